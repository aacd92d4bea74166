# SPDX-License-Identifier: BSD-3-Clause
"""Values and derivatives in floating point: what must hold to the last digits."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from bezsoma import bernstein as bb
from bezsoma.errors import InputError

U = 2.0**-53
CASES = [(n, d) for d in (1, 2, 3) for n in (0, 1, 2, 3, 6, 10, 20)]


def inside(points: int, d: int) -> np.ndarray:
    return np.random.default_rng(points).dirichlet(np.ones(d + 1), points)


@pytest.mark.parametrize(("n", "d"), CASES)
def test_relative_error_is_that_of_n_roundings(n: int, d: int) -> None:
    """At typical points, and where a coordinate is tiny or the point is far outside."""
    points = inside(12, d)
    points[0, 0] = 1e-11
    points[1, 0] = -7.3
    exact = np.vectorize(Fraction, otypes=[object])(points)
    expected, found = bb.values(n, exact), bb.values(n, points)
    for right, value in zip(expected.ravel(), found.ravel(), strict=True):
        assert abs(Fraction(value) - right) <= (n + 1) * U * abs(right)


@pytest.mark.parametrize(("n", "d"), CASES)
def test_positive_and_one_in_sum(n: int, d: int) -> None:
    values = bb.values(n, inside(500, d))
    assert values.shape == (500, bb.count(n, d))
    assert values.min() > 0
    assert np.abs(values.sum(axis=1) - 1).max() <= 20 * U + n * 4 * U


@pytest.mark.parametrize(("n", "d"), CASES)
def test_at_a_vertex_one_control_is_left(n: int, d: int) -> None:
    values = bb.values(n, np.eye(d + 1))
    for vertex in range(d + 1):
        alpha = n * np.eye(d + 1, dtype=int)[vertex]
        assert values[vertex, bb.position(alpha)] == 1
        assert np.count_nonzero(values[vertex]) == 1


@pytest.mark.parametrize(("n", "d"), CASES)
def test_derivatives_obey_eulers_identity(n: int, d: int) -> None:
    """B is homogeneous: sum_i L_i dB/dL_i = n B, and along sum zero the partials sum to 0."""
    points = inside(50, d)
    slopes = bb.derivatives(n, points)
    assert slopes.shape == (50, bb.count(n, d), d + 1)
    euler = np.einsum("pai,pi->pa", slopes, points)
    assert np.allclose(euler, n * bb.values(n, points), rtol=1e-13, atol=0)
    assert np.allclose(slopes.sum(axis=1), n, rtol=1e-13)  # of (L_0 + .. + L_d)^n


def test_any_shape_of_points_is_kept() -> None:
    points = inside(6, 2)
    flat = bb.values(4, points)
    assert np.array_equal(bb.values(4, points.reshape(2, 3, 3)), flat.reshape(2, 3, -1))
    assert np.array_equal(bb.values(4, points[0]), flat[0])
    assert bb.derivatives(4, points.reshape(3, 2, 3)).shape == (3, 2, 15, 3)
    assert bb.values(4, np.zeros((0, 3))).shape == (0, 15)
    assert bb.values(3, [[0, 1]]).tolist() == [[0.0, 0.0, 0.0, 1.0]]


def test_a_point_is_a_simplex_too() -> None:
    assert bb.values(3, np.array([[2.0]])).tolist() == [[8.0]]
    assert bb.derivatives(3, np.array([2.0])).tolist() == [[12.0]]


@pytest.mark.parametrize("shape", [(), (3, 0), (7, 5)])
def test_points_of_another_shape_are_refused(shape: tuple[int, ...]) -> None:
    with pytest.raises(InputError, match=r"barycentric points of shape .* 4 in a tet"):
        bb.values(2, np.zeros(shape))
