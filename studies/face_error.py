# SPDX-License-Identifier: BSD-3-Clause
"""The real face: how far its chin is from that of a much finer solution, and how far it says it is.

The jaw moves 5 mm forward (cases/face_small_jaw_forward.toml, face_large_...); asked for is the
mean displacement of the skin within 3 mm of the chin. Rows: degrees 1 to 4 on the mesh as it is,
and degree 2 on the mesh cut once and twice for the sake of that mean. The truth is the answer of
degree 5 (the large mesh: 4) on the mesh that was cut once; it comes last. Run as

    python studies/face_error.py [folder] [small|large]

with the meshes where the cases look for them. It leaves face_error_small.csv (or _large) in the
folder (docs/verification where none is given), each row as soon as it is known.
"""

from __future__ import annotations

import csv
import sys
from collections.abc import Iterator
from dataclasses import asdict, dataclass, fields, replace
from pathlib import Path

import numpy as np

import bezsoma as bz
from bezsoma.case.build import body_of
from bezsoma.case.sources import mesh_of
from bezsoma.refinement.bisection import Cuts, bisected
from bezsoma.refinement.loop import BULK, TIMES
from bezsoma.refinement.marking import bulk
from bezsoma.refinement.means import mean
from bezsoma.refinement.raised import raised
from bezsoma.refinement.targets import around

RADIUS = 3.0
DEGREES = {"small": (1, 2, 3, 4), "large": (1, 2, 3)}
TRUTH = {"small": 5, "large": 4}


@dataclass(frozen=True)
class Row:
    """A solution, the mean displacement at the chin and its estimated error, mm."""

    mesh: str
    degree: int
    tets: int
    unknowns: int
    x: float
    y: float
    z: float
    error_x: float
    error_y: float
    error_z: float
    size: float
    product: float
    energy: float


def row(name: str, solution: bz.Solution, place: bz.PatchMean) -> Row:
    """What one solution says of itself."""
    richer = raised(solution)
    found = bz.vector_estimate(solution, place, richer=richer)
    energy = bz.energy_estimate(solution, richer=richer).relative
    return Row(
        name,
        solution.body.degree,
        len(solution.body.mesh.tets),
        3 * solution.net.count,
        *found.value.tolist(),
        *found.error.tolist(),
        found.size,
        found.along.product,
        energy,
    )


def cut_for(solution: bz.Solution, place: bz.PatchMean, cuts: Cuts | None) -> tuple[bz.Body, Cuts]:
    """The body on tets cut as `refined` cuts them, for a mean over a place."""
    along = bz.vector_estimate(solution, place).along
    chosen = bulk(np.abs(along.of_tet), BULK)
    finer = bisected(solution.body.mesh, chosen, cuts, TIMES)
    return replace(solution.body, mesh=finer.mesh), finer.cuts


def rows(size: str) -> Iterator[Row]:
    """All of them; the truth comes last, with no errors of its own."""
    folder = Path(__file__).parent.parent / "cases"
    case = bz.read_case(folder / f"face_{size}_jaw_forward.toml")
    mesh = mesh_of(case)
    chin = next(probe for probe in case.file.probe if probe.name == "chin")
    assert not isinstance(chin.point, str)
    place = around("chin", np.array(chin.point), RADIUS, "skin").goals[0]
    assert isinstance(place, bz.PatchMean)
    for degree in DEGREES[size]:
        yield row("as it is", bz.solve(body_of(case, mesh, degree)), place)
    once, cuts = cut_for(bz.solve(body_of(case, mesh, 2)), place, None)
    twice, _ = cut_for(bz.solve(once), place, cuts)
    yield row("cut once", bz.solve(once), place)
    yield row("cut twice", bz.solve(twice), place)
    yield truth(once, TRUTH[size], place)


def truth(body: bz.Body, degree: int, place: bz.PatchMean) -> Row:
    """The mean of a much finer solution, which says nothing of its own error."""
    solution = bz.solve(replace(body, degree=degree), rtol=1e-8)
    values = [mean(replace(place, direction=axis), solution.displacement) for axis in "xyz"]
    sizes = (len(body.mesh.tets), 3 * solution.net.count)
    return Row("cut once", degree, *sizes, *values, *[0.0] * 6)


def main(words: list[str]) -> None:
    """The sizes that the words name, small where they name none."""
    sizes = [word for word in words if word in DEGREES] or ["small"]
    rest = [word for word in words if word not in DEGREES]
    folder = Path(rest[0]) if rest else Path(__file__).parent.parent / "docs" / "verification"
    for size in sizes:
        with (folder / f"face_error_{size}.csv").open("w", newline="", encoding="utf-8") as file:
            table = csv.DictWriter(file, [each.name for each in fields(Row)])
            table.writeheader()
            for each in rows(size):
                table.writerow(
                    {k: f"{v:.6g}" if isinstance(v, float) else v for k, v in asdict(each).items()}
                )
                file.flush()
                print(each, flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
