# SPDX-License-Identifier: BSD-3-Clause
"""Tetrahedral meshes with named regions and places, control nets and fields on them."""

from __future__ import annotations

from bezsoma.mesh.broken_field import BrokenField
from bezsoma.mesh.control_net import ControlNet
from bezsoma.mesh.field import Field
from bezsoma.mesh.files import read_mesh, write_mesh
from bezsoma.mesh.isolines import Isolines, isolines
from bezsoma.mesh.levels import Level, contour, slice_of
from bezsoma.mesh.lines import Line, line_through
from bezsoma.mesh.locator import Locator
from bezsoma.mesh.planes import Plane
from bezsoma.mesh.solids import ball, block, cook, l_block, round_bar, shell, square_bar
from bezsoma.mesh.subdivision import Subdivision, subdivision
from bezsoma.mesh.surface_field import SurfaceField
from bezsoma.mesh.tets import TetMesh

__all__ = [
    "BrokenField",
    "ControlNet",
    "Field",
    "Isolines",
    "Level",
    "Line",
    "Locator",
    "Plane",
    "Subdivision",
    "SurfaceField",
    "TetMesh",
    "ball",
    "block",
    "contour",
    "cook",
    "isolines",
    "l_block",
    "line_through",
    "read_mesh",
    "round_bar",
    "shell",
    "slice_of",
    "square_bar",
    "subdivision",
    "write_mesh",
]
