# SPDX-License-Identifier: BSD-3-Clause
"""Every law that there is: as built in, as its plain twin, and by principal stretches."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import root

import bezsoma as bz
from bezsoma.mechanics.laws import FunctionLaw, Law
from laws import plain_laws as plain

Energy = Callable[[Any], Any]
"""W of the three principal stretches; along x, y and z."""

E, NU, KAPPA = 2.0, 0.3, 5.0
LAM, MU = plain.moduli(E, NU)
BULK = LAM + 2 * MU / 3


def _volume(J: Any, shape: Any, kappa: float = KAPPA) -> Any:
    return shape + kappa / 2 * (J - 1) ** 2


def _svk(s: Any) -> Any:
    G = (s**2 - 1) / 2
    return LAM / 2 * G.sum() ** 2 + MU * (G**2).sum()


def _neo_hooke(s: Any) -> Any:
    J = s.prod()
    return MU / 2 * ((s**2).sum() - 3) - MU * np.log(J) + LAM / 2 * np.log(J) ** 2


def _bars(s: Any) -> tuple[Any, Any]:
    b = s * s.prod() ** (-1 / 3)
    return (b**2).sum() - 3, (b**-2).sum() - 3


def _mooney(s: Any) -> Any:
    one, two = _bars(s)
    return _volume(s.prod(), 0.5 * one + 0.2 * two)


def _ogden(s: Any) -> Any:
    b = s * s.prod() ** (-1 / 3)
    shape = 0.7 / 1.6 * ((b**1.6).sum() - 3) + 0.1 / 2.5 * ((b**-2.5).sum() - 3)
    return _volume(s.prod(), shape)


def _veronda(s: Any) -> Any:
    one, two = _bars(s)
    return _volume(s.prod(), 0.5 * (np.exp(0.8 * one) - 1) - 0.5 * 0.8 / 2 * two)


def _guccione(s: Any) -> Any:
    G = (s**2 - 1) / 2
    Q = 4.0 * G[0] ** 2 + 1.5 * (G[1] ** 2 + G[2] ** 2)
    return _volume(s.prod(), 0.5 / 2 * (np.exp(Q) - 1))


def _energy_norm(s: Any) -> Any:
    e = s - 1
    return E / 4 * (np.exp(2 * (LAM * e.sum() ** 2 + 2 * MU * (e**2).sum()) / E) - 1)


def _deviatoric(s: Any) -> Any:
    e = s - 1
    d = e - e.sum() / 3
    return BULK / 2 * e.sum() ** 2 + MU / 2 * (np.exp(2 * (d**2).sum()) - 1)


def _frobenius(s: Any) -> Any:
    e = s - 1
    return np.exp(2 * (e**2).sum()) * (LAM * e.sum() + 2 * MU * e)


def _mean(s: Any) -> Any:
    e = s - 1
    return np.exp(2 * (np.abs(e).sum() / 9) ** 2) * (LAM * e.sum() + 2 * MU * e)


@dataclass(frozen=True)
class Entry:
    """A law three times: built in, plain, and W (or the stress itself) by principal stretches.

    `shear` gives the shear stress of a simple shear by g, from the textbook or from its energy.
    """

    built: Callable[[], Law]
    plain: FunctionLaw
    principal: Energy
    shear: Callable[[float], float]
    energy: bool = True
    isotropic: bool = True

    def stresses(self, s: Any) -> Any:
        """The principal stresses P_i = dW/ds_i, by a complex step."""
        if not self.energy:
            return self.principal(s)
        return np.array([self.principal(s + 1e-30j * unit).imag / 1e-30 for unit in np.eye(3)])

    def stretches(self, given: dict[int, float]) -> Any:
        """The stretches with some given and no stress along the others."""
        free = [axis for axis in range(3) if axis not in given]

        def whole(x: Any) -> Any:
            s = np.ones(3)
            s[list(given)] = list(given.values())
            s[free] = x
            return s

        if not free:
            return whole([])
        found = root(lambda x: self.stresses(whole(x))[free], np.ones(len(free)), tol=1e-14)
        assert np.abs(found.fun).max() < 1e-12
        return whole(found.x)


def _by_energy(W: Energy) -> Callable[[float], float]:
    """dW/dg of a simple shear, whose principal stretches are l, 1/l and 1, l - 1/l = g."""

    def stress(g: float) -> float:
        z = g + 1e-30j
        long = z / 2 + np.sqrt(1 + z * z / 4)
        return float(W(np.array([long, 1 / long, 1.0])).imag / 1e-30)

    return stress


def _by_strain(W: Energy) -> Callable[[float], float]:
    """The same of a law at small strain: principal strains g/2, -g/2, 0."""

    def stress(g: float) -> float:
        z = g + 1e-30j
        return float(W(np.array([1 + z / 2, 1 - z / 2, 1.0])).imag / 1e-30)

    return stress


def _guccione_shear(g: float) -> float:
    """E_xy = g/2, E_yy = g^2/2: Q = 1.5 g^4/4 + 2 * 2.5 g^2/4, and dW/dg."""
    Q = 1.5 * g**4 / 4 + 2 * 2.5 * g**2 / 4
    return 0.5 / 2 * np.exp(Q) * (1.5 * g**3 + 2.5 * g)


def _stiffening(measure: str) -> Callable[[], Law]:
    return lambda: bz.Stiffening(E, NU, 2.0, measure=measure)


LAWS = {
    "st_venant_kirchhoff": Entry(
        lambda: bz.StVenantKirchhoff(E, NU),
        plain.st_venant_kirchhoff(E, NU),
        _svk,
        _by_energy(_svk),
    ),
    "neo_hooke": Entry(
        lambda: bz.NeoHooke(E, NU), plain.neo_hooke(E, NU), _neo_hooke, _by_energy(_neo_hooke)
    ),
    "mooney_rivlin": Entry(
        lambda: bz.MooneyRivlin(0.5, 0.2, KAPPA),
        plain.mooney_rivlin(0.5, 0.2, KAPPA),
        _mooney,
        lambda g: 2 * 0.7 * g,
    ),
    "ogden": Entry(
        lambda: bz.Ogden([0.7, -0.1], [1.6, -2.5], KAPPA),
        plain.ogden([0.7, -0.1], [1.6, -2.5], KAPPA),
        _ogden,
        _by_energy(_ogden),
    ),
    "veronda_westmann": Entry(
        lambda: bz.VerondaWestmann(0.5, 0.8, KAPPA),
        plain.veronda_westmann(0.5, 0.8, KAPPA),
        _veronda,
        lambda g: 0.5 * 0.8 * g * (2 * np.exp(0.8 * g**2) - 1),
    ),
    "guccione": Entry(
        lambda: bz.Guccione(0.5, 4.0, 1.5, 2.5, KAPPA, (1, 0, 0)),
        plain.guccione(0.5, 4.0, 1.5, 2.5, KAPPA),
        _guccione,
        _guccione_shear,
        isotropic=False,
    ),
    "stiffening frobenius": Entry(
        _stiffening("frobenius"),
        plain.stiffening(E, NU, 2.0),
        _frobenius,
        lambda g: MU * g * np.exp(2 * g**2 / 2),
        energy=False,
    ),
    "stiffening mean": Entry(
        _stiffening("mean"),
        plain.stiffening(E, NU, 2.0, "mean"),
        _mean,
        lambda g: MU * g * np.exp(2 * (g / 9) ** 2),
        energy=False,
        isotropic=False,
    ),
    "stiffening energy": Entry(
        _stiffening("energy"),
        plain.stiffening(E, NU, 2.0, "energy"),
        _energy_norm,
        _by_strain(_energy_norm),
    ),
    "stiffening deviatoric": Entry(
        _stiffening("deviatoric"),
        plain.stiffening(E, NU, 2.0, "deviatoric"),
        _deviatoric,
        _by_strain(_deviatoric),
    ),
}
