# SPDX-License-Identifier: BSD-3-Clause
"""Planes to cut bodies with."""

from __future__ import annotations

import re
from dataclasses import dataclass
from math import isfinite

import numpy as np

from bezsoma.arrays import Floats
from bezsoma.errors import InputError

_AXES = "xyz"


@dataclass(frozen=True)
class Plane:
    """All points x with normal . x = offset, in mm; the normal is made a unit vector.

    >>> plane = Plane((0, 0, 2), 20.0)
    >>> plane, str(plane)
    (Plane(normal=(0.0, 0.0, 1.0), offset=10.0), 'z = 10 mm')
    >>> plane.heights(np.array([[5.0, 5, 12.5]])).tolist()
    [2.5]
    """

    normal: tuple[float, float, float]
    offset: float
    """Distance from the origin along the normal, mm."""

    def __post_init__(self) -> None:
        given = np.asarray(self.normal, float)
        length = float(np.linalg.norm(given)) if given.shape == (3,) else float("nan")
        if not (isfinite(length) and length > 0 and isfinite(self.offset)):
            raise InputError(
                f"normal {self.normal!r} and offset {self.offset!r} are no plane; give three "
                "numbers that are not all zero, and a number"
            )
        object.__setattr__(self, "normal", tuple((given / length).tolist()))
        object.__setattr__(self, "offset", float(self.offset) / length)

    @classmethod
    def of(cls, given: Plane | str) -> Plane:
        """The plane itself, or the one that a text such as `x=12.5` (mm) names.

        >>> Plane.of("y = -3").normal
        (0.0, 1.0, 0.0)
        """
        if isinstance(given, Plane):
            return given
        found = re.fullmatch(r"\s*([xyz])\s*=\s*([-+.\deE]+)\s*(?:mm)?\s*", str(given))
        try:
            offset = float(found[2]) if found else float("nan")
        except ValueError:
            offset = float("nan")
        if not found or not isfinite(offset):
            raise InputError(
                f"{given!r} is no plane; write x=12.5, y=-3 or z=0 (mm; x to the patient's left, "
                "y to the back, z up), or give Plane(normal, offset)"
            )
        axis = _AXES.index(found[1])
        return cls((float(axis == 0), float(axis == 1), float(axis == 2)), offset)

    def __str__(self) -> str:
        for axis, name in enumerate(_AXES):
            if abs(self.normal[axis]) == 1.0:
                return f"{name} = {self.offset * self.normal[axis]:g} mm"
        return f"normal ({', '.join(f'{n:.3g}' for n in self.normal)}), {self.offset:g} mm"

    def heights(self, points: Floats) -> Floats:
        """How far (...) points (..., 3) lie above the plane, to the side of the normal, in mm."""
        return np.asarray(points @ np.array(self.normal) - self.offset)
