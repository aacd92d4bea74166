# SPDX-License-Identifier: BSD-3-Clause
"""Slices, contours, lines of one value, probes: exact where they say so, whole, without cracks."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from bezsoma.bernstein import count, values
from bezsoma.errors import InputError
from bezsoma.mesh import (
    BrokenField,
    ControlNet,
    Field,
    Level,
    Plane,
    TetMesh,
    ball,
    block,
    contour,
    isolines,
    line_through,
    slice_of,
)
from bezsoma.mesh.marching import straying
from tolerances import ROUNDING

EDGES = ((0, 1), (1, 2), (0, 2))


def field(mesh: TetMesh, degree: int, function: Callable[[np.ndarray], np.ndarray]) -> Field:
    return Field.interpolating(ControlNet(mesh, degree), function)


def shaken(mesh: TetMesh, degree: int, by: float, seed: int = 0) -> Field:
    net = ControlNet(mesh, degree)
    return Field(net, by * np.random.default_rng(seed).normal(size=(net.count, 3)))


def inner(number: int) -> np.ndarray:
    return np.random.default_rng(1).dirichlet((1, 1, 1), number)


def loose_edges(cut: Level) -> np.ndarray:
    """The places (e, 2, 3) of edges that one triangle alone has; no edge may have three."""
    pairs = cut.vertex[:, np.array(EDGES)].reshape(-1, 2)
    places = cut.points[:, np.array(EDGES)].reshape(-1, 2, 3)
    _, first, times = np.unique(
        np.sort(pairs, axis=1), axis=0, return_index=True, return_counts=True
    )
    assert times.max() == 2
    return places[first[times == 1]]


@pytest.mark.parametrize("degree", [1, 2, 5])
def test_a_field_on_a_slice_is_its_polynomial_in_the_plane(degree: int) -> None:
    mesh = block((3.0, 2.0, 2.0), (3, 2, 2), (10.0, 0.0, -5.0))

    def function(x: np.ndarray) -> np.ndarray:
        return (0.2 * x[:, 0] - 0.3 * x[:, 1] + 0.1 * x[:, 2]) ** degree

    plane = Plane((1.0, 2.0, -0.5), 14.0)
    cut = slice_of(mesh, plane)
    places = cut.places(inner(9))
    assert np.abs(plane.heights(places)).max() < ROUNDING * 20
    found = cut.at(field(mesh, degree, function), inner(9))
    wanted = function(places.reshape(-1, 3)).reshape(found.shape)
    assert np.abs(found - wanted).max() < 1e-12 * np.abs(wanted).max()


def test_a_slice_through_vertices_and_faces_is_whole_and_counted_once() -> None:
    mesh = block((4.0, 4.0, 4.0), (4, 4, 4))
    for plane, area in (("x=2", 16.0), ("z=1.3", 16.0), (Plane((1, 1, 1), 6.0), None)):
        cut = slice_of(mesh, plane)
        wanted = 12 * 3**0.5 if area is None else area  # a hexagon of side 2 sqrt(2)
        assert np.isclose(cut.areas.sum(), wanted, rtol=1e-12)
        rim = loose_edges(cut)
        on_wall = (np.abs(rim) < 1e-12) | (np.abs(rim - 4) < 1e-12)
        assert on_wall.all(axis=1).any(axis=1).all()


def test_a_slice_of_a_moved_body_lies_in_the_plane_and_has_no_cracks() -> None:
    mesh = ball(10.0, 2)
    moved = shaken(mesh, 3, 0.4)
    for text in ("x=0", "z=1.7"):
        plane = Plane.of(text)
        cut = slice_of(mesh, plane, moved, tolerance=0.4)
        corners = cut.points + cut.at(moved)
        assert np.abs(plane.heights(corners)).max() < 1e-11
        between = cut.places(inner(6)) + cut.at(moved, inner(6))
        off = np.abs(plane.heights(between)).max()
        assert 1e-4 < off <= cut.stray <= 0.4
        rim = loose_edges(cut).reshape(-1, 3)
        from_skin = mesh_distance(mesh, rim)
        assert from_skin.max() < 1e-9


def test_a_plane_that_runs_along_faces_of_a_moved_body_cuts_it_once() -> None:
    """There the height above the plane is zero but for rounding, on whole faces."""
    mesh = block((4.0, 3.0, 3.0), (4, 3, 3))
    moved = field(
        mesh, 3, lambda x: np.c_[0.1 * (x[:, 0] - 2) * x[:, 1] ** 2, x[:, 0], 0 * x[:, 0]]
    )
    for parts in (2, 3, 5):
        cut = slice_of(mesh, "x=2", moved, parts=parts)
        assert np.isclose(cut.areas.sum(), 9.0, rtol=1e-9)
        assert np.abs(cut.points[..., 0] - 2).max() < 1e-9


def mesh_distance(mesh: TetMesh, points: np.ndarray) -> np.ndarray:
    """How far points lie from the boundary."""
    from bezsoma.mesh import Locator

    return np.asarray(Locator(mesh).nearest(points).distance)


def test_a_contour_lies_on_its_level_closes_and_is_a_sphere() -> None:
    mesh = ball(10.0, 3)
    square = field(mesh, 2, lambda x: (x**2).sum(axis=1))
    cut = contour(square, 36.0, tolerance=0.5)
    assert cut.stray <= 0.5
    assert np.abs(np.linalg.norm(cut.points, axis=2) - 6).max() < 1e-13 * 6 * 10
    assert np.abs(cut.at(square, inner(20)) - 36).max() <= 0.5
    assert len(loose_edges(cut)) == 0
    sides = np.unique(np.sort(cut.vertex[:, np.array(EDGES)].reshape(-1, 2), axis=1), axis=0)
    assert len(np.unique(cut.vertex)) - len(sides) + len(cut) == 2
    assert 0.99 < cut.areas.sum() / (4 * np.pi * 36) < 1
    a, b, c = np.moveaxis(cut.points, 1, 0)
    assert (np.einsum("rd,rd->r", np.cross(b - a, c - a), a) > 0).all()  # outwards, as it grows
    assert np.allclose(cut.gradient(square), 2 * cut.points, atol=1e-12)


def test_a_broken_field_is_contoured_tet_by_tet() -> None:
    mesh = block(cells=(2, 1, 1))
    rng = np.random.default_rng(0)
    broken = BrokenField(mesh, 2, rng.normal(size=(len(mesh.tets), count(2, 3))))
    cut = contour(broken, 0.1, tolerance=0.2)
    assert np.abs(cut.at(broken) - 0.1).max() < 1e-12
    assert np.abs(cut.at(broken, inner(9)) - 0.1).max() <= cut.stray <= 0.2


@pytest.mark.parametrize("dim", [1, 2, 3])
@pytest.mark.parametrize("degree", [2, 3, 6])
def test_no_polynomial_strays_farther_than_the_bound(dim: int, degree: int) -> None:
    rng = np.random.default_rng(degree)
    controls = rng.normal(size=(40, count(degree, dim)))
    for parts in (1, 3):
        bound = straying(degree, dim, controls, parts)
        for _ in range(20):
            corners = rng.dirichlet(np.ones(dim + 1))[None] * (1 - 1 / parts)
            corners = corners + np.eye(dim + 1) / parts
            weight = rng.dirichlet(np.ones(dim + 1), 30)
            exact = controls @ values(degree, weight @ corners).T
            flat = controls @ values(degree, corners).T @ weight.T
            assert (np.abs(exact - flat).max(axis=1) <= bound * (1 + 1e-12)).all()


def test_lines_of_one_value_lie_on_it_and_meet() -> None:
    mesh = block((2.0, 2.0, 1.0), (3, 3, 1))
    square = field(mesh, 2, lambda x: ((x[:, :2] - 1) ** 2).sum(axis=1))
    found = isolines(square, 0.49, "top", tolerance=2e-3)
    assert np.abs(np.hypot(*(found.points[..., :2] - 1).reshape(-1, 2).T) - 0.7).max() < 1e-13
    assert np.abs(found.at(square) - 0.49).max() < 1e-13
    assert (np.bincount(found.vertex.ravel())[np.unique(found.vertex)] == 2).all()
    length = np.linalg.norm(np.diff(found.points, axis=1)[:, 0], axis=1).sum()
    assert np.isclose(length, 2 * np.pi * 0.7, rtol=2e-3) and found.stray <= 2e-3


def test_a_probe_line_gives_the_polynomial_both_sides_of_jumps_and_its_integral() -> None:
    mesh = block((4.0, 1.0, 1.0), (4, 1, 1))
    cubic = field(mesh, 3, lambda x: x[:, 0] ** 3 - x[:, 1])
    line = line_through(mesh, [-1, 0.3, 0.4], [6, 0.3, 0.4])
    distance, found = line.at(cubic, parts=7)
    assert np.allclose(found, (distance - 1) ** 3 - 0.3, atol=1e-12)
    assert np.isclose(distance.min(), 1) and np.isclose(distance.max(), 5)
    assert np.isclose(np.diff(line.span).sum(), 4)
    assert np.isclose(line.integral(cubic), 4**4 / 4 - 0.3 * 4)
    number = BrokenField(mesh, 0, np.arange(float(len(mesh.tets)))[:, None])
    _, numbers = line.at(number)
    assert (numbers.reshape(-1, 2) == line.tets[:, None]).all()


def test_a_probe_line_within_faces_and_along_edges_is_counted_once() -> None:
    mesh = block((2.0, 2.0, 2.0), (2, 2, 2))
    for start, end in (([0, 1, 1], [2, 1, 1]), ([0, 0, 0], [2, 2, 2]), ([0, 1, 0.3], [2, 1, 0.3])):
        line = line_through(mesh, np.array(start, float), np.array(end, float))
        length = float(np.linalg.norm(np.subtract(end, start)))
        assert np.isclose(np.diff(line.span).sum(), length)
        assert (line.span[1:, 0] >= line.span[:-1, 1] - 1e-12).all()


def test_what_cannot_be_cut_says_why() -> None:
    mesh = block((4.0, 2.0, 1.0), (2, 1, 1))
    moved = Field(ControlNet(mesh, 1), np.tile([10.0, 0, 0], (ControlNet(mesh, 1).count, 1)))
    height = field(mesh, 1, lambda x: x[:, 2])
    faults = (
        (lambda: slice_of(mesh, "x=5"), r"plane x = 5 mm does not cut .* x = 0 to 4 mm"),
        (lambda: slice_of(mesh, "x=2", moved), r"after it moved reaches from x = 10 to 14 mm"),
        (lambda: slice_of(mesh, "w=5"), "write x=12.5"),
        (lambda: slice_of(mesh, "x=1.2.3"), "write x=12.5"),
        (lambda: Plane((0, 0, 0), 1.0), "are no plane"),
        (lambda: contour(height, 3.0), "between 0 and 1"),
        (lambda: contour(moved, 1.0), r"shape \(3,\) has no meaning"),
        (lambda: contour(height, 0.5, -1.0), "give a positive number"),
        (lambda: contour(height, 0.5, np.nan), "give a positive number"),
        (lambda: isolines(height, 0.5, "top"), "does not reach the level"),
        (lambda: isolines(height.gradient_field(), 0.5), "continuous scalar field"),
        (lambda: line_through(mesh, [0, 9, 9], [1, 9, 9]), "misses the body, which reaches"),
        (lambda: line_through(mesh, [0, 1, 1], [0, 1, 1]), "has no direction"),
    )
    for call, message in faults:
        with pytest.raises(InputError, match=message):
            call()
    wave = field(mesh, 4, lambda x: np.sin(9 * x[:, 0]))
    with pytest.raises(InputError, match=r"can be had, or less on a finer mesh"):
        contour(wave, 0.1, 1e-6)


def test_the_lattice_of_a_slice_does_not_depend_on_the_tets_order() -> None:
    mesh = ball(5.0, 2)
    order = np.random.default_rng(0).permutation(len(mesh.tets))
    other = TetMesh(mesh.points, mesh.tets[order])
    for plane in ("x=0", "y=0.7"):
        assert np.isclose(slice_of(mesh, plane).areas.sum(), slice_of(other, plane).areas.sum())
