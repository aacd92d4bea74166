# SPDX-License-Identifier: BSD-3-Clause
"""From equations to fields: one solve(), a direct method and an iterative one behind it."""

from __future__ import annotations

from bezsoma.solvers.solution import Reaction, Solution
from bezsoma.solvers.solve import solve

__all__ = ["Reaction", "Solution", "solve"]
