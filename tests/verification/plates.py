# SPDX-License-Identifier: BSD-3-Clause
"""Plates and membranes: NAFEMS's, Cook's, and plates with polynomial or series solutions."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

import bezsoma as bz
from bezsoma.arrays import Floats
from bezsoma.mesh import block
from convergence.test_exact import MESHES
from verification.bodies import HOOKE, TG, coming_back, field, mapped
from verification.problem import ANALYTICAL, EXACT, PUBLISHED, Family, Value

FAMILY = Family("plates", "Plates and membranes as solids of tets.")
STEEL = bz.LinearElastic(E=210e3, nu=0.3)
NAFEMS = "NAFEMS, The Standard NAFEMS Benchmarks, rev. 3 (1990)"


def quarter_ellipse(cells: tuple[int, int, int], thickness: float) -> bz.TetMesh:
    """Between the ellipses x = 2, y = 1 and x = 3.25, y = 2.75 (m, here mm after 1000 times).

    Surfaces: inner (x = 2 cos t, y = sin t), outer, AB (y = 0), CD (x = 0), bottom, top. Cells are
    smaller towards the inner ellipse and towards D, where the stress is asked.
    """
    flat = block((1.0, 1.0, thickness), cells)

    def bent(p: Floats) -> Floats:
        t, s = np.pi / 2 * p[:, 1] ** 1.5, p[:, 0] ** 2
        x = (2.0 + 1.25 * s) * np.cos(t)
        y = (1.0 + 1.75 * s) * np.sin(t)
        return np.stack([1000 * x, 1000 * y, p[:, 2]], axis=1)

    names = {"left": "inner", "right": "outer", "front": "AB", "back": "CD"}
    moved = mapped(flat, bent)
    surfaces = {names.get(name, name): facets for name, facets in moved.surfaces.items()}
    return bz.TetMesh(moved.points, moved.tets, surfaces=surfaces)


PLANES = [bz.Fixed("AB", components="y"), bz.Fixed("CD", components="x")]


def membrane(degree: int, cells: tuple[int, int, int]) -> bz.Body:
    """LE1: 100 mm thick, 10 MPa outwards on the outer edge."""
    held = [*PLANES, bz.Fixed("bottom", components="z")]
    loads = [bz.Pressure("outer", value=-10.0)]
    return bz.Body(quarter_ellipse(cells, 100.0), degree, STEEL, held, loads)


def le1() -> Iterator[Value]:
    """The elliptic membrane: s_yy at D (2, 0)."""
    runs = (
        (2, (8, 16, 1), 0.025),
        (2, (8, 32, 1), 0.01),
        (3, (6, 32, 1), 0.015),
        (4, (4, 32, 1), 0.015),
    )
    for degree, cells, within in runs:
        yield at_d(membrane(degree, cells), (2000.0, 0.0, 50.0), 92.7, within)


def thick_plate(degree: int, cells: tuple[int, int, int]) -> bz.Body:
    """LE10: 600 mm thick, 1 MPa on its top.

    The outer face is held in x and y, and in z along its middle line.
    """
    mesh = quarter_ellipse(cells, 600.0)
    outer = mesh.points[mesh.vertices_of("outer")]
    line = outer[np.isclose(outer[:, 2], 300.0)]
    mesh = mesh.with_edges("line", line[np.argsort(line[:, 1])])
    held = [*PLANES, bz.Fixed("outer", components="xy"), bz.Fixed("line", components="z")]
    return bz.Body(mesh, degree, STEEL, held, [bz.Pressure("top", value=1.0)])


def le10() -> Iterator[Value]:
    """The thick elliptic plate: s_yy at D (2, 0) on the top."""
    for degree, cells, within in (
        (3, (6, 16, 2), 0.05),
        (3, (6, 32, 2), 0.03),
        (4, (4, 32, 2), 0.02),
    ):
        yield at_d(thick_plate(degree, cells), (2000.0, 0.0, 600.0), -5.38, within)


def at_d(body: bz.Body, point: tuple[float, float, float], wanted: float, within: float) -> Value:
    """The stress at D, averaged between tets."""
    stress = bz.solve(body).stress.averaged().at(np.array([point]))[0].reshape(3, 3)
    where = f"degree {body.degree}, {len(body.mesh.tets)} tets"
    return Value("s_yy at D, MPa", where, float(stress[1, 1]), wanted, within)


def plate(cells: int, thickness: float) -> bz.TetMesh:
    """A quarter of a square plate of side 1, its middle at the origin."""
    return block((0.5, 0.5, thickness), (cells, cells, 1), origin=(0, 0, -thickness / 2))


def square(held: str, wanted: float, within: float) -> Iterator[Value]:
    """The middle of a square plate under an even load, times D / (q a^4)."""
    t, q = 0.02, 1e-6
    D = HOOKE.E * t**3 / (12 * (1 - HOOKE.nu**2))
    planes = [bz.Fixed("left", components="x"), bz.Fixed("front", components="y")]
    sides = {
        "clamped": [bz.Fixed("right", "back")],
        "supported": [bz.Fixed("right", components="yz"), bz.Fixed("back", components="xz")],
    }[held]
    for degree, cells in ((3, 6), (4, 4)):
        mesh = plate(cells, t)
        body = bz.Body(
            mesh, degree, HOOKE, [*planes, *sides], [bz.Traction("top", value=(0, 0, q))]
        )
        found = bz.solve(body, solver="direct")
        w = float(found.displacement.at(np.zeros((1, 3)))[0, 2])
        where = f"degree {degree}, {len(mesh.tets)} tets, t/a = {t}"
        yield Value("w D / (q a^4)", where, w * D / q, wanted, within)


def polynomial(u: tuple[str, str, str], degrees: tuple[int, ...]) -> Iterator[Value]:
    yield from coming_back(field(u), HOOKE, MESHES["brick"](), degrees, 0.0)


POLYGON = "straight tets: the ellipse is a polygon; measured, cells smaller towards D"
FAMILY.add(
    "NAFEMS LE1: elliptic membrane", PUBLISHED, f"{NAFEMS}, LE1", "s_yy = 92.7 MPa at D",
    POLYGON, le1,
)  # fmt: skip
FAMILY.add(
    "NAFEMS LE10: thick plate under pressure", PUBLISHED, f"{NAFEMS}, LE10",
    "s_yy = -5.38 MPa at D", POLYGON, le10,
)  # fmt: skip
KRIEGER = "S. Timoshenko and S. Woinowsky-Krieger, Theory of Plates and Shells, 2nd ed. (1959)"
THIN = "the formula is of a thin plate: shear adds some (t/a)^2, and a coarse mesh is stiff"
FAMILY.add(
    "Square plate, supported",
    ANALYTICAL,
    f"{KRIEGER}, table 8",
    "w = 0.00406 q a^4 / D",
    THIN,
    square,
    "supported",
    0.00406,
    0.02,
)
FAMILY.add(
    "Square plate, clamped",
    PUBLISHED,
    f"{KRIEGER}, table 35",
    "w = 0.00126 q a^4 / D",
    THIN,
    square,
    "clamped",
    0.00126,
    0.03,
)
SPHERE = ("-0.01*x*z", "-0.01*y*z", "0.005*(x**2 + y**2) + 3/700*z**2")
POLYNOMIALS = {
    "Plate bent to a sphere": (SPHERE, (2, 3)),
    "Plate bent to a saddle": (("-0.01*x*z", "0.01*y*z", "0.005*(x**2 - y**2)"), (2, 3)),
    "Plate twisted by edge moments": (("-0.01*y*z", "-0.01*x*z", "0.01*x*y"), (2, 3)),
    "Membrane stretched on all sides": (("0.01*x", "0.01*y", "-3/350*z"), (1, 2)),
    "Membrane in shear": (("0.01*y", "0.01*x", "0"), (1, 2)),
}  # fmt: skip
for name, (u, degrees) in POLYNOMIALS.items():
    FAMILY.add(
        name,
        ANALYTICAL,
        f"{TG}, arts. 102 and 103",
        f"u = ({', '.join(u)})",
        EXACT,
        polynomial,
        u,
        degrees,
    )
