# SPDX-License-Identifier: BSD-3-Clause
"""The files of a results folder that carry numbers, written and read back bit for bit.

`mesh.npz` holds the mesh with its names; `displacement.npz` the degree, the control numbers of
each tet `of_tet` (t, m) and the controls (c, 3) in mm; `pressure.npz`, where the pressure is an
unknown of its own, the same with controls (c,) in MPa, or tet by tet (t, m) where it breaks between
regions. Numbers are stored as they are in memory,
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
from bezsoma.mesh.broken_field import BrokenField
from bezsoma.mesh.control_net import ControlNet
from bezsoma.mesh.field import Field
from bezsoma.mesh.files import read_mesh, write_mesh
from bezsoma.mesh.tets import TetMesh
from bezsoma.mesh.topology import slices
from bezsoma.results.folder import FORMAT, SUMMARY

MESH = "mesh.npz"
DISPLACEMENT = "displacement.npz"
PRESSURE = "pressure.npz"
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
    pressure: Field | BrokenField | None = None
    """The pressure, MPa, where it was an unknown of its own."""

    @property
    def unfinished(self) -> str:
        """Empty for an answer; else what is to be said first: that it is none, at which load.

        `summary["unfinished"]` then has this `mark`, the `fraction` of the load that the state
        bears, and `why` the run came no further.
        """
        return str(self.summary.get("unfinished", {}).get("mark", ""))


def write_fields(
    folder: Path, displacement: Field, pressure: Field | BrokenField | None = None
) -> None:
    """Write `mesh.npz` and `displacement.npz` into a folder, and `pressure.npz` if there is one."""
    net = displacement.net
    write_mesh(folder / MESH, net.mesh)
    np.savez(
        folder / DISPLACEMENT,
        notice=np.str_(NOTICE),
        degree=np.int64(net.degree),
        of_tet=_of_tet(net),
        controls=displacement.controls,
    )
    if pressure is not None:
        stored: dict[str, Any] = {"degree": pressure.degree, "controls": pressure.controls}
        if isinstance(pressure, Field):
            stored["of_tet"] = pressure.net.of_tet
        np.savez_compressed(folder / PRESSURE, notice=np.str_(NOTICE), **stored)


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
    pressure = _pressure(folder / PRESSURE, mesh) if "pressure_degree" in summary else None
    return Results(folder, mesh, displacement, summary, _text(folder / CASE), pressure)


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
        raise InputError(
            f"{str(folder / SUMMARY)!r} is damaged ({error}); run the case again"
        ) from None
    given = summary.get("format") if isinstance(summary, dict) else None
    if given != FORMAT:
        raise InputError(
            f"{str(folder / SUMMARY)!r} is of the format {given!r}, and this version reads "
            f"{FORMAT!r}; run the case again"
        )
    return dict(summary)


def _displacement(path: Path, mesh: TetMesh) -> Field:
    """The field stored at `path`, on the net of `mesh`."""
    stored = _stored(path)
    return _continuous(path, mesh, (3,), *_named(path, stored, "degree", "controls", "of_tet"))


def _pressure(path: Path, mesh: TetMesh) -> Field | BrokenField:
    """The pressure stored at `path`, continuous or tet by tet."""
    stored = _stored(path)
    degree, controls, *_ = _named(path, stored, "degree", "controls")
    if "of_tet" in stored:
        return _continuous(path, mesh, (), degree, controls, stored["of_tet"])
    try:
        field = BrokenField(mesh, int(degree), controls)
    except InputError as error:
        raise InputError(f"{str(path)!r} does not fit the mesh beside it: {error}") from None
    _finite(path, controls)
    return field


def _stored(path: Path) -> dict[str, Any]:
    """The arrays of a file."""
    try:
        # Opened here, since numpy leaves a damaged file open.
        with path.open("rb") as stream, np.load(stream, allow_pickle=False) as stored:
            return {name: stored[name] for name in stored.files}
    except Exception as error:  # zip, zlib and NumPy each have their own ways to fail
        raise InputError(f"{str(path)!r} is damaged ({error}); run the case again") from error


def _named(path: Path, stored: dict[str, Any], *names: str) -> list[Any]:
    """Arrays that have to be there."""
    missing = [name for name in names if name not in stored]
    if missing:
        raise InputError(f"{str(path)!r} is damaged ({missing} missing); run the case again")
    return [stored[name] for name in names]


def _continuous(
    path: Path, mesh: TetMesh, shape: tuple[int, ...], degree: Any, controls: Floats, of_tet: Ints
) -> Field:
    """A continuous field with values of a shape, renumbered where need be."""
    try:
        net = ControlNet(mesh, int(degree))
    except InputError as error:
        raise InputError(f"{str(path)!r} is damaged ({error}); run the case again") from None
    numbered = np.array_equal(np.unique(of_tet), np.arange(net.count))
    if not numbered or of_tet.shape != net.of_tet.shape or controls.shape != (net.count, *shape):
        raise InputError(
            f"{str(path)!r} does not fit the mesh beside it: it holds controls of shape "
            f"{controls.shape} and tets of shape {of_tet.shape}, where degree {degree} on this "
            f"mesh has {(net.count, *shape)} and {net.of_tet.shape}; run the case again"
        )
    _finite(path, controls)
    return Field(net, _renumbered(controls, of_tet, net.of_tet))


def _finite(path: Path, controls: Floats) -> None:
    if not np.isfinite(controls).all():
        raise InputError(f"{str(path)!r} is damaged: a control is not a number; run it again")


def _renumbered(controls: Floats, stored: Ints, current: Ints) -> Floats:
    """The controls in the numbering of `current`, should another version have numbered the net."""
    if np.array_equal(stored, current):
        return controls
    moved = np.empty_like(controls)
    moved[current.ravel()] = controls[stored.ravel()]
    return moved
