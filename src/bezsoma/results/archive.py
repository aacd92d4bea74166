# SPDX-License-Identifier: BSD-3-Clause
"""The files of a results folder that carry numbers, written and read back bit for bit.

`mesh.npz` holds the mesh with its names; `displacement.npz` the degree, the control numbers of
each tet `of_tet` (t, m) and the controls (c, 3) in mm. Numbers are stored as they are in memory,
never through text.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from math import comb
from pathlib import Path
from typing import Any

import numpy as np

from bezsoma.arrays import Floats, Int32s, Ints
from bezsoma.errors import InputError
from bezsoma.mesh.control_net import ControlNet
from bezsoma.mesh.field import Field
from bezsoma.mesh.files import read_mesh, write_mesh
from bezsoma.mesh.tets import TetMesh
from bezsoma.mesh.topology import slices
from bezsoma.results.folder import FORMAT, SUMMARY

MESH = "mesh.npz"
DISPLACEMENT = "displacement.npz"
CASE = "case.toml"
NOTICE = "BezSoma is research software and not a medical device."


@dataclass(frozen=True, eq=False)
class Results:
    """What a run left in its folder."""

    folder: Path
    mesh: TetMesh
    """The mesh with its named places, mm."""
    displacement: Field
    """The displacement, mm; its controls are the bits that the solver gave."""
    summary: dict[str, Any]
    """What summary.json says: sizes, method, energy, reactions, probes, versions."""
    case: str
    """The text of the case file, as it was when it ran."""


def write_fields(folder: Path, displacement: Field) -> None:
    """Write `mesh.npz` and `displacement.npz` into a folder."""
    net = displacement.net
    write_mesh(folder / MESH, net.mesh)
    np.savez(
        folder / DISPLACEMENT,
        notice=np.str_(NOTICE),
        degree=np.int64(net.degree),
        of_tet=_of_tet(net),
        controls=displacement.controls,
    )


def _of_tet(net: ControlNet) -> Int32s:
    """`net.of_tet` in half the memory."""
    found = np.empty((len(net.mesh.tets), comb(net.degree + 3, 3)), np.int32)
    for part in slices(len(found)):
        found[part] = net.closure(3, part)
    return found


def read_results(folder: Path | str) -> Results:
    """The results in a folder, without loss; InputError where it is damaged or no results."""
    folder = Path(folder)
    summary = _summary(folder)
    for name in (CASE, MESH, DISPLACEMENT):
        if not (folder / name).is_file():
            raise InputError(
                f"the results in {str(folder)!r} are damaged: {name!r} is missing; run the case "
                "again"
            )
    mesh = read_mesh(folder / MESH)
    displacement = _displacement(folder / DISPLACEMENT, mesh)
    return Results(folder, mesh, displacement, summary, _text(folder / CASE))


def _text(path: Path) -> str:
    """The text of the case that ran."""
    try:
        return path.read_bytes().decode("utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{str(path)!r} is damaged ({error}); run the case again") from error


def _summary(folder: Path) -> dict[str, Any]:
    """summary.json of a results folder, recognised by its mark."""
    if not folder.is_dir():
        what = "is a file" if folder.exists() else "does not exist"
        raise InputError(f"no results in {str(folder)!r}: it {what}; give the folder of a run")
    try:
        summary = json.loads((folder / SUMMARY).read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise InputError(
            f"no results in {str(folder)!r}: it has no {SUMMARY!r}; give the folder that "
            "`bezsoma run` wrote"
        ) from None
    except (OSError, ValueError) as error:
        raise InputError(f"{str(folder / SUMMARY)!r} is damaged: {error}") from None
    given = summary.get("format") if isinstance(summary, dict) else None
    if given != FORMAT:
        raise InputError(
            f"{str(folder / SUMMARY)!r} is of the format {given!r}, and this version reads "
            f"{FORMAT!r}; run the case again"
        )
    return dict(summary)


def _displacement(path: Path, mesh: TetMesh) -> Field:
    """The field stored at `path`, on the net of `mesh`."""
    try:
        # Opened here, since numpy leaves a damaged file open.
        with path.open("rb") as stream, np.load(stream, allow_pickle=False) as stored:
            degree, of_tet = int(stored["degree"]), stored["of_tet"]
            controls = stored["controls"]
    except Exception as error:  # zip, zlib and NumPy each have their own ways to fail
        raise InputError(f"{str(path)!r} is damaged ({error}); run the case again") from error
    net = ControlNet(mesh, degree)
    numbered = np.array_equal(np.unique(of_tet), np.arange(net.count))
    if not numbered or of_tet.shape != net.of_tet.shape or controls.shape != (net.count, 3):
        raise InputError(
            f"{str(path)!r} does not fit the mesh beside it: it holds controls of shape "
            f"{controls.shape} and tets of shape {of_tet.shape}, where degree {degree} on this "
            f"mesh has {(net.count, 3)} and {net.of_tet.shape}; run the case again"
        )
    if not np.isfinite(controls).all():
        raise InputError(f"{str(path)!r} is damaged: a control is not a number; run it again")
    return Field(net, _renumbered(controls, of_tet, net.of_tet))


def _renumbered(controls: Floats, stored: Ints, current: Ints) -> Floats:
    """The controls in the numbering of `current`, should another version have numbered the net."""
    if np.array_equal(stored, current):
        return controls
    moved = np.empty_like(controls)
    moved[current.ravel()] = controls[stored.ravel()]
    return moved
