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

from mutants import table
from mutants.workshop import Verdict, Workshop

PROJECT = Path(__file__).resolve().parent.parent.parent
ALL_PASSED, SOME_FAILED, INTERRUPTED = 0, 1, 2


def main() -> int:
    """Run the chosen errors; the status is 0 if every one is noticed."""
    options = arguments()
    chosen = [
        m for m in (table.IN_CI if options.ci else table.ALL) if options.only in m.what + m.file
    ]
    if not chosen:
        raise SystemExit(f"no deliberate error speaks of {options.only!r}")
    with tempfile.TemporaryDirectory(prefix="bezsoma-mutants-") as scratch:
        shops: queue.Queue[Workshop] = queue.Queue()
        for number in range(options.jobs):
            shops.put(Workshop(PROJECT, Path(scratch) / str(number)))
        sound(chosen, shops)
        with ThreadPoolExecutor(options.jobs) as pool:
            noticed = list(pool.map(lambda mutant: told(mutant, shops), chosen))
    print(f"{sum(noticed)} of {len(noticed)} deliberate errors are noticed")
    return 0 if all(noticed) else 1


def arguments() -> argparse.Namespace:
    """What was asked for."""
    parser = argparse.ArgumentParser(prog="./dev mutants", description=__doc__)
    parser.add_argument("--ci", action="store_true", help="those in Python and three in C++")
    parser.add_argument("--only", default="", help="those whose description or file has this text")
    cores = min(4, os.cpu_count() or 1)
    parser.add_argument("--jobs", type=int, default=cores, help="how many at once")
    return parser.parse_args()


def sound(chosen: list[table.Mutant], shops: queue.Queue[Workshop]) -> None:
    """Check that the tests pass without any error; otherwise their failing would mean nothing."""
    shop = shops.get()
    tests = tuple(sorted({test for mutant in chosen for test in mutant.tests}))
    verdict = shop.verdict(tests)
    shops.put(shop)
    if verdict.status != ALL_PASSED:
        raise SystemExit(f"the tests fail without any deliberate error: {verdict.words}")


def told(mutant: table.Mutant, shops: queue.Queue[Workshop]) -> bool:
    """Whether the tests notice one error; says so in a line."""
    shop, start = shops.get(), time.monotonic()
    try:
        verdict = judged(mutant, shop)
    finally:
        shops.put(shop)
    noticed = verdict.status in (SOME_FAILED, INTERRUPTED)
    if not noticed and verdict.status != ALL_PASSED:
        raise SystemExit(f"{mutant.what}: the tests could not run: {verdict.words}")
    seconds = time.monotonic() - start
    print(f"{'noticed' if noticed else 'MISSED'} in {seconds:.0f} s  {mutant.file}: {mutant.what}")
    print(
        f"        by {verdict.words if noticed else 'none of ' + ', '.join(mutant.tests)}",
        flush=True,
    )
    return noticed


def judged(mutant: table.Mutant, shop: Workshop) -> Verdict:
    """What the tests say about one error."""
    if not mutant.is_cpp:
        with shop.harmed(mutant.file, mutant.old, mutant.new):
            return shop.verdict(mutant.tests)
    with shop.harmed(mutant.file, mutant.old, mutant.new):
        shop.build_core()
        verdict = shop.verdict(mutant.tests)
    shop.build_core()
    return verdict


if __name__ == "__main__":
    sys.exit(main())
