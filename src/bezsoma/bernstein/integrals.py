# SPDX-License-Identifier: BSD-3-Clause
"""Integrals over one simplex in closed form, per unit measure.

Each is the *mean* over the simplex: multiply by the volume of the tet [mm3], the area of the
face [mm2] or the length of the edge [mm].  With exact=True each gives `fractions.Fraction`.

All of it is one theorem, the simplex's beta function (for |alpha| = n):

    mean of L^alpha = alpha_0! .. alpha_d! d! / (n + d)!

so that every B_alpha of degree n has the same mean, 1 / C(n + d, d), and the mean of a product
is a quotient of binomials.  No quadrature anywhere (the paper had Maple write such integrals).
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import cache
from math import factorial, prod
from typing import Any

import numpy as np

from bezsoma.arrays import Numbers, frozen
from bezsoma.bernstein.indices import count, indices, shifts
from bezsoma.bernstein.nets import net, trace
from bezsoma.bernstein.rationals import binomial, binomial_products, quotient


def integral(degree: int, dim: int, exact: bool = False) -> Any:
    """Mean of any one B_alpha of degree n: 1 / C(n + d, d), a number.

    >>> integral(2, 3, exact=True)
    Fraction(1, 10)
    """
    return quotient(1, count(degree, dim), exact)[()]


def monomial(alpha: Sequence[int], exact: bool = False) -> Any:
    """Mean of L^alpha over the simplex of dimension len(alpha) - 1, a number.

        alpha_0! .. alpha_d! d! / (|alpha| + d)!

    >>> monomial((1, 1), exact=True)        # of t (1 - t) on the unit interval
    Fraction(1, 6)
    """
    dim = len(alpha) - 1
    above = prod(factorial(int(a)) for a in alpha) * factorial(dim)
    return quotient(above, factorial(int(sum(alpha)) + dim), exact)[()]


@cache
def mass(degree_a: int, degree_b: int, dim: int, exact: bool = False) -> Numbers:
    """Means of B^n_alpha B^m_beta, (m_a, m_b).

        prod_i C(alpha_i + beta_i, alpha_i) / ( C(n + m, n) C(n + m + d, d) )

    >>> (6 * mass(1, 1, 1, exact=True)).tolist() == [[2, 1], [1, 2]]
    True
    """
    a, b = indices(degree_a, dim)[:, None], indices(degree_b, dim)
    return frozen(quotient(binomial_products(a + b, a), _below(degree_a, degree_b, dim), exact))


def _below(degree_a: int, degree_b: int, dim: int) -> int:
    """The divisor that all means of products share."""
    total = degree_a + degree_b
    return binomial(total, degree_a) * binomial(total + dim, dim)


def _zeros(shape: tuple[int, ...], exact: bool) -> Numbers:
    return np.full(shape, Fraction(0), dtype=object) if exact else np.zeros(shape)


def ladder(degree_a: int, degree_b: int, dim: int, exact: bool = False) -> Numbers:
    """The weights a_j > 0, (min(n, m) + 1,), of the mass matrix as a sum over elevations.

        mass = sum_j a_j E_j E'_j^T ,   a_j = C(n, j) C(m, j) / ( C(n+m, n) C(n+m+d, d) )

    E_j, E'_j elevate from degree j to n and to m.  It is Vandermonde's identity
    C(a + b, a) = sum_k C(a, k) C(b, k) in each index.  Applied rung by rung, the mass matrix
    then costs additions and scalings only, all of them positive.

    >>> from bezsoma.bernstein.nets import elevation
    >>> steps = [elevation(j, 3, 3 - j, exact=True) for j in range(4)]
    >>> rungs = zip(ladder(3, 3, 3, exact=True), steps)
    >>> bool((sum(a * (E @ E.T) for a, E in rungs) == mass(3, 3, 3, exact=True)).all())
    True
    """
    rungs = range(min(degree_a, degree_b) + 1)
    ways = [binomial(degree_a, j) * binomial(degree_b, j) for j in rungs]
    return quotient(ways, _below(degree_a, degree_b, dim), exact)


@cache
def gradient_moments(degree_a: int, degree_b: int, dim: int, exact: bool = False) -> Numbers:
    """Means of dB^n_alpha/dL_i B^m_beta, (d+1, m_a, m_b): what couples a pressure to a divergence.

        n mass(n-1, m)[alpha - e_i, beta] ,  zero where alpha_i = 0

    The L_i count as independent, as in `derivatives`: contract axis 0 with grad L.

    On the unit interval, d/dt = d/dL_1 - d/dL_0, and the mean of (t^2)' t is 2/3:

    >>> (gradient_moments(2, 1, 1, exact=True)[1] - gradient_moments(2, 1, 1, exact=True)[0])[2, 1]
    Fraction(2, 3)
    """
    means = _zeros((dim + 1, count(degree_a, dim), count(degree_b, dim)), exact)
    if degree_a > 0:
        lower = degree_a * mass(degree_a - 1, degree_b, dim, exact)
        for i in range(dim + 1):
            means[i, shifts(degree_a, dim)[:, i]] = lower
    return frozen(means)


@cache
def gradient_products(degree: int, dim: int, exact: bool = False) -> Numbers:
    """Means of dB_alpha/dL_i dB_beta/dL_j, (d+1, d+1, m, m): the stuff of stiffness matrices.

        n^2 mass(n-1, n-1)[alpha - e_i, beta - e_j] ,  zero where alpha_i or beta_j = 0

    so each of the (d+1)^2 blocks is one and the same small matrix, scattered.  On a tet of
    volume V with g_i = grad L_i,

        integral of d_k B_alpha d_l B_beta = V sum_ij g_ik g_jl gradient_products[i, j] .

    On the unit interval (g_0 = -1, g_1 = 1) this is the stiffness matrix of the hat functions,
    elevated to degree 2:

    >>> from bezsoma.bernstein.nets import elevation
    >>> g = np.array([-1, 1])
    >>> stiffness = [np.einsum("i,j,ijab->ab", g, g, gradient_products(n, 1)) for n in (1, 2)]
    >>> stiffness[0].tolist()
    [[1.0, -1.0], [-1.0, 1.0]]
    >>> up = elevation(1, 1)
    >>> np.allclose(up.T @ stiffness[1] @ up, stiffness[0], atol=1e-15)
    True
    """
    size = count(degree, dim)
    means = _zeros((dim + 1, dim + 1, size, size), exact)
    if degree > 0:
        lower = degree**2 * mass(degree - 1, degree - 1, dim, exact)
        up = shifts(degree, dim).T
        for i in range(dim + 1):
            for j in range(dim + 1):
                means[i, j][np.ix_(up[i], up[j])] = lower
    return frozen(means)


@cache
def face_mass(
    degree_a: int, degree_b: int, dim: int, vertices: tuple[int, ...], exact: bool = False
) -> Numbers:
    """Means of B^n_alpha B^m_beta over the face or edge with these vertices, (m_a, m_b).

    The face's own mass matrix at its own controls (see `nets.trace`); all others vanish there.
    Multiply by the face's area or the edge's length.

    >>> face_mass(1, 1, 2, (0, 2), exact=True)[2].tolist() == [Fraction(1, 6), 0, Fraction(1, 3)]
    True
    """
    means = _zeros((count(degree_a, dim), count(degree_b, dim)), exact)
    rows, columns = trace(degree_a, dim, vertices), trace(degree_b, dim, vertices)
    means[np.ix_(rows, columns)] = mass(degree_a, degree_b, len(vertices) - 1, exact)
    return frozen(means)


def moments(controls: Any, degree: int, tests: int, dim: int) -> Numbers:
    """Means of p B_alpha for each B_alpha of degree `tests`, (m_tests, ..); p is its controls.

        mass(tests, n) @ controls

    The force that a polynomial load of any degree does on each control, exactly.  The constant
    6 weighs on each of the three controls of degree 2 alike:

    >>> moments([6.0], 0, 2, 1)
    array([2., 2., 2.])
    """
    controls = net(controls, degree, dim)
    matrix = mass(tests, degree, dim, exact=controls.dtype == object)
    return np.asarray(np.tensordot(matrix, controls, axes=1))
