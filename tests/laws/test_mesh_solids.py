# SPDX-License-Identifier: BSD-3-Clause
"""The simple solids: volumes and areas by formula, named surfaces, shapes of tets."""

from __future__ import annotations

import math
from itertools import combinations

import numpy as np
import pytest

from bezsoma.mesh import TetMesh, ball, block, cook, l_block, round_bar, shell, square_bar

SOLIDS = {
    "block": (block((2, 3, 4), (2, 3, 5)), 24.0, 52.0),
    "irregular": (block((2, 3, 4), 3, origin=(-1, 5, 2), irregular=1 / 3, seed=3), 24.0, 52.0),
    "square bar": (square_bar(2, 7, 2, 7), 28.0, 64.0),
    "round bar": (
        round_bar(2, 3, cells=5, layers=7),
        3 * 10 * 4 * math.sin(math.tau / 20),
        2 * 10 * 4 * math.sin(math.tau / 20) + 3 * 20 * 2 * 2 * math.sin(math.tau / 40),
    ),
    "cook": (cook((4, 4, 1), 12.0), 17280.0, None),
    "L": (l_block(2, 3, 2, 2), 36.0, 2 * 12 + 3 * 16),
    "octahedron": (ball(3, 1), 4 / 3 * 27, 8 * math.sqrt(3) / 2 * 9),
    "ball": (ball(1, 4), None, None),
    "octant": (ball(1, 4, octant=True), None, None),
    "shell": (shell(1, 2, 4), None, None),
    "hollow": (shell(1, 2, 3, layers=2, octant=False), None, None),
}


@pytest.mark.parametrize("name", SOLIDS)
def test_volume_and_area(name: str) -> None:
    mesh, volume, area = SOLIDS[name]
    if volume is not None:
        assert mesh.volumes.sum() == pytest.approx(volume, rel=1e-13)
    if area is not None:
        assert mesh.areas(mesh.boundary).sum() == pytest.approx(area, rel=1e-13)


@pytest.mark.parametrize("name", SOLIDS)
def test_named_surfaces_tile_the_boundary(name: str) -> None:
    """Every facet of the boundary belongs to one surface, none to two."""
    mesh = SOLIDS[name][0]
    facets = np.concatenate(list(mesh.surfaces.values()))
    assert sorted(facets.tolist()) == mesh.boundary.tolist()


@pytest.mark.parametrize("name", SOLIDS)
def test_tets_are_well_shaped(name: str) -> None:
    """Mean ratio 12 (3 V)^(2/3) / sum of squared edges: 1 for a regular tet, 0 for a flat one."""
    mesh = SOLIDS[name][0]
    corners = np.moveaxis(mesh.points[mesh.tets], 1, 0)
    squares = sum(((a - b) ** 2).sum(axis=1) for a, b in combinations(corners, 2))
    ratio = 12 * (3 * mesh.volumes) ** (2 / 3) / squares
    assert ratio.min() > (0.2 if name == "cook" else 0.4)


@pytest.mark.parametrize("name", SOLIDS)
def test_one_piece(name: str) -> None:
    assert set(SOLIDS[name][0].components().tolist()) == {0}


@pytest.mark.parametrize("irregular", [0.0, 1 / 3])
def test_sides_of_a_block_stay_flat_and_where_they_are(irregular: float) -> None:
    mesh = block((2, 3, 4), 3, origin=(-1, 5, 2), irregular=irregular)
    for axis, (low, high) in enumerate((("left", "right"), ("front", "back"), ("bottom", "top"))):
        for name, sign in ((low, -1), (high, 1)):
            plane = (-1, 5, 2)[axis] + (0 if sign < 0 else (2, 3, 4)[axis])
            assert mesh.points[mesh.vertices_of(name), axis] == pytest.approx(plane, abs=0)
            normals = mesh.normals(mesh.surfaces[name])
            assert normals == pytest.approx(np.tile(sign * np.eye(3)[axis], (len(normals), 1)))


def test_irregular_is_reproducible_and_moves_inner_vertices() -> None:
    a, b, c = (block(cells=4, irregular=0.3, seed=seed) for seed in (1, 1, 2))
    assert (a.points == b.points).all()
    assert not (a.points == c.points).all()
    moved = np.abs(a.points - block(cells=4).points).max(axis=0)
    assert (moved > 0.02).all()
    assert (moved <= 0.3 / 2 / 4).all()


def test_round_surfaces_lie_on_their_spheres() -> None:
    for mesh in (shell(1, 2, 5), shell(1, 2, 5, octant=False)):
        for name, radius in (("inner", 1.0), ("outer", 2.0)):
            distance = np.linalg.norm(mesh.points[mesh.vertices_of(name)], axis=1)
            assert distance == pytest.approx(radius, rel=1e-15)
    inner = shell(1, 2, 5)
    at = inner.points[inner.surfaces["inner"]].mean(axis=1)
    assert (np.einsum("fd,fd->f", inner.normals(inner.surfaces["inner"]), at) < 0).all()


def test_planes_of_an_octant() -> None:
    for mesh in (ball(2, 3, octant=True), shell(1, 2, 3)):
        for axis, name in enumerate(("x0", "y0", "z0")):
            assert (mesh.points[mesh.vertices_of(name), axis] == 0).all()
            normals = mesh.normals(mesh.surfaces[name])
            assert (normals == -np.eye(3)[axis]).all()


def test_eight_octants_make_the_whole() -> None:
    for whole, octant in (
        (ball(2, 3), ball(2, 3, octant=True)),
        (shell(1, 2, 3, octant=False), shell(1, 2, 3)),
    ):
        assert len(whole.tets) == 8 * len(octant.tets)
        assert whole.volumes.sum() == pytest.approx(8 * octant.volumes.sum(), rel=1e-13)
        area = octant.areas(octant.surfaces["outer"]).sum()
        assert whole.areas(whole.surfaces["outer"]).sum() == pytest.approx(8 * area, rel=1e-13)


@pytest.mark.parametrize(
    ("solid", "exact"),
    [
        (lambda n: ball(1, n), 4 / 3 * math.pi),
        (lambda n: shell(1, 2, n), 7 / 6 * math.pi),
        (lambda n: round_bar(1, 1, n, 1), math.pi),
    ],
)
def test_round_volumes_converge_with_the_square_of_the_size(solid, exact: float) -> None:  # type: ignore[no-untyped-def]
    coarse, fine = (exact - solid(n).volumes.sum() for n in (4, 8))
    assert 0 < fine < coarse
    assert math.log2(coarse / fine) > 1.9


def test_cook_has_its_corners_and_sides() -> None:
    mesh = cook((3, 2, 1), 2.0)
    places = {tuple(point) for point in mesh.points.tolist()}
    assert {(0, 0, 0), (48, 44, 0), (48, 60, 2), (0, 44, 2)} <= places
    areas = {name: mesh.areas(facets).sum() for name, facets in mesh.surfaces.items()}
    expected = {"clamped": 88, "loaded": 32, "front": 1440, "back": 1440}
    assert {name: areas[name] for name in expected} == pytest.approx(expected)
    assert areas["lower"] == pytest.approx(2 * math.hypot(48, 44))
    assert areas["upper"] == pytest.approx(2 * math.hypot(48, 16))


def test_inner_corner_of_the_l() -> None:
    mesh = l_block(2, 3, 2, 2)
    assert mesh.areas(mesh.surfaces["notch"]).sum() == pytest.approx(12)
    corner = mesh.points[mesh.vertices_of("corner")]
    assert (corner[:, :2] == 0).all()
    assert len(mesh.edges["corner"]) == 2


def test_one_number_of_cells_serves_three_axes() -> None:
    assert len(block(cells=2).tets) == len(block(cells=(2, 2, 2)).tets) == 48
    assert isinstance(block(), TetMesh)
