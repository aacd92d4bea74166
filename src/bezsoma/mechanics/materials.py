# SPDX-License-Identifier: BSD-3-Clause
"""What the tissue is made of: how stress follows from the gradient of the displacement."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np

from bezsoma.arrays import Floats, frozen
from bezsoma.errors import InputError
from bezsoma.mechanics.checks import number


@runtime_checkable
class Material(Protocol):
    """A law at a point: stress (..., 3, 3) MPa from the displacement gradient H (..., 3, 3).

    `linear` says whether stress is proportional to H, `symmetric` whether its derivative is a
    symmetric form (it is when the stress comes from an energy). Solvers choose by these two.
    """

    @property
    def linear(self) -> bool:
        """Whether the stress is proportional to H."""
        ...

    @property
    def symmetric(self) -> bool:
        """Whether the tangent is a symmetric form."""
        ...

    def stress(self, H: Floats) -> Floats:
        """Stress (..., 3, 3) MPa at the displacement gradient H (..., 3, 3), H_kl = du_k/dx_l."""
        ...


@dataclass(frozen=True)
class LinearElastic:
    """Isotropic linear elasticity: E Young's modulus [MPa], nu Poisson's ratio [-].

    Roth et al. 1998, eqs. 4, 5 and 6 (doi:10.1111/1467-8659.00289). Positive definite for E > 0
    and -1 < nu < 1/2, which is checked. Soft tissue of the face: E near 0.015 MPa, nu from 0.45
    to 0.49. As nu nears 1/2 the displacement form stiffens (locking), least at high degree.

    nu = 1/2 is *incompressible*: kappa and lambda are infinite, and the displacement gives the
    deviatoric stress alone. The pressure is then an unknown of its own: see `Body`'s
    `pressure_degree`.

    >>> tissue = LinearElastic(E=0.015, nu=0.45)
    >>> bool(np.isclose(tissue.kappa, tissue.lam + 2 * tissue.mu / 3))
    True
    >>> water = LinearElastic(E=0.015, nu=0.5)
    >>> water.incompressible, water.kappa, water.compressibility
    (True, inf, 0.0)
    """

    E: float
    nu: float

    def __post_init__(self) -> None:
        E = number(self.E, "E of LinearElastic")
        nu = number(self.nu, "nu of LinearElastic")
        if not E > 0:
            raise InputError(
                f"E = {E:g} MPa: Young's modulus of LinearElastic must be positive, or the body "
                "would give way without force; soft tissue is near 0.015 MPa"
            )
        if not nu > -1:
            raise InputError(
                f"nu = {nu:g}: Poisson's ratio of LinearElastic must be above -1, where the "
                "shear modulus E/(2(1+nu)) is infinite; use -1 < nu < 1/2"
            )
        if not nu <= 0.5:
            raise InputError(
                f"nu = {nu:g}: Poisson's ratio of LinearElastic is at most 1/2, where volume "
                "cannot change at all; beyond it the bulk modulus would be negative, and pressure "
                "would make the body swell; 0.45 to 0.49 is usual for soft tissue, nu=0.5 is "
                "incompressible"
            )
        object.__setattr__(self, "E", E)
        object.__setattr__(self, "nu", nu)
        with np.errstate(all="ignore"):
            moduli = (0.0 if self.incompressible else self.lam + 2 * self.mu, self.mu)
        if not (all(map(math.isfinite, moduli)) and self.mu > 0):
            raise InputError(
                f"E = {E:g} MPa, nu = {nu!r}: the moduli lambda and mu leave the range of "
                "floating-point numbers; check the unit of E (MPa) and that nu is clearly below 1/2"
            )

    @classmethod
    def from_shear_bulk(cls, G: float, kappa: float) -> LinearElastic:
        """The same law from the shear modulus G and the bulk modulus kappa, both MPa.

        E = 9 kappa G / (3 kappa + G), nu = (3 kappa - 2 G) / (2 (3 kappa + G)), the inverse of
        eqs. 10 and 11 of the paper. kappa = inf is the incompressible law; one that is so far
        above G that nu would round to 1/2 is refused, since it would be taken for infinite.

        >>> soft = LinearElastic.from_shear_bulk(G=2.0, kappa=5.0)
        >>> bool(np.allclose([soft.mu, soft.kappa], [2, 5], rtol=1e-14))
        True
        >>> LinearElastic.from_shear_bulk(G=2.0, kappa=math.inf)
        LinearElastic(E=6.0, nu=0.5)
        """
        G = number(G, "G of LinearElastic.from_shear_bulk")
        infinite = isinstance(kappa, float) and math.isinf(kappa) and kappa > 0
        if not infinite:
            kappa = number(kappa, "kappa of LinearElastic.from_shear_bulk")
        for name, modulus in (("G", G), ("kappa", kappa)):
            if not modulus > 0:
                raise InputError(
                    f"{name} = {modulus:g} MPa: the shear and the bulk modulus of LinearElastic "
                    "must both be positive, or some deformation would cost no energy"
                )
        ratio = G / (3 * kappa)
        nu = (0.5 - ratio) / (1 + ratio)
        if nu >= 0.5 and not infinite:
            raise InputError(
                f"kappa/G = {kappa / G:g}: Poisson's ratio rounds to 1/2, so that this kappa could "
                "not be told from an infinite one; say kappa = inf (incompressible), or take a "
                "smaller one"
            )
        return cls(E=3 * G / (1 + ratio), nu=nu)

    @property
    def linear(self) -> bool:
        """True: stress is proportional to strain."""
        return True

    @property
    def symmetric(self) -> bool:
        """True: stress is the derivative of the stored energy."""
        return True

    @property
    def lam(self) -> float:
        """Lame's first parameter lambda = E nu / ((1 + nu)(1 - 2 nu)), MPa; inf at nu = 1/2."""
        if self.incompressible:
            return math.inf
        return self.E * (self.nu / ((1 + self.nu) * (1 - 2 * self.nu)))

    @property
    def mu(self) -> float:
        """The shear modulus mu = G = E / (2 (1 + nu)), MPa (eq. 11)."""
        return self.E / (2 * (1 + self.nu))

    @property
    def kappa(self) -> float:
        """The bulk modulus kappa = E / (3 (1 - 2 nu)), MPa (eq. 10); inf at nu = 1/2."""
        if self.incompressible:
            return math.inf
        return self.E / (3 * (1 - 2 * self.nu))

    @property
    def incompressible(self) -> bool:
        """Whether volume cannot change: nu = 1/2."""
        return self.nu == 0.5

    @property
    def compressibility(self) -> float:
        """1/kappa = 3 (1 - 2 nu) / E, 1/MPa: what the mixed form carries, 0 at nu = 1/2."""
        return 3 * (1 - 2 * self.nu) / self.E

    @property
    def voigt(self) -> Floats:
        """The matrix C (6, 6) MPa of eq. 6, order XX YY ZZ XY YZ ZX, engineering shears.

        Kept for reading and for tests; nothing inside multiplies by it. It is `stress` written
        for six numbers:

        >>> tissue = LinearElastic(E=2.0, nu=0.3)
        >>> H = np.arange(9.0).reshape(3, 3) ** 2
        >>> eps = (H + H.T) / 2
        >>> six = [eps[0, 0], eps[1, 1], eps[2, 2], 2 * eps[0, 1], 2 * eps[1, 2], 2 * eps[2, 0]]
        >>> tau = tissue.stress(H)
        >>> same = [tau[0, 0], tau[1, 1], tau[2, 2], tau[0, 1], tau[1, 2], tau[2, 0]]
        >>> bool(np.allclose(tissue.voigt @ six, same, rtol=1e-14))
        True
        """
        C = np.zeros((6, 6))
        C[:3, :3] = self.lam
        C[range(3), range(3)] += 2 * self.mu
        C[range(3, 6), range(3, 6)] = self.mu
        return frozen(C)

    def stress(self, H: Floats) -> Floats:
        """Stress (..., 3, 3) MPa at H (..., 3, 3): lambda tr(eps) I + 2 mu eps.

        eps = (H + H^T)/2 with H_kl = du_k/dx_l. Small strains: a turned body (H = R - I) is
        strained by 1 - cos(angle), which is what linear elasticity means.

        >>> spin = np.array([[0, -1.0, 0], [1, 0, 0], [0, 0, 0]])
        >>> float(abs(LinearElastic(1.0, 0.3).stress(spin)).max())
        0.0
        """
        if self.incompressible:
            raise InputError(
                "nu = 1/2: the displacement does not give the stress, whose pressure is an unknown "
                "of its own; take deviatoric_stress(H) - p I"
            )
        strain = (H + np.swapaxes(H, -1, -2)) / 2
        trace = np.trace(strain, axis1=-2, axis2=-1)
        stress: Floats = 2 * self.mu * strain + self.lam * trace[..., None, None] * np.eye(3)
        return stress

    def deviatoric_stress(self, H: Floats) -> Floats:
        """The deviatoric stress (..., 3, 3) MPa at H (..., 3, 3): 2 G (eps - tr(eps)/3 I).

        Paper, eqs. 13 and 18; stress = 2 G eps' - p I with p > 0 in compression. With the pressure
        p = -kappa tr(eps) of eq. 14 the sum is that of eq. 9:

        >>> H = np.arange(9.0).reshape(3, 3) ** 2
        >>> tissue = LinearElastic(E=2.0, nu=0.3)
        >>> p = -tissue.kappa * np.trace(H)
        >>> bool(np.allclose(tissue.deviatoric_stress(H) - p * np.eye(3), tissue.stress(H)))
        True
        """
        strain = (H + np.swapaxes(H, -1, -2)) / 2
        mean = np.trace(strain, axis1=-2, axis2=-1)[..., None, None] / 3
        deviatoric: Floats = 2 * self.mu * (strain - mean * np.eye(3))
        return deviatoric

    @property
    def finite(self) -> bool:
        """False: the strain is small."""
        return False

    def derivative(self, H: Floats, dH: Floats) -> Floats:
        """The change of the stress in the direction dH, the same at every H, MPa."""
        return self.stress(dH)

    def energy(self, H: Floats) -> Floats:
        """The stored energy tau : eps / 2 (...) N/mm2."""
        return np.asarray(np.einsum("...ij,...ij->...", self.stress(H), H) / 2)
