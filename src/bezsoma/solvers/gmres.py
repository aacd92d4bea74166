# SPDX-License-Identifier: BSD-3-Clause
"""GMRES, for tangents that are indefinite, and often not symmetric."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from bezsoma.arrays import Floats
from bezsoma.errors import NotConverged

KEPT = 60
"""Directions kept before a restart."""

Operator = Callable[[Floats], Floats]


def minimal_residual(
    apply: Operator, precondition: Operator, b: Floats, rtol: float, most: int
) -> tuple[Floats, int]:
    """x (n,) with |b - A x| <= rtol |b|, and how many times A was applied.

    Y. Saad and M. H. Schultz, SIAM J. Sci. Stat. Comput. 7 (1986), doi:10.1137/0907058, restarted;
    preconditioned from the right by what may differ from one application to the next (Y. Saad,
    SIAM J. Sci. Comput. 14, 1993, doi:10.1137/0914028).

    >>> A = np.array([[2.0, 1, 1], [1, 3, 0], [1, 0, -1]])
    >>> x, count = minimal_residual(lambda x: A @ x, lambda r: r, np.ones(3), 1e-13, 20)
    >>> bool(np.allclose(A @ x, 1, rtol=1e-12)), count
    (True, 4)
    """
    whole, x, r, applied = _length(b), np.zeros_like(b), b.copy(), 0
    size = whole
    while size > rtol * whole:
        if applied >= most:
            raise NotConverged(
                f"GMRES stands at {size / whole:.3g} of the residual after {applied} products "
                f"with the tangent; {rtol:.3g} was asked for"
            )
        dx, count = _cycle(apply, precondition, r, rtol * whole, min(KEPT, most - applied))
        x += dx
        r = b - apply(x)
        before, size, applied = size, _length(r), applied + count + 1
        if not size < 0.999 * before:
            raise NotConverged(f"GMRES stands still at {size / max(whole, 1e-300):.3g}")
    return x, applied


def _cycle(
    apply: Operator, precondition: Operator, r: Floats, target: float, most: int
) -> tuple[Floats, int]:
    """The correction from a Krylov space of at most so many directions, and how many."""
    size = _length(r)
    basis, forward = np.empty((most + 1, len(r))), np.empty((most, len(r)))
    basis[0] = r / size
    H, right = np.zeros((most + 1, most)), np.zeros(most + 1)
    right[0] = size
    y: Floats = np.zeros(0)
    for j in range(most):
        forward[j] = precondition(basis[j])
        w = apply(forward[j])
        for _ in range(2):  # twice is enough for orthogonality to rounding
            along = np.einsum("in,n->i", basis[: j + 1], w)
            H[: j + 1, j] += along
            w -= np.einsum("i,in->n", along, basis[: j + 1])
        H[j + 1, j] = _length(w)
        if not np.isfinite(H[: j + 2, j]).all():
            raise NotConverged(
                "GMRES met a product with the tangent, or its square, beyond the range of numbers"
            )
        small, b = H[: j + 2, : j + 1], right[: j + 2]
        y = np.asarray(np.linalg.lstsq(small, b, rcond=None)[0], dtype=np.float64)
        if H[j + 1, j] <= 1e-14 * size or np.linalg.norm(b - small @ y) <= target:
            break
        basis[j + 1] = w / H[j + 1, j]
    return np.einsum("i,in->n", y, forward[: len(y)]), len(y)


def _length(x: Floats) -> float:
    return float(np.sqrt(np.einsum("i,i->", x, x)))
