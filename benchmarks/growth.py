# SPDX-License-Identifier: BSD-3-Clause
"""How time, iterations and memory grow with the problem: python benchmarks/growth.py [--large].

From a mesh file to results on disk, stage by stage; each run has a process of its own. Memory is
the most that the process held until it was solved, and the same less what it held after its imports
and a warm-up, in bytes for each unknown.
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path
from typing import Any

import isolated
import plots
import problem
import record

Run = dict[str, Any]
SIZES = [1_000, 10_000, 50_000, 100_000, 350_000, 1_000_000]
LARGE = [3_000_000, 10_000_000]
STAGES = {
    "reading": "reading the mesh",
    "numbering": "numbering",
    "supports": "supports, net",
    "loads": "loads",
    "stiffness": "operator",
    "preconditioner": "preconditioner",
    "iterations": "iterations",
    "reactions": "reactions, energy",
    "writing": "writing results",
    "writing VTU": "writing VTU",
}
BESIDE = ("reading", "numbering", "supports", "loads", "writing", "writing VTU")
"""Preparation and writing: the rest works with the operator, as reactions and energy do."""


def main() -> None:
    """Run, print, plot."""
    options = _options()
    sizes = options.dofs + (LARGE if options.large else [])
    found: Run = {"surroundings": record.surroundings(), "rows": [], "failed": []}
    print(record.table(HEAD, []), flush=True)
    with tempfile.TemporaryDirectory() as folder:
        for degree in options.degrees:
            for unknowns in sizes:
                row = best(Path(folder) / "mesh.npz", degree, unknowns, options)
                found["failed" if "failed" in row else "rows"].append(row)
                print(_line(row), flush=True)
                record.kept(options.name, found)
    record.stored(options.name, found, report(found))
    if options.plots:
        plots.growth(found["rows"], options.plots.replace("*", "growth"))
        plots.stages(found["rows"], STAGES, options.plots.replace("*", "stages"))


def best(mesh: Path, degree: int, unknowns: int, options: argparse.Namespace) -> Run:
    """The quickest of the repeats; only one beyond --long seconds."""
    asked = {"mesh": str(mesh), "degree": degree}
    made = isolated.ran("one_growth.py", asked | {"unknowns": unknowns}, 1, options.limit)
    if "failed" in made:
        return asked | {"unknowns": unknowns} | made
    request, rows = asked | {"threads": options.threads}, []
    while len(rows) < options.repeats and (not rows or rows[-1]["solve"] < options.long):
        reply = isolated.ran("one_growth.py", request, options.threads, options.limit)
        if "failed" in reply:
            return asked | {"unknowns": unknowns} | reply
        rows.append(reply)
    quickest = min(rows, key=lambda row: row["solve"])
    return quickest | {"times": [row["solve"] for row in rows], "threads": options.threads}


HEAD = [
    "degree",
    "unknowns",
    "tets",
    "iterations",
    "solve() s",
    "of it iterations",
    "read s",
    "write s",
    "VTU s",
    "beside the solver",
    "process MB",
    "bytes an unknown",
]


def cells(row: Run) -> list[str]:
    """One row of the table."""
    stages = row["stages"]
    beside = sum(stages[key] for key in BESIDE)
    return [
        str(row["degree"]),
        str(row["unknowns"]),
        str(row["tets"]),
        str(row["iterations"]),
        f"{row['solve']:.3g}",
        f"{stages['iterations'] / row['solve']:.0%}",
        f"{stages['reading']:.2g}",
        f"{stages['writing']:.2g}",
        f"{stages['writing VTU']:.2g}",
        f"{beside / sum(stages.values()):.0%}",
        f"{row['bytes_peak'] / 1e6:.0f}",
        f"{(row['bytes_peak'] - row['bytes_imported']) / row['unknowns']:.0f}",
    ]


def _line(row: Run) -> str:
    if "failed" in row:
        return f"degree {row['degree']}, {row['unknowns']} unknowns: {row['failed']}"
    return "| " + " | ".join(cells(row)) + " |"


def report(found: Run) -> str:
    """Markdown: growth, then seconds by stage."""
    about, rows = found["surroundings"], found["rows"]
    broken = [
        [
            str(row["degree"]),
            str(row["unknowns"]),
            *(f"{row['stages'][key]:.2g}" for key in STAGES),
        ]
        for row in rows
    ]
    failed = "".join(f"\n\n{_line(row)}" for row in found["failed"])
    return (
        f"{about['date']}; {about['machine']}; load {about['load']} at the start; "
        f"`{about['command']}`\n\n"
        + record.table(HEAD, [cells(row) for row in rows])
        + "\n\nSeconds by stage:\n\n"
        + record.table(["degree", "unknowns", *STAGES.values()], broken)
        + failed
    )


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--degrees", type=int, nargs="+", default=problem.DEGREES)
    parser.add_argument("--dofs", type=int, nargs="+", default=SIZES)
    parser.add_argument("--large", action="store_true", help="also 3 and 10 million unknowns")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--long", type=float, default=10, help="longer runs are not repeated, s")
    parser.add_argument("--limit", type=float, default=1800, help="seconds for one run")
    parser.add_argument("--name", default="growth", help="of the files in benchmarks/results")
    parser.add_argument("--plots", default="", help="where to draw; * stands for each plot's name")
    return parser.parse_args()


if __name__ == "__main__":
    main()
