# SPDX-License-Identifier: BSD-3-Clause
"""What pushes and pulls: tractions and pressures [MPa], body forces [N/mm3], point forces [N]."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from bezsoma.arrays import Floats
from bezsoma.errors import InputError, unknown
from bezsoma.mechanics.checks import names, numbers
from bezsoma.mechanics.values import Given, Value, as_called, given
from bezsoma.mesh.tets import TetMesh
from bezsoma.mesh.topology import numbers as row_numbers

HIGHEST_EXACTNESS = 40


@dataclass(frozen=True, init=False, eq=False)
class Traction:
    """Force on the undeformed area of surfaces [MPa]: three numbers, a polynomial or a function.

    Constants and polynomials are integrated exactly. For functions the quadrature is exact for
    polynomials of degree `exactness` (load times Bernstein polynomial), by default 2 n + 2 for
    a body of degree n. Loads on the same surface add up; a part of a load that acts where the
    same component is supported goes into the reaction of that support.

    >>> Traction("top", value=(0, 0, -0.5)).value(np.zeros((1, 3))).tolist()
    [[0.0, 0.0, -0.5]]
    """

    surfaces: tuple[str, ...]
    value: Given
    exactness: int | None = None

    def __init__(self, *surfaces: str, value: Value | Given, exactness: int | None = None) -> None:
        object.__setattr__(self, "surfaces", names(surfaces, "Traction"))
        what = f"the traction on {', '.join(map(repr, surfaces))} (MPa)"
        object.__setattr__(self, "value", given(value, 3, what))
        object.__setattr__(self, "exactness", exactness_checked(exactness, "Traction"))

    def __repr__(self) -> str:
        return as_called("Traction", *self.surfaces, value=self.value, exactness=self.exactness)


@dataclass(frozen=True, init=False, eq=False)
class Pressure:
    """Pressure p on surfaces [MPa], traction t = -p n with n outward: positive pushes inward.

    One number, a polynomial of one component, or a function giving (p,) or (p, 1), of the point
    before it moved. The normal and the area are those of the flat facets before the deformation;
    with following=True they are those of the deformed surface, as of a fluid that pushes: the
    load then depends on the displacement, and `solve` iterates.

    >>> Pressure("inner", value=0.01).surfaces
    ('inner',)
    """

    surfaces: tuple[str, ...]
    value: Given
    exactness: int | None = None
    following: bool = False

    def __init__(
        self,
        *surfaces: str,
        value: Value | Given,
        exactness: int | None = None,
        following: bool = False,
    ) -> None:
        object.__setattr__(self, "surfaces", names(surfaces, "Pressure"))
        what = f"the pressure on {', '.join(map(repr, surfaces))} (MPa)"
        object.__setattr__(self, "value", given(value, 1, what))
        object.__setattr__(self, "exactness", exactness_checked(exactness, "Pressure"))
        if not isinstance(following, bool):
            raise InputError(f"following={following!r} of Pressure: it must be True or False")
        object.__setattr__(self, "following", following)

    def __repr__(self) -> str:
        following = True if self.following else None
        stated = {"exactness": self.exactness, "following": following}
        return as_called("Pressure", *self.surfaces, value=self.value, **stated)


@dataclass(frozen=True, init=False, eq=False)
class BodyForce:
    """Force on the volume [N/mm3] of some regions, or of all when none is named.

    Weight is density times 9.81 m/s2: tissue of 1.05 g/cm3 weighs 1.03e-5 N/mm3.

    >>> BodyForce((0, 0, -1.03e-5)).regions
    ()
    """

    value: Given
    regions: tuple[str, ...] = ()
    exactness: int | None = None

    def __init__(
        self,
        value: Value | Given,
        regions: Sequence[str] = (),
        exactness: int | None = None,
    ) -> None:
        if isinstance(regions, str) or not all(isinstance(each, str) for each in regions):
            raise InputError(
                f"regions={regions!r} of BodyForce must be a list of names of regions; leave it "
                "out for all of them"
            )
        object.__setattr__(self, "value", given(value, 3, "the body force (N/mm3)"))
        object.__setattr__(self, "regions", tuple(regions))
        object.__setattr__(self, "exactness", exactness_checked(exactness, "BodyForce"))


@dataclass(frozen=True, init=False, eq=False)
class PointForce:
    """A force [N] at one vertex, given by the name of its place or by its coordinates [mm].

    Beware: the displacement under a point force grows without bound as the mesh or the degree
    is refined. It serves to reproduce others; spread a real force over a patch with `Traction`.

    >>> PointForce("tip", (0, 0, -1)).force.tolist()
    [0.0, 0.0, -1.0]
    """

    at: str | Floats
    force: Floats

    def __init__(self, at: Any, force: Any) -> None:
        if not isinstance(at, str):
            at = numbers(at, (3,), "the point of PointForce (mm)")
        object.__setattr__(self, "at", at)
        object.__setattr__(self, "force", numbers(force, (3,), "the force of PointForce (N)"))


Load = Traction | Pressure | BodyForce | PointForce


def exactness_checked(exactness: Any, of: str) -> int | None:
    """The exactness of quadrature as given: None, or a whole number from 0 to 40."""
    if exactness is None:
        return None
    if (
        isinstance(exactness, bool)
        or not isinstance(exactness, int | np.integer)
        or not 0 <= exactness <= HIGHEST_EXACTNESS
    ):
        raise InputError(
            f"exactness={exactness!r} of {of}: it must be a whole number from 0 to "
            f"{HIGHEST_EXACTNESS}, the degree up to which the quadrature is exact"
        )
    return int(exactness)


def load_checked(load: Load, mesh: TetMesh) -> None:
    """Check that a load finds its surfaces, regions or vertex."""
    if isinstance(load, BodyForce):
        for region in load.regions:
            if region not in mesh.regions:
                raise InputError(
                    f"BodyForce: {unknown('region', region, mesh.regions, 'this mesh')}"
                )
    elif isinstance(load, PointForce):
        vertex_of(load, mesh)
    else:
        for name in load.surfaces:
            surface_checked(name, load, mesh)


def surface_checked(name: str, load: Traction | Pressure, mesh: TetMesh) -> None:
    """Check that a name is a surface, for pressures one with an outward side."""
    kind = type(load).__name__
    if name not in mesh.surfaces:
        raise InputError(f"{kind}: {unknown('surface', name, mesh.surfaces, 'this mesh')}")
    if isinstance(load, Pressure):
        inner = row_numbers(mesh.facets_of(name), mesh.boundary) < 0
        if inner.any():
            raise InputError(
                f"Pressure on {name!r}: {int(inner.sum())} of its {len(inner)} facets lie inside "
                "the body and have no outward side; give a Traction there instead"
            )


def vertex_of(load: PointForce, mesh: TetMesh) -> int:
    """The vertex of a point force; coordinates must meet one to 1e-9 of the mesh's size."""
    if isinstance(load.at, str):
        if load.at not in mesh.vertices:
            raise InputError(
                f"PointForce: {unknown('vertex place', load.at, mesh.vertices, 'this mesh')}; a "
                "point force acts at one named vertex or at the coordinates of one"
            )
        vertices = mesh.vertices[load.at]
        if len(vertices) != 1:
            raise InputError(
                f"PointForce: the place {load.at!r} holds {len(vertices)} vertices; a point force "
                "acts at one: give its coordinates, one PointForce for each"
            )
        return int(vertices[0])
    distances = np.linalg.norm(mesh.points - load.at, axis=1)
    nearest = int(distances.argmin())
    if distances[nearest] > 1e-9 * float(np.ptp(mesh.points, axis=0).max()):
        raise InputError(
            f"PointForce: no vertex of this mesh lies at {load.at.tolist()} mm; the nearest is "
            f"{mesh.points[nearest].tolist()}, {distances[nearest]:.3g} mm away: give that one, "
            "or spread the force over a surface with Traction"
        )
    return nearest
