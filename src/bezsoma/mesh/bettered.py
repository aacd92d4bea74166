# SPDX-License-Identifier: BSD-3-Clause
"""Tets with bad angles made better by moving their vertices a little, surfaces kept.

A vertex inside moves anywhere, one on a side of the box stays on it, one on a curved surface comes
back to it. What is made as large as possible is the least sine of the dihedral angles around a
vertex; a move that gains nothing is not made, so no tet gets worse than the worst around it was.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from bezsoma.arrays import Floats, Ints
from bezsoma.mesh.quality import least_sines
from bezsoma.mesh.stuffing import Level, Stuffed

GOOD = 0.42
"""Sine of 25 degrees: tets better than this in all six angles are let be."""
STEPS = (0.3, 0.15, 0.3, 0.08, 0.15, 0.04)
"""How far vertices are tried to be moved, as parts of the edges around; one pass for each."""
WAYS = np.array([
    [x, y, z] for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1) if x or y or z
], float)  # fmt: skip
"""(26, 3) directions in which a vertex is tried to be moved."""
ROUNDS = 60
"""At most so many independent sets of vertices are moved in a pass."""


def bettered(body: Stuffed, level: Level) -> Stuffed:
    """The same tets, their vertices moved where angles were bad; deterministic."""
    points = body.points.copy()
    tets = body.tets * 1
    turned = least_sines(points[tets]) < 0
    tets[turned] = tets[turned][:, [0, 1, 3, 2]]
    for step in STEPS:
        for chosen in _independent(points, tets):
            _move(points, tets, body, chosen, step, level)
    return Stuffed(points, body.tets, body.on_surface, body.on_side)


def _independent(points: Floats, tets: Ints) -> Iterator[Ints]:
    """Sets of vertices (s,) of bad tets, no two in one tet, the worst first; each vertex once."""
    sines = least_sines(points[tets])
    worst = np.full(len(points), np.inf)
    for corner in tets.T:
        np.minimum.at(worst, corner, sines)
    left = worst < GOOD
    rank = np.empty(len(points), np.int64)
    rank[np.argsort(worst, kind="stable")] = np.arange(len(points))
    near = tets[left[tets].any(axis=1)]
    for _ in range(ROUNDS):
        order = np.where(left, rank, len(points))
        least = order[near].min(axis=1)
        wins = left.copy()
        for corner in near.T:
            wins[corner[order[corner] > least]] = False
        if not wins.any():
            return
        yield np.flatnonzero(wins)
        left &= ~wins


def _move(
    points: Floats, tets: Ints, body: Stuffed, chosen: Ints, step: float, level: Level
) -> None:
    """Move each chosen vertex to the best of the places tried, if that is better than its own."""
    number = np.full(len(points), -1)
    number[chosen] = np.arange(len(chosen))
    which, corner = np.nonzero(number[tets] >= 0)
    of = number[tets[which, corner]]
    order = np.argsort(of, kind="stable")
    which, corner, of = which[order], corner[order], of[order]
    first = np.searchsorted(of, np.arange(len(chosen)))
    star = points[tets[which]]
    reach = np.linalg.norm(star - points[chosen[of]][:, None], axis=2).max(axis=1)
    reach = step * np.minimum.reduceat(reach, first)
    middle = np.add.reduceat((star.sum(axis=1) - points[chosen[of]]) / 3, first)
    middle /= np.diff(np.append(first, len(of)))[:, None]
    own = points[chosen]
    best, found = np.minimum.reduceat(least_sines(star), first), own.copy()
    row = np.arange(len(of))
    for way in (None, *WAYS):
        tried = middle if way is None else own + reach[:, None] * way / np.linalg.norm(way)
        tried = _back(np.where(body.on_side[chosen], own, tried), body, chosen, level)
        star[row, corner] = tried[of]
        quality = np.minimum.reduceat(least_sines(star), first)
        better = quality > best + 1e-9
        best, found = np.where(better, quality, best), np.where(better[:, None], tried, found)
    points[chosen] = found


def _back(places: Floats, body: Stuffed, chosen: Ints, level: Level) -> Floats:
    """Places (s, 3), those of vertices on the surface brought back to it, along its sides."""
    on = np.flatnonzero(body.on_surface[chosen])
    if not len(on):
        return places
    points, places = places[on], places.copy()
    width = 0.05
    for _ in range(3):
        slope = np.stack([
            level(points + width * axis) - level(points - width * axis) for axis in np.eye(3)
        ], axis=1) / (2 * width)  # fmt: skip
        slope[body.on_side[chosen[on]]] = 0.0
        square = np.maximum((slope**2).sum(axis=1), 0.05)
        points = points - (level(points) / square)[:, None] * slope
    off = np.abs(level(points)) > 0.02
    points[off] = np.nan
    places[on] = points
    return places
