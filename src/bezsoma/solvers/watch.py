# SPDX-License-Identifier: BSD-3-Clause
"""How a solve is watched: seconds by stage, progress, and numbers that leave their range."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from time import perf_counter

import numpy as np

from bezsoma.arrays import Floats
from bezsoma.errors import InputError
from bezsoma.solvers.krylov import Report

Progress = Callable[[str, float | None, str], None]
"""Called with a stage, how much of it is done (0 to 1, None where unknown) and a note."""


@dataclass
class Watch:
    """Seconds by stage, and whom to tell."""

    progress: Progress | None
    timings: dict[str, float] = field(default_factory=dict)

    @contextmanager
    def stage(self, name: str, note: str) -> Iterator[None]:
        """Time what is done inside, on top of what the stage took before, after telling of it."""
        start = perf_counter()
        self.tell(name, None, note)
        try:
            yield
        finally:
            self.timings[name] = self.timings.get(name, 0.0) + perf_counter() - start

    def tell(self, name: str, fraction: float | None, note: str) -> None:
        """Tell of a stage, how much of it is done and a note, whoever listens."""
        if self.progress:
            self.progress(name, fraction, note)

    def iterations(self, rtol: float) -> Report:
        """What tells of iterations: how far the residual has come, on a scale of its logarithm."""

        def report(iteration: int, residual: float) -> None:
            far = 1.0 if residual == 0 else math.log(residual) / math.log(rtol)
            note = f"iteration {iteration}, residual {residual:.1e}"
            self.tell("solving", min(max(far, 0.0), 1.0), note)

        return report

    def factorisation(self, seconds: float) -> None:
        """Tell that SuperLU, which does not say how far it is, is still at work."""
        self.tell("solving", None, f"factoring, {seconds:.0f} s so far")


def in_range(numbers: Floats, what: str) -> None:
    """Raise an InputError where numbers overflowed."""
    if not np.isfinite(numbers).all():
        raise InputError(
            f"{what} leave the range of floating-point numbers; check the units of E (MPa), of the "
            "loads (N) and of the mesh (mm)"
        )
