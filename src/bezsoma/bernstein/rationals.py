# SPDX-License-Identifier: BSD-3-Clause
"""Binomials, and quotients that stay exact when exact numbers go in.

Every closed form of this package is a product of binomials over a product of binomials. Both
are formed in integers (below 2**63 up to degree 20), so that the one division at the end is the
only rounding, or none at all: arrays of `fractions.Fraction` take the same road as floats.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np

from bezsoma.arrays import Ints, Numbers, frozen

LARGEST = 20
"""The highest degree: the product of two polynomials of degree 10."""


def _pascal(rows: int) -> Ints:
    table = np.zeros((rows, rows), dtype=np.int64)
    table[:, 0] = 1
    for n in range(1, rows):
        table[n, 1:] = table[n - 1, 1:] + table[n - 1, :-1]
    return table


PASCAL = frozen(_pascal(2 * LARGEST + 4))
"""C(n, k) at [n, k]; zero for k > n, which lets sums run over all k."""

_fraction = np.frompyfunc(Fraction, 2, 1)


def binomial(n: int, k: int) -> int:
    """C(n, k), the number of ways to choose k out of n.

    >>> [binomial(4, k) for k in range(6)]
    [1, 4, 6, 4, 1, 0]
    """
    return int(PASCAL[n, k])


def binomial_products(upper: Ints, lower: Ints) -> Ints:
    """prod_i C(u_i, l_i) over the last axis, which the two share (they broadcast).

    >>> binomial_products(np.array([3, 2]), np.array([1, 1]))
    np.int64(6)
    """
    product: Ints = np.prod(PASCAL[upper, lower], axis=-1)
    return product


def exact_or_float(given: Any) -> Numbers:
    """An array: objects (fractions) stay what they are, all else becomes float64.

    >>> exact_or_float([1, 2]).dtype, exact_or_float([Fraction(1, 2)]).dtype
    (dtype('float64'), dtype('O'))
    """
    array = np.asarray(given)
    return array if array.dtype == object else array.astype(np.float64, copy=False)


def quotient(numbers: Any, divisors: Any, exact: bool = False) -> Numbers:
    """The quotient: fractions if asked for, or if the numbers are objects; else floats.

    Python's own 1 / 3 would turn integers among objects into floats in silence.

    >>> quotient(np.array([1, 2], dtype=object), 3)
    array([Fraction(1, 3), Fraction(2, 3)], dtype=object)
    >>> quotient(np.array([1, 2]), 4)
    array([0.25, 0.5 ])
    """
    numbers = np.asarray(numbers)
    if exact or numbers.dtype == object:
        return np.asarray(numbers.astype(object) * _fraction(1, divisors), dtype=object)
    return np.asarray(numbers / divisors)
