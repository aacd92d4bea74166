# SPDX-License-Identifier: BSD-3-Clause
"""The files of a results folder, one after the other."""

from __future__ import annotations

import json
from collections.abc import Callable
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from bezsoma.case.reading import Case
from bezsoma.case.readme import readme
from bezsoma.errors import MissingExtra
from bezsoma.mesh.broken_field import BrokenField
from bezsoma.mesh.field import Field
from bezsoma.results import write_fields
from bezsoma.results.archive import CASE
from bezsoma.results.folder import SUMMARY
from bezsoma.solvers.solution import Solution
from bezsoma.view.picture import face_picture, picture
from bezsoma.view.vtk import write_vtu

README = "README.txt"
VTU = "displacement.vtu"
LABELS = {
    "pressure": "pressure, MPa",
    "divergence": "div u",
    "determinant": "det(I + grad u) - 1",
    "von_mises": "von Mises stress, MPa",
}


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
    write_fields(folder, solution.displacement, solution.pressure)
    if case.file.output.vtu:
        progress("write", None, VTU)
        _write_vtu(folder / VTU, case, solution)
    summary["pictures"] = []
    if case.file.output.pictures:
        progress("write", None, "pictures")
        mark = summary.get("unfinished", {}).get("mark", "")
        try:
            summary["pictures"] = _write_pictures(folder, case, solution, mark)
        except MissingExtra as error:  # what was solved is not lost for want of pictures
            summary["warnings"] = [*summary["warnings"], f"no pictures were drawn: {error}"]
            progress("write", None, summary["warnings"][-1])
    names = [path.name for path in folder.iterdir()]
    summary["files"] = sorted([*names, README, SUMMARY])
    (folder / README).write_text(readme(summary), encoding="utf-8")
    summary["history"] = summary.pop("history")  # the longest part comes last
    (folder / SUMMARY).write_text(json.dumps(summary, indent=1) + "\n", encoding="utf-8")


def _write_vtu(path: Path, case: Case, solution: Solution) -> None:
    """The displacement, and on request the stress, on cells of the displacement's degree."""
    fields: dict[str, Any] = {"displacement": solution.displacement}
    if solution.pressure is not None:
        fields["pressure"] = solution.pressure
    for name in case.file.output.fields:
        fields[name] = named(solution, name)
    if case.file.output.stress:
        fields["stress"] = solution.stress
    write_vtu(path, solution.body.mesh, fields, metadata={"title": case.title})


def _write_pictures(folder: Path, case: Case, solution: Solution, mark: str) -> list[str]:
    """A sheet for each view: before, after, the size of the displacement, the outlines; its names.

    Then one for each field and view, headed by `mark` where it is of no answer; the title of the
    case, which heads the sheets, has it already. A field that has no number somewhere, as stress
    where tissue is turned inside out, is not drawn: the solution's advice says where that is.
    """
    output = case.file.output
    first = f"{mark}: " if mark else ""
    for view in output.pictures:
        face_picture(
            folder / _picture(view),
            solution.body.mesh,
            solution.displacement,
            surface=output.surface,
            view=view,
            title=f"{case.title} (degree {solution.body.degree})",
        )
    fields = {name: named(solution, name) for name in output.fields}
    drawn = {name: field for name, field in fields.items() if np.isfinite(field.controls).all()}
    for (name, field), view in product(drawn.items(), output.pictures):
        picture(
            folder / _picture(view, name),
            solution.body.mesh,
            field,
            displacement=solution.displacement,
            surface=output.surface or ("skin" if "skin" in solution.body.mesh.surfaces else None),
            view=view,
            label=LABELS[name],
            title=f"{first}{LABELS[name]} (displacement of degree {solution.body.degree})",
        )
    sheets = [_picture(view) for view in output.pictures]
    return sheets + [_picture(view, name) for name, view in product(drawn, output.pictures)]


def named(solution: Solution, name: str) -> Field | BrokenField:
    """The field of a solution by its name in a case; where there is no pressure, -tr(stress)/3."""
    if name != "pressure" or solution.pressure is not None:
        field: Field | BrokenField = getattr(solution, name)
        return field
    stress = solution.stress
    mean = np.trace(stress.controls, axis1=-2, axis2=-1) / 3
    return BrokenField(stress.mesh, stress.degree, -mean)


def _picture(view: str, of: str = "before-after") -> str:
    """The name of the picture of a view."""
    return f"{of}-{view.replace(' ', '-')}.png"
