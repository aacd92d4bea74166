# SPDX-License-Identifier: BSD-3-Clause
"""The Morton order: a walk through space that keeps what is near in space near in memory."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from bezsoma.arrays import Floats, Ints

BITS = 21
"""Bits an axis: 3 x 21 fill a 63-bit key, and 2^21 steps along the longest side are plenty."""

SPREAD = (
    (32, 0x1F00000000FFFF),
    (16, 0x1F0000FF0000FF),
    (8, 0x100F00F00F00F00F),
    (4, 0x10C30C30C30C30C3),
    (2, 0x1249249249249249),
)
"""Shift and mask of each step that pulls the bits of a number three places apart."""


def morton_keys(points: Floats) -> npt.NDArray[np.uint64]:
    """The Morton key of each of the points (p, 3), (p,): the bits of x, y and z interleaved.

    All axes share one scale, so that a cell of the walk is a cube.  Source: G. M. Morton, A
    computer oriented geodetic data base, IBM, Ottawa, 1966.

    The eight corners of a cube are walked in the order of the binary numbers z y x:

    >>> corners = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)
    >>> bool((np.diff(morton_keys(corners)) > 0).all())
    True
    """
    low = points.min(axis=0, initial=np.inf)
    side = float((points - low).max(initial=0.0))
    steps = (points - low) * ((2**BITS - 1) / side if side > 0 else 0.0)
    keys = np.zeros(len(points), dtype=np.uint64)
    for axis in range(3):
        bits = steps[:, axis].astype(np.uint64)
        for shift, mask in SPREAD:
            bits = (bits | (bits << np.uint64(shift))) & np.uint64(mask)
        keys |= bits << np.uint64(axis)
    return keys


def morton_order(points: Floats) -> Ints:
    """The numbers of the points (p, 3) in the order of the walk, (p,); ties keep their order."""
    return np.argsort(morton_keys(points), kind="stable").astype(np.int64, copy=False)
