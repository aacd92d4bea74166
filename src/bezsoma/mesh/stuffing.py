# SPDX-License-Identifier: BSD-3-Clause
"""Tets that fill what a level function encloses: isosurface stuffing of a lattice.

Labelle and Shewchuk, Isosurface Stuffing (ACM TOG 26(3), 2007; doi:10.1145/1276377.1276448): the
lattice's vertices that lie too near to the surface are moved onto it, tets that still reach across
are cut, and what lies outside is left away. Other than there, vertices on the sides of the box stay
on them, so that a side that cuts the body is flat to the last bit, and a quadrilateral is parted at
its deeper end, which needs no lattice of one size. Deterministic, and linear in the number of tets.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from bezsoma.arrays import Bools, Floats, Ints
from bezsoma.mesh.topology import EDGES, determinants

Level = Callable[[Floats], Floats]
"""Numbers (p,) at points (p, 3): negative inside, zero on the surface, continuous."""
NEAR = 0.4
"""A vertex is moved onto the surface if that cuts an edge within this part of it. The paper proves
its bounds for 0.25 and 0.41, on long and on short edges; here 0.4 on all gave the best angles."""
LEAST = 0.02
"""What part of its volume a tet has to keep when its vertices are moved."""
HALVINGS = 12
"""Of the interval in which an edge meets the surface."""


@dataclass(frozen=True, eq=False)
class Stuffed:
    """Tets inside a surface and a box."""

    points: Floats
    """(v, 3) mm."""
    tets: Ints
    """(t, 4)."""
    on_surface: Bools
    """(v,) whether a vertex lies where the level is zero."""
    on_side: Bools
    """(v, 3) whether it lies on a side of the box across each axis."""

    def of(self, tets: Ints | Bools) -> Stuffed:
        """These tets of it alone, with the vertices they use."""
        used, rows = np.unique(self.tets[tets], return_inverse=True)
        return Stuffed(
            self.points[used], rows.reshape(-1, 4), self.on_surface[used], self.on_side[used]
        )

    def split(self, tets: Ints | Bools) -> Stuffed:
        """It with these tets cut in four at their barycentres; new vertices come last."""
        chosen = np.arange(len(self.tets))[tets]
        corners = self.tets[chosen]
        centre = len(self.points) + np.arange(len(chosen))
        four = np.repeat(corners, 4, axis=0)
        four[np.arange(len(four)), np.tile(np.arange(4), len(chosen))] = np.repeat(centre, 4)
        free = np.zeros((len(chosen), 3), np.bool_)
        return Stuffed(
            np.concatenate([self.points, self.points[corners].mean(axis=1)]),
            np.concatenate([np.delete(self.tets, chosen, axis=0), four]),
            np.concatenate([self.on_surface, free[:, 0]]),
            np.concatenate([self.on_side, free]),
        )


def stuffed(points: Floats, tets: Ints, on_side: Bools, level: Level) -> Stuffed:
    """The part of a lattice (points (v, 3) in mm, tets (t, 4)) where `level` is negative.

    `on_side` (v, 3) are the vertices that have to stay on a plane across each axis. Near such a
    plane `level` must not change across it.

    A ball has its volume up to what chords cut off, and no bad angles:

    >>> from bezsoma.mesh.graded import Octree, lattice
    >>> vertices, tets = lattice(Octree.of(np.full((16, 16, 16), 1.0), 1.0, 1))
    >>> ball = stuffed(vertices / 2 - 8, tets, np.zeros(vertices.shape, bool),
    ...                lambda x: np.linalg.norm(x, axis=1) - 6)
    >>> a, b, c, d = (ball.points[ball.tets[:, i]] for i in range(4))
    >>> volume = np.abs(np.einsum("td,td->t", b - a, np.cross(c - a, d - a))).sum() / 6
    >>> bool(0.975 < volume / (4 / 3 * np.pi * 6**3) < 1)
    True
    """
    values = level(points)
    tets = tets[(values[tets] < 0).any(axis=1)]
    points, values = _warped(points, values, tets, on_side, level)
    return _cut(points, values, tets, on_side, level)


def _edges(tets: Ints) -> Ints:
    """The edges (e, 2) of tets, each once, ascending."""
    ends = np.sort(np.concatenate([tets[:, list(e)] for e in EDGES]), axis=1)
    span = int(ends.max(initial=0)) + 1
    return np.stack(np.divmod(np.unique(ends[:, 0] * span + ends[:, 1]), span), axis=1)


def _crossings(points: Floats, values: Floats, edges: Ints, level: Level) -> tuple[Ints, Floats]:
    """The edges (c, 2) that go through the surface, and at what part (c,) from their first end."""
    edges = edges[values[edges[:, 0]] * values[edges[:, 1]] < 0]
    start, step = points[edges[:, 0]], points[edges[:, 1]] - points[edges[:, 0]]
    sign = np.sign(values[edges[:, 0]])
    low, high = np.zeros(len(edges)), np.ones(len(edges))
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        before = level(start + middle[:, None] * step) * sign > 0
        low, high = np.where(before, middle, low), np.where(before, high, middle)
    return edges, (low + high) / 2


def _warped(
    points: Floats, values: Floats, tets: Ints, on_side: Bools, level: Level
) -> tuple[Floats, Floats]:
    """Vertices that the surface comes too near are moved onto it, along the nearest such edge.

    Where that would turn a tet over, or nearly so, its vertices stay: surfaces are close there.
    """
    edges, part = _crossings(points, values, _edges(tets), level)
    place = points[edges[:, 0]] + part[:, None] * (points[edges[:, 1]] - points[edges[:, 0]])
    vertex = np.concatenate([edges[:, 0], edges[:, 1]])
    near = np.concatenate([part, 1 - part])
    place = np.concatenate([place, place])
    place = np.where(on_side[vertex], points[vertex], place)
    gap = np.linalg.norm(place - points[vertex], axis=1)
    order = np.lexsort((gap, vertex))
    order = order[near[order] < NEAR]
    moved, first = np.unique(vertex[order], return_index=True)
    after = points.copy()
    after[moved] = place[order[first]]
    before = determinants(points[tets])
    tets = np.where((before < 0)[:, None], tets[:, [0, 1, 3, 2]], tets)
    before = np.abs(before)
    while True:
        level_after = np.where((after == points).all(axis=1), values, 0.0)
        kept = (level_after[tets] < 0).any(axis=1)
        turned = kept & (determinants(after[tets]) < LEAST * before)
        if not turned.any():
            return after, level_after
        after[tets[turned]] = points[tets[turned]]


def _cut(points: Floats, values: Floats, tets: Ints, on_side: Bools, level: Level) -> Stuffed:
    """Tets with what lies outside cut away."""
    tets = tets[(values[tets] < 0).any(axis=1)]
    edges, part = _crossings(points, values, _edges(tets), level)
    new = points[edges[:, 0]] + part[:, None] * (points[edges[:, 1]] - points[edges[:, 0]])
    between = on_side[edges[:, 0]] & on_side[edges[:, 1]]
    span = len(points)
    key = edges[:, 0] * span + edges[:, 1]

    def cut(one: Ints, two: Ints) -> Ints:
        """The vertex on the edges between vertices (m,) and (m,)."""
        return span + np.searchsorted(key, np.minimum(one, two) * span + np.maximum(one, two))

    tets = _deepest_first(tets, values)
    sign = np.sign(values[tets])
    inside, outside = (sign < 0).sum(axis=1), (sign > 0).sum(axis=1)
    pieces = [tets[outside == 0]]
    for (within, beyond), parts in PARTS.items():
        these = tets[(inside == within) & (outside == beyond)]
        for corners in parts:
            columns = [
                these[:, c[0]] if len(c) == 1 else cut(these[:, c[0]], these[:, c[1]])
                for c in corners
            ]
            pieces.append(np.stack(columns, axis=1))
    return Stuffed(
        np.concatenate([points, new]),
        np.concatenate(pieces),
        np.concatenate([values == 0, np.ones(len(new), np.bool_)]),
        np.concatenate([on_side, between]),
    ).of(np.arange(sum(map(len, pieces))))


def _deepest_first(tets: Ints, values: Floats) -> Ints:
    """Tets (t, 4) with their corners in the order of the level, then of their numbers."""
    ordered = np.sort(tets, axis=1)
    return np.take_along_axis(ordered, np.argsort(values[ordered], axis=1, kind="stable"), axis=1)


PARTS: dict[tuple[int, int], tuple[tuple[tuple[int, ...], ...], ...]] = {
    (1, 3): (((0,), (0, 1), (0, 2), (0, 3)),),
    (1, 2): (((0,), (1,), (0, 2), (0, 3)),),
    (1, 1): (((0,), (1,), (2,), (0, 3)),),
    (2, 2): (
        ((0,), (1,), (1, 2), (1, 3)),
        ((0,), (0, 2), (1, 2), (1, 3)),
        ((0,), (0, 2), (0, 3), (1, 3)),
    ),
    (2, 1): (((0,), (1,), (2,), (1, 3)), ((0,), (2,), (0, 3), (1, 3))),
    (3, 1): (
        ((0,), (1,), (2,), (2, 3)),
        ((0,), (1,), (1, 3), (2, 3)),
        ((0,), (0, 3), (1, 3), (2, 3)),
    ),
}
"""How a tet with so many corners inside and outside is cut: its corners by depth, the deepest
first; a pair is the vertex where the surface meets that edge. A face that two tets share is parted
from its deepest corner in both, so they agree, and no prism is parted in a ring."""
