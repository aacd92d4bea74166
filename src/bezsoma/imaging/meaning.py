# SPDX-License-Identifier: BSD-3-Clause
"""What the numbers in a label map mean."""

from __future__ import annotations

from types import MappingProxyType

AIR, SOFT, BONE, MANDIBLE, CAVITY, MUSCLE, FAT = range(7)
NAMES = MappingProxyType({
    AIR: "air", SOFT: "soft tissue", BONE: "bone", MANDIBLE: "mandible", CAVITY: "cavity",
    MUSCLE: "muscle", FAT: "fat",
})  # fmt: skip
"""bone is the skull and whatever else is not the mandible; cavity is air inside the head."""
COLOURS = MappingProxyType({
    SOFT: (0.93, 0.62, 0.52), BONE: (0.97, 0.93, 0.80), MANDIBLE: (0.25, 0.55, 0.95),
    CAVITY: (0.35, 0.80, 0.75), MUSCLE: (0.72, 0.22, 0.24), FAT: (0.98, 0.85, 0.35),
})  # fmt: skip
"""Red, green, blue from 0 to 1, for pictures and for 3D Slicer."""
