# SPDX-License-Identifier: BSD-3-Clause
"""The body: a mesh with a degree, materials, supports, loads, and what holds where they meet."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields
from types import MappingProxyType
from typing import Any

import numpy as np

from bezsoma.errors import InputError, unknown
from bezsoma.mechanics.joins import Gap, Graded, Join, Precedence
from bezsoma.mechanics.laws import FunctionLaw, MixedLaw
from bezsoma.mechanics.loads import BodyForce, Load, PointForce, Pressure, Traction, load_checked
from bezsoma.mechanics.materials import LinearElastic, Material
from bezsoma.mechanics.meeting import joins_checked
from bezsoma.mechanics.pairs import pressure_degree_checked
from bezsoma.mechanics.supports import Support
from bezsoma.mesh.tets import TetMesh

HIGHEST_DEGREE = 10


@dataclass(frozen=True, eq=False)
class Body:
    """What is to be solved; mm, N, MPa, rad; nothing computed yet.

    `materials` is one material for all, or one for every region by name. `supports`, `loads` and
    `joins` are lists; the order of supports and loads does not matter. A body without supports
    may be stated; solving it is refused with the names of the motions that are left.

    With a `pressure_degree` the pressure is an unknown of its own, a continuous polynomial of that
    degree (the mixed form, which stays right up to nu = 1/2); `incompressible=True` chooses
    `degree - 1`, the best. With `pressure_breaks=True` it may jump between regions, as it does
    where materials change; within each region it is continuous.

    >>> from bezsoma.mesh.solids import block
    >>> water = LinearElastic(E=0.015, nu=0.5)
    >>> Body(block(), 3, water, [], incompressible=True).pressure_degree
    2
    """

    mesh: TetMesh
    degree: int
    materials: Material | Mapping[str, Material]
    supports: Sequence[Support]
    loads: Sequence[Load] = ()
    joins: Sequence[Join] = ()
    pressure_degree: int | None = None
    incompressible: bool = False
    pressure_breaks: bool = False

    def __post_init__(self) -> None:
        if not isinstance(self.mesh, TetMesh):
            raise InputError(f"mesh is {self.mesh!r}; a Body needs a TetMesh, as read_mesh gives")
        object.__setattr__(self, "degree", degree_checked(self.degree))
        object.__setattr__(self, "materials", materials_checked(self.materials, self.mesh))
        for name, kinds, example in _LISTS:
            listed = listed_checked(getattr(self, name), kinds, name, example)
            object.__setattr__(self, name, listed)
        for support in self.supports:
            places_checked(support.places, type(support).__name__, self.mesh)
        for load in self.loads:
            load_checked(load, self.mesh)
        joins_checked(self.joins, self.supports, self.mesh)
        object.__setattr__(self, "pressure_degree", _pressure_degree(self))
        _form_checked(self)

    def __reduce__(self) -> tuple[Any, ...]:
        """What pickle keeps; functions among supports, loads and laws have to be importable."""
        stated = {each.name: getattr(self, each.name) for each in fields(self)}
        if isinstance(self.materials, Mapping):
            stated["materials"] = dict(self.materials)
        return Body, tuple(stated.values())

    @property
    def mixed(self) -> bool:
        """Whether the pressure is an unknown of its own."""
        return self.pressure_degree is not None

    @property
    def material_of_region(self) -> tuple[Material, ...]:
        """The material of each region, in the order of `mesh.regions`."""
        if isinstance(self.materials, Mapping):
            return tuple(self.materials[region] for region in self.mesh.regions)
        return (self.materials,) * len(self.mesh.regions)


_LISTS: tuple[tuple[str, Any, str], ...] = (
    ("supports", Support, "[Fixed('skull'), Moved('jaw', translation=(0, -5, 0))]"),
    ("loads", Traction | Pressure | BodyForce | PointForce, "[Pressure('skin', value=0.001)]"),
    ("joins", Precedence | Graded | Gap, "[Graded(over='rami', to='jaw', band=5)]"),
)


def _pressure_degree(body: Body) -> int | None:
    """The degree of the pressure as stated or chosen; None where there is none."""
    for name in ("incompressible", "pressure_breaks"):
        if not isinstance(getattr(body, name), bool | np.bool_):
            raise InputError(f"{name} = {getattr(body, name)!r}: it is True or False")
        object.__setattr__(body, name, bool(getattr(body, name)))
    given = body.pressure_degree
    if given is None and body.incompressible:
        given = body.degree - 1
    if given is None:
        if body.pressure_breaks:
            raise InputError(
                "pressure_breaks = True, but there is no pressure: give pressure_degree=, or "
                "incompressible=True, which chooses one less than the degree"
            )
        return None
    return pressure_degree_checked(given, body.degree)


def _form_checked(body: Body) -> None:
    """Refuse a material that the displacement form, or the mixed one, cannot take."""
    for region, law in zip(body.mesh.regions, body.material_of_region, strict=True):
        if body.mixed and not (isinstance(law, LinearElastic) or _splits(law)):
            raise InputError(
                f"region {region!r} is {law!r}, which does not split into a shape and a volume and "
                "cannot stand beside a pressure; leave pressure_degree out, or take another law "
                "(Stiffening with measure='deviatoric', NeoHooke, MooneyRivlin, ...)"
            )
        if not body.mixed and _incompressible(law):
            raise InputError(
                f"region {region!r} has nu = 1/2: volume cannot change there, and the displacement "
                "alone does not give the stress; give the pressure a degree of its own, "
                f"{_with_pressure(body.degree)}, or take nu up to 0.49 or so"
            )


def _splits(law: Material) -> bool:
    """Whether a law has a form beside a pressure."""
    if isinstance(law, FunctionLaw):
        return law.kappa is not None
    return isinstance(law, MixedLaw) and getattr(law, "measure", "") != "energy"


def _incompressible(law: Material) -> bool:
    """Whether the displacement alone does not give the stress: nu = 1/2, or kappa = inf."""
    return getattr(law, "nu", 0.0) == 0.5 or getattr(law, "kappa", 0.0) == math.inf


def _with_pressure(degree: int) -> str:
    if degree == 1:
        return "Body(..., degree=2, incompressible=True) (degree 1 has no stable pressure)"
    return "Body(..., incompressible=True)"


def degree_checked(degree: Any) -> int:
    """The degree of the displacement as an int from 1 to 10."""
    if isinstance(degree, bool) or not isinstance(degree, int | np.integer):
        raise InputError(
            f"degree = {degree!r}: it must be a whole number from 1 to {HIGHEST_DEGREE}, as in "
            "degree=3"
        )
    if not 1 <= degree <= HIGHEST_DEGREE:
        raise InputError(
            f"degree = {degree}: degrees from 1 to {HIGHEST_DEGREE} are built; 2 or 3 serve most"
        )
    return int(degree)


def materials_checked(materials: Any, mesh: TetMesh) -> Material | Mapping[str, Material]:
    """The material, or a read-only copy of the materials of every region."""
    if not isinstance(materials, Mapping):
        return material_checked(materials, "materials")
    for name, material in materials.items():
        if name not in mesh.regions:
            raise InputError(f"materials: {unknown('region', name, mesh.regions, 'this mesh')}")
        material_checked(material, f"the material of region {name!r}")
    missing = [region for region in mesh.regions if region not in materials]
    if missing:
        raise InputError(
            f"materials: no material for {missing}; this mesh has the regions "
            f"{list(mesh.regions)}, each needs one (or give a single material for all)"
        )
    return MappingProxyType(dict(materials))


def material_checked(material: Any, what: str) -> Material:
    """The material, if it is one, such as LinearElastic(E=0.015, nu=0.45)."""
    if isinstance(material, type) or not isinstance(material, Material):
        raise InputError(
            f"{what}: {material!r} is no material; give LinearElastic(E=0.015, nu=0.45), or a "
            "dict from the name of each region to one"
        )
    return material


def listed_checked(listed: Any, kinds: Any, what: str, example: str) -> tuple[Any, ...]:
    """The list as a tuple, each entry of a kind that can stand there."""
    if isinstance(listed, str | Mapping) or not isinstance(listed, Iterable):
        raise InputError(f"{what} = {listed!r}: it must be a list, as in {what}={example}")
    entries = tuple(listed)
    for entry in entries:
        if isinstance(entry, type) or not isinstance(entry, kinds):
            raise InputError(f"{what}: {entry!r} cannot stand there; write {what}={example}")
    return entries


def places_checked(places: Iterable[str], of: str, mesh: TetMesh) -> None:
    """Check that the mesh has all these places."""
    for place in places:
        if place not in mesh.places:
            raise InputError(f"{of}: {unknown('place', place, mesh.places, 'this mesh')}")
