# SPDX-License-Identifier: BSD-3-Clause
"""Polynomials of x, y, z with exact coefficients, accurate far from the origin."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from itertools import product
from math import comb

import numpy as np
import numpy.typing as npt

from bezsoma.arrays import Floats, Ints, frozen
from bezsoma.errors import InputError
from bezsoma.mechanics.checks import numbers
from bezsoma.mechanics.formulas import Powers, Terms, formula


@dataclass(frozen=True)
class Polynomial:
    """A polynomial of x, y, z [mm], of one component or several; coefficients are fractions.

    For values the polynomial is shifted, exactly, to the middle of the points before anything
    is rounded. So a cubic about a tooth in scanner coordinates loses nothing, though x**3 is
    1e9 there and its terms cancel:

    >>> far = Polynomial.parse("(x - 1000)**3")
    >>> far(np.array([[1000.5, 0, 0], [999.5, 0, 0]])).tolist()
    [[0.125], [-0.125]]
    """

    components: tuple[Terms, ...]

    @classmethod
    def parse(cls, formulas: str | float | Sequence[str | float]) -> Polynomial:
        """A polynomial from one formula, or one for each component: `["0.1*x", 0, "x*y - z**2"]`.

        Allowed are numbers, x, y, z, + - *, division by a number, ** or ^ with a whole number
        from 0 to 10, and parentheses. Nothing is run as code; decimals are taken as written.

        >>> Polynomial.parse(["2*(x + y)^2 / 4", 0, "-z"])(np.array([[1.0, 2, 3]])).tolist()
        [[4.5, 0.0, -3.0]]
        """
        if isinstance(formulas, str | float | int):
            return cls((formula(formulas),))
        if not isinstance(formulas, Sequence) or not formulas:
            raise InputError(
                f"{formulas!r} is no formula; give text such as '0.1*x', or a list with one "
                "formula for each component such as ['0.1*x', 0, 'x*y']"
            )
        return cls(tuple(formula(each) for each in formulas))

    @classmethod
    def affine(
        cls,
        matrix: npt.ArrayLike,
        shift: npt.ArrayLike = (0, 0, 0),
        about: npt.ArrayLike = (0, 0, 0),
    ) -> Polynomial:
        """The field matrix (3, 3) @ (x - about) + shift, with shift and about (3,) in mm.

        >>> stretch = Polynomial.affine(np.diag([0.1, 0, 0]), shift=(0, 0, 2))
        >>> stretch(np.array([[10.0, 5, 5]])).tolist()
        [[1.0, 0.0, 2.0]]
        """
        A = numbers(matrix, (3, 3), "the matrix of an affine field").tolist()
        b = numbers(shift, (3,), "the shift of an affine field").tolist()
        c = numbers(about, (3,), "the point `about` of an affine field").tolist()
        rows: list[Terms] = []
        for row, constant in zip(A, b, strict=True):
            moved = sum(
                (Fraction(a) * Fraction(x) for a, x in zip(row, c, strict=True)), Fraction()
            )
            terms = [((0, 0, 0), Fraction(constant) - moved)]
            terms += [(unit, Fraction(a)) for unit, a in zip(_UNITS, row, strict=True)]
            rows.append(_tidy(terms))
        return cls(tuple(rows))

    @property
    def degree(self) -> int:
        """The highest total degree of any component; 0 for the zero polynomial."""
        return max((sum(powers) for terms in self.components for powers, _ in terms), default=0)

    def derivative(self, axis: int) -> Polynomial:
        """The partial derivative of every component along x, y or z (axis 0, 1 or 2).

        >>> Polynomial.parse("x**2 * y").derivative(0) == Polynomial.parse("2*x*y")
        True
        """
        down = _UNITS[axis]
        return Polynomial(
            tuple(
                _tidy([(_minus(p, down), c * p[axis]) for p, c in terms if p[axis]])
                for terms in self.components
            )
        )

    def __call__(self, points: Floats) -> Floats:
        """Values (p, k) at points (p, 3) mm."""
        if not len(points):
            return np.zeros((0, len(self.components)))
        centre = points.min(0) / 2 + points.max(0) / 2
        exponents, coefficients = _shifted(self, tuple(centre.tolist()))
        powers = (points - centre)[:, :, None] ** np.arange(self.degree + 1)
        monomials = powers[:, 0, exponents[:, 0]]
        for axis in (1, 2):
            monomials = monomials * powers[:, axis, exponents[:, axis]]
        values: Floats = monomials @ coefficients
        return values


_UNITS: tuple[Powers, Powers, Powers] = ((1, 0, 0), (0, 1, 0), (0, 0, 1))


def _minus(p: Powers, q: Powers) -> Powers:
    return p[0] - q[0], p[1] - q[1], p[2] - q[2]


def _tidy(terms: list[tuple[Powers, Fraction]]) -> Terms:
    return tuple(sorted((powers, c) for powers, c in terms if c))


@lru_cache(maxsize=64)
def _shifted(polynomial: Polynomial, centre: tuple[float, ...]) -> tuple[Ints, Floats]:
    """Exponents (m, 3) and coefficients (m, k) in x - centre, rounded once at the end."""
    k = len(polynomial.components)
    sums: dict[Powers, list[Fraction]] = {(0, 0, 0): [Fraction()] * k}
    for column, terms in enumerate(polynomial.components):
        for powers, value in terms:
            for lower, factor in _expansion(powers, centre):
                row = sums.setdefault(lower, [Fraction()] * k)
                row[column] += value * factor
    exponents = np.array(list(sums), dtype=np.int64)
    return frozen(exponents), frozen(np.array(list(sums.values()), dtype=float))


def _expansion(powers: Powers, centre: tuple[float, ...]) -> list[tuple[Powers, Fraction]]:
    """The terms of x**a y**b z**c in x - centre: binomials times powers of the centre."""
    axes = [
        [comb(power, low) * Fraction(c) ** (power - low) for low in range(power + 1)]
        for power, c in zip(powers, centre, strict=True)
    ]
    return [
        ((i, j, k), axes[0][i] * axes[1][j] * axes[2][k])
        for i, j, k in product(*(range(power + 1) for power in powers))
    ]
