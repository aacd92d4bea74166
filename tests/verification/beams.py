# SPDX-License-Identifier: BSD-3-Clause
"""Bars and beams: in tension, under their weight, bent by moments, forces and loads."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

import bezsoma as bz
from bezsoma.mechanics.loads import Load
from bezsoma.mesh import block
from convergence.test_exact import MESHES
from convergence.test_patches import hung
from verification.bodies import HOOKE, TG, coming_back, field
from verification.problem import ANALYTICAL, EXACT, Family, Value
from verification.torsion import smooth

FAMILY = Family("beams", "Bars and beams: exact where Saint-Venant's solutions are polynomials.")
E, NU = HOOKE.E, HOOKE.nu
H = 1.0
"""Height and width of the beams, mm."""
COWPER = 10 * (1 + NU) / (12 + 11 * NU)
"""Shear coefficient of a rectangle, G. R. Cowper, doi:10.1115/1.3625046."""


def beam(length: float, cells: int, across: int = 1) -> bz.TetMesh:
    """A beam along x, its axis through the origin, three corners of its left end named."""
    mesh = block((length, H, H), (cells, across, across), origin=(0, -H / 2, -H / 2))
    for name, (y, z) in {"a": (-1, -1), "b": (1, -1), "c": (-1, 1)}.items():
        mesh = mesh.with_vertices(name, [(0.0, y * H / 2, z * H / 2)])
    return mesh


def tension(length: float) -> Iterator[Value]:
    pull = 0.004
    u = bz.Polynomial.affine(pull / E * np.diag([1, -NU, -NU]))
    loads = [bz.Traction("right", value=(pull, 0, 0)), bz.Traction("left", value=(-pull, 0, 0))]
    for degree in (1, 2, 3):
        mesh = beam(length, 4)
        body = bz.Body(mesh, degree, HOOKE, hung(u), loads)
        found = bz.solve(body, solver="direct")
        at = found.displacement.at(np.array([[length, 0.0, 0.0]]))[0, 0]
        where = f"degree {degree}, {len(mesh.tets)} tets"
        yield Value("end, mm", where, float(at), pull * length / E, 1e-10)
        energy = pull**2 / E / 2 * length * H**2
        yield Value("energy, N mm", where, found.energy, energy, 1e-10)


def end_moment(length: float) -> Iterator[Value]:
    c = 0.001
    u = bz.Polynomial.parse(
        [f"-{c}*x*z", f"{c * NU}*y*z", f"{c}*x**2/2 - {c * NU}*(y**2 - z**2)/2"]
    )
    ends = [
        bz.Traction("right", value=bz.Polynomial.parse([f"-{c * E}*z", 0, 0])),
        bz.Traction("left", value=bz.Polynomial.parse([f"{c * E}*z", 0, 0])),
    ]
    moment = c * E * H**4 / 12
    for degree in (2, 3):
        mesh = beam(length, 5)
        found = bz.solve(bz.Body(mesh, degree, HOOKE, hung(u), ends), solver="direct")
        at = found.displacement.at(np.array([[length, 0.0, 0.0]]))[0, 2]
        where = f"degree {degree}, {len(mesh.tets)} tets"
        yield Value("end, mm", where, float(at), moment * length**2 / (2 * E * H**4 / 12), 1e-9)


def stiffnesses() -> tuple[float, float]:
    """EI [N mm2] and k G A [N]."""
    return E * H**4 / 12, COWPER * E / (2 + 2 * NU) * H**2


def cantilever(length: float) -> Iterator[Value]:
    EI, kGA = stiffnesses()
    load = bz.Traction("right", value=(0, 0, 0.001))
    wanted = 0.001 * (length**3 / (3 * EI) + length / kGA)
    yield from clamped(length, load, wanted, (3, 4))


def evenly_loaded(length: float) -> Iterator[Value]:
    EI, kGA = stiffnesses()
    load = bz.Traction("top", value=(0, 0, 0.0001))
    wanted = 0.0001 * H * (length**4 / (8 * EI) + length**2 / (2 * kGA))
    yield from clamped(length, load, wanted, (3, 4))


def heavy(length: float) -> Iterator[Value]:
    EI, kGA = stiffnesses()
    load = bz.BodyForce((0, 0, -0.0001))
    wanted = -0.0001 * H**2 * (length**4 / (8 * EI) + length**2 / (2 * kGA))
    yield from clamped(length, load, wanted, (3, 4))


def clamped_beam(length: float, load: Load, degree: int) -> bz.Body:
    """A beam clamped at its left."""
    return bz.Body(beam(length, round(length)), degree, HOOKE, [bz.Fixed("left")], [load])


def clamped(length: float, load: Load, wanted: float, degrees: tuple[int, ...]) -> Iterator[Value]:
    """The end of a beam clamped at its left."""
    for degree in degrees:
        found = bz.solve(clamped_beam(length, load, degree), solver="direct")
        at = found.displacement.at(np.array([[length, 0.0, 0.0]]))[0, 2]
        where = f"degree {degree}, {len(found.body.mesh.tets)} tets"
        yield Value("end, mm", where, float(at), wanted, 0.16 / length)


def both_ends(length: float) -> Iterator[Value]:
    EI, kGA = stiffnesses()
    q = 0.0001
    wanted = q * H * (length**4 / (384 * EI) + length**2 / (8 * kGA))
    for degree in (3, 4):
        mesh = beam(length, round(length))
        held = [bz.Fixed("left", "right")]
        body = bz.Body(mesh, degree, HOOKE, held, [bz.Traction("top", value=(0, 0, q))])
        at = bz.solve(body, solver="direct").displacement.at(np.array([[length / 2, 0.0, 0.0]]))
        where = f"degree {degree}, {len(mesh.tets)} tets"
        yield Value("middle, mm", where, float(at[0, 2]), wanted, 0.5 / length)


def polynomial(u: tuple[str, str, str], degrees: tuple[int, ...], weight: float) -> Iterator[Value]:
    yield from coming_back(field(u), HOOKE, MESHES["brick"](), degrees, weight)


ENDS = "Saint-Venant: the clamp and the load disturb the beam over about its height, so 0.16 h/l"
for length in (5.0, 10.0, 20.0):
    FAMILY.add(
        f"Bar in tension, l/h = {length:g}",
        ANALYTICAL,
        "Hooke's law",
        "p l / E",
        EXACT,
        tension,
        length,
    )
    FAMILY.add(
        f"End moment, l/h = {length:g}",
        ANALYTICAL,
        f"{TG}, art. 102",
        "M l^2 / (2 E I)",
        EXACT,
        end_moment,
        length,
    )
    FAMILY.add(
        f"Cantilever with a force at its end, l/h = {length:g}", ANALYTICAL,
        "Timoshenko's beam with Cowper's shear coefficient, doi:10.1115/1.3625046",
        "F l^3 / (3 E I) + F l / (k G A)", ENDS, cantilever, length,
    )  # fmt: skip
for length in (10.0, 20.0):
    answer = "q l^4 / (8 E I) + q l^2 / (2 k G A)"
    source = "Timoshenko's beam with Cowper's shear coefficient, doi:10.1115/1.3625046"
    FAMILY.add(
        f"Cantilever under an even load, l/h = {length:g}",
        ANALYTICAL,
        source,
        answer,
        ENDS,
        evenly_loaded,
        length,
    )
    FAMILY.add(
        f"Cantilever under its weight, l/h = {length:g}",
        ANALYTICAL,
        source,
        answer,
        ENDS,
        heavy,
        length,
    )
    FAMILY.add(
        f"Beam clamped at both ends, l/h = {length:g}", ANALYTICAL, source,
        "q l^4 / (384 E I) + q l^2 / (8 k G A)",
        "two clamps, and a quarter of the length between them: 0.5 h/l", both_ends, length,
    )  # fmt: skip
HANGING = ("-0.003*x*(1-z)", "-0.003*y*(1-z)", "0.01*(z - z**2/2) - 0.0015*(x**2 + y**2)")
CIRCLE = ("0.02*x*z", "-0.3*0.02*y*z", "0.01*(-x**2 + 0.3*(y**2 - z**2))")
FORCED = ("-x**2*z/200 + 17/4200*z**3", "0", "3/1400*x*z**2 + x**3/600")
for name, article, u, weight, degrees in (
    ("Bar hanging under its weight", "art. 96", HANGING, 0.005, (2, 3)),
    ("Beam bent to a circle", "art. 102", CIRCLE, 0.0, (2, 3)),
    ("Wide beam with a force at its end", "art. 21, in plane strain", FORCED, 0.0, (3, 4)),
):
    answer = f"u = ({', '.join(u)})"
    FAMILY.add(name, ANALYTICAL, f"{TG}, {article}", answer, EXACT, polynomial, u, degrees, weight)
for name in ("flexure", "flexure, other nu", "bending, elliptic"):
    why = "exact, if flat facets carry the stress times their own normals"
    answer = "tests/cases/exact.py has the field"
    FAMILY.add(
        f"Faceted bar: {name}", ANALYTICAL, f"{TG}, arts. 102, 122", answer, why, smooth, name
    )
