# SPDX-License-Identifier: BSD-3-Clause
"""The incomplete Cholesky factorisation, against a dense one of few lines."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from scipy.sparse import bsr_array

from bezsoma import _core
from bezsoma.arrays import Bools, Floats
from bezsoma.equations.assembled import BlockMatrix, assembled
from bezsoma.errors import NotConverged
from bezsoma.mesh import ControlNet, TetMesh, block
from bezsoma.solvers.krylov import (
    FIRST_SHIFT,
    IncompleteCholesky,
    conjugate_gradients,
    incomplete_cholesky,
)

KERSHAW = np.array([[3.0, -2, 0, 2], [-2, 3, -2, 0], [0, -2, 3, -2], [2, 0, -2, 3]])
"""Positive definite, and IC(0) breaks down: D. S. Kershaw, J. Comp. Phys. 26 (1978)."""


def blocks_of(dense: Floats) -> BlockMatrix:
    """A dense matrix as one of 3x3 blocks."""
    m = bsr_array(dense, blocksize=(3, 3)).sorted_indices()
    return BlockMatrix(m.indptr.astype(np.int64), m.indices.astype(np.int32), m.data.copy())


def dense_factor(factor: IncompleteCholesky) -> Floats:
    """L as a dense matrix."""
    c = len(factor.starts) - 1
    lower = bsr_array((factor.below, factor.columns, factor.starts), shape=(3 * c,) * 2).toarray()
    for i, inverse in enumerate(factor.inverse):
        lower[3 * i : 3 * i + 3, 3 * i : 3 * i + 3] = np.linalg.inv(inverse)
    return lower


def reference(A: Floats, keep: Bools) -> Floats:
    """IC(0) number by number, on the numbers of the blocks that A has."""
    L = np.zeros_like(A)
    for i in range(len(A)):
        for j in range(i):
            if keep[i, j]:
                L[i, j] = (A[i, j] - L[i, :j] @ L[j, :j]) / L[j, j]
        L[i, i] = np.sqrt(A[i, i] - L[i, :i] @ L[i, :i])
    return L


def problem(degree: int, cells: int = 2) -> tuple[BlockMatrix, Bools]:
    """A block that stands on its bottom, and is kept from moving along x on one side."""
    net = ControlNet(block(cells=cells, irregular=0.2), degree)
    held = np.zeros((net.count, 3), bool)
    held[net.of_place("bottom")] = True
    held[net.of_place("left"), 0] = True
    ones = np.ones(len(net.mesh.tets))
    return assembled(net, ones, ones), held


def with_identity(A: Floats, held: Bools) -> Floats:
    """A with the rows and columns of what is held replaced by those of the identity."""
    A = A.copy()
    rows = held.ravel()
    A[rows] = A[:, rows] = 0
    A[rows, rows] = 1
    return A


@pytest.mark.parametrize(("degree", "shift"), [(1, 0.0), (2, 0.5)])
def test_factor_is_the_dense_one(degree: int, shift: float) -> None:
    K, held = problem(degree)
    *parts, broken = _core.incomplete_cholesky(K.starts, K.columns, K.blocks, held, shift, 0.0)
    assert broken == -1
    A = K.scipy().toarray()
    A = with_identity(A + shift * np.diag(A.diagonal()), held)
    keep = np.kron(np.zeros((len(held),) * 2), np.ones((3, 3))).astype(bool)
    for i, (a, b) in enumerate(pairwise(K.starts)):
        for j in K.columns[a:b]:
            keep[3 * i : 3 * i + 3, 3 * j : 3 * j + 3] = True
    L = dense_factor(IncompleteCholesky(*parts, (shift,)))
    np.testing.assert_allclose(L, reference(A, keep), rtol=0, atol=1e-13)


def test_exact_where_nothing_is_left_out() -> None:
    net = ControlNet(TetMesh(np.eye(4, 3), [[0, 1, 2, 3]]), 3)
    held = np.zeros((net.count, 3), bool)
    held[net.of_facets(net.mesh.tets[:, :3])] = True
    K = assembled(net, np.ones(1), np.ones(1))
    L = dense_factor(incomplete_cholesky(K, held))
    np.testing.assert_allclose(L @ L.T, with_identity(K.scipy().toarray(), held), atol=1e-14)


def test_solve_is_that_of_the_factor() -> None:
    K, held = problem(2)
    factor = incomplete_cholesky(K, held)
    r = np.where(held, 0.0, np.random.default_rng(2).standard_normal(held.shape))
    L = dense_factor(factor)
    expected = np.linalg.solve(L @ L.T, r.ravel()).reshape(-1, 3)
    np.testing.assert_allclose(factor(r), expected, rtol=0, atol=1e-12 * np.abs(expected).max())
    assert (factor(r)[held] == 0).all()


def test_breakdown_raises_the_diagonal_until_it_holds() -> None:
    A = np.kron(KERSHAW, np.eye(3))
    factor = incomplete_cholesky(blocks_of(A), np.zeros((4, 3), bool))
    assert factor.tried[0] == 0 and factor.tried[1] == FIRST_SHIFT and factor.shift > 0
    assert all(b == 2 * a for a, b in pairwise(factor.tried[1:]))
    L = dense_factor(factor)
    kept = A != 0
    raised = A + factor.shift * np.diag(A.diagonal())
    np.testing.assert_allclose((L @ L.T)[kept], raised[kept], atol=1e-13)


def test_what_is_not_positive_definite_is_refused() -> None:
    with pytest.raises(NotConverged, match="not positive definite"):
        incomplete_cholesky(blocks_of(-np.eye(6)), np.zeros((2, 3), bool))


def test_conjugate_gradients_with_the_factor() -> None:
    K, held = problem(2)
    b = np.where(held, 0.0, np.random.default_rng(3).standard_normal(held.shape))

    def product(x: Floats) -> Floats:
        return np.where(held, 0.0, K @ x)

    x, history = conjugate_gradients(product, incomplete_cholesky(K, held), b, 1e-10)
    assert np.linalg.norm(b - product(x)) <= 1e-10 * np.linalg.norm(b)
    assert history[0] == 1 and history[-1] <= 1e-10
    plain = conjugate_gradients(product, lambda r: r.copy(), b, 1e-10)[1]
    assert len(history) < len(plain) / 3


def test_conjugate_gradients_end_exactly_in_as_many_steps_as_there_are_eigenvalues() -> None:
    sizes = np.repeat([1.0, 4.0, 9.0, 25.0], 3).reshape(4, 3)
    x, history = conjugate_gradients(
        lambda v: sizes * v, lambda r: r.copy(), np.ones((4, 3)), 1e-12
    )
    assert len(history) == 5
    np.testing.assert_allclose(x, 1 / sizes, rtol=1e-12)


def test_too_few_iterations_raise_with_the_history() -> None:
    K, held = problem(2)
    b = np.where(held, 0.0, 1.0)
    with pytest.raises(NotConverged, match=r"after 3 iterations.*solver='direct'") as raised:
        conjugate_gradients(
            lambda x: np.where(held, 0.0, K @ x), incomplete_cholesky(K, held), b, 1e-8, most=3
        )
    assert len(raised.value.history) == 4


def test_an_indefinite_operator_raises() -> None:
    with pytest.raises(NotConverged, match="without positive energy"):
        conjugate_gradients(lambda x: -x, lambda r: r.copy(), np.ones((2, 3)), 1e-8)


def test_rounding_that_keeps_the_residual_up_raises() -> None:
    noise = np.random.default_rng(0)

    def rough(x: Floats) -> Floats:
        return x * np.arange(1, 7).reshape(2, 3) * (1 + 1e-3 * noise.standard_normal(x.shape))

    with pytest.raises(NotConverged, match="rounding does not let it fall"):
        conjugate_gradients(rough, lambda r: r.copy(), np.ones((2, 3)), 1e-12)
