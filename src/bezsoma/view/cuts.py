# SPDX-License-Identifier: BSD-3-Clause
"""Ways to cut a facet into small triangles when its three edges are cut in different numbers.

Inside lies a regular lattice; between its rim and each edge runs a strip, zipped together from
both sides. A strip knows its own edge only, so any three go together, and the whole is one of a
few constant patterns: what is evaluated on it is a product with a constant matrix.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from bezsoma.arrays import Floats, Ints, frozen
from bezsoma.view.lattice import ROUND, SIDES, along, lattice_points, small_triangles

STEPS = (1, 2, 3, 4, 5, 6, 8, 10, 12, 16, 20, 24, 32, 40, 48, 64, 96, 128, 192, 256)
"""The numbers of parts that are used: few, so that many facets share a pattern."""
LEAST_INSIDE = 3
"""Parts of the smallest lattice with a point inside."""


@dataclass(frozen=True, eq=False)
class Cut:
    """A facet cut into small triangles."""

    bary: Floats
    """(s, 3) samples: the corners, then those inside the edges 01, 02, 12, then those inside."""
    triangles: Ints
    """(q, 3) rows of samples; each turns as the facet does."""
    rim: int
    """How many of the samples are on the rim."""


@cache
def cut(
    parts: tuple[int, int, int],
    inside: int,
    nipped: tuple[bool, bool, bool] = (False, False, False),
) -> Cut:
    """The edges 01, 02, 12 cut in these parts, and a lattice of so many parts an edge inside.

    Where all four agree it is that lattice; else it needs `LEAST_INSIDE`. A corner that is nipped
    has a triangle of its own, between the first points on its two edges; one that is not is
    joined to the corner of the lattice inside. The small triangles fill the facet:

    >>> for found in (cut((1, 2, 4), 3), cut((4, 4, 4), 4), cut((3, 2, 2), 4, (True, True, False))):
    ...     areas = np.linalg.det(found.bary[found.triangles])
    ...     bool(areas.min() > 0), round(float(areas.sum()), 12)
    (True, 1.0)
    (True, 1.0)
    (True, 1.0)
    """
    inner = (lattice_points(inside - 3) + 1) / inside if inside > 2 else np.empty((0, 3))
    bary = [np.eye(3)]
    for (i, j), count in zip(SIDES, parts, strict=True):
        bary.append(np.zeros((count - 1, 3)))
        bary[-1][:, [i, j]] = inside_edge(count)
    if parts == (inside,) * 3:
        triangles = _lattice_numbers(inside)[small_triangles(inside)]
    else:
        triangles = _stitched(parts, inside, nipped)
    return Cut(frozen(np.concatenate([*bary, inner])), frozen(triangles), sum(parts))


def inside_edge(parts: int) -> Floats:
    """The points (parts - 1, 2) that cut an edge in equal parts, barycentric.

    >>> inside_edge(4).tolist()
    [[0.75, 0.25], [0.5, 0.5], [0.25, 0.75]]
    """
    second = np.arange(1, parts) / parts
    return np.stack([1 - second, second], axis=1)


def _edges(parts: tuple[int, int, int]) -> dict[tuple[int, int], Ints]:
    """Samples along each edge in either direction, its corners included."""
    found, start = {}, 3
    for (i, j), count in zip(SIDES, parts, strict=True):
        row = np.array([i, *range(start, start + count - 1), j])
        found[i, j], found[j, i] = row, row[::-1]
        start += count - 1
    return found


def _lattice_numbers(parts: int) -> Ints:
    """The sample of each of the `lattice_points`."""
    numbers = np.full(len(lattice_points(parts)), -1)
    for side, samples in _edges((parts,) * 3).items():
        numbers[along(parts, side)] = samples
    numbers[numbers < 0] = 3 * parts + np.arange((numbers < 0).sum())
    return numbers


def _stitched(parts: tuple[int, int, int], inside: int, nipped: tuple[bool, bool, bool]) -> Ints:
    edges, rest, rim = _edges(parts), inside - 3, sum(parts)
    rows = [rim + small_triangles(rest)] if rest else []
    for i, j in ROUND:
        outer, inner = edges[i, j], rim + along(rest, (i, j))
        both = np.concatenate([outer, inner])
        rows.append(both[strip(len(outer) - 1, inside, (nipped[i], nipped[j]))])
        if nipped[i]:
            first, last = edges[i, j][1], edges[i, 3 - i - j][1]
            rows.append(np.array([[i, first, last], [first, inner[0], last]]))
    return np.concatenate(rows)


@cache
def strip(parts: int, inside: int, nipped: tuple[bool, bool] = (False, False)) -> Ints:
    """Triangles (q, 3) between an edge in `parts` and the row of a lattice of `inside` parts.

    Rows 0 to `parts` are the edge's points, the rest those of the row, `inside` - 2 of them;
    whichever side has its next point nearer goes on. Where an end is nipped its point is left out.

    >>> strip(2, 3).tolist(), strip(2, 3, (True, False)).tolist()
    ([[0, 1, 3], [1, 2, 3]], [[1, 2, 3]])
    """
    edge, row = np.arange(parts + 1) / parts, (np.arange(inside - 2) + 1.5) / inside
    found, j, m, end = [], int(nipped[0]), 0, parts - nipped[1]
    while j < end or m < len(row) - 1:
        on = m == len(row) - 1 or (j < end and edge[j + 1] <= row[m + 1])
        found.append([j, j + 1 if on else parts + 2 + m, parts + 1 + m])
        j, m = (j + 1, m) if on else (j, m + 1)
    return frozen(np.array(found, np.int64).reshape(-1, 3))


@cache
def strip_corners(parts: int, inside: int, edge: int, nipped: tuple[bool, bool]) -> Floats:
    """The corners (q, 3, 3) of the triangles of a strip along an edge, barycentric."""
    i, j = ROUND[edge]
    points = np.zeros((parts + inside - 1, 3))
    points[: parts + 1, j] = np.arange(parts + 1) / parts
    points[parts + 1 :, j] = (np.arange(inside - 2) + 1) / inside
    points[parts + 1 :, 3 - i - j] = 1 / inside
    points[:, i] = 1 - points.sum(axis=1)
    return frozen(points[strip(parts, inside, nipped)])


@cache
def nip_corners(parts: tuple[int, int], inside: int, corner: int) -> Floats:
    """The corners (2, 3, 3) of the two triangles at a nipped corner, barycentric.

    `parts` are those of the edges to the next corner and to the one before it.
    """
    i, j, k = corner, (corner + 1) % 3, (corner + 2) % 3
    at = np.zeros((4, 3))  # the corner, the first points on both edges, the lattice's corner
    at[1, j], at[2, k] = 1 / parts[0], 1 / parts[1]
    at[3, [j, k]] = 1 / inside
    at[:, i] = 1 - at.sum(axis=1)
    return frozen(at[[[0, 1, 2], [1, 3, 2]]])
