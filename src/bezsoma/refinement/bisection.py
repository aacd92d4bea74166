# SPDX-License-Identifier: BSD-3-Clause
"""Tets cut in two, and their neighbours with them, so that the mesh stays a mesh.

Bisection of D. N. Arnold, A. Mukherjee and L. Pouly (SIAM J. Sci. Comput. 22, 2000,
doi:10.1137/S1064827597323373). Every tet knows which of its edges is cut next, and every face
which of its edges is, the same from both sides: whichever of two neighbours is cut first, they
agree on their face. From any mesh the tets take finitely many shapes, so that none gets flat.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from bezsoma.arrays import Bools, Floats, Ints, frozen
from bezsoma.errors import InputError
from bezsoma.mesh import checks
from bezsoma.mesh.subdivision import Subdivision
from bezsoma.mesh.tets import TetMesh
from bezsoma.mesh.topology import EDGES

Bytes = npt.NDArray[np.int8]
PAIRS = np.array(EDGES)
NUMBER_OF_EDGE = np.zeros((4, 4), np.int64)
for _number, (_i, _j) in enumerate(EDGES):
    NUMBER_OF_EDGE[_i, _j] = NUMBER_OF_EDGE[_j, _i] = _number


@dataclass(frozen=True, eq=False)
class Cuts:
    """How the tets of a mesh will be cut: beside the mesh, the rows of which ascend.

    `corners` (t, 4) are the vertices of each tet: the edge from the first to the second is cut
    next. `sides` (t, 2) are the next cuts of the two faces that this edge is no part of, opposite
    the second and the first corner: 0 from the face's own end of the edge to the third corner, 1
    from there to the fourth, 2 from the third to the fourth. `flagged` (t,) tells the two
    generations of tets apart whose three cuts lie in a plane.
    """

    corners: Ints
    sides: Bytes
    flagged: Bools


@dataclass(frozen=True, eq=False)
class Bisection:
    """A finer mesh within the one before, and how it will be cut again.

    `field.subdivided(bisection.into)` is the same field on the finer mesh.
    """

    into: Subdivision
    cuts: Cuts

    @property
    def mesh(self) -> TetMesh:
        """The finer mesh."""
        return self.into.fine


def cuts_of(mesh: TetMesh) -> Cuts:
    """The first cuts of any mesh: tets and faces are cut at their longest edge.

    Of edges of one length the one of the higher number in `mesh.all_edges` counts as longer, in
    all tets alike: so neighbours agree on their face.
    """
    ends = mesh.points[mesh.all_edges]
    squares = np.einsum("ed,ed->e", *(ends[:, 1] - ends[:, 0],) * 2)
    rank = np.empty(len(squares), np.int64)
    rank[np.argsort(squares, kind="stable")] = np.arange(len(squares))
    ranks = rank[mesh.edges_of_tet]
    longest = ranks.argmax(axis=1)
    local = np.concatenate([PAIRS[longest], PAIRS[5 - longest]], axis=1)

    def ranked(i: int, j: int) -> Ints:
        edge = NUMBER_OF_EDGE[local[:, i], local[:, j]]
        return np.take_along_axis(ranks, edge[:, None], axis=1)[:, 0]

    sides = [np.argmax([ranked(i, 2), ranked(i, 3), ranked(2, 3)], axis=0) for i in (0, 1)]
    corners = np.take_along_axis(mesh.tets, local, axis=1)
    flagged = np.zeros(len(corners), bool)
    return Cuts(frozen(corners), frozen(np.stack(sides, axis=1).astype(np.int8)), frozen(flagged))


def bisected(
    mesh: TetMesh, chosen: npt.ArrayLike, cuts: Cuts | None = None, times: int = 1
) -> Bisection:
    """The mesh with these tets (q,) cut in two, and as many others as have to follow.

    So many `times`, all that these tets have become: three times halves every edge of a tet.

    Vertices keep their numbers and new ones come last; the first half of a tet keeps its number.
    Regions and named places are inherited. `cuts` are those that came with the mesh from the last
    bisection, the longest edges where there was none.

    The six tets of a cube share its diagonal, so that all follow the first:

    >>> from bezsoma.mesh.solids import block
    >>> fine = bisected(block(), [0])
    >>> len(fine.mesh.tets), len(fine.mesh.points), bool(fine.mesh.volumes.sum() == 1)
    (12, 9, True)
    """
    asked = np.unique(checks.index_array(chosen, len(mesh.tets), "tets to bisect", "tet"))
    cuts = cuts_of(mesh) if cuts is None else _cuts_checked(cuts, mesh)
    work = _Work(mesh, cuts)
    for _ in range(times):
        tets = np.flatnonzero(np.isin(work.ancestors, asked))
        while len(tets):
            work.cut(tets)
            tets = work.hanging()
    points, corners = work.points(), work.corners
    order = np.argsort(corners, axis=1)
    within = np.take_along_axis(work.within, order[:, :, None], axis=1)
    surfaces = {
        name: work.middles.facets(_opened_facets(mesh, cuts, facets))
        for name, facets in mesh.surfaces.items()
    }
    edges = {name: work.middles.edges(edges) for name, edges in mesh.edges.items()}
    region = mesh.region[work.ancestors]
    fine = TetMesh(points, corners, region, mesh.regions, surfaces, edges, mesh.vertices)
    after = Cuts(frozen(corners), frozen(work.sides), frozen(work.flagged))
    into = Subdivision(mesh, fine, frozen(work.ancestors), frozen(within))
    return Bisection(into, after)


def _cuts_checked(cuts: Cuts, mesh: TetMesh) -> Cuts:
    if not np.array_equal(np.sort(cuts.corners, axis=1), mesh.tets):
        raise InputError(
            f"the cuts of {len(cuts.corners)} other tets were given for this mesh of "
            f"{len(mesh.tets)}; give those that came with it, or none"
        )
    return cuts


class _Middles:
    """The vertex in the middle of each edge cut so far, looked up by the ends of the edge."""

    def __init__(self, count: int) -> None:
        self.count = count
        self.keys = np.zeros(0, np.int64)
        self.numbers = np.zeros(0, np.int64)
        self.ends = np.zeros((0, 2), np.int64)
        """The ends of the edge of each new vertex, in the order of their numbers."""

    def of(self, a: Ints, b: Ints) -> Ints:
        """The middle of each edge from a to b (q,), -1 where it is not cut."""
        if not len(self.keys):
            return np.full(len(a), -1)
        keys = _keys(a, b)
        place = np.minimum(np.searchsorted(self.keys, keys), len(self.keys) - 1)
        return np.where(self.keys[place] == keys, self.numbers[place], -1)

    def cut(self, a: Ints, b: Ints) -> Ints:
        """The middle of each edge from a to b (q,): a new vertex where there was none."""
        wanted = self.of(a, b) < 0
        keys = np.unique(_keys(a[wanted], b[wanted]))
        numbers = self.count + np.arange(len(keys))
        self.count += len(keys)
        self.ends = np.concatenate([self.ends, np.stack([keys >> 32, keys & 0xFFFFFFFF], axis=1)])
        place = np.searchsorted(self.keys, keys)
        self.keys = np.insert(self.keys, place, keys)
        self.numbers = np.insert(self.numbers, place, numbers)
        return self.of(a, b)

    def edges(self, rows: Ints) -> Ints:
        """Edges (e, 2) of the mesh before, in halves as far as they are cut."""
        while ((middle := self.of(rows[:, 0], rows[:, 1])) >= 0).any():
            cut = middle >= 0
            halves = [np.stack([rows[cut, i], middle[cut]], axis=1) for i in (0, 1)]
            rows = np.concatenate([rows[~cut], *halves])
        return rows

    def facets(self, rows: Ints) -> Ints:
        """Facets (f, 3) cut as far as the edge from their first to their second vertex is.

        What is left of a face is cut opposite its newest vertex, which therefore comes last.
        """
        while ((middle := self.of(rows[:, 0], rows[:, 1])) >= 0).any():
            cut = middle >= 0
            new = [np.stack([rows[cut, i], rows[cut, 2], middle[cut]], axis=1) for i in (0, 1)]
            rows = np.concatenate([rows[~cut], *new])
        return rows


class _Work:
    """Tets under the knife: arrays that grow by the second halves."""

    def __init__(self, mesh: TetMesh, cuts: Cuts) -> None:
        self.mesh = mesh
        self.corners, self.sides, self.flagged = cuts.corners, cuts.sides, cuts.flagged
        self.ancestors = np.arange(len(mesh.tets))
        self.within = (cuts.corners[:, :, None] == mesh.tets[:, None, :]).astype(np.float64)
        """Barycentric coordinates (t, 4, 4) of the corners in the ancestor."""
        self.middles = _Middles(len(mesh.points))

    def cut(self, rows: Ints) -> None:
        """Cut these tets (q,): first halves in their place, second halves at the end."""
        corners, sides, flagged = self.corners[rows], self.sides[rows], self.flagged[rows]
        middle = self.middles.cut(corners[:, 0], corners[:, 1])
        within = self.within[rows]
        between = (within[:, 0] + within[:, 1]) / 2
        planar = (sides[:, 0] == sides[:, 1]) & (sides[:, 0] < 2)
        halves = [_half(corners, middle, sides, i) for i in (0, 1)]
        inner = [_half(within, between, sides, i) for i in (0, 1)]
        new_sides = np.column_stack([0 * sides[:, 0], planar & flagged]).astype(np.int8)
        self.corners = _replaced(self.corners, rows, *halves)
        self.within = _replaced(self.within, rows, *inner)
        self.sides = _replaced(self.sides, rows, new_sides, new_sides)
        self.flagged = _replaced(self.flagged, rows, planar & ~flagged, planar & ~flagged)
        self.ancestors = np.concatenate([self.ancestors, self.ancestors[rows]])

    def hanging(self) -> Ints:
        """The tets that have an edge with a vertex in its middle."""
        ends = np.zeros(self.middles.count, bool)
        ends[self.middles.ends] = True
        near = np.flatnonzero(ends[self.corners].sum(axis=1) > 1)
        corners = self.corners[near]
        hangs = np.zeros(len(near), bool)
        for i, j in EDGES:
            hangs |= self.middles.of(corners[:, i], corners[:, j]) >= 0
        return near[hangs]

    def points(self) -> Floats:
        """All vertices (v, 3) mm; a middle may lie on an edge that a middle ends."""
        old = len(self.mesh.points)
        points = np.concatenate([self.mesh.points, np.empty((self.middles.count - old, 3))])
        begin = 0
        for end in _runs(self.middles.ends, old):
            a, b = points[self.middles.ends[begin:end]].transpose(1, 0, 2)
            points[old + begin : old + end] = (a + b) / 2
            begin = end
        return points


def _runs(ends: Ints, old: int) -> list[int]:
    """Where to pause in a list of edges, so that each run has only earlier vertices as ends."""
    stops, known = [], 0
    while known < len(ends):
        later = np.flatnonzero(ends[known:].max(axis=1) >= old + known)
        known = known + int(later[0]) if len(later) else len(ends)
        stops.append(known)
    return stops


def _keys(a: Ints, b: Ints) -> Ints:
    return np.minimum(a, b) << 32 | np.maximum(a, b)


_OPENED = np.array([(0, 1, 2), (0, 2, 1), (1, 2, 0)])
"""By the next cut of a face: where its ends and the vertex opposite stand among its vertices."""


def _opened(face: npt.NDArray[Any], side: Bytes) -> npt.NDArray[Any]:
    """Faces (q, 3, ...) with the ends of their next cut first and the vertex opposite last."""
    return np.asarray(face[np.arange(len(face))[:, None], _OPENED[side]])


def _half(
    corners: npt.NDArray[Any], middle: npt.NDArray[Any], sides: Bytes, end: int
) -> npt.NDArray[Any]:
    """The halves (q, 4, ...) that keep one end of the edge that is cut, the new corner last."""
    face = _opened(corners[:, [end, 2, 3]], sides[:, end])
    return np.concatenate([face, middle[:, None]], axis=1)


def _opened_facets(mesh: TetMesh, cuts: Cuts, facets: Ints) -> Ints:
    """Facets (f, 3), each as the ends of its next cut and the vertex opposite."""
    if not len(facets):
        return facets
    tets = mesh.tets_of_facets(facets)
    corners, sides = cuts.corners[tets], cuts.sides[tets]
    outside = (corners[:, :, None] != facets[:, None, :]).all(axis=2).argmax(axis=1)
    without = (
        _opened(corners[:, [1, 2, 3]], sides[:, 1]),
        _opened(corners[:, [0, 2, 3]], sides[:, 0]),
        corners[:, [0, 1, 3]],
        corners[:, [0, 1, 2]],
    )
    return np.asarray(np.stack(without, axis=1)[np.arange(len(facets)), outside])


def _replaced(
    old: npt.NDArray[Any], rows: Ints, first: npt.NDArray[Any], second: npt.NDArray[Any]
) -> npt.NDArray[Any]:
    new = np.concatenate([old, second])
    new[rows] = first
    return new
