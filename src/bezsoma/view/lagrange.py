# SPDX-License-Identifier: BSD-3-Clause
"""The order in which VTK lists the points of a Lagrange triangle or tetrahedron.

VTK numbers the lattice points of a simplex from its rim inwards: the vertices, then the inner
points of the edges, each from its first to its second vertex, then the insides of the faces, then
the inside of the cell. The inside of a triangle of degree n is itself a triangle of degree n - 3,
that of a tetrahedron a tetrahedron of degree n - 4, listed by the same rule. The cycles below
are VTK's own; `tests/laws/test_vtk.py` holds them against VTK where it is installed.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from bezsoma.arrays import Ints, frozen
from bezsoma.bernstein import position

_TRIANGLE_EDGES = ((0, 1), (1, 2), (2, 0))
_TET_EDGES = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))
_TET_FACES = ((0, 1, 3), (2, 3, 1), (0, 3, 2), (0, 2, 1))


def _rim(degree: int, dim: int, edges: tuple[tuple[int, int], ...]) -> Ints:
    """Vertices and inner edge points (r, dim + 1) of a simplex of degree at least 1."""
    unit = np.eye(dim + 1, dtype=np.int64)
    along = [(degree - k) * unit[a] + k * unit[b] for a, b in edges for k in range(1, degree)]
    return np.array([*(degree * unit), *along])


@cache
def lattice(degree: int, dim: int) -> Ints:
    """Multi-indices (m, dim + 1) of the lattice points in VTK's order; dim is 2 or 3.

    Every multi-index of the degree stands there once, so the order is a permutation of ours:

    >>> lattice(2, 2).tolist()
    [[2, 0, 0], [0, 2, 0], [0, 0, 2], [1, 1, 0], [0, 1, 1], [1, 0, 1]]
    >>> from bezsoma.bernstein import indices
    >>> all(
    ...     sorted(lattice(n, d).tolist()) == sorted(indices(n, d).tolist())
    ...     for n in range(1, 11)
    ...     for d in (2, 3)
    ... )
    True
    """
    if degree < 0:
        return np.empty((0, dim + 1), np.int64)
    if degree == 0:
        return np.zeros((1, dim + 1), np.int64)
    if dim == 2:
        parts = [_rim(degree, 2, _TRIANGLE_EDGES), lattice(degree - 3, 2) + 1]
    else:
        parts = [_rim(degree, 3, _TET_EDGES)]
        for face in _TET_FACES:
            inside = np.zeros((len(lattice(degree - 3, 2)), 4), np.int64)
            inside[:, face] = lattice(degree - 3, 2) + 1
            parts.append(inside)
        parts.append(lattice(degree - 4, 3) + 1)
    return frozen(np.concatenate(parts))


@cache
def vtk_order(degree: int, dim: int, mirrored: bool = False) -> Ints:
    """Positions (m,) in our order of the points that VTK expects, one after the other.

    Our simplices have ascending vertices, so half of them are left-handed; VTK's are all
    right-handed. A left-handed one is written with its last two vertices exchanged: `mirrored`.

    >>> vtk_order(1, 3).tolist(), vtk_order(1, 3, mirrored=True).tolist()
    ([0, 1, 2, 3], [0, 1, 3, 2])
    """
    rows = lattice(degree, dim)
    if mirrored:
        rows = np.concatenate([rows[:, :-2], rows[:, :-3:-1]], axis=1)
    return frozen(np.asarray(position(rows)))
