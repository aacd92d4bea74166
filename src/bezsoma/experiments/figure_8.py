# SPDX-License-Identifier: BSD-3-Clause
"""Figure 8: a block that stiffens; four readings of the paper's strain, and laws with energy."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Annotated

import numpy as np

import bezsoma as bz
from bezsoma.experiments.blocks import CELLS, TETS, pulled
from bezsoma.experiments.report import Picture, Report, Table, Tables
from bezsoma.mechanics.materials import Material
from bezsoma.view.graph import Graph, Line, graph_picture

E, NU, A = 1.0, 0.25, 5.0
FORCES = {"points": (0.5, 1.0, 1.5, 2.0), "squares": (5.0, 10.0, 15.0, 20.0)}
"""N; a force that is spread strains the block ten times less."""
LAWS: dict[str, Material] = {
    "linear": bz.LinearElastic(E, NU),
    "Frobenius": bz.Stiffening(E, NU, A),
    "Frobenius, engineering shears": bz.Stiffening(E, NU, A, shears="engineering"),
    "mean": bz.Stiffening(E, NU, A, "mean"),
    "mean, engineering shears": bz.Stiffening(E, NU, A, "mean", "engineering"),
    "energy": bz.Stiffening(E, NU, A, "energy"),
    "deviatoric": bz.Stiffening(E, NU, A, "deviatoric"),
}
COLOURS = ("#22262b", "#b3312c", "#d98324", "#1f4e79", "#4f9bd9", "#3c8d40", "#6a3d9a")
DEGREE = 2


@dataclass(frozen=True)
class Row:
    """The largest displacement under a force by one law; how much of the force it bore."""

    support: str
    law: str
    force: Annotated[float, "force, N"]
    largest: Annotated[float, "largest displacement, mm"]
    borne: Annotated[float, "part of the force that was borne"]
    iterations: int = 0


@cache
def row(support: str, law: str, force: float) -> Row:
    """One solve; where no equilibrium is found, the last one that was, and how far it came."""
    body, borne = pulled(support, CELLS, DEGREE, LAWS[law], force), 1.0
    try:
        found = bz.solve(body)
    except bz.NotConverged as failure:
        if failure.last is None:
            return Row(support, law, force, float("nan"), 0.0, 0)
        found, borne = failure.last, failure.fraction
    steps = 1 if law == "linear" else found.iterations
    return Row(support, law, force, found.largest_displacement, borne, steps)


def measured(quick: bool = False) -> Tables:
    """All laws, at points as the paper and on squares."""
    rows = [
        row(support, law, force)
        for support, forces in FORCES.items()
        for law in LAWS
        for force in (forces[:1] if quick else forces)
    ]
    about = f"The block, degree {DEGREE}, {TETS} tets, E0 = 1 MPa, nu = 0.25, A = 5."
    held = {"largest": 1e-5, "borne": 1e-9}
    return {"laws": Table(about, rows, ("support", "law", "force"), held)}


def graph(tables: Tables) -> bytes:
    """Largest displacement over force."""
    panels = []
    for support, title in {
        "squares": "squares held, force on a square",
        "points": "as the paper: corners held, force at a point",
    }.items():
        lines = []
        for name, colour in zip(LAWS, COLOURS, strict=True):
            rows = [r for r in tables["laws"].where(support=support, law=name) if r.borne == 1]
            if rows:
                points = np.array([[0.0, 0.0], *([r.force, r.largest] for r in rows)])
                style = "--" if "engineering" in name else "-"
                lines.append(Line(points, name, colour, style, "o"))
        panels.append(Graph(title, lines, "force, N", "largest displacement, mm"))
    return graph_picture(None, panels, size=(1200, 540))


def finding(tables: Tables) -> str:
    """What is found."""
    by = tables["laws"]
    straight = by.row(support="squares", law="linear", force=20.0).largest
    less = {
        name: 100 * (1 - by.row(support="squares", law=name, force=20.0).largest / straight)
        for name in LAWS
        if name != "linear"
    }
    listed = ", ".join(f"{name} {value:.0f} %" for name, value in less.items())
    shortfall = [r for r in by.rows if r.borne < 1]
    unborne = "".join(
        f" {r.law} ({r.support}) bore {100 * r.borne:.0f} % of {r.force:g} N." for r in shortfall
    )
    return (
        "The linear block gives way in proportion; every reading of the strain bends the curve "
        "down, as the paper says. By how much depends on the reading more than on anything "
        "else: under 20 N on squares the largest displacement is smaller than the linear one by "
        f"{listed}.{unborne}"
    )


def told(tables: Tables) -> Report:
    """The page."""
    return Report(
        "Figure 8: linear and stiffening",
        "A block under 0.5, 1.0, 1.5 and 2.0, degree 2, nu = 0.25, E = E0 exp(A eps^2) with A = "
        "5: the linear one shows the linear relation of force and displacement, the other "
        "stiffens.",
        finding(tables),
        "The paper offers two norms of the strain and prints engineering shears in a tensor; so "
        "there are four readings, and its curves do not say which was drawn. With engineering "
        "shears the law depends on the frame. The mean is at most a third of the Frobenius "
        "norm, so that A means another thing with it. None of the four has an energy; the "
        "energy and the deviatoric measure, which are ours, have, and their tangents are "
        "symmetric. Under a point force the strain at the point is as large as the mesh lets it "
        "be, and so is the stiffening: those curves belong to the mesh.",
        tables,
        {"curves": Picture(graph(tables), "Largest displacement over force, by law.")},
    )
