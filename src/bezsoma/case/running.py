# SPDX-License-Identifier: BSD-3-Clause
"""A case from its tables to its results folder, everything that can be checked first."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

from bezsoma.arrays import Floats
from bezsoma.case.advice import as_written, in_case
from bezsoma.case.build import body_of
from bezsoma.case.estimating import estimated
from bezsoma.case.expectations import checked, motions, probe_points
from bezsoma.case.last import keeping_last, of_keep_last
from bezsoma.case.quantities import Measured
from bezsoma.case.reading import Case, read_case
from bezsoma.case.refining import solved, with_tolerance
from bezsoma.case.sources import mesh_of
from bezsoma.case.writing import write_results
from bezsoma.errors import InputError, counted
from bezsoma.mechanics.body import Body
from bezsoma.mesh.nouns import described, path_given
from bezsoma.mesh.tets import TetMesh
from bezsoma.refinement.levels import Level, Refined
from bezsoma.refinement.singular import singularities
from bezsoma.results import Destination, Results, destination
from bezsoma.results.archive import NOTICE
from bezsoma.results.folder import FORMAT
from bezsoma.solvers.solution import Solution

Progress = Callable[[str, float | None, str], None]
"""Called with a stage, how much of it is done (0 to 1, None where unknown) and a note."""

UNITS = {
    "length": "mm",
    "volume": "mm3",
    "force": "N",
    "moment": "N mm",
    "energy": "N mm",
    "stress": "MPa",
    "time": "s",
}
FAR = 0.05
"""A probe is far from its surface beyond this part of the size of the mesh."""
BYTES_OF_CONTROL = 400
"""A generous guess of what all files together take for one control (with the mesh and VTU)."""
BYTES_OF_PICTURES = 4_000_000


def silent(stage: str, fraction: float | None, note: str) -> None:
    """The progress of those who do not watch."""


def run_case(
    case: Case | Path | str,
    folder: Path | str,
    *,
    overwrite: bool = False,
    degree: int | None = None,
    tolerance: float | None = None,
    keep_last: Path | str | None = None,
    progress: Progress = silent,
) -> Results:
    """Solve a case and leave its results folder, whole or not at all; gives what it holds.

    `case` is one that was read, or the path of its file. `degree` takes the place of the one in
    the file, `tolerance` [mm] that of the one in its table [refine]. The folder is looked at first,
    then the mesh, names, probes and expectations; only then is anything solved. Whether the
    expectations were met stands in `summary["expectations"]`, whether the tolerance was in
    `summary["refinement"]`. Where no answer is found, NotConverged is raised, and the last state
    in balance is written to the folder `keep_last`, if one is given, marked as no answer: see
    `Results.unfinished`.
    """
    case = _case(case)
    place = destination(path_given(folder, "run_case(case, folder)"), overwrite=overwrite)
    last = _place_of_last(place, keep_last, overwrite)
    start = perf_counter()
    progress("mesh", None, "reading the mesh and checking the case")
    mesh = mesh_of(case)
    table = with_tolerance(case, tolerance)
    probes = probe_points(case, mesh, table)
    body = body_of(case, mesh, case.file.degree if degree is None else degree)
    place.check_room(_size(body))
    instead = {
        **({} if degree in (None, case.file.degree) else {"degree": degree}),
        **({} if tolerance is None else {"tolerance": float(tolerance)}),
    }

    def told(case: Case, solution: Solution, levels: Refined | None = None) -> dict[str, Any]:
        summary = summary_of(case, solution, probes, levels)
        return {**summary, "instead": instead, "seconds": perf_counter() - start}

    with in_case(case.path.name), keeping_last(case, last, told, progress):
        solution, levels = solved(case, body, table, probes, progress)
    if levels is not None:
        place.check_room(_size(solution.body))
    summary = told(case, solution, levels)
    if levels is None:
        with_error(summary, estimated(case, solution, probes, progress))
    else:
        with_last_level(summary, levels.levels[-1], case.file.error.radius)
    summary["seconds"] = perf_counter() - start
    with place.filling() as partial:
        write_results(partial, case, solution, summary, progress)
    mesh, pressure = solution.body.mesh, solution.pressure
    return Results(place.folder, mesh, solution.displacement, summary, case.text, pressure)


def _place_of_last(place: Destination, folder: Any, overwrite: bool) -> Destination | None:
    """Where the last state in balance goes if there is no answer; never where the answer would."""
    if folder is None:
        return None
    given = path_given(folder, "keep_last= of run_case")
    try:
        found = destination(given, overwrite=overwrite)
    except InputError as refusal:
        raise InputError(of_keep_last(refusal)) from refusal
    if found.folder == place.folder:
        raise InputError(
            f"{str(place.folder)!r} is for the answer, and what --keep-last keeps is none; give "
            "it a folder of its own"
        )
    return found


def _case(given: Any) -> Case:
    """The case itself, read if a path was given."""
    if isinstance(given, Case):
        return given
    if isinstance(given, str | Path):
        return read_case(given)
    raise InputError(
        f"run_case(case, folder): {described(given)} cannot be the case; give read_case(path), or "
        "the path of a case file"
    )


def summary_of(
    case: Case, solution: Solution, probes: dict[str, Floats], levels: Refined | None = None
) -> dict[str, Any]:
    """What summary.json says of a solution; lengths mm, forces N, moments and energy N mm."""
    measured = Measured(solution, probes)
    mesh, degree = solution.body.mesh, solution.body.degree
    probed = motions(case, measured)
    return {
        "format": FORMAT,
        "title": case.title,
        "case": case.path.name,
        "notice": NOTICE,
        "units": UNITS,
        "degree_in_case": case.file.degree,
        **solution.summary(),
        "regions": list(mesh.regions),
        "surfaces": {name: len(facets) for name, facets in mesh.surfaces.items()},
        "probes": probed,
        **({} if levels is None else {"refinement": levels.summary()}),
        "warnings": [
            each + as_written(each) for each in dict.fromkeys(_said(solution, probed, levels))
        ],
        "expectations": checked(case, degree, measured),
    }


def _said(
    solution: Solution, probed: Mapping[str, Mapping[str, Any]], levels: Refined | None
) -> Iterator[str]:
    """All warnings, which may say a thing twice."""
    yield from warnings(solution.body.mesh, probed)
    yield from advice(solution)
    yield from singularities(solution)
    yield from doubts(levels)


def with_error(summary: dict[str, Any], error: dict[str, Any]) -> None:
    """Put what is known of the error beside the values: of each probe its length, mm."""
    summary["error"] = error
    for name, found in error.get("probes", {}).items():
        summary["probes"][name].update(error=found["error"], error_radius=found["radius"])


def with_last_level(summary: dict[str, Any], last: Level, radius: float) -> None:
    """Put the errors of the last level of a refinement beside the values, mm."""
    for found in last.at:
        if found.name in summary["probes"]:
            summary["probes"][found.name].update(error=found.error, error_radius=radius)


def warnings(mesh: TetMesh, probed: Mapping[str, Mapping[str, Any]]) -> Iterator[str]:
    """What is no fault but may not be what was meant."""
    if mesh.dropped:
        yield f"{mesh.dropped} points of the mesh belong to no tet and were dropped"
    size = float(np.linalg.norm(np.ptp(mesh.points, axis=0)))
    for name, probe in probed.items():
        if probe["off_by"] > FAR * size:
            yield f"the probe {name!r} was taken to its surface over {probe['off_by']:.3g} mm"


def advice(solution: Solution) -> Iterator[str]:
    """What would be better done otherwise."""
    if solution.advice:
        yield solution.advice
    if solution.held_tets:
        yield (
            f"all four vertices of {counted(solution.held_tets, 'tet')} are prescribed, and what "
            "can move there is stiffened by its pressure; split_held_tets = true cuts in four there"
        )


def doubts(levels: Refined | None) -> Iterator[str]:
    """What was not reached, and what makes an estimate meaningless."""
    if levels is None:
        return
    if not levels.reached:
        yield f"refinement ended short of what was asked for: {levels.why}"
    yield from levels.warnings


def _size(body: Body) -> int:
    """About how many bytes the results will take."""
    cells = len(body.mesh.tets) * body.degree**3 / 6 + len(body.mesh.points)
    return int(cells) * BYTES_OF_CONTROL + BYTES_OF_PICTURES
