# SPDX-License-Identifier: BSD-3-Clause
"""The algebra of one simplex, against closed forms in exact fractions."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from itertools import product
from math import comb, factorial, prod

import numpy as np

from bezsoma import bernstein
from verification.problem import ANALYTICAL, Family, Value

FAMILY = Family(
    "algebra",
    "Bernstein polynomials on one simplex: closed forms, many of them in exact fractions.",
)
FARIN = "G. Farin, CAGD 3 (1986) 83-127, doi:10.1016/0167-8396(86)90016-6"
DIMS = (1, 2, 3)
POINTS = np.random.default_rng(5).dirichlet(np.ones(4), 50)


def points(dim: int) -> np.ndarray:
    """Points (50, dim + 1) of a simplex."""
    part = POINTS[:, : dim + 1]
    return part / part.sum(axis=1, keepdims=True)


def controls(degree: int, dim: int) -> np.ndarray:
    """Some controls, the same every time."""
    return np.random.default_rng(degree).normal(size=bernstein.count(degree, dim))


def each(degrees: tuple[int, ...], dims: tuple[int, ...] = DIMS) -> Iterator[tuple[int, int, str]]:
    """Degree, dimension, and both in words."""
    for dim, degree in product(dims, degrees):
        yield degree, dim, f"degree {degree}, {dim} D"


def sums() -> Iterator[Value]:
    for n, d, where in each((1, 3, 6, 10)):
        total = bernstein.values(n, points(d)).sum(axis=1)
        yield Value("largest |sum B - 1|", where, float(np.abs(total - 1).max()), 0.0, 1e-14)


def monomials() -> Iterator[Value]:
    for n, d, where in each((2, 5)):
        alpha = bernstein.indices(n, d)[bernstein.count(n, d) // 2].tolist()
        wanted = Fraction(prod(map(factorial, alpha)) * factorial(d), factorial(n + d))
        found = bernstein.monomial(alpha, exact=True)
        yield Value(f"mean of L^{tuple(alpha)}", where, float(found), float(wanted), 0.0)


def equal_means() -> Iterator[Value]:
    for n, d, where in each((1, 4, 8)):
        found = bernstein.integral(n, d, exact=True)
        yield Value("mean of any B", where, float(found), 1 / comb(n + d, d), 1e-16)


def products() -> Iterator[Value]:
    for n, d, where in each((1, 3)):
        found = bernstein.mass(n, n, d, exact=True)
        alphas = bernstein.indices(n, d)
        a, b = alphas[0], alphas[len(alphas) // 2]
        ways = prod(comb(int(p + q), int(p)) for p, q in zip(a, b, strict=True))
        wanted = Fraction(ways, comb(2 * n, n) * comb(2 * n + d, d))
        yield Value("mean of B_a B_b", where, float(found[0, len(alphas) // 2]), float(wanted), 0.0)


def volume_of_mass() -> Iterator[Value]:
    for n, d, where in each((2, 5)):
        total = sum(bernstein.mass(n, n, d, exact=True).ravel().tolist())
        yield Value("sum of all entries", where, float(total), 1.0, 0.0)


def raised() -> Iterator[Value]:
    for n, d, where in each((1, 4, 7)):
        b = controls(n, d)
        up = bernstein.values(n + 3, points(d)) @ bernstein.elevated(b, n, d, 3)
        away = float(np.abs(up - bernstein.values(n, points(d)) @ b).max())
        yield Value("largest difference", where, away, 0.0, 1e-13)


def casteljau() -> Iterator[Value]:
    for n, d, where in each((3, 8)):
        b, bary = controls(n, d), points(d)[7]
        found = float(bernstein.de_casteljau(b, n, bary))
        yield Value("p at a point", where, found, float(bernstein.values(n, bary) @ b), 1e-12)


def blossoms() -> Iterator[Value]:
    for n, d, where in each((2, 3, 4)):
        arguments, b = points(d)[:n], controls(n, d)
        found = [float(bernstein.blossom(b, n, np.roll(arguments, k, axis=0))) for k in range(n)]
        yield Value("spread over orders", where, float(np.ptp(found)), 0.0, 1e-14)


def slopes() -> Iterator[Value]:
    for n, d, where in each((2, 6)):
        b, bary = controls(n, d), points(d)
        direction = np.zeros(d + 1)
        direction[:2] = (-1.0, 1.0)
        h = 1e-5
        steps = [bernstein.values(n, bary + s * h * direction) @ b for s in (1, -1)]
        wanted = (steps[0] - steps[1]) / (2 * h)
        lower = bernstein.derivative(b, n, d)
        found = bernstein.values(n - 1, bary) @ (lower @ direction)
        yield Value("against differences", where, float(np.abs(found - wanted).max()), 0.0, 1e-7)


def restricted() -> Iterator[Value]:
    for n, d, where in each((2, 5)):
        corners, b = points(d)[: d + 1], controls(n, d)
        inner = points(d)[10:20]
        part = bernstein.restriction(n, d, corners) @ b
        away = bernstein.values(n, inner) @ part - bernstein.values(n, inner @ corners) @ b
        yield Value("largest difference", where, float(np.abs(away).max()), 0.0, 1e-13)


def hull() -> Iterator[Value]:
    for n, d, where in each((3, 6)):
        b = controls(n, d)
        p = bernstein.values(n, points(d)) @ b
        outside = float(max(b.min() - p.min(), p.max() - b.max(), 0.0))
        yield Value("beyond the controls by", where, outside, 0.0, 0.0)


def affine() -> Iterator[Value]:
    for n, d, where in each((1, 4, 9)):
        at = bernstein.domain_points(n, d)[:, 0]
        away = bernstein.values(n, points(d)) @ at - points(d)[:, 0]
        yield Value("largest difference", where, float(np.abs(away).max()), 0.0, 1e-14)


def interpolated() -> Iterator[Value]:
    for n, d, where in each((1, 3, 6)):
        b = controls(n, d)
        at = bernstein.values(n, bernstein.domain_points(n, d)) @ b
        away = bernstein.interpolation(n, d) @ at - b
        yield Value("largest difference", where, float(np.abs(away).max()), 0.0, 1e-12)


def quadrature() -> Iterator[Value]:
    for n, d, where in each((2, 5, 9), (2, 3)):
        bary, weights = bernstein.simplex(n, d)
        worst = 0.0
        for alpha in bernstein.indices(n, d).tolist():
            exact = bernstein.monomial(alpha)
            worst = max(worst, abs(float(weights @ np.prod(bary**alpha, axis=1)) / exact - 1))
        yield Value("worst monomial", where, worst, 0.0, 1e-12)


def multiplied() -> Iterator[Value]:
    for n, d, where in each((2, 4)):
        a, b, bary = controls(n, d), controls(n + 1, d), points(d)
        both = bernstein.product(a, n, b, n + 1, d)
        wanted = (bernstein.values(n, bary) @ a) * (bernstein.values(n + 1, bary) @ b)
        away = bernstein.values(2 * n + 1, bary) @ both - wanted
        yield Value("largest difference", where, float(np.abs(away).max()), 0.0, 1e-13)


def ladders() -> Iterator[Value]:
    for n, d, where in each((2, 4), (2, 3)):
        total = sum(
            a * bernstein.elevation(n - j, d, j) @ bernstein.elevation(n - j, d, j).T
            for j, a in enumerate(bernstein.ladder(n, n, d))
        )
        away = float(np.abs(total - bernstein.mass(n, n, d)).max() / bernstein.mass(n, n, d).max())
        yield Value("against the mass matrix", where, away, 0.0, 1e-13)


def faces() -> Iterator[Value]:
    for n in (1, 3, 6):
        b = controls(n, 3)
        flat = points(2)
        edge = np.insert(flat, 1, 0.0, axis=1)
        away = (
            bernstein.values(n, edge) @ b
            - bernstein.values(n, flat) @ b[bernstein.trace(n, 3, (0, 2, 3))]
        )
        yield Value("largest difference", f"degree {n}", float(np.abs(away).max()), 0.0, 1e-14)


SMALL = "a few sums of small numbers, so some units of rounding"
for name, answer, why, function in (
    ("Partition of unity", "sum of all B = 1", SMALL, sums),
    ("Mean of a monomial", "alpha! d! / (n + d)!", "fractions, so none", monomials),
    ("All means are equal", "1 / C(n + d, d)", "one rounding of a fraction", equal_means),
    (
        "Mean of a product",
        "prod C(a_i + b_i, a_i) / (C(2n, n) C(2n + d, d))",
        "fractions, so none",
        products,
    ),
    ("The mass matrix sums to one", "sum of all entries = 1", "fractions, so none", volume_of_mass),
    ("Degree elevation", "the polynomial stays", SMALL, raised),
    ("De Casteljau's algorithm", "sum of b B at the point", SMALL, casteljau),
    ("The blossom is symmetric", "the same in any order of its arguments", SMALL, blossoms),
    (
        "Derivatives",
        "n times differences of controls",
        "central differences err by 1e-10 n^3",
        slopes,
    ),
    ("Restriction to a part", "p at the same points", SMALL, restricted),
    ("Convex hull", "min b <= p <= max b", "an inequality", hull),
    ("Linear precision", "controls of L_0 are its values", SMALL, affine),
    ("Interpolation undoes evaluation", "controls back", SMALL, interpolated),
    ("Quadrature rules", "exact for all monomials of the degree", "rules in 16 digits", quadrature),
    ("Products of polynomials", "the product of the values", SMALL, multiplied),
    ("The mass matrix as a ladder", "sum of a_j E_j E_j^T", SMALL, ladders),
    ("Traces on faces", "the face's own controls alone", SMALL, faces),
):
    FAMILY.add(name, ANALYTICAL, FARIN, answer, why, function)
