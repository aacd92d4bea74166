# SPDX-License-Identifier: BSD-3-Clause
"""A case as a file: TOML, checked whole before any work, to objects, to a results folder."""

from __future__ import annotations

from bezsoma.case.reading import Case, read_case
from bezsoma.case.running import run_case

__all__ = ["Case", "read_case", "run_case"]
