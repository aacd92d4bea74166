# SPDX-License-Identifier: BSD-3-Clause
"""Plants deliberate errors one by one and prints how many the tests notice: ./dev mutants."""

from __future__ import annotations

import argparse
import os
import queue
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from mutants import record, table
from mutants.mutant import Mutant
from mutants.planted import rounds
from mutants.workshop import Verdict, Workshop

PROJECT = Path(__file__).resolve().parent.parent.parent
ALL_PASSED, SOME_FAILED, INTERRUPTED = 0, 1, 2


def main() -> int:
    """Run the chosen errors; the status is 0 if every one is noticed."""
    options = arguments()
    chosen = [
        m for m in (table.IN_CI if options.ci else table.ALL) if options.only in m.what + m.file
    ]
    if options.rest:
        chosen = [m for m in chosen if not record.has(m)]
    if not chosen:
        raise SystemExit(f"no deliberate error speaks of {options.only!r}")
    with tempfile.TemporaryDirectory(prefix="bezsoma-mutants-") as scratch:
        noticed = in_python([m for m in chosen if not m.is_cpp], Path(scratch), options)
        noticed += in_the_core([m for m in chosen if m.is_cpp], Path(scratch) / "core", options)
    print(f"{sum(noticed)} of {len(noticed)} deliberate errors are noticed")
    if options.record:
        record.write_page()
    return 0 if all(noticed) else 1


def arguments() -> argparse.Namespace:
    """What was asked for."""
    parser = argparse.ArgumentParser(prog="./dev mutants", description=__doc__)
    parser.add_argument("--ci", action="store_true", help="a choice of them, in a few minutes")
    parser.add_argument("--only", default="", help="those whose description or file has this text")
    parser.add_argument("--rest", action="store_true", help="those without a recorded verdict")
    parser.add_argument("--record", action="store_true", help="record verdicts and write the page")
    cores = min(4, os.cpu_count() or 1)
    parser.add_argument("--jobs", type=int, default=cores, help="how many at once")
    return parser.parse_args()


def in_python(mutants: list[Mutant], scratch: Path, options: argparse.Namespace) -> list[bool]:
    """Errors in Python, several at once, each in a copy of the project."""
    if not mutants:
        return []
    shops: queue.Queue[Workshop] = queue.Queue()
    for number in range(options.jobs):
        shops.put(Workshop(PROJECT, scratch / str(number)))

    def noticed(mutant: Mutant) -> bool:
        shop, start = shops.get(), time.monotonic()
        try:
            with shop.harmed(mutant.file, mutant.old, mutant.new):
                verdict = shop.verdict(mutant.tests)
            sound = is_sound(shop, mutant, verdict)
        finally:
            shops.put(shop)
        return told(mutant, verdict, sound, time.monotonic() - start, options)

    with ThreadPoolExecutor(options.jobs) as pool:
        found = list(pool.map(noticed, mutants))
    while not shops.empty():
        shops.get().close()
    return found


def in_the_core(mutants: list[Mutant], scratch: Path, options: argparse.Namespace) -> list[bool]:
    """Errors in C++: as many as can be in one build, then those that need a build each."""
    if not mutants:
        return []
    shop, found = Workshop(PROJECT, scratch), list[bool]()
    for together in rounds(PROJECT, mutants):
        shop.plant(together)
        numbers = range(len(together))
        with ThreadPoolExecutor(options.jobs) as pool:
            found += pool.map(lambda m, n: chosen_in(shop, m, n, options), together, numbers)
    for mutant in mutants:
        if mutant.compiled:
            with shop.harmed(mutant.file, mutant.old, mutant.new):
                shop.plant([])
            start = time.monotonic()
            verdict = shop.verdict(mutant.tests)
            found.append(told(mutant, verdict, True, time.monotonic() - start, options))
    shop.close()
    return found


def chosen_in(shop: Workshop, mutant: Mutant, number: int, options: argparse.Namespace) -> bool:
    """Whether an error that stands in the built core is noticed when it is chosen."""
    start = time.monotonic()
    verdict = shop.verdict(mutant.tests, number)
    sound = is_sound(shop, mutant, verdict)
    return told(mutant, verdict, sound, time.monotonic() - start, options)


SOUND: set[tuple[str, ...]] = set()
"""Tests that are known to pass without any error."""


def is_sound(shop: Workshop, mutant: Mutant, verdict: Verdict) -> bool:
    """Whether what noticed an error passes without; otherwise its failing would mean nothing."""
    first = verdict.first_failure() or mutant.tests
    if verdict.status == ALL_PASSED or first in SOUND:
        return True
    if shop.verdict(first).status != ALL_PASSED:
        return False
    SOUND.add(first)
    return True


def told(
    mutant: Mutant, verdict: Verdict, sound: bool, seconds: float, options: argparse.Namespace
) -> bool:
    """Whether the tests noticed an error; says so in a line."""
    noticed = verdict.status in (SOME_FAILED, INTERRUPTED) or verdict.status < 0
    words = verdict.words if verdict.status >= 0 else f"signal {-verdict.status}"
    where = f"{seconds:.0f} s  {mutant.file}: {mutant.what}"
    if not sound or not (noticed or verdict.status == ALL_PASSED):
        print(f"NO VERDICT in {where}\n        fails without any error too: {words}", flush=True)
        return False
    by = words if noticed else f"none of {', '.join(mutant.tests)}"
    print(f"{'noticed' if noticed else 'MISSED'} in {where}\n        by {by}", flush=True)
    if options.record:
        record.add(mutant, words if noticed else None)
    return noticed


if __name__ == "__main__":
    sys.exit(main())
