# SPDX-License-Identifier: BSD-3-Clause
"""Every threshold and distance by which labels are found, with its default and its reason."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Literal

import numpy as np

from bezsoma.errors import InputError

Point = tuple[float, float, float]


@dataclass(frozen=True)
class LabelSettings:
    """How labels are found; HU and mm. Change one with `dataclasses.replace` or by its name."""

    skin: float = -500.0
    """HU: half-way between air (-1000) and skin (about 0)."""
    thin: float = 3.0
    """mm: what fits into no ball of this radius is no part of a head (head rest, wires, sheets)."""
    sealed: float = 5.0
    """mm: openings that a ball of this radius closes do not lead outside (nostrils, lips); 0: all
    do. A wide open mouth needs more, about half its height."""
    cavities: Literal["apart", "tissue"] = "apart"
    """Whether air inside the head has a label of its own or counts as soft tissue."""
    bone: float = 250.0
    """HU: what is denser is bone, before `halfway`."""
    soft: float = 40.0
    """HU: what surrounds bone; `halfway` lies between this and the bone nearby."""
    halfway: bool = True
    """Whether bone ends half-way between `soft` and the densest voxel nearby: at a threshold fixed
    for all, dense bone becomes too thick, and a higher one loses thin bone."""
    reach: float = 1.6
    """mm: how far nearby is."""
    fuller: float = 1.3
    """How many times denser than the densest voxel nearby bone may be, where that is less than the
    cortex of this head: a cortex no wider than a voxel fills none. 1: no denser."""
    plate: float = 2.0
    """mm: about how thick cortex is. Only voxels with a longer diagonal ask for `fuller`."""
    coarse: float = 1.5
    """mm: larger voxels are parted, values between them taken as linear, before bone is looked for:
    cortex and the gaps of joints are no wider than they are. Labels are those at their centres."""
    marrow: float = 80.0
    """mm2: smaller holes of bone in a slice are marrow or nerve canals, and count as bone."""
    cortex: float = 2.0
    """mm: gaps of the mandible's cortex that a ball of this radius closes keep its marrow in."""
    speck: float = 30.0
    """mm3: smaller pieces of bone are noise."""
    quiet: float = 30.0
    """HU: noise is smoothed until about this is left, where bone is looked for."""
    tissues: bool = False
    """Whether soft tissue is told apart into muscle, fat and the rest by their windows."""
    muscle: tuple[float, float] = (10.0, 150.0)
    """HU, from and to."""
    fat: tuple[float, float] = (-200.0, -30.0)
    """HU, from and to."""
    metal: float = 2900.0
    """HU: denser than teeth is metal, which draws streaks."""
    streaks: float = 20.0
    """mm3: with more metal than this inside the head, streaks are warned of."""
    mandible: bool = True
    """Whether the mandible is told apart from the other bones."""
    chin: Point | None = None
    """mm: a point in the bone of the chin, where the image alone does not lead to it."""
    skull: Point | None = None
    """mm: a point in the bone of the skull, likewise."""

    def __post_init__(self) -> None:
        for name in (
            "thin", "sealed", "marrow", "cortex", "plate", "speck", "reach", "quiet", "streaks"
        ):  # fmt: skip
            value = getattr(self, name)
            if not (np.isfinite(value) and 0 <= value <= 1000):
                raise InputError(f"{name}={value}: a number from 0 to 1000 is needed")
        if not 1 <= self.fuller <= 2:
            raise InputError(f"fuller={self.fuller}: 1 to 2 times as dense can be")
        if not 0.3 <= self.coarse <= 1000:
            raise InputError(f"coarse={self.coarse}: 0.3 to 1000 mm can be")
        if not -1000 < self.skin < self.bone < self.metal:
            raise InputError(
                f"skin {self.skin:g}, bone {self.bone:g} and metal {self.metal:g} HU have to rise "
                "from above -1000"
            )
        if not self.soft < self.bone:
            raise InputError(f"soft {self.soft:g} HU has to be below bone, {self.bone:g} HU")
        if self.cavities not in ("apart", "tissue"):
            raise InputError(f"cavities={self.cavities!r}: say 'apart' or 'tissue'")
        for name in ("muscle", "fat"):
            low, high = getattr(self, name)
            if not low < high:
                raise InputError(f"{name}={(low, high)} HU: from has to be below to")

    def stated(self) -> dict[str, object]:
        """Name and value of every setting, for reports.

        >>> LabelSettings().stated()["bone"]
        250.0
        """
        return {field.name: getattr(self, field.name) for field in fields(self)}
