# SPDX-License-Identifier: BSD-3-Clause
"""BiCGStab, for tangents that are not symmetric or not positive."""

from __future__ import annotations

import math

import numpy as np

from bezsoma.arrays import Floats, Numbers
from bezsoma.errors import NotConverged
from bezsoma.solvers.krylov import ROUGH, Operator, Rough, corrected, dot, length

RESTARTS = 10


def stabilised(
    apply: Operator,
    precondition: Operator,
    b: Floats,
    rtol: float,
    most: int,
    rough: Rough | None = None,
) -> tuple[Floats, int]:
    """x with |b - A x| <= rtol |b|, and how many times A was applied, two an iteration.

    H. A. van der Vorst, SIAM J. Sci. Stat. Comput. 13 (1992), doi:10.1137/0913035, preconditioned
    from the right, so that the residual is the true one. Where the shadow residual has turned
    orthogonal the iteration starts anew. Two vectors more than conjugate gradients keep. `rough`
    serves as it does there: see `conjugate_gradients`.

    >>> A = np.array([[4.0, 1, 0], [-1, 3, 1], [0, -2, 5]])
    >>> x, _ = stabilised(lambda x: A @ x, lambda r: r / 4, np.ones((3, 1)), 1e-14, 50)
    >>> bool(np.allclose(A @ x, 1, rtol=1e-13))
    True
    """
    whole = length(b)
    x, r = np.zeros_like(b), b.copy()
    applied = 0
    for _ in range(RESTARTS):
        left = most - applied
        if rough:

            def run(dx: Numbers, r: Numbers, goal: float, left: int = left) -> int:
                return _run(rough, precondition, dx, r, max(goal, ROUGH), left)

            applied += corrected(run, x, r, rtol * whole)
            del r
        else:
            applied += _run(apply, precondition, x, r, rtol * whole, left)
        r = b - apply(x)
        applied += 1
        size = length(r)
        if size <= rtol * whole:
            return x, applied
        if applied >= most or not np.isfinite(size):
            break
    raise NotConverged(
        f"BiCGStab stands at {length(r) / max(whole, 1e-300):.3g} of the residual after {applied} "
        f"products with the tangent; {rtol:.3g} was asked for"
    )


def _run(
    apply: Rough, precondition: Rough, x: Numbers, r: Numbers, target: float, most: int
) -> int:
    """Iterate from x with residual r, both changed in place; gives the number of products."""
    shadow, p, v, part = r.copy(), np.zeros_like(r), np.zeros_like(r), np.empty_like(r)
    rho, alpha, omega = 1.0, 1.0, 1.0
    for applied in range(0, most, 2):
        before, rho = rho, dot(shadow, r)
        small = abs(rho) < 1e-14 * length(shadow) * length(r)
        if small or omega == 0 or not math.isfinite(rho):  # a law may answer with no numbers
            return applied
        beta = 0.0 if applied == 0 else rho / before * (alpha / omega)
        p -= np.multiply(v, omega, out=part)
        p *= beta
        p += r
        del v  # or it would stand beside the next
        forward = precondition(p)
        v = apply(forward)
        along = dot(shadow, v)
        if along == 0:
            return applied + 1
        alpha = rho / along
        x += np.multiply(forward, alpha, out=part)
        r -= np.multiply(v, alpha, out=part)
        del forward
        if length(r) <= target:
            return applied + 1
        forward = precondition(r)
        t = apply(forward)
        squared = dot(t, t)
        omega = dot(t, r) / squared if squared else 0.0
        x += np.multiply(forward, omega, out=part)
        r -= np.multiply(t, omega, out=part)
        del forward, t
        if length(r) <= target:
            return applied + 2
    return most
