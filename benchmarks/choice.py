# SPDX-License-Identifier: BSD-3-Clause
"""Direct or not, of small bodies: python benchmarks/choice.py (docs/theory/solvers.md)."""

from __future__ import annotations

import argparse
from dataclasses import replace
from functools import partial
from typing import Any

import peaks
import problem
import record

import bezsoma as bz

WAYS = ("direct", "iterations", "auto")
Cases = dict[str, tuple[bz.LinearElastic | bz.NeoHooke, bool]]
"""Laws, and whether there is a pressure beside the displacement."""


def main() -> None:
    """Run and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--degrees", type=int, nargs="+", default=[1, 2, 4, 8])
    parser.add_argument("--dofs", type=int, nargs="+", default=[80, 400, 2200])
    parser.add_argument("--nu", type=float, nargs="+", default=[0.3, 0.499, 0.4999, 0.499999])
    parser.add_argument("--repeats", type=int, default=9)
    options = parser.parse_args()
    cases: Cases = {f"{nu:g}": (bz.LinearElastic(E=problem.E, nu=nu), False) for nu in options.nu}
    cases["0.5, mixed"] = bz.LinearElastic(E=problem.E, nu=0.5), True
    cases["0.3, neo-Hooke"] = bz.NeoHooke(E=problem.E, nu=0.3), False
    rows: list[dict[str, Any]] = []
    for degree in options.degrees:
        blocks = [problem.block(each, degree) for each in options.dofs]
        meshes = {3 * bz.ControlNet(block, degree).count: block for block in blocks}
        for count, mesh in meshes.items():
            for name, (law, mixed) in cases.items():
                if mixed and degree == 1:
                    continue
                body = replace(problem.body(mesh, degree), materials=law, incompressible=mixed)
                ways = ("direct", "saddle" if mixed else "multigrid", "auto")
                taken = dict(zip(WAYS, seconds(body, ways, options.repeats), strict=True))
                rows.append({"degree": degree, "unknowns": count, "nu": name} | taken)
    about = record.surroundings()
    head = ["degree", "unknowns", "nu", *(f"{way}, ms" for way in WAYS)]
    text = f"{about['date']}; {about['machine']}; load {about['load']}; `{about['command']}`\n\n"
    text += record.table(head, [cells(row) for row in rows])
    record.stored("choice", {"surroundings": about, "rows": rows}, text)


def seconds(body: bz.Body, ways: tuple[str, ...], repeats: int) -> list[float | None]:
    """The least of some solves on one thread each; None where it does not come through."""
    least: list[float | None] = []
    for way in ways:
        try:
            least.append(peaks.least(partial(bz.solve, body, solver=way, threads=1), repeats))
        except bz.NotConverged:
            least.append(None)
    return least


def cells(row: dict[str, Any]) -> list[str]:
    """One row of the table."""
    times = ["not reached" if row[way] is None else f"{1e3 * row[way]:.1f}" for way in WAYS]
    return [*(str(row[key]) for key in ("degree", "unknowns", "nu")), *times]


if __name__ == "__main__":
    main()
