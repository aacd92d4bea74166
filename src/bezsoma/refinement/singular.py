# SPDX-License-Identifier: BSD-3-Clause
"""What makes the energy of a body infinite, so that no number of its error means anything."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from bezsoma.equations.grading import graded_displacement
from bezsoma.mechanics.body import Body
from bezsoma.mechanics.joins import Precedence
from bezsoma.mechanics.loads import PointForce
from bezsoma.mechanics.meeting import simplices_of
from bezsoma.mechanics.supports import Support, prescribes
from bezsoma.solvers.solution import Solution

SAME = 1e-9
"""Two displacements differ where they are further apart than this part of the larger."""


IDLE = 1e-6
"""A support on a vertex or an edge is idle where its work is this part of the energy."""


def singularities(solution: Solution) -> tuple[str, ...]:
    """A sentence for each thing that makes a displacement or an energy grow without bound.

    >>> from bezsoma.mechanics import Fixed, LinearElastic
    >>> from bezsoma.mesh.solids import block
    >>> from bezsoma.solvers.solve import solve
    >>> force = PointForce((1, 1, 1), (0, 0, -1))
    >>> body = Body(block(), 2, LinearElastic(1.0, 0.3), [Fixed("bottom")], [force])
    >>> [sentence.split(":")[0] for sentence in singularities(solve(body))]
    ['a point force acts at (1, 1, 1) mm']
    """
    body = solution.body
    return (*_point_forces(body), *_thin_supports(solution), *_jumps(body))


def _point_forces(body: Body) -> Iterator[str]:
    for load in body.loads:
        if isinstance(load, PointForce) and load.force.any():
            at = load.at if isinstance(load.at, str) else _point(load.at)
            yield (
                f"a point force acts at {at}{'' if isinstance(load.at, str) else ' mm'}: the "
                "displacement there and the energy grow without bound as the mesh or the degree "
                "is refined, so the error in energy means nothing; spread it over a patch with "
                "Traction"
            )


def _thin_supports(solution: Solution) -> Iterator[str]:
    body = solution.body
    for place in dict.fromkeys(place for each in body.supports for place in each.places):
        if place in body.mesh.surfaces or _within_surfaces(body, place):
            continue
        force = float(np.linalg.norm(solution.reactions[place].force))
        if force * solution.largest_displacement > IDLE * solution.energy:
            kind = body.mesh.place_kind(place)
            yield (
                f"the support {place!r} is a {kind}: what it holds settles without bound as the "
                "mesh or the degree is refined, so errors that count on it mean little; support a "
                "surface"
            )


def _within_surfaces(body: Body, place: str) -> bool:
    """Whether supported surfaces hold all vertices of a place anyway, in the same components."""
    wanted = {axis for each in body.supports if place in each.places for axis in each.components}
    held = [
        name
        for each in body.supports
        if wanted <= set(each.components)
        for name in each.places
        if name in body.mesh.surfaces
    ]
    vertices = [body.mesh.vertices_of(name) for name in held]
    return bool(held) and bool(
        np.isin(body.mesh.vertices_of(place), np.concatenate(vertices)).all()
    )


def _jumps(body: Body) -> Iterator[str]:
    for join in body.joins:
        if not isinstance(join, Precedence):
            continue
        jump = max((_apart(body, one, other, join) for one, other in _pairs(body, join)), default=0)
        if jump > 0:
            first, second = join.places
            yield (
                f"where {first!r} and {second!r} meet the prescribed displacement jumps by "
                f"{jump:.3g} mm: the energy grows without bound as the mesh or the degree is "
                "refined, so the error in energy means nothing, and errors near that line little; "
                f"grade it, Graded(over={second!r}, to={first!r}, band=...), or leave a Gap"
            )


def _pairs(body: Body, join: Precedence) -> Iterator[tuple[Support, Support]]:
    first, second = join.places
    for one in body.supports:
        for other in body.supports:
            if first in one.places and second in other.places:
                yield one, other


def _apart(body: Body, one: Support, other: Support, join: Precedence) -> float:
    """How far two supports are apart on the vertices that their places share, mm."""
    first, second = join.places
    shared = np.intersect1d(simplices_of(body.mesh, first, 0), simplices_of(body.mesh, second, 0))
    points = body.mesh.points[shared]
    a = graded_displacement(one, first, body)(points)
    b = graded_displacement(other, second, body)(points)
    both = prescribes(one) & prescribes(other)
    size = max(float(np.abs(a).max(initial=0)), float(np.abs(b).max(initial=0)))
    jump = float(np.linalg.norm(np.where(both, a - b, 0.0), axis=1).max(initial=0))
    return jump if jump > SAME * size else 0.0


def _point(at: np.ndarray) -> str:
    return "(" + ", ".join(f"{x:.4g}" for x in at) + ")"
