# SPDX-License-Identifier: BSD-3-Clause
"""From supports to prescribed controls, and what holds where two supports meet."""

from __future__ import annotations

import doctest
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from bezsoma import bernstein
from bezsoma.equations.boundary import PrescribedControls, prescribed
from bezsoma.equations.grading import distances, smooth_step
from bezsoma.mechanics import (
    Body,
    Fixed,
    Gap,
    Graded,
    LinearElastic,
    Moved,
    Polynomial,
    Precedence,
    Prescribed,
)
from bezsoma.mechanics.meeting import meeting
from bezsoma.mesh.control_net import ControlNet
from bezsoma.mesh.solids import block
from bezsoma.mesh.tets import TetMesh
from tolerances import ROUNDING, patch

TISSUE = LinearElastic(E=0.015, nu=0.45)
FAR = np.array([1000.0, -700.0, 1300.0])


def jaw_and_rami(cells: tuple[int, int, int] = (8, 3, 2)) -> TetMesh:
    """A slab of 8 x 3 x 2 mm whose floor is held for x > 3 (rami) and moved for x < 3 (jaw)."""
    mesh = block(size=(8, 3, 2), cells=cells)
    mesh = mesh.with_surface("jaw", lambda x: (x[:, 2] == 0) & (x[:, 0] <= 3))
    mesh = mesh.with_surface("rami", lambda x: (x[:, 2] == 0) & (x[:, 0] >= 3))
    mesh = mesh.with_edges("line", np.array([[3.0, y, 0] for y in range(4)]))
    return mesh.with_vertices("tip", np.array([[8.0, 3, 2]]))


def known(
    mesh: TetMesh, degree: int, supports: list, joins: tuple = ()
) -> tuple[PrescribedControls, ControlNet]:
    net = ControlNet(mesh, degree)
    return prescribed(Body(mesh, degree, TISSUE, supports, joins=joins), net), net


def on_surface(net: ControlNet, name: str, controls: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Points on the facets of a surface and the values there of the net's Bernstein form."""
    bary, _ = bernstein.simplex(5, 2)
    facets = net.mesh.facets_of(name)
    points = bary @ net.mesh.points[facets]
    values = bernstein.values(net.degree, bary) @ controls[net.of_facets(facets)]
    return points.reshape(-1, 3), values.reshape(-1, 3)


# What a support prescribes ------------------------------------------------------------------


@pytest.mark.parametrize("degree", [1, 2, 3, 5, 8, 10])
def test_a_moved_surface_turns_as_a_rigid_body_to_the_last_digits(degree: int) -> None:
    mesh = block(cells=(2, 2, 2), irregular=0.3, origin=tuple(FAR))
    turn = Rotation.from_rotvec(0.4 * np.array([1, 2, 2]) / 3).as_matrix()
    about, shift = FAR + np.array([0.3, 0.1, -2]), np.array([0, -5.0, 1])
    moved = Moved("top", translation=shift, axis=(1, 2, 2), angle=0.4, about=about)
    controls, net = known(mesh, degree, [moved])
    points, values = on_surface(net, "top", controls.values)
    expected = (points - about) @ turn.T + about + shift - points
    assert np.abs(values - expected).max() < 1e-12  # mm, with coordinates of 1e3


@pytest.mark.parametrize("degree", range(1, 11))
def test_a_prescribed_polynomial_is_met_at_every_point(degree: int) -> None:
    """Not only in the domain points: controls are no values."""
    mesh = block(cells=(2, 2, 1), irregular=0.3, origin=tuple(FAR))
    local = [f"({axis} - {at:g})" for axis, at in zip("xyz", FAR, strict=True)]
    power = f"({local[0]} + 2*{local[1]} - {local[2]})**{degree}"
    field = Polynomial.parse([power, f"1 - {local[1]}", "0.5"])
    controls, net = known(mesh, degree, [Prescribed("top", "right", value=field)])
    points, values = on_surface(net, "right", controls.values)
    exact = field(points)
    assert np.abs(values - exact).max() < patch(degree) * np.abs(exact).max()


def test_a_function_is_interpolated_and_neighbours_agree() -> None:
    """Two surfaces with the same function share an edge: no disagreement, and it converges."""

    def swell(x: np.ndarray) -> np.ndarray:
        return np.stack([np.sin(x[:, 0]), np.exp(x[:, 1]), x[:, 0] * x[:, 1]], axis=1)

    errors = []
    for degree in (2, 4, 6):
        supports = [Prescribed("top", value=swell), Prescribed("right", value=lambda x: swell(x))]
        controls, net = known(block(cells=(2, 2, 2)), degree, supports)
        points, values = on_surface(net, "top", controls.values)
        errors.append(np.abs(values - swell(points)).max())
    assert errors[0] < 1e-2
    assert errors[1] < 1e-2 * errors[0]
    assert errors[2] < 1e-2 * errors[1]


@pytest.mark.parametrize("degree", [1, 3])
def test_the_closure_of_a_place_is_held_and_nothing_else(degree: int) -> None:
    mesh = jaw_and_rami()
    supports = [Fixed("bottom", components="z"), Fixed("line", components="y"), Fixed("tip")]
    controls, net = known(mesh, degree, supports)
    x, y, z = net.points.T
    tip = (x == 8) & (y == 3) & (z == 2)
    expected = np.stack([tip, tip | (np.isclose(x, 3) & (z == 0)), tip | (z == 0)], axis=1)
    assert np.array_equal(controls.mask, expected)
    assert not controls.values.any()


def test_supports_on_different_components_of_the_same_place_add_up() -> None:
    supports = [Fixed("top", components="xy"), Moved("top", translation=(9, 9, 1), components="z")]
    controls, net = known(block(), 2, supports)
    numbers, own = controls.of_support["top"]
    assert np.array_equal(numbers, net.of_place("top"))
    assert own.all()
    assert np.unique(controls.values[numbers], axis=0).tolist() == [[0.0, 0.0, 1.0]]


def test_every_prescribed_component_belongs_to_one_place_only() -> None:
    """So reactions add up to the whole; what two hold alike is the first's."""
    supports = [Fixed("top", "right"), Fixed("bottom", components="z"), Fixed("left", "top")]
    controls, net = known(block(cells=(2, 2, 2)), 3, supports)
    owners = np.zeros((net.count, 3), dtype=int)
    for numbers, own in controls.of_support.values():
        owners[numbers] += own
    assert np.array_equal(owners, controls.mask.astype(int))
    assert controls.of_support["top"][1].all()
    assert not controls.of_support["right"][1].all()


def test_a_body_without_supports_has_no_prescribed_controls() -> None:
    controls, _ = known(block(), 2, [])
    assert not controls.mask.any()
    assert controls.of_support == {}


@pytest.mark.parametrize("degree", [2, 10])
def test_the_same_value_twice_is_no_disagreement(degree: int) -> None:
    """Said as a motion, as a matrix and as a function, in scanner coordinates."""
    mesh = block(origin=tuple(FAR))
    turn = Rotation.from_rotvec([0, 0, 0.1]).as_matrix() - np.eye(3)
    supports = [
        Moved("top", axis=(0, 0, 1), angle=0.1, about=FAR),
        Prescribed("right", value=Polynomial.affine(turn, about=FAR)),
        Prescribed("front", value=lambda x: (x - FAR) @ turn.T),
    ]
    controls, _ = known(mesh, degree, supports)
    assert controls.mask.any()


# Where supports meet ------------------------------------------------------------------------


def test_precedence_holds_on_the_line_by_component() -> None:
    jump = [Moved("jaw", translation=(1, 2, 3), components="yz"), Fixed("rami")]
    controls, net = known(jaw_and_rami(), 3, jump, (Precedence("jaw", over="rami"),))
    line = net.of_place("line")
    assert np.unique(controls.values[line], axis=0).tolist() == [[0.0, 2.0, 3.0]]
    assert controls.mask[line].all()
    turned, _ = known(jaw_and_rami(), 3, jump, (Precedence("rami", over="jaw"),))
    assert not turned.values[line].any()
    assert turned.of_support["rami"][1].all()


def test_precedence_passes_on_through_a_third_place() -> None:
    """Three meet at a corner: first over second over third settles all three there."""
    motions = [Moved(name, translation=(i, 0, 0)) for i, name in enumerate(("top", "left", "back"))]
    joins = (
        Precedence("top", over="left"),
        Precedence("left", over="back"),
        Precedence("top", over="back"),
    )
    controls, net = known(block(), 2, motions, joins)
    corner = net.of_vertices(np.flatnonzero((net.mesh.points == [0, 1, 1]).all(axis=1)))
    assert controls.values[corner].tolist() == [[0.0, 0.0, 0.0]]


@pytest.mark.parametrize("degree", [1, 2, 3, 6])
def test_a_graded_jump_is_continuous_monotone_and_ends_at_the_band(degree: int) -> None:
    band, jump = 2.5, [Fixed("rami"), Moved("jaw", translation=(0, -5, 0))]
    controls, net = known(jaw_and_rami((16, 3, 2)), degree, jump, (Graded("rami", "jaw", band),))
    line = net.of_place("line")
    assert np.abs(controls.values[line] - [0, -5, 0]).max() < 1e-12
    assert np.abs(controls.values[net.of_place("jaw")] - [0, -5, 0]).max() < 1e-12
    points, values = on_surface(net, "rami", controls.values)
    assert np.abs(values[:, [0, 2]]).max() == 0
    away = points[:, 0] - 3
    beyond = away > band + 0.5  # an element's width: the step ends inside the last one it touches
    assert np.abs(values[beyond]).max() < 1e-12
    error = np.abs(values[:, 1] + 5 * smooth_step(away / band)).max()
    assert error < 5 * {1: 0.05, 2: 0.01, 3: 0.006, 6: 0.003}[degree]
    order = np.argsort(away)
    assert np.diff(values[order, 1]).min() > -5 * {1: 0.05, 2: 0.02, 3: 0.01, 6: 0.005}[degree]


def test_a_jump_graded_to_a_turning_jaw_follows_its_motion_on_the_line() -> None:
    turning = Moved("jaw", axis=(1, 0, 0), angle=0.3, about=(0, 1, 0))
    supports = [Fixed("rami", components="yz"), turning]
    controls, net = known(jaw_and_rami(), 4, supports, (Graded("rami", "jaw", 2),))
    points, values = on_surface(net, "rami", controls.values)
    weight = smooth_step((points[:, 0] - 3) / 2)[:, None]
    expected = weight * turning.displacement(points)
    assert np.abs(values - expected)[:, 1:].max() < 2e-3
    off_line = np.setdiff1d(net.of_place("rami"), net.of_place("line"))
    assert not controls.mask[off_line, 0].any()


def test_bands_can_follow_each_other() -> None:
    """The third is graded to the second, that to the first: its own line gets the graded value."""
    mesh = block(size=(6, 2, 1), cells=(12, 2, 1))
    for name, low, high in (("a", 0, 2), ("b", 2, 4), ("c", 4, 6)):
        mesh = mesh.with_surface(
            name,
            lambda x, low=low, high=high: (x[:, 2] == 0) & (x[:, 0] >= low) & (x[:, 0] <= high),
        )
    supports = [Fixed("c"), Fixed("b"), Moved("a", translation=(0, 0, 1))]
    joins = (Graded("c", "b", 1.5), Graded("b", "a", 3))
    controls, net = known(mesh, 3, supports, joins)
    at = net.points[:, 2] == 0
    on_line = at & np.isclose(net.points[:, 0], 4)
    assert np.allclose(controls.values[on_line, 2], smooth_step(np.array(2 / 3)), atol=0.02)
    x = net.points[at, 0]
    jumps = np.abs(np.diff(controls.values[at, 2][np.argsort(x)]))
    assert jumps.max() < 0.4


def test_a_gap_frees_what_reaches_into_its_width() -> None:
    """Facets with a vertex within 1.5 mm of x = 3 go; what is left holds its closure, x >= 5."""
    jump = [Fixed("rami"), Moved("jaw", translation=(0, -5, 0))]
    controls, net = known(jaw_and_rami(), 3, jump, (Gap(free="rami", at="jaw", width=1.5),))
    x, _, z = net.points.T
    expected = (z == 0) & ((x <= 3 + 1e-9) | (x >= 5 - 1e-9))
    assert np.array_equal(controls.mask.all(axis=1), expected)
    assert np.array_equal(controls.mask.any(axis=1), expected)
    line = net.of_place("line")
    assert np.unique(controls.values[line], axis=0).tolist() == [[0.0, -5.0, 0.0]]


def test_a_gap_between_mesh_edges_and_a_surface() -> None:
    mesh = block(size=(4, 1, 1), cells=(4, 1, 1))
    mesh = mesh.with_edges("wire", np.array([[float(x), 0, 0] for x in range(5)]))
    supports = [Moved("left", translation=(1, 0, 0)), Fixed("wire")]
    controls, net = known(mesh, 2, supports, (Gap(free="wire", at="left", width=0.5),))
    wire = net.of_place("wire")
    held = net.points[wire][controls.mask[wire].all(axis=1), 0]
    assert sorted(held.tolist()) == [0, 1, 1.5, 2, 2.5, 3, 3.5, 4]


@pytest.mark.parametrize("join", [Graded("rami", "jaw", 2.5), Gap("rami", "jaw", 2.0)])
def test_joins_do_not_feel_the_frame(join: Graded | Gap) -> None:
    """Turned and shifted: the same controls are held, at the turned values."""
    turn = Rotation.from_rotvec([0.3, -0.8, 0.5]).as_matrix()
    mesh, shift = jaw_and_rami(), np.array([0, -5.0, 2])
    here, _ = known(mesh, 3, [Fixed("rami"), Moved("jaw", translation=shift)], (join,))
    supports = [Fixed("rami"), Moved("jaw", translation=turn @ shift)]
    there, net = known(mesh.moved(turn, FAR), 3, supports, (join,))
    flat, _ = known(mesh.moved(turn, FAR), 3, [Fixed("rami", "jaw")])
    assert here.mask.sum() == there.mask.sum()
    assert (there.mask <= flat.mask).all()
    norms = [np.sort(np.linalg.norm(each.values, axis=1)) for each in (here, there)]
    assert np.allclose(*norms, rtol=0, atol=1e-9)
    assert net.count == len(there.mask)


def test_places_meet_on_shared_edges_and_lone_vertices() -> None:
    mesh = block(cells=(2, 2, 2)).with_vertices("corner", np.array([[0.0, 0, 0]]))
    line = mesh.points[meeting(mesh, "left", "bottom")]
    assert line.shape == (2, 2, 3)
    assert np.ptp(line[..., 1]) == 1
    assert not line[..., [0, 2]].any()
    assert meeting(mesh, "left", "corner").tolist() == [[0, 0]]


def test_the_step_is_the_cubic_that_is_flat_at_both_ends() -> None:
    s = np.array([0, 0.25, 0.5, 0.75, 1])
    assert smooth_step(s).tolist() == [1, 0.84375, 0.5, 0.15625, 0]
    assert np.allclose(smooth_step(s), 1 - 3 * s**2 + 2 * s**3, rtol=0, atol=1e-16)
    assert smooth_step(np.array([1.0001, 7, np.inf])).tolist() == [0, 0, 0]


def test_distances_to_a_polyline_are_exact() -> None:
    """Against brute force over finely sampled segments, and zero on the line itself."""
    rng = np.random.default_rng(4)
    corners = rng.normal(size=(6, 3))
    segments = np.stack([corners[:-1], corners[1:]], axis=1)
    points = 2 * rng.normal(size=(50, 3))
    s = np.linspace(0, 1, 4001)[:, None, None]
    sampled = ((1 - s) * segments[:, 0] + s * segments[:, 1]).reshape(-1, 3)
    brute = np.linalg.norm(points[:, None] - sampled, axis=2).min(axis=1)
    mine = distances(points, segments)
    assert np.abs(mine - brute).max() < 1e-3
    assert (mine <= brute + ROUNDING).all()
    limited = distances(points, segments, upto=1.0)
    near = mine <= 1
    assert np.array_equal(limited[near], mine[near])
    assert (limited[~near] > 1).all()
    assert distances(segments.mean(axis=1), segments).max() < 1e-15


def test_a_tiny_turn_keeps_its_digits_and_half_a_turn_is_one() -> None:
    origin, upwards = (0, 0, 0), (0, 0, 1)
    turned = Moved("a", axis=upwards, angle=1e-9, about=origin)
    tiny = turned.displacement(np.array([[1.0, 0, 0]]))
    assert tiny[0, 1] == pytest.approx(1e-9, rel=1e-15)
    turned = Moved("a", axis=(0, 0, 5), angle=np.pi, about=origin)
    half = turned.displacement(np.array([[1.0, 2, 3]]))
    assert np.allclose(half, [[-2, -4, 0]], atol=1e-15)


def test_no_motion_may_be_said_in_numbers() -> None:
    """A row of trials begins with zero; only a motion without any number is refused."""
    points = np.array([[1.0, 2, 3]])
    for still in (Moved("a", translation=(0, 0, 0)), Moved("a", angle=0)):
        assert not still.displacement(points).any()


def test_a_support_shows_itself_as_it_was_called() -> None:
    def swell(x: np.ndarray) -> np.ndarray:
        return x

    turn = Moved("jaw", axis=(1, 0, 0), angle=0.5, about=(0, 9, 0), components="yz")
    assert repr(Fixed("a", "b")) == "Fixed('a', 'b')"
    assert repr(Moved("a", translation=(0, -5, 0))) == "Moved('a', translation=(0.0, -5.0, 0.0))"
    assert repr(turn) == (
        "Moved('jaw', translation=(0.0, 0.0, 0.0), axis=(1.0, 0.0, 0.0), angle=0.5, "
        "about=(0.0, 9.0, 0.0), components='yz')"
    )
    assert repr(Prescribed("a", value=swell)) == "Prescribed('a', value=<function swell>)"


def test_the_examples_of_the_theory_page_run(root: Path) -> None:
    page = root / "docs" / "theory" / "supports_and_loads.md"
    result = doctest.testfile(
        str(page),
        module_relative=False,
        optionflags=doctest.ELLIPSIS | doctest.IGNORE_EXCEPTION_DETAIL,
        encoding="utf-8",
    )
    assert result.failed == 0
    assert result.attempted >= 15
