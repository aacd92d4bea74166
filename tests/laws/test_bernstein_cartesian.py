# SPDX-License-Identifier: BSD-3-Clause
"""Bernstein algebra against plain polynomials in x, y, z, which know nothing of barycentrics.

On the unit simplex L_0 = 1 - x - y - z, L_1 = x, L_2 = y, L_3 = z. Here polynomials are
dictionaries {exponents: Fraction} that are multiplied out, differentiated term by term, and
integrated one variable after the other. Everything is exact, so `==` means equal.
"""

from __future__ import annotations

from fractions import Fraction
from functools import cache
from math import comb, factorial

import numpy as np
import pytest

from bezsoma import bernstein as bb

Polynomial = dict[tuple[int, ...], Fraction]
SMALL = [(n, d) for d in (1, 2, 3) for n in (0, 1, 2, 3)]


def plus(*terms: Polynomial) -> Polynomial:
    total: Polynomial = {}
    for key, value in (item for term in terms for item in term.items()):
        total[key] = total.get(key, Fraction(0)) + value
    return {key: value for key, value in total.items() if value}


def times(p: Polynomial, q: Polynomial) -> Polynomial:
    pairs = ((a, u, b, v) for a, u in p.items() for b, v in q.items())
    return plus(*({tuple(map(sum, zip(a, b, strict=True))): u * v} for a, u, b, v in pairs))


def power(p: Polynomial, n: int, d: int) -> Polynomial:
    return times(p, power(p, n - 1, d)) if n else {(0,) * d: Fraction(1)}


def partial(p: Polynomial, k: int) -> Polynomial:
    lowered = {a: v * a[k] for a, v in p.items() if a[k]}
    return {(*a[:k], a[k] - 1, *a[k + 1 :]): v for a, v in lowered.items()}


@cache
def coordinate(i: int, d: int) -> Polynomial:
    """L_i in x, y, z."""
    axis = [tuple(int(k == j) for j in range(d)) for k in range(d)]
    one: Polynomial = {(0,) * d: Fraction(1)}
    return {axis[i - 1]: Fraction(1)} if i else plus(one, *({a: Fraction(-1)} for a in axis))


@cache
def basis(alpha: tuple[int, ...]) -> Polynomial:
    """B_alpha multiplied out."""
    d, left = len(alpha) - 1, sum(alpha)
    result: Polynomial = {(0,) * d: Fraction(1)}
    for i, a in enumerate(alpha):
        ways: Polynomial = {(0,) * d: Fraction(comb(left, a))}
        result, left = times(times(result, ways), power(coordinate(i, d), a, d)), left - a
    return result


def mean(p: Polynomial, d: int) -> Fraction:
    """Over the unit simplex: the last variable runs from 0 to what the others leave."""
    measure = Fraction(1, factorial(d))
    for k in range(d, 0, -1):
        room = coordinate(0, k - 1) if k > 1 else {(): Fraction(1)}
        above = {a: v / (a[-1] + 1) for a, v in p.items()}
        p = plus(*(times({a[:-1]: v}, power(room, a[-1] + 1, k - 1)) for a, v in above.items()))
    return p.get((), Fraction(0)) / measure


def at(p: Polynomial, x: list[Fraction]) -> Fraction:
    powers = (v * np.prod([c**e for c, e in zip(x, a, strict=True)]) for a, v in p.items())
    return sum(powers, Fraction(0))


def all_of(n: int, d: int) -> list[Polynomial]:
    return [basis(tuple(alpha)) for alpha in bb.indices(n, d).tolist()]


def controlled(controls: np.ndarray, n: int, d: int) -> Polynomial:
    weighted = zip(controls.tolist(), all_of(n, d), strict=True)
    return plus(*({a: v * c for a, v in p.items()} for c, p in weighted))


def rationals(count: int, seed: int) -> np.ndarray:
    draw = np.random.default_rng(seed).integers(-9, 10, size=(count, 2)).tolist()
    return np.array([Fraction(a, 7 + abs(b)) for a, b in draw], dtype=object)


@pytest.mark.parametrize(("n", "d"), [*SMALL, (6, 1), (6, 2), (5, 3), (10, 1), (10, 2)])
def test_values(n: int, d: int) -> None:
    """Each B_alpha of the paper, eq. 57, multiplied out."""
    x = [Fraction(2, 7), Fraction(-3, 5), Fraction(1, 3)][:d]
    point = np.array([1 - sum(x), *x], dtype=object)
    assert bb.values(n, point).tolist() == [at(p, x) for p in all_of(n, d)]


@pytest.mark.parametrize(("n", "d"), [*SMALL, (6, 1), (6, 2), (5, 3)])
def test_gradients(n: int, d: int) -> None:
    x = [Fraction(2, 7), Fraction(-3, 5), Fraction(1, 3)][:d]
    point = np.array([1 - sum(x), *x], dtype=object)
    slopes = bb.derivatives(n, point)
    for k in range(d):  # dL_0/dx_k = -1, dL_k+1/dx_k = 1
        expected = [at(partial(p, k), x) for p in all_of(n, d)]
        assert (slopes[:, k + 1] - slopes[:, 0]).tolist() == expected


@pytest.mark.parametrize(("n", "d"), [*SMALL, (6, 2), (5, 3)])
def test_integral(n: int, d: int) -> None:
    means = {mean(p, d) for p in all_of(n, d)}
    assert means == {bb.integral(n, d, exact=True)}


def test_monomial() -> None:
    for alpha in [(3, 0), (2, 5), (1, 2, 3), (4, 0, 1), (2, 1, 0, 3), (1, 1, 1, 1), (0, 0, 0, 2)]:
        d, p = len(alpha) - 1, {(0,) * (len(alpha) - 1): Fraction(1)}
        for i, a in enumerate(alpha):
            p = times(p, power(coordinate(i, d), a, d))
        assert bb.monomial(alpha, exact=True) == mean(p, d)


@pytest.mark.parametrize(("n", "m", "d"), [(3, 2, 1), (0, 2, 2), (3, 3, 2), (2, 2, 3), (3, 1, 3)])
def test_mass(n: int, m: int, d: int) -> None:
    expected = [[mean(times(p, q), d) for q in all_of(m, d)] for p in all_of(n, d)]
    assert bb.mass(n, m, d, exact=True).tolist() == expected


@pytest.mark.parametrize(("n", "d"), [(1, 1), (4, 1), (0, 2), (1, 2), (3, 2), (1, 3), (2, 3)])
def test_gradient_products(n: int, d: int) -> None:
    g = np.array([[-1] * d, *np.eye(d, dtype=int).tolist()], dtype=object)
    found = np.einsum("ik,jl,ijab->klab", g, g, bb.gradient_products(n, d, exact=True))
    for k in range(d):
        for m in range(d):
            left = [partial(p, k) for p in all_of(n, d)]
            right = [partial(p, m) for p in all_of(n, d)]
            assert found[k, m].tolist() == [[mean(times(p, q), d) for q in right] for p in left]


@pytest.mark.parametrize(("n", "m", "d"), [(3, 2, 1), (0, 1, 2), (2, 1, 2), (2, 1, 3), (1, 2, 3)])
def test_gradient_moments(n: int, m: int, d: int) -> None:
    found = bb.gradient_moments(n, m, d, exact=True)
    for k in range(d):
        left, right = [partial(p, k) for p in all_of(n, d)], all_of(m, d)
        expected = [[mean(times(p, q), d) for q in right] for p in left]
        assert (found[k + 1] - found[0]).tolist() == expected


@pytest.mark.parametrize(("n", "m", "d"), [(4, 2, 1), (0, 2, 2), (3, 1, 2), (3, 3, 3)])
def test_a_patch_is_the_sum_of_its_controls_times_the_basis(n: int, m: int, d: int) -> None:
    """Paper, eq. 58; m counts the components of a control."""
    controls = rationals(bb.count(n, d) * m, 4).reshape(-1, m)
    x = [Fraction(1, 5), Fraction(4, 9), Fraction(-2, 3)][:d]
    point = np.array([1 - sum(x), *x], dtype=object)
    expected = [at(controlled(controls[:, k], n, d), x) for k in range(m)]
    assert (bb.values(n, point) @ controls).tolist() == expected
    assert bb.de_casteljau(controls, n, point).tolist() == expected


@pytest.mark.parametrize(("n", "m", "d"), [(3, 4, 1), (2, 3, 2), (0, 2, 2), (2, 2, 3), (3, 1, 3)])
def test_product_and_moments(n: int, m: int, d: int) -> None:
    a, b = rationals(bb.count(n, d), 1), rationals(bb.count(m, d), 2)
    p, q = controlled(a, n, d), controlled(b, m, d)
    assert controlled(bb.product(a, n, b, m, d), n + m, d) == times(p, q)
    expected = [mean(times(p, r), d) for r in all_of(m, d)]
    assert bb.moments(a, n, m, d).tolist() == expected


@pytest.mark.parametrize(("n", "d"), [(1, 1), (5, 1), (3, 2), (3, 3)])
def test_elevation_and_derivative(n: int, d: int) -> None:
    a = rationals(bb.count(n, d), 3)
    p = controlled(a, n, d)
    for by in (0, 1, 2):
        assert controlled(bb.elevated(a, n, d, by), n + by, d) == p
        assert controlled(bb.elevation(n, d, by, exact=True) @ a, n + by, d) == p
    slopes = bb.derivative(a, n, d)
    for k in range(d):
        assert controlled(slopes[:, k + 1] - slopes[:, 0], n - 1, d) == partial(p, k)
