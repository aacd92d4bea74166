# SPDX-License-Identifier: BSD-3-Clause
"""Bisection: whatever is chosen, the mesh stays a mesh, of the same body, with the same names."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import Delaunay

from bezsoma.arrays import Floats, Ints
from bezsoma.errors import InputError
from bezsoma.mesh.broken_field import BrokenField
from bezsoma.mesh.control_net import ControlNet
from bezsoma.mesh.field import Field
from bezsoma.mesh.solids import ball, block
from bezsoma.mesh.tets import TetMesh
from bezsoma.mesh.topology import EDGES
from bezsoma.refinement.bisection import Bisection, Cuts, bisected, cuts_of
from tolerances import ROUNDING


def two_regions(seed: int = 0) -> TetMesh:
    """A block of irregular tets in two regions, with a surface between, an edge and a vertex."""
    mesh = block((3, 2, 2), cells=(3, 2, 2), irregular=0.3, seed=seed)
    region = (mesh.points[mesh.tets].mean(axis=1)[:, 0] > 1.5).astype(int)
    both = mesh.tets_of_face
    between = (both[:, 1] >= 0) & (region[both[:, 0]] != region[both[:, 1]])
    places = {**mesh.surfaces, "between": mesh.all_faces[between]}
    corner = int(np.argmin(mesh.points.sum(axis=1)))
    edges = {"rim": mesh.all_edges[(mesh.points[mesh.all_edges][:, :, 1:] == 0).all(axis=(1, 2))]}
    return TetMesh(
        mesh.points, mesh.tets, region, ("soft", "stiff"), places, edges, {"corner": [corner]}
    )


def scattered(seed: int = 0) -> TetMesh:
    """The Delaunay tets of a few points drawn at random: first cuts of every kind."""
    points = np.random.default_rng(seed).standard_normal((14, 3))
    return TetMesh(points, Delaunay(points).simplices)


def rounds(mesh: TetMesh, choices: list[int]) -> list[Bisection]:
    """One bisection for each number, of tets that it draws."""
    cuts: Cuts | None = None
    found = []
    for choice in choices:
        draw = np.random.default_rng(choice)
        chosen = draw.integers(0, len(mesh.tets), draw.integers(1, 6))
        found.append(bisected(mesh, chosen, cuts, times=1 + choice % 3))
        mesh, cuts = found[-1].mesh, found[-1].cuts
    return found


def lengths(mesh: TetMesh, edges: Ints) -> float:
    ends = mesh.points[edges]
    return float(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).sum())


def quality(mesh: TetMesh) -> Floats:
    """12 (3 V)^(2/3) / sum of squared edges: 1 for the regular tet, 0 for a flat one."""
    corners = mesh.points[mesh.tets]
    squares = sum(((corners[:, i] - corners[:, j]) ** 2).sum(axis=1) for i, j in EDGES)
    return np.asarray(12 * (3 * mesh.volumes) ** (2 / 3) / squares)


choices = st.lists(st.integers(0, 10**6), min_size=1, max_size=5)


@settings(max_examples=25, deadline=None)
@given(choices, st.integers(0, 5))
def test_neighbours_share_whole_faces(chosen: list[int], seed: int) -> None:
    mesh = two_regions(seed)
    outside = mesh.areas(mesh.boundary).sum()
    for step in rounds(mesh, chosen):
        fine = step.mesh
        # A face with one tet alone is part of the boundary, else some vertex hangs in it.
        facets = fine.points[fine.boundary]
        low, high = fine.box
        on_a_side = (facets == low).all(axis=1) | (facets == high).all(axis=1)
        assert on_a_side.any(axis=1).all()
        assert fine.areas(fine.boundary).sum() == pytest.approx(outside, rel=ROUNDING)
        assert len(np.unique(fine.points, axis=0)) == len(fine.points)


@settings(max_examples=25, deadline=None)
@given(choices, st.integers(0, 20))
def test_neighbours_share_whole_faces_whatever_their_first_cuts(
    chosen: list[int], seed: int
) -> None:
    mesh = scattered(seed).with_surface("hull", lambda x: np.ones(len(x), bool))
    assert (cuts_of(mesh).sides == 2).any()  # a block has none of these
    for step in rounds(mesh, chosen):
        fine = step.mesh
        area = mesh.areas(mesh.boundary).sum()
        assert fine.areas(fine.boundary).sum() == pytest.approx(area, rel=ROUNDING)
        assert sorted(fine.surfaces["hull"].tolist()) == fine.boundary.tolist()
        assert fine.volumes.sum() == pytest.approx(mesh.volumes.sum(), rel=ROUNDING)


@settings(max_examples=15, deadline=None)
@given(choices)
def test_volumes_regions_and_places_are_kept(chosen: list[int]) -> None:
    mesh = two_regions()
    fine = rounds(mesh, chosen)[-1].mesh
    assert (fine.regions, fine.places) == (mesh.regions, mesh.places)
    for region in range(2):
        wanted = mesh.volumes[mesh.region == region].sum()
        assert fine.volumes[fine.region == region].sum() == pytest.approx(wanted, rel=ROUNDING)
    for name, facets in mesh.surfaces.items():
        wanted = mesh.areas(facets).sum()
        assert fine.areas(fine.surfaces[name]).sum() == pytest.approx(wanted, rel=ROUNDING)
    assert lengths(fine, fine.edges["rim"]) == pytest.approx(3.0, rel=ROUNDING)
    assert fine.vertices["corner"].tolist() == mesh.vertices["corner"].tolist()
    both = fine.tets_of_face[[*_rows(fine, fine.surfaces["between"])]]
    assert (fine.region[both[:, 0]] != fine.region[both[:, 1]]).all()


def _rows(mesh: TetMesh, facets: Ints) -> Ints:
    known = {tuple(face): i for i, face in enumerate(mesh.all_faces.tolist())}
    return np.array([known[tuple(facet)] for facet in facets.tolist()])


@settings(max_examples=10, deadline=None)
@given(choices, st.integers(1, 6))
def test_a_field_stays_the_same_polynomial(chosen: list[int], degree: int) -> None:
    draw = np.random.default_rng(chosen[0])
    net = ControlNet(two_regions(), degree)
    field = Field(net, draw.standard_normal((net.count, 3)))
    broken = field.gradient_field()
    points = draw.uniform(0, 1, (60, 3)) * [3, 2, 2]
    wanted, slopes = field.at(points), np.abs(broken.at(points))
    for step in rounds(net.mesh, chosen):
        field = field.subdivided(step.into)
        broken = broken.subdivided(step.into)
        assert isinstance(broken, BrokenField)
    assert np.abs(field.at(points) - wanted).max() <= ROUNDING * np.abs(wanted).max()
    assert np.abs(np.abs(broken.at(points)) - slopes).max() <= 10 * ROUNDING * slopes.max()


def test_what_is_chosen_is_cut_and_what_follows_is_little() -> None:
    mesh = two_regions()
    for tet in range(len(mesh.tets)):
        step = bisected(mesh, [tet])
        halves = np.bincount(step.into.parent)
        assert halves[tet] >= 2
        assert halves.max() <= 8
    thrice = bisected(mesh, np.arange(len(mesh.tets)), times=3)
    assert np.bincount(thrice.into.parent).min() >= 8


def shapes(mesh: TetMesh) -> set[tuple[float, ...]]:
    """What does not change where a tet is moved, mirrored or scaled, rounded."""
    corners = mesh.points[mesh.tets]
    squares = np.stack([((corners[:, i] - corners[:, j]) ** 2).sum(axis=1) for i, j in EDGES], 1)
    squares /= np.cbrt(mesh.volumes[:, None] ** 2)
    opposite = np.sort(squares[:, :3] * squares[:, :2:-1], axis=1)
    rounded = np.round(np.concatenate([np.sort(squares, axis=1), opposite], axis=1), 6)
    return {tuple(row) for row in rounded.tolist()}


@pytest.mark.parametrize("seed", [0, 2, 4])
def test_a_tet_has_finitely_many_shapes_among_its_descendants(seed: int) -> None:
    """Its own, and 36 at most for either half: n n! 2^(n - 2) of J. M. Maubach's bisection."""
    mesh = TetMesh(np.random.default_rng(seed).standard_normal((4, 3)), [[0, 1, 2, 3]])
    found: list[set[tuple[float, ...]]] = [shapes(mesh)]
    cuts = None
    for _ in range(11):
        step = bisected(mesh, np.arange(len(mesh.tets)), cuts)
        mesh, cuts = step.mesh, step.cuts
        found.append(found[-1] | shapes(mesh))
    assert len(found[-1]) == len(found[-4]) <= 73


@pytest.mark.parametrize("mesh", [two_regions(3), ball(cells=2)], ids=["irregular", "ball"])
def test_shapes_stay_bounded(mesh: TetMesh) -> None:
    """Cut towards a vertex again and again: after a while nothing new appears."""
    corner, worst, cuts = mesh.points[mesh.boundary[0, 0]], [], None
    for _ in range(24):
        near = np.linalg.norm(mesh.points[mesh.tets] - corner, axis=2).min(axis=1)
        step = bisected(mesh, np.flatnonzero(near == 0), cuts)
        mesh, cuts = step.mesh, step.cuts
        worst.append(float(quality(mesh).min()))
    assert mesh.volumes.min() < 1e-5 * mesh.volumes.max()
    assert worst[-1] > 0.3 * worst[0]
    assert worst[-1] == pytest.approx(worst[12], rel=1e-6)


def test_the_same_choice_gives_the_same_bits_in_any_order() -> None:
    mesh = two_regions()
    one, other = bisected(mesh, [3, 17, 40]), bisected(mesh, [40, 3, 17, 3])
    for a, b in zip(one.mesh.__reduce__()[1][:2], other.mesh.__reduce__()[1][:2], strict=True):
        assert a.tobytes() == b.tobytes()
    assert one.cuts.corners.tobytes() == other.cuts.corners.tobytes()


def test_the_numbering_of_vertices_decides_nothing() -> None:
    """The tags are beside the mesh: with other numbers the same tets come out, elsewhere listed."""
    mesh = two_regions()  # no two edges of one length: there the numbers would have to decide
    order = np.random.default_rng(1).permutation(len(mesh.points))
    renamed = np.argsort(order)
    other = TetMesh(mesh.points[order], renamed[mesh.tets])
    found = []
    for one in (mesh, other):
        each = one
        cuts = None
        for times in (3, 2, 1):
            centres = each.points[each.tets].mean(axis=1)
            near = np.argsort(np.linalg.norm(centres - [1.1, 0.7, 0.4], axis=1))[:5]
            step = bisected(each, near, cuts, times)
            each, cuts = step.mesh, step.cuts
        found.append({tuple(sorted(map(tuple, tet.tolist()))) for tet in each.points[each.tets]})
    assert found[0] == found[1]


def test_nothing_chosen_changes_nothing() -> None:
    mesh = two_regions()
    step = bisected(mesh, [])
    assert step.mesh.tets.tolist() == mesh.tets.tolist()
    assert step.cuts.corners.tolist() == cuts_of(mesh).corners.tolist()


def test_cuts_of_another_mesh_are_refused() -> None:
    with pytest.raises(InputError, match="cuts of 12 other tets were given for this mesh of 6"):
        bisected(block(), [0], bisected(block(), [0]).cuts)


def test_a_tet_that_is_not_there_is_refused() -> None:
    with pytest.raises(InputError, match="tets to bisect"):
        bisected(block(), [6])
