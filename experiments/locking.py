# SPDX-License-Identifier: BSD-3-Clause
"""Who locks: the displacement form and the mixed form, degree 1 to 6, as nu goes to 1/2.

A quarter of a block of tissue stands on a fixed floor and is pressed from above by a smooth
traction; what is compared is the work of the load, int t . u, which a form that locks finds too
small. The truth is the mixed form of degree 5 on tets half as large. Run as

    python experiments/locking.py [folder]

It leaves locking.csv and locking.png in the folder (docs/images where none is given). Seconds are
those of `solve` without progress, all threads; docs/theory/incompressible.md discusses both.
"""

from __future__ import annotations

import csv
import sys
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from time import perf_counter

from matplotlib.figure import Figure

import bezsoma as bz

NUS = (0.3, 0.45, 0.49, 0.499, 0.4999, 0.5)
DEGREES = (1, 2, 3, 4, 5, 6)
CELLS = 5
RTOL = 1e-8
LOAD = bz.Polynomial.parse([0, 0, "-0.001*(1-x^2)^2*(1-y^2)^2"])
"""MPa on top, zero with its slope where x = 1 or y = 1; the middle is x = y = 0."""
COLOURS = dict(
    zip(DEGREES, ("#7a828c", "#b3312c", "#d98324", "#3c8d40", "#1f4e79", "#6a3d9a"), strict=True)
)
PLANES = (bz.Fixed("left", components="x"), bz.Fixed("front", components="y"), bz.Fixed("bottom"))


@dataclass(frozen=True)
class Row:
    """One solve: work of the load [N mm] and what is missing of it [-], and its cost."""

    form: str
    degree: int
    nu: float
    unknowns: int
    iterations: int
    seconds: float
    work: float
    deficit: float


def body(nu: float, degree: int, mixed: bool, cells: int) -> bz.Body:
    """The quarter of a block, 1 mm a side, E = 0.015 MPa."""
    mesh = bz.block(cells=cells)
    law = bz.LinearElastic(E=0.015, nu=nu)
    load = [bz.Traction("top", value=LOAD)]
    return bz.Body(mesh, degree, law, PLANES, load, incompressible=mixed)


def row(nu: float, degree: int, mixed: bool, truth: float) -> Row:
    """Solve and compare."""
    stated = body(nu, degree, mixed, CELLS)
    start = perf_counter()
    found = bz.solve(stated, rtol=RTOL)
    seconds = perf_counter() - start
    form, work = "mixed" if mixed else "displacement", 2 * found.energy
    deficit = abs(1 - work / truth)
    return Row(form, degree, nu, found.free, found.iterations, seconds, work, deficit)


def rows() -> Iterator[Row]:
    """All forms and degrees at every nu."""
    for nu in NUS:
        truth = 2 * bz.solve(body(nu, 5, True, 2 * CELLS), rtol=RTOL).energy
        for degree in DEGREES:
            if nu < 0.5:
                yield row(nu, degree, False, truth)
            if degree > 1:
                yield row(nu, degree, True, truth)


def picture(found: list[Row], path: Path) -> None:
    """What is missing against 1 - 2 nu, and against seconds."""
    figure = Figure(figsize=(12, 5), layout="constrained")
    left, right = figure.subplots(1, 2)
    for form, style in (("displacement", "-o"), ("mixed", "--s")):
        for degree in DEGREES:
            mine = [r for r in found if r.form == form and r.degree == degree]
            if not mine:
                continue
            away = [max(1 - 2 * r.nu, 3e-5) for r in mine]
            missing = [r.deficit for r in mine]
            left.loglog(
                away, missing, style, color=COLOURS[degree], label=f"{form}, {degree}", ms=4
            )
            near = [r for r in mine if r.nu == 0.4999]
            right.loglog(
                [r.seconds for r in near],
                [r.deficit for r in near],
                style[-1],
                color=COLOURS[degree],
                ms=9,
                mfc="none" if form == "mixed" else None,
            )
    left.set(
        xlabel="1 - 2 nu (the last: nu = 1/2)",
        ylabel="missing work of the load, relative",
        title=f"{6 * CELLS**3} tets: who locks",
    )
    left.invert_xaxis()
    left.legend(fontsize=7, ncols=2)
    right.set(xlabel="seconds", ylabel="missing work", title="what it costs at nu = 0.4999")
    for each in (left, right):
        each.grid(alpha=0.3)
    figure.savefig(path, dpi=110)


def main() -> None:
    """Run all, write both files."""
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "docs/images")
    found = []
    for each in rows():
        found.append(each)
        print(
            f"{each.form:<12} degree {each.degree} nu {each.nu:<6} unknowns {each.unknowns:>7} "
            f"iterations {each.iterations:>5} {each.seconds:7.2f} s  missing {each.deficit:.2e}",
            flush=True,
        )
    with (folder / "locking.csv").open("w", newline="") as stream:
        writer = csv.DictWriter(stream, list(asdict(found[0])))
        writer.writeheader()
        writer.writerows(asdict(each) for each in found)
    picture(found, folder / "locking.png")


if __name__ == "__main__":
    main()
