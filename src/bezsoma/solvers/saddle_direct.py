# SPDX-License-Identifier: BSD-3-Clause
"""The direct solver of the mixed form: one sparse factorisation of both equations."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.sparse import block_array, csc_array, diags_array

from bezsoma.arrays import Floats, Ints
from bezsoma.equations.level import without_mean
from bezsoma.equations.mixed import MixedEquations, MixedMatrix
from bezsoma.errors import NotConverged
from bezsoma.solvers.direct import REFINEMENTS
from bezsoma.solvers.factors import Waiting, factored, too_large
from bezsoma.solvers.krylov import Report

PIVOT = 0.1
"""A pivot on the diagonal is taken if it is at least this part of the largest in its column."""


@dataclass(frozen=True, eq=False)
class _Scaled:
    """The free part of the matrix with units taken off it, and how to measure a residual."""

    free: Ints
    kept: Ints
    scale_u: Floats
    scale_p: Floats

    def packed(self, f: Floats, g: Floats) -> Floats:
        """Both residuals as one vector without units."""
        return np.concatenate([self.scale_u * f.ravel()[self.free], self.scale_p * g[self.kept]])

    def add(self, u: Floats, p: Floats, step: Floats) -> tuple[Floats, Floats]:
        """U and p, changed by a step of the unknowns without units."""
        u, p = u.copy(), p.copy()
        u.ravel()[self.free] += self.scale_u * step[: len(self.free)]
        p[self.kept] += self.scale_p * step[len(self.free) :]
        return u, p


def direct_saddle(
    equations: MixedEquations,
    matrix: MixedMatrix,
    report: Report | None = None,
    waiting: Waiting | None = None,
) -> tuple[Floats, Floats, list[float]]:
    """u (c, 3) and p (cp,) with what is prescribed, and the relative residual of each refinement.

    [K B^T; B -M/kappa] is symmetric and indefinite. Each unknown is scaled to a unit diagonal, of
    K for displacements and of B diag(K)^-1 B^T (the Schur complement, roughly) for pressures, so
    that N, mm and MPa compare; SuperLU pivots where the diagonal is too small. Where the level of
    the pressure is not determined one of its controls is left out, and the mean taken off
    afterwards: the equation of that control follows from the others. Refined as `direct` is.
    """
    parts = _scaled(equations, matrix)
    try:
        return _refined(equations, parts, _solver(matrix, parts, waiting), report)
    except MemoryError as full:
        raise too_large(len(parts.free) + len(parts.kept), "saddle") from full


def _refined(
    equations: MixedEquations,
    parts: _Scaled,
    solve: Callable[[Floats], Floats],
    report: Report | None,
) -> tuple[Floats, Floats, list[float]]:
    u, p = equations.given.copy(), np.zeros(equations.pressure_net.count)
    r = parts.packed(*equations.residuals(u, p))
    whole, history = _length(r), [1.0]
    for step in range(1, REFINEMENTS + 1):
        better_u, better_p = parts.add(u, p, solve(r))
        left = parts.packed(*equations.residuals(better_u, better_p))
        size = _length(left) / whole
        if not size < history[-1]:
            break
        stagnates = size > history[-1] / 2
        u, p, r = better_u, better_p, left
        history.append(size)
        if report:
            report(step, size)
        if stagnates or size == 0:
            break
    return u, without_mean(p, equations.modes, equations.pressure_net), history


def _length(x: Floats) -> float:
    """The Euclidean norm, of tiny and huge numbers too, whose squares leave the range."""
    size = float(np.abs(x).max(initial=0.0)) or 1.0
    y = x / size
    return size * float(np.sqrt(np.einsum("i,i->", y, y)))


def _scaled(equations: MixedEquations, matrix: MixedMatrix) -> _Scaled:
    free = np.flatnonzero(~equations.held.ravel())
    stiff = matrix.shear.diagonal.ravel()[free]
    work = matrix.coupling[:, free]
    schur = (work**2) @ (1 / stiff) + matrix.softness.diagonal()
    pinned = [int(np.flatnonzero(mode)[0]) for mode in equations.modes]
    kept = np.setdiff1d(np.arange(len(schur)), pinned)
    schur = np.where(schur > 0, schur, 1.0)[kept]
    return _Scaled(free, kept, 1 / np.sqrt(stiff), 1 / np.sqrt(schur))


def _solver(
    matrix: MixedMatrix, parts: _Scaled, waiting: Waiting | None
) -> Callable[[Floats], Floats]:
    su, sp = diags_array(parts.scale_u), diags_array(parts.scale_p)
    K = su @ matrix.shear.scipy().tocsr()[parts.free][:, parts.free] @ su
    B = sp @ matrix.coupling[parts.kept][:, parts.free] @ su
    M = sp @ matrix.softness[parts.kept][:, parts.kept] @ sp
    whole = csc_array(block_array([[K, B.T], [B, -M]]))
    try:
        return factored(whole, waiting, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=PIVOT)
    except RuntimeError as singular:
        raise NotConverged(
            f"the matrix of {whole.shape[0]} displacements and pressures is singular ({singular}): "
            "some pressure is not determined; look for parts of the mesh with most of their "
            "boundary prescribed, and cut their tets: solve(unlocked(body))"
        ) from singular
