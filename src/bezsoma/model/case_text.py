# SPDX-License-Identifier: BSD-3-Clause
"""The case of a model: the mandible moves forward, what borders on the skull stays."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from bezsoma.arrays import Floats
from bezsoma.mesh import TetMesh
from bezsoma.model.settings import ModelSettings

TEXT = """\
# Made from a CT by bezsoma model. Research software, not a medical device.
# mm, MPa; x to the patient's left, y to the back, z up. Change it, and: bezsoma run case.toml
title = "The mandible moves {forward:g} mm forward"
degree = {degree}

[mesh]
file = "mesh.npz"

[materials.tissue]
E = 0.015     # MPa: soft tissue of the face; of no account for how it moves
nu = 0.45

[[support]]   # bone that stays; the rest of the head holds nothing, since the cut is free: to hold
type = "fixed"  # it, write on = ["skull", "cut"], and a join where it meets the mandible
on = "skull"

[[support]]   # forward is -y; {free} free
type = "moved"
on = "mandible"
translation = [0, {back:g}, 0]

{join}{probes}[error]       # how far all is from the truth, mm; takes some times as long as solving
estimate = true

[output]
pictures = ["three-quarter", "front", "right"]
"""
JOIN = """\
[[join]]      # where mandible and skull still share a vertex, a strip of the skull is set free
type = "gap"
free = "skull"
at = "mandible"
width = {width:g}

"""
PROBE = """\
[[probe]]
name = "{name}"
point = [{x:.2f}, {y:.2f}, {z:.2f}]
on = "skin"

"""
NEAR = 3.0
"""mm: a landmark further outside the box of the mesh was cut off with its part of the head."""


def case_text(mesh: TetMesh, points: Mapping[str, Floats], settings: ModelSettings) -> str:
    """The text of case.toml for a mesh of `face_mesh` and points of its skin."""
    low, high = mesh.box
    seen = {
        name: point
        for name, point in points.items()
        if ((point > low - NEAR) & (point < high + NEAR)).all()
    }
    shared = np.intersect1d(mesh.vertices_of("mandible"), mesh.vertices_of("skull"))
    free = [name for name in mesh.surfaces if name not in ("skull", "mandible")]
    return TEXT.format(
        forward=settings.forward,
        back=0.0 - settings.forward,
        degree=settings.degree,
        free=" and ".join([", ".join(free[:-1]), free[-1]]) + (" are" if free[1:] else " is"),
        join=JOIN.format(width=max(settings.domain.apart, 1.0)) if len(shared) else "",
        probes="".join(
            PROBE.format(name=name, **dict(zip("xyz", point, strict=True)))
            for name, point in seen.items()
        ),
    )
