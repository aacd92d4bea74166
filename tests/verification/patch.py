# SPDX-License-Identifier: BSD-3-Clause
"""The patch test: what the space holds comes back from any mesh."""

from __future__ import annotations

from collections.abc import Iterator

import bezsoma as bz
from convergence.polynomials import PolynomialField
from convergence.test_exact import MESHES
from verification.bodies import HOOKE, coming_back, field
from verification.problem import ANALYTICAL, EXACT, Family, Value

FAMILY = Family(
    "patch", "Polynomial displacements with the loads that hold a body in them, on irregular tets."
)
IRONS = "B. M. Irons and A. Razzaque (1972), the patch test; by differentiation of the polynomial"
STRAINS = {
    "stretch along x": ("0.01*x", "0", "0"),
    "stretch along y": ("0", "0.01*y", "0"),
    "stretch along z": ("0", "0", "0.01*z"),
    "shear xy": ("0.01*y", "0.01*x", "0"),
    "shear yz": ("0", "0.01*z", "0.01*y"),
    "shear zx": ("0.01*z", "0", "0.01*x"),
}


def strain(name: str) -> Iterator[Value]:
    exact = field(STRAINS[name])
    yield from coming_back(exact, HOOKE, MESHES["few"](), (1, 2, 3))
    yield from coming_back(exact, HOOKE, MESHES["brick"](), (1,))


def drawn(degree: int, nu: float, mesh: str) -> Iterator[Value]:
    law = bz.LinearElastic(E=0.02, nu=nu)
    yield from coming_back(PolynomialField.random(degree, law), law, MESHES[mesh](), (degree,))


for name in STRAINS:
    answer = f"u = ({', '.join(STRAINS[name])})"
    FAMILY.add(f"Constant strain: {name}", ANALYTICAL, IRONS, answer, EXACT, strain, name)
for degree in range(1, 9):
    title = f"All polynomials of degree {degree}"
    FAMILY.add(title, ANALYTICAL, IRONS, "drawn at random", EXACT, drawn, degree, 0.3, "few")
for nu in (-0.3, 0.0, 0.45):
    title = f"All cubics, nu = {nu}"
    FAMILY.add(title, ANALYTICAL, IRONS, "drawn at random", EXACT, drawn, 3, nu, "few")
FAMILY.add(
    "All cubics in a ball", ANALYTICAL, IRONS, "drawn at random", EXACT, drawn, 3, 0.45, "ball"
)
