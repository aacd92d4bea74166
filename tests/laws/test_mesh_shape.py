# SPDX-License-Identifier: BSD-3-Clause
"""Flat or not, and which way round: decided as exact fractions would decide it."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bezsoma import _core
from bezsoma.mesh.shape import FLAT, LARGEST, flat_tets, heights_and_lengths
from bezsoma.mesh.topology import determinants

ONE = np.array([[0, 1, 2, 3]])
BASE = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0.3, 0.3, 0]])


def raised(height: float) -> np.ndarray:
    """The four points, of which the last is lifted off the plane of the others."""
    points = BASE.copy()
    points[3, 2] = height
    return points


def exact(points: np.ndarray) -> Fraction:
    """det[p1 - p0, p2 - p0, p3 - p0] by Leibniz, in fractions."""
    rows = [[Fraction(float(x)) for x in point] for point in points]
    a, b, c = ([x - y for x, y in zip(row, rows[0], strict=True)] for row in rows[1:])
    even = a[0] * b[1] * c[2] + a[1] * b[2] * c[0] + a[2] * b[0] * c[1]
    return even - a[2] * b[1] * c[0] - a[1] * b[0] * c[2] - a[0] * b[2] * c[1]


@settings(max_examples=150, deadline=None)
@given(
    st.floats(-1e-6, 1e-6).filter(lambda h: abs(h) > 1e-9),
    st.sampled_from([1e-6, 1.0, 1e3]),
    st.integers(0, 10**6),
)
def test_orientation_of_thin_tets_is_exact(height: float, scale: float, seed: int) -> None:
    """Whatever the frame: a height of 1e-9 of the size is thin, not flat."""
    random = np.random.default_rng(seed)
    turn = np.linalg.qr(random.normal(size=(3, 3)))[0]
    points = scale * (raised(height) @ turn.T)
    signs, flat = flat_tets(points, ONE)
    assert not flat[0]
    assert signs[0] == (1 if exact(points) > 0 else -1)


@pytest.mark.parametrize("width", [3e-9, 1e-9])
def test_which_way_round_a_needle_is_does_not_hang_on_rounding(width: float) -> None:
    """Its determinant, some width squared, is as small as what rounds in the terms of its sum."""
    tip = np.array([[0, 0, 1.0], [width, 0, 0], [0, width, 0], [0, 0, 0]])
    random, rounded = np.random.default_rng(2), 0
    for _ in range(200):
        points = tip @ np.linalg.qr(random.normal(size=(3, 3)))[0].T
        signs, flat = flat_tets(points, ONE)
        true = exact(points)
        assert flat[0] or signs[0] == (1 if true > 0 else -1)
        rounded += determinants(points[ONE])[0] * true <= 0
    assert rounded > 10


@pytest.mark.parametrize("width", [1e-3, 1e-5, 1e-7])
def test_needles_are_not_flat(width: float) -> None:
    """Volume over length cubed is width squared, but the tet is as thick as it is wide."""
    tip = np.array([[0, 0, 1.0], [width, 0, 0], [0, width, 0], [0, 0, 0]])
    turn = np.linalg.qr(np.random.default_rng(5).normal(size=(3, 3)))[0]
    for points in (tip, tip @ turn.T):
        signs, flat = flat_tets(points, ONE)
        assert not flat[0]
        assert signs[0] == (1 if exact(points) > 0 else -1)


@pytest.mark.parametrize("scale", [1e-9, 1e-6, 1.0, 1e6])
@pytest.mark.parametrize("height", [0.0, 0.3 * FLAT, -0.3 * FLAT])
def test_flat_is_flat_at_any_scale(scale: float, height: float) -> None:
    points = scale * raised(height)
    assert flat_tets(points, ONE)[1][0]
    points[3, 2] += 1e-3 * scale
    assert not flat_tets(points, ONE)[1][0]


def test_flat_within_the_rounding_of_scanner_coordinates() -> None:
    """Four points on a sloping plane 1000 mm away do not lie on it to the last bit."""
    random = np.random.default_rng(2)
    corners = random.uniform(-1, 1, (200, 4, 2)) @ random.normal(size=(2, 3)) + 1000 / 3
    assert (np.abs([float(exact(x)) for x in corners]) > 0).mean() > 0.5
    points, tets = corners.reshape(-1, 3), np.arange(800).reshape(-1, 4)
    assert flat_tets(points, tets)[1].all()


def test_many_tets_in_parts_are_judged_like_one() -> None:
    random = np.random.default_rng(3)
    points = random.normal(size=(1000, 3))
    tets = np.sort(random.permuted(np.tile(np.arange(1000), (160, 1)), axis=1)[:, :4], axis=1)
    tets = np.concatenate([tets] * 250)
    signs, flat = flat_tets(points, tets)
    assert not flat.any()
    assert signs.tolist() == [1 if exact(points[row]) > 0 else -1 for row in tets[:160]] * 250


def test_height_and_length_of_the_regular_tet() -> None:
    points = np.array([[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
    height, length = heights_and_lengths(points[None])
    assert length == pytest.approx(np.sqrt(8))
    assert height == pytest.approx(length * np.sqrt(2 / 3))


def test_a_height_within_the_rounding_of_large_coordinates_is_none() -> None:
    """5e-10 mm are a height beside edges of 1 mm, and nothing that is known at 1e6 mm."""
    thin = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 5e-10]])
    tet = np.array([[0, 1, 2, 3]])
    assert flat_tets(thin, tet)[1].tolist() == [False]
    assert flat_tets(thin + 1e6, tet)[1].tolist() == [True]
    assert flat_tets(thin[[1, 0, 2, 3]], tet)[0].tolist() == [-1]


def test_the_few_that_are_in_doubt_are_looked_at_in_python() -> None:
    """All but the flat and the nearly flat are decided by the core alone."""
    rng = np.random.default_rng(5)
    points = rng.standard_normal((4000, 3))
    tets = np.arange(4000).reshape(-1, 4)
    found = _core.orientations(points, tets, FLAT, LARGEST)
    assert np.array_equal(found, np.sign(determinants(points[tets])))
    points[3::4] = points[0::4] + 1e-12 * points[3::4]
    assert not _core.orientations(points, tets, FLAT, LARGEST).any()
    assert flat_tets(points, tets)[1].all()
