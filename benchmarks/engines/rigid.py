# SPDX-License-Identifier: BSD-3-Clause
"""PyAMG with the rigid-body modes, for matrices that other engines assembled."""

from __future__ import annotations

from typing import Any

import numpy as np
import pyamg
import scipy.sparse as sp

Array = np.ndarray[Any, Any]


def modes(places: Array) -> Array:
    """Translations and rotations of points (p, 3), as columns (3 p, 6), components interleaved."""
    moved = np.zeros((len(places), 3, 6))
    moved[:, range(3), range(3)] = 1
    for column, (i, j) in enumerate(((0, 1), (1, 2), (2, 0)), start=3):
        moved[:, i, column] = -places[:, j]
        moved[:, j, column] = places[:, i]
    return moved.reshape(-1, 6)


def multigrid(matrix: sp.csr_matrix, places: Array) -> Any:
    """Smoothed aggregation on a matrix (3 p, 3 p), components interleaved."""
    blocks = sp.bsr_matrix(matrix, blocksize=(3, 3))
    return pyamg.smoothed_aggregation_solver(
        blocks, B=modes(places), strength=("symmetric", {"theta": 0.08}), max_coarse=300
    )


def conjugate_gradients(hierarchy: Any, b: Array, tolerance: float) -> tuple[Array, int]:
    """x and iterations."""
    history: list[float] = []
    x = hierarchy.solve(b, tol=tolerance, accel="cg", residuals=history, maxiter=1000)
    return x, len(history) - 1
