# SPDX-License-Identifier: BSD-3-Clause
"""Conjugate gradients, and the incomplete Cholesky factorisation that preconditions them.

The paper's own iterative way to solve (section 3.3), with what it leaves open: K is no M-matrix,
least of all at high degree, so that a factorisation without fill can break down.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from bezsoma import _core
from bezsoma.arrays import Bools, Floats, Ints, Numbers
from bezsoma.equations.assembled import BlockMatrix
from bezsoma.errors import NotConverged

FIRST_SHIFT = 1e-3
"""The shift that is tried first where IC(0) breaks down without one; then it is doubled."""
LEAST_PIVOT = 1e-6
"""A pivot below this part of its entry of diag(K) counts as breakdown."""
LARGEST_SHIFT = 1e3
MOST_ITERATIONS = 5000
RESTARTS = 3
WORTH = 1e-2
"""What is left of a residual where a larger rtol may give an answer that is worth something."""
ROUGH = 1e-4
"""How far the residual is followed by rough products before it is formed anew."""

AT_ONCE = 4096
"""Numbers in float32 that are summed up in it: fewer than would show in the sum."""

Operator = Callable[[Floats], Floats]
Rough = Callable[[Any], Any]
"""An operator on float32, right to six digits or so."""
Report = Callable[[int, float], None]
"""Called with the number of the iteration and its relative residual."""


@dataclass(frozen=True, eq=False)
class IncompleteCholesky:
    """L with L L^T ~ K + shift diag(K) on the free part, no block where K has none.

    `below` (l, 3, 3) are the blocks under the diagonal, of rows `starts` (c + 1,) and `columns`
    (l,); `inverse` (c, 3, 3) the inverses of those on it. Rows of what is held are those of the
    identity. `tried` are all shifts, the last of which is `shift`.
    """

    starts: Ints
    columns: npt.NDArray[np.int32]
    below: Floats
    inverse: Floats
    tried: tuple[float, ...]

    @property
    def shift(self) -> float:
        """The shift, in parts of the diagonal."""
        return self.tried[-1]

    def __call__(self, r: Floats) -> Floats:
        """(L L^T)^-1 r (c, 3)."""
        z = np.empty(r.shape)
        _core.solve_cholesky(self.starts, self.columns, self.below, self.inverse, r, z)
        return z


def incomplete_cholesky(
    matrix: BlockMatrix, held: Bools, least: float = LEAST_PIVOT
) -> IncompleteCholesky:
    """The factor of the free part of a matrix; held (c, 3) says which components are prescribed.

    Where a pivot is not positive the diagonal is raised (T. A. Manteuffel, Math. Comp. 34, 1980,
    doi:10.1090/S0025-5718-1980-0559197-0), by `FIRST_SHIFT` of itself and twice as much each
    time. Where every two controls meet in a tet nothing is left out, and it is exact:

    >>> from bezsoma.equations.assembled import assembled
    >>> from bezsoma.mesh.control_net import ControlNet
    >>> from bezsoma.mesh.tets import TetMesh
    >>> net = ControlNet(TetMesh(np.eye(4, 3), [[0, 1, 2, 3]]), 2)
    >>> held = np.zeros((10, 3), bool)
    >>> held[net.of_facets(net.mesh.tets[:, :3])] = True
    >>> K = assembled(net, np.ones(1), np.ones(1))
    >>> u = np.where(held, 0.0, net.points)
    >>> f = np.where(held, 0.0, K @ u)
    >>> bool(np.allclose(incomplete_cholesky(K, held)(f), u, atol=1e-14))
    True
    """
    tried: list[float] = []
    shift = 0.0
    while shift < LARGEST_SHIFT:
        tried.append(shift)
        starts, columns, below, inverse, broken = _core.incomplete_cholesky(
            matrix.starts, matrix.columns, matrix.blocks, held, shift, least
        )
        if broken < 0:
            return IncompleteCholesky(starts, columns, below, inverse, tuple(tried))
        shift = 2 * shift if shift else FIRST_SHIFT
    raise NotConverged(
        f"the incomplete Cholesky factorisation breaks down at control {broken} even with its "
        f"diagonal raised {tried[-1]:g} times: the matrix is not positive definite there; look "
        "for tets that are almost flat, or try solver='direct'"
    )


def dot(x: Numbers, y: Numbers) -> float:
    """The sum of products of (c, 3) and (c, 3), of float32 as exact as they are.

    Not by a BLAS: its threads would show in the last bits of the answer, and stall on a machine
    that is busy with something else.
    """
    if x.dtype != np.float32:
        return float(np.einsum("ck,ck->", x, y))
    x, y = x.ravel(), y.ravel()
    whole = len(x) - len(x) % AT_ONCE
    rows = [each[:whole].reshape(-1, AT_ONCE) for each in (x, y)]
    parts = np.einsum("pk,pk->p", *rows)
    rest = np.einsum("k,k->", *(each[whole:].astype(np.float64) for each in (x, y)))
    return float(parts.sum(dtype=np.float64) + rest)


def length(x: Numbers) -> float:
    """The Euclidean norm of (c, 3)."""
    return math.sqrt(dot(x, x))


def corrected(
    way: Callable[[Numbers, Numbers, float], Any], x: Floats, r: Floats, whole: float
) -> Any:
    """Adds to x what `way(dx, r, whole)` finds for the residual r in float32; gives its answer.

    As a linear system is refined: r is scaled to norm one and rounded, with what it is measured by.
    """
    size = length(r) or 1.0
    small = np.divide(r, size, dtype=np.float32, casting="same_kind")
    dx = np.zeros_like(small)
    found = way(dx, small, whole / size)
    x += np.multiply(dx, size, dtype=np.float64)
    return found


def conjugate_gradients(
    apply: Operator,
    precondition: Operator,
    b: Floats,
    rtol: float,
    most: int = MOST_ITERATIONS,
    report: Report | None = None,
    start: Floats | None = None,
    rough: Rough | None = None,
) -> tuple[Floats, list[float]]:
    """x with |b - A x| <= rtol |b|, and |r| / |b| after each iteration, the first before any.

    From `start`, or from zero. |b| is the residual at zero in either case.

    M. R. Hestenes and E. Stiefel, J. Res. NBS 49 (1952), doi:10.6028/jres.049.044. The residual
    that the recursion carries drifts from the true one by rounding, so the true one decides: where
    it has not come down with it the iteration starts anew from there, `RESTARTS` times at most.

    `rough` applies A in float32. Then the recursion has all its vectors in float32, and is believed
    until the residual has come down to `ROUGH` of itself; `apply` gives the true residual: as a
    linear system is refined, so that x is as good as without. It takes half the memory and time.
    """
    whole = length(b)
    x, r = (np.zeros_like(b), b.copy()) if start is None else (start.copy(), b - apply(start))
    history = [length(r) / whole]
    runs = RESTARTS + 1 + (math.ceil(math.log(rtol) / math.log(ROUGH)) if rough else 0)
    for _ in range(runs):
        goal = max(rtol, ROUGH * history[-1]) if rough else rtol
        if rough:

            def run(dx: Numbers, left: Numbers, size: float, goal: float = goal) -> None:
                _iterate(rough, precondition, dx, left, size, goal, most, history, report)

            corrected(run, x, r, whole)
            del r
        else:
            _iterate(apply, precondition, x, r, whole, goal, most, history, report)
        r = b - apply(x)
        before, history[-1] = history[-1], length(r) / whole
        if history[-1] <= rtol:
            return x, history
    raise NotConverged(
        f"the residual of conjugate gradients stays at {history[-1]:.3g} of that at zero free "
        f"displacement (the recursion believed {before:.3g}): rounding does not let it fall to "
        f"rtol = {rtol:g}. A larger rtol will do; solver='direct' goes further on small problems",
        history,
    )


def _iterate(
    apply: Rough,
    precondition: Rough,
    x: Numbers,
    r: Numbers,
    whole: float,
    rtol: float,
    most: int,
    history: list[float],
    report: Report | None,
) -> None:
    """Iterate from x with residual r, both changed in place, until |r| <= rtol * whole."""
    p, part, before = np.zeros_like(x), np.empty_like(x), np.inf
    while history[-1] > rtol:
        if len(history) > most:
            raise NotConverged(_slow(history, rtol, most), history)
        z = precondition(r)
        now = dot(r, z)
        p *= now / before
        p += z
        q = apply(p)
        curvature = dot(p, q)
        if not (curvature > 0 and now > 0):
            raise NotConverged(_indefinite(history), history)
        x += np.multiply(p, now / curvature, out=part)
        r -= np.multiply(q, now / curvature, out=part)
        del z, q  # or they would stand beside the next
        before = now
        history.append(length(r) / whole)
        if report:
            report(len(history) - 1, history[-1])


def larger_rtol(left: float) -> str:
    """The end of advice: it helps where little of the residual is left, not where much is."""
    return "; a larger rtol serves too" if left < WORTH else ""


def _slow(history: list[float], rtol: float, most: int) -> str:
    return (
        f"conjugate gradients stand at {history[-1]:.3g} of the residual at zero free displacement "
        f"after {most} iterations; rtol = {rtol:g} was asked for. Very flat tets, nu close to 1/2 "
        "or very unequal materials slow them down: take incompressible=True close to 1/2, a lower "
        f"degree, or solver='direct'{larger_rtol(history[-1])}"
    )


def _indefinite(history: list[float]) -> str:
    return (
        f"conjugate gradients met a direction without positive energy in iteration {len(history)}, "
        f"at a relative residual of {history[-1]:.3g}: rounding has the upper hand. Look for tets "
        "that are almost flat and for nu very close to 1/2 (which Body(..., incompressible=True) "
        "is for), or try solver='direct'"
    )
