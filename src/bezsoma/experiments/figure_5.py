# SPDX-License-Identifier: BSD-3-Clause
"""Figure 5: de Casteljau's algorithm on a cubic triangle and in a cubic tet."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bezsoma import bernstein
from bezsoma.arrays import Floats
from bezsoma.experiments.figure_4 import bent
from bezsoma.experiments.nets_drawn import net_lines
from bezsoma.experiments.report import Picture, Report, Table, Tables
from bezsoma.view.graph import Graph, graph_picture

DEGREE = 3
POINTS = {2: np.array([0.3, 0.25, 0.45]), 3: np.array([0.3, 0.25, 0.25, 0.2])}
COLOURS = ("#9aa3ac", "#1f4e79", "#3c8d40", "#b3312c")


@dataclass(frozen=True)
class Level:
    """The net after so many steps: its controls and how far the farthest is from the point."""

    dimension: int
    steps: int
    controls: int
    farthest: float
    off_the_polynomial: float


@dataclass(frozen=True)
class Halving:
    """How far nets lie from the patch, at the domain points, after so many subdivisions."""

    dimension: int
    subdivisions: int
    pieces: int
    net_from_patch: float


def controls_of(dim: int) -> Floats:
    """A curved net: of a flat triangle (10, 2) or of a tet (20, 3)."""
    if dim == 3:
        return bent(DEGREE)
    flat = bernstein.domain_points(DEGREE, 2) @ np.array([[0.0, 0], [1.0, 0], [0.4, 0.9]])
    away = flat - flat.mean(axis=0)
    turned = away @ np.array([[0.0, 1.0], [-1.0, 0.0]])
    curved: Floats = flat + 0.35 * away + 0.45 * turned * np.linalg.norm(away, axis=1)[:, None]
    return curved


def levels(dim: int) -> list[Floats]:
    """The nets of degree 3, 2, 1 and 0 at the point."""
    arguments = np.tile(POINTS[dim], (DEGREE, 1))
    return bernstein.de_casteljau_levels(controls_of(dim), DEGREE, arguments)


def measured(quick: bool = False) -> Tables:
    """How the nets shrink to a point of the patch, and how subdivision drives them there."""
    shrinking = [row for dim in POINTS for row in level_rows(dim)]
    halved = [row for dim in POINTS for row in halvings(dim, 2 if quick else 3)]
    about = "De Casteljau's nets; lengths in units of the patch's edge."
    return {
        "levels": Table(about, shrinking, ("dimension", "steps"), {"farthest": 1e-12}),
        "subdivision": Table(
            "The net against the patch when every edge is halved again and again.",
            halved,
            ("dimension", "subdivisions"),
            {"net_from_patch": 1e-10},
        ),
    }


def level_rows(dim: int) -> list[Level]:
    """A row for each level."""
    nets = levels(dim)
    exact = bernstein.values(DEGREE, POINTS[dim]) @ controls_of(dim)
    off = float(np.abs(nets[-1][0] - exact).max())
    far = [float(np.linalg.norm(net - exact, axis=1).max()) for net in nets]
    return [Level(dim, k, len(net), far[k], off) for k, net in enumerate(nets)]


def halvings(dim: int, times: int) -> list[Halving]:
    """Each simplex restricted to the corner pieces and the inner ones of its halved lattice."""
    nets, rows = [controls_of(dim)], []
    points = bernstein.values(DEGREE, bernstein.domain_points(DEGREE, dim))
    for k in range(times + 1):
        off = max(float(np.linalg.norm(net - points @ net, axis=1).max()) for net in nets)
        rows.append(Halving(dim, k, len(nets), off))
        if k < times:
            nets = [piece @ net for net in nets for piece in pieces(dim)]
    return rows


def pieces(dim: int) -> list[Floats]:
    """The matrices to the 2^d pieces of a simplex with halved edges."""
    middle = [
        [0.5 * (np.eye(dim + 1)[i] + np.eye(dim + 1)[j]) for j in range(dim + 1)]
        for i in range(dim + 1)
    ]
    corner = [[middle[i][j] for j in range(dim + 1)] for i in range(dim + 1)]
    inner = [[middle[0][1], middle[0][2], middle[1][2]]]
    if dim == 3:
        (ab, ac, ad), (bc, bd, cd) = (middle[0][1:], (middle[1][2], middle[1][3], middle[2][3]))
        inner = [[ab, ac, ad, bd], [ab, ac, bc, bd], [ac, ad, bd, cd], [ac, bc, bd, cd]]
    return [bernstein.restriction(DEGREE, dim, np.array(each)) for each in corner + inner]


def picture() -> bytes:
    """All nets over each other, in the plane and in space."""
    shown = []
    for dim, title in {2: "a cubic triangle", 3: "a cubic tet"}.items():
        lines = []
        for k, net in enumerate(levels(dim)):
            label = f"after {k} step{'s' * (k != 1)}" if dim == 2 else ""
            lines += net_lines(net, DEGREE - k, dim, COLOURS[k], label, 1.0 + 0.3 * k)
        shown.append(Graph(title, lines, drawing=True))
    return graph_picture(None, shown, size=(1200, 600))


def finding(tables: Tables) -> str:
    """What is found."""
    worst = max(row.off_the_polynomial for row in tables["levels"].rows)
    two, three = (
        tables["subdivision"].row(dimension=3, subdivisions=k).net_from_patch for k in (2, 3)
    )
    triangle, tet = (tables["levels"].row(dimension=dim, steps=0).controls for dim in (2, 3))
    return (
        f"Three steps of averages lead from {triangle} or {tet} controls to a point of the patch, "
        f"equal to the sum of the polynomials within {worst:.0e}. Subdivision drives the nets to "
        f"the patch: the distance falls by {two / three:.1f} from the second to the third halving "
        "of a tet."
    )


def told(tables: Tables) -> Report:
    """The page."""
    return Report(
        "Figure 5: de Casteljau's algorithm",
        "The algorithm in two and three dimensions for cubic patches; it serves to draw "
        "surfaces and to subdivide, so as to refine a solution step by step.",
        finding(tables),
        "They do not. The levels hold more than the paper says: their sides are the nets of the "
        "sub-simplices at the point, and with other arguments in each step (the blossom) the same "
        "averages give elevation, faces, and the pieces of a tet cut in eight.",
        tables,
        {
            "de_casteljau": Picture(
                picture(),
                "The nets of a cubic triangle and of a cubic tet after 0, 1, 2 and 3 steps.",
            )
        },
    )
