# SPDX-License-Identifier: BSD-3-Clause
"""Plain input taken apart once: numbers, vectors and names, each refusal said in full."""

from __future__ import annotations

from typing import Any

import numpy as np

from bezsoma.arrays import Floats, frozen
from bezsoma.errors import InputError


def number(value: Any, what: str) -> float:
    """A finite float from a plain number; text, truth values and arrays are refused.

    >>> number(np.float32(0.5), "a width")
    0.5
    """
    return float(numbers(value, (), what))


def numbers(value: Any, shape: tuple[int, ...], what: str) -> Floats:
    """A finite read-only array of that shape; the message says what was given and what can be.

    >>> numbers((0, -5, 0), (3,), "a translation").tolist()
    [0.0, -5.0, 0.0]
    """
    needed = ("one number", f"{shape[0] if shape else 1} numbers")[len(shape) > 0]
    if len(shape) > 1:
        needed = f"{' x '.join(map(str, shape))} numbers"
    if isinstance(value, str) or (
        isinstance(value, list | tuple) and any(isinstance(each, str) for each in value)
    ):
        raise InputError(
            f"{what} is {value!r}, which is text; {needed} can stand here (a formula, where one "
            "is allowed, goes through Polynomial.parse)"
        )
    try:
        array = np.array(value)
    except (TypeError, ValueError):
        array = np.array(None)
    if array.dtype.kind not in "iuf" or array.shape != shape:
        raise InputError(f"{what} is {value!r}; it must be {needed}")
    array = array.astype(float)
    if not np.isfinite(array).all():
        raise InputError(f"{what} is {array.tolist()!r}; it must be finite")
    return frozen(array)


def names(given: tuple[Any, ...], of: str) -> tuple[str, ...]:
    """The names of places as given to `of`, at least one, each a string.

    >>> names(("skull", "rami"), "Fixed")
    ('skull', 'rami')
    """
    if not given:
        raise InputError(f"{of} names no place; name at least one, as in {of}('skull', ...)")
    for each in given:
        if not isinstance(each, str):
            raise InputError(
                f"{of} was given {each!r} where the name of a place stands; write names one after "
                f"the other, as in {of}('skull', 'rami', ...), and everything else by keyword"
            )
        if given.count(each) > 1:
            raise InputError(
                f"{of} names {each!r} {given.count(each)} times; a load would act as often, so "
                "name each place once"
            )
    return given
