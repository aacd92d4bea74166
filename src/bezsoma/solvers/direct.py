# SPDX-License-Identifier: BSD-3-Clause
"""The direct solver: a sparse factorisation, refined until rounding stops it."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from scipy.sparse import csc_array, diags_array

from bezsoma.arrays import Floats, Ints
from bezsoma.equations.assembled import BlockMatrix
from bezsoma.equations.displacement import Equations
from bezsoma.errors import InputError, NotConverged
from bezsoma.solvers.factors import Waiting, factored
from bezsoma.solvers.krylov import Report, length

DIRECT_UP_TO = 3000
"""Unknowns of a body that is factored where iterations do not come through, in every form: in a
part of a second, whatever nu and the tets are. Iterations that do are quicker at any size."""
REFINEMENTS = 10
LARGEST = 2**31 - 1
"""SuperLU counts entries in 32 bits."""


def may_be_factored(solver: str, free: int) -> bool:
    """Whether a body of so many unknowns is factored where iterations do not come through.

    >>> may_be_factored("auto", 3000), may_be_factored("auto", 3001)
    (True, False)
    """
    return solver == "auto" and free <= DIRECT_UP_TO


def iterations_before(free: int, degree: int) -> int:
    """How many iterations a small body gets before it is factored: about what the factors cost.

    So little more than twice the least is ever spent, as by who rents skis until he has paid their
    price. Factors of n unknowns cost about sqrt(n) as much as an iteration, more at high degree:
    the numbers are from benchmarks/choice.py.

    >>> iterations_before(2500, 2)
    1000
    """
    return int(10 * degree * math.sqrt(free))


def why_iterated(solver: str) -> str:
    """Why iterations were taken, for the summary."""
    return "the quickest way that comes through" if solver == "auto" else "as asked for"


def why_factored(stopped: NotConverged, free: int) -> str:
    """Why they were given up, for the summary."""
    return (
        f"since {len(stopped.history) - 1} iterations left {stopped.history[-1]:.1e} of the "
        f"residual and {free} unknowns are few"
    )


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
