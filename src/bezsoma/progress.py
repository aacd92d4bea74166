# SPDX-License-Identifier: BSD-3-Clause
"""What a run shows of itself: a moving bar on a terminal, plain lines elsewhere, or nothing."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import perf_counter

from rich.console import Console
from rich.progress import BarColumn, Progress, SpinnerColumn, TaskID, TextColumn, TimeElapsedColumn

Report = Callable[[str, float | None, str], None]
"""Called with a stage, how much of it is done (0 to 1, None where unknown) and a note."""

SECONDS_BETWEEN_LINES = 5.0


@contextmanager
def shown(*, quiet: bool) -> Iterator[Report]:
    """A function to report to; what it shows goes to stderr, so that stdout stays for answers."""
    console = Console(stderr=True, highlight=False)
    if quiet:
        yield lambda stage, fraction, note: None
    elif console.is_terminal:
        with _bars(console) as report:
            yield report
    else:
        yield _lines()


def _lines() -> Report:
    """One plain line for each stage, and now and then one from inside a long stage."""
    last_stage, last_time = "", float("-inf")

    def report(stage: str, fraction: float | None, note: str) -> None:
        nonlocal last_stage, last_time
        now = perf_counter()
        if stage == last_stage and now - last_time < SECONDS_BETWEEN_LINES:
            return
        last_stage, last_time = stage, now
        done = "" if fraction is None else f" {100 * fraction:.0f} %"
        print(f"{stage}{done}: {note}" if note else f"{stage}{done}", file=sys.stderr, flush=True)

    return report


@contextmanager
def _bars(console: Console) -> Iterator[Report]:
    """One line for each stage, the current one moving."""
    columns = (
        SpinnerColumn(finished_text="[green]ok[/green]"),
        TextColumn("{task.description:<12}"),
        BarColumn(bar_width=24),
        TimeElapsedColumn(),
        TextColumn("{task.fields[note]}", markup=False),
    )
    with Progress(*columns, console=console) as display:
        tasks: dict[str, TaskID] = {}

        def report(stage: str, fraction: float | None, note: str) -> None:
            if stage not in tasks:
                _finished(display, tasks)
                tasks[stage] = display.add_task(stage, total=None, note=note)
            display.update(tasks[stage], note=note)
            if fraction is not None:
                display.update(tasks[stage], total=1.0, completed=fraction)

        yield report
        _finished(display, tasks)


def _finished(display: Progress, tasks: dict[str, TaskID]) -> None:
    """Mark all stages so far as done."""
    for task in tasks.values():
        display.update(task, total=1.0, completed=1.0)
