# SPDX-License-Identifier: BSD-3-Clause
"""Conjugate gradients: the laws that make them more than a descent.

That the answer is right does not show them to be conjugate: a slower descent gets there too. The
number of iterations does.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from bezsoma.arrays import Floats
from bezsoma.errors import NotConverged
from bezsoma.solvers.bicgstab import stabilised
from bezsoma.solvers.krylov import Operator, conjugate_gradients, dot


def operator(eigenvalues: list[float], seed: int = 2) -> tuple[Operator, Floats, int]:
    """A symmetric operator on (c, 3) with these eigenvalues, each often; its matrix; c."""
    rows = 4 * len(eigenvalues)
    turn, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3 * rows, 3 * rows)))
    A = turn @ np.diag(np.resize(eigenvalues, 3 * rows)) @ turn.T
    return (lambda x: (A @ x.ravel()).reshape(-1, 3)), A, rows


def load(rows: int) -> Floats:
    return np.random.default_rng(3).normal(size=(rows, 3))


def same(r: Floats) -> Floats:
    return r.copy()


@pytest.mark.parametrize("eigenvalues", [[3.0], [1.0, 9.0], [1.0, 2.0, 5.0, 9.0, 40.0]])
def test_as_many_iterations_as_distinct_eigenvalues(eigenvalues: list[float]) -> None:
    apply, A, rows = operator(eigenvalues)
    x, history = conjugate_gradients(apply, same, load(rows), 1e-11)
    assert len(history) - 1 == len(eigenvalues)
    assert np.allclose(A @ x.ravel(), load(rows).ravel(), atol=1e-9)


def test_one_iteration_with_the_inverse_as_preconditioner() -> None:
    apply, A, rows = operator([1.0, 2.0, 5.0, 9.0, 40.0])
    inverse = np.linalg.inv(A)
    _, history = conjugate_gradients(
        apply, lambda r: (inverse @ r.ravel()).reshape(-1, 3), load(rows), 1e-11
    )
    assert len(history) - 1 == 1


def test_the_error_falls_in_the_energy_norm_as_fast_as_theory_bounds_it() -> None:
    """|e_k| <= 2 ((sqrt c - 1) / (sqrt c + 1))^k |e_0| with the condition number c."""
    eigenvalues = np.linspace(1, 100, 40).tolist()
    apply, A, rows = operator(eigenvalues)
    exact = np.linalg.solve(A, load(rows).ravel())

    def size(e: Floats) -> float:
        return float(np.sqrt(e @ A @ e))

    q = (np.sqrt(100) - 1) / (np.sqrt(100) + 1)
    for most in (5, 10, 20):
        x = np.zeros((rows, 3))
        with pytest.raises(NotConverged) as stopped:
            conjugate_gradients(apply, same, load(rows), 1e-14, most=most)
        assert len(stopped.value.history) == most + 1
        x, history = conjugate_gradients(
            apply, same, load(rows), stopped.value.history[-1] * (1 + 1e-9)
        )
        assert len(history) - 1 <= most
        assert size(x.ravel() - exact) <= 2 * q ** (len(history) - 1) * size(exact)


@pytest.mark.parametrize("way", [conjugate_gradients, stabilised])
def test_rough_products_give_an_answer_as_good(way: Any) -> None:
    """To float32 alone the residual would stay near 1e-6; the true one brings it to 1e-11."""
    apply, A, rows = operator(np.linspace(1, 30, 40).tolist())
    rough_A, asked = A.astype(np.float32), []

    def rough(x: Any) -> Any:
        assert x.dtype == np.float32, "its vectors are to take half the memory"
        return (rough_A @ x.ravel()).reshape(-1, 3)

    def exact(x: Floats) -> Floats:
        asked.append(1)
        return apply(x)

    x, _ = way(exact, same, load(rows), 1e-11, 300, rough=rough)
    left = np.linalg.norm(load(rows).ravel() - A @ x.ravel())
    assert left <= 1e-11 * np.linalg.norm(load(rows))
    assert len(asked) <= 5, "exact products are for the true residual"


def test_sums_of_float32_are_as_exact_as_their_numbers() -> None:
    """A running sum in float32 would lose a thousandth of a million ones."""
    x = np.full((400_001, 3), 1.0, dtype=np.float32)
    y = np.random.default_rng(1).normal(size=x.shape).astype(np.float32)
    assert dot(x, x) == x.size
    exact = float((y.astype(float) ** 2).sum())
    assert dot(y, y) == pytest.approx(exact, rel=1e-6)
    assert dot(y[:7], y[:7]) == pytest.approx(float((y[:7].astype(float) ** 2).sum()), rel=1e-14)
