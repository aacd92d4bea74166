# SPDX-License-Identifier: BSD-3-Clause
"""The tables of docs/verification/known_problems.md, measured anew.

`PYTHONPATH=tests ./dev python -m cases.known_tables` prints them; it takes about two minutes.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

import bezsoma as bz
from cases.exact import square_torsion_constant
from cases.test_known_problems import (
    BARS,
    SPHERE,
    energy,
    largest_error,
    rate,
    slab,
    solved,
    sphere,
    twisted_square,
)

FOLDER = Path(__file__).resolve().parents[2] / "cases" / "verification"
COOK = {1 / 3: (22.61047, 21.52456, 10.795109), 0.4999: (19.42817, 18.51183, 9.283614)}
"""Corner and middle (mm) and energy (N mm) by `cases.cook_plane`, sixteen layers."""


def table(head: Iterable[object], rows: Iterable[Iterable[object]]) -> str:
    """A table in Markdown."""
    lines = [list(map(str, row)) for row in (head, *rows)]
    lines.insert(1, ["---"] * len(lines[0]))
    return "\n".join(f"| {' | '.join(line)} |" for line in lines) + "\n"


def of_sphere() -> Iterator[list[object]]:
    """Errors and rates of Lame's sphere by degree and mesh."""
    for degree, meshes in {1: (4, 8, 16), 2: (2, 4, 8), 3: (2, 4, 8), 4: (2, 4, 8)}.items():
        last = None
        for cells in meshes:
            field = sphere(degree, cells).displacement
            errors = np.array(
                [
                    field.l2_error(SPHERE.displacement, 2 * degree + 6),
                    field.h1_error(SPHERE.gradient, 2 * degree + 6),
                ]
            )
            rates = ["", ""]
            if last is not None:
                pairs = np.column_stack([last, errors])
                rates = [f"{rate(pair, 2):.2f}" for pair in pairs]
            shown = [f"{error:.2e}" for error in errors]
            yield [degree, cells, 3 * field.net.count, shown[0], rates[0], shown[1], rates[1]]
            last = errors


def of_bars() -> Iterator[list[object]]:
    """Relative errors of the polynomial solutions on faceted bars."""
    for name, bar in BARS.items():
        for degree in range(1, bar.degree + 3):
            errors = largest_error(solved(bar, degree), bar.exact)
            yield [name, degree, *(f"{error:.1e}" for error in errors)]


def of_square() -> Iterator[list[object]]:
    """The torsion constant of a square, by degree."""
    for degree in range(1, 7):
        found = twisted_square(degree, 4)
        yield [degree, f"{found:.8f}", f"{found / square_torsion_constant() - 1:.1e}"]


def of_cook(nu: float) -> Iterator[list[object]]:
    """Cook's membrane by mesh and degree: corner, middle, energy, and how much each lacks."""
    corner, middle, whole = COOK[nu]
    for cells, degrees in {4: (1, 2, 3, 4, 6), 8: (1, 2, 3, 4, 5), 16: (1, 2, 3)}.items():
        for degree in degrees:
            u = slab(degree, cells, nu).displacement
            at = u.at(np.array([[48, 60, 24 / cells], [48, 52, 24 / cells]]))[:, 1]
            stored = energy(degree, cells, nu)
            pairs = zip((*at, stored), (corner, middle, whole), strict=True)
            shown = [f"{found:.4f} ({100 * (found / exact - 1):+.2f} %)" for found, exact in pairs]
            yield [cells, degree, 3 * u.net.count, *shown]


def of_case(name: str, degrees: Iterable[int], quantities: list[str]) -> Iterator[list[object]]:
    """What `bezsoma run --degree` finds for a case."""
    case = bz.read_case(FOLDER / f"{name}.toml")
    for degree in degrees:
        with TemporaryDirectory() as folder:
            summary = bz.run_case(case, Path(folder) / "out", degree=degree).summary
        found = {check["of"]: f"{check['found']:.6g}" for check in summary["expectations"]}
        found |= {
            f"{probe}.{axis}": f"{value:.6g}"
            for probe, moved in summary["probes"].items()
            for axis, value in zip(
                ("x", "y", "z", "size"), [*moved["displacement"], moved["size"]], strict=True
            )
        }
        yield [degree, *(found.get(quantity, "") for quantity in quantities)]


def tables() -> Iterator[tuple[str, str]]:
    """Title and table of each."""
    errors = ["L2 error", "rate", "H1 error", "rate"]
    yield "sphere", table(["degree", "cells", "unknowns", *errors], of_sphere())
    asked = ["inside.z", "middle.size", "outside.y", "energy"]
    yield "sphere, case", table(["degree", *asked], of_case("sphere", (1, 2, 3), asked))
    yield "bars", table(["bar", "degree", "displacement", "stress"], of_bars())
    yield "square", table(["degree", "J / a^4", "too stiff by"], of_square())
    asked = ["tip.z", "middle.stress.xx"]
    yield "cantilever", table(["degree", *asked], of_case("cantilever", (1, 2, 3, 4, 5), asked))
    for nu in COOK:
        head = ["cells", "degree", "unknowns", "corner, mm", "middle, mm", "energy, N mm"]
        yield f"cook, nu = {nu:.4f}", table(head, of_cook(nu))


if __name__ == "__main__":
    for title, text in tables():
        print(f"{title}\n\n{text}", flush=True)
