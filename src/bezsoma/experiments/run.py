# SPDX-License-Identifier: BSD-3-Clause
"""Runs an experiment by its name and leaves its page, pictures and numbers in a folder."""

from __future__ import annotations

import os
from importlib import import_module
from pathlib import Path
from types import MappingProxyType
from typing import Protocol, cast

from bezsoma.errors import InputError, unknown
from bezsoma.experiments.report import Report, Tables
from bezsoma.results.folder import written as made
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
MARK = b"`bezsoma experiment "
"""Stands in every page of an experiment."""


class Experiment(Protocol):
    """A module of this package."""

    def measured(self, quick: bool = False) -> Tables:
        """The numbers; when quick, some of the rows."""

    def finding(self, tables: Tables) -> str:
        """What is found, in words that follow from the full numbers alone."""

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

    A quick run leaves no page and no pictures, which would speak of rows that it has not, and
    does not replace a whole one.
    """
    chosen, target = experiment(name), Path(folder)
    with made(target):
        refuse_occupied(target, overwrite)
        if quick and (target / "README.md").exists():
            raise InputError(
                f"{str(target)!r} holds the page of a whole run, which would then speak of other "
                "numbers; name another folder with -o"
            )
    tables = chosen.measured(quick)
    files = {f"{file}.csv": table.as_csv().encode() for file, table in tables.items()}
    if not quick:
        report = chosen.told(tables)
        files |= {f"{file}.png": each.content for file, each in report.pictures.items()}
        files["README.md"] = report.page(name).encode()
    with made(target):
        target.mkdir(parents=True, exist_ok=True)
        return [written(target / file, content, overwrite=True) for file, content in files.items()]


def refuse_occupied(folder: Path, overwrite: bool) -> None:
    """Refuse a place before the work: a file, a place in one, or what no experiment wrote."""
    stands = next(each for each in (folder.absolute(), *folder.absolute().parents) if each.exists())
    if not stands.is_dir():
        raise InputError(f"{str(stands)!r} is a file, not a folder; name another one with -o")
    if not os.access(stands, os.W_OK):
        raise InputError(f"you may not write to {str(stands)!r}; name another folder with -o")
    there = sorted(folder.iterdir()) if folder.is_dir() else []
    if there and not overwrite:
        raise InputError(
            f"{str(folder)!r} is there already; say --overwrite, or name another folder with -o"
        )
    theirs = [each.name for each in there if not of_an_experiment(each)]
    if theirs:
        raise InputError(
            f"{str(folder)!r} holds {theirs[:3]}, which no experiment wrote, so nothing in it is "
            "touched; name another folder with -o"
        )


def of_an_experiment(file: Path) -> bool:
    """Whether a file is one that experiments write: numbers, a picture, or a page that says so."""
    if file.name == "README.md":
        return file.is_file() and MARK in file.read_bytes()
    return file.suffix in {".csv", ".png"} and file.is_file()
