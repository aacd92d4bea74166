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
    return self.core.stress(_rows(H, np.shape(H))).reshape(np.shape(H))


def derivative(self: Compiled, H: Floats, dH: Floats) -> Floats:
    """The change (..., 3, 3) MPa of the stress at H in the direction dH, by the core."""
    shape = np.broadcast_shapes(np.shape(H), np.shape(dH))
    return self.core.derivative(_rows(H, shape), _rows(dH, shape)).reshape(shape)


def energy(self: Compiled, H: Floats) -> Floats:
    """The stored energy (...) N/mm2, by the core; tau : eps for a law that has none."""
    if self.core.has_energy:
        return self.core.energy(_rows(H, np.shape(H))).reshape(np.shape(H)[:-2])
    return np.asarray(np.einsum("...ij,...ij->...", stress(self, H), H))


def mixed_stress(self: Compiled, H: Floats, p: Floats) -> tuple[Floats, Floats]:
    """P (..., 3, 3) MPa and c (...) at H (..., 3, 3) and the pressure p (...) MPa, by the core."""
    shape = np.shape(H)
    P, c = _beside(self).mixed_stress(_rows(H, shape), _row(p, shape))
    return P.reshape(shape), c.reshape(shape[:-2])


def mixed_derivative(
    self: Compiled, H: Floats, p: Floats, dH: Floats, dp: Floats
) -> tuple[Floats, Floats]:
    """The changes of P and c in the direction dH, dp, by the core."""
    shape = np.broadcast_shapes(np.shape(H), np.shape(dH))
    rows = (_rows(H, shape), _row(p, shape), _rows(dH, shape), _row(dp, shape))
    dP, dc = _beside(self).mixed_derivative(*rows)
    return dP.reshape(shape), dc.reshape(shape[:-2])


def mixed_energy(self: Compiled, H: Floats, p: Floats) -> Floats:
    """The stored energy (...) N/mm2, or P : H where there is none, by the core."""
    shape = np.shape(H)
    if _beside(self).has_energy:
        found = _beside(self).mixed_energy(_rows(H, shape), _row(p, shape))
        return found.reshape(shape[:-2])
    return np.asarray(np.einsum("...ij,...ij->...", mixed_stress(self, H, p)[0], H))


def _beside(self: Compiled) -> _core.Law:
    """The core's law for the mixed form, where it is another."""
    found: _core.Law = getattr(self, "core_mixed", self.core)
    return found


def _rows(H: Floats, shape: tuple[int, ...]) -> Floats:
    """As the core takes it, (q, 3, 3)."""
    return np.ascontiguousarray(np.broadcast_to(H, shape), dtype=np.float64).reshape(-1, 3, 3)


def _row(p: Floats, shape: tuple[int, ...]) -> Floats:
    return np.ascontiguousarray(np.broadcast_to(p, shape[:-2]), dtype=np.float64).reshape(-1)


def positive(value: Any, what: str, unit: str, why: str) -> float:
    """A number above zero; `why` says what would happen otherwise.

    >>> positive(2, "c1 of MooneyRivlin", "MPa", "")
    2.0
    """
    found = number(value, what)
    if not found > 0:
        raise InputError(f"{what} = {found:g} {unit}".rstrip() + f": it must be positive, {why}")
    return found


def not_negative(value: Any, what: str, unit: str, why: str) -> float:
    """A number that is zero or above."""
    found = number(value, what)
    if not found >= 0:
        raise InputError(
            f"{what} = {found:g} {unit}".rstrip() + f": it must not be negative, {why}"
        )
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
