# SPDX-License-Identifier: BSD-3-Clause
"""Who locks: the displacement form and the mixed form, degree 1 to 6, as nu goes to 1/2.

A quarter of a block of tissue stands on a fixed floor and is pressed from above by a smooth
traction; what is compared is the work of the load, int t . u, which a form that locks finds too
small. The truth is the mixed form of degree 5 on tets half as large.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from time import process_time
from typing import Annotated

import numpy as np

import bezsoma as bz
from bezsoma.experiments.report import Picture, Report, Table, Tables
from bezsoma.view.graph import Graph, Line, graph_picture

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
    seconds: Annotated[float, "processor s"]
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
    start = process_time()
    found = bz.solve(stated, rtol=RTOL)
    seconds = process_time() - start
    form, work = "mixed" if mixed else "displacement", 2 * found.energy
    deficit = abs(1 - work / truth)
    return Row(form, degree, nu, found.free, found.iterations, seconds, work, deficit)


def rows(quick: bool) -> Iterator[Row]:
    """All forms and degrees at every nu; quick: some, against degree 4 on the same tets."""
    for nu in (NUS[0], NUS[-2]) if quick else NUS:
        fine = (4, CELLS) if quick else (5, 2 * CELLS)
        truth = 2 * bz.solve(body(nu, fine[0], True, fine[1]), rtol=RTOL).energy
        for degree in DEGREES[:2] if quick else DEGREES:
            if nu < 0.5:
                yield row(nu, degree, False, truth)
            if degree > 1:
                yield row(nu, degree, True, truth)


def measured(quick: bool = False) -> Tables:
    """The work of the load by form, degree and nu."""
    about = (
        f"{6 * CELLS**3} tets; processor seconds of `solve`, all threads together; 2 or 3 "
        "iterations are refinements of factors."
    )
    held = {"work": 1e-6, "unknowns": 0.0, "iterations": 0.05}
    return {"locking": Table(about, list(rows(quick)), ("form", "degree", "nu"), held)}


def graph(tables: Tables) -> bytes:
    """What is missing against 1 - 2 nu, and against seconds."""
    left, right = [], []
    for form, style, mark in (("displacement", "-", "o"), ("mixed", "--", "s")):
        for degree in DEGREES:
            mine = list(tables["locking"].where(form=form, degree=degree))
            if not mine:
                continue
            away = np.array([[max(1 - 2 * r.nu, 3e-5), r.deficit] for r in mine])
            left.append(Line(away, "", COLOURS[degree], style, mark))
            near = np.array([[r.seconds, r.deficit] for r in mine if r.nu == NUS[-2]])
            right.append(Line(near, f"{form}, {degree}", COLOURS[degree], "", mark))
    missing = "missing work of the load, relative"
    panels = [
        Graph("who locks", left, "1 - 2 nu (the leftmost: nu = 1/2)", missing, "xy"),
        Graph("what it costs at nu = 0.4999", right, "processor seconds", missing, "xy"),
    ]
    return graph_picture(None, panels, size=(1320, 560))


def finding(tables: Tables) -> str:
    """What is found."""
    table = tables["locking"]

    def lacks(form: str, degree: int, nu: float) -> str:
        return f"{100 * table.row(form=form, degree=degree, nu=nu).deficit:.2g} %"

    return (
        "At nu = 0.4999 the displacement form of degree 1 misses "
        f"{lacks('displacement', 1, 0.4999)} of the work of the load, of degree 2 "
        f"{lacks('displacement', 2, 0.4999)}, of degree 4 {lacks('displacement', 4, 0.4999)}; "
        f"the mixed form of degree 2 {lacks('mixed', 2, 0.4999)}, and at nu = 1/2 "
        f"{lacks('mixed', 2, 0.5)}."
    )


def told(tables: Tables) -> Report:
    """The page."""
    return Report(
        "Who locks as nu goes to 1/2",
        "A result of the theory of finite elements: in order to prevent locking, the pressure "
        "has to be interpolated with a lower degree than the displacement.",
        finding(tables),
        "They agree, with one addition: the displacement form of a high degree hardly locks. "
        "What to take when is discussed in docs/theory/incompressible.md.",
        tables,
        {"locking": Picture(graph(tables), "What is missing of the work of the load.")},
    )
