# SPDX-License-Identifier: BSD-3-Clause
"""Lattices on facets: which of their points neighbouring facets share, and small triangles."""

from __future__ import annotations

from functools import cache

import numpy as np

from bezsoma.arrays import Ints, frozen
from bezsoma.bernstein import count, indices, position, trace

SIDES = ((0, 1), (0, 2), (1, 2))


@cache
def small_triangles(parts: int) -> Ints:
    """The parts**2 triangles (parts**2, 3) of a facet whose edges are cut into equal parts.

    Corners are positions among `indices(parts, 2)`; each triangle turns as the facet does, which
    its exact area in barycentric coordinates shows:

    >>> corners = indices(3, 2)[small_triangles(3)]
    >>> np.round(np.linalg.det(corners / 3) * 9).tolist() == [1.0] * 9
    True
    """
    up = indices(parts - 1, 2)[:, None, :] + np.eye(3, dtype=np.int64)
    if parts == 1:
        return frozen(np.asarray(position(up)))
    down = indices(parts - 2, 2)[:, None, :] + (1 - np.eye(3, dtype=np.int64))
    return frozen(np.asarray(position(np.concatenate([up, down]))))


def shared_points(facets: Ints, parts: int) -> tuple[Ints, int]:
    """Numbers (f, m) of the lattice points of ascending facets (f, 3), and how many there are.

    Points on a common vertex or edge have one number: vertices come first, then edges, then the
    insides of facets. Two triangles with a common edge, cut in two, have 15 - 6 = 9 points:

    >>> shared_points(np.array([[0, 1, 2], [1, 2, 3]]), 2)[1]
    9
    """
    size = count(parts, 2)
    numbers = np.empty((len(facets), size), np.int64)
    vertices, of_corner = np.unique(facets, return_inverse=True)
    for i in range(3):
        numbers[:, trace(parts, 2, (i,))[0]] = of_corner.reshape(-1, 3)[:, i]
    total = len(vertices)
    sides = facets[:, np.array(SIDES)].reshape(-1, 2)
    edges, of_side = np.unique(sides, axis=0, return_inverse=True)
    between = np.arange(parts - 1)
    for i, side in enumerate(SIDES):
        start = total + of_side.reshape(-1, 3)[:, i] * (parts - 1)
        numbers[:, trace(parts, 2, side)[1:-1]] = start[:, None] + between
    total += len(edges) * (parts - 1)
    inner = np.flatnonzero((indices(parts, 2) > 0).all(axis=1))
    numbers[:, inner] = total + np.arange(len(facets) * len(inner)).reshape(len(facets), -1)
    return numbers, total + len(facets) * len(inner)
