# SPDX-License-Identifier: BSD-3-Clause
"""What can be done to a net of controls without leaving Bernstein form.

Controls stand on the leading axis, (m, ..), in the order of `indices`; further axes ride along.
Nothing but sums, products and quotients by integers is used, so nets of `fractions.Fraction`
stay exact.

One step explains them all.  A polynomial p of degree n has a *blossom*: the one function
p(v_1, .., v_n) that is symmetric, affine in each argument, and equals p(v) when all arguments
are v (Ramshaw 1989, doi:10.1016/0167-8396(89)90032-0).  Controls are its values at vertices:
b_alpha = p(vertex 0, alpha_0 times; ..; vertex d, alpha_d times).  De Casteljau's step fills in
one argument.  Filled in with the corners of another simplex, the blossom gives the controls
there: restriction to faces, subdivision.  With one argument left out, and the mean taken over
which one, it gives elevation.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from bezsoma.arrays import Ints, Numbers, frozen
from bezsoma.bernstein.indices import count, indices, multinomials, parents, position, shifts
from bezsoma.bernstein.rationals import binomial, binomial_products, exact_or_float, quotient
from bezsoma.errors import InputError


def net(controls: Any, degree: int, dim: int) -> Numbers:
    """The controls as an array, refused if their number does not fit the degree.

    >>> net([1, 2, 3], 1, 1)
    Traceback (most recent call last):
    ...
    bezsoma.errors.InputError: 3 controls were given; degree 1 in dimension 1 has 2
    """
    array = exact_or_float(controls)
    if array.ndim == 0 or len(array) != count(degree, dim):
        given = len(array) if array.ndim else "no axis of"
        raise InputError(
            f"{given} controls were given; degree {degree} in dimension {dim} "
            f"has {count(degree, dim)}"
        )
    return array


def _column(numbers: Numbers, like: Numbers) -> Numbers:
    """The numbers (m,) as (m, 1, .., 1), to multiply nets with."""
    return numbers.reshape(-1, *[1] * (like.ndim - 1))


@cache
def elevation(degree: int, dim: int, by: int = 1, exact: bool = False) -> Numbers:
    """The matrix (m_{n+r}, m_n) that writes a polynomial of degree n in degree n + r.

    Multiplying by (L_0 + .. + L_d)^r = 1 and comparing terms,

        E[alpha, beta] = prod_i C(alpha_i, beta_i) / C(n + r, n) .

    Rows are convex weights: the net moves towards the polynomial.

    >>> elevation(1, 1, exact=True).tolist() == [[1, 0], [quotient(1, 2, True)] * 2, [0, 1]]
    True
    """
    higher = _raised(degree, by)
    ways = binomial_products(indices(higher, dim)[:, None], indices(degree, dim))
    return frozen(quotient(ways, binomial(higher, degree), exact))


def _raised(degree: int, by: int) -> int:
    if by < 0:
        raise InputError(
            f"elevation of degree {degree} by {by} was asked for; only a polynomial of lower "
            "degree can be written in a lower one: elevate by 0 or more"
        )
    return degree + by


def elevated(controls: Any, degree: int, dim: int, by: int = 1) -> Numbers:
    """The same polynomial's controls in degree n + r, (m_{n+r}, ..).

    Degree by degree, by means of neighbours (Farin 1986, doi:10.1016/0167-8396(86)90016-6):

        b^{n+1}_alpha = sum_i alpha_i / (n+1) b^n_{alpha - e_i}

    >>> elevated([0.0, 1.0], 1, 1, by=3).tolist()      # linear precision
    [0.0, 0.25, 0.5, 0.75, 1.0]
    """
    lower = net(controls, degree, dim)
    for n in range(degree + 1, _raised(degree, by) + 1):
        up, below = shifts(n, dim), indices(n - 1, dim)
        higher = np.zeros((count(n, dim), *lower.shape[1:]), dtype=lower.dtype)
        for i in range(dim + 1):
            higher[up[:, i]] += _column(below[:, i] + 1, lower) * lower
        lower = quotient(higher, n)
    return lower


def de_casteljau_levels(controls: Any, degree: int, arguments: Any) -> list[Numbers]:
    """All levels of de Casteljau's scheme: nets of degree n, n-1, .., 0.

    Level k+1 fills in the argument k (d+1 barycentric numbers each, (n, d+1) in all):

        b^{k+1}_beta = sum_i L_i b^k_{beta + e_i}

    With the same point n times the levels hold the nets of all sub-simplices at that point
    (figure 5 of the paper).

    >>> half = [[0.5, 0.5]] * 2
    >>> [level.tolist() for level in de_casteljau_levels([0.0, 0.0, 4.0], 2, half)]
    [[0.0, 0.0, 4.0], [0.0, 2.0], [1.0]]
    """
    arguments = exact_or_float(arguments)
    if arguments.ndim != 2 or len(arguments) != degree:
        raise InputError(
            f"arguments of shape {arguments.shape} were given; a blossom of degree {degree} "
            f"takes {degree} barycentric points: ({degree}, d+1)"
        )
    dim = arguments.shape[1] - 1
    levels = [net(controls, degree, dim)]
    for n, point in zip(range(degree, 0, -1), arguments, strict=True):
        up, last = shifts(n, dim), levels[-1]
        levels.append(np.sum([point[i] * last[up[:, i]] for i in range(dim + 1)], axis=0))
    return levels


def de_casteljau(controls: Any, degree: int, bary: Any) -> Any:
    """The polynomial's value at one barycentric point (d+1,): shape of one control.

    By repeated averages of controls; for many points, values(n, points) @ controls is quicker.

    >>> float(de_casteljau([0.0, 0.0, 4.0], 2, [0.5, 0.5]))     # 4 L_1^2
    1.0
    """
    return blossom(controls, degree, np.tile(exact_or_float(bary), (degree, 1)))


def blossom(controls: Any, degree: int, arguments: Any) -> Any:
    """The blossom at n barycentric points (n, d+1): shape of one control.

    Symmetric in the points and affine in each; on the diagonal it is the polynomial.  Of
    4 L_1^2 it is 4 u_1 v_1:

    >>> float(blossom([0.0, 0.0, 4.0], 2, [[0.75, 0.25], [0.5, 0.5]]))
    0.5
    """
    return de_casteljau_levels(controls, degree, arguments)[-1][0]


def restriction(degree: int, dim: int, corners: Any) -> Numbers:
    """The matrix (m_e, m_d) to the controls on the sub-simplex with these corners (e+1, d+1).

    Row alpha is the blossom with corner j filled in alpha_j times (Goldman 1983, on
    subdivision), so one matrix serves subdivision (e = d), faces and edges (e < d) and
    points (e = 0).  With corners inside the simplex its rows are convex weights, and halving
    again and again drives the net to the polynomial; with corners outside it extrapolates.

    >>> left = restriction(2, 1, [[1.0, 0.0], [0.5, 0.5]])
    >>> left.tolist()
    [[1.0, 0.0, 0.0], [0.5, 0.5, 0.0], [0.25, 0.5, 0.25]]
    """
    corners = exact_or_float(corners)
    if corners.ndim != 2 or corners.shape[1] != dim + 1:
        raise InputError(
            f"corners of shape {corners.shape} were given; in dimension {dim} each corner has "
            f"{dim + 1} barycentric numbers: (corners, {dim + 1})"
        )
    rows = np.ones((1, 1), dtype=corners.dtype)
    for n in range(1, degree + 1):
        corner, parent = parents(n, len(corners) - 1)
        finer = np.zeros((len(parent), count(n, dim)), dtype=corners.dtype)
        for i in range(dim + 1):
            finer[:, shifts(n, dim)[:, i]] += corners[corner, i, None] * rows[parent]
        rows = finer
    return rows


@cache
def trace(degree: int, dim: int, vertices: tuple[int, ...]) -> Ints:
    """Positions of the controls on the face, edge or vertex with these vertices, in its order.

    On a face only its own controls live: the others' B_alpha carry a factor L_i that is zero
    there.  Vertices in another order give the face's net read in that order.

    >>> trace(2, 2, (0, 2)).tolist(), trace(2, 2, (2, 0)).tolist()
    ([0, 2, 5], [5, 2, 0])
    """
    if len(set(vertices)) != len(vertices) or not set(vertices) <= set(range(dim + 1)):
        raise InputError(
            f"vertices {vertices} were given; a simplex of dimension {dim} has "
            f"{list(range(dim + 1))}, each at most once"
        )
    on_face = indices(degree, len(vertices) - 1)
    alpha = np.zeros((len(on_face), dim + 1), dtype=np.int64)
    alpha[:, list(vertices)] = on_face
    return frozen(position(alpha))


def product(a: Any, degree_a: int, b: Any, degree_b: int, dim: int) -> Numbers:
    """Controls (m_{n+m}, ..) of the product of two polynomials, elementwise in further axes.

        c_gamma = sum over alpha + beta = gamma of prod_i C(gamma_i, alpha_i) a_alpha b_beta
                  / C(n + m, n) :

    controls times multinomials convolve.

    >>> product([0.0, 1.0], 1, [1.0, 0.0], 1, 1).tolist()       # L_1 L_0
    [0.0, 0.5, 0.0]
    """
    a, b = net(a, degree_a, dim), net(b, degree_b, dim)
    a = a * _column(multinomials(degree_a, dim), a)
    b = b * _column(multinomials(degree_b, dim), b)
    terms = a[:, None] * b[None, :]
    to = position(indices(degree_a, dim)[:, None] + indices(degree_b, dim))
    sums = np.zeros((count(degree_a + degree_b, dim), *terms.shape[2:]), dtype=terms.dtype)
    np.add.at(sums, to, terms)
    return quotient(sums, _column(multinomials(degree_a + degree_b, dim), sums))


def derivative(controls: Any, degree: int, dim: int) -> Numbers:
    """Controls of the formal partials, (m_{n-1}, d+1, ..), in degree n-1 (none for degree 0).

        (dp / dL_i)_beta = n b_{beta + e_i}

    The derivative along a direction g (d+1 numbers that sum to zero) is the sum over i of g_i
    times column i: differences of neighbouring controls.

    >>> derivative([1.0, 2.0, 4.0], 2, 1) @ [-1.0, 1.0]
    array([2., 4.])
    """
    if degree < 1:
        raise InputError(
            "the derivative of a polynomial of degree 0 was asked for; it is zero and has no "
            "degree below: elevate to degree 1 first"
        )
    return net(controls, degree, dim)[shifts(degree, dim)] * degree
