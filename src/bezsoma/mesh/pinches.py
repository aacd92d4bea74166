# SPDX-License-Identifier: BSD-3-Clause
"""Edges at which the boundary of tets meets itself, and the few tets to leave away for it."""

from __future__ import annotations

import numpy as np

from bezsoma.arrays import Bools, Floats, Ints
from bezsoma.mesh.topology import EDGES, FACES, packed

ROUNDS = 20
"""Leaving tets away may pinch the boundary elsewhere; after so many rounds none was ever left."""


def pinched(facets: Ints) -> Ints:
    """The edges (e, 2) that other than two of the facets (f, 3) of a boundary share.

    >>> pinched(np.array([[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]])).tolist()
    []
    """
    edges = np.sort(facets[:, [[0, 1], [0, 2], [1, 2]]].reshape(-1, 2), axis=1)
    rows, count = np.unique(edges, axis=0, return_counts=True)
    return np.asarray(rows[count != 2])


def unpinched(points: Floats, tets: Ints) -> Bools:
    """Which of the tets (t, 4) to keep so that no edge of the boundary is shared by four facets.

    Around such an edge tets stand in fans that share no face; all but the largest fan go.

    >>> points = np.array([[0, 0, 0], [0, 0, 1], [1, 0, 0], [0, 2, 0], [-1, 0, 0], [0, -1, 0.0]])
    >>> unpinched(points, np.array([[0, 1, 2, 3], [0, 1, 4, 5]])).tolist()
    [True, False]
    """
    keep = np.ones(len(tets), np.bool_)
    for _ in range(ROUNDS):
        edges = pinched(_boundary(tets[keep], len(points)))
        if not len(edges):
            break
        of_tet = np.sort(np.stack([tets[:, list(e)] for e in EDGES], axis=1), axis=2)
        key = packed(of_tet.reshape(-1, 2), len(points)).reshape(-1, len(EDGES))
        for edge in packed(edges, len(points)).tolist():
            around = np.flatnonzero((key == edge).any(axis=1) & keep)
            keep[around[_lesser(points, tets[around])]] = False
    return keep


def _boundary(tets: Ints, count: int) -> Ints:
    """The faces (b, 3) that only one tet has."""
    faces = np.sort(np.concatenate([tets[:, list(face)] for face in FACES]), axis=1)
    _, first, times = np.unique(packed(faces, count), return_index=True, return_counts=True)
    return np.asarray(faces[first[times == 1]])


def _lesser(points: Floats, tets: Ints) -> Bools:
    """Which tets (a,) around an edge do not belong to the largest fan, by volume."""
    shared = (tets[:, None, :, None] == tets[None, :, None, :]).any(axis=3).sum(axis=2) >= 3
    fan = np.arange(len(tets))
    for _ in range(len(tets)):
        fan = np.where(shared, fan, len(tets)).min(axis=1)
    a, b, c, d = (points[tets[:, i]] for i in range(4))
    volume = np.abs(np.einsum("td,td->t", b - a, np.cross(c - a, d - a)))
    size = np.bincount(fan, volume)
    return np.asarray(fan != size.argmax())
