# SPDX-License-Identifier: BSD-3-Clause
"""Bars twisted with free warping: moments of sections, and the exact fields of some."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

import bezsoma as bz
from bezsoma.arrays import Floats
from bezsoma.mesh import block
from cases.exact import square_torsion_constant
from cases.test_known_problems import BARS, largest_error, solved
from convergence.test_exact import MESHES
from verification.bodies import HOOKE, TG, coming_back, field, prism
from verification.problem import ANALYTICAL, EXACT, PUBLISHED, Family, Value

FAMILY = Family("torsion", "Saint-Venant's torsion: ends turned against each other, free to warp.")
LAW = bz.LinearElastic(E=2.5, nu=0.25)
"""With G = 1 MPa."""


def twisted(mesh: bz.TetMesh, degree: int, height: float) -> bz.Solution:
    """A prism whose top is turned about the z axis, 1 rad/mm, free to warp."""
    corner = mesh.points[mesh.points[:, 2] == 0]
    middle = corner[np.argmin(np.hypot(corner[:, 0], corner[:, 1]))]
    mesh = mesh.with_vertices("one", [middle])
    turn = bz.Polynomial.parse([f"-{height}*y", f"{height}*x", 0])
    held = [
        bz.Fixed("bottom", components="xy"),
        bz.Prescribed("top", value=turn, components="xy"),
        bz.Fixed("one", components="z"),
    ]
    return bz.solve(bz.Body(mesh, degree, LAW, held), solver="direct")


def constant(mesh: bz.TetMesh, degree: int, height: float) -> float:
    """J [mm4] of a prism: the moment at 1 rad/mm, G = 1."""
    return float(twisted(mesh, degree, height).reactions["top"].moment[2])


def rectangle_constant(ratio: float) -> float:
    """J / (long side x short side^3), the series of art. 109."""
    n = np.arange(1, 200, 2)
    terms = np.tanh(n * np.pi * ratio / 2) / n**5
    return float((1 - 192 / np.pi**5 / ratio * terms.sum()) / 3)


def slice_of_bar(ratio: float) -> bz.TetMesh:
    """0.5 mm of a bar of a rectangle, its sides 1 and `ratio` mm, about the z axis."""
    cells = (2 * round(2 * ratio), 4, 1)
    return block((ratio, 1.0, 0.5), cells, origin=(-ratio / 2, -0.5, 0.0))


def rectangle(ratio: float) -> Iterator[Value]:
    wanted = rectangle_constant(ratio) * ratio
    for degree, within in ((3, 2e-3), (4, 3e-4), (5, 5e-5)):
        mesh = slice_of_bar(ratio)
        where = f"degree {degree}, {len(mesh.tets)} tets"
        yield Value("J, mm4", where, constant(mesh, degree, 0.5), wanted, within)


def series() -> Iterator[Value]:
    for ratio, printed in ((1.0, 0.1406), (1.5, 0.196), (2.0, 0.229), (3.0, 0.263), (10.0, 0.312)):
        found = rectangle_constant(ratio)
        yield Value("J / (b a^3)", f"b/a = {ratio:g}", found, printed, 5e-3)
    yield Value("J / a^4", "square", square_torsion_constant(), rectangle_constant(1.0), 1e-12)


def equilateral(points: Floats) -> Floats:
    """The right triangle to one of side 1 about its centre."""
    x, y, z = points.T
    return np.stack([x - y / 2 - 0.5, np.sqrt(3) / 2 * y - np.sqrt(3) / 6, z], axis=1)


def isosceles(points: Floats) -> Floats:
    """Legs of 1 mm, about the centre."""
    return points - np.array([2 / 3, 1 / 3, 0.0])


def triangle(which: str, wanted: float, values: tuple[tuple[int, float], ...]) -> Iterator[Value]:
    to = {"equilateral": equilateral, "isosceles": isosceles}[which]
    for degree, within in values:
        mesh = prism(3, 1, 0.5, to)
        where = f"degree {degree}, {len(mesh.tets)} tets"
        yield Value("J, mm4", where, constant(mesh, degree, 0.5), wanted, within)


def smooth(name: str) -> Iterator[Value]:
    bar = BARS[name]
    for degree in (bar.degree, bar.degree + 1):
        found = solved(bar, degree)
        u, s = largest_error(found, bar.exact)
        where = f"degree {degree}, {len(found.body.mesh.tets)} tets"
        yield Value("largest error of u", where, u, 0.0, 1e-10)
        yield Value("largest error of the stress", where, s, 0.0, 1e-9)


def polynomial(u: tuple[str, str, str], degrees: tuple[int, ...]) -> Iterator[Value]:
    yield from coming_back(field(u), HOOKE, MESHES["brick"](), degrees, 0.0)


CORNERS = "stress is not smooth at the corners; measured"
for ratio in (1.0, 1.5, 2.0, 3.0):
    answer = "J = b a^3 / 3 (1 - 192 a / (pi^5 b) sum tanh(n pi b / 2 a) / n^5), n odd"
    FAMILY.add(
        f"Rectangle, b/a = {ratio:g}",
        ANALYTICAL,
        f"{TG}, art. 109",
        answer,
        CORNERS,
        rectangle,
        ratio,
    )
FAMILY.add(
    "The series against the table",
    PUBLISHED,
    f"{TG}, table of art. 109",
    "k_1",
    "three digits are printed",
    series,
)
FAMILY.add(
    "Equilateral triangle", ANALYTICAL, f"{TG}, art. 105", "J = sqrt(3) a^4 / 80",
    "the warping is cubic, so exact from degree 3 on", triangle, "equilateral", np.sqrt(3) / 80,
    ((2, 0.05), (3, 1e-9), (4, 1e-9)),
)  # fmt: skip
FAMILY.add(
    "Right triangle with equal legs", PUBLISHED, "Roark's Formulas, table 10.1",
    "J = 0.0261 a^4", "three digits are printed", triangle, "isosceles", 0.0261,
    ((3, 6e-3), (5, 2.5e-3)),
)  # fmt: skip
for name, article in {"torsion, round": "art. 101", "torsion, elliptic": "art. 105"}.items():
    answer = "u = t (-y z, x z, (b^2 - a^2) / (a^2 + b^2) x y)"
    why = "exact, if flat facets carry the stress times their own normals"
    FAMILY.add(f"Faceted bar: {name}", ANALYTICAL, f"{TG}, {article}", answer, why, smooth, name)
ELLIPSE = ("-0.02*y*z", "0.02*x*z", "-0.012*x*y")
TRIANGLE = ("-0.02*y*z", "0.02*x*z", "0.005*(y**3 - 3*x**2*y)")
FAMILY.add(
    "Field of a twisted ellipse, half axes 2 and 1",
    ANALYTICAL,
    f"{TG}, art. 105",
    f"u = ({', '.join(ELLIPSE)})",
    EXACT,
    polynomial,
    ELLIPSE,
    (2, 3),
)
FAMILY.add(
    "Field of a twisted triangle",
    ANALYTICAL,
    f"{TG}, art. 105",
    f"u = ({', '.join(TRIANGLE)})",
    EXACT,
    polynomial,
    TRIANGLE,
    (3, 4),
)
