# SPDX-License-Identifier: BSD-3-Clause
"""A case from its tables to its results folder, everything that can be checked first."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

from bezsoma.arrays import Floats
from bezsoma.case.advice import in_case
from bezsoma.case.build import body_of
from bezsoma.case.expectations import checked, motions, probe_points
from bezsoma.case.quantities import Measured
from bezsoma.case.reading import Case, read_case
from bezsoma.case.sources import mesh_of
from bezsoma.case.writing import write_results
from bezsoma.errors import InputError
from bezsoma.mechanics.body import Body
from bezsoma.mesh.nouns import described, path_given
from bezsoma.mesh.tets import TetMesh
from bezsoma.results import Results, destination
from bezsoma.results.archive import NOTICE
from bezsoma.results.folder import FORMAT
from bezsoma.solvers.solution import Solution
from bezsoma.solvers.solve import solve

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
    progress: Progress = silent,
) -> Results:
    """Solve a case and leave its results folder, whole or not at all; gives what it holds.

    `case` is one that was read, or the path of its file. `degree` takes the place of the one in
    the file. The folder is looked at first, then the mesh, names, probes and expectations; only
    then is anything solved. Whether the expectations were met stands in `summary["expectations"]`.
    """
    case = _case(case)
    place = destination(path_given(folder, "run_case(case, folder)"), overwrite=overwrite)
    start = perf_counter()
    progress("mesh", None, "reading the mesh and checking the case")
    mesh = mesh_of(case)
    probes = probe_points(case, mesh)
    body = body_of(case, mesh, case.file.degree if degree is None else degree)
    mesh = body.mesh
    place.check_room(_size(body))
    table = case.file.solver
    with in_case(case.path.name):
        solution = solve(
            body,
            solver=table.method,
            rtol=table.rtol,
            threads=table.threads,
            steps=table.steps,
            method=table.iteration,
            exactness=table.exactness,
            progress=progress,
        )
    summary = summary_of(case, solution, probes)
    summary["seconds"] = perf_counter() - start
    with place.filling() as partial:
        write_results(partial, case, solution, summary, progress)
    pressure = solution.pressure
    return Results(place.folder, mesh, solution.displacement, summary, case.text, pressure)


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


def summary_of(case: Case, solution: Solution, probes: dict[str, Floats]) -> dict[str, Any]:
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
        "warnings": [*warnings(mesh, probed), *advice(solution)],
        "expectations": checked(case, degree, measured),
    }


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
            f"all four vertices of {solution.held_tets} tets are prescribed, and what can move "
            "there is stiffened by its pressure; split_held_tets = true cuts them in four"
        )


def _size(body: Body) -> int:
    """About how many bytes the results will take."""
    cells = len(body.mesh.tets) * body.degree**3 / 6 + len(body.mesh.points)
    return int(cells) * BYTES_OF_CONTROL + BYTES_OF_PICTURES
