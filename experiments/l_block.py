# SPDX-License-Identifier: BSD-3-Clause
"""How fast the error falls beside an edge singularity: uniform meshes, and tets where it matters.

The L-shaped block of tests/l_block.py: pulled at one end, rollers elsewhere, so that nothing but
the inward edge is singular, where the displacement goes with r^0.5445. Run as

    python experiments/l_block.py [folder] [most unknowns]

It leaves l_block.csv and l_block.png in the folder (docs/images where none is given). Errors are in
the energy norm, relative, from the energies of `ENERGY` and of each level; beside them stand those
that the levels estimated. docs/theory/refinement.md discusses both.
"""

from __future__ import annotations

import csv
import sys
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from math import log, sqrt
from pathlib import Path

from matplotlib.figure import Figure

import bezsoma as bz

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from l_block import ENERGY, l_body, l_mesh

DEGREES = (1, 2, 3, 4)
RATES = {1: -1 / 3, 2: -0.5445, 3: -0.5445, 4: -0.5445}
COLOURS = {1: "#7a828c", 2: "#b3312c", 3: "#d98324", 4: "#1f4e79"}


@dataclass(frozen=True)
class Row:
    """One solve: how it was made, its size, and its relative error, true and estimated."""

    way: str
    degree: int
    tets: int
    unknowns: int
    error: float
    estimated: float
    iterations: int
    seconds: float


def true_error(energy: float) -> float:
    """Of the energy norm, relative: all work is done by a traction."""
    return sqrt(1 - energy / ENERGY)


def rows(most: int) -> Iterator[Row]:
    """Uniform meshes and refined ones, degree by degree."""
    for degree in DEGREES:
        cells = 1
        while True:
            found = bz.solve(l_body(l_mesh(cells), degree))
            size, tets = 3 * found.net.count, len(found.body.mesh.tets)
            if size > most:
                break
            error, taken = true_error(found.energy), sum(found.timings.values())
            yield Row("uniform", degree, tets, size, error, 0.0, found.iterations, taken)
            cells *= 2
        for level in bz.refined(l_body(l_mesh(), degree), most_unknowns=most).levels:
            yield Row(
                "refined",
                degree,
                level.tets,
                level.unknowns,
                true_error(level.energy),
                level.energy_error,
                level.iterations,
                level.seconds,
            )


def rate(found: list[Row]) -> float:
    """The power of N between the last row and the first with more than an eighth of its size."""
    last = found[-1]
    first = next(row for row in found if 8 * row.unknowns > last.unknowns)
    return log(last.error / first.error) / log(last.unknowns / first.unknowns)


def picture(found: list[Row], path: Path) -> None:
    """Errors against unknowns, with the slopes that theory gives."""
    figure = Figure(figsize=(7.5, 5.5), layout="constrained")
    axes = figure.subplots()
    for degree in DEGREES:
        for way, style in (("uniform", ":o"), ("refined", "-o")):
            mine = [row for row in found if (row.way, row.degree) == (way, degree)]
            label = f"degree {degree}, {way}: N^{rate(mine):.2f}"
            sizes = [row.unknowns for row in mine]
            axes.loglog(
                sizes, [row.error for row in mine], style, color=COLOURS[degree], ms=4, label=label
            )
            if way == "refined":
                estimated = [row.estimated for row in mine]
                axes.loglog(sizes, estimated, "x", color=COLOURS[degree], ms=5)
    for power, at in ((-1 / 3, 0.5), (-0.5445, 0.9)):
        ends = (2e3, 1e5)
        line = [at * (end / 2e2) ** power for end in ends]
        axes.loglog(ends, line, "--", color="black", lw=0.8)
        axes.annotate(f"N^{power:.2f}", (ends[1], line[1]), fontsize=8)
    axes.set(
        xlabel="unknowns N",
        ylabel="error in the energy norm, relative",
        title="L-shaped block, edge singularity r^0.5445 (crosses: as estimated)",
    )
    axes.grid(alpha=0.3)
    axes.legend(fontsize=7)
    figure.savefig(path, dpi=110)


def main() -> None:
    """Run all, write both files."""
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "docs/images")
    most = int(sys.argv[2]) if len(sys.argv) > 2 else 60_000
    found = []
    for each in rows(most):
        found.append(each)
        print(
            f"{each.way:<8} degree {each.degree} tets {each.tets:>6} unknowns {each.unknowns:>7} "
            f"error {100 * each.error:6.3f} % estimated {100 * each.estimated:6.3f} % "
            f"iterations {each.iterations:>3} {each.seconds:6.2f} s",
            flush=True,
        )
    with (folder / "l_block.csv").open("w", newline="") as stream:
        writer = csv.DictWriter(stream, list(asdict(found[0])))
        writer.writeheader()
        writer.writerows(asdict(each) for each in found)
    picture(found, folder / "l_block.png")


if __name__ == "__main__":
    main()
