# SPDX-License-Identifier: BSD-3-Clause
"""The assembled matrix: its pattern, its values, its product."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from bezsoma import _core
from bezsoma.arrays import Floats
from bezsoma.equations.assembled import BlockMatrix, assembled, pattern
from bezsoma.equations.element import element_matrices
from bezsoma.mesh import ControlNet, block
from tolerances import RIGID

MODULI = (1.3, 0.7)


def net_of(degree: int) -> ControlNet:
    """A net on an irregular block."""
    return ControlNet(block(cells=(2, 2, 1), irregular=0.2), degree)


def moduli(net: ControlNet) -> tuple[Floats, Floats]:
    """Unequal moduli."""
    vary = np.linspace(1, 2, len(net.mesh.tets))
    return MODULI[0] * vary, MODULI[1] * vary[::-1].copy()


def dense_sum(net: ControlNet) -> Floats:
    """The matrix (3c, 3c), element by element."""
    mesh = net.mesh
    out = np.zeros((3 * net.count,) * 2)
    elements = element_matrices(net.degree, mesh.gradients, mesh.volumes, *moduli(net))
    for controls, K in zip(net.of_tet, elements, strict=True):
        rows = (3 * controls[:, None] + np.arange(3)).ravel()
        out[np.ix_(rows, rows)] += K
    return out


@pytest.mark.parametrize("degree", [1, 2, 3, 5])
def test_matrix_is_the_sum_of_elements(degree: int) -> None:
    net = net_of(degree)
    K, expected = assembled(net, *moduli(net)).scipy().toarray(), dense_sum(net)
    assert np.abs(K - expected).max() < 1e-14 * np.abs(expected).max()
    assert (K == K.T).all()


@pytest.mark.parametrize("degree", [1, 2, 4])
def test_pattern_is_who_meets_in_a_tet(degree: int) -> None:
    net = net_of(degree)
    meets = [set() for _ in range(net.count)]
    for controls in net.of_tet.tolist():
        for control in controls:
            meets[control] |= set(controls)
    starts, columns = pattern(net.of_tet, net.count)
    assert [columns[a:b].tolist() for a, b in pairwise(starts)] == [sorted(row) for row in meets]
    assert starts.dtype == np.int64 and columns.dtype == np.int32


def test_six_eigenvalues_vanish_in_a_whole_mesh() -> None:
    for degree in (1, 2, 3):
        sizes = np.abs(np.linalg.eigvalsh(dense_sum(net_of(degree))))
        assert (sizes < RIGID * sizes.max()).sum() == 6


def test_product_and_diagonal() -> None:
    net = net_of(3)
    K = assembled(net, *moduli(net))
    x = np.random.default_rng(1).standard_normal((net.count, 3))
    dense = K.scipy().toarray()
    np.testing.assert_allclose((K @ x).ravel(), dense @ x.ravel(), rtol=0, atol=1e-13)
    assert (K.diagonal.ravel() == dense.diagonal()).all()


def test_product_takes_any_layout() -> None:
    net = net_of(1)
    K = assembled(net, *moduli(net))
    x = np.random.default_rng(1).standard_normal((net.count, 3))
    assert (K @ np.asfortranarray(x) == K @ x).all()


def test_bits_do_not_depend_on_threads() -> None:
    net = ControlNet(block(cells=8, irregular=0.2), 2)
    one = assembled(net, *moduli(net), threads=1)
    x = np.random.default_rng(1).standard_normal((net.count, 3))
    products = []
    for threads in (1, 2, 5):
        many = assembled(net, *moduli(net), threads=threads)
        assert (many.blocks == one.blocks).all()
        y = np.empty_like(x)
        _core.multiply(one.starts, one.columns, one.blocks, x, y, threads)
        products.append(y)
    assert all((y == products[0]).all() for y in products)


def test_shapes_that_do_not_fit_are_refused() -> None:
    net = net_of(2)
    K = assembled(net, *moduli(net))
    with pytest.raises(ValueError, match="one row a control"):
        K @ np.zeros((net.count - 1, 3))
    mesh, (lam, mu) = net.mesh, moduli(net)
    with pytest.raises(ValueError, match="does not fit the degree"):
        _core.assembled(3, net.of_tet, mesh.gradients, mesh.volumes, lam, mu, K.starts, K.columns)
    with pytest.raises(ValueError, match="one row a tet"):
        _core.element_matrices(2, mesh.gradients, mesh.volumes, lam[:-1], mu)
    with pytest.raises(ValueError, match="2\\^31"):
        _core.pattern(net.of_tet, 2**31)


def test_an_empty_row_has_no_forces() -> None:
    K = BlockMatrix(np.zeros(3, np.int64), np.zeros(0, np.int32), np.zeros((0, 3, 3)))
    assert (K @ np.ones((2, 3)) == 0).all()
