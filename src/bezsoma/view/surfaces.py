# SPDX-License-Identifier: BSD-3-Clause
"""Displaced surfaces as small triangles with the normals that a picture is shaded by.

The triangles have their corners on the exact displaced polynomial patches, and the normals start
as those of the patches. Patches meet at an angle, though, where a skin is meant to be smooth; so
at every corner of a facet the normals of the facets around are averaged (not across creases, so
a block keeps its edges), and each patch takes the change at its three corners along into its
inside. Where the patches meet smoothly nothing changes: their exact normals are shown.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import ceil

import numpy as np
import numpy.typing as npt
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from bezsoma.arrays import Bools, Floats, Ints, T
from bezsoma.bernstein import derivatives, domain_points, trace
from bezsoma.mesh import Field, TetMesh
from bezsoma.mesh.topology import cross, packed
from bezsoma.view.chords import bends, lattice_error
from bezsoma.view.lattice import SIDES, corners_of, small_triangles
from bezsoma.view.restriction import controls_on, degree_of, values_at

MOST_PARTS = 16


@dataclass(frozen=True, eq=False)
class Surface:
    """Facets cut into `parts` an edge: points and outward unit normals at m samples of each."""

    facets: Ints
    """(f, 3) vertex numbers of the mesh, ascending."""
    parts: int
    points: Floats
    """(f, m, 3) mm, displaced."""
    normals: Floats
    """(f, m, 3) outward, length 1, smoothed across edges that are no creases."""
    vertex: Ints
    """(f, m) one number for samples that share point and normal."""

    @property
    def bary(self) -> Floats:
        """(m, 3) where on its facet each sample lies."""
        return domain_points(self.parts, 2)

    @cached_property
    def rims(self) -> Bools:
        """(r, 3) whether the edge opposite each triangle's corner lies on an edge of its facet."""
        return np.tile(on_edges(self.parts).any(axis=2), (len(self.points), 1))

    def corners(self, samples: npt.NDArray[T]) -> npt.NDArray[T]:
        """Values (r, 3, ...) at the corners of the small triangles, from those at samples."""
        return corners_of(samples, self.parts)


def on_edges(parts: int) -> Bools:
    """Whether the side opposite corner k of each small triangle is on edge j of its facet.

    (parts**2, 3, 3) [triangle, k, j]; edge j of the facet is the one opposite its corner j.

    >>> on_edges(1)[0].tolist() == np.eye(3, dtype=bool).tolist()
    True
    """
    off = domain_points(parts, 2)[small_triangles(parts)] > 0
    return np.stack([~off[:, [(k + 1) % 3, (k + 2) % 3]].any(axis=1) for k in range(3)], axis=1)


def displaced(
    mesh: TetMesh,
    facets: Ints,
    displacement: Field | None,
    parts: int,
    crease: float = 0.7,
    magnified: float = 1.0,
) -> Surface:
    """The surface (f facets) moved by the displacement; `crease` in rad.

    Two facets that meet at a larger angle than `crease` keep an edge between them. A shear along
    a plane leaves its normal alone, and this is exact:

    >>> from bezsoma.mesh import ControlNet, block
    >>> mesh = block(cells=(1, 1, 1))
    >>> net = ControlNet(mesh, 2)
    >>> field = Field(net, net.interpolated(lambda p: np.c_[p[:, 0] * p[:, 1], 0 * p[:, :2]]))
    >>> top = displaced(mesh, mesh.facets_of("top"), field, 4)
    >>> bool(np.allclose(top.normals, [0, 0, 1]))
    True
    """
    bary = domain_points(parts, 2)
    corners = mesh.points[facets]
    outward = mesh.normals(facets)
    points = bary @ corners
    tangents = np.broadcast_to(_sides(corners)[:, None], (len(facets), len(bary), 2, 3))
    if displacement is not None:
        controls = magnified * controls_on(mesh, displacement, facets)
        degree = degree_of(displacement)
        points = points + values_at(degree, controls, bary)
        tangents = tangents + _slopes(degree, controls, bary)
    vertex = _shading_vertices(len(facets), _smooth_sides(facets, outward, crease), parts)
    normals = _exact(tangents, outward, _sides(corners))
    return Surface(facets, parts, points, _smoothed(normals, vertex, corners, parts), vertex)


def parts_for(controls: Floats, degree: int, tolerance: float) -> int:
    """Into how many parts each edge is cut so that the triangles err by less than `tolerance` mm.

    All facets alike, for displacements with the controls (f, m, 3); at most `MOST_PARTS`. For
    x**2 over one facet the bound of `chords` is attained:

    >>> controls = np.zeros((1, 6, 3)); controls[0, 3, 2] = 1.0  # u**2, bends by 1/4 in all
    >>> parts_for(controls, 2, 0.25), parts_for(controls, 2, 0.0156251)
    (1, 4)
    """
    worst = lattice_error(bends(controls, degree)).max(initial=0.0)
    return int(min(MOST_PARTS, max(1, ceil(np.sqrt(worst / tolerance)))))


def _sides(corners: Floats) -> Floats:
    """The two edges (f, 2, 3) of each facet from its first corner."""
    return corners[:, 1:] - corners[:, :1]


def _slopes(degree: int, controls: Floats, bary: Floats) -> Floats:
    """What the displacement adds to the tangents (f, m, 2, 3) along those edges."""
    partials = np.moveaxis(np.asarray(derivatives(degree, bary), float), 2, 0)
    along = [(partial - partials[0]) @ controls for partial in partials[1:]]
    return np.stack(along, axis=2)


def _unit(vectors: Floats) -> Floats:
    """Vectors (..., 3) of length 1; one without length stays zero, as of a facet crushed flat."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.asarray(vectors / np.where(length > 0, length, 1.0))


def _exact(tangents: Floats, outward: Floats, before: Floats) -> Floats:
    """Unit normals (f, m, 3) of the displaced patches; the facet's own one where it is crushed."""
    side = np.sign(np.einsum("fd,fd->f", cross(before[:, 0], before[:, 1]), outward))
    found = _unit(cross(tangents[..., 0, :], tangents[..., 1, :]) * side[:, None, None])
    crushed = (found == 0).all(axis=-1, keepdims=True)
    return np.asarray(np.where(crushed, outward[:, None], found))


def _smoothed(normals: Floats, vertex: Ints, corners: Floats, parts: int) -> Floats:
    """Unit normals (f, m, 3) that agree wherever samples share a shading vertex."""
    place = _corner_places(parts)
    mine = normals[:, place]
    change = _averaged(mine, vertex[:, place], _angles(corners)) - mine
    taken = _unit(normals + domain_points(parts, 2) @ change)
    return _averaged(taken, vertex, _weights(corners, parts))


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


def _shading_vertices(number: int, links: Ints, parts: int) -> Ints:
    """Numbers (f, m) of samples that share a normal: those joined across smooth edges."""
    along = np.stack([trace(parts, 2, side) for side in SIDES])
    size = len(domain_points(parts, 2))
    samples = links[:, :, :1] * size + along[links[:, :, 1]]
    first, second = samples[:, 0].ravel(), samples[:, 1].ravel()
    graph = coo_array((np.ones(len(first), bool), (first, second)), (number * size,) * 2)
    return np.asarray(connected_components(graph, directed=False)[1], np.int64).reshape(-1, size)


def _angles(corners: Floats) -> Floats:
    """The angles (f, 3) of each facet in rad."""
    found = []
    for i in range(3):
        a, b = (corners[:, (i + k) % 3] - corners[:, i] for k in (1, 2))
        found.append(np.arctan2(np.linalg.norm(cross(a, b), axis=1), np.einsum("fd,fd->f", a, b)))
    return np.stack(found, axis=1)


def _corner_places(parts: int) -> Ints:
    return np.array([trace(parts, 2, (i,))[0] for i in range(3)])


def _weights(corners: Floats, parts: int) -> Floats:
    """The angle (f, m) that each facet fills around each of its samples, in rad."""
    zeros = (domain_points(parts, 2) == 0).sum(axis=1)
    weights = np.broadcast_to(np.where(zeros == 0, 2 * np.pi, np.pi), (len(corners), len(zeros)))
    weights = weights.copy()
    weights[:, _corner_places(parts)] = _angles(corners)
    return weights


def _averaged(normals: Floats, vertex: Ints, weights: Floats) -> Floats:
    """Unit normals (f, m, 3), weighted averages over samples of one shading vertex."""
    parts = [np.bincount(vertex.ravel(), (normals[..., i] * weights).ravel()) for i in range(3)]
    total: Floats = np.stack(parts, axis=1)
    found = _unit(total)[vertex]
    return np.asarray(np.where((found == 0).all(axis=-1, keepdims=True), normals, found))
