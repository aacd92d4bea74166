# SPDX-License-Identifier: BSD-3-Clause
"""From supports and joins to prescribed controls; where supports disagree nothing is silent."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import combinations, product

import numpy as np

from bezsoma.arrays import Bools, Floats, Ints, frozen
from bezsoma.equations.grading import bands_checked, distances, graded_displacement
from bezsoma.errors import InputError
from bezsoma.mechanics.body import Body
from bezsoma.mechanics.joins import Gap, Graded
from bezsoma.mechanics.meeting import meeting, own_simplices
from bezsoma.mechanics.supports import Support, prescribes
from bezsoma.mesh.control_net import ControlNet

TOLERANCE = 1e-12
"""Two supports prescribe the same when they differ by less than this times the size."""

ROUNDING = 1e-9
"""A vertex this much beyond a gap's width is within it, so that a turned frame decides alike."""


@dataclass(frozen=True, eq=False)
class PrescribedControls:
    """Which components of which controls are known (c, 3), and their values (c, 3) mm.

    `of_support` has for every supported place its control numbers (k,) ascending and which of
    their components (k, 3) it holds. What two places hold alike counts for the one stated first,
    so that reactions add up to the whole. Values are zero where nothing is prescribed.
    """

    mask: Bools
    values: Floats
    of_support: Mapping[str, tuple[Ints, Bools]]


@dataclass(frozen=True, eq=False)
class Claim:
    """What one support wants on one of its places: controls (k,), components, values (k, 3)."""

    support: Support
    place: str
    components: Bools
    numbers: Ints
    values: Floats
    graded: bool = False

    def __str__(self) -> str:
        bands = " (graded by a join)" if self.graded else ""
        return f"{type(self.support).__name__} on {self.place!r}{bands}"


def prescribed(body: Body, net: ControlNet) -> PrescribedControls:
    """The controls that supports prescribe, joins applied; a disagreement left is refused.

    A support prescribes the trace on the closure of its places. Affine displacements have their
    values at the domain points as controls; anything else is interpolated entity by entity.

    >>> from bezsoma.mechanics import Body, Fixed, LinearElastic
    >>> from bezsoma.mesh.solids import block
    >>> body = Body(block(), 2, LinearElastic(1.0, 0.3), [Fixed("bottom", components="z")])
    >>> known = prescribed(body, ControlNet(body.mesh, 2))
    >>> known.mask.sum(axis=0).tolist() == [0, 0, len(known.of_support["bottom"][0])]
    True
    """
    points = net.points  # formed at each call
    claims = [
        _claim(support, place, body, net, points)
        for support in body.supports
        for place in dict.fromkeys(support.places)
    ]
    for join in body.joins:
        if isinstance(join, Gap):
            claims = [_released(claim, join, net) for claim in claims]
    return _settled(claims, body, net, points)


def _claim(support: Support, place: str, body: Body, net: ControlNet, points: Floats) -> Claim:
    gradeds = [join for join in body.joins if isinstance(join, Graded) and join.over == place]
    bands_checked(gradeds, net)
    if not gradeds and support.degree is not None and support.degree <= 1:
        numbers = net.of_place(place)
        values = support.displacement(points[numbers])
    else:
        function = graded_displacement(support, place, body)
        numbers, values = net.interpolated_on(place, function)
    return Claim(support, place, prescribes(support), numbers, values, bool(gradeds))


def _released(claim: Claim, join: Gap, net: ControlNet) -> Claim:
    """The claim without the parts of `free` that have a vertex within the gap's width."""
    if claim.place != join.free:
        return claim
    mesh = net.mesh
    line = mesh.points[meeting(mesh, join.free, join.at)]
    rows = own_simplices(mesh, join.free)
    vertices = np.unique(rows)
    away = distances(mesh.points[vertices], line, 2 * join.width)
    near = vertices[away <= join.width * (1 + ROUNDING)]
    kept = rows[~np.isin(rows, near).any(axis=1)]
    if not len(kept):
        raise InputError(
            f"{join}: all of {join.free!r} lies within {join.width:g} mm of the line, nothing "
            "would be held there; give a shorter width, or leave the support out"
        )
    controls = (net.of_vertices, net.of_edges, net.of_facets)[rows.shape[1] - 1](kept)
    stays = np.isin(claim.numbers, controls)
    return replace(claim, numbers=claim.numbers[stays], values=claim.values[stays])


def _settled(
    claims: list[Claim], body: Body, net: ControlNet, points: Floats
) -> PrescribedControls:
    held = _precedence(claims, body)
    _agreed(claims, held, points)
    mask = np.zeros((net.count, 3), dtype=bool)
    values = np.zeros((net.count, 3))
    owned: dict[str, Bools] = {}
    for claim, holds in zip(claims, held, strict=True):
        new = holds & ~mask[claim.numbers]
        values[claim.numbers] = np.where(new, claim.values, values[claim.numbers])
        mask[claim.numbers] |= new
        owned.setdefault(claim.place, np.zeros_like(mask))[claim.numbers] |= new
    return PrescribedControls(
        frozen(mask),
        frozen(values),
        {place: _numbered(net.of_place(place), own) for place, own in owned.items()},
    )


def _numbered(numbers: Ints, own: Bools) -> tuple[Ints, Bools]:
    return frozen(numbers), frozen(own[numbers])


def _precedence(claims: list[Claim], body: Body) -> list[Bools]:
    """For each claim the (k, 3) components it holds after others took precedence."""
    held = [np.tile(claim.components, (len(claim.numbers), 1)) for claim in claims]
    first_of = {join.places for join in body.joins}
    for one, (other, holds) in product(claims, zip(claims, held, strict=True)):
        if (one.place, other.place) in first_of:
            shared = np.isin(other.numbers, one.numbers)
            holds[np.ix_(shared, one.components)] = False
    return held


def _agreed(claims: list[Claim], held: list[Bools], points: Floats) -> None:
    """Refuse two claims that still prescribe different values at the same control."""
    largest = max((float(np.abs(claim.values).max(initial=0)) for claim in claims), default=0.0)
    tolerance = TOLERANCE * max(largest, float(np.abs(points).max()))
    for (one, holds), (other, holds_too) in combinations(zip(claims, held, strict=True), 2):
        shared, i, j = np.intersect1d(
            one.numbers, other.numbers, assume_unique=True, return_indices=True
        )
        apart = np.abs(one.values[i] - other.values[j]) * (holds[i] & holds_too[j])
        if (apart > tolerance).any():
            raise InputError(_disagreement(one, other, apart, apart > tolerance, points[shared]))


def _disagreement(one: Claim, other: Claim, apart: Floats, differ: Bools, points: Floats) -> str:
    rows = np.flatnonzero(differ.any(axis=1))
    x, y, z = points[rows[0]]
    axes = ", ".join(letter for letter, column in zip("xyz", differ.T, strict=True) if column.any())
    what = (
        f"{one} and {other} prescribe different displacements ({axes}) at {len(rows)} of the "
        f"controls they share, first at ({x:.6g}, {y:.6g}, {z:.6g}) mm, by up to "
        f"{apart.max():.3g} mm; "
    )
    by_motion = sorted((one, other), key=lambda claim: -float(np.abs(claim.values).max()))
    a, b = (claim.place for claim in by_motion)
    if a == b:
        return what + "only one can hold on the same place: take one away or split the components"
    return what + (
        f"say in joins=[...] what holds: Precedence({a!r}, over={b!r}), or "
        f"Graded(over={b!r}, to={a!r}, band=<mm>) to grade the jump, or "
        f"Gap(free={b!r}, at={a!r}, width=<mm>) to leave a gap free; each works the other way round"
    )
