# SPDX-License-Identifier: BSD-3-Clause
"""Incompressible tissue beside other engines: python benchmarks/mixed.py.

The problem of problem.py at nu = 1/2, Taylor-Hood of degree k and k - 1 on the same tets, with the
same supports and load, to the same relative residual formed anew. Every configuration is tried
once; those within twice the best of their engine are repeated, interleaved, and the least time
counts. Assembly, numbering and set-up count; the mesh does not.
"""

from __future__ import annotations

import argparse
import tempfile
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import isolated
import problem
import record

Run = dict[str, Any]
CONFIGURATIONS = (
    ("bezsoma", "saddle", "bezsoma"),
    ("ngsolve", "bddc vertices", "ngsolve"),
    ("ngsolve", "bddc", "ngsolve"),
    ("ngsolve", "direct", "ngsolve"),
    ("pardiso", "LDL^T", "pypardiso"),
)
"""Engine, configuration, and the package that it needs; pardiso is for degree 2."""
AGREE = 1e-6
"""How far energies may be apart, relative to ours."""
HEAD = ["degree", "unknowns", "threads", "engine", "together s", "processor s", "iterations"]
HEAD += ["residual", "memory MB", "times ours", "energy apart"]


def main() -> None:
    """Run and print."""
    options = _options()
    found: dict[str, Any] = {"surroundings": record.surroundings(), "rows": []}
    with tempfile.TemporaryDirectory() as folder:
        for unknowns in options.dofs:
            for degree in options.degrees:
                tets = Path(folder) / f"{degree}-{unknowns}.npz"
                problem.tets(unknowns, degree).write(tets)
                case = {"degree": degree, "threads": options.threads, "tets": str(tets)}
                found["rows"].append(compared(case, options))
                record.kept(options.name, found)
    about = found["surroundings"]
    text = f"{about['date']}; {about['machine']}; load {about['load']} at the start; "
    text += f"`{about['command']}`; {about['versions']}\n\n"
    lines = [line for row in found["rows"] for line in row]
    record.stored(options.name, found, text + record.table(HEAD, [_cells(run) for run in lines]))


def compared(case: Run, options: argparse.Namespace) -> list[Run]:
    """All configurations once, then again in turn; the least time of each, with ours first."""
    ways = [
        {"engine": engine, "configuration": name}
        for engine, name, package in CONFIGURATIONS
        if find_spec(package)
        and name not in options.without
        and (engine != "pardiso" or case["degree"] == 2)
    ]
    kept: list[Run] = []
    for turn in range(options.repeats):
        for i, way in enumerate(ways):
            if turn and ("failed" in kept[i] or kept[i]["seconds"] > options.long):
                continue
            run = isolated.ran("one_mixed.py", case | way, case["threads"], options.limit)
            run = way | {key: case[key] for key in ("degree", "threads")} | run
            print(run, flush=True)
            if turn == 0:
                kept.append(run)
            elif "failed" not in run and run["seconds"] < kept[i]["seconds"]:
                kept[i] = run
    for run in kept:
        if "failed" not in run and "failed" not in kept[0]:
            run["slower"] = run["seconds"] / kept[0]["seconds"]
            run["apart"] = abs(run["energy"] / kept[0]["energy"] - 1)
    return kept


def _cells(run: Run) -> list[str]:
    named = f"{run['engine']} ({run['configuration']})"
    if "failed" in run:
        return [str(run["degree"]), "", str(run["threads"]), named, run["failed"], *[""] * 6]
    return [
        str(run["degree"]),
        str(run["unknowns"]),
        str(run["threads"]),
        named,
        f"{run['seconds']:.3g}",
        f"{run['processor']:.3g}",
        str(run["iterations"]),
        f"{run['residual']:.1e}",
        f"{run['memory'] / 1e6:.0f}",
        f"{run['slower']:.1f}" if "slower" in run else "",
        f"{run['apart']:.0e}" + (" (!)" if run["apart"] > AGREE else "") if "apart" in run else "",
    ]


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--degrees", type=int, nargs="+", default=[2])
    parser.add_argument("--dofs", type=int, nargs="+", default=[110_000, 200_000])
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--without", nargs="*", default=[], help="configurations to leave out")
    parser.add_argument("--limit", type=float, default=900, help="seconds for one run")
    parser.add_argument("--long", type=float, default=10, help="longer runs are not repeated, s")
    parser.add_argument("--name", default="mixed", help="of the files in benchmarks/results")
    return parser.parse_args()


if __name__ == "__main__":
    main()
