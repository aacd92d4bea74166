# SPDX-License-Identifier: BSD-3-Clause
"""The linear law that each tet is near at a state: what a preconditioner is built from."""

from __future__ import annotations

import numpy as np

from bezsoma.arrays import Floats
from bezsoma.equations.pointwise import Pointwise
from bezsoma.mechanics.laws import Law, at_rest, nearest_isotropic

SOFTEST = 0.1
"""A preconditioner has to stay positive: no modulus below this part of what it is at rest."""
STIFFEST = 1e6
"""Its blocks are float32 and have to hold numbers where an exponential all but overflows: no
modulus above so many times what it is at rest."""


def moduli_at(pointwise: Pointwise, u: Floats) -> Floats:
    """Lame's lambda and mu [MPa] (t, 2) of each tet at u (c, 3) mm, from the middle of it.

    Those of the isotropic law nearest to the tangent (`nearest_isotropic`). What turns a tet does
    not show in them.

    >>> from bezsoma.mechanics.stiffening import Stiffening
    >>> from bezsoma.mesh.control_net import ControlNet
    >>> from bezsoma.mesh.solids import block
    >>> net, law = ControlNet(block(), 2), Stiffening(2.5, 0.25, 5.0, "deviatoric")
    >>> moduli_at(Pointwise(net, [law], 6), 0 * net.points).round(12)[0].tolist()
    [1.0, 1.0]
    >>> stretched = moduli_at(Pointwise(net, [law], 6), net.points * [0.4, -0.2, -0.2])
    >>> bool(stretched[0, 1] > np.exp(5 * 0.24)) # exp(A s^2) is the secant, and less
    True
    """
    middle = Pointwise(pointwise.net, pointwise.laws, 1, once=True)
    found = np.empty((len(pointwise.net.mesh.tets), 2))
    for law, tets in middle.runs():
        H = middle.gradients(u, tets)[:, 0]
        found[tets] = _near(law, _unturned(H) if law.finite else H)
    return found


def _near(law: Law, H: Floats) -> Floats:
    """Lambda and mu (t, 2) at H (t, 3, 3), kept positive."""
    with np.errstate(all="ignore"):
        kappa, mu = nearest_isotropic(law, H)
    lam, rest = at_rest(law)
    mu = np.clip(np.where(np.isfinite(mu), mu, rest), SOFTEST * rest, STIFFEST * rest)
    bulk = lam + 2 * rest / 3
    kappa = np.clip(np.where(np.isfinite(kappa), kappa, bulk), SOFTEST * bulk, STIFFEST * bulk)
    return np.stack([kappa - 2 * mu / 3, mu], axis=1)


def _unturned(H: Floats) -> Floats:
    """U - I of F = I + H = R U (t, 3, 3)."""
    F = np.eye(3) + H
    squares, axes = np.linalg.eigh(np.swapaxes(F, 1, 2) @ F)
    stretches = np.sqrt(np.maximum(squares, 0.0))
    return np.asarray((axes * stretches[:, None]) @ np.swapaxes(axes, 1, 2) - np.eye(3))
