# SPDX-License-Identifier: BSD-3-Clause
"""The array types that signatures speak of; shapes stand in the docstrings."""

from __future__ import annotations

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


def frozen(array: npt.NDArray[T]) -> npt.NDArray[T]:
    """The same array, made read-only: what frozen dataclasses hold and caches hand out."""
    array.flags.writeable = False
    return array


def plain(x: npt.ArrayLike) -> Floats:
    """The same numbers as the core takes them: float64, one after another in memory."""
    return np.ascontiguousarray(x, dtype=np.float64)
