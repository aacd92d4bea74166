# SPDX-License-Identifier: BSD-3-Clause
"""One module for each engine that is measured.

Each offers three functions:

    configurations(degree, unknowns) -> names of the ways that are worth a try, {} where none
    prepared(tets, degree)           -> the mesh in the engine's own form; not counted as a solve
    solved(mesh, degree, configuration, threads, tolerance) -> Answer

and is imported by name in the process of one run only, so that no engine carries another along.
"""

from __future__ import annotations

from dataclasses import dataclass

NAMES = ("bezsoma", "ngsolve", "skfem", "felupe")
"""Modules here that end in _engine; the first is what the others are compared with."""


@dataclass(frozen=True)
class Answer:
    """What a run says of itself; seconds of wall time, N mm."""

    unknowns: int
    setting_up: float
    solving: float
    processor: float
    """Seconds that all threads of the process together were at work, set-up and solve."""
    iterations: int
    residual: float
    """Formed anew from the engine's own matrix or operator, after the clock was stopped."""
    energy: float
    """Stored energy; half the work of the load, for all displacements prescribed are zero."""

    @property
    def together(self) -> float:
        """Seconds of set-up and solve."""
        return self.setting_up + self.solving
