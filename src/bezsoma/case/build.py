# SPDX-License-Identifier: BSD-3-Clause
"""From the tables of a case to the objects they speak of: supports, loads, joins, the body."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import singledispatch
from math import radians
from typing import Any

from bezsoma.case import schema
from bezsoma.case.advice import as_written
from bezsoma.case.faults import Fault
from bezsoma.case.lines import KeyPath
from bezsoma.case.reading import Case
from bezsoma.equations.locked import unlocked
from bezsoma.errors import InputError, unknown
from bezsoma.mechanics.body import Body
from bezsoma.mechanics.joins import Gap, Graded, Precedence
from bezsoma.mechanics.loads import BodyForce, PointForce, Pressure, Traction
from bezsoma.mechanics.polynomial import Polynomial
from bezsoma.mechanics.supports import Fixed, Moved, Prescribed
from bezsoma.mesh.tets import TetMesh


def body_of(case: Case, mesh: TetMesh, degree: int) -> Body:
    """The body of a case on its mesh, all names of which the mesh has (`names_missing`)."""
    file = case.file
    try:
        body = Body(
            mesh,
            degree=degree,
            materials={name: material.made() for name, material in file.materials.items()},
            supports=[made(table) for table in file.support],
            loads=[made(table) for table in file.load],
            joins=[made(table) for table in file.join],
            pressure_degree=file.pressure_degree,
            incompressible=file.incompressible,
            pressure_breaks=file.pressure_breaks,
        )
        return unlocked(body) if file.split_held_tets else body
    except InputError as error:
        raise InputError(f"{case.path.name}: {error}{as_written(str(error))}") from None


@singledispatch
def made(table: Any) -> Any:
    """The support, join or load that a table of the case describes."""
    raise TypeError(f"no object for {type(table).__name__}")


@made.register
def _fixed(table: schema.Fixed) -> Fixed:
    return Fixed(*table.on, components=table.components)


@made.register
def _moved(table: schema.Moved) -> Moved:
    return Moved(
        *table.on,
        translation=table.translation,
        axis=table.axis or (0.0, 0.0, 1.0),
        angle=radians(table.degrees),
        about=table.about or (0.0, 0.0, 0.0),
        components=table.components,
    )


@made.register
def _prescribed(table: schema.Prescribed) -> Prescribed:
    value = Polynomial.parse(table.value)
    return Prescribed(*table.on, value=value, components=table.components)


@made.register
def _precedence(table: schema.Precedence) -> Precedence:
    return Precedence(table.place, over=table.over)


@made.register
def _graded(table: schema.Graded) -> Graded:
    return Graded(over=table.over, to=table.to, band=table.band)


@made.register
def _gap(table: schema.Gap) -> Gap:
    return Gap(free=table.free, at=table.at, width=table.width)


@made.register
def _traction(table: schema.Traction) -> Traction:
    return Traction(*table.on, value=Polynomial.parse(table.value))


@made.register
def _pressure(table: schema.Pressure) -> Pressure:
    return Pressure(*table.on, value=Polynomial.parse(table.value), following=table.following)


@made.register
def _body_force(table: schema.BodyForce) -> BodyForce:
    return BodyForce(Polynomial.parse(table.value), regions=table.regions or ())


@made.register
def _point_force(table: schema.PointForce) -> PointForce:
    return PointForce(table.at, table.force)


def names_missing(case: Case, mesh: TetMesh) -> Iterator[Fault]:
    """Every name in the case that its mesh does not have."""
    known = {
        "place": mesh.places,
        "surface": tuple(mesh.surfaces),
        "vertex place": tuple(mesh.vertices),
        "region": mesh.regions,
    }
    for path, kind, name in _names_used(case.file):
        if name not in known[kind]:
            yield Fault(path, unknown(kind, name, known[kind], "this mesh"))
    for region in mesh.regions:
        if region not in case.file.materials:
            yield Fault(("materials",), f"no material for the region {region!r}; add it")


def _names_used(file: schema.CaseFile) -> Iterator[tuple[KeyPath, str, str]]:
    """Every name that must be one of the mesh's: its path, its kind, the name."""
    for number, support in enumerate(file.support):
        yield from _each(("support", number, "on"), "place", support.on)
    for number, join in enumerate(file.join):
        for key in ("place", "over", "to", "free", "at"):
            if (name := getattr(join, key, None)) is not None:
                yield ("join", number, key), "place", name
    for number, load in enumerate(file.load):
        if isinstance(load, schema.Traction | schema.Pressure):
            yield from _each(("load", number, "on"), "surface", load.on)
        elif isinstance(load, schema.BodyForce):
            yield from _each(("load", number, "regions"), "region", load.regions or ())
        elif isinstance(load.at, str):
            yield ("load", number, "at"), "vertex place", load.at
    for number, probe in enumerate(file.probe):
        if probe.on is not None:
            yield ("probe", number, "on"), "surface", probe.on
        if isinstance(probe.point, str):
            yield ("probe", number, "point"), "vertex place", probe.point
    if file.output.surface is not None:
        yield ("output", "surface"), "surface", file.output.surface
    for name in file.materials:
        yield ("materials", name), "region", name


def _each(path: KeyPath, kind: str, names: Iterable[str]) -> Iterator[tuple[KeyPath, str, str]]:
    for name in names:
        yield path, kind, name
