# SPDX-License-Identifier: BSD-3-Clause
"""Functions of position that a user hands in, and the one check of what they give back."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from bezsoma.arrays import Floats
from bezsoma.errors import InputError

Function = Callable[[Floats], Floats]
"""Points (p, 3) in mm -> values (p,) or (p, k)."""


def sampled(function: Function | Floats, points: Floats) -> Floats:
    """The values (p, ...) of a function in the points (p, 3), or the values as given; checked.

    >>> sampled(lambda x: x[:, 0] + 1, np.zeros((2, 3)))
    array([1., 1.])
    >>> sampled(lambda x: 1.0, np.zeros((2, 3)))
    Traceback (most recent call last):
        ...
    bezsoma.errors.InputError: the function gave values of shape () for 2 points; the first axis
    has to count the points
    """
    given = function(points) if callable(function) else function
    try:
        values = np.asarray(given, dtype=np.float64)
    except (TypeError, ValueError):
        raise InputError(
            f"{'the function gave' if callable(function) else 'as values was given'} a "
            f"{type(given).__name__} that is no array of numbers; {len(points)} values are needed, "
            "one for each point, or a function that gives them at points (p, 3) in mm"
        ) from None
    if values.shape[:1] != (len(points),):
        raise InputError(
            f"{'the function gave' if callable(function) else 'there are'} values of shape "
            f"{values.shape} for {len(points)} points; the first axis has to count the points"
        )
    bad = np.flatnonzero(~np.isfinite(values.reshape(len(points), -1)).all(axis=1))
    if len(bad):
        x, y, z = points[bad[0]]
        raise InputError(
            f"the value at ({x:g}, {y:g}, {z:g}) mm is not finite ({len(bad)} of {len(points)} "
            "such); it has to be a number everywhere it is asked for"
        )
    return values
