# SPDX-License-Identifier: BSD-3-Clause
"""How finely each edge and each facet of a surface is cut for its triangles to be near enough."""

from __future__ import annotations

import numpy as np

from bezsoma.arrays import Bools, Ints
from bezsoma.errors import InputError
from bezsoma.mesh.topology import packed
from bezsoma.view.chords import Bends, lattice_error, strip_error, triangles_error
from bezsoma.view.cuts import LEAST_INSIDE, STEPS, nip_corners, strip_corners
from bezsoma.view.lattice import ROUND, SIDES


def edge_parts(bent: Bends, tolerance: float) -> Ints:
    """Into how many parts (f, 3) the edges are cut, each by its own controls.

    A chord over 1/s of an edge is off by at most M / (8 s^2). Half the tolerance is spent here: of
    the shares tried it makes the fewest triangles, as most facets are then as fine as their edges.
    """
    wanted = np.sqrt(bent.whole.rim / (4 * tolerance))
    refuse_too_fine(float(wanted.max(initial=0.0)), tolerance)
    return np.asarray(np.array(STEPS)[np.searchsorted(STEPS, wanted)])


def insides(
    bent: Bends, parts: Ints, tolerance: float, least: Ints | int = 1
) -> tuple[Ints, Bools]:
    """The lattice inside each facet (f,), the coarsest for which all its triangles are near.

    It has at least so many parts (f,). And which of its corners are nipped (f, 3): those where that
    is near enough. 0 where none is: an edge that is straight, beside an inside that is bent a great
    deal.
    """
    whole = lattice_error(bent)
    even = (parts == parts[:, :1]).all(axis=1) & (whole <= tolerance * parts[:, 0] ** 2)
    even &= least <= parts[:, 0]
    inside, nipped = np.where(even, parts[:, 0], 0), np.zeros(parts.shape, np.bool_)
    for step in (step for step in STEPS if step >= LEAST_INSIDE):
        fine = (least <= step) & (whole <= tolerance * step**2)
        left = np.flatnonzero((inside == 0) & fine)
        corners, near = _near(bent.of(left), parts[left], step, tolerance)
        inside[left[near]], nipped[left[near]] = step, corners[near]
    return inside, nipped


def _near(bent: Bends, parts: Ints, inside: int, tolerance: float) -> tuple[Bools, Bools]:
    """Which corners (f, 3) to nip, and for which facets (f,) all triangles along edges are near."""
    corners = np.zeros(parts.shape, np.bool_)
    for corner in range(3):
        j, k = (corner + 1) % 3, (corner + 2) % 3
        sides = parts[:, [_side(corner, j), _side(corner, k)]]
        sides[(sides.min(axis=1) < 2) | (sides.sum(axis=1) <= inside)] = 0
        for (one, other), mine in kinds(sides):
            if one:
                small = nip_corners((one, other), inside, corner)
                corners[mine, corner] = triangles_error(bent.of(mine), small) <= tolerance
    near = np.ones(len(parts), np.bool_)
    for edge, (i, j) in enumerate(ROUND):
        for (count, first, last), mine in kinds(
            np.column_stack([parts[:, edge], corners[:, [i, j]]])
        ):
            small = strip_corners(count, inside, edge, (bool(first), bool(last)))
            if len(small):
                error = strip_error(bent.of(mine), edge, 1 / inside, small)
                near[mine] &= error <= tolerance
    return corners, near


def _side(i: int, j: int) -> int:
    return SIDES.index((min(i, j), max(i, j)))


def kinds(rows: Ints) -> list[tuple[list[int], Ints]]:
    """The distinct rows (f, k) of small numbers, and where each stands."""
    keys = packed(rows, STEPS[-1] + 1)
    order = np.argsort(keys, kind="stable")
    groups = np.split(order, np.flatnonzero(np.diff(keys[order])) + 1)
    return [(rows[group[0]].tolist(), group) for group in groups if len(group)]


def refuse_too_fine(parts: float, tolerance: float) -> None:
    """Refuses what would need edges cut in more parts than there are patterns for."""
    if not parts <= STEPS[-1]:
        least = tolerance * (parts / STEPS[-1]) ** 2
        raise InputError(
            f"a tolerance of {tolerance:.3g} mm would cut edges in {parts:.0f} parts, and "
            f"{STEPS[-1]} is the most; give {least:.2g} mm or more, or subdivide the field first"
        )
