# SPDX-License-Identifier: BSD-3-Clause
"""The product K u against what the machine allows: python benchmarks/roofline.py.

Two bounds on its time, from counts (counts.py) and from what the machine does in the same run
(peaks.py): bytes that have to move over the bandwidth of a STREAM triad, and flops over the rate of
a large dense product. The larger is the roof; its part attained is roof over time. That flop rate
is made of multiplications with additions at once, which the kernel has in part only; so the part
of the instructions that the processor could have issued is given as well.
"""

from __future__ import annotations

import argparse
from typing import Any

import counts
import isolated
import peaks
import plots
import record

from bezsoma import _core

Run = dict[str, Any]


def main() -> None:
    """Run, print, plot."""
    options = _options()
    found: Run = {"surroundings": record.surroundings(), "rows": [], "failed": []}
    found["triad_large"] = peaks.triad(3 * peaks.LARGE * 4, 1, 3)
    for degree in options.degrees:
        for instructions in options.instructions:
            request = {
                "degree": degree,
                "instructions": instructions,
                "threads": options.threads,
                "unknowns": options.dofs,
                "sides": options.sides,
                "repeats": options.repeats,
            }
            reply = isolated.ran("one_operator.py", request, options.threads)
            if "failed" in reply:
                found["failed"].append(request | reply)
                print(f"degree {degree}, {instructions}: {reply['failed']}", flush=True)
            for row in reply.get("rows", []):
                found["rows"].append(row | bounds(row, found["triad_large"]))
                print(line(found["rows"][-1]), flush=True)
    record.stored(options.name, found, report(found))
    plots.operator(found, options.plot)


def bounds(row: Run, large: float) -> Run:
    """Rates, and the parts of the bounds that are attained."""
    count = counts.of_tet(row["degree"])
    work = row["tets"] * row["sides"]
    by_memory = row["bytes"] / max(row["triad"], large)
    by_flops = count.flops * work / row["peak_flops"]
    by_issue = count.instructions * work / (row["peak_flops"] / 2)
    seconds = row["seconds"]
    return {
        "rate": row["unknowns"] * row["sides"] / seconds,
        "bytes_per_unknown": row["bytes"] / row["unknowns"] / row["sides"],
        "flops_per_unknown": count.flops * work / row["unknowns"] / row["sides"],
        "attained_flops": count.flops * work / seconds,
        "part": max(by_memory, by_flops) / seconds,
        "part_memory": by_memory / seconds,
        "part_flops": by_flops / seconds,
        "part_issue": by_issue / seconds,
    }


HEAD = [
    "degree",
    "kernels",
    "float",
    "sides",
    "M unknowns/s",
    "bytes each",
    "flops each",
    "GB/s of triad",
    "GF/s",
    "GF/s of dense product",
    "of the roof",
    "of memory",
    "of flops",
    "of instructions",
]


def cells(row: Run) -> list[str]:
    """One row of the table."""
    parts = ("part", "part_memory", "part_flops", "part_issue")
    return [
        str(row["degree"]),
        row["instructions"],
        str(8 * row["width"]),
        str(row["sides"]),
        f"{row['rate'] / 1e6:.0f}",
        f"{row['bytes_per_unknown']:.1f}",
        f"{row['flops_per_unknown']:.0f}",
        f"{row['triad'] / 1e9:.1f}",
        f"{row['attained_flops'] / 1e9:.1f}",
        f"{row['peak_flops'] / 1e9:.0f}",
        *(f"{row[part]:.0%}" for part in parts),
    ]


def line(row: Run) -> str:
    """One row of the table, in Markdown."""
    return "| " + " | ".join(cells(row)) + " |"


def report(found: Run) -> str:
    """Markdown."""
    about = found["surroundings"]
    return (
        f"{about['date']}; {about['machine']}; load {about['load']} at the start; "
        f"`{about['command']}`; triad on arrays no cache holds {found['triad_large'] / 1e9:.1f} "
        "GB/s\n\n" + record.table(HEAD, [cells(row) for row in found["rows"]])
    )


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--degrees", type=int, nargs="+", default=list(range(1, 11)))
    parser.add_argument("--dofs", type=int, default=1_000_000)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--repeats", type=int, default=7)
    parser.add_argument("--sides", type=int, nargs="+", default=[1, 8], help="right-hand sides")
    sets = _core.instruction_sets()
    parser.add_argument("--instructions", nargs="+", default=sets, choices=sets)
    parser.add_argument("--name", default="operator", help="of the files in benchmarks/results")
    parser.add_argument("--plot", default="", help="where to draw")
    return parser.parse_args()


if __name__ == "__main__":
    main()
