# SPDX-License-Identifier: BSD-3-Clause
"""Figure 4: control nets of linear, quadratic and cubic Bezier tets, and Bernstein polynomials."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bezsoma import bernstein
from bezsoma.arrays import Floats
from bezsoma.experiments.nets_drawn import PARTS, faces_of, net_lines, surface
from bezsoma.experiments.report import Picture, Report, Table, Tables
from bezsoma.view.graph import Graph, graph_picture

CORNERS = np.array([[0.0, 0, 0], [1.0, 0, 0], [0.35, 0.95, 0], [0.45, 0.35, 0.9]])
DEGREES = (1, 2, 3)
POLYNOMIALS = ((3, 0, 0), (2, 1, 0), (1, 1, 1))


@dataclass(frozen=True)
class Net:
    """How many controls a tet of a degree has in all, on a face and inside; what they sum to."""

    degree: int
    controls: int
    on_a_face: int
    inside: int
    sum_of_polynomials: float
    least_value: float


@dataclass(frozen=True)
class Peak:
    """The largest value of a cubic Bernstein polynomial on a triangle, found and by formula."""

    polynomial: str
    largest: float
    formula: float


def measured(quick: bool = False) -> Tables:
    """Counts of controls; maxima of the polynomials."""
    points = np.random.default_rng(1).dirichlet(np.ones(4), 2000)
    nets = [net(degree, points) for degree in (*DEGREES, 4, 6, 10)]
    peaks = [peak(alpha) for alpha in POLYNOMIALS]
    exact = {"sum_of_polynomials": 1e-12, "controls": 0.0, "on_a_face": 0.0, "inside": 0.0}
    return {
        "nets": Table("Controls of one tet; 2,000 points in it.", nets, ("degree",), exact),
        "peaks": Table(
            "Cubic polynomials on a triangle.", peaks, ("polynomial",), {"largest": 1e-12}
        ),
    }


def net(degree: int, points: Floats) -> Net:
    """A row of the first table."""
    values = bernstein.values(degree, points)
    inside = bernstein.count(degree - 4, 3) if degree > 3 else 0
    total = values.sum(axis=1)
    worst = float(total[np.abs(total - 1).argmax()])
    counts = bernstein.count(degree, 3), bernstein.count(degree, 2), inside
    return Net(degree, *counts, worst, float(values.min()))


def peak(alpha: tuple[int, ...]) -> Peak:
    """B_alpha is largest at alpha/n, where it is n!/alpha! (alpha/n)^alpha."""
    bary = bernstein.domain_points(18, 2)
    at = int(bernstein.position(np.array(alpha)))
    largest = float(bernstein.values(3, bary)[:, at].max())
    factors = [(a / 3) ** a for a in alpha]
    formula = float(bernstein.multinomials(3, 2)[at] * np.prod(factors))
    return Peak("B_" + "".join(map(str, alpha)), largest, formula)


def bent(degree: int) -> Floats:
    """Controls of a curved tet: those of the straight one, pushed outwards along its edges."""
    bary = bernstein.domain_points(degree, 3)
    controls = bary @ CORNERS
    away = controls - CORNERS.mean(axis=0)
    on_rim = (bary.max(axis=1) < 1)[:, None]
    outwards = 0.75 * np.sin(np.pi * bary.max(axis=1))[:, None] ** 2
    pushed: Floats = controls + on_rim * outwards * away
    return pushed


def patches() -> bytes:
    """The nets of one tet of degree 1, 2 and 3, with the patches that they control."""
    shown = [
        Graph(
            f"degree {degree}: {bernstein.count(degree, 3)} controls",
            net_lines(bent(degree), degree, 3, "#1f4e79"),
            tiles=[surface(faces_of(bent(degree), degree), opacity=0.75)],
            drawing=True,
        )
        for degree in DEGREES
    ]
    return graph_picture(None, shown, columns=3, size=(1200, 460))


def polynomials() -> bytes:
    """Three cubic polynomials over a triangle, with the controls that make them."""
    bary, base = bernstein.domain_points(PARTS, 2), CORNERS[:3, :2]
    shown = []
    for alpha in POLYNOMIALS:
        at = int(bernstein.position(np.array(alpha)))
        height = bernstein.values(3, bary)[:, at]
        over = np.column_stack([bary @ base, height])
        ground = np.column_stack([bary @ base, 0 * height])
        controls = np.column_stack([bernstein.domain_points(3, 2) @ base, np.zeros(10)])
        controls[at, 2] = 1.0
        grey = surface(ground[None], np.array([0.87, 0.89, 0.91]), 1.0)
        shown.append(
            Graph(
                f"B with exponents {alpha}".replace("(", "").replace(")", ""),
                net_lines(controls, 3, 2, "#7a828c", width=0.8),
                tiles=[grey, surface(over[None])],
                drawing=True,
            )
        )
    return graph_picture(None, shown, columns=3, size=(1200, 480))


def finding(tables: Tables) -> str:
    """What is found."""
    cubic = tables["nets"].row(degree=3)
    inside = str(cubic.inside) if cubic.inside else "none"
    off = max(abs(row.sum_of_polynomials - 1) for row in tables["nets"].rows)
    least = min(row.least_value for row in tables["nets"].rows)
    heights = ", ".join(f"{row.polynomial} {row.largest:.4f}" for row in tables["peaks"].rows)
    return (
        f"The same for any degree; a cubic tet has {cubic.controls} controls, {cubic.on_a_face} of "
        f"them on each face, {inside} inside. The polynomials sum to one within {off:.0e} and "
        f"{'are nowhere negative' if least >= 0 else f'fall to {least:.0e}'}, so a patch stays "
        f"within the hull of its controls. Largest values: {heights}."
    )


def told(tables: Tables) -> Report:
    """The page."""
    return Report(
        "Figure 4: control nets and Bernstein polynomials",
        "Control nets of linear, quadratic and cubic Bezier tets, and three cubic Bernstein "
        "polynomials on a triangle.",
        finding(tables),
        "They do not; but the paper calls controls vertices, and of the cubic net only the four "
        "corners lie on the patch, as the drawing shows. A control is not a value at a point, so "
        "data that is given as values has to be converted.",
        tables,
        {
            "nets": Picture(patches(), "Bezier tets of degree 1, 2 and 3 with their control nets."),
            "polynomials": Picture(
                polynomials(),
                "Cubic Bernstein polynomials over a triangle; grey: their controls, one of them "
                "lifted to 1.",
            ),
        },
    )
