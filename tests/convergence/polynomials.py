# SPDX-License-Identifier: BSD-3-Clause
"""Polynomial displacements, and the loads that hold a body in them, by arithmetic on terms.

A polynomial is a dict from powers (a, b, c) to the coefficient of x^a y^b z^c. Its calculus is
done here anew; BezSoma gets nothing but the finished formulas.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product

import numpy as np
import numpy.typing as npt

import bezsoma as bz

Floats = npt.NDArray[np.float64]
Powers = tuple[int, int, int]
Terms = Mapping[Powers, float]


def derivative(terms: Terms, axis: int) -> Terms:
    """The partial derivative."""
    lower = [
        (tuple(p - (i == axis) for i, p in enumerate(powers)), c * powers[axis])
        for powers, c in terms.items()
        if powers[axis]
    ]
    return dict(lower)


def combined(*weighted: tuple[float, Terms]) -> Terms:
    """The sum of weights times polynomials."""
    total: dict[Powers, float] = {}
    for weight, terms in weighted:
        for powers, c in terms.items():
            total[powers] = total.get(powers, 0.0) + weight * c
    return total


def values(components: Sequence[Terms], points: Floats) -> Floats:
    """Values (p, k) of k polynomials at points (p, 3)."""
    powers = sorted({each for terms in components for each in terms})
    coefficients = np.array([[terms.get(each, 0.0) for terms in components] for each in powers])
    x, y, z = points.T[:, :, None] ** np.array(powers).T[:, None, :]
    return np.asarray((x * y * z) @ coefficients)


def formula(*components: Terms) -> bz.Polynomial:
    """The same for BezSoma; a double is a fraction, so nothing is rounded."""
    return bz.Polynomial(
        tuple(
            tuple(sorted((powers, Fraction(c)) for powers, c in terms.items() if c))
            for terms in components
        )
    )


@dataclass(frozen=True, eq=False)
class PolynomialField:
    """A displacement (three polynomials, mm) of an isotropic body with lam and mu, MPa."""

    u: tuple[Terms, Terms, Terms]
    lam: float
    mu: float

    @classmethod
    def random(cls, degree: int, law: bz.LinearElastic, seed: int = 0) -> PolynomialField:
        """All terms up to a degree in all components, of alike size on |x|, |y|, |z| <= 1."""
        rng = np.random.default_rng(seed + 100 * degree)
        powers = [p for p in product(range(degree + 1), repeat=3) if sum(p) <= degree]
        u = tuple(
            dict(zip(powers, rng.uniform(-1, 1, len(powers)).tolist(), strict=True)) for _ in "xyz"
        )
        return cls(u, law.E * law.nu / ((1 + law.nu) * (1 - 2 * law.nu)), law.E / (2 + 2 * law.nu))

    @property
    def gradient(self) -> list[list[Terms]]:
        """H_kl = du_k/dx_l."""
        return [[derivative(each, axis) for axis in range(3)] for each in self.u]

    @property
    def stress(self) -> list[list[Terms]]:
        """lam tr H I + mu (H + H^T)."""
        H = self.gradient
        trace = combined(*((self.lam, H[k][k]) for k in range(3)))
        return [
            [
                combined((self.mu, H[k][m]), (self.mu, H[m][k]), (float(k == m), trace))
                for m in range(3)
            ]
            for k in range(3)
        ]

    @property
    def body_force(self) -> tuple[Terms, ...]:
        """- div stress."""
        return tuple(
            combined(*((-1.0, derivative(row[axis], axis)) for axis in range(3)))
            for row in self.stress
        )

    def traction(self, normal: Floats) -> tuple[Terms, ...]:
        """Stress times a unit normal."""
        return tuple(
            combined(*((float(n), s) for n, s in zip(normal, row, strict=True)))
            for row in self.stress
        )

    def at(self, points: Floats) -> Floats:
        """The displacement (p, 3)."""
        return values(self.u, points)

    def stress_at(self, points: Floats) -> Floats:
        """The stress (p, 3, 3)."""
        return values([each for row in self.stress for each in row], points).reshape(-1, 3, 3)

    def gradient_at(self, points: Floats) -> Floats:
        """The displacement gradient (p, 3, 3)."""
        return values([each for row in self.gradient for each in row], points).reshape(-1, 3, 3)
