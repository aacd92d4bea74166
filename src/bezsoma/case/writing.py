# SPDX-License-Identifier: BSD-3-Clause
"""The files of a results folder, one after the other."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from bezsoma.case.reading import Case
from bezsoma.case.readme import readme
from bezsoma.results import write_fields
from bezsoma.results.archive import CASE
from bezsoma.results.folder import SUMMARY
from bezsoma.solvers.solution import Solution
from bezsoma.view.picture import face_picture
from bezsoma.view.vtk import write_vtu

README = "README.txt"
VTU = "displacement.vtu"


def write_results(
    folder: Path,
    case: Case,
    solution: Solution,
    summary: dict[str, Any],
    progress: Callable[[str, float | None, str], None],
) -> None:
    """Write all files of a run into an empty folder; completes `summary` and writes it last."""
    progress("write", None, "mesh and controls")
    (folder / CASE).write_bytes(case.text.encode("utf-8"))
    write_fields(folder, solution.displacement)
    if case.file.output.vtu:
        progress("write", None, VTU)
        _write_vtu(folder / VTU, case, solution)
    if case.file.output.pictures:
        progress("write", None, "pictures")
        _write_pictures(folder, case, solution)
    summary["pictures"] = [_picture(view) for view in case.file.output.pictures]
    names = [path.name for path in folder.iterdir()]
    summary["files"] = sorted([*names, README, SUMMARY])
    (folder / README).write_text(readme(summary), encoding="utf-8")
    summary["history"] = summary.pop("history")  # the longest part comes last
    (folder / SUMMARY).write_text(json.dumps(summary, indent=1) + "\n", encoding="utf-8")


def _write_vtu(path: Path, case: Case, solution: Solution) -> None:
    """The displacement, and on request the stress, on cells of the displacement's degree."""
    fields: dict[str, Any] = {"displacement": solution.displacement}
    if case.file.output.stress:
        fields["stress"] = solution.stress
    write_vtu(path, solution.body.mesh, fields, metadata={"title": case.title})


def _write_pictures(folder: Path, case: Case, solution: Solution) -> None:
    """A sheet for each view: before, after, the size of the displacement, the outlines."""
    output = case.file.output
    for view in output.pictures:
        face_picture(
            folder / _picture(view),
            solution.body.mesh,
            solution.displacement,
            surface=output.surface,
            view=view,
            title=f"{case.title} (degree {solution.body.degree})",
        )


def _picture(view: str) -> str:
    """The name of the sheet of a view."""
    return f"before-after-{view.replace(' ', '-')}.png"
