# SPDX-License-Identifier: BSD-3-Clause
"""How many threads the core is given."""

from __future__ import annotations

import math
import os
from functools import cache
from pathlib import Path

import numpy as np

from bezsoma.control_groups import groups
from bezsoma.errors import InputError

MOST_THREADS = 1024


def cores() -> int:
    """How many cores this process may use: those it may run on, in the time its groups give it.

    A container with a quota of two and a half cores has three.
    """
    mine = os.cpu_count() or 1
    if hasattr(os, "sched_getaffinity"):
        mine = len(os.sched_getaffinity(0))
    return max(1, min(mine, quota()))


@cache
def quota() -> int:
    """How many cores the control groups give this process time for; asked once, since it is slow.

    1024 where they do not limit it.
    """
    given = [time for folder in groups("cpu") if (time := _quota(folder)) is not None]
    return math.ceil(min(given, default=MOST_THREADS))


def _quota(folder: Path) -> float | None:
    """How many cores' time one group gives; None where it does not limit it."""
    for files in (("cpu.max",), ("cpu.cfs_quota_us", "cpu.cfs_period_us")):  # of version 2 and 1
        try:
            given, period = " ".join((folder / file).read_text() for file in files).split()
            if int(given) > 0 and int(period) > 0:  # -1 where there is none in version 1
                return int(given) / int(period)
        except (OSError, ValueError):  # not there, or "max"
            continue
    return None


def thread_count(given: object, said: object = None, where: str = "threads") -> int:
    """The number given, that of all `cores` for 0; what is none, or starts too many, is refused.

    A message shows what was `said`, where that is not the number itself.

    >>> thread_count(np.int64(2))
    2
    >>> thread_count(10**6)
    Traceback (most recent call last):
    bezsoma.errors.InputError: threads = 1000000 is no number of threads: give 1 to 1024, or 0 for
    all cores
    """
    # A bool is an int to Python, and True threads are hardly what was meant.
    number = -1
    if isinstance(given, int | np.integer) and not isinstance(given, bool):
        number = int(given)
    if not 0 <= number <= MOST_THREADS:
        raise InputError(
            f"{where} = {(given if said is None else said)!r} is no number of threads: give 1 to "
            f"{MOST_THREADS}, or 0 for all cores"
        )
    return number or cores()
