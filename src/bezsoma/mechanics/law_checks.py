# SPDX-License-Identifier: BSD-3-Clause
"""What a law of the user's own is asked before it is believed."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from bezsoma.arrays import Floats
from bezsoma.errors import InputError

LEAST = 1e-12
"""A modulus below this part of the largest is none but rounding."""
STEP = 1e-5
APART, FLOOR = 1e-3, 1e-4
"""How far stress and the slope of energy may be apart, of the stress there and of the modulus at
rest: differences of a law with a kink are right to some `STEP`, wrong factors are not so near."""

_STRAINED = np.array([[0.03, -0.02, 0.01], [0.04, 0.05, -0.03], [0.02, 0.01, -0.06]])
_WAYS = np.array(
    [
        [[0.5, 0.0, 0.0], [0.0, 0.7, 0.0], [0.0, 0.0, -0.4]],
        [[0.0, 0.8, 0.0], [0.3, 0.0, 0.5], [0.0, 0.5, 0.0]],
        [[0.2, 0.1, -0.4], [0.3, -0.6, 0.2], [0.5, 0.1, 0.3]],
    ]
)
"""A state, and directions in which energy and stress are looked at."""


def strains() -> Floats:
    """An orthonormal basis (6, 3, 3) of the symmetric H: the change of volume, five of shape."""
    basis = np.zeros((6, 3, 3))
    basis[0] = np.eye(3) / np.sqrt(3)
    basis[1] = np.diag([1, -1, 0]) / np.sqrt(2)
    basis[2] = np.diag([1, 1, -2]) / np.sqrt(6)
    for row, (k, l) in enumerate(((0, 1), (1, 2), (2, 0)), start=3):
        basis[row, k, l] = basis[row, l, k] = 1 / np.sqrt(2)
    return basis


def stiffness_at_rest(slope: Callable[[Floats, Floats], Floats], volume: bool) -> float:
    """The largest modulus [MPa] at rest, H = 0; refuses a law that does not resist every strain.

    Or every change of shape alone, where the volume has a law of its own. The modulus for a strain
    e of norm one is e : C : e.

    >>> round(stiffness_at_rest(lambda H, dH: 2 * dH, volume=True), 12)
    2.0
    """
    basis = strains() if volume else strains()[1:]
    C = np.einsum("akl,bkl->ab", basis, slope(np.zeros_like(basis), basis))
    moduli, directions = np.linalg.eigh((C + C.T) / 2)
    largest = float(np.abs(moduli).max())
    if moduli[0] > LEAST * largest:
        return largest
    worst = np.einsum("a,akl->kl", directions[:, 0], basis)
    raise InputError(
        f"FunctionLaw does not resist the small strain {_told(worst)} at rest: its modulus there "
        f"is {moduli[0]:.3g} MPa, the largest of all {largest:.3g}, so that a body of it gives way "
        "by itself; the stress has to grow with "
        + ("every small strain" if volume else "every small change of shape, apart from kappa")
        + ": look at its sign, and for a part that is missing"
    )


def refuse_other_energy(
    stress: Callable[[Floats], Floats], energy: Callable[[Floats], Floats], modulus: float
) -> None:
    """Refuses an energy of which the stress is not the derivative, at rest and three states more.

    >>> refuse_other_energy(lambda H: H, lambda H: (H**2).sum(axis=(-2, -1)), modulus=1.0)
    Traceback (most recent call last):
        ...
    bezsoma.errors.InputError: the stress of FunctionLaw is not the derivative of its energy: ...
    """
    states = np.zeros((4, 1, 3, 3))
    states[1, 0] = np.diag([0.1, -0.04, -0.02])
    states[2, 0, 0, 1], states[2, 0, 1, 0] = 0.08, 0.02
    states[3, 0] = _STRAINED
    H, dH = np.broadcast_arrays(states, _WAYS)
    with np.errstate(all="ignore"):
        P = stress(H)
        found = (energy(H + STEP * dH) - energy(H - STEP * dH)) / (2 * STEP)
        wanted = np.einsum("swkl,swkl->sw", P, dH)
        apart = np.abs(found - wanted)
        bound = APART * np.abs(P).max(axis=(-2, -1)) + FLOOR * modulus
    wrong = np.argwhere(np.isfinite(apart) & (apart > bound))  # an exponential may overflow here
    if len(wrong):
        s, w = wrong[0]
        raise InputError(
            "the stress of FunctionLaw is not the derivative of its energy: at H = "
            f"{_told(H[s, w])} the energy changes by {found[s, w]:.4g} N/mm2 along "
            f"{_told(dH[s, w])}, and the stress does {wanted[s, w]:.4g}; mend one of them, or "
            "leave energy= out, and the tangent is not taken for symmetric"
        )


def refuse_other_slope(
    stress: Callable[[Floats], Floats], slope: Callable[[Floats, Floats], Floats], modulus: float
) -> None:
    """Refuses a derivative that is not the one of the stress, in two states and three directions.

    Both are strained all round and a little: nothing has a kink there, and what may give way has
    not yet. A complex step knows nothing of an absolute value:

    >>> law = lambda H: H * (1 + abs(H))
    >>> refuse_other_slope(law, lambda H, dH: law(H + 1e-30j * dH).imag / 1e-30, modulus=1.0)
    Traceback (most recent call last):
        ...
    bezsoma.errors.InputError: the derivative of FunctionLaw is not that of its stress: ...
    """
    H, dH = np.broadcast_arrays(np.array([0.5, -0.5])[:, None, None, None] * _STRAINED, _WAYS)
    with np.errstate(all="ignore"):
        found = slope(H, dH)
        wanted = (stress(H + STEP * dH) - stress(H - STEP * dH)) / (2 * STEP)
        apart = np.abs(found - wanted).max(axis=(-2, -1))
        bound = APART * np.abs(wanted).max(axis=(-2, -1)) + FLOOR * modulus
    wrong = np.argwhere(np.isfinite(apart) & (apart > bound))
    if len(wrong):
        s, w = wrong[0]
        raise InputError(
            f"the derivative of FunctionLaw is not that of its stress: at H = {_told(H[s, w])} "
            f"along {_told(dH[s, w])} it is {_told(found[s, w])} MPa, and the stress changes by "
            f"{_told(wanted[s, w])}; mend one of them (a complex step is right without abs, max "
            "and eigenvalues only), or take derivative='differences'"
        )


def _told(H: Floats) -> str:
    return str(np.round(H, 3).tolist())
