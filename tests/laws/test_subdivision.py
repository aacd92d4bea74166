# SPDX-License-Identifier: BSD-3-Clause
"""Fields on finer meshes are the same polynomials; nets become graphs; bounds enclose."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bezsoma import bernstein
from bezsoma.bernstein.subdivision import uniform_corners
from bezsoma.errors import InputError
from bezsoma.mesh import BrokenField, ControlNet, Field, Subdivision, TetMesh, block, subdivision
from bezsoma.mesh.subdivision import shortest_diagonals
from tolerances import ROUNDING

RNG = np.random.default_rng(5)
UNIT = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])


def ragged() -> TetMesh:
    """Two regions, places of every kind, and tets whose shortest diagonals are all three."""
    mesh = block((3.0, 2.0, 2.5), (2, 2, 2), (70.0, -40.0, 9.0), irregular=0.3, seed=3)
    region = (mesh.points[mesh.tets].mean(axis=1)[:, 0] > 71.5).astype(int)
    between = [set(map(tuple, sides(mesh.tets[region == k]).tolist())) for k in (0, 1)]
    surfaces = {**mesh.surfaces, "between": sorted(between[0] & between[1])}
    order = np.random.default_rng(2).permutation(len(mesh.points))
    number = np.argsort(order)
    mesh = TetMesh(
        mesh.points[order],
        number[mesh.tets],
        region,
        ("soft", "hard"),
        {name: number[np.array(facets)] for name, facets in surfaces.items()},
    )
    mesh = mesh.with_edges("rim", mesh.all_edges[:3].astype(np.int64))
    return mesh.with_vertices("corner", numbers=[0, 5])


def sides(tets: np.ndarray) -> np.ndarray:
    return np.concatenate([np.delete(tets, i, axis=1) for i in range(4)])


# Children


@pytest.mark.parametrize("diagonal", [0, 1, 2])
@pytest.mark.parametrize("degree", [1, 2, 5])
def test_every_child_holds_the_same_polynomial_in_fractions(degree: int, diagonal: int) -> None:
    size = bernstein.count(degree, 3)
    net = np.array([Fraction(int(k), 7) for k in RNG.integers(-50, 50, size)], dtype=object)
    point = np.array([Fraction(1, 6), Fraction(1, 2), Fraction(1, 12), Fraction(1, 4)])
    for child in bernstein.uniform_children(3, diagonal):
        corners = np.array([[Fraction(x) for x in row] for row in child], dtype=object)
        inner = bernstein.restriction(degree, 3, corners) @ net
        assert (
            bernstein.values(degree, point) @ inner
            == bernstein.values(degree, point @ corners) @ net
        )


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_children_fill_their_parent(dim: int) -> None:
    """Every point lies in one child, unless on a side of one; all are of one size."""
    points = RNG.dirichlet(np.ones(dim + 1), 200)
    for diagonal in range(3 if dim == 3 else 1):
        children = bernstein.uniform_children(dim, diagonal)
        inside = np.stack([(points @ np.linalg.inv(child) > 0).all(axis=1) for child in children])
        assert (inside.sum(axis=0) == 1).all()
        assert np.abs(np.linalg.det(children)) == pytest.approx([0.5**dim] * 2**dim)
        assert (np.diff(uniform_corners(dim, diagonal), axis=1) > 0).all()


@pytest.mark.parametrize("degree", [1, 3, 10])
def test_bisection_split_and_any_other_sub_simplex(degree: int) -> None:
    nets = RNG.normal(size=(6, bernstein.count(degree, 3), 2))
    point = RNG.dirichlet(np.ones(4))
    corners = np.concatenate([bernstein.bisection_children(3, (1, 3), 0.3), [np.eye(4)] * 4])
    corners[2:] = bernstein.split_children(point)
    for chosen in (corners, RNG.dirichlet(np.ones(4), (6, 3))):
        inner = bernstein.restricted(nets, degree, chosen)
        weights = RNG.dirichlet(np.ones(chosen.shape[1]))
        found = np.einsum("m,qmk->qk", bernstein.values(degree, weights), inner)
        wanted = np.einsum("qm,qmk->qk", bernstein.values(degree, weights @ chosen), nets)
        assert np.abs(found - wanted).max() < ROUNDING * np.abs(nets).max()


def test_bisection_and_split_fill_their_parent() -> None:
    points = RNG.dirichlet(np.ones(4), 200)
    inner = np.array([0.1, 0.2, 0.3, 0.4])
    both = bernstein.bisection_children(3, (1, 3), 0.3)
    for children, parts in ((both, [0.3, 0.7]), (bernstein.split_children(inner), inner)):
        inside = np.stack([(points @ np.linalg.inv(child) > 0).all(axis=1) for child in children])
        assert (inside.sum(axis=0) == 1).all()
        assert np.abs(np.linalg.det(children)) == pytest.approx(parts)
    assert both[0, 1].tolist() == [0, 1, 0, 0] and both[1, 3].tolist() == [0, 0, 0, 1]
    assert both[0, 3].tolist() == both[1, 1].tolist() == [0, 0.7, 0, 0.3]


def test_a_child_of_equal_corners_is_not_mistaken_for_another() -> None:
    """Groups are found by bytes: 0.0 and -0.0 are one, neighbours in the last bit are two."""
    corners = np.stack([np.eye(2), np.eye(2) * np.nextafter(1, 2), -0.0 + np.eye(2)])
    corners[2, 0, 1] = -0.0
    found = bernstein.restricted(np.ones((3, 2)), 1, corners)
    assert found[0, 0] == found[2, 0] == 1 and found[1, 0] > 1


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: bernstein.uniform_children(0), "no edges to halve"),
        (lambda: bernstein.uniform_children(3, 3), "diagonals 0, 1 and 2"),
        (lambda: bernstein.bisection_children(2, (1, 1)), "no edge"),
        (lambda: bernstein.bisection_children(2, (0, 1), 1.0), "between 0 and 1"),
        (lambda: bernstein.split_children([0.5, 0.5, 0.0]), "not inside"),
        (lambda: bernstein.split_children([0.5, 0.5, 0.5]), "1 in sum"),
        (lambda: bernstein.restricted(np.ones((2, 4)), 1, np.eye(4)), "one set of"),
    ],
)
def test_what_is_no_child_is_refused(call: object, message: str) -> None:
    with pytest.raises(InputError, match=message):
        call()  # type: ignore[operator]


# Meshes


def test_a_mesh_cut_in_eight_is_the_same_body() -> None:
    mesh = ragged()
    fine = subdivision(mesh).fine
    assert len(set(shortest_diagonals(mesh).tolist())) == 3
    assert len(fine.tets) == 8 * len(mesh.tets) and fine.dropped == 0
    assert len(fine.boundary) == 4 * len(mesh.boundary)  # conforming, or more would be open
    assert np.allclose(fine.volumes.reshape(-1, 8), mesh.volumes[:, None] / 8, rtol=1e-9)
    assert fine.regions == mesh.regions and (fine.region == np.repeat(mesh.region, 8)).all()
    assert set(fine.places) == set(mesh.places)
    for name, facets in mesh.surfaces.items():
        areas = [m.areas(f).sum() for m, f in ((mesh, facets), (fine, fine.surfaces[name]))]
        assert areas[0] == pytest.approx(areas[1], rel=1e-12)
        assert len(fine.surfaces[name]) == 4 * len(facets)
    assert len(fine.edges["rim"]) == 6
    assert (fine.points[fine.vertices["corner"]] == mesh.points[mesh.vertices["corner"]]).all()
    outer = mesh.normals(mesh.boundary).round(9).tolist()
    assert {tuple(n) for n in fine.normals(fine.boundary).round(9).tolist()} <= set(
        map(tuple, outer)
    )


def test_the_shortest_diagonal_is_taken_and_children_stay_round() -> None:
    flat = TetMesh(UNIT * [1.0, 1.0, 0.2], [[0, 1, 2, 3]])
    middles = np.array([(flat.points[i] + flat.points[j]) / 2 for i, j in flat.all_edges])
    lengths = [np.linalg.norm(middles[i] - middles[j]) for i, j in ((0, 5), (1, 4), (2, 3))]
    assert shortest_diagonals(flat)[0] == np.argmin(lengths)
    mesh, worst = flat, []
    for _ in range(3):
        fine = subdivision(mesh).fine
        corners = fine.points[fine.tets]
        longest = np.linalg.norm(corners[:, :, None] - corners[:, None], axis=3).max(axis=(1, 2))
        worst.append((longest**3 / fine.volumes).max())
        mesh = fine
    assert worst[2] < 1.5 * worst[0]


@pytest.mark.parametrize("degree", range(1, 11))
def test_a_field_on_the_finer_mesh_is_the_same_polynomial(degree: int) -> None:
    mesh = ragged() if degree < 6 else block(cells=1, irregular=0.3)
    net = ControlNet(mesh, degree)
    field = Field(net, np.random.default_rng(degree).normal(size=(net.count, 2)))
    broken = BrokenField(mesh, degree - 1, RNG.normal(size=(len(mesh.tets), net_size(degree), 1)))
    finer = subdivision(mesh)
    tets = RNG.integers(0, len(finer.fine.tets), 200)
    bary = RNG.dirichlet(np.ones(4), 200)
    above = np.einsum("pi,pij->pj", bary, finer.corners[tets])
    for old in (field, broken):
        fine = old.subdivided(finer)
        wanted = old.at_bary(finer.parent[tets], above)
        assert np.abs(fine.at_bary(tets, bary) - wanted).max() < ROUNDING * np.abs(wanted).max()
    places = np.einsum("pi,pid->pd", bary, finer.fine.points[finer.fine.tets[tets]])
    origin = np.einsum("pi,pid->pd", above, mesh.points[mesh.tets[finer.parent[tets]]])
    assert np.allclose(places, origin, rtol=1e-13)


def net_size(degree: int) -> int:
    return bernstein.count(degree - 1, 3)


def test_neighbours_agree_on_the_finer_mesh() -> None:
    """What one tet writes into a shared control, its neighbours would have written as well."""
    mesh = ragged()
    net = ControlNet(mesh, 4)
    field = Field(net, RNG.normal(size=net.count))
    finer = subdivision(mesh)
    fine = field.subdivided(finer)
    assert np.abs(fine.of_tet - finer.nets(field)).max() < 1e-14
    assert fine.integral() == pytest.approx(float(field.integral()), rel=1e-12)
    assert field.subdivided().elevated(6).h1_seminorm() == pytest.approx(
        field.h1_seminorm(), rel=1e-11
    )


def test_corners_that_are_elsewhere_are_refused() -> None:
    mesh = block()
    finer = subdivision(mesh)
    with pytest.raises(InputError, match="tet 0 of the finer mesh is not where"):
        Subdivision(mesh, finer.fine, finer.parent, finer.corners[:, [1, 0, 2, 3]])
    other = block(cells=(2, 1, 1))
    with pytest.raises(InputError, match="another mesh"):
        BrokenField(other, 0, np.ones((12, 1))).subdivided(finer)


# Nets and graphs


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_nets_become_graphs_four_times_nearer_at_each_level(dim: int) -> None:
    degree, most = 4, {1: 8, 2: 5, 3: 3}[dim]
    net = RNG.normal(size=bernstein.count(degree, dim))
    away = []
    for level in range(most + 1):
        corners, nets = bernstein.uniform_nets(net, degree, dim, level)
        assert len(corners) == len(nets) == 2 ** (dim * level)
        away.append(bernstein.graph_distance(nets, degree, dim))
    assert away[-2] / away[-1] == pytest.approx(4, rel=0.35)
    bary = RNG.dirichlet(np.ones(dim + 1), len(nets))
    here = np.einsum("sm,sm->s", bernstein.values(degree, bary), nets)
    there = bernstein.values(degree, np.einsum("si,sij->sj", bary, corners)) @ net
    assert np.abs(here - there).max() < ROUNDING * np.abs(net).max()


# Bounds


@settings(max_examples=30, deadline=None)
@given(
    st.integers(0, 7), st.integers(1, 3), st.integers(0, 10_000), st.sampled_from([0.3, 1e-2, 1e-4])
)
def test_bounds_enclose_and_are_as_near_as_was_asked(
    degree: int, dim: int, seed: int, tolerance: float
) -> None:
    rng = np.random.default_rng(seed)
    nets = rng.normal(size=(3, bernstein.count(degree, dim), 2))
    low, high = bernstein.bounds(nets, degree, dim, tolerance)
    lattice = bernstein.domain_points(20, dim)
    values = np.einsum("bm,qmk->qbk", bernstein.values(degree, lattice), nets)
    below, above = values.min(axis=1), values.max(axis=1)
    assert (low <= below + 1e-13).all() and (high >= above - 1e-13).all()
    # the lattice itself misses the extremes, by what its spacing allows
    missed = np.abs(nets).max() * degree**2 * 4 * 0.05**2
    assert (low >= below - tolerance - missed).all()
    assert (high <= above + tolerance + missed).all()
    outer = bernstein.bounds(nets, degree, dim)
    assert (outer[0] <= low).all() and (outer[1] >= high).all()


def test_bounds_tighten_quadratically() -> None:
    """The extreme controls of 8^l children, against the true maximum of a known polynomial."""
    x, y, z = bernstein.domain_points(4, 3)[:, 1:].T  # maximum 1 in the centroid of the tet
    net = bernstein.interpolation(4, 3) @ (256 * x * y * z * (1 - x - y - z))
    gaps = []
    for level in range(4):
        _, nets = bernstein.uniform_nets(net, 4, 3, level)
        gaps.append(nets.max() - 1)
    assert gaps[0] > 1
    assert (np.array(gaps) * 4.0 ** np.arange(4) <= 1.0001 * gaps[0]).all()
    assert gaps[3] > 0  # never below the maximum
    for tolerance in (1e-2, 1e-4, 1e-6):
        low, high = bernstein.bounds(net[None], 4, 3, tolerance)
        assert 1 - 1e-13 <= high[0] <= 1 + tolerance
        assert -tolerance <= low[0] <= 0


def test_bounds_of_a_mesh_are_those_of_its_worst_tet() -> None:
    mesh = block(cells=(2, 2, 2), irregular=0.3)
    wave = Field.interpolating(
        ControlNet(mesh, 3), lambda p: np.stack([bump(p, 0.4), p[:, 1] * p[:, 2]], axis=1)
    )
    low, high = wave.bounds_of_tets(1e-3)
    values = wave.tabulated(bernstein.domain_points(12, 3))
    assert (low <= values.min(axis=1) + 1e-12).all() and (values.max(axis=1) - 1e-12 <= high).all()
    assert (high - values.max(axis=1)).max() < 0.02
    bounds = wave.bounds(1e-3)
    assert np.allclose(bounds[0], low.min(axis=0), atol=2e-3)
    assert np.allclose(bounds[1], high.max(axis=0), atol=2e-3)
    assert bounds[1][1] == 1  # at a corner of the block, taken
    stress = wave.gradient_field()
    assert (stress.bounds(0.1)[1] <= stress.bounds()[1]).all()


def bump(points: np.ndarray, width: float) -> np.ndarray:
    away = ((points - [0.4, 0.45, 0.6]) ** 2).sum(axis=1)
    return np.asarray(np.exp(-away / width**2))


def test_a_ridge_that_would_take_too_long_is_refused() -> None:
    """The maximum is taken on a whole plane, and each halving has four times as many at it."""
    net = bernstein.interpolation(2, 3) @ -((bernstein.domain_points(2, 3)[:, 1] - 0.3) ** 2)
    assert bernstein.bounds(net[None], 2, 3, 1e-3)[1][0] == pytest.approx(0, abs=1e-3)
    with pytest.raises(InputError, match="along a line or a surface"):
        bernstein.bounds(net[None], 2, 3, 1e-11)


@pytest.mark.parametrize("tolerance", [0.0, -1.0, float("nan"), 1e-15])
def test_a_tolerance_below_rounding_is_refused(tolerance: float) -> None:
    with pytest.raises(InputError, match="give a larger tolerance"):
        bernstein.bounds(np.ones((1, 10)), 2, 3, tolerance)
