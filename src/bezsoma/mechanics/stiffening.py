# SPDX-License-Identifier: BSD-3-Clause
"""Tissue that stiffens as it is strained, at small strain: the paper's law and its kin."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from bezsoma import _core
from bezsoma.arrays import Floats
from bezsoma.errors import InputError, unknown
from bezsoma.mechanics import compiled
from bezsoma.mechanics.compiled import kappa_mu, not_negative, poissons, youngs

MEASURES = ("frobenius", "mean", "energy", "deviatoric")
SHEARS = ("tensor", "engineering")


@dataclass(frozen=True)
class Stiffening:
    """E(s) = E exp(A s^2): linear elasticity that stiffens with a measure s of the strain.

        tau = E exp(A s^2) C_1(nu) eps        (Roth et al. 1998, eqs. 22 and 23)

    E [MPa] > 0 at rest, -1 < nu < 1/2 (1/2 in the mixed form), A >= 0 [-]; the paper has A = 5,
    which stiffens a strain of 38 % by a half to a factor of two. `measure` is one of

    - "frobenius": s^2 = sum eps_ij^2 (eq. 24, read as a tensor: it does not change when the frame
      is turned);
    - "mean": s = (1/9) sum |eps_ij|. At most a third of the former, not the same in every frame,
      and not smooth;
    - "energy": s^2 = eps : C_1 : eps, so that W = E/(2A) (exp(A s^2) - 1) is stored;
    - "deviatoric": W = kappa/2 tr^2 + (G/A) (exp(A eps':eps') - 1): volume is not stiffened.

    The first two have no energy, and their tangents are not symmetric ("frobenius" at nu = 0, where
    it is "energy", apart); the last two, which are not in the paper, have. shears="engineering" is
    eq. 24 to the letter, gamma_ij off the diagonal: *not* the same in every frame, for the first
    two measures only.

    Small strain: for large turns take a law at finite strain.

    >>> H = np.diag([0.2, -0.05, -0.05])
    >>> tissue = Stiffening(E=1.0, nu=0.25, A=5.0)
    >>> s2 = 0.2**2 + 2 * 0.05**2
    >>> bool(np.isclose(tissue.stress(H)[0, 0], np.exp(5 * s2) * 0.2, rtol=1e-14))
    True
    """

    E: float
    nu: float
    A: float
    measure: str = "frobenius"
    shears: str = "tensor"
    linear: ClassVar[bool] = False
    finite: ClassVar[bool] = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "E", youngs(self.E, "Stiffening"))
        object.__setattr__(self, "nu", poissons(self.nu, "Stiffening"))
        why = "or the tissue would soften and have no strength left"
        object.__setattr__(self, "A", not_negative(self.A, "A of Stiffening", "", why))
        if self.measure not in MEASURES:
            raise InputError(unknown("measure", self.measure, MEASURES, "Stiffening"))
        if self.shears not in SHEARS:
            raise InputError(unknown("shears", self.shears, SHEARS, "Stiffening"))
        if self.symmetric and self.shears != "tensor":
            raise InputError(
                f"shears={self.shears!r} with measure={self.measure!r}: an energy is one of the "
                "strain tensor; engineering shears go with 'frobenius' and 'mean'"
            )

    @property
    def symmetric(self) -> bool:
        """Whether stress comes from an energy."""
        return self.measure in ("energy", "deviatoric")

    @cached_property
    def core(self) -> _core.Law:
        """The core's law."""
        letter = "_engineering" if self.shears == "engineering" else ""
        parameters = [*kappa_mu(self.E, self.nu), self.A]
        return _core.Law(f"stiffening_{self.measure}{letter}", parameters)

    stress = compiled.stress
    derivative = compiled.derivative
    energy = compiled.energy
    mixed_stress = compiled.mixed_stress
    mixed_derivative = compiled.mixed_derivative
    mixed_energy = compiled.mixed_energy

    def secant(self, H: Floats, dH: Floats) -> Floats:
        """C(H) dH (..., 3, 3) MPa with stress(H) = C(H) H: the secant of the paper's eq. 51.

        >>> H = np.diag([0.2, 0.1, -0.05])
        >>> law = Stiffening(E=1.0, nu=0.25, A=5.0)
        >>> bool(np.allclose(law.secant(H, H), law.stress(H), rtol=1e-14))
        True
        """
        kappa, mu = kappa_mu(self.E, self.nu)
        kappa_part, shear_part = self._factors(H)
        strain = (dH + np.swapaxes(dH, -1, -2)) / 2
        trace = np.trace(strain, axis1=-2, axis2=-1)[..., None, None] * np.eye(3)
        volume = kappa_part[..., None, None] * kappa * trace
        return np.asarray(volume + shear_part[..., None, None] * 2 * mu * (strain - trace / 3))

    def _factors(self, H: Floats) -> tuple[Floats, Floats]:
        """By what the bulk and the shear modulus have grown at H."""
        strain = (H + np.swapaxes(H, -1, -2)) / 2
        off = 2.0 if self.shears == "engineering" else 1.0
        weighted = strain * (off - (off - 1) * np.eye(3))
        trace = np.trace(strain, axis1=-2, axis2=-1)
        deviator = strain - trace[..., None, None] / 3 * np.eye(3)
        if self.measure == "mean":
            square = (np.abs(weighted).sum(axis=(-2, -1)) / 9) ** 2
        elif self.measure == "frobenius":
            square = (weighted**2).sum(axis=(-2, -1))
        else:
            square = (deviator**2).sum(axis=(-2, -1))
        if self.measure == "energy":
            kappa, mu = kappa_mu(self.E, self.nu)
            square = (kappa * trace**2 + 2 * mu * square) / self.E
        grown = np.exp(self.A * square)
        return np.ones_like(grown) if self.measure == "deviatoric" else grown, grown
