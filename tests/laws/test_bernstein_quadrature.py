# SPDX-License-Identifier: BSD-3-Clause
"""Rules on the simplex against factorials, and where their exactness has to end."""

from __future__ import annotations

from math import comb, factorial, prod

import numpy as np
import pytest

from bezsoma import bernstein as bb
from bezsoma.bernstein.quadrature import cone
from bezsoma.errors import InputError

DIMS = [1, 2, 3]


def mean(alpha: list[int]) -> float:
    d = len(alpha) - 1
    return prod(map(factorial, alpha)) * factorial(d) / factorial(sum(alpha) + d)


@pytest.mark.parametrize("d", DIMS)
@pytest.mark.parametrize("exactness", range(21))
def test_every_monomial_up_to_the_exactness(exactness: int, d: int) -> None:
    """Measured: relative errors below 5e-15 for each monomial, the smallest ones included."""
    bary, weights = bb.simplex(exactness, d)
    assert bary.shape == ((exactness // 2 + 1) ** d, d + 1)
    for degree in {0, exactness // 2, exactness}:
        for alpha in bb.indices(degree, d).tolist():
            found = weights @ np.prod(bary ** np.array(alpha), axis=1)
            assert abs(found / mean(alpha) - 1) < 1e-14


@pytest.mark.parametrize("d", DIMS)
@pytest.mark.parametrize("exactness", [*range(12), 21, 40])
def test_weights_are_positive_and_points_inside(exactness: int, d: int) -> None:
    bary, weights = bb.simplex(exactness, d)
    assert weights.min() > 0
    assert abs(weights.sum() - 1) < 3e-15
    assert bary.min() > 0
    assert np.abs(bary.sum(axis=1) - 1).max() < 4e-16


@pytest.mark.parametrize("points", [1, 2, 3, 4, 6, 9])
def test_one_degree_more_errs_by_what_theory_says(points: int) -> None:
    """Legendre's monic polynomial on [0, 1] has mean square ((k!)^2 / (2k)!)^2 / (2k + 1)."""
    bary, weights = bb.simplex(2 * points - 1, 1)
    defect = 1 / (2 * points + 1) - weights @ bary[:, 1] ** (2 * points)
    assert defect == pytest.approx(comb(2 * points, points) ** -2 / (2 * points + 1), rel=1e-4)


@pytest.mark.parametrize("d", DIMS)
@pytest.mark.parametrize("exactness", [1, 3, 5, 7])
def test_the_exactness_is_not_exceeded(exactness: int, d: int) -> None:
    """Gauss's k points see nothing of the polynomial that vanishes at all of them, squared."""
    bary, weights = bb.simplex(exactness, d)
    t, _ = cone(exactness // 2 + 1, d)
    square = np.prod((1 - bary[:, :1] - t) ** 2, axis=1)  # of degree exactness + 1 in L_0
    assert weights @ square < 1e-30
    fine, fine_weights = bb.simplex(exactness + 1, d)
    assert fine_weights @ np.prod((1 - fine[:, :1] - t) ** 2, axis=1) > 1e-9


@pytest.mark.parametrize("points", [1, 2, 5, 12, 40])
@pytest.mark.parametrize("d", DIMS)
def test_the_rule_along_a_cone(points: int, d: int) -> None:
    t, weights = cone(points, d)
    assert (np.diff(t) > 0).all()
    assert 0 < t[0] <= t[-1] < 1
    for p in (0, 1, points, 2 * points - 1):
        assert weights @ t**p == pytest.approx(d / (d + p), rel=1e-14)


@pytest.mark.parametrize("d", DIMS)
def test_it_gives_the_closed_forms(d: int) -> None:
    bary, weights = bb.simplex(12, d)
    values, slopes = bb.values(6, bary), bb.derivatives(6, bary)
    mass = np.einsum("q,qa,qb->ab", weights, values, values)
    assert np.allclose(mass, bb.mass(6, 6, d), rtol=1e-13, atol=0)
    products = np.einsum("q,qai,qbj->ijab", weights, slopes, slopes, optimize=True)
    assert np.allclose(products, bb.gradient_products(6, d), rtol=1e-13, atol=0)


def test_a_function_that_is_no_polynomial_converges() -> None:
    """Mean of exp(L_1) over a tet: 6 (e - 5/2)."""
    errors = []
    for exactness in (2, 6, 14):
        bary, weights = bb.simplex(exactness, 3)
        errors.append(abs(weights @ np.exp(bary[:, 1]) - 6 * (np.e - 2.5)))
    assert errors[0] < 1e-3
    assert errors[1] < 1e-7
    assert errors[2] < 2e-15


def test_a_point_has_one_rule() -> None:
    bary, weights = bb.simplex(7, 0)
    assert bary.tolist() == [[1.0]]
    assert weights.tolist() == [1.0]


@pytest.mark.parametrize(("exactness", "d"), [(-1, 3), (2, 4)])
def test_what_is_no_degree_or_dimension_is_refused(exactness: int, d: int) -> None:
    with pytest.raises(InputError, match=f"exactness {exactness} on a simplex of dimension {d}"):
        bb.simplex(exactness, d)
