# SPDX-License-Identifier: BSD-3-Clause
"""What the solver refuses, said to the person who wrote a case file.

The solver speaks of Python (`joins=[...]`, `Fixed`); whoever wrote TOML is told how the same is
written there.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager

from bezsoma.errors import InputError

JOIN = re.compile(r"joins=\[\.\.\.\].*?Precedence\('(?P<moved>.*?)', over='(?P<over>.*?)'\)")
"""The advice on two supports that collide, with the places it names."""
HOLD = "Hold (Fixed, Moved, Prescribed)"
"""The advice on rigid motions that are left."""
KEYS = {"incompressible=True": "incompressible = true", "unlocked(body)": "split_held_tets = true"}
"""Advice that is one key at the head of the file."""
ITERATION = re.compile(r"method='secant'.*ake (method=)?'newton'", re.DOTALL)
"""The advice on an iteration, whose key is another word in a case."""


@contextmanager
def in_case(name: str) -> Iterator[None]:
    """Whatever is refused inside names the case file, and says what to write into it.

    >>> with in_case("a.toml"):
    ...     raise InputError("nothing is held. Hold (Fixed, Moved, Prescribed) a surface")
    Traceback (most recent call last):
        ...
    bezsoma.errors.InputError: a.toml: nothing is held. Hold (Fixed, Moved, Prescribed) a surface; \
in the case file: [[support]] type = "fixed" on = "<place>" (each key on a line of its own)
    """
    try:
        yield
    except InputError as error:
        raise type(error)(f"{name}: {error}{as_written(str(error))}") from error


def as_written(message: str) -> str:
    """How what a message advises is written in a case file; nothing where it advises nothing.

    >>> as_written("method='secant' is for a displacement alone; take 'newton'")
    '; in the case file: iteration = "newton" in [solver]'
    """
    tables = ""
    if found := JOIN.search(message):
        a, b = found["moved"], found["over"]
        tables = (
            f'[[join]] type = "precedence" place = "{a}" over = "{b}", or '
            f'[[join]] type = "graded" over = "{b}" to = "{a}" band = <mm>, or '
            f'[[join]] type = "gap" free = "{b}" at = "{a}" width = <mm>'
        )
    elif HOLD in message:
        tables = '[[support]] type = "fixed" on = "<place>"'
    elif ITERATION.search(message):
        return '; in the case file: iteration = "newton" in [solver]'
    if tables:
        return f"; in the case file: {tables} (each key on a line of its own)"
    keys = [key for advice, key in KEYS.items() if advice in message]
    return f"; in the case file: {', '.join(keys)} beside degree" if keys else ""
