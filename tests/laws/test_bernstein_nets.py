# SPDX-License-Identifier: BSD-3-Clause
"""Nets of controls in exact fractions, each against evaluation at points."""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations, permutations

import numpy as np
import pytest

from bezsoma import bernstein as bb
from bezsoma.errors import InputError

CASES = [(n, d) for d in (1, 2, 3) for n in (0, 1, 2, 3, 5)] + [(10, 1), (10, 2), (8, 3)]
DEEP = [*CASES, (10, 3)]
SUB_SIMPLICES = [(n, d, e) for n, d in CASES for e in range(d + 1)] + [(10, 3, 2)]


def fractions(*shape: int, seed: int = 0) -> np.ndarray:
    draw = np.random.default_rng(seed).integers(-20, 21, size=shape)
    return np.vectorize(lambda k: Fraction(int(k), 11), otypes=[object])(draw)


def points(count: int, d: int, seed: int = 1) -> np.ndarray:
    """Exact barycentric points, inside and outside."""
    rest = fractions(count, d, seed=seed)
    return np.concatenate([1 - rest.sum(axis=1, keepdims=True), rest], axis=1)


def value(controls: np.ndarray, n: int, bary: np.ndarray) -> list[Fraction]:
    return (bb.values(n, bary) @ controls).tolist()


@pytest.mark.parametrize(("n", "d"), DEEP)
def test_elevation_keeps_the_polynomial(n: int, d: int) -> None:
    controls, at = fractions(bb.count(n, d), 2), points(2, d)
    for by in (0, 1, 2, 4):
        assert value(bb.elevated(controls, n, d, by), n + by, at) == value(controls, n, at)


@pytest.mark.parametrize(("n", "d"), [case for case in CASES if case != (8, 3)])
def test_the_matrix_of_elevation_is_the_steps_of_elevation(n: int, d: int) -> None:
    eye = np.vectorize(Fraction, otypes=[object])(np.eye(bb.count(n, d), dtype=object))
    for by in (1, 3):
        matrix = bb.elevation(n, d, by, exact=True)
        assert np.array_equal(matrix, bb.elevated(eye, n, d, by))
        assert (matrix.sum(axis=1) == 1).all()
        assert (matrix >= 0).all()
        assert np.array_equal(bb.elevation(n, d, by), matrix.astype(float))


@pytest.mark.parametrize(("n", "d"), DEEP)
def test_de_casteljau_is_the_value(n: int, d: int) -> None:
    controls, at = fractions(bb.count(n, d), 3), points(2, d)
    assert [bb.de_casteljau(controls, n, p).tolist() for p in at] == value(controls, n, at)


@pytest.mark.parametrize(("n", "d"), [case for case in CASES if case[0] > 0])
def test_the_blossom_is_symmetric_affine_and_true_on_the_diagonal(n: int, d: int) -> None:
    controls, at = fractions(bb.count(n, d)), points(n + 1, d)
    bloom = bb.blossom(controls, n, at[:n])
    assert bb.blossom(controls, n, at[:n][::-1]) == bloom
    t = Fraction(3, 7)
    middle = at.copy()
    middle[0] = t * at[0] + (1 - t) * at[n]
    other = np.concatenate([at[n:], at[1:n]])
    mixed = t * bloom + (1 - t) * bb.blossom(controls, n, other)
    assert bb.blossom(controls, n, middle[:n]) == mixed
    assert bb.blossom(controls, n, np.tile(at[0], (n, 1))) == value(controls, n, at[:1])[0]


@pytest.mark.parametrize(("n", "d"), [(1, 3), (3, 2), (4, 3)])
def test_controls_are_blossoms_at_vertices(n: int, d: int) -> None:
    controls, vertices = fractions(bb.count(n, d)), np.eye(d + 1, dtype=object)
    for alpha, control in zip(bb.indices(n, d), controls, strict=True):
        assert bb.blossom(controls, n, np.repeat(vertices, alpha, axis=0)) == control


@pytest.mark.parametrize(("n", "d"), CASES)
def test_the_levels_hold_the_nets_of_the_children(n: int, d: int) -> None:
    """Figure 5 of the paper: vertex i replaced by the point; read off, not computed again."""
    controls, at = fractions(bb.count(n, d)), points(1, d)[0]
    levels = bb.de_casteljau_levels(controls, n, np.tile(at, (n, 1)))
    assert [len(level) for level in levels] == [bb.count(k, d) for k in range(n, -1, -1)]
    for i in range(d + 1):
        corners = np.eye(d + 1, dtype=object)
        corners[i] = at
        child = bb.restriction(n, d, corners) @ controls
        for alpha, control in zip(bb.indices(n, d), child, strict=True):
            rest = alpha * (np.arange(d + 1) != i)
            assert levels[alpha[i]][bb.position(rest)] == control


@pytest.mark.parametrize(("n", "d", "e"), SUB_SIMPLICES)
def test_restriction_is_the_polynomial_on_the_sub_simplex(n: int, d: int, e: int) -> None:
    controls, corners, inner = fractions(bb.count(n, d)), points(e + 1, d, seed=5), points(1, e)
    sub = bb.restriction(n, d, corners) @ controls
    assert value(sub, n, inner) == value(controls, n, inner @ corners)


def test_restricting_twice_is_restricting_once() -> None:
    first, second = points(4, 3, seed=6), points(3, 3, seed=7)
    once = bb.restriction(4, 3, second @ first)
    assert np.array_equal(bb.restriction(4, 3, second) @ bb.restriction(4, 3, first), once)


def test_corners_inside_give_convex_weights() -> None:
    corners = np.random.default_rng(8).dirichlet(np.ones(4), 4)
    rows = bb.restriction(10, 3, corners)
    assert rows.min() > 0
    assert np.abs(rows.sum(axis=1) - 1).max() < 2e-15


@pytest.mark.parametrize(("n", "d"), CASES)
def test_a_trace_is_the_restriction_to_vertices(n: int, d: int) -> None:
    controls, vertices = fractions(bb.count(n, d)), np.eye(d + 1, dtype=object)
    for size in range(1, d + 2):
        faces = [p for c in combinations(range(d + 1), size) for p in permutations(c)]
        for face in faces if n <= 3 else faces[:3]:
            on_face = bb.restriction(n, d, vertices[list(face)]) @ controls
            assert controls[bb.trace(n, d, face)].tolist() == on_face.tolist()


def test_vector_controls_ride_along() -> None:
    a, b = fractions(10, 2, 3), fractions(4, 2, 3, seed=1)
    ab = bb.product(a, 2, b, 1, 3)
    assert ab.shape == (20, 2, 3)
    assert ab[:, 1, 2].tolist() == bb.product(a[:, 1, 2], 2, b[:, 1, 2], 1, 3).tolist()
    assert bb.derivative(a, 2, 3).shape == (4, 4, 2, 3)
    assert bb.de_casteljau(a, 2, points(1, 3)[0]).shape == (2, 3)
    assert bb.elevated(a, 2, 3).shape == (20, 2, 3)


def test_products_reach_degree_20() -> None:
    a, b, at = fractions(286), fractions(286, seed=1), points(1, 3)
    ab = bb.product(a, 10, b, 10, 3)
    assert value(ab, 20, at) == [value(a, 10, at)[0] * value(b, 10, at)[0]]


@pytest.mark.parametrize("d", [1, 2, 3])
def test_the_derivative_along_a_direction_is_the_limit_of_differences(d: int) -> None:
    """A cubic's central difference errs by h^2 times a constant: removed by halving h."""
    controls, (at, end) = fractions(bb.count(3, d)), points(2, d)
    along = end - at
    slope = bb.values(2, at) @ (bb.derivative(controls, 3, d) @ along)

    def difference(h: Fraction) -> Fraction:
        ahead, behind = (bb.de_casteljau(controls, 3, at + s * h * along) for s in (1, -1))
        return (ahead - behind) / (2 * h)

    assert slope == (4 * difference(Fraction(1, 2)) - difference(Fraction(1))) / 3


def test_integers_among_objects_stay_exact() -> None:
    net = np.array([0, 1, 0], dtype=object)
    assert bb.elevated(net, 2, 1).tolist() == [0, Fraction(2, 3), Fraction(2, 3), 0]
    assert bb.product(net, 2, net, 2, 1).tolist() == [0, 0, Fraction(2, 3), 0, 0]
    halves = np.array([0.5, Fraction(1, 2), 0], dtype=object)  # mixed: as exact as its parts
    assert bb.elevated(halves, 2, 1).tolist() == [0.5, 0.5, Fraction(1, 3), 0]


def test_misfits_are_refused() -> None:
    with pytest.raises(InputError, match="9 controls were given; degree 2 in dimension 3 has 10"):
        bb.elevated(np.zeros(9), 2, 3)
    with pytest.raises(InputError, match=r"degree 3 by -1 .* elevate by 0 or more"):
        bb.elevation(3, 3, -1)
    with pytest.raises(InputError, match="degree 2 by -2 "):
        bb.elevated(np.zeros(10), 2, 3, -2)
    with pytest.raises(InputError, match=r"shape \(2, 3\) .* each corner has 4"):
        bb.restriction(2, 3, np.zeros((2, 3)))
    with pytest.raises(InputError, match=r"vertices \(0, 0\) .* at most once"):
        bb.trace(2, 3, (0, 0))
    with pytest.raises(InputError, match=r"vertices \(4,\) .* has \[0, 1, 2, 3\]"):
        bb.trace(2, 3, (4,))
    with pytest.raises(InputError, match=r"shape \(1, 2\) .* degree 2 takes 2 barycentric"):
        bb.blossom(np.zeros(3), 2, np.zeros((1, 2)))
    with pytest.raises(InputError, match="degree 0 was asked for; it is zero"):
        bb.derivative(np.zeros(1), 0, 3)
