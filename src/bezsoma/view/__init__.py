# SPDX-License-Identifier: BSD-3-Clause
"""Pictures and files of fields and surfaces; nothing here knows how a field came about."""

from __future__ import annotations

from bezsoma.view.convergence import convergence_picture
from bezsoma.view.film import film
from bezsoma.view.history import history_picture
from bezsoma.view.picture import face_picture, picture, side_by_side
from bezsoma.view.shot import Shot
from bezsoma.view.tessellation import Tessellation, tessellation
from bezsoma.view.vtk import write_surface_vtu, write_vtu
from bezsoma.view.vtkhdf import write_vtkhdf
from bezsoma.view.window import show

__all__ = [
    "Shot",
    "Tessellation",
    "convergence_picture",
    "face_picture",
    "film",
    "history_picture",
    "picture",
    "show",
    "side_by_side",
    "tessellation",
    "write_surface_vtu",
    "write_vtkhdf",
    "write_vtu",
]
