# SPDX-License-Identifier: BSD-3-Clause
"""The tangent of any law as a sparse matrix: for direct solves and small problems."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.sparse import coo_array, csr_array

from bezsoma.arrays import Floats, Ints
from bezsoma.equations.pointwise import Pointwise
from bezsoma.mechanics.laws import Law

AT_ONCE = 1 << 22


def tangent_matrix(pointwise: Pointwise, u: Floats) -> csr_array[Any]:
    """The derivative (3c, 3c) N/mm of the internal forces at u (c, 3) mm, index 3c + k.

        K_ai,bk = sum_q w_q V dP_ij/dH_kl dB_a/dx_j dB_b/dx_l

    (paper, eq. 47, with the true tangent); nine directions a point, by the law's own derivative.
    It is what `Pointwise.tangent` applies:

    >>> from bezsoma.mechanics.materials import LinearElastic
    >>> from bezsoma.mesh.control_net import ControlNet
    >>> from bezsoma.mesh.solids import block
    >>> net = ControlNet(block(cells=1), 2)
    >>> forces = Pointwise(net, (LinearElastic(E=2.5, nu=0.25),), 2)
    >>> u = np.sin(7 * net.points)
    >>> K = tangent_matrix(forces, u)
    >>> bool(np.allclose(K @ u.ravel(), forces.tangent(u).apply(u).ravel(), rtol=1e-13))
    True
    """
    net = pointwise.net
    size = 3 * net.count
    total: csr_array[Any] = csr_array((size, size))
    entries = (3 * net.of_tet.shape[1]) ** 2 + 36 * len(pointwise.rule[1]) * net.of_tet.shape[1]
    most = max(1, AT_ONCE // entries)
    for law, run in pointwise.runs():
        for start in range(0, len(run), most):
            tets = run[start : start + most]
            K = element_tangents(pointwise, law, u, tets)
            rows = (3 * net.of_tet[tets][:, :, None] + np.arange(3)).reshape(len(tets), -1)
            wide = rows.shape[1]
            at = (np.repeat(rows, wide, axis=1).ravel(), np.tile(rows, (1, wide)).ravel())
            total = total + csr_array(coo_array((K.ravel(), at), shape=(size, size)))
    return total


def element_tangents(pointwise: Pointwise, law: Law, u: Floats, tets: Ints) -> Floats:
    """The tangents (t, 3m, 3m) N/mm of some tets at u (c, 3); row 3a + i."""
    partials, weights = pointwise.rule
    mesh = pointwise.net.mesh
    H = pointwise.gradients(u, tets)
    G = partials @ mesh.gradients[tets][:, None]
    t, q, m, _ = G.shape
    scale = weights[:, None, None] * mesh.volumes[tets][:, None, None, None]
    K = np.empty((t, m, 3, m, 3))
    for k in range(3):
        moved = np.empty((t, q, m, 3, 3))
        for direction in range(3):
            unit = np.zeros((3, 3))
            unit[k, direction] = 1
            C = law.derivative(H, np.broadcast_to(unit, H.shape)) * scale
            moved[..., direction] = G @ np.swapaxes(C, 2, 3)
        left = np.moveaxis(moved, (2, 3, 1, 4), (1, 2, 3, 4)).reshape(t, 3 * m, 3 * q)
        right = np.swapaxes(G, 2, 3).reshape(t, 3 * q, m)
        K[..., k] = (left @ right).reshape(t, m, 3, m)
    return K.reshape(t, 3 * m, 3 * m)
