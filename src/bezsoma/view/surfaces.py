# SPDX-License-Identifier: BSD-3-Clause
"""Displaced surfaces as small triangles with the normals that a picture is shaded by.

The triangles have their corners on the exact displaced polynomial patches, as close together as
these bend (`tessellation`), and the normals start as those of the patches. Patches meet at an
angle, though, where a skin is meant to be smooth; so at every corner of a facet the normals of the
facets around are averaged (not across creases, so a block keeps its edges), and each patch takes
the change at its three corners along into its inside. Where the patches meet smoothly nothing
changes: their exact normals are shown.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from bezsoma.arrays import Bools, Floats, Ints, T
from bezsoma.mesh import Field, SurfaceField, TetMesh
from bezsoma.mesh.surface_field import patch_normals
from bezsoma.mesh.topology import cross, packed
from bezsoma.view.lattice import SIDES
from bezsoma.view.restriction import AnyField, controls_on, degree_of, values_at
from bezsoma.view.tessellation import Alike, tessellation


@dataclass(frozen=True, eq=False)
class Surface:
    """Facets cut into triangles: points and outward unit normals at s samples of them.

    A sample belongs to one facet. Facets that are cut alike stand together, in `groups`.
    """

    field: SurfaceField
    groups: tuple[Alike, ...]
    points: Floats
    """(s, 3) mm, displaced."""
    normals: Floats
    """(s, 3) outward, length 1, smoothed across edges that are no creases."""
    vertex: Ints
    """(s,) one number for samples that share point and normal."""

    @property
    def facets(self) -> Ints:
        """(f, 3) vertex numbers of the mesh, ascending."""
        return self.field.facets

    @cached_property
    def places(self) -> Floats:
        """Where the samples (s, 3) lay before the move, mm."""
        return _joined(self.groups, lambda g: g.cut.bary @ self.field.corners[g.facets])

    @cached_property
    def triangles(self) -> Ints:
        """The samples (r, 3) at the corners of each triangle."""
        rows, first = [], 0
        for group in self.groups:
            start = first + np.arange(len(group.facets)) * len(group.cut.bary)
            rows.append((start[:, None, None] + group.cut.triangles).reshape(-1, 3))
            first += group.points.size
        return np.concatenate(rows)

    @cached_property
    def rims(self) -> Bools:
        """(r, 3) whether the edge opposite each triangle's corner lies on an edge of its facet."""
        return np.concatenate(
            [
                np.tile(on_edges(g.cut.bary, g.cut.triangles).any(axis=2), (len(g.facets), 1))
                for g in self.groups
            ]
        )

    def corners(self, samples: npt.NDArray[T]) -> npt.NDArray[T]:
        """Values (r, 3, ...) at the corners of the triangles, from those at samples (s, ...)."""
        return samples[self.triangles]

    def at(self, field: AnyField) -> Floats:
        """The values (s, k) of a field of the mesh at the samples."""
        controls, degree = controls_on(self.field.mesh, field, self.facets), degree_of(field)
        return _joined(self.groups, lambda g: values_at(degree, controls[g.facets], g.cut.bary))


def on_edges(bary: Floats, triangles: Ints) -> Bools:
    """Whether the side opposite corner k of each triangle (q, 3) is on edge j of its facet.

    (q, 3, 3) [triangle, k, j]; edge j of the facet is the one opposite its corner j, and `bary`
    (s, 3) are the places that the triangles join.

    >>> on_edges(np.eye(3), np.array([[0, 1, 2]]))[0].tolist() == np.eye(3, dtype=bool).tolist()
    True
    """
    off = bary[triangles] > 0
    return np.stack([~off[:, [(k + 1) % 3, (k + 2) % 3]].any(axis=1) for k in range(3)], axis=1)


def displaced(
    mesh: TetMesh,
    facets: Ints,
    displacement: Field | None,
    tolerance: float = np.inf,
    crease: float = 0.7,
    magnified: float = 1.0,
    longest: float = np.inf,
) -> Surface:
    """The surface (f facets) moved by the displacement; `crease` in rad, the others in mm.

    No triangle is farther from its patch than `tolerance`, none has sides that were longer than
    `longest`. Two facets that meet at a larger angle than `crease` keep an edge between them. A
    shear along a plane leaves its normal alone, and this is exact:

    >>> from bezsoma.mesh import ControlNet, block
    >>> mesh = block(cells=(1, 1, 1))
    >>> net = ControlNet(mesh, 2)
    >>> field = Field(net, net.interpolated(lambda p: np.c_[p[:, 0] * p[:, 1], 0 * p[:, :2]]))
    >>> top = displaced(mesh, mesh.facets_of("top"), field, 0.01)
    >>> bool(np.allclose(top.normals, [0, 0, 1])), len(top.triangles) > 2
    (True, True)
    """
    moved = _still(mesh, facets) if displacement is None else displacement.on_surface(facets)
    cut = tessellation(moved, min(tolerance, _FAR), magnified, longest)
    outward = _unit(cross(*np.moveaxis(_sides(moved.corners), 1, 0))) * moved.turns[:, None]
    vertex = _shading_vertices(cut.groups, _smooth_sides(facets, outward, crease))
    normals = _exact(moved, magnified, cut.groups, outward)
    smooth = _smoothed(normals, vertex, moved.corners, cut.groups)
    points = cut.points[np.concatenate([group.points.ravel() for group in cut.groups])]
    return Surface(moved, cut.groups, points, smooth, vertex)


_FAR = 1e300
"""A tolerance that is none."""


def _still(mesh: TetMesh, facets: Ints) -> SurfaceField:
    """No displacement."""
    return SurfaceField(mesh, facets, 1, facets, np.zeros((len(facets), 3, 3)))


def _joined(groups: tuple[Alike, ...], of: Callable[[Alike], Floats]) -> Floats:
    """What is known at the samples of each group (g, m, k), in one row (s, k)."""
    parts = [of(group) for group in groups]
    return np.concatenate([part.reshape(-1, part.shape[2]) for part in parts])


def _sides(corners: Floats) -> Floats:
    """The two edges (f, 2, 3) of each facet from its first corner."""
    return corners[:, 1:] - corners[:, :1]


def _unit(vectors: Floats) -> Floats:
    """Vectors (..., 3) of length 1; one without length stays zero, as of a facet crushed flat."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.asarray(vectors / np.where(length > 0, length, 1.0))


def _exact(
    moved: SurfaceField, magnified: float, groups: tuple[Alike, ...], outward: Floats
) -> Floats:
    """Unit normals (s, 3) of the displaced patches; the facet's own one where it is crushed."""
    net = moved.net(magnified)

    def of(group: Alike) -> Floats:
        found = patch_normals(moved.degree, net[group.facets], group.cut.bary)
        found *= moved.turns[group.facets, None, None]
        crushed = (found == 0).all(axis=2, keepdims=True)
        return np.where(crushed, outward[group.facets, None], found)

    return _joined(groups, of)


def _smoothed(normals: Floats, vertex: Ints, corners: Floats, groups: tuple[Alike, ...]) -> Floats:
    """Unit normals (s, 3) that agree wherever samples share a shading vertex."""
    at = _corner_samples(groups, len(corners))
    mine, angles = normals[at], _angles(corners)
    change = _averaged(mine.reshape(-1, 3), vertex[at].ravel(), angles.ravel())
    change = change.reshape(mine.shape) - mine
    taken = _unit(normals + _joined(groups, lambda g: g.cut.bary @ change[g.facets]))
    return _averaged(taken, vertex, _weights(groups, angles))


def _corner_samples(groups: tuple[Alike, ...], count: int) -> Ints:
    """The samples (f, 3) at the corners of each facet."""
    found, first = np.empty((count, 3), np.int64), 0
    for group in groups:
        start = first + np.arange(len(group.facets)) * len(group.cut.bary)
        found[group.facets] = start[:, None] + np.arange(3)
        first += group.points.size
    return found


def _smooth_sides(facets: Ints, outward: Floats, crease: float) -> Ints:
    """Pairs (s, 2, 2) of [facet, side] that meet at an edge of two facets which is no crease."""
    rows = facets[:, np.array(SIDES)].reshape(-1, 2)
    key = packed(rows, int(facets.max(initial=0)) + 1)
    order = np.argsort(key, kind="stable")
    starts = np.flatnonzero(np.diff(key[order], prepend=-1, append=-1))
    twice = starts[:-1][np.diff(starts) == 2]
    pairs = np.stack([order[twice], order[twice + 1]], axis=1)
    of_facet, side = np.divmod(pairs, 3)
    cosine = np.einsum("sd,sd->s", outward[of_facet[:, 0]], outward[of_facet[:, 1]])
    return np.asarray(np.stack([of_facet, side], axis=2)[cosine > np.cos(crease)])


def _shading_vertices(groups: tuple[Alike, ...], links: Ints) -> Ints:
    """Numbers (s,) of samples that share a normal: those joined across smooth edges.

    Corners come first, by what they are joined to; then points on smooth edges; then each for
    itself.
    """
    number = sum(len(group.facets) for group in groups)
    corner, corners = _joined_corners(number, links)
    smooth = np.zeros((number, 3), bool)
    smooth[links[:, :, 0], links[:, :, 1]] = True
    own = corners + 1 + max(int(group.points.max()) for group in groups)
    found = []
    for group in groups:
        mine = own + np.arange(group.points.size).reshape(group.points.shape)
        own += group.points.size
        mine[:, :3] = corner[group.facets]
        rim = slice(3, group.cut.rim)
        side = 2 - (group.cut.bary[rim] == 0).argmax(axis=1)
        shared = smooth[group.facets][:, side]
        mine[:, rim] = np.where(shared, corners + group.points[:, rim], mine[:, rim])
        found.append(mine.ravel())
    return np.unique(np.concatenate(found), return_inverse=True)[1].ravel()


def _joined_corners(number: int, links: Ints) -> tuple[Ints, int]:
    """One number (f, 3) for corners that are joined across smooth edges, and how many there are."""
    ends = 3 * links[:, :, :1] + np.array(SIDES)[links[:, :, 1]]
    first, second = ends[:, 0].ravel(), ends[:, 1].ravel()
    graph = coo_array((np.ones(len(first), bool), (first, second)), (3 * number,) * 2)
    count, part = connected_components(graph, directed=False)
    return np.asarray(part, np.int64).reshape(-1, 3), int(count)


def _angles(corners: Floats) -> Floats:
    """The angles (f, 3) of each facet in rad."""
    found = []
    for i in range(3):
        a, b = (corners[:, (i + k) % 3] - corners[:, i] for k in (1, 2))
        found.append(np.arctan2(np.linalg.norm(cross(a, b), axis=1), np.einsum("fd,fd->f", a, b)))
    return np.stack(found, axis=1)


def _weights(groups: tuple[Alike, ...], angles: Floats) -> Floats:
    """The angle (s,) that each facet fills around each of its samples, in rad."""
    found = []
    for group in groups:
        mine = np.full(group.points.shape, 2 * np.pi)
        mine[:, 3 : group.cut.rim] = np.pi
        mine[:, :3] = angles[group.facets]
        found.append(mine.ravel())
    return np.concatenate(found)


def _averaged(normals: Floats, vertex: Ints, weights: Floats) -> Floats:
    """Unit normals (s, 3), weighted averages over samples of one shading vertex."""
    parts = [np.bincount(vertex, normals[:, i] * weights) for i in range(3)]
    total: Floats = np.stack(parts, axis=1)
    found = _unit(total)[vertex]
    return np.asarray(np.where((found == 0).all(axis=1, keepdims=True), normals, found))
