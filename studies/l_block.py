# SPDX-License-Identifier: BSD-3-Clause
"""How fast the error falls beside an edge singularity: uniform meshes, and tets where it matters.

The L-shaped block of tests/l_block.py: pulled at one end, rollers elsewhere, so that nothing but
the inward edge is singular, where the displacement goes with r^0.5445. Run as

    python studies/l_block.py [folder] [most unknowns]
    python studies/l_block.py far [folder] [most unknowns]

It leaves l_block.csv and l_block.png in the folder (docs/images where none is given). Errors are in
the energy norm, relative, from the energies of `ENERGY` and of each level; beside them stand those
that the levels estimated. With `far` it goes on with degree 2 alone, to 300,000 unknowns: it leaves
l_block_far.csv, and l_block_rates.png with the rates of all beside those of the best of meshes.
docs/theory/refinement.md discusses all of it.
"""

from __future__ import annotations

import csv
import sys
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from itertools import pairwise
from math import log, pi, sqrt
from pathlib import Path

import numpy as np
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


def best(degree: int, smallest: float, power: float = -RATES[2]) -> tuple[float, float]:
    """The tets and the error of the best mesh of tets that are as long as they are wide.

    Up to constants, for an error of h^k r^(power - 1 - k) at the distance r from the edge, to 1 mm.
    The least sum of squares for a number of tets has h = C r^b with

        b = 2 (k + 1 - power) / (2 k + 3),  C = smallest^(1 - b),

    down to r = h = `smallest`, where tets of that size surround the edge:

        tets = 6 angle length (int r h^-3 dr + 1 / (2 smallest))
        error^2 = int h^(2 k) r^(2 power - 1 - 2 k) dr + smallest^(2 power)
    """
    b = 2 * (degree + 1 - power) / (2 * degree + 3)
    C = smallest ** (1 - b)

    def integral(q: float) -> float:
        return (1 - smallest ** (q + 1)) / (q + 1)

    tets = 6 * (1.5 * pi) * 0.5 * (C**-3 * integral(1 - 3 * b) + 0.5 / smallest)
    square = C ** (2 * degree) * integral(2 * degree * (b - 1) + 2 * power - 1)
    return tets, sqrt(square + smallest ** (2 * power))


def slopes(sizes: list[float], errors: list[float]) -> tuple[list[float], list[float]]:
    """Numbers of tets, and the power at each over the last factor of eight or more."""
    at, powers = [], []
    for j in range(len(sizes)):
        before = [i for i in range(j) if 8 * sizes[i] <= sizes[j]]
        if before:
            i = before[-1]
            at.append(sizes[j])
            powers.append(log(errors[j] / errors[i]) / log(sizes[j] / sizes[i]))
    return at, powers


def far(folder: Path, most: int) -> None:
    """Degree 2 alone on more and more tets, level by level."""
    found = bz.refined(l_body(l_mesh(), 2), most_unknowns=most).levels
    with (folder / "l_block_far.csv").open("w", newline="") as stream:
        writer = csv.writer(stream)
        writer.writerow(["tets", "unknowns", "energy", "estimated"])
        for level in found:
            error = f"{level.energy_error:.8g}"
            writer.writerow([level.tets, level.unknowns, f"{level.energy:.12g}", error])


def rates_picture(folder: Path) -> None:
    """The powers of what was measured beside those of the best of meshes."""
    figure = Figure(figsize=(7.5, 4.5), layout="constrained")
    axes = figure.subplots()
    measured: dict[int, list[tuple[float, float]]] = {}
    with (folder / "l_block.csv").open() as stream:
        for row in csv.DictReader(stream):
            if row["way"] == "refined":
                pair = (float(row["tets"]), float(row["estimated"]))
                measured.setdefault(int(row["degree"]), []).append(pair)
    with (folder / "l_block_far.csv").open() as stream:
        measured[2] = [
            (float(row["tets"]), float(row["estimated"])) for row in csv.DictReader(stream)
        ]
    for degree in DEGREES:
        model = [best(degree, float(h)) for h in np.geomspace(0.2, 1e-8, 60)]
        steps = [
            (sqrt(a[0] * b[0]), log(b[1] / a[1]) / log(b[0] / a[0])) for a, b in pairwise(model)
        ]
        label = f"degree {degree}"
        axes.semilogx(*zip(*steps, strict=True), color=COLOURS[degree])
        tets, errors = map(list, zip(*measured[degree], strict=True))
        axes.semilogx(*slopes(tets, errors), "o-", ms=4, lw=0.6, color=COLOURS[degree], label=label)
    axes.axhline(RATES[2], color="black", lw=0.8, ls="--")
    axes.set(
        xlabel="tets",
        ylabel="power of the number of tets",
        ylim=(-0.6, -0.2),
        xlim=(1e2, 1e9),
        title="L-shaped block: how fast the error falls (lines: the best mesh; dots: measured)",
    )
    axes.grid(alpha=0.3)
    axes.legend(fontsize=8)
    figure.savefig(folder / "l_block_rates.png", dpi=110)


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
    """Run all, write the files."""
    words = [word for word in sys.argv[1:] if word != "far"]
    folder = Path(words[0] if words else "docs/images")
    if len(words) < len(sys.argv) - 1:
        far(folder, int(words[1]) if len(words) > 1 else 300_000)
        rates_picture(folder)
        return
    most = int(words[1]) if len(words) > 1 else 60_000
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
