# SPDX-License-Identifier: BSD-3-Clause
"""How many threads the core is given."""

from __future__ import annotations

import numpy as np

from bezsoma.errors import InputError

MOST_THREADS = 1024


def thread_count(given: object, said: object = None, where: str = "threads") -> int:
    """The number given, 0 for all cores; what is none, or starts too many, is refused.

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
    return number
