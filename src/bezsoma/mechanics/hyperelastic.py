# SPDX-License-Identifier: BSD-3-Clause
"""Laws at finite strain, each from a stored energy: F = I + H, C = F^T F, J = det F.

What they have in common: stress is the first Piola-Kirchhoff stress P = dW/dF, `solution.stress`
the Cauchy stress P F^T / J; a bar over an invariant or a stretch means that the change of volume
is taken out, J^(-2/3) I1, J^(-4/3) I2, J^(-1/3) l. J <= 0 is refused.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from bezsoma import _core
from bezsoma.arrays import Floats
from bezsoma.errors import InputError
from bezsoma.mechanics import compiled
from bezsoma.mechanics.checks import number, numbers
from bezsoma.mechanics.compiled import bulk, kappa_mu, not_negative, poissons, positive, youngs

_SOFT = "or the material would give way without force"


@dataclass(frozen=True)
class StVenantKirchhoff:
    """W = lambda/2 (tr E)^2 + mu E:E with Green's strain E = (C - I)/2; E [MPa] > 0, -1 < nu < 1/2.

    The linear law, turned with the body: right for large turns and small strains. Beware of
    compression: it softens, and below a stretch of sqrt(1/3) it gives way (G. A. Holzapfel,
    Nonlinear Solid Mechanics, 2000, section 6.5). A turn costs nothing:

    >>> spin = np.array([[0, -1.0, 0], [1, 0, 0], [0, 0, 1]])
    >>> float(abs(StVenantKirchhoff(E=1.0, nu=0.3).stress(spin - np.eye(3))).max()) < 1e-15
    True
    """

    E: float
    nu: float
    linear: ClassVar[bool] = False
    finite: ClassVar[bool] = True
    symmetric: ClassVar[bool] = True

    def __post_init__(self) -> None:
        object.__setattr__(self, "E", youngs(self.E, "StVenantKirchhoff"))
        object.__setattr__(self, "nu", poissons(self.nu, "StVenantKirchhoff"))
        if self.nu == 0.5:
            raise InputError(
                "nu = 1/2: StVenantKirchhoff does not split into a shape and a volume part, so it "
                "has no incompressible form; take NeoHooke(E=..., nu=0.5) in a Body with a pressure"
            )

    @cached_property
    def core(self) -> _core.Law:
        """The core's law."""
        return _core.Law("st_venant_kirchhoff", kappa_mu(self.E, self.nu))

    stress = compiled.stress
    derivative = compiled.derivative
    energy = compiled.energy


@dataclass(frozen=True)
class NeoHooke:
    """W = mu/2 (I1 - 3) - mu ln J + lambda/2 (ln J)^2; E [MPa] > 0, -1 < nu < 1/2.

    The simplest law that bears any strain (J. Bonet and R. D. Wood, Nonlinear Continuum Mechanics,
    2nd ed. (2008), eq. 6.27), linear elasticity with E and nu near rest. In a Body with a pressure
    of its own, nu = 1/2 allowed, it is W = mu/2 (J^(-2/3) I1 - 3) + kappa/2 (J - 1)^2.

    Under pressure alone, F = l I: P = (mu (l - 1/l) + 3 lambda ln(l)/l) I.

    >>> law, l = NeoHooke(E=2.5, nu=0.25), 1.2
    >>> P = law.stress((l - 1) * np.eye(3))[0, 0]
    >>> bool(np.isclose(P, (l - 1 / l) + 3 * np.log(l) / l, rtol=1e-14))
    True
    """

    E: float
    nu: float
    linear: ClassVar[bool] = False
    finite: ClassVar[bool] = True
    symmetric: ClassVar[bool] = True

    def __post_init__(self) -> None:
        object.__setattr__(self, "E", youngs(self.E, "NeoHooke"))
        object.__setattr__(self, "nu", poissons(self.nu, "NeoHooke"))

    @cached_property
    def core(self) -> _core.Law:
        """The core's law."""
        return _core.Law("neo_hooke", kappa_mu(self.E, self.nu))

    @cached_property
    def core_mixed(self) -> _core.Law:
        """The core's law beside a pressure."""
        return _core.Law("neo_hooke_isochoric", kappa_mu(self.E, self.nu))

    stress = compiled.stress
    derivative = compiled.derivative
    energy = compiled.energy
    mixed_stress = compiled.mixed_stress
    mixed_derivative = compiled.mixed_derivative
    mixed_energy = compiled.mixed_energy


@dataclass(frozen=True)
class MooneyRivlin:
    """W = c1 (I1bar - 3) + c2 (I2bar - 3) + kappa/2 (J - 1)^2; c1, c2 >= 0, kappa > 0, MPa.

    M. Mooney, J. Appl. Phys. 11 (1940), doi:10.1063/1.1712836; R. S. Rivlin, Phil. Trans. A 241
    (1948), doi:10.1098/rsta.1948.0024. G = 2 (c1 + c2) near rest; c2 = 0 is the isochoric
    neo-Hookean law. kappa = inf is incompressible, in a Body with a pressure of its own.

    A simple shear by g carries 2 (c1 + c2) g whatever its size:

    >>> law = MooneyRivlin(c1=0.3, c2=0.2, kappa=5.0)
    >>> H = np.zeros((3, 3))
    >>> H[0, 1] = 0.7
    >>> bool(np.isclose(law.stress(H)[0, 1], 2 * 0.5 * 0.7, rtol=1e-14))
    True
    """

    c1: float
    c2: float
    kappa: float
    linear: ClassVar[bool] = False
    finite: ClassVar[bool] = True
    symmetric: ClassVar[bool] = True

    def __post_init__(self) -> None:
        why = "or a large enough stretch would gain energy"
        for name in ("c1", "c2"):
            of = f"{name} of MooneyRivlin"
            object.__setattr__(self, name, not_negative(getattr(self, name), of, "MPa", why))
        if self.c1 + self.c2 == 0:
            raise InputError(
                "c1 = c2 = 0 MPa: then MooneyRivlin has no shear modulus; one of them must be "
                "positive"
            )
        object.__setattr__(self, "kappa", bulk(self.kappa, "MooneyRivlin"))

    @cached_property
    def core(self) -> _core.Law:
        """The core's law."""
        return _core.Law("mooney_rivlin", [self.kappa, self.c1, self.c2])

    stress = compiled.stress
    derivative = compiled.derivative
    energy = compiled.energy
    mixed_stress = compiled.mixed_stress
    mixed_derivative = compiled.mixed_derivative
    mixed_energy = compiled.mixed_energy


@dataclass(frozen=True)
class Ogden:
    """W = sum_i mu_i/alpha_i (l1bar^alpha_i + l2bar^alpha_i + l3bar^alpha_i - 3) + kappa/2 (J-1)^2.

    R. W. Ogden, Proc. R. Soc. A 326 (1972), doi:10.1098/rspa.1972.0026. mu [MPa] and alpha [-] are
    lists of the same length, mu_i alpha_i > 0, which makes each term convex; kappa > 0 MPa, or inf
    in a Body with a pressure of its own. G = 1/2 sum mu_i alpha_i near rest. Up to six terms.

    alpha = 2 and -2 are Mooney and Rivlin's law with c1 = mu_1/2, c2 = -mu_2/2:

    >>> one = Ogden(mu=[0.6, -0.4], alpha=[2.0, -2.0], kappa=5.0)
    >>> other = MooneyRivlin(c1=0.3, c2=0.2, kappa=5.0)
    >>> H = np.array([[0.2, 0.3, 0], [0.1, -0.1, 0.2], [0, 0.1, 0.3]])
    >>> bool(np.allclose(one.stress(H), other.stress(H), rtol=1e-13))
    True
    """

    mu: tuple[float, ...]
    alpha: tuple[float, ...]
    kappa: float
    linear: ClassVar[bool] = False
    finite: ClassVar[bool] = True
    symmetric: ClassVar[bool] = True

    def __init__(self, mu: Sequence[float], alpha: Sequence[float], kappa: float) -> None:
        moduli, powers = _list(mu, "mu of Ogden (MPa)"), _list(alpha, "alpha of Ogden")
        if len(moduli) != len(powers) or not 1 <= len(moduli) <= 6:
            raise InputError(
                f"Ogden was given {len(moduli)} mu and {len(powers)} alpha; it takes as many of "
                "the one as of the other, one to six"
            )
        for modulus, power in zip(moduli, powers, strict=True):
            if not modulus * power > 0:
                raise InputError(
                    f"mu = {modulus:g} MPa with alpha = {power:g} of Ogden: mu * alpha must be "
                    "positive, or the term would gain energy in a large enough stretch"
                )
        object.__setattr__(self, "mu", moduli)
        object.__setattr__(self, "alpha", powers)
        object.__setattr__(self, "kappa", bulk(kappa, "Ogden"))

    @cached_property
    def core(self) -> _core.Law:
        """The core's law."""
        terms = np.stack([self.mu, self.alpha], axis=1).ravel()
        return _core.Law("ogden", [self.kappa, *terms])

    stress = compiled.stress
    derivative = compiled.derivative
    energy = compiled.energy
    mixed_stress = compiled.mixed_stress
    mixed_derivative = compiled.mixed_derivative
    mixed_energy = compiled.mixed_energy


def _list(given: Sequence[float], what: str) -> tuple[float, ...]:
    if isinstance(given, int | float) or (isinstance(given, np.ndarray) and given.ndim == 0):
        given = [float(given)]
    if isinstance(given, str) or not hasattr(given, "__iter__"):
        raise InputError(f"{what} is {given!r}; it must be a list of numbers")
    return tuple(number(each, what) for each in given)


@dataclass(frozen=True)
class VerondaWestmann:
    """W = c1 (exp(c2 (I1bar - 3)) - 1) - c1 c2/2 (I2bar - 3) + kappa/2 (J - 1)^2.

    Skin: D. R. Veronda and R. A. Westmann, J. Biomech. 3 (1970), doi:10.1016/0021-9290(70)90055-2.
    c1 [MPa] > 0, c2 [-] > 0, kappa [MPa] > 0 or inf (in a Body with a pressure of its own).
    G = c1 c2 near rest.

    >>> law = VerondaWestmann(c1=0.5, c2=0.4, kappa=5.0)
    >>> H = np.zeros((3, 3))
    >>> H[0, 1] = 1e-6
    >>> bool(np.isclose(law.stress(H)[0, 1] / 1e-6, 0.2, rtol=1e-9))
    True
    """

    c1: float
    c2: float
    kappa: float
    linear: ClassVar[bool] = False
    finite: ClassVar[bool] = True
    symmetric: ClassVar[bool] = True

    def __post_init__(self) -> None:
        object.__setattr__(self, "c1", positive(self.c1, "c1 of VerondaWestmann", "MPa", _SOFT))
        object.__setattr__(self, "c2", positive(self.c2, "c2 of VerondaWestmann", "", _SOFT))
        object.__setattr__(self, "kappa", bulk(self.kappa, "VerondaWestmann"))

    @cached_property
    def core(self) -> _core.Law:
        """The core's law."""
        return _core.Law("veronda_westmann", [self.kappa, self.c1, self.c2])

    stress = compiled.stress
    derivative = compiled.derivative
    energy = compiled.energy
    mixed_stress = compiled.mixed_stress
    mixed_derivative = compiled.mixed_derivative
    mixed_energy = compiled.mixed_energy


@dataclass(frozen=True, eq=False)
class Guccione:
    """Muscle with fibres: W = C/2 (exp Q - 1) + kappa/2 (J - 1)^2, Green's strain E in the frame.

        Q = bf Eff^2 + bt (Ess^2 + Enn^2 + 2 Esn^2) + 2 bfs (Efs^2 + Efn^2)

    J. M. Guccione, A. D. McCulloch and L. K. Waldman, J. Biomech. Eng. 113 (1991),
    doi:10.1115/1.2894084. C [MPa] > 0; bf, bt, bfs [-] > 0; kappa [MPa] > 0, or inf in a Body with
    a pressure of its own. `fibre` is the direction f of the fibres of the region; s and n stand
    across it, and the law does not depend on which two are taken.

    With bf = bt = bfs = b it has no direction, and E = 3/2 C b (kappa = inf) near rest:

    >>> law = Guccione(C=0.2, bf=2.0, bt=2.0, bfs=2.0, kappa=1e3, fibre=(1, 1, 0))
    >>> H = np.zeros((3, 3))
    >>> H[0, 1] = 1e-6
    >>> bool(np.isclose(law.stress(H)[0, 1] / 1e-6, 0.2, rtol=1e-6))
    True
    """

    C: float
    bf: float
    bt: float
    bfs: float
    kappa: float
    fibre: Floats
    linear: ClassVar[bool] = False
    finite: ClassVar[bool] = True
    symmetric: ClassVar[bool] = True

    def __post_init__(self) -> None:
        object.__setattr__(self, "C", positive(self.C, "C of Guccione", "MPa", _SOFT))
        for name in ("bf", "bt", "bfs"):
            of = f"{name} of Guccione"
            object.__setattr__(self, name, positive(getattr(self, name), of, "", _SOFT))
        object.__setattr__(self, "kappa", bulk(self.kappa, "Guccione"))
        object.__setattr__(self, "fibre", numbers(self.fibre, (3,), "the fibre of Guccione"))
        if not np.any(self.fibre):
            raise InputError(
                "the fibre of Guccione is (0, 0, 0); it must point somewhere, as (1, 0, 0) does"
            )

    @cached_property
    def core(self) -> _core.Law:
        """The core's law."""
        f = self.fibre / np.abs(self.fibre).max()
        f = f / np.sqrt((f**2).sum())
        return _core.Law("guccione", [self.kappa, self.C, self.bf, self.bt, self.bfs, *f])

    stress = compiled.stress
    derivative = compiled.derivative
    energy = compiled.energy
    mixed_stress = compiled.mixed_stress
    mixed_derivative = compiled.mixed_derivative
    mixed_energy = compiled.mixed_energy
