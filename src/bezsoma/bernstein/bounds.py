# SPDX-License-Identifier: BSD-3-Clause
"""The least and the largest value of a polynomial on its simplex, from its controls.

Inside the simplex the B_alpha are positive and sum to one, so the values lie between the least
and the largest control, for free.  At its vertices the polynomial *takes* the controls, so the
largest value lies between the largest control at a vertex and the largest of all.  Subdivision
brings the two together quadratically; docs/theory/subdivision.md has the proof.
"""

from __future__ import annotations

import numpy as np

from bezsoma.arrays import Floats
from bezsoma.bernstein.indices import count
from bezsoma.bernstein.nets import restriction, trace
from bezsoma.bernstein.subdivision import uniform_children
from bezsoma.errors import InputError

FINEST = 1e-12
"""The least tolerance, relative to the largest control: below it stands rounding."""
_PORTION = 1 << 20
"""Numbers in the nets that are subdivided together."""
_MOST = 1 << 24
"""Numbers in the nets that may be open at once."""


def bounds(
    nets: Floats, degree: int, dim: int, tolerance: float | None = None
) -> tuple[Floats, Floats]:
    """A lower and an upper bound (q, ..) of each of q polynomials (q, m, ..) on its simplex.

    Without a tolerance these are the extreme controls.  With one, simplices are subdivided until
    the bounds are that close to the true extremes; only those children that may hold the extreme
    are looked at again.  Up to rounding the bounds always hold.  Beware: around an extreme in a
    point there are few such children at each level; along a whole plane of extremes they become
    four times as many, and a tolerance that would need too many is refused.

    >>> net = np.array([[0.0, 1.0, 0.0]])                       # 2 t (1 - t), at most 1/2
    >>> bounds(net, 2, 1)[1].tolist(), bounds(net, 2, 1, tolerance=1e-3)[1].tolist()
    ([1.0], [0.5])
    """
    low, high = (np.ascontiguousarray(end(nets, axis=1)) for end in (np.min, np.max))
    if tolerance is None or dim == 0:  # a single control is the value itself
        return low, high
    least = FINEST * float(np.abs(nets).max(initial=0.0))
    if not tolerance > 0 or tolerance < least:
        raise InputError(
            f"bounds to {tolerance} were asked for; numbers as large as these controls allow "
            f"{least:.1e} at best: give a larger tolerance, or None for the controls' own bounds"
        )
    flat = np.moveaxis(nets, 1, -1).reshape(-1, count(degree, dim))
    step = max(1, _PORTION // (flat.shape[1] << dim))
    for start in range(0, len(flat), step):
        part = slice(start, start + step)
        low.reshape(-1)[part] = -_tops(-flat[part], degree, dim, tolerance)
        high.reshape(-1)[part] = _tops(flat[part], degree, dim, tolerance)
    return low, high


def _tops(nets: Floats, degree: int, dim: int, tolerance: float) -> Floats:
    """Upper bounds (s,) of scalar polynomials (s, m), within the tolerance of the true maximum.

    `taken` is the largest value seen at a corner. A child whose controls stay below it plus the
    tolerance is laid aside; the largest control of all that were laid aside is the bound.
    """
    vertices = np.array([trace(degree, dim, (i,))[0] for i in range(dim + 1)])
    halves = np.concatenate([restriction(degree, dim, child) for child in uniform_children(dim)])
    taken, found = nets[:, vertices].max(axis=1), nets.max(axis=1)
    owner = np.flatnonzero(found > taken + tolerance)
    found[owner] = -np.inf
    nets = nets[owner]
    while len(owner):
        if nets.size << dim > _MOST:
            raise InputError(
                f"bounds to {tolerance:.3g} were asked for, and {len(owner)} simplices may still "
                "hold the extreme: it is taken along a line or a surface; give a larger tolerance"
            )
        nets = (nets @ halves.T).reshape(-1, nets.shape[1])
        owner = np.repeat(owner, 1 << dim)
        np.maximum.at(taken, owner, nets[:, vertices].max(axis=1))
        above = nets.max(axis=1)
        open_ = above > taken[owner] + tolerance
        np.maximum.at(found, owner[~open_], above[~open_])
        nets, owner = nets[open_], owner[open_]
    return np.asarray(found)
