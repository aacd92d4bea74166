# SPDX-License-Identifier: BSD-3-Clause
"""Lattices on facets: which of their points neighbouring facets share, and small triangles."""

from __future__ import annotations

from functools import cache

import numpy as np
import numpy.typing as npt

from bezsoma.arrays import Ints, T, frozen
from bezsoma.bernstein import count, indices, trace

SIDES = ((0, 1), (0, 2), (1, 2))
"""The edges of a facet, each from its lower vertex."""
ROUND = ((0, 1), (2, 0), (1, 2))
"""The same edges, walked with the facet to the left."""


@cache
def lattice_points(parts: int) -> Ints:
    """The points (m, 3) of a facet whose edges are cut into equal parts, any number of them.

    As multi-indices in the order of `bernstein.indices`, which ends at degree 20:

    >>> bool((lattice_points(7) == indices(7, 2)).all()), len(lattice_points(64))
    (True, 2145)
    """
    rows = [[parts - t, t - c, c] for t in range(parts + 1) for c in range(t + 1)]
    return frozen(np.array(rows))


def place(points: Ints) -> Ints:
    """Where multi-indices (.., 3) stand among `lattice_points`."""
    tail = points[..., 1] + points[..., 2]
    return np.asarray(tail * (tail + 1) // 2 + points[..., 2])


def along(parts: int, side: tuple[int, int]) -> Ints:
    """Where the points (parts + 1,) of a side stand among `lattice_points`, from end to end.

    >>> along(2, (0, 2)).tolist(), along(2, (2, 0)).tolist()
    ([0, 2, 5], [5, 2, 0])
    """
    rows = np.zeros((parts + 1, 3), np.int64)
    rows[:, side[0]], rows[:, side[1]] = np.arange(parts, -1, -1), np.arange(parts + 1)
    return place(rows)


@cache
def small_triangles(parts: int) -> Ints:
    """The parts**2 triangles (parts**2, 3) of a facet whose edges are cut into equal parts.

    Corners are positions among `lattice_points`; each triangle turns as the facet does, which
    its exact area in barycentric coordinates shows:

    >>> corners = lattice_points(3)[small_triangles(3)]
    >>> np.round(np.linalg.det(corners / 3) * 9).tolist() == [1.0] * 9
    True
    """
    up = place(lattice_points(parts - 1)[:, None] + np.eye(3, dtype=np.int64))
    if parts == 1:
        return frozen(up)
    down = place(lattice_points(parts - 2)[:, None] + 1 - np.eye(3, dtype=np.int64))
    return frozen(np.concatenate([up, down]))


def corners_of(samples: npt.NDArray[T], parts: int) -> npt.NDArray[T]:
    """Values (r, 3, ...) at the corners of all small triangles, from those at samples (f, m, ...).

    >>> corners_of(np.array([[10, 20, 30, 40, 50, 60]]), 2)[-1].tolist()  # the one upside down
    [50, 30, 20]
    """
    return samples[:, small_triangles(parts)].reshape(-1, 3, *samples.shape[2:])


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
