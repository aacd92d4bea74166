# SPDX-License-Identifier: BSD-3-Clause
"""The laws of the core once more, each in a line of plain arithmetic over complex numbers.

Written from the definitions alone, so that two spellings agree or one is wrong. Stress follows by
complex steps: d/dh Im f(H + i h dH) at h = 1e-30, exact to rounding.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

Complex = Any
"""An array of real or complex numbers."""

STEP = 1e-30
KAPPA, MU = 3.0, 0.7
FRAME = np.linalg.qr(np.random.default_rng(5).standard_normal((3, 3)))[0]


def strain(H: Complex) -> Complex:
    return (H + np.swapaxes(H, -1, -2)) / 2


def dot(A: Complex, B: Complex) -> Complex:
    return np.einsum("...ij,...ij->...", A, B)


def trace(A: Complex) -> Complex:
    return np.einsum("...ii->...", A)


def deviator(A: Complex) -> Complex:
    return A - trace(A)[..., None, None] / 3 * np.eye(3)


def cauchy_green(H: Complex) -> tuple[Complex, Complex]:
    """C = F^T F and J, for complex H too: transposed, never conjugated."""
    F = H + np.eye(3)
    return np.swapaxes(F, -1, -2) @ F, np.linalg.det(F)


def lame(E: Complex) -> Complex:
    """The linear stress."""
    return 2 * MU * deviator(E) + KAPPA * trace(E)[..., None, None] * np.eye(3)


def linear(H: Complex) -> Complex:
    return dot(strain(H), lame(strain(H))) / 2


def energy_norm(H: Complex, A: float = 5.0) -> Complex:
    E0 = 9 * KAPPA * MU / (3 * KAPPA + MU)
    return E0 / (2 * A) * (np.exp(A * dot(strain(H), lame(strain(H))) / E0) - 1)


def deviatoric(H: Complex, A: float = 5.0) -> Complex:
    e = deviator(strain(H))
    return KAPPA / 2 * trace(strain(H)) ** 2 + MU / A * (np.exp(A * dot(e, e)) - 1)


def st_venant_kirchhoff(H: Complex) -> Complex:
    E = (cauchy_green(H)[0] - np.eye(3)) / 2
    return (KAPPA - 2 * MU / 3) / 2 * trace(E) ** 2 + MU * dot(E, E)


def neo_hooke(H: Complex) -> Complex:
    C, J = cauchy_green(H)
    return MU / 2 * (trace(C) - 3) - MU * np.log(J) + (KAPPA - 2 * MU / 3) / 2 * np.log(J) ** 2


def invariants(H: Complex) -> tuple[Complex, Complex, Complex]:
    """I1bar - 3, I2bar - 3 and J."""
    C, J = cauchy_green(H)
    I2 = (trace(C) ** 2 - dot(C, C)) / 2
    return J ** (-2 / 3) * trace(C) - 3, J ** (-4 / 3) * I2 - 3, J


def volume(J: Complex) -> Complex:
    return KAPPA / 2 * (J - 1) ** 2


def neo_hooke_isochoric(H: Complex) -> Complex:
    I1, _, J = invariants(H)
    return MU / 2 * I1 + volume(J)


def mooney_rivlin(H: Complex) -> Complex:
    I1, I2, J = invariants(H)
    return 0.3 * I1 + 0.2 * I2 + volume(J)


def veronda_westmann(H: Complex) -> Complex:
    I1, I2, J = invariants(H)
    return 0.3 * (np.exp(1.2 * I1) - 1) - 0.3 * 1.2 / 2 * I2 + volume(J)


def guccione(H: Complex) -> Complex:
    C, J = cauchy_green(H)
    E = FRAME @ ((C - np.eye(3)) / 2) @ FRAME.T
    e = {a + b: E[..., i, j] for i, a in enumerate("fsn") for j, b in enumerate("fsn")}
    Q = (
        3 * e["ff"] ** 2
        + 2 * (e["ss"] ** 2 + e["nn"] ** 2 + 2 * e["sn"] ** 2)
        + 2 * 1.5 * (e["fs"] ** 2 + e["fn"] ** 2)
    )
    return 0.5 / 2 * (np.exp(Q) - 1) + volume(J)


def ogden(H: Complex) -> Complex:
    """By powers of C, for which complex steps hold: sum l_a^alpha = tr C^(alpha/2)."""
    C, J = cauchy_green(H)
    found = volume(J)
    for mu, alpha in ((0.5, 2.0), (-0.3, -3.0), (0.02, 9.0)):
        powers = np.sum(np.linalg.eigvals(C) ** (alpha / 2), axis=-1)
        found = found + mu / alpha * (J ** (-alpha / 3) * powers - 3)
    return found


class Plain(NamedTuple):
    """A law of the core with its parameters, and its energy spelled out."""

    parameters: list[float]
    energy: Callable[[Complex], Complex]


ENERGIES = {
    "linear": Plain([KAPPA, MU], linear),
    "stiffening_energy": Plain([KAPPA, MU, 5.0], energy_norm),
    "stiffening_deviatoric": Plain([KAPPA, MU, 5.0], deviatoric),
    "st_venant_kirchhoff": Plain([KAPPA, MU], st_venant_kirchhoff),
    "neo_hooke": Plain([KAPPA, MU], neo_hooke),
    "neo_hooke_isochoric": Plain([KAPPA, MU], neo_hooke_isochoric),
    "mooney_rivlin": Plain([KAPPA, 0.3, 0.2], mooney_rivlin),
    "ogden": Plain([KAPPA, 0.5, 2.0, -0.3, -3.0, 0.02, 9.0], ogden),
    "veronda_westmann": Plain([KAPPA, 0.3, 1.2], veronda_westmann),
    "guccione": Plain([KAPPA, 0.5, 3.0, 2.0, 1.5, *FRAME[0]], guccione),
}

SHEARS = {"": 1.0, "_engineering": 2.0}
"""How often an eps_ij counts for an off-diagonal entry, as tensor or as engineering shear."""


def secant(name: str, H: Complex, A: float = 5.0) -> Complex:
    """tau of the laws without energy: exp(A s^2) C eps."""
    _, measure, *engineering = name.split("_")
    e = strain(H)
    entries = e * (1 + (SHEARS["_engineering" if engineering else ""] - 1) * (1 - np.eye(3)))
    if measure == "frobenius":
        squared = dot(entries, entries)
    else:
        squared = (np.sum(entries * np.sign(entries.real), axis=(-1, -2)) / 9) ** 2
    return np.exp(A * squared)[..., None, None] * lame(e)


SECANTS = tuple(f"stiffening_{m}{s}" for m in ("frobenius", "mean") for s in SHEARS)
PARAMETERS = {name: law.parameters for name, law in ENERGIES.items()} | {
    name: [KAPPA, MU, 5.0] for name in SECANTS
}


def stress(name: str, H: Complex) -> Complex:
    """P by complex steps of the energy, or tau."""
    if name in SECANTS:
        return secant(name, H)
    P = np.empty(H.shape)
    for k in range(3):
        for l in range(3):
            step = np.zeros((3, 3))
            step[k, l] = STEP
            P[..., k, l] = ENERGIES[name].energy(H + 1j * step).imag / STEP
    return P
