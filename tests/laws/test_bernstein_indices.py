# SPDX-License-Identifier: BSD-3-Clause
"""The order of controls, from brute force and from the formula that the C++ core shares."""

from __future__ import annotations

from itertools import product
from math import comb, factorial, prod

import numpy as np
import pytest

from bezsoma import bernstein as bb
from bezsoma.errors import InputError

CASES = [(n, d) for d in (0, 1, 2, 3) for n in (*range(11), 20)]


@pytest.mark.parametrize(("n", "d"), [case for case in CASES if case[0] <= 10])
def test_all_multi_indices_stand_in_descending_order(n: int, d: int) -> None:
    tails = product(range(n + 1), repeat=d)
    brute = sorted(((n - sum(t), *t) for t in tails if sum(t) <= n), reverse=True)
    assert bb.indices(n, d).tolist() == [list(alpha) for alpha in brute]
    assert bb.count(n, d) == len(brute) == comb(n + d, d)


@pytest.mark.parametrize(("n", "d"), CASES)
def test_position_is_the_place_in_the_order(n: int, d: int) -> None:
    assert bb.position(bb.indices(n, d)).tolist() == list(range(bb.count(n, d)))


def test_position_in_a_tet_is_the_formula_of_the_core() -> None:
    for _, a1, a2, a3 in bb.indices(9, 3).tolist():
        s1, s2, s3 = a3, a2 + a3, a1 + a2 + a3
        for a0 in (0, 4):  # raising alpha_0 moves nothing
            expected = comb(s3 + 2, 3) + comb(s2 + 1, 2) + s1
            assert bb.position(np.array([a0, a1, a2, a3])) == expected


@pytest.mark.parametrize(("n", "d"), [case for case in CASES if case[0] > 0])
def test_shifts_and_parents_lead_up_and_down(n: int, d: int) -> None:
    upper, lower, units = bb.indices(n, d), bb.indices(n - 1, d), np.eye(d + 1, dtype=int)
    for i in range(d + 1):
        assert np.array_equal(upper[bb.shifts(n, d)[:, i]], lower + units[i])
    last, parent = bb.parents(n, d)
    assert np.array_equal(lower[parent] + units[last], upper)
    assert all(not alpha[i + 1 :].any() for alpha, i in zip(upper, last, strict=True))


@pytest.mark.parametrize(("n", "d"), CASES)
def test_multinomials_are_quotients_of_factorials(n: int, d: int) -> None:
    for alpha, ways in zip(bb.indices(n, d).tolist(), bb.multinomials(n, d).tolist(), strict=True):
        assert ways * prod(map(factorial, alpha)) == factorial(n)


def test_domain_points_lie_at_alpha_over_n() -> None:
    assert bb.domain_points(4, 3)[bb.position(np.array([1, 0, 3, 0]))].tolist() == [
        0.25,
        0,
        0.75,
        0,
    ]
    assert bb.domain_points(0, 2).tolist() == [[1 / 3] * 3]


def test_what_is_handed_out_cannot_be_changed() -> None:
    for array in (bb.indices(2, 2), bb.shifts(2, 2), bb.mass(1, 1, 1), bb.interpolation(2, 1)):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0


@pytest.mark.parametrize(("n", "d"), [(-1, 3), (21, 3), (2, 4), (2, -1)])
def test_degrees_and_dimensions_out_of_range_are_refused(n: int, d: int) -> None:
    message = rf"degree {n} on a simplex of dimension {d} .* from 0 to 20 .* from 0 to 3"
    with pytest.raises(InputError, match=message):
        bb.indices(n, d)


def test_degree_0_has_nothing_below() -> None:
    with pytest.raises(InputError, match="degree 0 has no net below it"):
        bb.shifts(0, 3)
