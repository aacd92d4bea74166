# SPDX-License-Identifier: BSD-3-Clause
"""How an iteration came to balance, as a picture."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby
from pathlib import Path
from typing import Protocol

import numpy as np

from bezsoma.errors import InputError
from bezsoma.view.sheet import Curve, chart, png
from bezsoma.view.written import written


class Iterated(Protocol):
    """One iteration of a nonlinear solve, as `Solution.path` and `NotConverged.path` have them."""

    @property
    def step(self) -> int:
        """The step of the load."""
        ...

    @property
    def fraction(self) -> float:
        """The part of the load that is tried."""
        ...

    @property
    def residual(self) -> float:
        """What is out of balance, relative."""
        ...

    @property
    def energy(self) -> float:
        """Its work on the correction, relative."""
        ...


def history_picture(
    path: str | Path | None,
    history: Sequence[Iterated],
    *,
    title: str = "Residual and energy, relative",
    size: tuple[int, int] = (1000, 700),
    overwrite: bool = False,
) -> bytes:
    r"""Residual and energy after each iteration as PNG, logarithmic; written if a path is given.

    `history` is `solution.path`, or that of a `NotConverged`. Stripes are tries of a part of the
    load, with its percentage above: where a percentage falls, a longer step had failed.

    >>> from types import SimpleNamespace as Each
    >>> path = [Each(step=1, fraction=1.0, residual=10.0**-k, energy=0.0) for k in (1, 2, 4, 8)]
    >>> history_picture(None, path)[:4]
    b'\x89PNG'
    """
    if not len(history):
        raise InputError(
            "there are no iterations to draw: a linear body, or one that nothing loads, is solved "
            "at once, and its path is empty; give the path of a body with a law or a pressure that "
            "is not linear"
        )
    if not all(hasattr(each, "residual") and hasattr(each, "energy") for each in history):
        raise InputError(
            f"history_picture() was given {history!r:.60}; it draws `path` of a Solution or of a "
            "NotConverged, which has the energy and the fraction of the load beside the residual"
        )
    curves = [
        Curve("residual", np.array([each.residual for each in history]), "#1f4e79"),
        Curve("energy", np.array([each.energy for each in history]), "#b3541e", dashed=True),
    ]
    figure = chart(curves, tries(history), "iteration", title, size)
    content = png(figure, title)
    if path is not None:
        written(path, content, overwrite)
    return content


def tries(history: Sequence[Iterated]) -> list[tuple[float, float, str]]:
    """From where to where each try of a part of the load goes, and its percentage.

    >>> from types import SimpleNamespace as Each
    >>> tries([Each(step=1, fraction=t) for t in (1.0, 1.0, 0.5)])
    [(0.5, 2.5, '100 %'), (2.5, 3.5, '50 %')]
    """
    found, start = [], 0.5
    for (_, fraction), group in groupby(history, key=lambda each: (each.step, each.fraction)):
        end = start + len(list(group))
        found.append((start, end, f"{100 * fraction:.3g} %"))
        start = end
    return found
