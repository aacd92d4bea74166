# SPDX-License-Identifier: BSD-3-Clause
"""Lattices, stacks of prisms and mirror images, from which the simple solids are made.

A lattice cell is cut into six *Kuhn tets*, one for each order in which a path from its lowest to
its highest corner may take its three steps; they agree across cells. A prism over a triangle is
cut into three tets along the ascending numbers of its corners, so that neighbours agree.
"""

from __future__ import annotations

from itertools import permutations, product

import numpy as np

from bezsoma.arrays import Floats, Ints


def kuhn(counts: Ints) -> tuple[Ints, Ints]:
    """Lattice points (v, 3) of nx, ny, nz cells, and six ascending tets a cell (t, 4).

    >>> points, tets = kuhn(np.array([2, 1, 3]))
    >>> points.shape, tets.shape, bool((np.diff(tets) > 0).all())
    ((24, 3), (36, 4), True)
    """
    lattice = np.stack(np.meshgrid(*(np.arange(n + 1) for n in counts), indexing="ij"), axis=-1)
    stride = np.array([(counts[1] + 1) * (counts[2] + 1), counts[2] + 1, 1])
    paths = [[0, *np.cumsum(stride[list(order)])] for order in permutations(range(3))]
    lowest = lattice[: counts[0], : counts[1], : counts[2]].reshape(-1, 3) @ stride
    return lattice.reshape(-1, 3), (lowest[:, None, None] + np.array(paths)).reshape(-1, 4)


def triangle(n: int) -> tuple[Ints, Ints]:
    """Lattice points i, j >= 0, i + j <= n (v, 2), and the n**2 triangles between them (f, 3).

    >>> [tuple(map(len, triangle(n))) for n in (1, 2, 3)]
    [(3, 1), (6, 4), (10, 9)]
    """
    points = np.array([(i, j) for i in range(n + 1) for j in range(n + 1 - i)])
    number = {(i, j): k for k, (i, j) in enumerate(points.tolist())}
    rows = [
        [number[corner] for corner in ((i, j), (i, j + 1), (i + 1, j))]
        for i, j in number
        if i + j < n
    ]
    rows += [
        [number[corner] for corner in ((i, j + 1), (i + 1, j), (i + 1, j + 1))]
        for i, j in number
        if i + j < n - 1
    ]
    return points, np.array(rows)


def prisms(triangles: Ints, count: int, layers: int) -> Ints:
    """Three tets (t, 4) in each prism between copies of a net of `count` points.

    With a < b < c below and A, B, C above: abcC, abBC, aABC. The quadrilateral over an edge is
    cut from its lower first corner, whichever prism looks at it.

    >>> prisms(np.array([[0, 1, 2]]), 3, 1).tolist()
    [[0, 1, 2, 5], [0, 1, 4, 5], [0, 3, 4, 5]]
    """
    low = np.sort(triangles, axis=1)
    a, b, c = low.T
    top = low + count
    tets = np.stack([[a, b, c, top[:, 2]], [a, b, top[:, 1], top[:, 2]], [a, *top.T]])
    one = tets.transpose(0, 2, 1).reshape(-1, 4)
    return np.concatenate([one + layer * count for layer in range(layers)])


def mirrored(points: Floats, cells: Ints, axes: int) -> tuple[Floats, Ints, Ints]:
    """Points and cells mirrored in the first `axes` coordinate planes, and each point's original.

    Points on a mirror are their own image; they are found by their exact zeros. Two mirrors
    make four of a triangle that touches both:

    >>> corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    >>> points, cells, origin = mirrored(corners, np.array([[0, 1, 2]]), 2)
    >>> len(points), len(cells), np.bincount(origin).tolist()
    (5, 4, [1, 2, 2])
    """
    signs = np.array(list(product((1, -1), repeat=axes)))
    signs = np.column_stack([signs, np.ones((len(signs), 3 - axes), np.int64)])
    images = np.where(points == 0, 1, signs[:, None, :])
    codes = (images < 0) @ np.array([1, 2, 4]) * len(points) + np.arange(len(points))
    distinct, numbers = np.unique(codes, return_inverse=True)
    numbers = numbers.reshape(codes.shape)
    origin = distinct % len(points)
    placed = np.empty((len(distinct), 3))
    placed[numbers] = points * images
    return placed, np.concatenate([row[cells] for row in numbers]), origin


def radii(vectors: Floats) -> Floats:
    """Distances from the origin (v,), 1 in place of 0."""
    distance = np.linalg.norm(vectors, axis=1)
    return np.asarray(np.where(distance > 0, distance, 1.0))
