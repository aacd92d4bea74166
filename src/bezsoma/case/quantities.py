# SPDX-License-Identifier: BSD-3-Clause
"""The numbers that a case may ask for by name, and how they are taken from a solution.

    energy                        stored energy, N mm
    volume_change                 integral of div u, mm3
    largest_displacement          largest length of the displacement, mm
    largest_divergence            largest |div u|, the volumetric strain of small strains
    largest_determinant           largest |det(I + grad u) - 1|, the local change of volume
    PROBE.x  .y  .z  .size        displacement of a probe, mm
    PROBE.stress.xx ... .zx       Cauchy stress at a probe, MPa; PROBE.von_mises likewise
    PROBE.strain.xx ... .zx       strain at a probe (half the engineering shears)
    PROBE.pressure                pressure there, MPa: of its own, else minus the mean stress
    reaction.PLACE.x ... .size    force of a support on the body, N
    moment.PLACE.x ... .size      its moment about the origin, N mm

Stress and strain jump between tets; at a probe they are read off the averaged field.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bezsoma.arrays import Floats
from bezsoma.case.faults import nearest
from bezsoma.mesh.field import Field
from bezsoma.solvers.solution import Solution

WHOLE = (
    "energy",
    "volume_change",
    "largest_displacement",
    "largest_divergence",
    "largest_determinant",
)
OF_PLACE = ("reaction", "moment")
AXES = ("x", "y", "z", "size")
TENSORS = ("stress", "strain")
ENTRIES = {"xx": (0, 0), "yy": (1, 1), "zz": (2, 2), "xy": (0, 1), "yz": (1, 2), "zx": (2, 0)}
OF_PROBE = (
    *AXES,
    "von_mises",
    "pressure",
    *(f"{tensor}.{entry}" for tensor in TENSORS for entry in ENTRIES),
)


def complaint(of: str, probes: Iterable[str], places: Iterable[str]) -> str | None:
    """What is wrong with the name of a quantity, or None.

    >>> complaint("chn.y", ["chin"], [])
    "no quantity 'chn.y' (did you mean 'chin.y'?)"
    >>> complaint("chin.von_mises", ["chin"], []) is None
    True
    """
    of_place = [f"{word}.{place}" for word in OF_PLACE for place in places]
    known = [*WHOLE, *(f"{place}.{axis}" for place in of_place for axis in AXES)]
    known += [f"{probe}.{detail}" for probe in probes for detail in OF_PROBE]
    return None if of in known else f"no quantity {of!r} {nearest(of, known)}"


@dataclass(frozen=True)
class Measured:
    """A solution and its probes (name -> point (3,), mm), asked for numbers by name."""

    solution: Solution
    probes: Mapping[str, Floats]

    def number(self, of: str) -> float:
        """The quantity of that name, which `complaint` has let pass."""
        subject, _, rest = of.partition(".")
        if of in WHOLE:
            return float(getattr(self.solution, of))
        if subject in OF_PLACE:
            place, _, axis = rest.rpartition(".")
            reaction = self.solution.reactions[place]
            return _along(reaction.force if subject == "reaction" else reaction.moment, axis)
        if rest in AXES:
            moved = self.solution.displacement.at(self._point(subject), outside="nearest")
            return _along(moved[0], rest)
        return self._of_tensor(subject, rest)

    def _of_tensor(self, probe: str, detail: str) -> float:
        """An entry of the stress or strain, or the von Mises stress, at a probe."""
        tensor, _, entry = detail.partition(".")
        pressure = self.solution.pressure
        if detail == "pressure" and pressure is not None:
            return float(pressure.at(self._point(probe), outside="nearest")[0])
        field = self._strain if tensor == "strain" else self._stress
        value = field.at(self._point(probe), outside="nearest").reshape(3, 3)
        if detail == "pressure":
            return -float(np.trace(value)) / 3
        if detail == "von_mises":
            deviator = value - np.trace(value) / 3 * np.eye(3)
            return float(np.sqrt(1.5 * (deviator**2).sum()))
        return float(value[ENTRIES[entry]])

    def _point(self, probe: str) -> Floats:
        return self.probes[probe][None]

    @cached_property
    def _stress(self) -> Field:
        return self.solution.stress.averaged()

    @cached_property
    def _strain(self) -> Field:
        return self.solution.strain.averaged()


def _along(vector: Floats, axis: str) -> float:
    """A component of a vector (3,), or its length."""
    if axis == "size":
        return float(np.linalg.norm(vector))
    return float(vector["xyz".index(axis)])
