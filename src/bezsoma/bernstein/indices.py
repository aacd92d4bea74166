# SPDX-License-Identifier: BSD-3-Clause
"""Multi-indices: the addresses of controls in the net of one simplex.

A polynomial of degree n on a simplex of dimension d (a point, an edge, a triangle, a tet for
d = 0, 1, 2, 3) has one control for each alpha = (alpha_0, .., alpha_d) of non-negative integers
with |alpha| = alpha_0 + .. + alpha_d = n.  They stand in *descending lexicographic* order, in
this package, in its C++ core and in its files:

    (n,0,0,0), (n-1,1,0,0), (n-1,0,1,0), (n-1,0,0,1), (n-2,2,0,0), (n-2,1,1,0), ..

The order has one gift: the position depends on alpha_1 .. alpha_d alone.  Raising alpha_0, the
degree with it, moves nothing, so the net of degree n-1 lies in the net of degree n as its head.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from bezsoma.arrays import Floats, Ints, frozen
from bezsoma.bernstein.rationals import LARGEST, PASCAL, binomial
from bezsoma.errors import InputError


def count(degree: int, dim: int) -> int:
    """The number of controls, C(n + d, d).

    >>> [count(n, 3) for n in range(5)]
    [1, 4, 10, 20, 35]
    """
    if not (0 <= degree <= LARGEST and 0 <= dim <= 3):
        raise InputError(
            f"degree {degree} on a simplex of dimension {dim} was asked for; "
            f"degrees go from 0 to {LARGEST} and dimensions from 0 to 3"
        )
    return binomial(degree + dim, dim)


@cache
def indices(degree: int, dim: int) -> Ints:
    """All multi-indices of the degree, (m, d+1), in descending lexicographic order.

    The first entry falls from n to 0; what it leaves over is shared out among the others in
    the order of their own, smaller simplex.

    >>> indices(2, 2).tolist()
    [[2, 0, 0], [1, 1, 0], [1, 0, 1], [0, 2, 0], [0, 1, 1], [0, 0, 2]]
    """
    every = np.full((count(degree, dim), dim + 1), degree, dtype=np.int64)
    if dim > 0:
        every[:, 1:] = np.concatenate([indices(rest, dim - 1) for rest in range(degree + 1)])
        every[:, 0] -= every[:, 1:].sum(axis=1)
    return frozen(every)


def position(alpha: Ints) -> Ints:
    """Where the multi-indices (.., d+1) stand in `indices` of their own degree and dimension.

    Before alpha come all those that leave less to their tail; with the tail sums
    t_i = alpha_i + .. + alpha_d, level by level,

        position = sum over i = 1 .. d of C(t_i + d - i, d - i + 1).

    >>> bool((position(indices(7, 3)) == np.arange(count(7, 3))).all())
    True
    """
    alpha = np.asarray(alpha, dtype=np.int64)
    dim = alpha.shape[-1] - 1
    tails = np.cumsum(alpha[..., :0:-1], axis=-1)  # t_d, .., t_1
    below = np.arange(dim)  # d - i
    return np.asarray(PASCAL[tails + below, below + 1].sum(axis=-1), dtype=np.int64)


@cache
def shifts(degree: int, dim: int) -> Ints:
    """Positions in degree n of beta + e_i for each beta of degree n-1: (count(n-1), d+1).

    The whole algebra walks along these.  Derivative, de Casteljau's step and degree elevation
    all look at the d+1 controls of a small simplex in the net, and this lists them.
    Column 0 is 0, 1, 2, ..: raising alpha_0 moves nothing.

    >>> shifts(2, 2).tolist()
    [[0, 1, 2], [1, 3, 4], [2, 4, 5]]
    """
    if degree < 1:
        raise InputError(f"degree {degree} has no net below it; shifts start at degree 1")
    units = np.eye(dim + 1, dtype=np.int64)
    return frozen(position(indices(degree - 1, dim)[:, None, :] + units))


@cache
def parents(degree: int, dim: int) -> tuple[Ints, Ints]:
    """For each alpha of degree n >= 1: j, its last non-zero entry, and the position of alpha - e_j.

    A tree over all multi-indices.  What is defined as a product or a composition of n affine
    pieces (a Lagrange polynomial, a row of blossoms) is built along it, one piece a step.

    >>> last, parent = parents(2, 1)   # of (2,0), (1,1), (0,2)
    >>> last.tolist(), parent.tolist()
    ([0, 1, 1], [0, 0, 1])
    """
    every = indices(degree, dim)
    last = dim - np.argmax(every[:, ::-1] > 0, axis=1)
    lower = every - np.eye(dim + 1, dtype=np.int64)[last]
    return frozen(last.astype(np.int64)), frozen(position(lower))


@cache
def multinomials(degree: int, dim: int) -> Ints:
    """The factors n! / (alpha_0! .. alpha_d!) of L^alpha in B_alpha, (m,).

    A chain of choices: C(n, alpha_0) C(n - alpha_0, alpha_1) ..

    >>> multinomials(3, 1).tolist(), int(multinomials(3, 2).sum()) == 3**3
    ([1, 3, 3, 1], True)
    """
    every = indices(degree, dim)
    left = np.cumsum(every[:, ::-1], axis=1)[:, ::-1]
    return frozen(np.asarray(np.prod(PASCAL[left, every], axis=1)))


@cache
def domain_points(degree: int, dim: int) -> Floats:
    """The points alpha / n where controls are drawn, (m, d+1) barycentric; centroid for n = 0.

    A control is *not* the value there (see `interpolation`); but controls set to an affine
    function's values at these points give that function back: linear precision.

    >>> domain_points(2, 1).tolist()
    [[1.0, 0.0], [0.5, 0.5], [0.0, 1.0]]
    """
    if degree == 0:
        return frozen(np.full((1, dim + 1), 1.0 / (dim + 1)))
    return frozen(indices(degree, dim) / degree)
