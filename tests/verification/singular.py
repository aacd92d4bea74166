# SPDX-License-Identifier: BSD-3-Clause
"""Where answers are singular: what grows without bound, what converges slowly, what is exact."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

import bezsoma as bz
from bezsoma.arrays import Floats
from bezsoma.experiments.blocks import lifted, pulled
from bezsoma.mesh import block
from bezsoma.mesh.solids import l_block
from verification.problem import ANALYTICAL, AT_LEAST, LAW, PUBLISHED, Family, Value

FAMILY = Family("singular", "Point forces, notches, and the block of the paper's figure 6.")
LAW_6 = bz.LinearElastic(1.0, 0.25)
ERRATA = "measured by an independent prototype of the same block (docs/theory/errata.md)"


def at_points() -> Iterator[Value]:
    for degree, wanted in ((1, 0.74), (2, 1.97), (3, 3.58)):
        found = bz.solve(pulled("points", 4, degree, LAW_6, 1.0), solver="direct")
        yield Value(
            "middle of the top, mm", f"degree {degree}, 192 tets", lifted(found), wanted, 5e-3
        )


def halved() -> Iterator[Value]:
    for cells, wanted in ((2, 0.37), (4, 0.74), (8, 1.53), (16, 3.11)):
        found = bz.solve(pulled("points", cells, 1, LAW_6, 1.0))
        yield Value(
            "middle of the top, mm", f"degree 1, {3 * cells**3} tets", lifted(found), wanted, 0.015
        )


def on_squares() -> Iterator[Value]:
    for degree, wanted in ((1, 0.156), (2, 0.219), (3, 0.234), (4, 0.239)):
        found = bz.solve(pulled("squares", 4, degree, LAW_6, 1.0), solver="direct")
        yield Value(
            "middle of the top, mm", f"degree {degree}, 192 tets", lifted(found), wanted, 4e-3
        )


def kelvin(x: Floats) -> Floats:
    """A force of 1 N along z at the origin of all space, outside of which this is exact."""
    nu, G = 0.3, 1 / 2.6
    r = np.linalg.norm(x, axis=1)[:, None]
    u = x * x[:, 2:] / r**3
    u[:, 2:] += (3 - 4 * nu) / r
    return u / (16 * np.pi * G * (1 - nu))


def near_a_force() -> Iterator[Value]:
    mesh = block((1.0, 1.0, 1.0), cells=2, origin=(0.7, -0.5, -0.4), irregular=0.2)
    held = [bz.Prescribed("left", "right", "front", "back", "bottom", "top", value=kelvin)]
    errors = []
    for degree, within in ((2, 1e-2), (4, 3e-4), (6, 3e-5)):
        found = bz.solve(bz.Body(mesh, degree, bz.LinearElastic(1.0, 0.3), held), solver="direct")
        errors.append(found.displacement.l2_error(kelvin, 16) / found.displacement.l2_norm())
        yield Value(
            "error of u in L2", f"degree {degree}, {len(mesh.tets)} tets", errors[-1], 0.0, within
        )


def notched(cells: int) -> bz.Body:
    """An L in plane strain, clamped at its left, its right end pulled up; degree 3."""
    mesh = l_block(arm=1.0, thickness=1.0 / cells, cells=cells, layers=1)
    held = [bz.Fixed("left"), bz.Fixed("bottom", "top", components="z")]
    load = [bz.Traction("right", value=(0, 0.01, 0))]
    return bz.Body(mesh, 3, bz.LinearElastic(1.0, 0.3), held, load)


def notch() -> Iterator[Value]:
    """The energy of an L in plane strain converges as h^(2 * 0.5445): Williams' exponent."""
    energies = [bz.solve(notched(cells)).energy * cells for cells in (2, 4, 8)]
    rate = float(np.log2((energies[1] - energies[0]) / (energies[2] - energies[1])))
    yield Value("rate of the energy", "degree 3, 2 to 8 cells an arm", rate, 2 * 0.5445, 0.15)


def from_below(held: str) -> Iterator[Value]:
    """Each larger space stores more under the same force."""
    energies = [bz.solve(pulled(held, 4, degree, LAW_6, 1.0)).energy for degree in (1, 2, 3, 4)]
    for degree, (low, high) in enumerate(pairwise(energies), 1):
        yield Value(
            "gain of energy, N mm",
            f"degree {degree} to {degree + 1}",
            high - low,
            0.0,
            0.0,
            AT_LEAST,
        )


FAMILY.add(
    "Block under a point force, by degree",
    PUBLISHED,
    ERRATA,
    "0.74, 1.97, 3.58 mm",
    "three digits",
    at_points,
)
FAMILY.add(
    "Block under a point force, by mesh",
    PUBLISHED,
    ERRATA,
    "0.37, 0.74, 1.53, 3.11 mm",
    "two to three digits",
    halved,
)
FAMILY.add(
    "Block held and pulled on squares",
    PUBLISHED,
    ERRATA,
    "0.156, 0.219, 0.234, 0.239 mm",
    "three digits",
    on_squares,
)
FAMILY.add(
    "Beside Kelvin's force",
    ANALYTICAL,
    "A. E. H. Love, Mathematical Theory of Elasticity, art. 130",
    "u = (x z / r^3 + (3 - 4 nu) e_z / r) / (16 pi G (1 - nu))",
    "no polynomial; measured, less with every degree",
    near_a_force,
)
FAMILY.add(
    "Notch of 90 degrees in plane strain",
    ANALYTICAL,
    "M. L. Williams, J. Appl. Mech. 19 (1952) 526-528",
    "energy converges as h^1.089",
    "three meshes, and other corners beside",
    notch,
)
for held in ("points", "squares"):
    FAMILY.add(
        f"Energy comes from below, held at {held}",
        LAW,
        "the least potential over nested spaces",
        "grows with the degree",
        "an inequality",
        from_below,
        held,
    )
