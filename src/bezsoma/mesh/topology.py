# SPDX-License-Identifier: BSD-3-Clause
"""Who touches whom: faces and edges of tets.

Rows of vertex numbers are ascending throughout, so equal simplices are equal rows and there is
no orientation to compare.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from bezsoma import _core
from bezsoma.arrays import Floats, Int32s, Ints, frozen

EDGES = ((0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3))
"""The local edges of a tet, in the order of `edges_of_tet`."""
FACES = ((1, 2, 3), (0, 2, 3), (0, 1, 3), (0, 1, 2))
"""The local faces of a tet, in the order of `faces_of_tet`: face i lies opposite vertex i."""
_KEYS = 2**62


def slices(count: int, size: int = 1 << 15) -> Iterator[slice]:
    """Runs of `size` rows that cover `count`: scratch arrays stay small, and near the processor.

    >>> list(slices(5, 3))
    [slice(0, 3, None), slice(3, 6, None)]
    """
    return (slice(start, start + size) for start in range(0, count, size))


def packed(rows: Ints, count: int) -> Ints:
    """One integer a row (r,), in the order of the rows; `count` bounds the entries.

    Sorting these is many times faster than sorting rows. Where count**k would not fit into 64
    bits (three columns beyond some two million vertices), the leading columns are replaced by
    their rank, which keeps the order.

    >>> packed(np.array([[0, 2], [1, 0]]), 3)
    array([2, 3])
    >>> rows = np.array([[5, 7, 9], [5, 7, 8], [0, 1, 2]])
    >>> bool((np.argsort(packed(rows, 10)) == np.argsort(packed(rows, 2**40))).all())
    True
    """
    key = rows[:, 0].astype(np.int64)
    bound = count
    for column in rows.T[1:]:
        if bound * count >= _KEYS:
            distinct, key = np.unique(key, return_inverse=True)
            bound = len(distinct)
        key = key * count + column
        bound *= count
    return key


def simplices(tets: Ints, local: tuple[tuple[int, ...], ...], count: int) -> tuple[Int32s, Int32s]:
    """The distinct simplices that `local` (`EDGES` or `FACES`) cuts out of ascending tets (t, 4).

    Their rows (s, k), ascending and in lexicographic order, and the numbers (t, 6) or (t, 4) of
    those that each tet has. A tet alone has four faces, each its own; Euler's relation holds for
    the ball that two make:

    >>> tets = np.array([[0, 1, 2, 3], [1, 2, 3, 4]])
    >>> (faces, of_tet), (edges, _) = simplices(tets, FACES, 5), simplices(tets, EDGES, 5)
    >>> 5 - len(edges) + len(faces) - len(tets), of_tet.tolist()
    (1, [[3, 2, 1, 0], [6, 5, 4, 3]])
    """
    rows, of_tet = _core.simplices(tets, count, len(local[0]))
    return frozen(rows), frozen(of_tet)


def numbers(rows: Ints, among: Ints | Int32s) -> Ints:
    """The number (r,) of each ascending row in the lexicographic list `among`; -1 where none.

    >>> numbers(np.array([[1, 2], [0, 3]]), np.array([[0, 1], [1, 2], [2, 3]])).tolist()
    [1, -1]
    """
    return _core.numbers_among(np.ascontiguousarray(rows), among)


def cross(a: Floats, b: Floats) -> Floats:
    """The vector product (..., 3), several times faster than NumPy's general one.

    >>> cross(np.array([1.0, 0, 0]), np.array([0, 1.0, 0]))
    array([0., 0., 1.])
    """
    product = np.empty(np.broadcast_shapes(a.shape, b.shape))
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        product[..., i] = a[..., j] * b[..., k] - a[..., k] * b[..., j]
    return product


def determinants(corners: Floats) -> Floats:
    """det[p1 - p0, p2 - p0, p3 - p0] (t,) of tets (t, 4, 3): six times the signed volume, mm3.

    Differences come before products, so that a mesh 1000 mm from the origin loses nothing:

    >>> unit = np.array([[[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]])
    >>> determinants(unit), determinants(unit + 2.0**40)
    (array([1.]), array([1.]))
    """
    a, b, c = (corners[:, i] - corners[:, 0] for i in (1, 2, 3))
    return np.asarray(np.einsum("td,td->t", a, cross(b, c)))
