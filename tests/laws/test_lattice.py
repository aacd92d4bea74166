# SPDX-License-Identifier: BSD-3-Clause
"""Graded lattices fill boxes without a hanging vertex; what is cut from them has known volumes."""

from __future__ import annotations

import numpy as np
import pytest

from bezsoma.arrays import Floats
from bezsoma.mesh import TetMesh, block, stuffing
from bezsoma.mesh.bettered import bettered
from bezsoma.mesh.graded import Octree, lattice
from bezsoma.mesh.pinches import pinched, unpinched
from bezsoma.mesh.quality import dihedral_angles, least_sines
from bezsoma.mesh.stuffing import Stuffed, stuffed
from tolerances import ANGLE


@pytest.mark.parametrize("seed", range(4))
def test_a_graded_lattice_has_no_hanging_vertex(seed: int) -> None:
    """A face that only one tet has lies on a side of the box: else two tets would not fit."""
    random = np.random.default_rng(seed)
    shape = (16, 24, 8)
    sizes = np.full(shape, 8.0)
    sizes[tuple(random.integers(0, shape, (5, 3)).T)] = random.choice([1.0, 2.0, 4.0], 5)
    vertices, tets = lattice(Octree.of(sizes, 1.0, 3))
    mesh = TetMesh(vertices.astype(float), tets)
    facets = mesh.points[mesh.boundary]
    flat = [(facets[..., k] == end).all(axis=1) for k in range(3) for end in (0, 2 * shape[k])]
    assert np.logical_or.reduce(flat).all()
    assert mesh.volumes.sum() == pytest.approx(8 * np.prod(shape), rel=1e-12)
    assert 44.9 < dihedral_angles(mesh).min() and dihedral_angles(mesh).max() < 120.1


def test_cells_are_about_as_large_as_wanted_and_balanced() -> None:
    random = np.random.default_rng(1)
    sizes = np.exp(random.uniform(0, 2.5, (16, 16, 16)))
    level = Octree.of(sizes, 1.0, 3).level
    assert (2.0**level <= np.sqrt(2) * np.maximum(sizes, 1)).all()
    for axis in range(3):
        assert np.abs(np.diff(level, axis=axis)).max() <= 1


def egg(points: Floats) -> Floats:
    return np.asarray(np.linalg.norm(points / [1, 0.8, 1.2], axis=1) - 6)


def cut_egg(beyond: float = 0.0) -> Stuffed:
    """An egg with half axes 6, 4.8, 7.2, its middle so far beyond the plane that cuts it."""
    shape = (12, 24, 24)
    centres = np.moveaxis(np.indices(shape), 0, -1) * 0.8 + [0.4, -9.2, -9.2]
    sizes = 0.8 + 0.08 * np.linalg.norm(centres - [0, 0, 7], axis=-1)
    vertices, tets = lattice(Octree.of(sizes, 0.8, 2))
    on_side = np.zeros(vertices.shape, np.bool_)
    on_side[:, 0] = vertices[:, 0] == 0
    points = vertices * 0.4 + [0, -9.6, -9.6]
    return stuffed(points, tets, on_side, lambda x: egg(x - [beyond, 0, 0]))


def test_half_an_egg_has_half_its_volume_and_a_flat_side() -> None:
    body = cut_egg()
    mesh = TetMesh(body.points, body.tets)
    half = 2 / 3 * np.pi * 6 * 4.8 * 7.2
    assert mesh.volumes.sum() == pytest.approx(half, rel=0.03) and mesh.volumes.sum() < half
    assert not len(pinched(mesh.boundary)) and not mesh.components().any()
    facets = mesh.boundary
    flat = (mesh.points[facets][..., 0] == 0).all(axis=1)
    assert mesh.areas(facets[flat]).sum() == pytest.approx(np.pi * 4.8 * 7.2, rel=0.03)
    curved = np.unique(facets[~flat])
    assert np.abs(egg(mesh.points[curved])).max() < 0.01
    assert body.on_surface[curved].all()


@pytest.mark.parametrize("beyond", [-4.0, 4.0])
def test_what_lies_on_the_cut_stays_on_it_where_the_surface_meets_it_at_a_slant(
    beyond: float,
) -> None:
    body = cut_egg(beyond)
    cut = body.on_side[:, 0]
    assert cut.sum() > 20 and (body.points[cut, 0] == 0).all()
    assert (body.points[~cut, 0] > 0).all()


def test_vertices_move_to_better_angles_and_stay_where_they_belong() -> None:
    before = cut_egg()
    shaken = before.points.copy()
    inner = ~before.on_surface & ~before.on_side.any(axis=1)
    shaken[inner] += np.random.default_rng(0).uniform(-0.15, 0.15, (inner.sum(), 3))
    worse = Stuffed(shaken, before.tets, before.on_surface, before.on_side)
    after = bettered(worse, egg)

    def least(body: Stuffed) -> float:
        return float(np.abs(least_sines(body.points[body.tets])).min())

    assert least(after) > least(worse) and least(after) > np.sin(np.radians(ANGLE))
    assert (after.points[after.on_side[:, 0], 0] == 0).all()
    assert np.abs(egg(after.points[after.on_surface])).max() < 0.03
    assert np.array_equal(bettered(worse, egg).points, after.points)


def test_tets_that_touch_along_an_edge_are_parted() -> None:
    whole = block((2, 2, 1), (2, 2, 1))
    points, tets = whole.points, whole.tets
    middle = points[tets].mean(axis=1)
    corner = (middle[:, 0] < 1) == (middle[:, 1] < 1)
    assert len(pinched(TetMesh(points, tets[corner]).boundary))
    keep = unpinched(points, tets[corner])
    assert not len(pinched(TetMesh(points, tets[corner][keep]).boundary))
    assert keep.sum() >= len(keep) // 2


@pytest.mark.parametrize("near", [0.0, 0.4])
@pytest.mark.parametrize("seed", range(3))
def test_a_plane_through_the_middle_leaves_half_of_a_box(
    near: float, seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With near = 0 no vertex moves, so tets are cut in every way that there is."""
    monkeypatch.setattr(stuffing, "NEAR", near)
    sizes = np.full((8, 8, 8), 4.0)
    sizes[2, 3, 4] = 1.0
    vertices, tets = lattice(Octree.of(sizes, 1.0, 2))
    normal = np.random.default_rng(seed).normal(size=3)
    points = vertices / 2 - 4
    free = np.zeros(vertices.shape, np.bool_)
    inner = ~((vertices == 0) | (vertices == 16)).any(axis=1)
    body = stuffed(points, tets, ~inner[:, None] | free, lambda x: x @ normal)
    mesh = TetMesh(body.points, body.tets)
    assert mesh.volumes.sum() == pytest.approx(256, rel=1e-3 if near == 0 else 0.1)
    assert not len(pinched(mesh.boundary))
