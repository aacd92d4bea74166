# SPDX-License-Identifier: BSD-3-Clause
"""Whether a strained material resists every shear and stretch of a thin layer in it.

Where it does not, strain may gather in a layer as thin as the mesh allows: answers depend on the
mesh, tangents turn singular, and Newton's iteration goes astray.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from bezsoma.arrays import Floats, frozen
from bezsoma.mechanics.laws import Law, MixedLaw

LAYERS = 61
"""Normals of layers that are tried, over half a sphere: none is further than 12 degrees off."""

ROUNDING = 1e-13
"""An eigenvalue that is no larger part of the largest than this is none."""


@cache
def layers() -> Floats:
    """The normals (LAYERS, 3): Fibonacci's spiral over the half sphere z >= 0."""
    k = np.arange(LAYERS) + 0.5
    z, turn = k / LAYERS, np.pi * (1 + np.sqrt(5)) * k
    ring = np.sqrt(1 - z * z)
    return frozen(np.stack([ring * np.cos(turn), ring * np.sin(turn), z], axis=1))


def least_resistance(law: Law, H: Floats) -> Floats:
    """The least of a . Q(m) a (..., ) MPa over unit a and the normals m of `layers`.

    Q_ik(m) = dP_ij/dH_kl m_j m_l is the acoustic tensor; its symmetric part is positive for all m
    where the law is strongly elliptic (R. W. Ogden, Non-linear elastic deformations, 1984, 6.2.7).
    At rest a linear law has min(mu, lambda + 2 mu) = mu:

    >>> from bezsoma.mechanics.stiffening import Stiffening
    >>> law = Stiffening(E=1.0, nu=0.45, A=5.0)
    >>> H = np.zeros((3, 3, 3))
    >>> bool(abs(least_resistance(law, H) - 0.5 / 1.45).max() < 1e-14)
    True

    Neo-Hooke's Q = mu I + (mu + lambda - lambda ln J) n n^T, n = F^-T m, resists by mu throughout:

    >>> from bezsoma.mechanics.hyperelastic import NeoHooke
    >>> sheared = np.array([[0.3, 0.5, 0.0], [-0.2, 0.1, 0.4], [0.0, 0.3, -0.2]])
    >>> bool(abs(least_resistance(NeoHooke(E=1.0, nu=0.25), sheared[None]) - 0.4).max() < 1e-13)
    True

    The paper's law loses it by volume strain, at nu = 0.45 and A = 5 never below 0.33:

    >>> H[:] = np.diag([1.0, 1.0, 1.0]) * np.array([0.1, 0.25, -0.25])[:, None, None]
    >>> (least_resistance(law, H) > 0).tolist()
    [True, True, True]
    """
    least = np.full(H.shape[:-2], np.inf)
    for m in layers():
        Q = np.empty(H.shape)
        for k in range(3):
            Q[..., :, k] = law.derivative(H, _slip(k, m, H)) @ m
        both = (Q + np.swapaxes(Q, -1, -2)) / 2
        least = np.minimum(least, _least_eigenvalue(both))
    return least


def least_resistance_beside(law: MixedLaw, H: Floats, p: Floats) -> Floats:
    """The same (..., ) MPa of a law beside a pressure p (...) MPa, which gives way as c = 0 has it.

    From dc = 0 follows dp = -(dc/dH : dH) / (dc/dp): with n = (dc/dH) m and v = (dP/dp) m

        Q(m) -> Q(m) - v n^T / (dc/dp)

    Where dc/dp = 0 the law is incompressible, and a layer can only give way along a with n . a = 0.

    >>> from bezsoma.mechanics.hyperelastic import MooneyRivlin, NeoHooke
    >>> law = MooneyRivlin(c1=0.5, c2=0.2, kappa=5.0)
    >>> H = np.array([[0.3, 0.5, 0.0], [-0.2, 0.1, 0.4], [0.0, 0.3, -0.2]])[None]
    >>> p = -5.0 * (np.linalg.det(np.eye(3) + H) - 1)
    >>> bool(np.allclose(least_resistance_beside(law, H, p), least_resistance(law, H), rtol=1e-12))
    True

    Incompressible neo-Hooke resists by mu across n, at any strain without change of volume and at
    any pressure:

    >>> H = np.diag([1.44, 1 / 1.2, 1 / 1.2])[None] - np.eye(3)
    >>> found = least_resistance_beside(NeoHooke(E=3.0, nu=0.5), H, np.array([7.0]))
    >>> bool(abs(found[0] - 1.0) < 1e-12)
    True
    """
    least, none = np.full(H.shape[:-2], np.inf), np.zeros_like(p)
    of_p, along = law.mixed_derivative(H, p, np.zeros_like(H), np.ones_like(p))
    for m in layers():
        Q, n = np.empty(H.shape), np.empty(H.shape[:-1])
        for k in range(3):
            change, n[..., k] = law.mixed_derivative(H, p, _slip(k, m, H), none)
            Q[..., :, k] = change @ m
        if np.any(along):
            Q = Q - (of_p @ m)[..., :, None] * n[..., None, :] / along[..., None, None]
        both = (Q + np.swapaxes(Q, -1, -2)) / 2
        if not np.any(along):
            both = _across(both, n)
        least = np.minimum(least, _least_eigenvalue(both))
    return least


def _slip(k: int, m: Floats, H: Floats) -> Floats:
    """The change of H (..., 3, 3) where a layer of normal m (3,) gives way along axis k."""
    dH = np.zeros((3, 3))
    dH[k] = m
    return np.broadcast_to(dH, H.shape)


def _least_eigenvalue(Q: Floats) -> Floats:
    """That of Q (..., 3, 3); 0 where rounding decides or Q has left the range of numbers.

    An exponential makes Q so stiff along one axis that the sign of the least is that of an error:

    >>> n = np.array([1.0, 2.0, 3.0])
    >>> _least_eigenvalue(1e300 * np.outer(n, n) + np.eye(3)), _least_eigenvalue(-np.eye(3))
    (array(0.), array(-1.))
    """
    finite = np.isfinite(Q).all(axis=(-1, -2), keepdims=True)
    found = np.linalg.eigvalsh(np.where(finite, Q, 0.0))
    sure = np.abs(found[..., 0]) > ROUNDING * np.abs(found[..., 2])
    return np.where(sure, found[..., 0], 0.0)


def _across(Q: Floats, n: Floats) -> Floats:
    """Q (..., 3, 3) across n (..., 3), and along it more than across."""
    along = n[..., :, None] * n[..., None, :] / (n * n).sum(axis=-1)[..., None, None]
    across = np.eye(3) - along
    size = np.abs(Q).sum(axis=(-1, -2))[..., None, None]
    return np.asarray(across @ Q @ across + size * along)
