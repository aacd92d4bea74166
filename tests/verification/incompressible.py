# SPDX-License-Identifier: BSD-3-Clause
"""Tissue that keeps its volume: the mixed form at and near nu = 1/2."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

import bezsoma as bz
from bezsoma.mesh import block
from cases.test_incompressible import COOK, slab
from convergence.polynomials import values
from convergence.test_polynomial_pairs import Pair, body
from convergence.waves import irregular
from verification.problem import ANALYTICAL, EXACT, LAW, PUBLISHED, Family, Value

FAMILY = Family("incompressible", "Displacement and pressure, nu up to 1/2.")
CURLS = "a curl has no divergence; by differentiation"


def pair(degree: int, lower: int, nu: float, enclosed: bool) -> Iterator[Value]:
    softness = 3 * (1 - 2 * nu) / (2 + 2 * nu)
    exact = Pair.compressible(lower, softness) if softness else Pair.incompressible(degree, lower)
    mesh = irregular(0)[0] if degree > 3 else block(cells=(2, 1, 1), irregular=0.3)
    found = bz.solve(body(mesh, exact, degree, lower, nu, enclosed), solver="direct")
    u = bz.Field.interpolating(found.net, lambda x: values(exact.u, x)).controls
    net = found.pressure.net  # type: ignore[union-attr]
    p = bz.Field.interpolating(net, lambda x: values([exact.p], x)[:, 0]).controls
    if enclosed and nu == 0.5:
        p = p - bz.Field(net, p).integral() / net.mesh.volumes.sum()
    where = f"degree {degree} and {lower}, {len(found.body.mesh.tets)} tets"
    off = np.abs(found.displacement.controls - u).max() / np.abs(u).max()
    yield Value("largest error of u", where, float(off), 0.0, 1e-10)
    off = np.abs(found.pressure.controls - p).max() / np.abs(p).max()  # type: ignore[union-attr]
    yield Value("largest error of p", where, float(off), 0.0, 1e-8)


def standing(degree: int) -> Iterator[Value]:
    """A box full of it: u = 0, and the pressure of a fluid."""
    g, law = 0.001, bz.LinearElastic(0.01, 0.5)
    sides = [bz.Fixed("left", "right", components="x"), bz.Fixed("front", "back", components="y")]
    held = [*sides, bz.Fixed("bottom", components="z")]
    mesh = block(cells=(2, 2, 2), irregular=0.2)
    stated = bz.Body(mesh, degree, law, held, [bz.BodyForce((0, 0, -g))], incompressible=True)
    found = bz.solve(stated, solver="direct")
    where = f"degree {degree} and {degree - 1}, {len(mesh.tets)} tets"
    yield Value("largest displacement, mm", where, found.largest_displacement, 0.0, 1e-10)
    for z in (0.1, 0.6):
        p = float(np.ravel(found.pressure.at(np.array([[0.4, 0.5, z]])))[0])  # type: ignore[union-attr]
        yield Value(f"p at z = {z}, MPa", where, p, g * (1 - z), 1e-9)


def sheared(degree: int) -> Iterator[Value]:
    """Between moving walls: p = 0, force G times the shear."""
    law = bz.LinearElastic(3.0, 0.5)
    move = bz.Polynomial.parse(["0.1*z", 0, 0])
    held = [bz.Prescribed("bottom", "top", "left", "right", value=move)]
    loads = [bz.Traction("front", value=(0, 0, 0))]
    found = bz.solve(
        bz.Body(block(cells=2), degree, law, held, loads, incompressible=True), solver="direct"
    )
    where = f"degree {degree} and {degree - 1}, 48 tets"
    yield Value("energy, N mm", where, found.energy, 0.1**2 / 2, 1e-9)
    yield Value("change of volume, mm3", where, found.volume_change, 0.0, 1e-12)


def cook(degree: int, within: float) -> Iterator[Value]:
    found = bz.solve(slab(degree, pressure_degree=degree - 1), solver="direct")
    corner, middle = found.displacement.at(np.array([[48.0, 60, 3], [48, 52, 3]]))[:, 1]
    where = f"degree {degree} and {degree - 1}, {len(found.body.mesh.tets)} tets"
    yield Value("corner, mm", where, float(corner), COOK["corner"], within)
    yield Value("middle, mm", where, float(middle), COOK["middle"], within)
    yield Value("energy, N mm a mm", where, found.energy / 6, COOK["energy"], within)


def kept(degree: int) -> Iterator[Value]:
    """Whatever the load, the volume stays."""
    mesh = block(cells=(2, 2, 2), irregular=0.3)
    load = bz.Traction("top", value=bz.Polynomial.parse(["0.001*x", "-0.002*y*x", "0.003*x"]))
    stated = bz.Body(
        mesh,
        degree,
        bz.LinearElastic(0.015, 0.5),
        [bz.Fixed("bottom")],
        [load],
        incompressible=True,
    )
    found = bz.solve(stated, solver="direct")
    where = f"degree {degree} and {degree - 1}, {len(mesh.tets)} tets"
    yield Value("int div u, mm3", where, found.volume_change, 0.0, 1e-12)


def near(degree: int) -> Iterator[Value]:
    """The mixed form at nu -> 1/2 comes to that at 1/2."""
    ends = {}
    for nu in (0.4999, 0.49999, 0.5):
        load = [bz.Traction("top", value=(0.001, 0, 0))]
        stated = bz.Body(
            block(cells=2),
            degree,
            bz.LinearElastic(0.015, nu),
            [bz.Fixed("bottom")],
            load,
            incompressible=True,
        )
        ends[nu] = bz.solve(stated, solver="direct").energy
    for nu in (0.4999, 0.49999):
        where = f"degree {degree}, nu = {nu}"
        yield Value("energy against nu = 1/2", where, ends[nu], ends[0.5], 30 * (0.5 - nu))


for degree, lower in ((2, 1), (3, 1), (3, 2), (4, 3), (5, 4)):
    name = f"A stirred polynomial, degree {degree} and {lower}"
    FAMILY.add(name, ANALYTICAL, CURLS, "drawn at random", EXACT, pair, degree, lower, 0.5, False)
for degree, lower in ((2, 1), (3, 2)):
    name = f"The same between walls all round, degree {degree} and {lower}"
    FAMILY.add(name, ANALYTICAL, CURLS, "p up to a constant", EXACT, pair, degree, lower, 0.5, True)
    name = f"Any polynomial at nu = 0.4999, degree {degree} and {lower}"
    FAMILY.add(
        name,
        ANALYTICAL,
        "p = -kappa div u",
        "drawn at random",
        EXACT,
        pair,
        degree,
        lower,
        0.4999,
        False,
    )
for degree in (2, 3):
    FAMILY.add(
        f"A box full of tissue, degree {degree}",
        ANALYTICAL,
        "hydrostatics",
        "u = 0, p = g (H - z)",
        EXACT,
        standing,
        degree,
    )
    FAMILY.add(
        f"Shear between walls, degree {degree}",
        ANALYTICAL,
        "Hooke's law",
        "energy G gamma^2 / 2",
        EXACT,
        sheared,
        degree,
    )
    FAMILY.add(
        f"Volume is kept, degree {degree}", LAW, "int div u = 0", "0", "rounding", kept, degree
    )
FAMILY.add(
    "Continuous as nu goes to 1/2",
    LAW,
    "the form depends on 1/kappa",
    "the energy at 1/2",
    "of the order of 1 - 2 nu",
    near,
    2,
)
for degree, within in ((2, 0.025), (3, 0.012)):
    FAMILY.add(
        f"Cook's membrane at nu = 1/2, degree {degree}", PUBLISHED,
        "scikit-fem, plane strain, degree 4 and 3, sixteen graded layers (cases/cook_plane.py)",
        "19.4258 mm at the corner", "singular corners of the clamp; measured", cook, degree, within,
    )  # fmt: skip
