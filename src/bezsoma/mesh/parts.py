# SPDX-License-Identifier: BSD-3-Clause
"""Which vertex, edge, face or interior of one simplex owns which of its controls."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from bezsoma import bernstein
from bezsoma.arrays import Floats, Int32s, Ints, frozen
from bezsoma.mesh.topology import EDGES, FACES

PARTS: tuple[tuple[tuple[int, ...], ...], ...] = (
    ((0,),),
    ((0,), (1,), (0, 1)),
    ((0,), (1,), (2,), (0, 1), (0, 2), (1, 2), (0, 1, 2)),
    ((0,), (1,), (2,), (3,), *EDGES, *FACES, (0, 1, 2, 3)),
)
"""The vertices, edges, faces and interior of a simplex of dimension 0, 1, 2, 3, in local order."""


@lru_cache(maxsize=64)
def owners(degree: int, dim: int) -> tuple[Ints, Ints]:
    """For each control of a simplex: the part that owns it (m,), and its rank there (m,).

    The part is a number into `PARTS[dim]`: the one spanned by the vertices at which the
    multi-index is not zero.  The rank counts the controls inside that part in the part's own
    order, which descending lexicographic order passes on to it.

    A cubic edge has a vertex, two controls inside, and a vertex:

    >>> [column.tolist() for column in owners(3, 1)]
    [[0, 2, 2, 1], [0, 0, 1, 0]]
    """
    alphas = bernstein.indices(degree, dim)
    part = [PARTS[dim].index(tuple(np.flatnonzero(alpha).tolist())) for alpha in alphas]
    seen = [0] * len(PARTS[dim])
    rank = []
    for number in part:
        rank.append(seen[number])
        seen[number] += 1
    return frozen(np.array(part, dtype=np.int64)), frozen(np.array(rank, dtype=np.int64))


@lru_cache(maxsize=64)
def inside(degree: int, dim: int) -> Ints:
    """The positions of the multi-indices without a zero: the controls inside a simplex.

    >>> inside(3, 2).tolist(), inside(3, 3).tolist()  # a cubic triangle has one, a tet none
    ([4], [])
    """
    return frozen(np.flatnonzero((bernstein.indices(degree, dim) > 0).all(axis=1)))


@lru_cache(maxsize=64)
def interpolation_inside(degree: int, dim: int) -> Floats:
    """The rows (r, m) that give the controls inside a simplex from values in its domain points.

    A parabola through 0, 1, 0 has the middle control 2, which is no value it takes:

    >>> float((interpolation_inside(2, 1) @ [0, 1, 0])[0])
    2.0
    """
    return frozen(bernstein.interpolation(degree, dim)[inside(degree, dim)])


def rows_applied(rows: Floats, values: Floats, closures: Ints | Int32s) -> Floats:
    """The rows (r, m) applied to the values (c, ...) on each closure (q, m): (r, q, ...)."""
    local = np.take(values, closures.T, axis=0)  # quicker than values[closures.T]
    columns = local.reshape(len(local), -1)
    found = np.empty((len(rows), columns.shape[1]))
    # In products too small for BLAS to wake threads of its own: see `rigid._fewer`.
    piece = max(1, 200_000 // max(1, rows.size))
    for begin in range(0, columns.shape[1], piece):
        part = slice(begin, begin + piece)
        np.matmul(rows, columns[:, part], out=found[:, part])
    return found.reshape(len(rows), *local.shape[1:])
