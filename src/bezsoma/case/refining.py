# SPDX-License-Identifier: BSD-3-Clause
"""A case that is solved once, or refined until its error is small enough."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

from bezsoma.arrays import Floats
from bezsoma.case.faults import Fault
from bezsoma.case.reading import Case
from bezsoma.case.schema import CaseFile, Refine
from bezsoma.errors import InputError, unknown
from bezsoma.mechanics.body import Body
from bezsoma.mesh.tets import TetMesh
from bezsoma.refinement.levels import Refined
from bezsoma.refinement.loop import refined
from bezsoma.refinement.targets import Target, around, targets
from bezsoma.solvers.solution import Solution
from bezsoma.solvers.solve import solve

SKIN = "skin"
"""The surface to look at where a case names no probe."""


def with_tolerance(case: Case, tolerance: float | None) -> Refine | None:
    """What the case asks of its error, with another tolerance [mm] if one is given."""
    table = case.file.refine
    if tolerance is None:
        return table
    if not tolerance > 0:
        raise InputError(
            f"the tolerance of {tolerance:g} mm cannot be met: no error is below it; give more "
            "than 0, as --tolerance 0.1"
        )
    return (table or Refine()).model_copy(update={"tolerance": float(tolerance)})


def places_missing(file: CaseFile, table: Refine | None, mesh: TetMesh) -> Iterator[Fault]:
    """What the case wants refined and neither its probes nor its mesh have."""
    if table is None:
        return
    probes = [probe.name for probe in file.probe]
    known = [*probes, *mesh.surfaces]
    for name in table.at or ():
        if name not in known:
            yield Fault(("refine", "at"), unknown("probe or surface", name, known, "this case"))
        elif name in probes and name in mesh.surfaces:
            yield Fault(("refine", "at"), f"{name!r} is a probe and a surface; rename the probe")
    if table.tolerance is not None and not (table.at or probes or SKIN in known):
        yield Fault(
            ("refine",), f"a tolerance of what? Name a surface of {sorted(mesh.surfaces)} in 'at'"
        )


def solved(
    case: Case,
    body: Body,
    table: Refine | None,
    probes: Mapping[str, Floats],
    progress: Callable[[str, float | None, str], None],
) -> tuple[Solution, Refined | None]:
    """The solution of the case, and how it was refined, if it was."""
    solver = case.file.solver
    how: dict[str, Any] = {
        "solver": solver.method,
        "rtol": solver.rtol,
        "threads": solver.threads,
        "steps": solver.steps,
        "method": solver.iteration,
        "exactness": solver.exactness,
        "progress": progress,
    }
    if table is None:
        return solve(body, **how), None
    found = refined(
        body,
        tolerance=table.tolerance,
        at=list(_targets(case, table, probes, body.mesh)),
        energy=table.energy,
        by=table.by,
        most_unknowns=table.most_unknowns,
        most_seconds=table.most_seconds,
        **how,
    )
    return found.solution, found


def _targets(
    case: Case, table: Refine, probes: Mapping[str, Floats], mesh: TetMesh
) -> Iterator[Target]:
    """A patch around each probe, a mean over each surface."""
    surfaces = {probe.name: probe.on for probe in case.file.probe}
    for name in table.at or probes or [SKIN] * (SKIN in mesh.surfaces):
        if name in probes:
            yield around(name, probes[name], case.file.error.radius, surfaces[name])
        else:
            yield from targets(name, mesh)
