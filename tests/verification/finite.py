# SPDX-License-Identifier: BSD-3-Clause
"""Finite strain: stretched, sheared, turned and blown up, against formulas."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

import bezsoma as bz
from bezsoma.mesh import block
from cases.test_finite_motions import corner, corner_in_plane_strain, twisted
from cases.test_finite_problems import blown, muscle_beam
from verification.problem import ANALYTICAL, AT_MOST, LAW, PUBLISHED, Family, Value

FAMILY = Family("finite", "Large stretches and turns, by the laws for finite strain.")
OGDEN = "R. W. Ogden, Non-Linear Elastic Deformations (1984), chapters 4 and 7"
NEWTON = "Newton stops at 1e-10"
E, NU = 1.0, 0.3
MU, LAM = E / (2 + 2 * NU), E * NU / ((1 + NU) * (1 - 2 * NU))
PLANES = [
    bz.Fixed("left", components="x"),
    bz.Fixed("front", components="y"),
    bz.Fixed("bottom", components="z"),
]


def drawn(
    law: object, first: Callable[[float, float], float], side: Callable[[float], float]
) -> Iterator[Value]:
    """Drawn out to a stretch l, sides free: force first(l, s), side stretch s = side(l)."""
    for stretch in (0.7, 1.5):
        move = bz.Moved("top", translation=(0, 0, stretch - 1), components="z")
        found = bz.solve(bz.Body(block(), 2, law, [*PLANES, move]))  # type: ignore[arg-type]
        s = side(stretch)
        where = f"stretch {stretch}, degree 2, 6 tets"
        yield Value(
            "force, N", where, float(found.reactions["top"].force[2]), first(stretch, s), 1e-7
        )
        wide = 1 + float(found.displacement.at(np.array([[1.0, 0.5, 0.5]]))[0, 0])
        yield Value("side stretch", where, wide, s, 1e-7)


def neo_side(stretch: float) -> float:
    """Where mu (s - 1/s) + lam ln(l s^2) / s = 0."""
    return float(
        brentq(lambda s: MU * (s - 1 / s) + LAM * np.log(stretch * s**2) / s, 0.3, 3.0, xtol=1e-14)
    )


def neo_force(stretch: float, s: float) -> float:
    """P = mu (l - 1/l) + lam ln J / l."""
    return MU * (stretch - 1 / stretch) + LAM * np.log(stretch * s**2) / stretch


def svk_side(stretch: float) -> float:
    """E_side = -nu E_axial."""
    return float(np.sqrt(1 - NU * (stretch**2 - 1)))


def svk_force(stretch: float, s: float) -> float:
    """P = l S, S = E (l^2 - 1)/2."""
    return stretch * E * (stretch**2 - 1) / 2


def incompressible(law: object, force: Callable[[float], float]) -> Iterator[Value]:
    """The same without change of volume: s = 1/sqrt(l)."""
    for stretch in (0.7, 1.5):
        move = bz.Moved("top", translation=(0, 0, stretch - 1), components="z")
        found = bz.solve(bz.Body(block(), 2, law, [*PLANES, move], incompressible=True))  # type: ignore[arg-type]
        where = f"stretch {stretch}, degree 2 and 1, 6 tets"
        yield Value("force, N", where, float(found.reactions["top"].force[2]), force(stretch), 1e-7)
        yield Value("change of volume, mm3", where, found.volume_change, 0.0, 1e-9)


def mooney(c1: float, c2: float, stretch: float) -> float:
    """P = 2 (l - l^-2) (c1 + c2 / l)."""
    return 2 * (stretch - stretch**-2) * (c1 + c2 / stretch)


def ogden(terms: tuple[tuple[float, float], ...], stretch: float) -> float:
    """P = sum mu_i (l^(a - 1) - l^(-a/2 - 1))."""
    return sum(m * (stretch ** (a - 1) - stretch ** (-a / 2 - 1)) for m, a in terms)


def veronda(c1: float, c2: float, stretch: float) -> float:
    """From its energy, by I1 = l^2 + 2/l and I2 = 2 l + l^-2."""
    slope1, slope2 = 2 * stretch - 2 / stretch**2, 2 - 2 * stretch**-3
    grown = c1 * c2 * np.exp(c2 * (stretch**2 + 2 / stretch - 3))
    return float(grown * slope1 - c1 * c2 / 2 * slope2)


def sheared(law: object, T_xz: Callable[[float], float]) -> Iterator[Value]:
    """Simple shear, prescribed all round: the shear stress, and no change of volume."""
    for gamma in (0.3, 1.0):
        u = bz.Polynomial.parse([f"{gamma}*z", 0, 0])
        held = [bz.Prescribed("left", "right", "front", "back", "bottom", "top", value=u)]
        found = bz.solve(bz.Body(block(), 2, law, held))  # type: ignore[arg-type]
        s = found.stress.at(np.array([[0.7, 0.5, 0.5]]), outside="nearest")[0].reshape(3, 3)
        where = f"shear {gamma}, degree 2, 6 tets"
        yield Value("Cauchy T_xz, MPa", where, float(s[0, 2]), T_xz(gamma), 1e-9)


def turned(law: object) -> Iterator[Value]:
    """Turned by 75 degrees: no stress, no energy."""
    turn = Rotation.from_rotvec([0.5, 0.8, -0.9]).as_matrix() - np.eye(3)
    held = [bz.Prescribed("bottom", "left", value=bz.Polynomial.affine(turn))]
    found = bz.solve(bz.Body(block(), 2, law, held))  # type: ignore[arg-type]
    points = block().points[:4] * 0.8 + 0.1
    away = np.abs(found.displacement.at(points) - points @ turn.T).max()
    yield Value("largest error of u, mm", "degree 2, 6 tets", float(away), 0.0, 1e-8)
    yield Value("energy, N mm", "degree 2, 6 tets", found.energy, 0.0, 1e-12)


def small(law: object) -> Iterator[Value]:
    """A small load: linear elasticity, up to the square of the strain."""
    load = [bz.Traction("top", value=(1e-6, 0, 2e-6))]
    one, other = (
        bz.solve(
            bz.Body(block(cells=2), 2, each, [bz.Fixed("bottom")], load),  # type: ignore[arg-type]
            solver="direct",
        ).displacement.controls
        for each in (law, bz.LinearElastic(E, NU))
    )
    away = float(np.abs(one - other).max() / np.abs(other).max())
    yield Value("largest difference", "degree 2, 48 tets", away, 0.0, 1e-4)


def sphere() -> Iterator[Value]:
    """The inner radius of 1 grows by 0.3, the outer follows."""
    for degree, of_u, of_p in ((2, 0.08, 0.3), (3, 0.015, 0.03)):
        u, p = blown(degree)
        yield Value("error of u in L2", f"degree {degree}", u, 0.0, of_u)
        yield Value("error of p, of mu", f"degree {degree}", p, 0.0, of_p)


def beam() -> Iterator[Value]:
    """On 20 x 2 x 2 cells; on these degree 2 is still too stiff, and has a tolerance of its own."""
    for degree, within in ((2, 0.03), (3, 0.02), (4, 0.02)):
        z, solution = muscle_beam(degree, (20, 2, 2), "multigrid")
        where = f"degree {degree} and {degree - 1}, 20 x 2 x 2 cells, {solution.free} unknowns"
        yield Value("z of the end's upper edge, mm", where, z, 4.17, within / 4.17)
        yield Value("change of volume, mm3", where, solution.volume_change, 0.0, 1e-9)


def membrane() -> Iterator[Value]:
    """The upper corner, on 4 x 4 x 1 cells."""
    wanted = corner_in_plane_strain(4)
    for degree, within in ((2, 0.05), (3, 0.02), (4, 0.01)):
        for name, found, exact in zip("xy", corner(degree), wanted, strict=True):
            where = f"degree {degree}, 96 tets"
            yield Value(f"u_{name} of the corner, mm", where, float(found), float(exact), within)


def ends() -> Iterator[Value]:
    """A cube whose top is turned by 60 degrees and pressed down by a fifth, incompressible."""
    energies = []
    for degree in (2, 3, 4, 5):
        found = twisted(degree, bz.NeoHooke(1.0, 0.5), incompressible=True)
        energies.append(found.energy)
        where = f"degree {degree} and {degree - 1}, 6 tets"
        apart = found.reactions["bottom"].force + found.reactions["top"].force
        yield Value("forces of both ends, N", where, float(np.abs(apart).max()), 0.0, 1e-8)
        yield Value("change of volume, mm3", where, found.volume_change, 0.0, 1e-10)
        if degree > 2:
            least = energies[-2]
            yield Value("energy, N mm, below the last", where, found.energy, least, 0.0, AT_MOST)


FAMILY.add(
    "Neo-Hooke drawn out",
    ANALYTICAL,
    OGDEN,
    "P = mu (l - 1/l) + lam ln J / l",
    NEWTON,
    drawn,
    bz.NeoHooke(E, NU),
    neo_force,
    neo_side,
)
FAMILY.add(
    "St. Venant-Kirchhoff drawn out",
    ANALYTICAL,
    OGDEN,
    "P = l E (l^2 - 1)/2",
    NEWTON,
    drawn,
    bz.StVenantKirchhoff(E, NU),
    svk_force,
    svk_side,
)
TERMS = ((0.3, 2.0), (0.1, 4.0))
for name, law, answer, force in (
    ("neo-Hooke", bz.NeoHooke(1.0, 0.5), "P = G (l - l^-2)", partial(mooney, 1 / 6, 0.0)),
    (
        "Mooney-Rivlin",
        bz.MooneyRivlin(0.2, 0.1, np.inf),
        "P = 2 (l - l^-2)(c1 + c2/l)",
        partial(mooney, 0.2, 0.1),
    ),
    (
        "Ogden",
        bz.Ogden([m for m, _ in TERMS], [a for _, a in TERMS], np.inf),
        "P = sum mu_i (l^(a-1) - l^(-a/2-1))",
        partial(ogden, TERMS),
    ),
    (
        "Veronda-Westmann",
        bz.VerondaWestmann(0.1, 2.0, np.inf),
        "P = dW/dl",
        partial(veronda, 0.1, 2.0),
    ),
):
    FAMILY.add(
        f"{name} drawn out, incompressible",
        ANALYTICAL,
        OGDEN,
        answer,
        NEWTON,
        incompressible,
        law,
        force,
    )
FAMILY.add(
    "Neo-Hooke in simple shear",
    ANALYTICAL,
    OGDEN,
    "T_xz = mu gamma",
    NEWTON,
    sheared,
    bz.NeoHooke(E, NU),
    lambda g: MU * g,
)
FAMILY.add(
    "Mooney-Rivlin in simple shear",
    ANALYTICAL,
    OGDEN,
    "T_xz = 2 (c1 + c2) gamma",
    NEWTON,
    sheared,
    bz.MooneyRivlin(0.2, 0.1, 2.0),
    lambda g: 0.6 * g,
)
FAMILY.add(
    "St. Venant-Kirchhoff in simple shear",
    ANALYTICAL,
    OGDEN,
    "T = F S F^T / J",
    NEWTON,
    sheared,
    bz.StVenantKirchhoff(E, NU),
    lambda g: MU * g + (LAM / 2 + MU) * g**3,
)
for name, law in {
    "neo-Hooke": bz.NeoHooke(E, NU),
    "St. Venant-Kirchhoff": bz.StVenantKirchhoff(E, NU),
}.items():
    FAMILY.add(
        f"Turned by 75 degrees: {name}",
        LAW,
        "objectivity",
        "u = (Q - I) x, no energy",
        NEWTON,
        turned,
        law,
    )
    FAMILY.add(
        f"Under a small load: {name}",
        LAW,
        "linearisation",
        "linear elasticity",
        "of the size of the strain, some 1e-5",
        small,
        law,
    )
FAMILY.add(
    "Hollow sphere blown up by a third",
    ANALYTICAL,
    "int 2 mu (l^2 - l^-4) / r dr by Gauss; exact on facets",
    "r^3 = R^3 + 1.3^3 - 1",
    "measured; less with every degree",
    sphere,
)
FAMILY.add(
    "Beam of heart muscle, pressed from below",
    PUBLISHED,
    "S. Land et al., Proc. R. Soc. A 471 (2015), doi:10.1098/rspa.2015.0641, problem 1",
    "z = 4.17 +- 0.02 mm",
    "0.02 mm is where the codes of the paper lie, and degrees 3 and 4 are held to it. Degree 2 is "
    "not: on 20 x 2 x 2 cells (480 tets, 3,189 unknowns) it is too stiff, lies outside of that "
    "band, and is held to a tolerance of its own, 0.03 mm. The table has both relative to 4.17 mm",
    beam,
)
FAMILY.add(
    "Cook's membrane of neo-Hooke in plane strain",
    PUBLISHED,
    "scikit-fem, the plane problem: triangles of degree 3, graded to the corners",
    "E = 208.5 MPa, nu = 0.3, 100 N on 16 mm2: u of the corner (48, 60)",
    "measured; the stress is singular where the clamp ends",
    membrane,
)
FAMILY.add(
    "Cube twisted by 60 degrees and pressed by a fifth, incompressible",
    LAW,
    "S. Reese, P. Wriggers and B. D. Reddy, Comput. Struct. 75 (2000), have one like it",
    "ends in balance, no change of volume, less energy with every degree",
    "Newton stops at 1e-10",
    ends,
)
