# SPDX-License-Identifier: BSD-3-Clause
"""The laws once more, in the plainest arrays: twins of the core's, and laws of a user.

Written from the energies of docs/theory/nonlinear.md, without a look at the core. They work with
complex numbers, so that `FunctionLaw` differentiates them exactly; Ogden's, by eigenvalues, and the
mean norm, by absolute values, do not.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from bezsoma.mechanics.laws import FunctionLaw

Array = npt.NDArray[Any]
I = np.eye(3)


def transposed(A: Array) -> Array:
    """A^T."""
    return np.swapaxes(A, -1, -2)


def trace(A: Array) -> Array:
    """tr A (..., 1, 1)."""
    return np.trace(A, axis1=-2, axis2=-1)[..., None, None]


def dots(A: Array, B: Array) -> Array:
    """A : B (...)."""
    return np.einsum("...ij,...ij->...", A, B)


def det(F: Array) -> Array:
    """det F (..., 1, 1), by cofactors: also of complex numbers."""
    return np.einsum("...i,...i->...", F[..., 0], np.cross(F[..., 1], F[..., 2]))[..., None, None]


def cofactor(F: Array) -> Array:
    """J F^-T."""
    a, b, c = F[..., 0], F[..., 1], F[..., 2]
    return np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=-1)


def moduli(E: float, nu: float) -> tuple[float, float]:
    """Lame's lambda and mu."""
    return E * nu / (1 + nu) / (1 - 2 * nu), E / 2 / (1 + nu)


def finite(P: Callable[[Array, Array, Array], Array], W: Callable[[Array, Array], Array]) -> Any:
    """A FunctionLaw from P(F, J, F^-T) and W(F, J)."""

    def stress(H: Array) -> Array:
        F = I + H
        J = det(F)
        return P(F, J, cofactor(F) / J)

    def energy(H: Array) -> Array:
        F = I + H
        return W(F, det(F)[..., 0, 0])

    return FunctionLaw(stress, energy=energy)


def st_venant_kirchhoff(E: float, nu: float) -> FunctionLaw:
    """lambda/2 (tr E)^2 + mu E:E."""
    lam, mu = moduli(E, nu)

    def strain(F: Array) -> Array:
        return (transposed(F) @ F - I) / 2

    return finite(
        lambda F, J, T: F @ (lam * trace(strain(F)) * I + 2 * mu * strain(F)),
        lambda F, J: lam / 2 * trace(strain(F))[..., 0, 0] ** 2 + mu * dots(strain(F), strain(F)),
    )


def neo_hooke(E: float, nu: float) -> FunctionLaw:
    """mu/2 (I1 - 3) - mu ln J + lambda/2 (ln J)^2."""
    lam, mu = moduli(E, nu)
    return finite(
        lambda F, J, T: mu * (F - T) + lam * np.log(J) * T,
        lambda F, J: mu / 2 * (dots(F, F) - 3) - mu * np.log(J) + lam / 2 * np.log(J) ** 2,
    )


def _first(F: Array, J: Array, T: Array) -> Array:
    """d(J^(-2/3) I1)/dF."""
    return 2 * J ** (-2 / 3) * (F - trace(transposed(F) @ F) / 3 * T)


def _second(F: Array, J: Array, T: Array) -> Array:
    """d(J^(-4/3) I2)/dF."""
    C = transposed(F) @ F
    I1 = trace(C)
    I2 = (I1**2 - trace(C @ C)) / 2
    return 2 * J ** (-4 / 3) * (I1 * F - F @ C - 2 / 3 * I2 * T)


def _bars(F: Array, J: Array) -> tuple[Array, Array]:
    C = transposed(F) @ F
    I1 = trace(C)[..., 0, 0]
    I2 = (I1**2 - trace(C @ C)[..., 0, 0]) / 2
    return J ** (-2 / 3) * I1, J ** (-4 / 3) * I2


def mooney_rivlin(c1: float, c2: float, kappa: float) -> FunctionLaw:
    """c1 (I1bar - 3) + c2 (I2bar - 3) + kappa/2 (J - 1)^2."""

    def W(F: Array, J: Array) -> Array:
        one, two = _bars(F, J)
        return c1 * (one - 3) + c2 * (two - 3) + kappa / 2 * (J - 1) ** 2

    return finite(
        lambda F, J, T: c1 * _first(F, J, T) + c2 * _second(F, J, T) + kappa * (J - 1) * J * T, W
    )


def veronda_westmann(c1: float, c2: float, kappa: float) -> FunctionLaw:
    """c1 (exp(c2 (I1bar - 3)) - 1) - c1 c2/2 (I2bar - 3) + kappa/2 (J - 1)^2."""

    def P(F: Array, J: Array, T: Array) -> Array:
        one = J ** (-2 / 3) * trace(transposed(F) @ F)
        steep = c1 * c2 * np.exp(c2 * (one - 3))
        first, second = _first(F, J, T), _second(F, J, T)
        return steep * first - c1 * c2 / 2 * second + kappa * (J - 1) * J * T

    def W(F: Array, J: Array) -> Array:
        one, two = _bars(F, J)
        shape = c1 * (np.exp(c2 * (one - 3)) - 1) - c1 * c2 / 2 * (two - 3)
        return shape + kappa / 2 * (J - 1) ** 2

    return finite(P, W)


def ogden(mu: Sequence[float], alpha: Sequence[float], kappa: float) -> FunctionLaw:
    """sum mu_i/alpha_i (sum_k lbar_k^alpha_i - 3) + kappa/2 (J - 1)^2, by principal stretches."""

    def stress(H: Array) -> Array:
        F = I + H
        J = det(F)
        squares, N = np.linalg.eigh(transposed(F) @ F)
        bars = np.sqrt(squares) * J[..., 0] ** (-1 / 3)
        powers = [m * bars**a for m, a in zip(mu, alpha, strict=True)]
        along = sum(p - p.mean(axis=-1, keepdims=True) for p in powers) / squares
        S = (N * along[..., None, :]) @ transposed(N)
        return F @ S + kappa * (J - 1) * cofactor(F)

    def energy(H: Array) -> Array:
        F = I + H
        J = det(F)[..., 0]
        bars = np.sqrt(np.linalg.eigvalsh(transposed(F) @ F)) * J ** (-1 / 3)
        shape = sum(m / a * ((bars**a).sum(axis=-1) - 3) for m, a in zip(mu, alpha, strict=True))
        return np.asarray(shape + kappa / 2 * (J[..., 0] - 1) ** 2)

    return FunctionLaw(stress, energy=energy, derivative="differences")


def guccione(
    C: float, bf: float, bt: float, bfs: float, kappa: float, frame: Array = I
) -> FunctionLaw:
    """C/2 (exp Q - 1) + kappa/2 (J - 1)^2; rows of the frame: fibre, sheet, normal."""
    weights = np.array([[bf, bfs, bfs], [bfs, bt, bt], [bfs, bt, bt]])

    def strain(F: Array) -> Array:
        return frame @ (transposed(F) @ F - I) @ frame.T / 2

    def P(F: Array, J: Array, T: Array) -> Array:
        G = strain(F)
        Q = dots(weights * G, G)[..., None, None]
        S = C * np.exp(Q) * weights * G
        return F @ (frame.T @ S @ frame) + kappa * (J - 1) * J * T

    def W(F: Array, J: Array) -> Array:
        G = strain(F)
        return C / 2 * (np.exp(dots(weights * G, G)) - 1) + kappa / 2 * (J - 1) ** 2

    return finite(P, W)


def stiffening(
    E: float, nu: float, A: float, measure: str = "frobenius", shears: str = "tensor"
) -> FunctionLaw:
    """exp(A s^2) C eps; the energy and the deviatoric norm as ERRATA has them."""
    lam, mu = moduli(E, nu)
    kappa = lam + 2 * mu / 3
    w = np.where(I > 0, 1.0, 1.0 if shears == "tensor" else 2.0)

    def small(H: Array) -> Array:
        return (H + transposed(H)) / 2

    def linear(e: Array) -> Array:
        return lam * trace(e) * I + 2 * mu * e

    def square(e: Array) -> Array:
        if measure == "mean":
            return (np.abs(w * e).sum(axis=(-2, -1)) / 9) ** 2
        if measure == "energy":
            return dots(linear(e), e) / E
        return dots(w * e, w * e)

    def stress(H: Array) -> Array:
        e = small(H)
        if measure == "deviatoric":
            d = e - trace(e) / 3 * I
            return kappa * trace(e) * I + 2 * mu * np.exp(A * dots(d, d))[..., None, None] * d
        return np.exp(A * square(e))[..., None, None] * linear(e)

    def energy(H: Array) -> Array:
        e = small(H)
        if measure == "energy":
            return E / (2 * A) * (np.exp(A * square(e)) - 1)
        d = e - trace(e) / 3 * I
        volume = kappa / 2 * trace(e)[..., 0, 0] ** 2
        return volume + mu / A * (np.exp(A * dots(d, d)) - 1)

    has = measure in ("energy", "deviatoric")
    how = "differences" if measure == "mean" else "complex step"
    return FunctionLaw(stress, energy=energy if has else None, finite=False, derivative=how)
