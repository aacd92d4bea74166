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
from bezsoma.errors import NotConverged, counted
from bezsoma.solvers.factors import Waiting, factored, too_large
from bezsoma.solvers.krylov import Report, length

DIRECT_UP_TO = 3000
"""Free unknowns of a small body, one that is factored in a second or so (some at high degree),
whatever nu and the tets are: a linear one where iterations do not come through soon, one of another
law or under a pressure that follows always."""
REFINEMENTS = 10


def before_factoring(solver: str, free: int, degree: int) -> int | None:
    """How many iterations a linear body gets before it is factored; None where it never is.

    A third to two thirds of what the factors of a displacement cost, and little beside those of
    both equations (docs/theory/solvers.md). What needs more is badly conditioned: a residual of
    1e-8 says less and less of the displacement there, and factors give more digits.

    >>> before_factoring("auto", 2500, 2), before_factoring("auto", 3001, 2)
    (500, None)
    """
    small = solver == "auto" and free <= DIRECT_UP_TO
    return int(5 * degree * math.sqrt(free)) if small else None


def why_iterated(solver: str) -> str:
    """Why iterations were taken, for the summary."""
    return "since that is quickest" if solver == "auto" else "as asked for"


def why_factored(stopped: NotConverged, few: int, free: int) -> str:
    """Why they were given up, for the summary: all were done, or rounding had the upper hand."""
    done, left = len(stopped.history) - 1, f"{stopped.history[-1]:.1e} of the residual"
    what = f"{counted(done, 'iteration')} left {left}"
    if done < few:
        what = f"iterations came no farther than {left}"
    return f"since {what} and {free} unknowns are few"


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
    try:
        return _refined(equations, free, _solver(matrix, free, waiting), b, report)
    except MemoryError as full:
        raise too_large(len(free), "multigrid") from full


def _refined(
    equations: Equations,
    free: Ints,
    solve: Callable[[Floats], Floats],
    b: Floats,
    report: Report | None,
) -> tuple[Floats, list[float]]:
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
    except RuntimeError as singular:
        raise NotConverged(
            f"the matrix of {len(free)} unknowns is singular to rounding ({singular}): look for "
            "tets that are almost flat, nu very close to 1/2 (which Body(..., "
            "incompressible=True) is for), and materials of very unequal stiffness",
            [1.0],
        ) from singular
    return lambda r: scale * solve(scale * r)
