# SPDX-License-Identifier: BSD-3-Clause
"""How long a solve takes, by degree and method: ./dev bench.

./dev bench peers, and likewise roofline, growth, choice, mixed and nonlinear, run the longer
measurements; see docs/performance.md.
"""

from __future__ import annotations

import argparse
import os
import platform
import sys
import time
from importlib import import_module

import problem

import bezsoma as bz

LONGER = ("peers", "roofline", "growth", "choice", "mixed", "nonlinear")


def row(degree: int, solver: str, unknowns: int, threads: int) -> str:
    """One line of the table: sizes, seconds, iterations."""
    body = problem.body(problem.block(unknowns, degree), degree)
    start = time.perf_counter()
    solution = bz.solve(body, solver=solver, threads=threads)
    whole = time.perf_counter() - start
    solving = solution.timings["solving"]
    count = 3 * solution.net.count
    return (
        f"{degree:6d} {solver:>9} {len(body.mesh.tets):8d} {count:9d} {solution.iterations:10d}"
        f" {whole - solving:9.2f} {solving:9.2f} {count / whole / 1e3:10.0f}"
    )


def main() -> None:
    """Print the table, or hand over to one of the longer measurements."""
    if sys.argv[1:2] and sys.argv[1] in LONGER:
        name = sys.argv.pop(1)
        sys.argv[0] = f"{name}.py"
        import_module(name).main()
        return
    parser = argparse.ArgumentParser(prog="./dev bench", description=__doc__)
    parser.add_argument("--unknowns", type=int, default=20_000, help="about how many")
    parser.add_argument("--degrees", type=int, nargs="+", default=problem.DEGREES)
    parser.add_argument("--solvers", nargs="+", default=["direct", "cg", "multigrid"])
    parser.add_argument("--threads", type=int, default=0, help="0: all cores")
    options = parser.parse_args()
    print(f"bezsoma {bz.__version__}, {platform.machine()}, {os.cpu_count()} cores")
    print("degree    solver     tets  unknowns iterations   other s   solve s  unknowns/ms")
    for degree in options.degrees:
        for solver in options.solvers:
            print(row(degree, solver, options.unknowns, options.threads), flush=True)


if __name__ == "__main__":
    main()
