# SPDX-License-Identifier: BSD-3-Clause
"""Who touches whom: faces and edges of tets, by sorting one integer key a row.

Rows of vertex numbers are ascending throughout, so equal simplices are equal rows and there is
no orientation to compare.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bezsoma.arrays import Floats, Ints, frozen

EDGES = ((0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3))
"""The local edges of a tet, in the order of `edges_of_tet`."""
FACES = ((1, 2, 3), (0, 2, 3), (0, 1, 3), (0, 1, 2))
"""The local faces of a tet, in the order of `faces_of_tet`: face i lies opposite vertex i."""
_KEYS = 2**62


@dataclass(frozen=True, eq=False)
class Simplices:
    """The distinct edges or faces of a mesh, and which of them each tet has."""

    rows: Ints
    """(s, k) vertex numbers, rows ascending and in lexicographic order."""
    of_tet: Ints
    """(t, 6) or (t, 4) numbers into `rows`, local order `EDGES` or `FACES`."""
    counts: Ints
    """(s,) how many tets share each."""
    incidences: Ints
    """(6 t,) or (4 t,) positions in `of_tet` raveled, sorted by the number found there."""


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


def simplices(tets: Ints, local: tuple[tuple[int, ...], ...], count: int) -> Simplices:
    """The distinct simplices that `local` (`EDGES` or `FACES`) cuts out of ascending tets (t, 4).

    A tet alone has four faces, each its own; Euler's relation holds for the ball it is:

    >>> tets = np.array([[0, 1, 2, 3], [1, 2, 3, 4]])
    >>> faces, edges = simplices(tets, FACES, 5), simplices(tets, EDGES, 5)
    >>> 5 - len(edges.rows) + len(faces.rows) - len(tets)
    1
    """
    every = tets[:, np.array(local)].reshape(-1, len(local[0]))
    keys = packed(every, count)
    order = np.argsort(keys, kind="stable")
    ordered = keys[order]
    starts = np.flatnonzero(np.concatenate([[True], ordered[1:] != ordered[:-1]]))
    counts = np.diff(np.concatenate([starts, [len(keys)]]))
    of_tet = np.empty(len(keys), np.int64)
    of_tet[order] = np.repeat(np.arange(len(starts)), counts)
    return Simplices(
        frozen(every[order[starts]]),
        frozen(of_tet.reshape(len(tets), len(local))),
        frozen(counts),
        frozen(order),
    )


def neighbours(faces_of_tet: Ints, faces: int) -> Ints:
    """The two tets at each of the faces (faces, 2), the lower number first; -1 where none is.

    >>> found = simplices(np.array([[0, 1, 2, 3], [1, 2, 3, 4]]), FACES, 5)
    >>> neighbours(found.of_tet, len(found.rows)).tolist()
    [[0, -1], [0, -1], [0, -1], [0, 1], [1, -1], [1, -1], [1, -1]]
    """
    flat = faces_of_tet.ravel()
    tets = np.arange(len(flat)) // 4
    pair = np.empty((faces, 2), np.int64)
    pair[flat, 1] = tets  # of several writers the last one stays
    pair[flat[::-1], 0] = tets[::-1]
    pair[pair[:, 0] == pair[:, 1], 1] = -1
    return frozen(pair)


def numbers(rows: Ints, among: Ints, count: int) -> Ints:
    """The number (r,) of each ascending row in the lexicographic list `among`; -1 where none.

    >>> numbers(np.array([[1, 2], [0, 3]]), np.array([[0, 1], [1, 2], [2, 3]]), 4)
    array([ 1, -1])
    """
    keys = packed(np.concatenate([among, rows]), count)
    known, wanted = keys[: len(among)], keys[len(among) :]
    place = np.minimum(np.searchsorted(known, wanted), len(known) - 1)
    return np.where(known[place] == wanted, place, -1)


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
