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
ALL_PASSED, SOME_FAILED, INTERRUPTED, NOTHING_LEFT = 0, 1, 2, 5
WITHOUT_KERNELS = "lacks the kernels of that degree"


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
            believe(shop, mutant, verdict)
        finally:
            shops.put(shop)
        return told(mutant, verdict, time.monotonic() - start, options)

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
            found += pool.map(lambda m, n: planted(shop, m, n, options), together, numbers)
    for mutant in mutants:
        if mutant.compiled:
            with shop.harmed(mutant.file, mutant.old, mutant.new):
                shop.plant([])
            found.append(planted(shop, mutant, -1, options))
    shop.close()
    return found


def planted(shop: Workshop, mutant: Mutant, number: int, options: argparse.Namespace) -> bool:
    """Whether an error that stands in the built core is noticed.

    What asks for kernels that are not built is left out, and asked again without.
    """
    start = time.monotonic()
    while True:
        left_out = [f"--deselect={test}" for test in sorted(WITHOUT)]
        verdict = shop.verdict((*mutant.tests, *left_out), number)
        lacking = {t for t, why in verdict.failures().items() if WITHOUT_KERNELS in why}
        if not lacking:
            break
        WITHOUT.update(lacking)
    if number >= 0:
        believe(shop, mutant, verdict)
    return told(mutant, verdict, time.monotonic() - start, options)


WITHOUT: set[str] = set()
"""Tests that need kernels that are not built for errors."""
SOUND: set[tuple[str, ...]] = set()
"""Tests that are known to pass without any error."""


def believe(shop: Workshop, mutant: Mutant, verdict: Verdict) -> None:
    """Check that what noticed an error passes without; otherwise its failing would mean nothing."""
    if verdict.status == ALL_PASSED:
        return
    first = tuple(verdict.failures())[:1] or mutant.tests
    if first in SOUND:
        return
    left_out = [f"--deselect={test}" for test in sorted(WITHOUT)]
    without = shop.verdict((*first, *left_out))
    if without.status != ALL_PASSED:
        raise SystemExit(f"the tests fail without any deliberate error: {without.words}")
    SOUND.add(first)


def told(mutant: Mutant, verdict: Verdict, seconds: float, options: argparse.Namespace) -> bool:
    """Whether the tests noticed an error; says so in a line."""
    noticed = verdict.status in (SOME_FAILED, INTERRUPTED) or verdict.status < 0
    if not noticed and verdict.status not in (ALL_PASSED, NOTHING_LEFT):
        raise SystemExit(f"{mutant.what}: the tests could not run: {verdict.words}")
    print(f"{'noticed' if noticed else 'MISSED'} in {seconds:.0f} s  {mutant.file}: {mutant.what}")
    words = verdict.words if verdict.status >= 0 else f"signal {-verdict.status}"
    print(f"        by {words if noticed else 'none of ' + ', '.join(mutant.tests)}", flush=True)
    if options.record:
        record.add(mutant, words if noticed else None)
    return noticed


if __name__ == "__main__":
    sys.exit(main())
