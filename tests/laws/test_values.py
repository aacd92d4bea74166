# SPDX-License-Identifier: BSD-3-Clause
"""Formulas are read exactly, and their values lose nothing far from the origin."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from hypothesis import given as any_of
from hypothesis import settings
from hypothesis import strategies as st

from bezsoma.errors import InputError
from bezsoma.mechanics import Polynomial
from bezsoma.mechanics.formulas import formula
from bezsoma.mechanics.values import given
from tolerances import ROUNDING

Exact = Callable[[Fraction, Fraction, Fraction], Fraction]
READ: list[tuple[str, Exact]] = [
    ("0.1*x", lambda x, y, z: x / 10),
    ("x*y - 2*z**2", lambda x, y, z: x * y - 2 * z * z),
    ("x*y - 2*z^2", lambda x, y, z: x * y - 2 * z * z),
    ("-x**2", lambda x, y, z: -(x**2)),
    ("(-x)**2", lambda x, y, z: x**2),
    ("-(x - y)*(x + y)/4", lambda x, y, z: (y * y - x * x) / 4),
    ("2 - 3 - 4", lambda x, y, z: Fraction(-5)),
    ("12/3/2", lambda x, y, z: Fraction(2)),
    ("x/(2*5)", lambda x, y, z: x / 10),
    ("1e-3*z + .5", lambda x, y, z: z / 1000 + Fraction(1, 2)),
    ("+x - -y", lambda x, y, z: x + y),
    ("(x + y + z)**10", lambda x, y, z: (x + y + z) ** 10),
    ("x**0", lambda x, y, z: Fraction(1)),
    ("  x +\n y ", lambda x, y, z: x + y),
]


def exactly(text: str | float, x: Fraction, y: Fraction, z: Fraction) -> Fraction:
    terms = formula(text)
    return sum((c * x**i * y**j * z**k for (i, j, k), c in terms), Fraction(0))


@pytest.mark.parametrize(("text", "exact"), READ, ids=[text for text, _ in READ])
def test_a_formula_is_read_exactly(text: str, exact: Exact) -> None:
    for point in product((Fraction(-3, 7), Fraction(0), Fraction(5, 2)), repeat=3):
        assert exactly(text, *point) == exact(*point)


def test_a_full_polynomial_of_degree_10_can_be_written_out() -> None:
    powers = [(i, j, k) for i in range(11) for j in range(11 - i) for k in range(11 - i - j)]
    text = " + ".join(f"{sum(p)}.5*x^{p[0]}*y^{p[1]}*z^{p[2]}" for p in powers)
    assert dict(formula(text)) == {p: sum(p) + Fraction(1, 2) for p in powers}


AT = (Fraction(2, 3), Fraction(-5, 4), Fraction(7))
Said = tuple[str, Fraction]
LEAVES: list[Said] = [*zip("xyz", AT, strict=True), ("2", Fraction(2)), ("1e-2", Fraction(1, 100))]


def longer(inner: st.SearchStrategy[Said]) -> st.SearchStrategy[Said]:
    """Formulas of formulas, each with the value it must have at one point."""
    return st.one_of(
        st.builds(lambda a, b: (f"({a[0]} + {b[0]})", a[1] + b[1]), inner, inner),
        st.builds(lambda a, b: (f"({a[0]} - ({b[0]}))", a[1] - b[1]), inner, inner),
        st.builds(lambda a, b: (f"({a[0]})*({b[0]})", a[1] * b[1]), inner, inner),
        st.builds(lambda a: (f"-({a[0]})", -a[1]), inner),
        st.builds(lambda a: (f"({a[0]})/4", a[1] / 4), inner),
        st.builds(lambda a: (f"({a[0]})^2", a[1] ** 2), inner),
    )


@any_of(st.recursive(st.sampled_from(LEAVES), longer, max_leaves=4))
@settings(max_examples=60, deadline=None)
def test_any_formula_means_what_it_says(said: Said) -> None:
    text, value = said
    try:
        assert exactly(text, *AT) == value
    except InputError as error:
        assert "degree exceeds 10" in str(error)


def test_values_far_from_the_origin_lose_nothing() -> None:
    """Scanner coordinates: every term is 1e9 there, the sum is 1e-3; compared in fractions."""
    text = "(x - 1000)**3 + (y + 900)*(z - 1200)**2"
    points = np.array([1000, -900, 1200]) + np.random.default_rng(0).uniform(-0.1, 0.1, (20, 3))
    values = Polynomial.parse(text)(points)[:, 0]
    for point, value in zip(points, values, strict=True):
        exact = exactly(text, *(Fraction(float(x)) for x in point))
        assert abs(value - float(exact)) < ROUNDING * 1e-3


def test_a_polynomial_has_components_a_degree_and_derivatives() -> None:
    field = Polynomial.parse(["x**2*y", 3, "z - x**2*y + y*x**2"])
    points = np.random.default_rng(0).normal(size=(5, 3))
    x, y, z = points.T
    assert field.degree == 3
    assert np.allclose(field(points), np.stack([x**2 * y, 0 * x + 3, z], axis=1), atol=1e-14)
    assert field.derivative(0) == Polynomial.parse(["2*x*y", 0, 0])
    assert field.derivative(1) == Polynomial.parse(["x**2", 0, 0])
    assert field.derivative(2) == Polynomial.parse([0, 0, 1])
    assert Polynomial.parse("0").degree == 0
    assert Polynomial.parse(["0"])(points).tolist() == [[0.0]] * 5
    assert Polynomial.parse("x")(np.zeros((0, 3))).shape == (0, 1)


def test_an_affine_field_is_the_matrix_times_the_point() -> None:
    rng = np.random.default_rng(2)
    A, b, c, points = (rng.normal(size=s) for s in ((3, 3), 3, 3, (6, 3)))
    field = Polynomial.affine(A, shift=b, about=c)
    assert field.degree == 1
    assert np.allclose(field(points), (points - c) @ A.T + b, atol=1e-14)


def test_numbers_polynomials_and_functions_can_be_given() -> None:
    points = np.random.default_rng(3).normal(size=(4, 3))
    assert given(np.float32(2), 1, "p")(points).tolist() == [[2.0]] * 4
    assert given([1, 2, 3], 3, "u")(points).tolist() == [[1.0, 2.0, 3.0]] * 4
    assert given(Polynomial.parse("x"), 1, "p").degree == 1
    function = given(lambda x: x[:, 0], 1, "p")
    assert function.degree is None
    assert np.array_equal(function(points)[:, 0], points[:, 0])
    again = given(function, 1, "p")
    assert again is function


def test_a_function_cannot_change_the_points_it_is_given() -> None:
    points = np.ones((2, 3))

    def greedy(x: np.ndarray) -> np.ndarray:
        x *= 0
        return x

    assert given(greedy, 3, "u")(points).max() == 0
    assert points.min() == 1
