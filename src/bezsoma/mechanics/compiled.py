# SPDX-License-Identifier: BSD-3-Clause
"""What all laws of the core share: they are written once, there, and asked from here."""

from __future__ import annotations

import math
from typing import Any, Protocol

import numpy as np

from bezsoma import _core
from bezsoma.arrays import Floats
from bezsoma.errors import InputError
from bezsoma.mechanics.checks import number


class Compiled(Protocol):
    """A material whose law the core has."""

    @property
    def core(self) -> _core.Law:
        """The core's law."""
        ...


def stress(self: Compiled, H: Floats) -> Floats:
    """Stress (..., 3, 3) MPa at the displacement gradient H (..., 3, 3), by the core."""
    return self.core.stress(np.ascontiguousarray(H, dtype=np.float64))


def derivative(self: Compiled, H: Floats, dH: Floats) -> Floats:
    """The change (..., 3, 3) MPa of the stress at H in the direction dH, by the core."""
    H, dH = np.broadcast_arrays(np.asarray(H, dtype=np.float64), dH)
    return self.core.derivative(np.ascontiguousarray(H), np.ascontiguousarray(dH))


def energy(self: Compiled, H: Floats) -> Floats:
    """The stored energy (...) N/mm2, by the core; tau : eps for a law that has none."""
    H = np.ascontiguousarray(H, dtype=np.float64)
    if self.core.has_energy:
        return self.core.energy(H)
    return np.asarray(np.einsum("...ij,...ij->...", self.core.stress(H), H))


def positive(value: Any, what: str, unit: str, why: str) -> float:
    """A number above zero; `why` says what would happen otherwise.

    >>> positive(2, "c1 of MooneyRivlin", "MPa", "")
    2.0
    """
    found = number(value, what)
    if not found > 0:
        raise InputError(f"{what} = {found:g} {unit}: it must be positive, {why}")
    return found


def not_negative(value: Any, what: str, unit: str, why: str) -> float:
    """A number that is zero or above."""
    found = number(value, what)
    if not found >= 0:
        raise InputError(f"{what} = {found:g} {unit}: it must not be negative, {why}")
    return found


def bulk(value: Any, law: str) -> float:
    """A bulk modulus kappa [MPa]: positive; inf is the incompressible law, for the mixed form.

    >>> bulk(math.inf, "NeoHooke")
    inf
    """
    if isinstance(value, float) and value == math.inf:
        return value
    return positive(
        value,
        f"kappa of {law}",
        "MPa",
        "or a change of volume would cost no energy (inf is the "
        "incompressible law, for a Body with a pressure of its own)",
    )


def youngs(E: Any, law: str) -> float:
    """Young's modulus, MPa, positive."""
    return positive(
        E,
        f"E of {law}",
        "MPa",
        "or the body would give way without force; soft tissue is near 0.015 MPa",
    )


def poissons(nu: Any, law: str) -> float:
    """Poisson's ratio: -1 < nu <= 1/2, where 1/2 is the incompressible law."""
    found = number(nu, f"nu of {law}")
    if not -1 < found <= 0.5:
        raise InputError(
            f"nu of {law} = {found:g}: Poisson's ratio lies above -1 and not above 1/2, or a shear "
            "or a pressure would gain energy; 0.45 to 0.49 is usual for soft tissue, 0.5 is "
            "incompressible"
        )
    return found


def kappa_mu(E: float, nu: float) -> tuple[float, float]:
    """Bulk and shear modulus, MPa (paper, eqs. 10 and 11); kappa = inf at nu = 1/2.

    >>> [round(modulus, 12) for modulus in kappa_mu(2.5, 0.25)]
    [1.666666666667, 1.0]
    """
    return math.inf if nu == 0.5 else E / (3 * (1 - 2 * nu)), E / (2 * (1 + nu))
