# SPDX-License-Identifier: BSD-3-Clause
"""Closed forms of integrals: up to degree 10, on faces, and against the divergence theorem."""

from __future__ import annotations

from fractions import Fraction
from math import factorial, prod

import numpy as np
import pytest

from bezsoma import bernstein as bb
from tolerances import ROUNDING

PAIRS = [(n, m, d) for d in (1, 2, 3) for n, m in ((1, 1), (2, 1), (3, 3), (5, 2))]


def multinomial(alpha: np.ndarray) -> int:
    return factorial(int(alpha.sum())) // prod(factorial(int(a)) for a in alpha)


def mean_of_product(alpha: np.ndarray, beta: np.ndarray) -> Fraction:
    """From the factorial formula for monomials, with no binomial in sight."""
    both, d = alpha + beta, len(alpha) - 1
    above = prod(factorial(int(a)) for a in both) * factorial(d)
    scale = multinomial(alpha) * multinomial(beta)
    return Fraction(scale * above, factorial(int(both.sum()) + d))


@pytest.mark.parametrize(("n", "m", "d"), [(10, 10, 1), (10, 10, 2), (10, 10, 3), (20, 10, 3)])
def test_mass_at_high_degrees(n: int, m: int, d: int) -> None:
    exact, floats = bb.mass(n, m, d, exact=True), bb.mass(n, m, d)
    rng = np.random.default_rng(0)
    rows, columns = rng.integers(len(exact), size=60), rng.integers(exact.shape[1], size=60)
    for a, b in zip(rows, columns, strict=True):
        right = mean_of_product(bb.indices(n, d)[a], bb.indices(m, d)[b])
        assert exact[a, b] == right
        assert floats[a, b] == float(right)  # one division: correctly rounded


@pytest.mark.parametrize("d", [1, 2, 3])
def test_gradient_products_at_degree_10(d: int) -> None:
    exact, floats = bb.gradient_products(10, d, exact=True), bb.gradient_products(10, d)
    rng, m, units = np.random.default_rng(1), bb.count(10, d), np.eye(d + 1, dtype=int)
    for i, j in np.ndindex(d + 1, d + 1):
        for a, b in rng.integers(m, size=(40, 2)):
            lower = bb.indices(10, d)[a] - units[i], bb.indices(10, d)[b] - units[j]
            right = 100 * mean_of_product(*lower) if min(map(np.min, lower)) >= 0 else 0
            assert exact[i, j, a, b] == right
            assert abs(floats[i, j, a, b] - right) <= 2**-52 * right


@pytest.mark.parametrize(("n", "m", "d"), PAIRS)
def test_divergence_theorem(n: int, m: int, d: int) -> None:
    """Volume against faces: int d_g (B_a B_b) = sum over faces of int B_a B_b (g . normal).

    The face opposite vertex f has outward area normal -d V grad L_f, so per unit volume it
    weighs -d g_f, g being a direction in barycentric numbers that sum to zero.
    """
    for vertex in range(1, d + 1):
        g = np.eye(d + 1, dtype=int)[vertex] - np.eye(d + 1, dtype=int)[0]
        left = np.tensordot(g, bb.gradient_moments(n, m, d, exact=True), axes=1)
        right = np.tensordot(g, bb.gradient_moments(m, n, d, exact=True), axes=1).T
        faces = [tuple(v for v in range(d + 1) if v != f) for f in range(d + 1)]
        flux = sum(-d * g[f] * bb.face_mass(n, m, d, faces[f], exact=True) for f in range(d + 1))
        assert np.array_equal(left + right, flux)


@pytest.mark.parametrize("d", [1, 2, 3])
def test_products_integrate_like_their_controls(d: int) -> None:
    """Mean of p q as a' M b, and as the plain average of the product's controls."""
    rng = np.random.default_rng(2)
    for n, m in ((1, 2), (4, 4), (3, 0), (10, 10)):
        a = rng.integers(-9, 9, bb.count(n, d)).astype(object)
        b = rng.integers(-9, 9, bb.count(m, d)).astype(object)
        controls = bb.product(a, n, b, m, d)
        assert a @ bb.mass(n, m, d, exact=True) @ b == sum(controls) * Fraction(1, len(controls))


@pytest.mark.parametrize(("n", "d"), [(1, 3), (3, 2), (4, 3), (10, 3)])
def test_constants_have_no_stiffness_and_energies_do_not_turn_negative(n: int, d: int) -> None:
    g = np.random.default_rng(3).standard_normal((d + 1, d))
    g[0] = -g[1:].sum(axis=0)  # gradients of L_0 .. L_d sum to zero
    stiffness = np.einsum("ik,jk,ijab->ab", g, g, bb.gradient_products(n, d))
    assert np.abs(stiffness.sum(axis=1)).max() < ROUNDING * np.abs(stiffness).max()
    assert np.abs(stiffness - stiffness.T).max() < ROUNDING * np.abs(stiffness).max()
    eigenvalues = np.linalg.eigvalsh(stiffness)
    assert abs(eigenvalues[0]) < ROUNDING * eigenvalues[-1] < eigenvalues[1]


@pytest.mark.parametrize(("n", "d"), [(1, 1), (3, 2), (1, 3), (3, 3)])
def test_stiffness_does_not_feel_elevation(n: int, d: int) -> None:
    up = bb.elevation(n, d, exact=True)
    g = np.array([[-1] * d, *np.eye(d, dtype=int).tolist()], dtype=object)
    low, high = (
        np.einsum("ik,jl,ijab->klab", g, g, bb.gradient_products(k, d, exact=True))
        for k in (n, n + 1)
    )
    for k, m in np.ndindex(d, d):
        assert np.array_equal(up.T @ high[k, m] @ up, low[k, m])


@pytest.mark.parametrize(("n", "m", "d"), [*PAIRS, (7, 7, 2), (5, 5, 3)])
def test_the_ladder_is_the_mass_matrix(n: int, m: int, d: int) -> None:
    total = 0
    for j, weight in enumerate(bb.ladder(n, m, d, exact=True)):
        assert weight > 0
        up_n, up_m = (bb.elevation(j, d, k - j, exact=True) for k in (n, m))
        total = total + weight * (up_n @ up_m.T)
    assert np.array_equal(total, bb.mass(n, m, d, exact=True))


@pytest.mark.parametrize("face", [(0, 1, 2), (3, 1, 0), (1, 3), (2,), (0, 1, 2, 3)])
def test_faces_integrate_their_traces(face: tuple[int, ...]) -> None:
    """On the face's own net, found by restriction to its corners."""
    to_face = bb.restriction(3, 3, np.eye(4, dtype=object)[list(face)])
    expected = to_face.T @ bb.mass(3, 3, len(face) - 1, exact=True) @ to_face
    assert np.array_equal(bb.face_mass(3, 3, 3, face, exact=True), expected)


def test_floats_and_fractions_agree() -> None:
    pairs = [
        (bb.integral(7, 3), bb.integral(7, 3, exact=True)),
        (bb.monomial((3, 0, 2, 5)), bb.monomial((3, 0, 2, 5), exact=True)),
        (bb.gradient_moments(4, 3, 3), bb.gradient_moments(4, 3, 3, exact=True)),
        (bb.face_mass(4, 3, 3, (0, 2, 3)), bb.face_mass(4, 3, 3, (0, 2, 3), exact=True)),
        (bb.ladder(8, 8, 3), bb.ladder(8, 8, 3, exact=True)),
    ]
    for floats, exact in pairs:
        assert np.allclose(floats, np.asarray(exact, dtype=float), rtol=4e-16, atol=0)


def test_moments_of_floats() -> None:
    controls = np.random.default_rng(4).standard_normal((20, 3))
    assert np.allclose(bb.moments(controls, 3, 2, 3), bb.mass(2, 3, 3) @ controls, rtol=1e-14)
