# SPDX-License-Identifier: BSD-3-Clause
"""What stands where a path, a mesh or a field is wanted, checked where a user hands it in."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np

from bezsoma.errors import InputError
from bezsoma.mesh.broken_field import BrokenField
from bezsoma.mesh.field import Field
from bezsoma.mesh.tets import TetMesh

LONGEST = 40
"""So many characters of what was given are repeated."""


def path_given(path: Any, call: str) -> Path:
    """The path of a file or folder, text or a `Path`; `call` shows where it stands.

    >>> path_given(3, "read_mesh(path)")
    Traceback (most recent call last):
        ...
    bezsoma.errors.InputError: read_mesh(path): the number 3 cannot be the path; give text or a Path
    """
    if isinstance(path, str) or (
        isinstance(path, os.PathLike) and isinstance(os.fspath(path), str)
    ):
        return Path(path)
    raise InputError(f"{call}: {described(path)} cannot be the path; give text or a Path")


def mesh_given(mesh: Any, call: str) -> TetMesh:
    """The mesh, or an InputError that says where the mesh is of what was given instead."""
    if isinstance(mesh, TetMesh):
        return mesh
    name = type(mesh).__name__.lower()
    if isinstance(getattr(mesh, "displacement", None), Field):
        advice = f"give {name}.displacement.mesh there, and {name}.displacement as the field"
    elif isinstance(mesh, Field | BrokenField):
        advice = "give field.mesh there, and the field after it"
    elif isinstance(getattr(mesh, "mesh", None), TetMesh):
        advice = f"give {name}.mesh there"
    elif isinstance(mesh, str | os.PathLike):
        advice = "give the path first and a mesh second; read_mesh reads one"
    else:
        advice = "give a TetMesh, such as read_mesh(path) or block()"
    raise InputError(f"{call}: {described(mesh)} cannot be the mesh; {advice}")


def field_given(field: Any, call: str, what: str) -> Field | BrokenField:
    """The field, or an InputError that says where the field is of what was given instead.

    A solution is known by its displacement: what solves stands on a floor above this one.
    """
    if isinstance(field, Field | BrokenField):
        return field
    name = type(field).__name__.lower()
    if isinstance(getattr(field, "displacement", None), Field):
        advice = f"give {name}.displacement"
    elif isinstance(field, np.ndarray):
        advice = "numbers alone do not say on which net they live: give Field(net, controls)"
    else:
        advice = "give a Field, or a BrokenField such as a stress"
    raise InputError(f"{call}: {described(field)} cannot be {what}; {advice}")


def described(thing: Any) -> str:
    """A few words for what was given.

    >>> described("jaw.vtu"), described(None), described({})
    ("the text 'jaw.vtu'", 'None', 'a dict')
    """
    if thing is None:
        return "None"
    if isinstance(thing, str):
        return f"the text {thing if len(thing) <= LONGEST else thing[:LONGEST] + '...'!r}"
    if isinstance(thing, int | float):
        return f"the number {thing!r}"
    if isinstance(thing, np.ndarray):
        return f"an array of shape {thing.shape}"
    kind = type(thing).__name__
    return f"{'an' if kind[0] in 'AEIOaeio' else 'a'} {kind}"
