# SPDX-License-Identifier: BSD-3-Clause
"""Wall and processor time since a start."""

from __future__ import annotations

from time import perf_counter, process_time


class Clock:
    """Started when made; `wall()` and `processor()` are seconds since then."""

    def __init__(self) -> None:
        self._wall, self._processor = perf_counter(), process_time()

    def wall(self) -> float:
        """Seconds on the wall."""
        return perf_counter() - self._wall

    def processor(self) -> float:
        """Seconds of all threads of this process."""
        return process_time() - self._processor
