# SPDX-License-Identifier: BSD-3-Clause
"""Rules on the simplex against factorials, and where their exactness has to end.

First what `simplex` hands out, then the two makes it chooses from.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from itertools import permutations
from math import comb, factorial, prod

import numpy as np
import pytest

from bezsoma import bernstein as bb
from bezsoma.arrays import Floats
from bezsoma.bernstein.quadrature import cone, conical, symmetric
from bezsoma.errors import InputError

DIMS = [1, 2, 3]


TRIANGLES = {1: 1, 2: 3, 4: 6, 5: 7, 6: 12, 7: 15, 8: 16, 9: 19, 10: 25, 11: 28, 12: 33, 13: 37}
TRIANGLES |= {14: 42}
TETS = {1: 1, 2: 4, 3: 8, 5: 14, 6: 24, 7: 35, 8: 46, 9: 59, 10: 81, 11: 105}
COUNTS = {(d, p): q for d, table in ((2, TRIANGLES), (3, TETS)) for p, q in table.items()}


def mean(alpha: list[int]) -> Fraction:
    d = len(alpha) - 1
    return Fraction(prod(map(factorial, alpha)) * factorial(d), factorial(sum(alpha) + d))


def means(bary: Floats, weights: Floats, degree: int) -> Iterator[tuple[float, Fraction]]:
    """By the rule and in truth, of each monomial."""
    for alpha in bb.indices(degree, bary.shape[1] - 1).tolist():
        yield float(weights @ np.prod(bary ** np.array(alpha), axis=1)), mean(alpha)


@pytest.mark.parametrize("d", DIMS)
@pytest.mark.parametrize("exactness", range(21))
def test_every_monomial_up_to_the_exactness(exactness: int, d: int) -> None:
    """Measured: relative errors below 5e-15 for each monomial, the smallest ones included."""
    bary, weights = bb.simplex(exactness, d)
    for degree in {0, exactness // 2, exactness}:
        for found, true in means(bary, weights, degree):
            assert abs(found - true) < 1e-15
            assert abs(found / float(true) - 1) < 1e-14


def test_the_table_has_so_many_points() -> None:
    assert {key: len(weights) for key, (_, weights) in symmetric().items()} == COUNTS


@pytest.mark.parametrize("d", DIMS)
@pytest.mark.parametrize("exactness", range(25))
def test_the_smallest_rule_that_is_exact_enough(exactness: int, d: int) -> None:
    enough = [q for (dim, p), q in COUNTS.items() if dim == d and p >= exactness]
    q = min(enough, default=(exactness // 2 + 1) ** d)
    bary, weights = bb.simplex(exactness, d)
    assert bary.shape == (q, d + 1)
    assert weights.shape == (q,)
    assert bb.simplex(exactness, d)[0] is bary
    assert not bary.flags.writeable
    assert not weights.flags.writeable


@pytest.mark.parametrize(("d", "exactness"), COUNTS)
def test_a_symmetric_rule_is_as_exact_as_its_digits(d: int, exactness: int) -> None:
    """In fractions of the doubles; they are within 1e-16 of the true points and weights."""
    bary, weights = (np.vectorize(Fraction)(array) for array in symmetric()[d, exactness])
    for alpha in bb.indices(exactness, d).tolist():
        if alpha == sorted(alpha):
            error = weights @ np.prod(bary ** np.array(alpha), axis=1) - mean(alpha)
            assert abs(error) < 4e-16


@pytest.mark.parametrize(("d", "exactness"), COUNTS)
def test_a_symmetric_rule_is_not_exact_one_degree_higher(d: int, exactness: int) -> None:
    pairs = means(*symmetric()[d, exactness], exactness + 1)
    assert max(abs(found / float(true) - 1) for found, true in pairs) > 1e-4


@pytest.mark.parametrize(("d", "exactness"), COUNTS)
def test_renumbering_the_vertices_reorders_a_symmetric_rule(d: int, exactness: int) -> None:
    rule = np.column_stack(symmetric()[d, exactness])
    as_is = sorted(map(tuple, rule))
    assert len(set(as_is)) == len(as_is)
    for order in permutations(range(d + 1)):
        assert sorted(map(tuple, rule[:, [*order, d + 1]])) == as_is


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
def test_the_exactness_of_a_cone_is_not_exceeded(exactness: int, d: int) -> None:
    """Gauss's k points see nothing of the polynomial that vanishes at all of them, squared."""
    bary, weights = conical(exactness, d)
    t, _ = cone(exactness // 2 + 1, d)
    square = np.prod((1 - bary[:, :1] - t) ** 2, axis=1)  # of degree exactness + 1 in L_0
    assert weights @ square < 1e-30
    fine, fine_weights = conical(exactness + 1, d)
    assert fine_weights @ np.prod((1 - fine[:, :1] - t) ** 2, axis=1) > 1e-9


@pytest.mark.parametrize("d", DIMS)
@pytest.mark.parametrize("exactness", range(21))
def test_a_cone_has_any_exactness(exactness: int, d: int) -> None:
    bary, weights = conical(exactness, d)
    assert bary.shape == ((exactness // 2 + 1) ** d, d + 1)
    for found, true in means(bary, weights, exactness):
        assert abs(found / float(true) - 1) < 1e-14


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
