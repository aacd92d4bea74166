# SPDX-License-Identifier: BSD-3-Clause
"""The estimated errors of a case: in energy, and of what its probes say."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from time import perf_counter
from typing import Any

import numpy as np

from bezsoma.arrays import Floats
from bezsoma.case.reading import Case
from bezsoma.errors import BezSomaError
from bezsoma.mechanics.body import HIGHEST_DEGREE
from bezsoma.mesh.control_net import ControlNet
from bezsoma.refinement.estimates import energy_estimate, goal_estimate
from bezsoma.refinement.goals import Goal
from bezsoma.refinement.means import mean
from bezsoma.refinement.raised import UP, Raised, raised
from bezsoma.refinement.targets import around
from bezsoma.solvers.solution import Solution

MOST_UNKNOWNS = 1_000_000
"""Of the richer equations: up to here nobody has to ask for an estimate."""

Progress = Callable[[str, float | None, str], None]


def estimated(
    case: Case, solution: Solution, probes: Mapping[str, Floats], progress: Progress
) -> dict[str, Any]:
    """What summary.json says of the error; `left_out` says why where there is no estimate.

    `energy` [-] is relative, in the energy norm; `probes` has for each the mean over a patch, its
    direction and its error, mm; `components` is None where these directions are those of the
    motion; `seconds` is what all of it took.
    """
    table, start = case.file.error, perf_counter()
    if reason := _unwanted(table.estimate, solution):
        return {"left_out": reason}
    progress("error", None, f"two degrees up, {len(probes)} probes")
    try:
        richer = raised(solution, threads=case.file.solver.threads)
        energy = energy_estimate(solution, richer=richer)
        found = {
            name: [_judged(solution, goal, richer) for goal in goals]
            for name, goals in _goals(case, solution, probes)
        }
    except BezSomaError as error:
        return {"left_out": f"the error could not be estimated: {error}"}
    return {
        "energy": energy.relative,
        "probes": found,
        "components": case.file.error.components,
        "unknowns": len(richer.start),
        "seconds": perf_counter() - start,
    }


def _unwanted(estimate: bool | None, solution: Solution) -> str:
    """Why nothing is estimated; nothing where it is."""
    if estimate is False:
        return "not asked for"
    degree = solution.body.degree + UP
    if degree > HIGHEST_DEGREE:
        return f"it takes degree {degree}, and degrees up to {HIGHEST_DEGREE} are built"
    unknowns = 3 * ControlNet(solution.body.mesh, degree).count
    if estimate is None and unknowns > MOST_UNKNOWNS:
        return (
            f"it takes {unknowns} unknowns, and nobody has asked for it: write estimate = true in "
            "[error]"
        )
    return ""


def _goals(
    case: Case, solution: Solution, probes: Mapping[str, Floats]
) -> Iterator[tuple[str, list[Goal]]]:
    """The means around each probe: of its surface where it has one, else of the inside."""
    table, surfaces = case.file.error, {each.name: each.on for each in case.file.probe}
    for name, point in probes.items():
        goals = around(name, point, table.radius, surfaces[name]).goals
        moved = np.array([mean(goal, solution.displacement) for goal in goals])
        if table.components is not None:
            yield name, [goals["xyz".index(letter)] for letter in table.components]
        else:
            yield name, [replace(goals[0], direction=moved)] if moved.any() else [goals[2]]


def _judged(solution: Solution, goal: Goal, richer: Raised) -> dict[str, Any]:
    found = goal_estimate(solution, goal, richer=richer)
    return {
        "direction": goal.direction.tolist(),
        "radius": getattr(goal, "radius", None),
        "mean": found.value,
        "error": found.size,
        "signed": found.error,
    }
