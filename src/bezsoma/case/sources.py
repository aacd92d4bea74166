# SPDX-License-Identifier: BSD-3-Clause
"""Where the tets of a case come from: a file that is looked for, a solid, the head phantom."""

from __future__ import annotations

import inspect
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

from bezsoma.case.faults import Fault, nearest
from bezsoma.case.reading import Case
from bezsoma.errors import InputError
from bezsoma.mesh import solids
from bezsoma.mesh.files import read_mesh
from bezsoma.mesh.tets import TetMesh

DATA = "BEZSOMA_DATA"
"""The environment variable that may name the folder in which data lies."""


def mesh_of(case: Case) -> TetMesh:
    """The mesh of a case with all its named places, mm."""
    mesh = _tets(case)
    for kind, places in (("edges", case.file.mesh.edges), ("vertices", case.file.mesh.vertices)):
        for name, points in places.items():
            mesh = _named(case, mesh, kind, name, points)
    return mesh


def found(file: str, folder: str | None, beside: Path) -> Path:
    """The path of a data file: beside the case, else in BEZSOMA_DATA, else in `folder`.

    An absolute path stands for itself. `folder` is what a case says for those who have not set
    the variable; it is relative to the case.
    """
    data = os.environ.get(DATA)
    homes = [beside, *([Path(data)] if data else []), *([beside / folder] if folder else [])]
    tried = [Path(os.path.normpath(home / file)) for home in homes]
    for path in tried:
        if path.is_file():
            return path
    places = " and ".join(repr(str(path)) for path in dict.fromkeys(tried))
    advice = "" if data else f"; {DATA} is not set, set it to the folder that holds the file"
    raise InputError(f"no file {file!r}: looked for {places}{advice}")


def _tets(case: Case) -> TetMesh:
    """The tets from the one source that the case gives."""
    table = case.file.mesh
    if table.phantom is not None:
        from bezsoma.imaging.phantom import head_phantom

        return head_phantom(table.phantom)
    if table.solid is not None:
        return _solid(case, table.solid, table.parameters)
    assert table.file is not None
    try:
        path = found(table.file, table.folder, case.path.parent)
        return read_mesh(path, surfaces=table.surfaces, regions=table.regions)
    except InputError as error:
        case.refuse([Fault(("mesh", "file"), str(error))])
        raise


def _solid(case: Case, name: str, parameters: dict[str, Any]) -> TetMesh:
    """A solid made by formula, its parameters checked against those of its function."""
    known = _solids()
    if name not in known:
        case.refuse([Fault(("mesh", "solid"), f"no solid {name!r} {nearest(name, list(known))}")])
    words = list(inspect.signature(known[name]).parameters)
    case.refuse(
        [
            Fault(("mesh", "parameters", key), f"unknown key {nearest(key, words)}")
            for key in parameters
            if key not in words
        ]
    )
    given = {key: tuple(v) if isinstance(v, list) else v for key, v in parameters.items()}
    try:
        return known[name](**given)
    except (InputError, TypeError, ValueError) as error:
        case.refuse([Fault(("mesh", "parameters"), f"the solid {name!r} refuses: {error}")])
        raise


def _solids() -> dict[str, Callable[..., TetMesh]]:
    """The solids by name: every public function of their module that gives a mesh."""
    functions = inspect.getmembers(solids, inspect.isfunction)
    return {
        name: function
        for name, function in functions
        if function.__module__ == solids.__name__ and not name.startswith("_")
    }


def _named(case: Case, mesh: TetMesh, kind: str, name: str, points: Any) -> TetMesh:
    """The mesh with one more named place, given by its points."""
    try:
        with_place = mesh.with_edges if kind == "edges" else mesh.with_vertices
        return with_place(name, points)
    except InputError as error:
        case.refuse([Fault(("mesh", kind, name), str(error))])
        raise
