# SPDX-License-Identifier: BSD-3-Clause
"""Finding the tet of a point and the nearest point of a surface, against trying them all."""

from __future__ import annotations

import gc
import weakref

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import nnls
from scipy.spatial import Delaunay

from bezsoma.errors import InputError
from bezsoma.mesh import locator as module
from bezsoma.mesh.bins import BoxBins
from bezsoma.mesh.locator import Locator
from bezsoma.mesh.solids import ball, block
from bezsoma.mesh.tets import TetMesh
from bezsoma.mesh.triangles import Triangles, nearest_on_triangles

FLAT = 1e-6
"""Tets of a triangulation that are flatter than this, relative to their size, are left out."""


def triangulated(points: np.ndarray) -> TetMesh:
    """A Delaunay mesh, slivers included."""
    tets = Delaunay(points).simplices
    corners = points[tets]
    edges = corners[:, 1:] - corners[:, :1]
    size = np.abs(edges).max(axis=(1, 2))
    return TetMesh(points, tets[np.abs(np.linalg.det(edges)) > FLAT * size**3])


def graded(ratio: float) -> TetMesh:
    """A block whose cells grow from 1/ratio to 1: tets of very different size side by side."""
    solid = block(cells=(6, 6, 6), irregular=0.3, seed=5)
    return TetMesh(ratio ** (solid.points - 1.0), solid.tets)


def flattened() -> TetMesh:
    """A block squeezed a thousandfold: every tet is a sliver."""
    return block(cells=(5, 5, 5), irregular=0.3, seed=2).moved(np.diag([1.0, 1.0, 1e-3]))


MESHES = {
    "random": lambda: triangulated(np.random.default_rng(0).normal(size=(150, 3))),
    "slivers": lambda: triangulated(
        np.random.default_rng(1).normal(size=(150, 3)) * [1, 1, 1e-2] + [0, 0, 1e3]
    ),
    "graded": lambda: graded(1e4),
    "flattened": flattened,
    "far away": lambda: block(cells=(3, 3, 3), origin=(1000.0, -1000.0, 1500.0), irregular=0.3),
    "one tet": lambda: TetMesh(np.eye(4, 3), [[0, 1, 2, 3]]),
    "two parts": lambda: TetMesh(
        np.concatenate([np.eye(4, 3), np.eye(4, 3) * 1e-3 + 5.0]), [[0, 1, 2, 3], [4, 5, 6, 7]]
    ),
}


@pytest.fixture(scope="module", params=MESHES)
def mesh(request: pytest.FixtureRequest) -> TetMesh:
    return MESHES[request.param]()


def all_bary(mesh: TetMesh, points: np.ndarray) -> np.ndarray:
    """The coordinates of every point in every tet, by Cramer's rule from volumes (p, t, 4)."""
    corners = mesh.points[mesh.tets]
    whole = np.linalg.det(corners[:, 1:] - corners[:, :1])
    bary = np.empty((len(points), len(mesh.tets), 4))
    for i in range(4):
        others = np.delete(corners, i, axis=1)[None] - points[:, None, None, :]
        bary[..., i] = np.linalg.det(others) / whole * (-1) ** i
    return bary


def inside_points(mesh: TetMesh, count: int, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    tets = rng.integers(0, len(mesh.tets), count)
    bary = rng.dirichlet([0.6] * 4, count)
    return tets, np.einsum("pi,pid->pd", bary, mesh.points[mesh.tets[tets]])


def box_points(mesh: TetMesh, count: int, seed: int = 0) -> np.ndarray:
    low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
    middle, half = (low + high) / 2, (high - low) * 0.7
    return np.random.default_rng(seed).uniform(middle - half, middle + half, (count, 3))


def rebuilt(mesh: TetMesh, tets: np.ndarray, bary: np.ndarray) -> np.ndarray:
    return np.einsum("pi,pid->pd", bary, mesh.points[mesh.tets[tets]])


def test_points_inside_are_found(mesh: TetMesh) -> None:
    _, points = inside_points(mesh, 400)
    tets, bary = Locator(mesh).tets_of(points)
    assert (tets >= 0).all()
    size = np.ptp(mesh.points[mesh.tets[tets]], axis=1).max(axis=1)
    scale = np.abs(mesh.points).max()
    distance = np.linalg.norm(rebuilt(mesh, tets, bary) - points, axis=1)
    assert (distance <= 1e-14 * (size + scale)).all()
    assert np.abs(bary.sum(axis=1) - 1).max() < 1e-14


def test_all_points_are_judged_as_by_trying_every_tet(mesh: TetMesh) -> None:
    """Also those outside, in holes and between parts; doubt is left only within rounding."""
    points = np.concatenate([box_points(mesh, 300), inside_points(mesh, 100, seed=3)[1]])
    tets, bary = Locator(mesh).tets_of(points)
    least = all_bary(mesh, points).min(axis=2)
    certain = np.abs(least).min(axis=1) > 1e-6
    expected = np.where((least > 0).any(axis=1), (least > 0).argmax(axis=1), -1)
    assert certain.sum() > 300
    assert np.array_equal(tets[certain], expected[certain])
    assert np.isnan(bary[tets < 0]).all()
    assert np.isfinite(bary[tets >= 0]).all()


def test_points_on_vertices_edges_and_faces_go_to_the_lowest_tet(mesh: TetMesh) -> None:
    locator = Locator(mesh)
    for rows in (np.arange(len(mesh.points))[:, None], mesh.all_edges, mesh.all_faces):
        chosen = rows[np.random.default_rng(1).permutation(len(rows))[:80]]
        tets, _ = locator.tets_of(mesh.points[chosen].mean(axis=1))
        owned = (chosen[:, None, :, None] == mesh.tets[None, :, None, :]).any(axis=3).all(axis=2)
        assert (tets >= 0).all()
        assert (tets <= owned.argmax(axis=1)).all()  # lower only where rounding cannot tell


def test_on_a_clean_grid_the_owner_is_exactly_the_lowest() -> None:
    mesh = block(cells=(3, 3, 3))
    tets, _ = Locator(mesh).tets_of(mesh.points)
    assert np.array_equal(
        tets, [np.flatnonzero((mesh.tets == v).any(axis=1))[0] for v in range(64)]
    )


@pytest.mark.parametrize("height", [1e-2, 1e-4, 1e-6])
def test_coordinates_in_a_sliver_give_the_point_back(height: float) -> None:
    """However ill-conditioned they are, what they stand for is the point, to rounding."""
    rng = np.random.default_rng(0)
    points = rng.normal(size=(4, 3)) * 10 + 300
    points[3] = np.array([0.31, 0.33, 0.36]) @ points[:3] + height * rng.normal(size=3)
    mesh = TetMesh(points, [[0, 1, 2, 3]])
    asked = rng.dirichlet([1.0] * 4, 200) @ mesh.points
    tets, bary = Locator(mesh).tets_of(asked)
    assert (tets == 0).all()
    assert np.abs(bary @ mesh.points - asked).max() < 4e-13


def test_just_outside_by_rounding_is_inside_and_a_little_more_is_not() -> None:
    mesh = block(size=(2.0, 2.0, 2.0), cells=(2, 2, 2))
    face = np.array([[0.3, 0.4, 2.0], [0.0, 1.1, 0.7], [2.0, 2.0, 2.0]])
    outward = np.array([[0.0, 0, 1], [-1, 0, 0], [1, 1, 1]])
    locator = Locator(mesh)
    assert (locator.tets_of(face + 1e-12 * outward)[0] >= 0).all()
    assert (locator.tets_of(face + 1e-8 * outward)[0] == -1).all()
    assert (locator.tets_of(face * 1e9)[0] == -1).all()


def test_no_points_are_no_trouble() -> None:
    tets, bary = Locator(block()).tets_of(np.empty((0, 3)))
    assert tets.shape == (0,)
    assert bary.shape == (0, 4)
    assert len(Locator(block()).nearest(np.empty((0, 3))).facet) == 0


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 10**6), st.floats(1.0, 1e5), st.integers(0, 200))
def test_bins_never_miss_a_box(seed: int, ratio: float, count: int) -> None:
    rng = np.random.default_rng(seed)
    low = rng.uniform(-1, 1, (count + 1, 3))
    high = low + rng.uniform(0, 1, low.shape) * ratio ** -rng.uniform(0, 1, (count + 1, 1))
    points = np.concatenate([rng.uniform(-1.5, 1.5, (40, 3)), low[:5], high[:5]])
    expected = ((points[:, None] >= low) & (points[:, None] <= high)).all(axis=2)
    found = np.zeros_like(expected)
    for asked, boxes in BoxBins.of(low, high).around(points, most=50):
        found[asked, boxes] = True
    assert np.array_equal(found, expected)


def test_bins_hold_where_cells_share_a_number() -> None:
    """Tiny boxes farther apart than the cell numbers reach: time is lost, no box is."""
    low = np.array([[0.0, 0, 0], [2.0**19, 0, 0], [2.0**20, 3, 0]])
    bins = BoxBins.of(low, low + 0.99)
    pairs = [
        tuple(map(int, p)) for a, b in bins.around(low + 0.5, 10) for p in zip(a, b, strict=True)
    ]
    assert sorted(pairs) == [(0, 0), (1, 1), (2, 2)]


def test_nearest_is_nearest_of_all_facets(mesh: TetMesh) -> None:
    points = np.concatenate([box_points(mesh, 120), mesh.points[:10], mesh.points[:10] * 30 + 7])
    near = Locator(mesh).nearest(points)
    corners = mesh.points[mesh.boundary]
    every = np.stack(
        [nearest_on_triangles(np.repeat(p[None], len(corners), axis=0), corners)[1] for p in points]
    )
    scale = np.abs(mesh.points).max() + np.abs(points).max()
    assert np.abs(near.distance - every.min(axis=1)).max() <= 1e-13 * scale
    foot = np.einsum("pi,pid->pd", near.bary, corners[near.facet])
    assert np.abs(np.linalg.norm(foot - points, axis=1) - near.distance).max() <= 1e-13 * scale
    assert near.bary.min() >= 0
    assert np.abs(near.bary.sum(axis=1) - 1).max() < 1e-14


def test_nearest_agrees_with_least_squares_over_the_triangle() -> None:
    """An independent judge, over needles and flat triangles too.

    Minimise |sum w_i v_i - x| over w >= 0, with sum w_i = 1 as a heavy equation (Lawson, Hanson).
    """
    rng = np.random.default_rng(4)
    corners = rng.normal(size=(300, 3, 3))
    corners[100:200, 2] = corners[100:200, :2].mean(axis=1) + 1e-5 * rng.normal(size=(100, 3))
    corners[200:, 1] = corners[200:, 0] + 1e-6 * rng.normal(size=(100, 3))
    points = rng.normal(size=(300, 3)) * 2
    bary, distance = nearest_on_triangles(points, corners)
    assert bary.min() >= 0
    for point, triangle, found in zip(points, corners, distance, strict=True):
        heavy = np.vstack([triangle.T - point[:, None], np.full(3, 1e5)])
        weights, _ = nnls(heavy, [0.0, 0.0, 0.0, 1e5])
        best = np.linalg.norm(triangle.T @ (weights / weights.sum()) - point)
        assert abs(found - best) < 1e-8


def test_a_triangle_without_area_is_its_longest_side() -> None:
    line = np.array([[[0.0, 0, 0], [1, 0, 0], [2, 0, 0]]])
    bary, distance = nearest_on_triangles(np.array([[1.5, 2.0, 0.0]]), line)
    assert distance[0] == 2.0
    assert np.allclose(bary[0] @ line[0], [1.5, 0, 0])
    point = np.ones((1, 3, 3))
    assert nearest_on_triangles(np.zeros((1, 3)), point)[1][0] == np.sqrt(3)


def test_nearest_on_a_named_surface_counts_its_own_facets() -> None:
    mesh = block(size=(4.0, 4.0, 4.0), cells=(4, 4, 4))
    points = np.array([[1.3, 2.2, 5.0], [9.0, 9.0, 9.0], [1.0, 1.0, 1.0]])
    near = Locator(mesh).nearest(points, "top")
    corners = mesh.points[mesh.facets_of("top")][near.facet]
    foot = np.einsum("pi,pid->pd", near.bary, corners)
    assert np.allclose(foot, [[1.3, 2.2, 4.0], [4, 4, 4], [1, 1, 4]])
    assert np.allclose(near.distance, [1.0, np.sqrt(75), 3.0])


def test_nearest_from_the_middle_of_a_ball_where_all_facets_tie() -> None:
    mesh = ball(radius=3.0, cells=4)
    near = Locator(mesh).nearest(np.zeros((1, 3)))
    corner = mesh.points[mesh.boundary[:, 0]]
    heights = np.abs(np.einsum("fd,fd->f", corner, mesh.normals(mesh.boundary)))
    assert near.distance[0] == pytest.approx(heights.min(), rel=1e-13)


def test_points_on_the_boundary_lead_into_their_tet() -> None:
    mesh = block(cells=(3, 3, 3), irregular=0.3)
    locator, points = Locator(mesh), box_points(block(cells=(3, 3, 3)), 50) * 3 + 2
    near = locator.nearest(points)
    tets, bary = locator.in_tets(near)
    foot = np.einsum("pi,pid->pd", near.bary, mesh.points[mesh.boundary[near.facet]])
    assert np.allclose(rebuilt(mesh, tets, bary), foot, atol=1e-15)


def test_bins_are_made_once_a_mesh_and_die_with_it() -> None:
    mesh = block(cells=(2, 2, 2))
    bins = Locator(mesh).bins
    assert Locator(mesh).bins is bins
    assert mesh in module._BINS
    gone = weakref.ref(mesh)
    del mesh
    gc.collect()
    assert gone() is None


def test_faults_are_named() -> None:
    locator = Locator(block())
    with pytest.raises(InputError, match=r"shape \(3,\) were given; \(p, 3\) in mm is needed"):
        locator.tets_of(np.zeros(3))
    with pytest.raises(InputError, match=r"point 1 is \[nan, 0.0, 0.0\]; it has to be finite"):
        locator.nearest(np.array([[0.0, 0, 0], [np.nan, 0, 0]]))
    with pytest.raises(InputError, match=r"no surface 'tip'.*did you mean 'top'"):
        locator.nearest(np.zeros((1, 3)), "tip")
    with pytest.raises(InputError, match="without facets has no nearest point"):
        Triangles.of(np.empty((0, 3, 3)))
