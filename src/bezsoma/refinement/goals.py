# SPDX-License-Identifier: BSD-3-Clause
"""What a user wants to know of a displacement: its mean over a place, in one direction, mm.

A mean, not a value at a point: the dual of a value at a point is the displacement under a point
force, whose energy is infinite in three dimensions, so that no product of energies bounds the
error there. A mean over an area or a volume has a dual of finite energy.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from bezsoma.arrays import Floats, frozen
from bezsoma.errors import InputError, unknown
from bezsoma.mechanics.checks import number, numbers
from bezsoma.mesh.tets import TetMesh

POINT = (
    "the displacement at a point has no finite dual in 3-D (a force at a point has infinite "
    "energy), so nothing bounds its error; take the mean over a patch of a surface, "
    "PatchMean('skin', at=(x, y, z), radius=3, direction='y'), or around an inner point, "
    "InnerMean(at=(x, y, z), radius=3, direction='y')"
)


@dataclass(frozen=True, init=False, eq=False)
class PatchMean:
    """The mean of the displacement [mm] over a patch of a surface, in one direction.

    The patch is what is connected of the surface within `radius` [mm] of the point of it that is
    nearest to `at`. The mean is weighted by w(r) = (1 - r^2/radius^2)^2, which falls to zero at
    the rim: nothing there then jumps, and the mean does not feel how facets cut the rim.

    >>> PatchMean("skin", at=(0, 5, 1), radius=3, direction="y").direction.tolist()
    [0.0, 1.0, 0.0]
    """

    surface: str
    at: Floats
    radius: float
    direction: Floats

    def __init__(self, surface: str, *, at: Any, radius: Any, direction: Any) -> None:
        object.__setattr__(self, "surface", surface)
        object.__setattr__(self, "at", numbers(at, (3,), "the middle of PatchMean (mm)"))
        object.__setattr__(self, "radius", _radius(radius, "PatchMean"))
        object.__setattr__(self, "direction", unit(direction, "PatchMean"))


@dataclass(frozen=True, init=False, eq=False)
class SurfaceMean:
    """The mean of the displacement [mm] over a whole surface, in one direction.

    >>> SurfaceMean("top", direction=(0, 3, 4)).direction.tolist()
    [0.0, 0.6, 0.8]
    """

    surface: str
    direction: Floats

    def __init__(self, surface: str, *, direction: Any) -> None:
        object.__setattr__(self, "surface", surface)
        object.__setattr__(self, "direction", unit(direction, "SurfaceMean"))


@dataclass(frozen=True, init=False, eq=False)
class InnerMean:
    """The mean of the displacement [mm] around an inner point, in one direction.

    Over what of the body lies within `radius` [mm] of `at`, weighted as in `PatchMean`: the value
    at the point, mollified.

    >>> InnerMean(at=(0, 5, 1), radius=2, direction="z").radius
    2.0
    """

    at: Floats
    radius: float
    direction: Floats

    def __init__(self, *, at: Any, radius: Any, direction: Any) -> None:
        object.__setattr__(self, "at", numbers(at, (3,), "the middle of InnerMean (mm)"))
        object.__setattr__(self, "radius", _radius(radius, "InnerMean"))
        object.__setattr__(self, "direction", unit(direction, "InnerMean"))


Goal = PatchMean | SurfaceMean | InnerMean


def goal_checked(goal: Any, mesh: TetMesh) -> Goal:
    """The goal, if it is one and the mesh has its surface; a point is refused, saying why.

    >>> from bezsoma.mesh.solids import block
    >>> goal_checked((0.0, 0.0, 0.0), block())
    Traceback (most recent call last):
        ...
    bezsoma.errors.InputError: (0.0, 0.0, 0.0) is no goal: the displacement at a point has no
    finite dual in 3-D (a force at a point has infinite energy), so nothing bounds its error; take
    the mean over a patch of a surface, PatchMean('skin', at=(x, y, z), radius=3, direction='y'),
    or around an inner point, InnerMean(at=(x, y, z), radius=3, direction='y')
    """
    if not isinstance(goal, Goal):
        raise InputError(f"{goal!r} is no goal: {POINT}")
    if not isinstance(goal, InnerMean) and goal.surface not in mesh.surfaces:
        kind = type(goal).__name__
        raise InputError(f"{kind}: {unknown('surface', goal.surface, mesh.surfaces, 'this mesh')}")
    return goal


def unit(direction: Any, of: str) -> Floats:
    """The direction (3,) of length 1: an axis by its letter, or three numbers."""
    if isinstance(direction, str):
        if direction not in ("x", "y", "z"):
            raise InputError(
                f"direction={direction!r} of {of}: it is 'x', 'y', 'z' or three numbers"
            )
        return frozen(np.eye(3)["xyz".index(direction)])
    along = numbers(direction, (3,), f"the direction of {of}")
    size = float(np.linalg.norm(along))
    if size == 0:
        raise InputError(f"the direction of {of} is {along.tolist()}; it must point somewhere")
    return frozen(along / size)


def _radius(radius: Any, of: str) -> float:
    length = number(radius, f"the radius of {of} (mm)")
    if length <= 0:
        raise InputError(f"the radius of {of} is {length:g} mm, and it has to be above 0: {POINT}")
    return length
