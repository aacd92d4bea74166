# SPDX-License-Identifier: BSD-3-Clause
"""Linear solves with the tangent of a displacement form: factored, or applied without a matrix."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.sparse import csc_array, csr_array, diags_array

from bezsoma.arrays import Bools, Floats, Ints, Numbers
from bezsoma.equations.nonlinear import NonlinearEquations
from bezsoma.equations.pointwise import Pointwise, Tangent
from bezsoma.equations.tangent_matrix import tangent_matrix
from bezsoma.errors import NotConverged
from bezsoma.solvers.bicgstab import stabilised
from bezsoma.solvers.factors import Waiting, factored, too_large
from bezsoma.solvers.gmres import minimal_residual
from bezsoma.solvers.kept import Kept
from bezsoma.solvers.krylov import conjugate_gradients
from bezsoma.solvers.newton import Breakdown, Correction, Linearised

MOST_ITERATIONS = 800


@dataclass(frozen=True, eq=False)
class Factored:
    """A tangent matrix (n, n), factored by SuperLU when it is first solved with."""

    matrix: csr_array[Any]
    free: Ints
    scale: Floats | None = None
    """What takes the units off unknowns of different kinds (n,), so that pivots compare."""
    waiting: Waiting | None = None
    """Who hears of a long factorisation."""

    def product(self, dx: Floats) -> Floats:
        """K dx (n,)."""
        return np.asarray(self.matrix @ dx)

    def solve(self, b: Floats, rtol: float) -> Correction:
        """The free dx (n,) with K dx = b, refined once; `rtol` is met whatever it is."""
        if not np.isfinite(self.matrix.data).all():
            raise Breakdown("the tangent leaves the range of numbers")
        scale = np.ones(len(b)) if self.scale is None else self.scale
        S = diags_array(scale[self.free])
        part = csc_array(S @ self.matrix[self.free][:, self.free] @ S)
        dx = np.zeros_like(b)
        right = (scale * b)[self.free]
        try:
            solve = factored(part, self.waiting)
            dx[self.free] = solve(right)
            dx[self.free] += solve(right - part @ dx[self.free])
        except RuntimeError as singular:
            raise Breakdown(
                "the tangent is singular: the body has a motion that nothing resists, as where it "
                "buckles or its law loses ellipticity"
            ) from singular
        except MemoryError as full:
            raise too_large(len(self.free), "multigrid") from full
        if not np.isfinite(dx).all():
            raise Breakdown("the tangent is singular to rounding")
        return Correction(scale * dx, 1)


@dataclass(frozen=True, eq=False)
class Applied:
    """A tangent that is only applied, and the preconditioner of a linear law that it is near."""

    tangent: Tangent
    follow: csr_array[Any] | None
    held: Bools
    precondition: Kept
    symmetric: bool

    def product(self, dx: Floats) -> Floats:
        """K dx (n,)."""
        out = self.tangent.apply(dx.reshape(-1, 3)).ravel()
        if self.follow is not None:
            out -= self.follow @ dx
        return out

    def solve(self, b: Floats, rtol: float) -> Correction:
        """The free dx (n,), by conjugate gradients or, not symmetric, by BiCGStab.

        GMRES takes over where these do not come through: where a symmetric tangent is not positive,
        as beyond buckling, and where BiCGStab stands still.
        """
        size = float(np.abs(b).max())
        if size == 0:
            return Correction(np.zeros_like(b), 0)
        scaled = (b / size).reshape(-1, 3)
        try:
            x, count, event = self._solved(scaled, rtol)
        except NotConverged as failure:
            self.precondition.failed()
            raise Breakdown(str(failure)) from failure
        self.precondition.learn(count, rtol)
        return Correction(x.ravel() * size, count, event)

    def _solved(self, b: Floats, rtol: float) -> Correction:
        single = self.tangent.rough
        apply = self._free_product
        rough = None if single is None else lambda x: self._freed(single(x), x)
        how = (self.precondition, b, rtol, MOST_ITERATIONS)
        try:
            if not self.symmetric:
                return Correction(*stabilised(apply, *how, rough))
            x, history = conjugate_gradients(apply, *how, rough=rough)
            return Correction(x, len(history) - 1)
        except NotConverged as failure:
            first = "conjugate gradients" if self.symmetric else "BiCGStab"
            event = f"GMRES solved where {first} did not: {failure}"
        flat, count = minimal_residual(
            lambda v: self._free_product(v.reshape(-1, 3)).ravel(),
            lambda r: self.precondition(r.reshape(-1, 3)).ravel(),
            b.ravel(),
            rtol,
            MOST_ITERATIONS,
        )
        return Correction(flat.reshape(-1, 3), count, event)

    def _free_product(self, x: Floats) -> Floats:
        return self._freed(self.tangent.apply(x), x)

    def _freed(self, f: Numbers, x: Numbers) -> Numbers:
        if self.follow is not None:
            f -= (self.follow @ x.ravel()).reshape(-1, 3)
        f[self.held] = 0.0
        return f


def factored_tangents(
    equations: NonlinearEquations, pointwise: Pointwise, waiting: Waiting | None = None
) -> Callable[[Floats, float], Linearised]:
    """What gives the tangent at x (n,) and a fraction of the load, as a matrix."""
    free = np.flatnonzero(~equations.held.ravel())

    def at(x: Floats, fraction: float) -> Factored:
        u = x.reshape(-1, 3)
        with np.errstate(over="ignore", invalid="ignore"):  # `Factored` says so
            matrix, follow = tangent_matrix(pointwise, u), equations.follow(u, fraction)
        if follow is not None:
            matrix = csr_array(matrix - follow)
        return Factored(matrix, free, waiting=waiting)

    return at


def applied_tangents(
    equations: NonlinearEquations,
    tangent: Callable[[Floats], Tangent],
    precondition: Kept,
    symmetric: bool,
) -> Callable[[Floats, float], Linearised]:
    """What gives the tangent at x (n,) and a fraction of the load, without a matrix."""

    def at(x: Floats, fraction: float) -> Applied:
        u = x.reshape(-1, 3)
        precondition.at(x)
        follow = equations.follow(u, fraction)
        return Applied(tangent(u), follow, equations.held, precondition, symmetric)

    return at
