# SPDX-License-Identifier: BSD-3-Clause
"""Manufactured solutions: plane waves with the loads that they need, and the rates of errors."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

import bezsoma as bz
from convergence import stirring, test_finite_strain
from convergence.waves import Waves, errors, irregular, regular
from tolerances import RATE_SLACK
from verification.problem import ANALYTICAL, AT_LEAST, Family, Value

FAMILY = Family(
    "manufactured",
    "Solutions that are no polynomials, with exact loads: errors fall as the theory says.",
)
THEORY = (
    "S. C. Brenner and L. R. Scott, The Mathematical Theory of Finite Element Methods, 3rd ed. "
    "(2008), theorems 5.4.4 and 5.4.8"
)
WHY = "a rate is measured between two meshes, so it is not yet that of the limit"
MESHES = {1: (8, 12), 2: (3, 6), 3: (2, 4), 4: (2, 3), 5: (1, 2)}


def rates(
    first: np.ndarray, second: np.ndarray, finer: float, wanted: dict[str, float], where: str
) -> Iterator[Value]:
    """Each error's power of h."""
    found = np.log(first / second) / np.log(finer)
    for rate, (of, least) in zip(found, wanted.items(), strict=True):
        yield Value(f"rate of {of}", where, float(rate), least, RATE_SLACK, AT_LEAST)


def cubes(degree: int) -> Iterator[Value]:
    coarse, fine = MESHES[degree]
    one, two = (errors(*regular(n), degree, Waves(0.02, 0.3)) for n in (coarse, fine))
    where = f"degree {degree}, {6 * coarse**3} and {6 * fine**3} tets"
    yield from rates(one, two, fine / coarse, {"u": degree + 1, "grad u": degree}, where)


def odd(degree: int, nu: float) -> Iterator[Value]:
    levels = (2, 3) if degree == 1 else (1, 2)
    one, two = (errors(*irregular(level), degree, Waves(0.02, nu)) for level in levels)
    where = f"degree {degree}, {4 * 8 ** levels[0]} and {4 * 8 ** levels[1]} irregular tets"
    yield from rates(one, two, 2, {"u": degree + 1, "grad u": degree}, where)


def stirred(degree: int) -> Iterator[Value]:
    levels = (1, 2) if degree == 2 else (0, 1)
    one, two = (
        stirring.errors(*irregular(level), degree, degree - 1, 2 * degree + 6) for level in levels
    )
    where = f"degree {degree} and {degree - 1}, {4 * 8 ** levels[0]} and {4 * 8 ** levels[1]} tets"
    yield from rates(one, two, 2, {"u": degree + 1, "p": degree}, where)


def bent(degree: int, law: object) -> Iterator[Value]:
    coarse, fine = (2, 3)
    one, two = (test_finite_strain.errors(*regular(n), degree, law) for n in (coarse, fine))  # type: ignore[arg-type]
    where = f"degree {degree}, {6 * coarse**3} and {6 * fine**3} tets"
    yield from rates(one, two, fine / coarse, {"u": degree + 1, "grad u": degree}, where)


WAVES = "u_i = a_i sin(k_i . x + p_i)"
for degree in MESHES:
    FAMILY.add(f"Waves in a cube, degree {degree}", ANALYTICAL, THEORY, WAVES, WHY, cubes, degree)
for degree, nu in ((1, 0.0), (1, 0.45), (2, 0.0), (2, 0.45), (3, 0.45)):
    name = f"Waves on irregular tets, degree {degree}, nu = {nu}"
    FAMILY.add(name, ANALYTICAL, THEORY, WAVES, WHY, odd, degree, nu)
for degree in (2, 3):
    FAMILY.add(
        f"Stirring without compression, degree {degree}", ANALYTICAL,
        "D. Boffi, F. Brezzi, M. Fortin, Mixed Finite Element Methods (2013), section 8.8",
        "u_i = a_i sin(k_i . x + p_i) with a_i across k_i, p = G sin(q . x), nu = 1/2",
        WHY, stirred, degree,
    )  # fmt: skip
for title, law in {
    "neo-Hooke": bz.NeoHooke(E=1.0, nu=0.3),
    "stiffening": bz.Stiffening(E=1.0, nu=0.3, A=5.0),
}.items():
    FAMILY.add(f"Waves by {title}, degree 3", ANALYTICAL, THEORY, WAVES, WHY, bent, 3, law)
