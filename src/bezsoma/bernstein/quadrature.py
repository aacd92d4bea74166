# SPDX-License-Identifier: BSD-3-Clause
"""Quadrature on a simplex, of any exactness, with positive weights: by our own rules.

Bernstein polynomials need none: `integrals` has them in closed form.  Callable loads and
materials that are no polynomials do.  Published tables for tets end early, and some carry
negative weights or rounded digits.  Ours are of two makes:

- Symmetric rules (`rules.txt`, found and polished by tools/rules.py): few points, and the same
  ones however the vertices are numbered.  They reach as far as the search did.
- Conical products beyond (Stroud 1971, *Approximate Calculation of Multiple Integrals*, ch. 2):
  any exactness at the price of more points.

A simplex of dimension d is a cone: its apex, vertex 0, over the opposite face.  With t the way
from the apex to the face, the point is L = (1 - t, t L') with L' on the face, the slice at t has
measure t^(d-1), and a polynomial of degree p in L is one of degree p in t and in L'.  So

    mean over the simplex of f  =  integral_0^1 d t^(d-1)  mean over the face of f(1 - t, t L') dt

and a rule for the weight d t^(d-1) times a rule for the face is a rule for the simplex.  On an
edge that is Gauss's rule, which is symmetric already.
"""

from __future__ import annotations

from functools import cache
from itertools import permutations
from pathlib import Path

import numpy as np

from bezsoma.arrays import Floats, frozen
from bezsoma.errors import InputError

Rule = tuple[Floats, Floats]
"""Barycentric points (q, d+1) and weights (q,)."""


@cache
def simplex(exactness: int, dim: int) -> Rule:
    """Barycentric points (q, d+1) inside and positive weights (q,) with sum 1.

    Exact for every polynomial of degree up to `exactness`, by the smallest rule there is here
    that is; docs/theory/bernstein.md has the counts.  Weights are per unit measure: multiply by
    volume, area or length.  Renumbering vertices only reorders a symmetric rule; a conical one
    (beyond the table) is denser at vertex 0, so a function that is *not* integrated exactly
    then gives another error.

    The mean of L_0^4 over a tet is 4! 3! / 7!:

    >>> bary, weights = simplex(4, 3)
    >>> len(weights), round(float(weights @ bary[:, 0] ** 4) * 35, 14)
    (14, 1.0)
    """
    if exactness < 0 or not 0 <= dim <= 3:
        raise InputError(
            f"exactness {exactness} on a simplex of dimension {dim} was asked for; exactness is "
            "a polynomial degree, 0 or more, and dimensions go from 0 to 3"
        )
    enough = [rule for (d, p), rule in symmetric().items() if d == dim and p >= exactness]
    return min(enough, key=lambda rule: len(rule[1]), default=conical(exactness, dim))


@cache
def symmetric() -> dict[tuple[int, int], Rule]:
    """The symmetric rules by dimension and exactness, from the orbits in `rules.txt`.

    An orbit is all points that arise from one by permuting its coordinates: here the three
    of a triangle's rule for exactness 2.

    >>> symmetric()[2, 2][0].round(3).tolist()
    [[0.167, 0.167, 0.667], [0.167, 0.667, 0.167], [0.667, 0.167, 0.167]]
    """
    found: dict[tuple[int, int], list[tuple[float, ...]]] = {}
    for line in Path(__file__).with_name("rules.txt").read_text(encoding="utf-8").splitlines():
        if line.startswith("#"):
            continue
        dim, exactness, *numbers = line.split()
        *point, weight = map(float, numbers)
        orbit = sorted(set(permutations(point)))
        found.setdefault((int(dim), int(exactness)), []).extend((*L, weight) for L in orbit)
    return {
        key: (frozen(rows[:, :-1].copy()), frozen(rows[:, -1].copy()))
        for key, rows in ((key, np.array(orbits)) for key, orbits in found.items())
    }


@cache
def conical(exactness: int, dim: int) -> Rule:
    """A product of Gauss's rules with (p // 2 + 1)^d points, for any exactness p.

    >>> [len(conical(8, dim)[1]) for dim in (1, 2, 3)], len(simplex(8, 3)[1])
    ([5, 25, 125], 46)
    """
    if dim == 0:
        return frozen(np.ones((1, 1))), frozen(np.ones(1))
    t, along = cone(exactness // 2 + 1, dim)
    face, across = conical(exactness, dim - 1)
    points = np.empty((len(t), len(face), dim + 1))
    points[..., 0] = 1 - t[:, None]
    points[..., 1:] = t[:, None, None] * face
    return frozen(points.reshape(-1, dim + 1)), frozen(np.outer(along, across).ravel())


@cache
def cone(points: int, dim: int) -> tuple[Floats, Floats]:
    """Gauss's rule on [0, 1] for the weight d t^(d-1): abscissae (k,), ascending, weights (k,).

    k points are exact to degree 2k - 1.  Golub and Welsch 1969 (doi:10.2307/2004418): the
    abscissae are the eigenvalues of the Jacobi matrix; three Newton steps then clear the
    eigensolver's rounding.  The weights are 1 / sum_j p_j(t)^2 over the orthonormal
    polynomials p_0 .. p_{k-1}: positive by construction.

    For dim = 1 it is Gauss-Legendre's rule:

    >>> t, weights = cone(2, 1)
    >>> [bool(abs(error).max() < 1e-15) for error in (t * (1 - t) - 1 / 6, weights - 0.5)]
    [True, True]
    """
    middle, off = _jacobi(points, dim)
    t: Floats = np.linalg.eigvalsh(np.diag(middle) + np.diag(off[:-1], -1)).astype(np.float64)
    for _ in range(3):
        p, slope = _orthonormal(t, middle, off)
        t -= p[-1] / slope[-1]
    p, _ = _orthonormal(t, middle, off)
    return frozen(t), frozen(1 / np.sum(p[:-1] ** 2, axis=0))


def _jacobi(points: int, dim: int) -> tuple[Floats, Floats]:
    """The recurrence t p_j = off_{j-1} p_{j-1} + middle_j p_j + off_j p_{j+1}, j = 0 .. k-1.

    Of the Jacobi polynomials P^(0, b) with b = d - 1, moved from [-1, 1] to [0, 1].
    """
    b, j = dim - 1, np.arange(points)
    # For b = 0 the first quotient is 0 / 0 and stands for 0; the maximum touches nothing else.
    middle = 0.5 + 0.5 * b * b / np.maximum((2 * j + b) * (2 * j + b + 2), 1)
    j = j + 1
    off = j * (j + b) / ((2 * j + b) * np.sqrt((2.0 * j + b + 1) * (2 * j + b - 1)))
    return middle, off


def _orthonormal(t: Floats, middle: Floats, off: Floats) -> tuple[Floats, Floats]:
    """p_0 .. p_k and their slopes at t, each (k+1, len(t)), for the weight of mean 1."""
    p = np.zeros((len(middle) + 1, len(t)))
    slope = np.zeros_like(p)
    p[0] = 1
    for j in range(len(middle)):
        # For j = 0 the row before, p[-1], is the last one and still zero.
        back = off[j - 1]
        p[j + 1] = ((t - middle[j]) * p[j] - back * p[j - 1]) / off[j]
        slope[j + 1] = ((t - middle[j]) * slope[j] + p[j] - back * slope[j - 1]) / off[j]
    return p, slope
