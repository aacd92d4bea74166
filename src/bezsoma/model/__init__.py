# SPDX-License-Identifier: BSD-3-Clause
"""From a CT to a model: labels, tets, pictures and a ready case, in a folder, stage by stage."""

from __future__ import annotations

from bezsoma.model.building import Model, run_model
from bezsoma.model.settings import ModelSettings, read_settings

__all__ = ["Model", "ModelSettings", "read_settings", "run_model"]
