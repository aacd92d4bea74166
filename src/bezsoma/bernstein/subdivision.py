# SPDX-License-Identifier: BSD-3-Clause
"""Smaller simplices within one, and the nets of a polynomial on them.

A *child* is given by the barycentric coordinates of its corners in its parent, (d+1, d+1).  Its
net is the parent's blossom at those corners (`nets.restriction`), so a child holds the same
polynomial (paper, eq. 58), only looked at more closely: the net of a child of half the size lies
four times as close to the polynomial's graph.

Vertices come before midpoints, and midpoints follow the edges 01, 02, 03, 12, 13, 23.  A mesh
whose vertices ascend, and which numbers new vertices by edges in lexicographic order, then has
ascending children without sorting anything.
"""

from __future__ import annotations

from functools import cache
from itertools import combinations, product
from typing import Any

import numpy as np

from bezsoma.arrays import Floats, Ints, Numbers, frozen
from bezsoma.bernstein.basis import values
from bezsoma.bernstein.indices import count, domain_points
from bezsoma.bernstein.nets import restriction
from bezsoma.errors import InputError

DIAGONALS = ((4, 9), (5, 8), (6, 7))
"""Opposite midpoints of a tet, ends of the three diagonals of its inner octahedron."""
ROUNDING = 1e-12
"""By so much the coordinates of a point may miss 1 in sum."""


@cache
def refinement_points(dim: int) -> Floats:
    """The vertices of a simplex and then the midpoints of its edges, barycentric (p, d+1).

    >>> refinement_points(1).tolist()
    [[1.0, 0.0], [0.0, 1.0], [0.5, 0.5]]
    """
    vertices = np.eye(dim + 1)
    edges = np.array(list(combinations(range(dim + 1), 2)), np.int64).reshape(-1, 2)
    return frozen(np.concatenate([vertices, vertices[edges].mean(axis=1)]))


@cache
def uniform_corners(dim: int, diagonal: int = 0) -> Ints:
    """The 2^d children (2^d, d+1) that halve every edge, as ascending rows of `refinement_points`.

    An edge gives two, a triangle four.  A tet gives four at its vertices, and around one of the
    three diagonals of the octahedron that is left, four more (Bey 1995,
    doi:10.1007/BF02238487); all eight have an eighth of the volume:

    >>> uniform_corners(2).tolist()
    [[0, 3, 4], [1, 3, 5], [2, 4, 5], [3, 4, 5]]
    >>> eighths = [np.linalg.det(uniform_children(3, diagonal)) for diagonal in range(3)]
    >>> bool(np.allclose(np.abs(eighths), 1 / 8, rtol=1e-15))
    True
    """
    if not 1 <= dim <= 3:
        raise InputError(f"a simplex of dimension {dim} has no edges to halve; give 1, 2 or 3")
    edges = list(combinations(range(dim + 1), 2))
    rows = [
        [vertex, *(dim + 1 + k for k, edge in enumerate(edges) if vertex in edge)]
        for vertex in range(dim + 1)
    ]
    if dim == 2:
        rows.append([3, 4, 5])
    if dim == 3:
        if diagonal not in (0, 1, 2):
            raise InputError(f"an octahedron has the diagonals 0, 1 and 2, and not {diagonal!r}")
        others = [pair for k, pair in enumerate(DIAGONALS) if k != diagonal]
        rows += [sorted((*DIAGONALS[diagonal], *ends)) for ends in product(*others)]
    return frozen(np.array(rows))


@cache
def uniform_children(dim: int, diagonal: int = 0) -> Floats:
    """The corners (2^d, d+1, d+1) of the children that halve every edge; `uniform_corners`."""
    return frozen(refinement_points(dim)[uniform_corners(dim, diagonal)])


def bisection_children(dim: int, edge: tuple[int, int], at: float = 0.5) -> Floats:
    """The corners (2, d+1, d+1) of two children that meet at a point of an edge (i, j).

    The point is (1 - at) vertex i + at vertex j.  The first child keeps vertex i, and has the
    point in the place of vertex j; the second keeps j.

    >>> bisection_children(1, (0, 1), 0.25).tolist()
    [[[1.0, 0.0], [0.75, 0.25]], [[0.75, 0.25], [0.0, 1.0]]]
    """
    i, j = edge
    if i == j or not {i, j} <= set(range(dim + 1)):
        raise InputError(f"a simplex of dimension {dim} has no edge {edge}; vertices count from 0")
    if not 0 < at < 1:
        raise InputError(f"an edge cannot be cut at {at}: a number between 0 and 1 is needed")
    children = np.tile(np.eye(dim + 1), (2, 1, 1))
    children[0, j, [i, j]] = children[1, i, [i, j]] = 1 - at, at
    return children


def split_children(point: Any) -> Floats:
    """The corners (d+1, d+1, d+1) of the children that meet in a point (d+1,) inside.

    Child i has the point in the place of vertex i, and the part L_i of the volume.

    >>> point = np.array([0.5, 0.25, 0.125, 0.125])
    >>> np.linalg.det(split_children(point)).round(15).tolist()
    [0.5, 0.25, 0.125, 0.125]
    """
    inner = np.asarray(point, dtype=np.float64)
    inside = inner.ndim == 1 and 2 <= len(inner) <= 4 and bool((inner > 0).all())
    if not inside or abs(inner.sum() - 1) > ROUNDING:
        raise InputError(
            f"the point {inner.tolist()} is not inside a simplex: 2 to 4 barycentric coordinates, "
            "all of them positive and 1 in sum, are needed"
        )
    children = np.tile(np.eye(len(inner)), (len(inner), 1, 1))
    children[np.arange(len(inner)), np.arange(len(inner))] = inner
    return children


def restricted(nets: Numbers, degree: int, corners: Numbers) -> Floats:
    """The nets (q, m_e, ..) of q polynomials (q, m_d, ..), each on a sub-simplex of its own.

    The sub-simplex has the corners (e+1, d+1) in its polynomial's simplex, (q, e+1, d+1) in all:
    a child, a face, an edge, or anything else, in any order of corners.  One constant matrix is
    formed for each set of corners that occurs, and applied to all that have it; so this is quick
    where few do, as after a uniform subdivision (16) or a bisection.

    >>> both = restricted(np.array([[0.0, 0, 4]] * 2), 2, bisection_children(1, (0, 1)))
    >>> both.tolist()                                          # 4 t^2 on either half
    [[0.0, 0.0, 1.0], [1.0, 2.0, 4.0]]
    """
    nets, corners = np.asarray(nets, np.float64), np.asarray(corners, np.float64)
    if corners.ndim != 3 or len(corners) != len(nets):
        raise InputError(
            f"corners of shape {corners.shape} were given for {len(nets)} nets; one set of "
            "corners for each is needed, (nets, e+1, d+1)"
        )
    dim, sub = corners.shape[2] - 1, corners.shape[1] - 1
    flat = nets.reshape(len(nets), count(degree, dim), -1)
    found = np.empty((len(nets), count(degree, sub), flat.shape[2]))
    for rows in _alike(corners):
        found[rows] = np.matmul(restriction(degree, dim, corners[rows[0]]), flat[rows])
    return found.reshape(len(nets), -1, *nets.shape[2:])


def _alike(corners: Floats) -> list[Ints]:
    """The positions that have the same corners, group by group; found by their bytes."""
    flat = np.ascontiguousarray(corners.reshape(len(corners), -1)) + 0.0  # -0.0 is 0.0
    keys = flat.view(np.dtype((np.void, flat.itemsize * flat.shape[1]))).ravel()
    _, group = np.unique(keys, return_inverse=True)
    order = np.argsort(group, kind="stable")
    starts = np.flatnonzero(np.diff(group[order])) + 1
    return [rows for rows in np.split(order, starts) if len(rows)]


def uniform_nets(controls: Any, degree: int, dim: int, levels: int) -> tuple[Floats, Floats]:
    """Corners (s, d+1, d+1) and nets (s, m, ..) of all s = 2^(d levels) descendants of a net.

    Each level halves every edge.  With `graph_distance` this shows the net becoming the graph:

    >>> net = [0.0, 1.0, 0.0]                                  # 2 t (1 - t)
    >>> [graph_distance(uniform_nets(net, 2, 1, level)[1], 2, 1) for level in range(3)]
    [0.5, 0.125, 0.03125]
    """
    corners = np.eye(dim + 1)[None]
    nets = np.asarray(controls, np.float64)[None]
    children = uniform_children(dim)
    for _ in range(levels):
        nets = restricted(
            np.repeat(nets, len(children), axis=0), degree, np.tile(children, (len(nets), 1, 1))
        )
        corners = (children @ corners[:, None]).reshape(-1, dim + 1, dim + 1)
    return corners, nets


def graph_distance(nets: Numbers, degree: int, dim: int) -> float:
    """The largest |b_alpha - p(alpha/n)| of nets (s, m, ..): how far a control is from the graph.

    It falls by four with each halving, and by one half with twice the degree of elevation
    (docs/theory/subdivision.md).
    """
    nets = np.asarray(nets, np.float64)
    flat = nets.reshape(len(nets), nets.shape[1], -1)
    at_points = np.matmul(values(degree, domain_points(degree, dim)), flat)
    return float(np.abs(flat - at_points).max(initial=0.0))
