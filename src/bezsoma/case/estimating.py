# SPDX-License-Identifier: BSD-3-Clause
"""The estimated errors of a case: in energy, and of what its probes say."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from math import sqrt
from time import perf_counter
from typing import Any

from bezsoma.arrays import Floats
from bezsoma.case.reading import Case
from bezsoma.errors import BezSomaError
from bezsoma.mechanics.body import HIGHEST_DEGREE
from bezsoma.mesh.control_net import ControlNet
from bezsoma.refinement.estimates import (
    GoalEstimate,
    VectorEstimate,
    energy_estimate,
    goal_estimate,
    vector_estimate,
)
from bezsoma.refinement.goals import Goal
from bezsoma.refinement.raised import Raised, raised, up
from bezsoma.refinement.targets import AXES, around
from bezsoma.solvers.solution import Solution

MOST_UNKNOWNS = 1_000_000
"""Of the richer equations: up to here nobody has to ask for an estimate."""

Progress = Callable[[str, float | None, str], None]


def estimated(
    case: Case, solution: Solution, probes: Mapping[str, Floats], progress: Progress
) -> dict[str, Any]:
    """What summary.json says of the error; `left_out` says why where there is no estimate.

    `energy` [-] is relative, in the energy norm; `probes` has for each the mean over a patch and
    its error, mm: those `components` of it, and the length of all errors together; `seconds` is
    what all of it took.
    """
    table, start = case.file.error, perf_counter()
    if reason := _unwanted(table.estimate, solution):
        return {"left_out": reason}
    progress("error", None, f"in a higher degree, {len(probes)} probes")
    try:
        richer = raised(solution, threads=case.file.solver.threads)
        energy = energy_estimate(solution, richer=richer)
        found = {
            name: _told(goals, table.components, solution, richer)
            for name, goals in _goals(case, probes)
        }
    except BezSomaError as error:
        return {"left_out": f"the error could not be estimated: {error}"}
    return {
        "energy": energy.relative,
        "probes": found,
        "components": table.components or AXES,
        "unknowns": len(richer.start),
        "seconds": perf_counter() - start,
    }


def _unwanted(estimate: bool | None, solution: Solution) -> str:
    """Why nothing is estimated; nothing where it is."""
    if estimate is False:
        return "not asked for"
    degree = solution.body.degree + up(solution.body.degree)
    if degree > HIGHEST_DEGREE:
        return f"it takes degree {degree}, and degrees up to {HIGHEST_DEGREE} are built"
    unknowns = 3 * ControlNet(solution.body.mesh, degree).count
    if estimate is None and unknowns > MOST_UNKNOWNS:
        return (
            f"it takes {unknowns} unknowns, and nobody has asked for it: write estimate = true in "
            "[error]"
        )
    return ""


def _goals(case: Case, probes: Mapping[str, Floats]) -> Iterator[tuple[str, tuple[Goal, ...]]]:
    """The means around each probe, x, y and z: of its surface where it has one, else inside."""
    radius, surfaces = case.file.error.radius, {each.name: each.on for each in case.file.probe}
    for name, point in probes.items():
        yield name, around(name, point, radius, surfaces[name]).goals


def _told(
    goals: tuple[Goal, ...], components: str | None, solution: Solution, richer: Raised
) -> dict[str, Any]:
    """The mean over a patch and its error, mm: all components, or those asked for."""
    radius = getattr(goals[0], "radius", None)
    if components is None:
        return {"radius": radius, **_vector(vector_estimate(solution, goals[0], richer=richer))}
    chosen = [goals[AXES.index(letter)] for letter in components]
    found = [goal_estimate(solution, goal, richer=richer) for goal in chosen]
    return {"radius": radius, **_components(found)}


def _vector(found: VectorEstimate) -> dict[str, Any]:
    return {"mean": found.value.tolist(), "signed": found.error.tolist(), "error": found.size}


def _components(found: list[GoalEstimate]) -> dict[str, Any]:
    size = sqrt(sum(each.size**2 for each in found))
    mean, signed = [each.value for each in found], [each.error for each in found]
    return {"mean": mean, "signed": signed, "error": size}
