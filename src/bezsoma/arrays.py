# SPDX-License-Identifier: BSD-3-Clause
"""The array types that signatures speak of; shapes stand in the docstrings."""

from __future__ import annotations

import math
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

T = TypeVar("T", bound=np.generic)
Floats = npt.NDArray[np.float64]
Singles = npt.NDArray[np.float32]
Ints = npt.NDArray[np.int64]
Int32s = npt.NDArray[np.int32]
Bools = npt.NDArray[np.bool_]
Numbers = npt.NDArray[Any]
"""float64, or objects such as `fractions.Fraction` where a function is also exact."""

LINE = 64
"""Bytes of a line of the cache."""


def frozen(array: npt.NDArray[T]) -> npt.NDArray[T]:
    """The same array, made read-only: what frozen dataclasses hold and caches hand out."""
    array.flags.writeable = False
    return array


def plain(x: npt.ArrayLike) -> Floats:
    """The same numbers as the core takes them: float64, one after another in memory."""
    return np.ascontiguousarray(x, dtype=np.float64)


def on_lines(shape: tuple[int, ...], dtype: npt.DTypeLike = np.float64) -> npt.NDArray[Any]:
    """An array with numbers not yet set that begins where a line of the cache does, 64 bytes.

    Rows of eight float64, one for each of eight right-hand sides, then are a line each:

    >>> on_lines((5, 3, 8)).ctypes.data % 64
    0
    """
    size = math.prod(shape) * np.dtype(dtype).itemsize
    room = np.empty(size + LINE - 1, np.uint8)
    begin = -room.ctypes.data % LINE
    return room[begin : begin + size].view(dtype).reshape(shape)
