# SPDX-License-Identifier: BSD-3-Clause
"""Pictures and files of fields and surfaces; nothing here knows how a field came about."""

from __future__ import annotations

from bezsoma.view.history import history_picture
from bezsoma.view.picture import face_picture, picture
from bezsoma.view.vtk import write_surface_vtu, write_vtu

__all__ = ["face_picture", "history_picture", "picture", "write_surface_vtu", "write_vtu"]
