# SPDX-License-Identifier: BSD-3-Clause
"""From values to controls and back, exactly in fractions and to measured errors in floats."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from bezsoma import bernstein as bb

EXACT = [(n, d) for d in (1, 2, 3) for n in range(5)] + [(10, 1), (10, 2), (6, 3)]


def exact_points(n: int, d: int) -> np.ndarray:
    return bb.indices(n, d).astype(object) * Fraction(1, n) if n else centroid(d)


def centroid(d: int) -> np.ndarray:
    return np.full((1, d + 1), Fraction(1, d + 1), dtype=object)


@pytest.mark.parametrize(("n", "d"), EXACT)
def test_it_is_the_inverse_of_the_values(n: int, d: int) -> None:
    matrix = bb.values(n, exact_points(n, d))
    inverse = bb.interpolation(n, d, exact=True)
    assert np.array_equal(matrix @ inverse, np.eye(bb.count(n, d), dtype=int))


def test_it_is_the_inverse_of_the_values_at_degree_10_in_a_tet() -> None:
    """Full product too slow in fractions: one exact vector through both, and its way back."""
    numbers = np.random.default_rng(0).integers(-99, 99, 286)
    controls = numbers.astype(object) * Fraction(1)
    sampled = bb.values(10, exact_points(10, 3)) @ controls
    assert (bb.interpolation(10, 3, exact=True) @ sampled).tolist() == controls.tolist()


@pytest.mark.parametrize(("n", "d"), [(1, 1), (4, 2), (8, 3), (10, 3)])
def test_every_float_entry_is_the_exact_one_rounded_once(n: int, d: int) -> None:
    exact = bb.interpolation(n, d, exact=True)
    assert np.array_equal(bb.interpolation(n, d), exact.astype(np.float64))


@pytest.mark.parametrize("d", [1, 2, 3])
@pytest.mark.parametrize("n", range(1, 11))
def test_round_trips_keep_their_digits(n: int, d: int) -> None:
    """Worst of 30 nets in a tet: 1e-15 at degree 4, 1e-14 at 6, 6e-14 at 8, 7e-13 at 10."""
    bound = 3e-15 * max(1.0, 2.3 ** (n - 2))
    controls = np.random.default_rng(n).uniform(-1, 1, bb.count(n, d))
    to_values, to_controls = bb.values(n, bb.domain_points(n, d)), bb.interpolation(n, d)
    assert np.abs(to_controls @ (to_values @ controls) - controls).max() < bound
    assert np.abs(to_values @ (to_controls @ controls) - controls).max() < bound


def test_the_question_itself_is_as_well_conditioned_as_stated() -> None:
    sums = {n: np.abs(bb.interpolation(n, 3)).sum(axis=1).max() for n in (4, 8, 10)}
    assert {n: float(f"{s:.2g}") for n, s in sums.items()} == {4: 35, 8: 1900, 10: 13000}


def test_a_sampled_cubic_comes_back_as_its_controls() -> None:
    """(x - y)^3 on a tet: controls from the product of affine functions, done by hand."""
    at = exact_points(3, 3)
    sampled = (at[:, 1] - at[:, 2]) ** 3
    line = np.array([0, 1, -1, 0], dtype=object)
    cubic = bb.product(bb.product(line, 1, line, 1, 3), 2, line, 1, 3)
    assert (bb.interpolation(3, 3, exact=True) @ sampled).tolist() == cubic.tolist()


def test_neighbours_agree() -> None:
    """Values on a face alone decide the face's controls, by the face's own matrix."""
    whole = bb.interpolation(5, 3)
    for face in [(1, 2, 3), (0, 2, 3), (0, 1), (3,)]:
        on_face = bb.trace(5, 3, face)
        rest = np.setdiff1d(np.arange(bb.count(5, 3)), on_face)
        assert not whole[np.ix_(on_face, rest)].any()
        assert np.array_equal(whole[np.ix_(on_face, on_face)], bb.interpolation(5, len(face) - 1))
