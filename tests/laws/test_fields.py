# SPDX-License-Identifier: BSD-3-Clause
"""Fields: continuous and broken, on tets and on surfaces, against polynomials known exactly."""

from __future__ import annotations

import doctest
from collections.abc import Callable
from math import pi
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bezsoma import bernstein
from bezsoma.errors import InputError
from bezsoma.mesh import evaluation
from bezsoma.mesh.control_net import ControlNet
from bezsoma.mesh.field import BrokenField, Field
from bezsoma.mesh.solids import ball, block, shell
from bezsoma.mesh.tets import TetMesh
from tolerances import CLOSED_FORM, ROUNDING, patch

DEGREES = range(1, 11)
DIRECTIONS = np.array([[0.3, -0.5, 0.4], [0.6, 0.2, -0.1]])


@pytest.fixture(scope="module")
def mesh() -> TetMesh:
    return block(size=(1.0, 2.0, 1.5), cells=(2, 3, 2), irregular=0.4, seed=7)


def powers(degree: int) -> Callable[[np.ndarray], np.ndarray]:
    """A field of two components, each the power of an affine function: (1 + d . x)^n."""
    return lambda x: (1 + x @ DIRECTIONS.T) ** degree


def gradients(degree: int) -> Callable[[np.ndarray], np.ndarray]:
    """Its gradient, (p, 2, 3)."""
    return lambda x: (
        degree * ((1 + x @ DIRECTIONS.T) ** max(degree - 1, 0))[:, :, None] * DIRECTIONS
    )


def arbitrary(mesh: TetMesh, degree: int, shape: tuple[int, ...] = (2,), seed: int = 0) -> Field:
    net = ControlNet(mesh, degree)
    return Field(net, np.random.default_rng(seed).normal(size=(net.count, *shape)))


def some_points(mesh: TetMesh, count: int = 60, seed: int = 0) -> np.ndarray:
    rng = np.random.default_rng(seed)
    tets = rng.integers(0, len(mesh.tets), count)
    bary = rng.dirichlet([1.0] * 4, count)
    return np.einsum("pi,pid->pd", bary, mesh.points[mesh.tets[tets]])


# Continuity and reproduction ------------------------------------------------------------------


@pytest.mark.parametrize("degree", DEGREES)
def test_any_controls_give_a_continuous_field(mesh: TetMesh, degree: int) -> None:
    """Seen from its two tets, a face has the same values; the gradient along it as well."""
    field = arbitrary(mesh, degree)
    inner = mesh.tets_of_face[:, 1] >= 0
    faces, (first, second) = mesh.all_faces[inner], mesh.tets_of_face[inner].T
    on_face = np.random.default_rng(1).dirichlet([1.0] * 3, len(faces))
    sides = []
    for tets in (first, second):
        same = mesh.tets[tets][:, :, None] == faces[:, None, :]
        bary = np.einsum("fij,fj->fi", same, on_face)
        edge = mesh.points[faces[:, 1]] - mesh.points[faces[:, 0]]
        along = np.einsum("fkd,fd->fk", field.gradient_bary(tets, bary), edge)
        sides.append((field.at_bary(tets, bary), along))
    assert np.abs(sides[0][0] - sides[1][0]).max() < CLOSED_FORM
    assert np.abs(sides[0][1] - sides[1][1]).max() < CLOSED_FORM * 100


@pytest.mark.parametrize("degree", DEGREES)
def test_polynomials_and_their_gradients_come_back(mesh: TetMesh, degree: int) -> None:
    field = Field.interpolating(ControlNet(mesh, degree), powers(degree))
    points = some_points(mesh)
    values, slopes = powers(degree)(points), gradients(degree)(points)
    assert np.abs(field.at(points) - values).max() < patch(degree) * np.abs(values).max()
    largest = np.abs(slopes).max()
    assert np.abs(field.gradient(points) - slopes).max() < patch(degree) * largest
    broken = field.gradient_field()
    assert broken.degree == degree - 1
    assert np.abs(broken.at(points) - slopes).max() < patch(degree) * largest


@pytest.mark.parametrize("shape", [(), (1,), (3,), (3, 3)])
def test_values_of_any_shape(mesh: TetMesh, shape: tuple[int, ...]) -> None:
    field, points = arbitrary(mesh, 3, shape), some_points(mesh, 7)
    assert field.shape == shape
    assert field.at(points).shape == (7, *shape)
    assert field.gradient(points).shape == (7, *shape, 3)
    assert field.of_tet.shape == (len(mesh.tets), 20, *shape)
    assert np.shape(field.integral()) == shape
    assert field.gradient_field().shape == (*shape, 3)
    assert field.gradient_field().averaged().at(points).shape == (7, *shape, 3)
    assert field.on_surface("top").at_bary(np.eye(3)).shape[1:] == (3, *shape)
    single = Field(field.net, field.controls.reshape(field.net.count, -1)[:, 0])
    first = field.at(points).reshape(7, -1)[:, 0]
    assert np.abs(single.at(points) - first).max() < ROUNDING * 10


def test_a_constant_has_no_gradient_at_all(mesh: TetMesh) -> None:
    field = Field(net := ControlNet(mesh, 4), np.full((net.count, 3), 1e6 + 0.1))
    assert not field.gradient(some_points(mesh)).any()
    assert field.h1_seminorm() == 0


@pytest.mark.parametrize("degree", [1, 2, 5])
def test_tabulated_is_the_same_point_by_point(mesh: TetMesh, degree: int) -> None:
    field, bary = arbitrary(mesh, degree), np.random.default_rng(2).dirichlet([1.0] * 4, 5)
    table = field.tabulated(bary)
    chosen = np.array([0, 7, len(mesh.tets) - 1])
    for number, point in enumerate(bary):
        found = field.at_bary(chosen, np.repeat(point[None], 3, axis=0))
        assert np.abs(table[chosen, number] - found).max() < ROUNDING * 10
    assert np.array_equal(field.tabulated(bary, chosen).shape, (3, 5, 2))


# Elevation ------------------------------------------------------------------------------------


@settings(max_examples=30, deadline=None)
@given(st.integers(1, 10), st.integers(0, 9), st.integers(0, 1000))
def test_elevation_changes_nothing(degree: int, by: int, seed: int) -> None:
    mesh = block(cells=(1, 2, 1))
    field = arbitrary(mesh, degree, seed=seed)
    raised = field.elevated(min(10, degree + by))
    points = some_points(mesh, 20, seed)
    assert raised.degree == min(10, degree + by)
    assert (
        np.abs(raised.at(points) - field.at(points)).max() < ROUNDING * np.abs(field.controls).max()
    )
    broken = BrokenField(mesh, degree, field.of_tet).elevated(degree + by)
    assert (
        np.abs(broken.at(points) - field.at(points)).max() < ROUNDING * np.abs(field.controls).max()
    )


def test_elevation_by_nothing_is_the_same_controls(mesh: TetMesh) -> None:
    field = arbitrary(mesh, 3)
    assert np.array_equal(field.elevated(3).controls, field.controls)


def test_elevation_twice_is_elevation_at_once(mesh: TetMesh) -> None:
    field = arbitrary(mesh, 2)
    twice, once = field.elevated(4).elevated(7), field.elevated(7)
    assert np.abs(twice.controls - once.controls).max() < ROUNDING * 10


# Surfaces -------------------------------------------------------------------------------------


@pytest.mark.parametrize("degree", [1, 2, 3, 6, 10])
def test_the_restriction_is_the_field_on_the_surface(mesh: TetMesh, degree: int) -> None:
    field, bary = arbitrary(mesh, degree), np.random.default_rng(3).dirichlet([1.0] * 3, 6)
    for place in ("left", None, mesh.boundary[::3]):
        surface = field.on_surface(place)
        places = surface.places(bary)
        found = surface.at_bary(bary).reshape(-1, 2)
        expected = field.at(places.reshape(-1, 3), outside="nearest")
        assert np.abs(found - expected).max() < 1e-9  # the point may be given to another tet
        assert np.array_equal(surface.controls, field.controls[surface.numbers])
        assert np.abs(surface.positions - field.net.points[surface.numbers]).max() < ROUNDING * 10


@pytest.mark.parametrize("degree", [1, 2, 4])
def test_displaced_surfaces_turn_as_a_rigid_motion_says(mesh: TetMesh, degree: int) -> None:
    angle = 0.7
    turn = np.array(
        [[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]]
    )
    field = Field.interpolating(ControlNet(mesh, degree), lambda x: x @ turn.T - x + 3)
    surface, bary = field.on_surface(), np.array([[0.2, 0.3, 0.5], [1, 0, 0]])
    outward = mesh.normals(mesh.boundary)[:, None, :]
    assert np.abs(surface.normals(bary, scale=0.0) - outward).max() < CLOSED_FORM
    assert np.abs(surface.normals(bary) - outward @ turn.T).max() < CLOSED_FORM
    moved = surface.places(bary) @ turn.T + 3
    assert np.abs(surface.displaced(bary) - moved).max() < CLOSED_FORM
    half = (surface.places(bary) + moved) / 2
    assert np.abs(surface.displaced(bary, scale=0.5) - half).max() < CLOSED_FORM


def test_normals_of_a_curved_face_are_those_of_its_formula() -> None:
    """The top of a block bent to z = 1 + 0.2 x^2 - 0.3 x y: normals (-0.4 x + 0.3 y, 0.3 x, 1)."""
    net = ControlNet(block(cells=(2, 2, 1)), 2)
    bent = Field.interpolating(
        net, lambda x: np.outer(0.2 * x[:, 0] ** 2 - 0.3 * x[:, 0] * x[:, 1], [0, 0, 1])
    )
    surface, bary = bent.on_surface("top"), np.random.default_rng(0).dirichlet([1.0] * 3, 9)
    x, y, _ = np.moveaxis(surface.places(bary), -1, 0)
    expected = np.stack([0.3 * y - 0.4 * x, 0.3 * x, np.ones_like(x)], axis=-1)
    expected /= np.linalg.norm(expected, axis=-1, keepdims=True)
    assert np.abs(surface.normals(bary) - expected).max() < CLOSED_FORM


# Integrals and distances ----------------------------------------------------------------------


@pytest.mark.parametrize("degree", [1, 2, 3, 5, 8])
def test_integrals_over_a_block_are_exact(degree: int) -> None:
    """int x^a y^b z^c = 1/((a+1)(b+1)(c+1)) over the unit cube; norms by the same."""
    mesh = block(cells=(2, 2, 2), irregular=0.4, seed=3)
    a, b = degree // 2, degree - degree // 2
    field = Field.interpolating(ControlNet(mesh, degree), lambda x: x[:, 0] ** a * x[:, 2] ** b)
    assert field.integral() == pytest.approx(1 / ((a + 1) * (b + 1)), rel=CLOSED_FORM)
    square = 1 / ((2 * a + 1) * (2 * b + 1))
    assert field.l2_norm() == pytest.approx(np.sqrt(square), rel=CLOSED_FORM)
    slope = (a**2 / (2 * a - 1) / (2 * b + 1) if a else 0) + b**2 / (2 * b - 1) / (2 * a + 1)
    assert field.h1_seminorm() == pytest.approx(np.sqrt(slope), rel=CLOSED_FORM)
    assert field.on_surface("right").integral() == pytest.approx(1 / (b + 1), rel=CLOSED_FORM)
    gradient = field.gradient_field()
    assert gradient.l2_norm() == pytest.approx(np.sqrt(slope), rel=CLOSED_FORM)
    by_parts = field.on_surface("top").integral() - field.on_surface("bottom").integral()
    assert gradient.integral()[2] == pytest.approx(by_parts, rel=CLOSED_FORM)


def test_gauss_holds_on_a_shell_for_any_field() -> None:
    """int div u dV = int u . n dS, the two sides from different code."""
    mesh = shell(inner=1.0, outer=2.0, cells=2)
    field = arbitrary(mesh, 3, (3,))
    surface = field.on_surface()
    areas, normals = mesh.areas(mesh.boundary), mesh.normals(mesh.boundary)
    flux = np.einsum("f,fd,fd->", areas, normals, surface.controls.mean(axis=1))
    assert np.trace(field.gradient_field().integral()) == pytest.approx(flux, abs=1e-11)


@pytest.mark.parametrize("degree", [1, 2, 4])
def test_errors_against_the_field_itself_vanish_and_a_known_gap_is_found(degree: int) -> None:
    mesh = block(cells=(2, 1, 2))
    field = Field.interpolating(ControlNet(mesh, degree), powers(degree))
    assert field.l2_error(powers(degree)) < patch(degree) * field.l2_norm()
    assert field.h1_error(gradients(degree)) < patch(degree) * field.h1_seminorm()
    apart = field.l2_error(lambda x: powers(degree)(x) + np.array([3.0, -4.0]))
    assert apart == pytest.approx(5.0, rel=CLOSED_FORM)
    ones = np.ones((2, 3))
    assert field.h1_error(lambda x: gradients(degree)(x) - ones) == pytest.approx(
        np.sqrt(6), rel=1e-11
    )
    zero = field.l2_error(lambda x: np.zeros((len(x), 2)))
    assert zero == pytest.approx(field.l2_norm(), rel=CLOSED_FORM)
    broken = field.gradient_field()
    assert broken.l2_error(gradients(degree)) < patch(degree) * field.h1_seminorm()


@pytest.mark.parametrize("degree", [1, 2, 3, 4])
def test_interpolation_converges_at_full_rate(degree: int) -> None:
    errors = []
    for cells in (2, 4):
        field = Field.interpolating(
            ControlNet(block(cells=(cells,) * 3), degree), lambda x: np.sin(x @ [2.0, 1.0, -1.5])
        )
        errors.append(field.l2_error(lambda x: np.sin(x @ [2.0, 1.0, -1.5])))
    assert np.log2(errors[0] / errors[1]) > degree + 1 - 0.25


def test_portions_do_not_show(mesh: TetMesh, monkeypatch: pytest.MonkeyPatch) -> None:
    field, points = arbitrary(mesh, 3), some_points(mesh)

    def all_of_it() -> list[np.ndarray]:
        return [
            np.asarray(x)
            for x in (
                field.at(points),
                field.gradient(points),
                field.integral(),
                field.l2_norm(),
                field.h1_seminorm(),
                field.l2_error(powers(2)),
                field.h1_error(gradients(2)),
                *field.gradient_field().largest(),
            )
        ]

    whole = all_of_it()
    monkeypatch.setattr(evaluation, "PORTION", 500)
    for before, after in zip(whole, all_of_it(), strict=True):
        assert np.allclose(before, after, rtol=CLOSED_FORM, atol=CLOSED_FORM)


# Order of tets and vertices -------------------------------------------------------------------


@settings(max_examples=10, deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 6))
def test_a_field_does_not_depend_on_the_order_of_tets_or_vertices(seed: int, degree: int) -> None:
    rng = np.random.default_rng(seed)
    mesh = block(cells=(2, 2, 1), irregular=0.3, seed=seed % 1000)
    place = rng.permutation(len(mesh.points))
    points = np.empty_like(mesh.points)
    points[place] = mesh.points
    turned = rng.permuted(place[mesh.tets], axis=1)[rng.permutation(len(mesh.tets))]
    other = TetMesh(points, turned)
    asked = some_points(mesh, 25, seed)

    def function(x: np.ndarray) -> np.ndarray:
        return np.sin(3 * x) + x[:, :1]

    here, there = (Field.interpolating(ControlNet(m, degree), function) for m in (mesh, other))
    assert here.net.count == there.net.count
    assert np.abs(here.at(asked) - there.at(asked)).max() < 1e-11
    assert here.l2_norm() == pytest.approx(there.l2_norm(), rel=CLOSED_FORM)
    assert np.allclose(here.integral(), there.integral(), rtol=CLOSED_FORM)
    averages = [f.gradient_field().averaged().at(asked) if degree > 1 else 0 for f in (here, there)]
    assert np.abs(averages[0] - averages[1]).max() < 1e-9


# Broken fields --------------------------------------------------------------------------------


@pytest.mark.parametrize("degree", [1, 2, 5])
def test_averaging_what_is_continuous_gives_it_back(mesh: TetMesh, degree: int) -> None:
    field = arbitrary(mesh, degree)
    back = BrokenField(mesh, degree, field.of_tet).averaged(field.net)
    assert back.net is field.net
    assert np.abs(back.controls - field.controls).max() < ROUNDING * 10


def test_averages_weigh_by_volume() -> None:
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 3], [0, 0, -1.0]])
    mesh = TetMesh(points, [[0, 1, 2, 3], [0, 1, 2, 4]])
    heavy = int(np.flatnonzero(mesh.volumes > 0.4)[0])
    controls = np.zeros((2, 1))
    controls[heavy] = 4.0
    averaged = BrokenField(mesh, 0, controls).averaged()
    assert averaged.degree == 1
    assert averaged.at(points).tolist() == pytest.approx([3.0, 3.0, 3.0, 4.0, 0.0])


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 6), st.integers(0, 1000))
def test_bounds_enclose_and_largest_is_a_value(degree: int, seed: int) -> None:
    mesh = block(cells=(1, 1, 1))
    controls = np.random.default_rng(seed).normal(size=(6, bernstein.count(degree, 3), 3))
    field = BrokenField(mesh, degree, controls)
    values = field.tabulated(np.random.default_rng(1).dirichlet([1.0] * 4, 30))
    low, high = field.bounds()
    assert (low <= values.min(axis=(0, 1)) + 1e-12).all()
    assert (high >= values.max(axis=(0, 1)) - 1e-12).all()
    size, where = field.largest()
    bary = bernstein.domain_points(max(degree, 1), 3)
    sizes = np.linalg.norm(field.tabulated(bary), axis=2)
    tet, point = np.unravel_index(sizes.argmax(), sizes.shape)
    assert size == pytest.approx(sizes.max(), rel=CLOSED_FORM)
    assert np.allclose(where, bary[point] @ mesh.points[mesh.tets[tet]])
    if degree > 0:
        continuous = Field(net := ControlNet(mesh, degree), np.full((net.count, 1), 2.0))
        assert [float(b[0]) for b in continuous.bounds()] == [2.0, 2.0]


def test_a_broken_field_takes_the_lowest_tet_on_a_face() -> None:
    mesh = block(cells=(2, 2, 2))
    number = BrokenField(mesh, 0, np.arange(len(mesh.tets))[:, None])
    inner = mesh.tets_of_face[:, 1] >= 0
    middle = mesh.points[mesh.all_faces[inner]].mean(axis=1)
    assert np.array_equal(number.at(middle), mesh.tets_of_face[inner, 0])
    assert not number.gradient(middle).any()


def test_the_volume_of_a_ball_is_the_integral_of_one() -> None:
    mesh = ball(radius=2.0, cells=6)
    one = Field(net := ControlNet(mesh, 2), np.ones(net.count))
    assert one.integral() == pytest.approx(mesh.volumes.sum(), rel=CLOSED_FORM)
    assert one.integral() == pytest.approx(4 / 3 * pi * 8, rel=0.1)


# Outside --------------------------------------------------------------------------------------


def test_the_rule_for_points_outside() -> None:
    field = Field.interpolating(ControlNet(block(cells=(2, 2, 2)), 2), lambda x: x**2)
    points = np.array([[0.5, 0.5, 0.5], [0.25, 0.5, 3.0], [-1.0, -1.0, -1.0]])
    with pytest.raises(InputError) as raised:
        field.at(points)
    for word in ("point 1 at (0.25, 0.5, 3)", "2 mm from it", "(2 of 3", "'nearest'", "'nan'"):
        assert word in str(raised.value)
    nearest = field.at(points, outside="nearest")
    assert np.allclose(nearest, [[0.25, 0.25, 0.25], [0.0625, 0.25, 1.0], [0, 0, 0]])
    gone = field.at(points, outside="nan")
    assert np.isnan(gone[1:]).all()
    assert np.allclose(gone[0], 0.25)
    slope = field.gradient(points[:2], outside="nearest")
    assert np.allclose(slope[1], np.diag([0.5, 1.0, 2.0]))
    assert np.isnan(field.gradient(points, outside="nan")[2]).all()
    broken = field.gradient_field()
    assert np.allclose(broken.at(points[:2], outside="nearest"), slope)
    with pytest.raises(InputError, match="outside='zero' is not known"):
        field.at(points, outside="zero")  # type: ignore[arg-type]


# Faults ---------------------------------------------------------------------------------------


def test_faults_are_named(mesh: TetMesh) -> None:
    net = ControlNet(mesh, 2)
    with pytest.raises(
        InputError, match=rf"shape \(4, 3\) were given; .* has {net.count} controls"
    ):
        Field(net, np.zeros((4, 3)))
    with pytest.raises(InputError, match="degree 1 on this mesh has"):
        BrokenField(mesh, 1, np.zeros((len(mesh.tets), 10)))
    field = Field(net, np.zeros((net.count, 2)))
    with pytest.raises(InputError, match="degree 2 cannot be lowered to 1"):
        field.elevated(1)
    with pytest.raises(InputError, match="degree 1 cannot be lowered to 0"):
        field.gradient_field().elevated(0)
    with pytest.raises(InputError, match=r"values of shape \(2,\) does not move points"):
        field.on_surface("top").displaced(np.eye(3))
    with pytest.raises(InputError, match=r"gives values of shape \(3,\), and the field has values"):
        field.l2_error(lambda x: x)
    with pytest.raises(InputError, match=r"field has gradients of shape \(2, 3\)"):
        field.h1_error(lambda x: x)
    with pytest.raises(InputError, match="mesh and degree 1 is needed"):
        field.gradient_field().averaged(net)
    with pytest.raises(InputError, match=r"no surface 'tpo'.*did you mean 'top'"):
        field.on_surface("tpo")


def test_controls_cannot_be_changed_behind_a_fields_back(mesh: TetMesh) -> None:
    field = Field(net := ControlNet(mesh, 1), np.zeros(net.count))
    with pytest.raises(ValueError, match="read-only"):
        field.controls[0] = 1.0


def test_the_examples_of_the_theory_page_run(root: Path) -> None:
    page = root / "docs" / "theory" / "fields.md"
    result = doctest.testfile(str(page), module_relative=False, encoding="utf-8")
    assert result.failed == 0
    assert result.attempted >= 18
