# SPDX-License-Identifier: BSD-3-Clause
"""Laws of the Bernstein algebra for any degree, dimension, polynomial and point, in fractions."""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations
from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from bezsoma import bernstein

DIMENSIONS = st.integers(0, 3)


def places(dim: int) -> st.SearchStrategy[list[Fraction]]:
    """Barycentric coordinates of a point of a simplex, its corners among them."""
    weights = st.lists(st.integers(0, 7), min_size=dim + 1, max_size=dim + 1).filter(any)
    return weights.map(lambda w: [Fraction(x, sum(w)) for x in w])


@st.composite
def polynomials(draw: st.DrawFn, most: int = 6) -> tuple[int, int, Any]:
    """Degree, dimension and controls, whole numbers as fractions."""
    degree, dim = draw(st.integers(0, most)), draw(DIMENSIONS)
    size = bernstein.count(degree, dim)
    numbers = draw(st.lists(st.integers(-9, 9), min_size=size, max_size=size))
    return degree, dim, np.array([Fraction(n) for n in numbers], dtype=object)


def at(controls: Any, degree: int, place: list[Fraction]) -> Any:
    """The value of a polynomial, exactly."""
    return (bernstein.values(degree, np.array(place, dtype=object)) * controls).sum()


@given(st.data(), st.integers(0, 20), DIMENSIONS)
def test_they_are_a_partition_of_unity_and_keep_what_is_linear(
    data: st.DataObject, degree: int, dim: int
) -> None:
    place = np.array(data.draw(places(dim)), dtype=object)
    basis = bernstein.values(degree, place)
    assert basis.sum() == 1 and min(basis) >= 0
    if degree:
        alphas = bernstein.indices(degree, dim)
        assert [(basis * a).sum() / degree for a in alphas.T] == list(place)


@given(st.data(), polynomials())
def test_de_casteljau_gives_the_value(data: st.DataObject, given: tuple[int, int, Any]) -> None:
    degree, dim, controls = given
    place = data.draw(places(dim))
    assert bernstein.de_casteljau(controls, degree, np.array(place, dtype=object)) == at(
        controls, degree, place
    )


@given(st.data(), polynomials(4))
def test_the_blossom_does_not_mind_the_order_and_is_affine(
    data: st.DataObject, given: tuple[int, int, Any]
) -> None:
    degree, dim, controls = given
    points = [data.draw(places(dim)) for _ in range(degree)]
    value = bernstein.blossom(controls, degree, np.array(points, dtype=object).reshape(-1, dim + 1))
    other = data.draw(st.permutations(points))
    again = bernstein.blossom(controls, degree, np.array(other, dtype=object).reshape(-1, dim + 1))
    assert value == again
    if degree:
        ends = [data.draw(places(dim)), points[0]]
        middle = [(a + b) / 2 for a, b in zip(*ends, strict=True)]
        at_three = [
            bernstein.blossom(controls, degree, np.array([first, *points[1:]], dtype=object))
            for first in (*ends, middle)
        ]
        assert 2 * at_three[2] == at_three[0] + at_three[1]


@given(st.data(), polynomials(), st.integers(0, 3))
def test_elevation_keeps_every_value_and_the_mean(
    data: st.DataObject, given: tuple[int, int, Any], by: int
) -> None:
    degree, dim, controls = given
    raised = bernstein.elevated(controls, degree, dim, by)
    place = data.draw(places(dim))
    assert at(raised, degree + by, place) == at(controls, degree, place)
    assert raised.sum() * bernstein.integral(degree + by, dim, exact=True) == (
        controls.sum() * bernstein.integral(degree, dim, exact=True)
    )


@given(st.data(), st.integers(0, 4), st.integers(1, 3), st.integers(1, 2))
def test_elevation_and_restriction_can_change_places(
    data: st.DataObject, degree: int, dim: int, by: int
) -> None:
    corners = np.array([data.draw(places(dim)) for _ in range(dim + 1)], dtype=object)
    raised = bernstein.elevation(degree, dim, by, exact=True)
    first = bernstein.restriction(degree + by, dim, corners) @ raised
    second = raised @ bernstein.restriction(degree, dim, corners)
    assert (first == second).all()


@given(st.data(), polynomials(4))
def test_a_restriction_is_the_same_polynomial_of_other_corners(
    data: st.DataObject, given: tuple[int, int, Any]
) -> None:
    degree, dim, controls = given
    corners = np.array([data.draw(places(dim)) for _ in range(dim + 1)], dtype=object)
    part = bernstein.restriction(degree, dim, corners) @ controls
    place = np.array(data.draw(places(dim)), dtype=object)
    assert at(part, degree, list(place)) == at(controls, degree, list(place @ corners))


@given(st.data(), polynomials(5), st.integers(0, 2))
def test_a_trace_is_elevated_as_the_whole(
    data: st.DataObject, given: tuple[int, int, Any], by: int
) -> None:
    degree, dim, controls = given
    some = [c for size in range(1, dim + 2) for c in combinations(range(dim + 1), size)]
    vertices = data.draw(st.sampled_from(some))
    raised = bernstein.elevated(controls, degree, dim, by)
    of_the_whole = raised[bernstein.trace(degree + by, dim, vertices)]
    alone = controls[bernstein.trace(degree, dim, vertices)]
    assert list(of_the_whole) == list(bernstein.elevated(alone, degree, len(vertices) - 1, by))


@given(st.data(), st.integers(0, 3), st.integers(0, 3), DIMENSIONS)
def test_a_product_has_the_product_of_values_and_the_mass_its_mean(
    data: st.DataObject, m: int, n: int, dim: int
) -> None:
    numbers = st.integers(-5, 5).map(Fraction)
    a, b = (
        np.array(data.draw(st.lists(numbers, min_size=size, max_size=size)), dtype=object)
        for size in (bernstein.count(m, dim), bernstein.count(n, dim))
    )
    both = bernstein.product(a, m, b, n, dim)
    place = data.draw(places(dim))
    assert at(both, m + n, place) == at(a, m, place) * at(b, n, place)
    mean = both.sum() * bernstein.integral(m + n, dim, exact=True)
    assert a @ bernstein.mass(m, n, dim, exact=True) @ b == mean


@given(st.data(), polynomials())
def test_values_lie_between_the_bounds_and_these_between_the_controls(
    data: st.DataObject, given: tuple[int, int, Any]
) -> None:
    degree, dim, controls = given
    value = at(controls, degree, data.draw(places(dim)))
    assert min(controls) <= value <= max(controls)
    low, high = (b[0] for b in bernstein.bounds(controls.astype(float)[None], degree, dim, 0.5))
    assert low - 1e-12 <= value <= high + 1e-12
    assert min(controls) <= low + 1e-12 and high <= max(controls) + 1e-12
