# SPDX-License-Identifier: BSD-3-Clause
"""Errors over unknowns or seconds, as a picture with both axes logarithmic."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from bezsoma.arrays import Floats
from bezsoma.errors import InputError
from bezsoma.view.sheet import Curve, chart, png
from bezsoma.view.written import written

_COLOURS = ("#1f4e79", "#b3541e", "#3b7d3a", "#7a1f5c", "#5b5b5b", "#0f8b8d")


def convergence_picture(
    path: str | Path | None,
    rows: Mapping[str, Sequence[tuple[float, float]]],
    *,
    across: str = "unknowns",
    up: str = "error",
    title: str = "Convergence",
    size: tuple[int, int] = (1000, 760),
    overwrite: bool = False,
) -> bytes:
    r"""Curves of an error over unknowns, or over seconds, as PNG; written if a path is given.

    `rows` has for each name its pairs (unknowns, error), both positive, in any order. The legend
    says how each curve falls: the slope of the straight line through its last three points.

    >>> picture = convergence_picture(None, {"k = 2": [(n, n**-0.5) for n in (1e3, 1e4, 1e5)]})
    >>> picture[:4]
    b'\x89PNG'
    """
    if not rows or len(rows) > len(_COLOURS):
        raise InputError(f"{len(rows)} curves were given; 1 to {len(_COLOURS)} can be told apart")
    curves = []
    for (name, pairs), colour in zip(rows.items(), _COLOURS, strict=False):
        points = _points(name, pairs)
        label = name if len(points) < 2 else f"{name}  (slope {slope(points):.2f})"
        curves.append(Curve(label, points[:, 1], colour, over=points[:, 0]))
    content = png(chart(curves, (), across, title, size, up), title)
    if path is not None:
        written(path, content, overwrite)
    return content


def slope(points: Floats) -> float:
    """The slope of log error over log unknowns, by least squares over the last three (n, 2).

    >>> round(slope(np.array([[1e2, 5.0], [1e3, 1.0], [1e4, 0.1], [1e5, 0.01]])), 12)
    -1.0
    """
    x, y = np.log(points[-3:]).T
    return float(np.polyfit(x, y, 1)[0])


def _points(name: str, pairs: Sequence[tuple[float, float]]) -> Floats:
    """The pairs (n, 2) in ascending order, checked."""
    points = np.asarray(pairs, float)
    if points.ndim != 2 or points.shape[1:] != (2,) or not len(points):
        raise InputError(f"the curve {name!r} is no list of pairs (unknowns, error)")
    if not (np.isfinite(points).all() and (points > 0).all()):
        raise InputError(
            f"the curve {name!r} has numbers that are not positive, which logarithmic axes cannot "
            "show; leave them out"
        )
    return np.asarray(points[np.argsort(points[:, 0], kind="stable")])
