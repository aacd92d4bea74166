# SPDX-License-Identifier: BSD-3-Clause
"""Runs an experiment by its name and leaves its page, pictures and numbers in a folder."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from types import MappingProxyType
from typing import Protocol, cast

from bezsoma.errors import InputError, unknown
from bezsoma.experiments.report import Report, Tables
from bezsoma.view.written import written

EXPERIMENTS = MappingProxyType(
    {
        "figure_2": "an elastic body: support, load, displacement, virtual work",
        "figure_4": "control nets of Bezier tets, Bernstein polynomials",
        "figure_5": "de Casteljau's algorithm on a triangle and in a tet",
        "figure_6": "a block by degree: a point force, and why a patch",
        "figure_7": "compressible and incompressible, and what locks",
        "figure_8": "linear and stiffening, by six laws",
        "figure_9": "the jaw of the Visible Human moved forward, then and today",
        "degree_or_mesh": "a face: degree against refinement against time",
        "locking": "who locks as nu goes to 1/2",
        "face_laws": "what the law changes on a face",
    }
)
"""Name -> what it shows."""


class Experiment(Protocol):
    """A module of this package."""

    def measured(self, quick: bool = False) -> Tables:
        """The numbers; when quick, some of the rows."""

    def told(self, tables: Tables) -> Report:
        """The page and the pictures, from the full numbers."""


def experiment(name: str) -> Experiment:
    """The module of an experiment.

    >>> experiment("figure_10")
    Traceback (most recent call last):
    ...
    bezsoma.errors.InputError: no experiment 'figure_10'; BezSoma has ... (did you mean ...
    """
    if name not in EXPERIMENTS:
        raise InputError(unknown("experiment", name, EXPERIMENTS, "BezSoma"))
    return cast(Experiment, import_module(f"bezsoma.experiments.{name}"))


def run_experiment(
    name: str, folder: Path | str, *, overwrite: bool = False, quick: bool = False
) -> list[Path]:
    """Run one; the files that it left: README.md (the page), pictures, numbers as CSV.

    A quick run leaves no page and no pictures, which would speak of rows that it has not.
    """
    chosen, target = experiment(name), Path(folder)
    if target.exists() and (not target.is_dir() or (any(target.iterdir()) and not overwrite)):
        raise InputError(
            f"{str(target)!r} is there already; say --overwrite, or name another folder with -o"
        )
    tables = chosen.measured(quick)
    files = {f"{file}.csv": table.as_csv().encode() for file, table in tables.items()}
    if not quick:
        report = chosen.told(tables)
        files |= {f"{file}.png": each.content for file, each in report.pictures.items()}
        files["README.md"] = report.page(name).encode()
    target.mkdir(parents=True, exist_ok=True)
    return [written(target / file, content, overwrite=True) for file, content in files.items()]
