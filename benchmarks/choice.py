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

SOLVERS = ("direct", "multigrid")


def main() -> None:
    """Run and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--degrees", type=int, nargs="+", default=[1, 2, 4, 6, 8])
    parser.add_argument("--dofs", type=int, default=2200)
    parser.add_argument("--nu", type=float, nargs="+", default=[0.3, 0.4999, 0.499999])
    parser.add_argument("--repeats", type=int, default=9)
    options = parser.parse_args()
    rows: list[dict[str, Any]] = []
    for degree in options.degrees:
        mesh = problem.block(options.dofs, degree)
        for nu in options.nu:
            law = bz.LinearElastic(E=problem.E, nu=nu)
            body = replace(problem.body(mesh, degree), materials=law)
            taken = {solver: seconds(body, solver, options.repeats) for solver in SOLVERS}
            count = 3 * bz.ControlNet(mesh, degree).count
            rows.append({"degree": degree, "unknowns": count, "nu": nu} | taken)
    about = record.surroundings()
    head = ["degree", "unknowns", "nu", *(f"{solver}, ms" for solver in SOLVERS)]
    text = f"{about['date']}; {about['machine']}; load {about['load']}; `{about['command']}`\n\n"
    text += record.table(head, [cells(row) for row in rows])
    record.stored("choice", {"surroundings": about, "rows": rows}, text)


def seconds(body: bz.Body, solver: str, repeats: int) -> float | None:
    """The least of some solves on one thread; None where it does not come to 1e-8."""
    try:
        return peaks.least(partial(bz.solve, body, solver=solver, threads=1), repeats)
    except bz.NotConverged:
        return None


def cells(row: dict[str, Any]) -> list[str]:
    """One row of the table."""
    times = ["not reached" if row[s] is None else f"{1e3 * row[s]:.0f}" for s in SOLVERS]
    return [*(str(row[key]) for key in ("degree", "unknowns", "nu")), *times]


if __name__ == "__main__":
    main()
