# SPDX-License-Identifier: BSD-3-Clause
"""The direct solver: a sparse factorisation, refined until rounding stops it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.sparse import csc_array, diags_array

from bezsoma.arrays import Floats, Ints
from bezsoma.equations.assembled import BlockMatrix
from bezsoma.equations.displacement import Equations
from bezsoma.errors import InputError
from bezsoma.solvers.factors import Waiting, factored
from bezsoma.solvers.krylov import Report, length

DIRECT_UP_TO = 3000
"""Unknowns up to which the direct solver is chosen, in every form: it answers to rounding in a part
of a second, whatever nu and the tets are. Above, iterations are far ahead."""
REFINEMENTS = 10
LARGEST = 2**31 - 1
"""SuperLU counts entries in 32 bits."""


def direct(
    equations: Equations,
    matrix: BlockMatrix,
    b: Floats,
    report: Report | None = None,
    waiting: Waiting | None = None,
) -> tuple[Floats, list[float]]:
    """The free displacement x (c, 3) with K x = b, and the relative residual of each refinement.

    The free part is scaled to a unit diagonal, S K S with S = diag(K)^-1/2, and factored by
    SuperLU with the order of K + K^T (minimum degree) and pivots on the diagonal, which a
    positive definite matrix allows. Then x is refined, x + S (S K S)^-1 S (b - K x), for as long as
    that halves the residual at least; the better of the last two is taken. Ctrl-C is heard while
    SuperLU factors: see `factored`, which says what `waiting` is.
    """
    free = np.flatnonzero(~equations.held.ravel())
    solve = _solver(matrix, free, waiting)
    whole = length(b)
    x, r, history = np.zeros_like(b), b, [1.0]
    for step in range(1, REFINEMENTS + 1):
        better = x.copy()
        better.ravel()[free] += solve(r.ravel()[free])
        left = b - equations.free_product(better)
        size = length(left) / whole
        if not size < history[-1]:
            break
        stagnates = size > history[-1] / 2
        x, r = better, left
        history.append(size)
        if report:
            report(step, size)
        if stagnates or size == 0:
            break
    return x, history


def _solver(matrix: BlockMatrix, free: Ints, waiting: Waiting | None) -> Callable[[Floats], Floats]:
    if matrix.blocks.size > LARGEST:
        raise InputError(
            f"the matrix has {matrix.blocks.size} entries, more than the direct solver can count "
            f"({LARGEST}); use solver='multigrid'"
        )
    scale = 1 / np.sqrt(matrix.diagonal.ravel()[free])
    part = matrix.scipy().tocsr()[free][:, free]
    S = diags_array(scale)
    try:
        solve = factored(
            csc_array(S @ part @ S),
            waiting,
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
    except MemoryError as full:
        raise InputError(
            f"the factors of {len(free)} unknowns are more than the direct solver can hold or "
            "count; use solver='multigrid'"
        ) from full
    return lambda r: scale * solve(scale * r)
