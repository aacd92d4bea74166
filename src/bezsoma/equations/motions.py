# SPDX-License-Identifier: BSD-3-Clause
"""Rigid motions in words: translations, rotations about axes or a point, screws."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bezsoma.arrays import Floats, Ints
from bezsoma.errors import counted
from bezsoma.mesh.tets import TetMesh

SMALL = 1e-6
"""Components of unit motions below this are rounding."""
NAMED = 3
"""Parts whose motions a message spells out."""


@dataclass(frozen=True, eq=False)
class Motions:
    """What a part can still do: basis (6, q) of (t, w) in u(x) = t + w x (x - centre) / radius.

    tets is the number of its tets. Parts of one group hang together: column j of the basis of each
    is what it does in joint motion j.
    """

    part: int
    group: int
    tets: int
    centre: Floats
    radius: float
    basis: Floats


def sentence(left: Sequence[Motions], parts: int, hinged: bool = False) -> str:
    """The message for motions left in a mesh of so many parts; whether any hang on a hinge."""
    named = "; ".join(f"{_subject(motions, parts)} {words(motions)}" for motions in left[:NAMED])
    more = len(left) - NAMED
    and_more = f"; and {more} further parts can move" if more > 0 else ""
    return (
        "the supports leave motions that cost no energy, so no one answer exists: "
        f"{named}{and_more}. {_advice(hinged)}"
    )


def _subject(motions: Motions, parts: int) -> str:
    if parts == 1:
        return "the body"
    tets = counted(motions.tets, "tet")
    return f"part {motions.part + 1} ({tets}, around {_point(motions.centre, motions)} mm)"


def _advice(hinged: bool) -> str:
    if hinged:
        return (
            "Parts that touch in single vertices or edges are hinged there and not joined: let "
            "them share faces, take the loose part away, or support it as well"
        )
    return (
        "Hold (Fixed, Moved, Prescribed) a surface of what moves, or further places or components"
    )


def words(motions: Motions) -> str:
    """What a part can do, for example "can still rotate about the axis through ... along z".

    A motion that keeps the centre and turns about x + y:

    >>> turn = np.array([[0, 0, 0, 1, 1, 0.0]]).T / 2**0.5
    >>> print(words(Motions(0, 0, 1, np.zeros(3), 1.0, turn)))
    can still rotate about the axis through (0, 0, 0) mm along (0.7071, 0.7071, 0)
    """
    shifts, turns = _split(motions.basis)
    if shifts.shape[1] == 3 and turns.shape[1] == 3:
        return "is held nowhere: it can still translate and rotate freely"
    said = [_translations(shifts)] if shifts.size else []
    said += _rotations(turns, motions)
    return f"can still {', and '.join(said)}"


def _split(basis: Floats) -> tuple[Floats, Floats]:
    """The pure translations (3, s), and motions (6, q) with turns along simple directions.

    The span of all is kept; what the pure translations can do is taken off the others.
    """
    _, sizes, right = np.linalg.svd(basis)
    basis = (basis @ right.T)[:, : int((sizes > SMALL).sum())]
    basis /= np.linalg.norm(basis, axis=0)
    _, sizes, right = np.linalg.svd(basis[3:])
    rank = int((sizes > SMALL).sum())
    ordered = basis @ right.T
    shifts, turns = ordered[:3, rank:], ordered[:, :rank]
    shifts = np.linalg.qr(shifts)[0]
    turns[:3] -= shifts @ (shifts.T @ turns[:3])
    simple = _simple(turns[3:])
    turns = turns @ np.linalg.lstsq(turns[3:], simple, rcond=None)[0]
    return shifts, turns


def _simple(directions: Floats) -> Floats:
    """Unit vectors that span the same as the columns (3, q), along x, y, z where they can be."""
    rows = directions.T.copy()
    done = 0
    for column in range(3):
        if done == len(rows):
            break
        pivot = done + int(np.abs(rows[done:, column]).argmax())
        if abs(rows[pivot, column]) < SMALL:
            continue
        rows[[done, pivot]] = rows[[pivot, done]]
        rows[done] /= rows[done, column]
        others = np.arange(len(rows)) != done
        rows[others] -= np.outer(rows[others, column], rows[done])
        done += 1
    return np.asarray((rows / np.linalg.norm(rows, axis=1)[:, None]).T)


def _translations(shifts: Floats) -> str:
    directions = _simple(shifts).T
    if len(directions) == 3:
        return "translate in every direction"
    if len(directions) == 2:
        return f"translate in every direction across {_direction(np.cross(*directions))}"
    return f"translate along {_direction(directions[0])}"


def _rotations(turns: Floats, motions: Motions) -> list[str]:
    """Each turn (6,) with |w| = 1: about the axis through centre + radius w x t, along w."""
    if turns.shape[1] == 3:
        arm = turns[:3] @ np.linalg.inv(turns[3:])
        if np.abs(arm + arm.T).max() < SMALL:  # t = d x w for all w: all axes meet in d
            d = np.array([arm[2, 1], arm[0, 2], arm[1, 0]])
            through = _point(motions.centre + motions.radius * d, motions)
            return [f"rotate in every direction about the point {through} mm"]
    said = []
    for turn in turns.T:
        t, w = turn[:3], turn[3:]
        through = _point(motions.centre + motions.radius * np.cross(w, t), motions)
        what = f"rotate about the axis through {through} mm along {_direction(w)}"
        slide = 2 * np.pi * motions.radius * float(t @ w)
        if abs(slide) > SMALL * motions.radius:
            what += f" while it slides along it by {slide:.4g} mm a turn (a screw)"
        said.append(what)
    return said


def _direction(vector: Floats) -> str:
    unit = vector / np.linalg.norm(vector)
    for axis, name in enumerate("xyz"):
        if abs(abs(unit[axis]) - 1) < SMALL:
            return name
    return "(" + ", ".join(f"{x:.4g}" for x in _clean(unit, 1.0)) + ")"


def _point(point: Floats, motions: Motions) -> str:
    return "(" + ", ".join(f"{x:.6g}" for x in _clean(point, motions.radius)) + ")"


def _clean(numbers: Floats, size: float) -> Floats:
    """The numbers without what is rounding beside the size; no minus zero."""
    return np.where(np.abs(numbers) < SMALL * size, 0.0, numbers) + 0.0


def unwelded(mesh: TetMesh, label: Ints, left: Sequence[Motions]) -> str | None:
    """The message for parts that lie against each other without sharing their points, or None."""
    if label.max() == 0:
        return None
    spot = _spots(mesh.points)
    part_of = np.zeros(len(mesh.points), dtype=np.int64)
    part_of[mesh.tets] = label[:, None]
    loose = np.isin(part_of, [motions.part for motions in left])
    doubled = loose & (np.bincount(spot)[spot] > 1)
    if not doubled.any():
        return None
    return (
        f"the mesh is not welded: it falls into {int(label.max()) + 1} parts that share no faces, "
        f"and {int(doubled.sum())} points of the {len(left)} parts that nothing holds lie on other "
        "points with other numbers. Merge points that coincide, for example with\n"
        "    points, number = numpy.unique(points.round(6), axis=0, return_inverse=True)\n"
        "    tets = number.reshape(-1)[tets]"
    )


def _spots(points: Floats) -> Ints:
    """A number (v,) that points have in common when they lie on each other."""
    extent = float(np.ptp(points, axis=0).max())
    grid = np.round((points - points.min(axis=0)) / (1e-8 * extent))
    order = np.lexsort(grid.T)
    differs = (grid[order[1:]] != grid[order[:-1]]).any(axis=1)
    spot = np.zeros(len(points), dtype=np.int64)
    spot[order[1:]] = np.cumsum(differs)
    return spot
