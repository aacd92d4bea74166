# SPDX-License-Identifier: BSD-3-Clause
"""Tetrahedral meshes with named regions and places, control nets and fields on them."""

from __future__ import annotations

from bezsoma.mesh.broken_field import BrokenField
from bezsoma.mesh.control_net import ControlNet
from bezsoma.mesh.field import Field
from bezsoma.mesh.files import read_mesh, write_mesh
from bezsoma.mesh.locator import Locator
from bezsoma.mesh.solids import ball, block, cook, l_block, round_bar, shell, square_bar
from bezsoma.mesh.surface_field import SurfaceField
from bezsoma.mesh.tets import TetMesh

__all__ = [
    "BrokenField",
    "ControlNet",
    "Field",
    "Locator",
    "SurfaceField",
    "TetMesh",
    "ball",
    "block",
    "cook",
    "l_block",
    "read_mesh",
    "round_bar",
    "shell",
    "square_bar",
    "write_mesh",
]
