# SPDX-License-Identifier: BSD-3-Clause
"""Figure 6: a block by degree; a point force has no answer, a square has; degree or refinement."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from time import process_time
from typing import Annotated

import numpy as np

import bezsoma as bz
from bezsoma.experiments.blocks import CELLS, TETS, lifted, pulled
from bezsoma.experiments.report import Picture, Report, Table, Tables
from bezsoma.view.graph import Graph, Line, graph_picture

LAW = bz.LinearElastic(E=1.0, nu=0.25)
DEGREES = (1, 2, 3, 4, 6)
FORCES = (0.1, 0.5, 1.0)
HALVED = {
    "points": {1: (2, 4, 8, 16), 2: (2, 4, 8), 3: (2, 4, 8)},
    "squares": {1: (4, 8, 16, 32), 2: (4, 8, 16), 3: (4, 8, 16)},
}
"""Cells along an edge by support and degree."""
RACE = {1: (4, 8, 16, 32), 2: (4, 8, 16, 24), 3: (4, 8, 16), 4: (4, 8, 12), 6: (4, 8)}
EQUAL = (7803, 55539, 180075)
"""Unknowns that several of them have."""
REFERENCE = (6, 16)
"""Degree and cells of the answer that the others are compared with."""
COLOURS = {1: "#7a828c", 2: "#b3312c", 3: "#d98324", 4: "#3c8d40", 6: "#1f4e79"}


@dataclass(frozen=True)
class Pulled:
    """The block under one force by one degree, on the stated mesh."""

    support: str
    degree: int
    force: Annotated[float, "force, N"]
    unknowns: int
    middle: Annotated[float, "middle of the top, mm"]
    highest: Annotated[float, "largest displacement, mm"]


@dataclass(frozen=True)
class Halved:
    """The middle of the top under 1 N as the mesh is halved."""

    support: str
    degree: int
    cells: int
    middle: Annotated[float, "middle of the top, mm"]
    ratio: Annotated[float, "to the mesh before"]


@dataclass(frozen=True)
class Raced:
    """One solve of the block on squares, what it cost, and what is missing of the energy."""

    degree: int
    cells: int
    unknowns: int
    seconds: Annotated[float, "processor s"]
    energy: Annotated[float, "energy, N mm"]
    missing: Annotated[float, "missing of it"]


@cache
def solved(support: str, cells: int, degree: int) -> bz.Solution:
    """The block under 1 N."""
    return bz.solve(pulled(support, cells, degree, LAW, 1.0), rtol=1e-10)


def measured(quick: bool = False) -> Tables:
    """Both blocks by degree, both by mesh, and the race."""
    held = {"middle": 1e-6, "highest": 1e-6, "unknowns": 0.0}
    rows = [
        by_degree(support, degree, force)
        for support in ("points", "squares")
        for degree in (DEGREES[:3] if quick else DEGREES)
        for force in FORCES
    ]
    by_mesh = [
        each
        for support, meshes_of in HALVED.items()
        for degree, meshes in meshes_of.items()
        for each in halved(support, degree, meshes[:2] if quick else meshes)
    ]
    about = f"The block on the stated mesh, {TETS} tets, E = 1 MPa, nu = 0.25."
    return {
        "by_degree": Table(about, rows, ("support", "degree", "force"), held),
        "by_mesh": Table(
            "Under 1 N, the mesh halved.", by_mesh, ("support", "degree", "cells"), {"middle": 1e-6}
        ),
        "race": race(quick),
    }


def by_degree(support: str, degree: int, force: float) -> Pulled:
    """A row by degree; the equations are linear, so one solve serves all forces."""
    found = solved(support, CELLS, degree)
    top = force * found.largest_displacement
    return Pulled(support, degree, force, 3 * found.net.count, force * lifted(found), top)


def halved(support: str, degree: int, meshes: tuple[int, ...]) -> list[Halved]:
    """A row for each mesh."""
    moved = [lifted(solved(support, cells, degree)) for cells in meshes]
    ratios = [float("nan"), *(b / a for a, b in pairwise(moved))]
    return [Halved(support, degree, *row) for row in zip(meshes, moved, ratios, strict=True)]


def race(quick: bool) -> Table:
    """Degree against refinement on squares; the reference is a finer mesh of a higher degree."""
    chosen = {degree: meshes[: 1 if quick else None] for degree, meshes in RACE.items()}
    truth = ENERGY if quick else solved("squares", REFERENCE[1], REFERENCE[0]).energy
    rows = [raced(d, cells, truth) for d, meshes in chosen.items() for cells in meshes]
    about = (
        f"Squares under 1 N: against degree {REFERENCE[0]} on {3 * REFERENCE[1] ** 3:,} tets, "
        f"{truth:.6f} N mm. Processor seconds of `solve`, all threads together, to a residual of "
        "1e-8."
    )
    return Table(about, rows, ("degree", "cells"), {"energy": 1e-6, "unknowns": 0.0})


ENERGY = 0.102982
"""Of the reference as it was found, N mm; a quick run takes it as given."""


def raced(degree: int, cells: int, truth: float) -> Raced:
    """The faster of two solves: the first one also wakes the threads."""
    body = pulled("squares", cells, degree, LAW, 1.0)
    seconds: list[float] = []
    for _ in range(2):
        start = process_time()
        found = bz.solve(body)
        seconds.append(process_time() - start)
    energy = found.energy
    return Raced(degree, cells, 3 * found.net.count, min(seconds), energy, 1 - energy / truth)


def graph(tables: Tables) -> bytes:
    """What is missing over unknowns, and over seconds."""
    panels = []
    for what, across in {"unknowns": "unknowns", "seconds": "processor seconds"}.items():
        lines = []
        for degree in RACE:
            rows = list(tables["race"].where(degree=degree))
            points = np.array([[getattr(row, what), row.missing] for row in rows])
            lines.append(Line(points, f"degree {degree}", COLOURS[degree], "-", "o"))
        panels.append(Graph("", lines, across, "missing energy, relative", "xy"))
    return graph_picture(None, panels, size=(1200, 520))


def refinement(tables: Tables) -> bytes:
    """The middle of the top as the mesh is halved, with points and with squares."""
    panels = []
    for support, title in {
        "points": "corners held, force at a point",
        "squares": "squares held, force on a square",
    }.items():
        lines = []
        for degree in HALVED[support]:
            rows = tables["by_mesh"].where(support=support, degree=degree)
            points = np.array([[row.cells, row.middle] for row in rows])
            lines.append(Line(points, f"degree {degree}", COLOURS[degree], "-", "o"))
        panels.append(
            Graph(
                title,
                lines,
                "cells along an edge",
                "middle of the top, mm",
                "xy" if support == "points" else "x",
            )
        )
    return graph_picture(None, panels, size=(1200, 480))


def blocks() -> dict[str, Picture]:
    """The pulled block as the paper has it, by degree."""
    pictures = {}
    for degree in (1, 2, 3):
        found = solved("points", CELLS, degree)
        image = bz.picture(
            None, found.body.mesh, displacement=found.displacement, magnified=0.5,
            wires=True, size=(620, 620), title=f"degree {degree}, 1 N",
        )  # fmt: skip
        about = (
            f"Corners held, 1 N at the middle of the top, degree {degree}; drawn half as large, "
            "which is what 0.5 N do."
        )
        pictures[f"degree_{degree}"] = Picture(image, about)
    return pictures


def finding(tables: Tables) -> str:
    """What is found."""
    point, square = (
        {row.degree: row.middle for row in tables["by_degree"].where(support=s, force=1.0)}
        for s in ("points", "squares")
    )
    halves = [row.ratio for row in tables["by_mesh"].where(support="points", degree=1)][1:]
    ratios = ", ".join(f"{ratio:.2f}" for ratio in halves)
    return (
        f"On the stated mesh the point is drawn out by {listed(point)} mm of 1 N for degrees "
        f"{listed_degrees(point)}: it grows with every degree, and with degree 1 by factors of "
        f"{ratios} whenever the mesh is halved. There is no "
        "number to converge to. With squares held at the corners and the same force on the middle "
        f"quarter of the top the degrees give {listed(square)} mm, and settle.\n\n"
        "Degree against refinement, by the part of the energy that is missing. At equal unknowns, "
        + "; ".join(equal(tables["race"], unknowns) for unknowns in EQUAL)
        + f". At equal time, {in_time(tables['race'])}."
    )


def told(tables: Tables) -> Report:
    """The page."""
    return Report(
        "Figure 6: a block by degree",
        "A block of soft tissue, regularly cut into tets, held at its lower corners, a vertical "
        "force in the middle of its top; E = 1, nu = 0.25, forces 0.1, 0.5, 1.0. Higher degrees "
        "bring more detail; linear elements are incapable of bending.",
        finding(tables),
        "The paper reads the growth from degree to degree as detail that is gained. Most of it is "
        "the singularity: a point of an elastic body cannot bear a force, its displacement under "
        "one is infinite (as 1/r under Kelvin's force), and corners that are held at points sink "
        "in likewise. Finer spaces come closer to infinity. With squares the effect of the degree "
        "itself is left: large for degree 1, small beyond 3 (the limit is about 0.248 mm). The "
        "edges of the squares still bound the rates, so that a degree helps more than halving the "
        "mesh, though not exponentially.",
        tables,
        {
            **blocks(),
            "refinement": Picture(
                refinement(tables), "The middle of the top as the mesh is halved."
            ),
            "race": Picture(graph(tables), "Degree against refinement, by unknowns and by time."),
        },
    )


def equal(table: Table, unknowns: int) -> str:
    """What all runs with as many unknowns miss."""
    rows = [
        f"degree {r.degree} {r.missing:.3f} in {r.seconds:.2f} s"
        for r in table.where(unknowns=unknowns)
    ]
    return f"with {unknowns:,}: {', '.join(rows)}"


def in_time(table: Table) -> str:
    """What each degree misses after as many seconds, between two meshes along the graph's lines.

    The time is that at which the first of the lines ends; a line that begins later is left out.
    """
    runs = {degree: list(table.where(degree=degree)) for degree in RACE}
    seconds = min(max(r.seconds for r in rows) for rows in runs.values())
    missing = {
        degree: at_time(rows, seconds)
        for degree, rows in runs.items()
        if min(r.seconds for r in rows) <= seconds
    }
    least = min(missing, key=lambda degree: missing[degree])
    listed = ", ".join(f"degree {degree} {part:.3f}" for degree, part in missing.items())
    return f"in {seconds:.2f} processor seconds: {listed}; least by degree {least}"


def at_time(rows: Sequence[Raced], seconds: float) -> float:
    """The missing energy of a degree's line in the graph, which is straight between logarithms.

    >>> runs = [Raced(1, 4, 0, 0.01, 0, 0.4), Raced(1, 8, 0, 1.0, 0, 0.1)]
    >>> round(at_time(runs, 0.1), 12)
    0.2
    """
    rows = sorted(rows, key=lambda row: row.seconds)
    across, up = (np.log([getattr(r, what) for r in rows]) for what in ("seconds", "missing"))
    return float(np.exp(np.interp(np.log(seconds), across, up)))


def listed(found: dict[int, float]) -> str:
    """Numbers in a row."""
    return ", ".join(f"{value:.3f}" for value in found.values())


def listed_degrees(found: dict[int, float]) -> str:
    """Degrees in a row."""
    return ", ".join(map(str, found))
