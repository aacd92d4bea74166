# SPDX-License-Identifier: BSD-3-Clause
"""Laws at a point: stress from the displacement gradient, and how it changes in a direction.

A law is all that the nonlinear solver knows of a material. The internal force of every law, at
small or finite strain, is int P(H) : grad v over the undeformed body.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Protocol, runtime_checkable

import numpy as np

from bezsoma.arrays import Bools, Floats
from bezsoma.errors import InputError
from bezsoma.mechanics.compiled import bulk
from bezsoma.mechanics.law_checks import (
    refuse_other_energy,
    refuse_other_slope,
    stiffness_at_rest,
    strains,
)
from bezsoma.mechanics.materials import Material

Stress = Callable[[Floats], Floats]
Slope = Callable[[Floats, Floats], Floats]

COMPLEX_STEP = 1e-30
"""No difference is taken, so the step may be as small as squares of it do not show."""
DIFFERENCE = 6e-6
"""The cube root of rounding, which central differences like best."""


@runtime_checkable
class Law(Material, Protocol):
    """A material that is not linear: stress, its derivative, and its energy if it has one.

    `finite` says what the stress is: the first Piola-Kirchhoff stress P, F = I + H, of a law at
    finite strain; the stress tau, which is symmetric, of one at small strain.
    """

    @property
    def finite(self) -> bool:
        """Whether the strain is finite: stress is P and F = I + H, J = det F > 0."""
        ...

    def derivative(self, H: Floats, dH: Floats) -> Floats:
        """The change (..., 3, 3) MPa of the stress at H in the direction dH (paper, eq. 48)."""
        ...

    def energy(self, H: Floats) -> Floats:
        """The stored energy (...) N/mm2; tau : eps for a law that has none."""
        ...


@runtime_checkable
class MixedLaw(Law, Protocol):
    """A law that can go with a pressure of its own: P(H, p), and c(H, p), which has to vanish.

    c = - (J - 1) - p / kappa at finite strain, - tr eps - p / kappa at small strain.
    """

    def mixed_stress(self, H: Floats, p: Floats) -> tuple[Floats, Floats]:
        """P (..., 3, 3) MPa and c (...) at H (..., 3, 3) and p (...) MPa."""
        ...

    def mixed_derivative(
        self, H: Floats, p: Floats, dH: Floats, dp: Floats
    ) -> tuple[Floats, Floats]:
        """Their changes in the direction dH, dp."""
        ...

    def mixed_energy(self, H: Floats, p: Floats) -> Floats:
        """The stored energy (...) N/mm2: of the shape, and p^2 / (2 kappa)."""
        ...


@dataclass(frozen=True, init=False, eq=False)
class FunctionLaw:
    """A law of your own: functions over arrays H (..., 3, 3); MPa.

    It runs through the same solver as the laws of the core, ten to a hundred times slower.
    `derivative(H, dH)` is exact where you give it. Without it the complex step is taken,
    Im P(H + i h dH) / h, exact to rounding if the function is made of + - * /, powers, exp, log
    and `np.linalg.inv` or `det` (W. Squire and G. Trapp, SIAM Rev. 40, 1998,
    doi:10.1137/S003614459631241X), but not of abs, eigenvalues or max, which is refused;
    derivative="differences" takes central differences instead, right to some nine digits, with
    which Newton's last steps are not quadratic. `energy(H)`, if given, says that the stress is its
    derivative, so the tangent is symmetric; that is looked at in four states. At rest the stress
    has to resist every small strain: a law that gives way by itself is refused.

    With a `kappa` [MPa] the functions are those of the shape alone, and kappa/2 (J - 1)^2 is added
    (kappa/2 tr^2 at small strain): then the law can also go with a pressure, kappa = inf allowed.

    >>> law = FunctionLaw(lambda H: H + H**3, finite=False)
    >>> H, dH = np.full((3, 3), 0.5), np.eye(3)
    >>> bool(np.allclose(law.derivative(H, dH), dH * (1 + 3 * H**2), rtol=1e-15))
    True
    """

    function: Stress
    slope: Slope | str
    stored: Stress | None
    finite: bool = True
    kappa: float | None = None
    linear: bool = field(default=False)

    def __init__(
        self,
        stress: Stress,
        *,
        derivative: Slope | str = "complex step",
        energy: Stress | None = None,
        finite: bool = True,
        kappa: float | None = None,
    ) -> None:
        if not callable(stress) or not (energy is None or callable(energy)):
            raise InputError(
                "FunctionLaw(stress, energy=...) takes functions of H (..., 3, 3); "
                f"given were {stress!r} and {energy!r}"
            )
        if not callable(derivative) and derivative not in ("complex step", "differences"):
            raise InputError(
                f"derivative={derivative!r} of FunctionLaw is not known; give a function of "
                "(H, dH), 'complex step' or 'differences'"
            )
        if not isinstance(finite, bool):
            raise InputError(f"finite={finite!r} of FunctionLaw: it must be True or False")
        object.__setattr__(self, "function", stress)
        object.__setattr__(self, "slope", derivative)
        object.__setattr__(self, "stored", energy)
        object.__setattr__(self, "finite", finite)
        object.__setattr__(self, "kappa", None if kappa is None else bulk(kappa, "FunctionLaw"))
        object.__setattr__(self, "linear", False)
        _answers(self)

    @property
    def symmetric(self) -> bool:
        """Whether an energy was given."""
        return self.stored is not None

    def stress(self, H: Floats) -> Floats:
        """What the function says, (..., 3, 3) MPa, and the pressure of the volume."""
        shape = self.shape_stress(H)
        if self.kappa is None:
            return shape
        change, gradient = _volume(H, self.finite)
        return np.asarray(shape + self.kappa * change[..., None, None] * gradient)

    def derivative(self, H: Floats, dH: Floats) -> Floats:
        """The change of the stress in the direction dH, (..., 3, 3) MPa."""
        shape = self.shape_slope(H, dH)
        if self.kappa is None:
            return shape
        change, gradient = _volume(H, self.finite)
        along = np.einsum("...ij,...ij->...", gradient, dH)[..., None, None]
        turned = change[..., None, None] * _volume_slope(H, dH, self.finite)
        return np.asarray(shape + self.kappa * (along * gradient + turned))

    def energy(self, H: Floats) -> Floats:
        """The energy that was given and that of the volume, or stress : H, N/mm2."""
        if self.stored is None:
            return np.asarray(np.einsum("...ij,...ij->...", self.stress(H), H))
        stored = self.shape_energy(H)
        if self.kappa is None:
            return stored
        return np.asarray(stored + self.kappa / 2 * _volume(H, self.finite)[0] ** 2)

    def mixed_stress(self, H: Floats, p: Floats) -> tuple[Floats, Floats]:
        """P and c: see `MixedLaw`."""
        change, gradient = _volume(H, self.finite)
        shape = self.shape_stress(H)
        return shape - p[..., None, None] * gradient, -change - p / self._kappa

    def mixed_derivative(
        self, H: Floats, p: Floats, dH: Floats, dp: Floats
    ) -> tuple[Floats, Floats]:
        """The changes of P and c: see `MixedLaw`."""
        _, gradient = _volume(H, self.finite)
        bent = _volume_slope(H, dH, self.finite)
        dP = self.shape_slope(H, dH) - dp[..., None, None] * gradient - p[..., None, None] * bent
        return dP, -np.einsum("...ij,...ij->...", gradient, dH) - dp / self._kappa

    def mixed_energy(self, H: Floats, p: Floats) -> Floats:
        """The energy of the shape, or its stress : H, and p^2 / (2 kappa), N/mm2."""
        return np.asarray(self.shape_energy(H) + p**2 / (2 * self._kappa))

    @property
    def _kappa(self) -> float:
        assert self.kappa is not None  # Body refuses a law without it beside a pressure
        return self.kappa

    def shape_stress(self, H: Floats) -> Floats:
        """What the function says, without the volume's stress."""
        return self._asked("stress", self.function, H)

    def shape_energy(self, H: Floats) -> Floats:
        """The energy that was given, or the function's stress : H, without the volume's."""
        if self.stored is not None:
            return self._asked("energy", self.stored, H)
        return np.asarray(np.einsum("...ij,...ij->...", self.shape_stress(H), H))

    def shape_slope(self, H: Floats, dH: Floats) -> Floats:
        """The change of the function in the direction dH, without the volume's."""
        if callable(self.slope):
            return self._asked("derivative", self.slope, H, dH)
        stress = self.shape_stress
        if self.slope == "complex step":
            return np.asarray(stress(H + 1j * COMPLEX_STEP * dH).imag / COMPLEX_STEP)
        size = np.sqrt((dH**2).sum(axis=(-2, -1), keepdims=True))
        h = DIFFERENCE / np.where(size > 0, size, 1.0)
        return np.asarray((stress(H + h * dH) - stress(H - h * dH)) / (2 * h))

    def _asked(self, what: str, function: Callable[..., Floats], *arrays: Floats) -> Floats:
        """What a function of the user's answers, refused where it raises or is not as it must be.

        It may not write into its arguments: others read the same numbers after it.
        """
        H = np.broadcast_shapes(*(array.shape for array in arrays))
        each = {"energy": "number", "stress": "3 x 3 stress"}.get(what, "3 x 3 change of stress")
        shape = H[:-2] if what == "energy" else H
        try:
            found = np.asarray(function(*(_unwritable(array) for array in arrays)))
        except Exception as error:
            raise InputError(
                f"the {what} of FunctionLaw raises {type(error).__name__} ({error}) for H of shape "
                f"{H}; it must answer for arrays of any such shape and any H with det(I + H) > 0, "
                "and leave H as it is"
            ) from error
        if found.shape != shape:
            raise InputError(
                f"the {what} of FunctionLaw answers with shape {found.shape} for H of shape "
                f"{H}; it must give one {each} for each H, shape {shape}"
            )
        if found.dtype.kind not in ("iufc" if any(map(np.iscomplexobj, arrays)) else "iuf"):
            raise InputError(
                f"the {what} of FunctionLaw answers with numbers of type {found.dtype} for H of "
                f"type {arrays[0].dtype}; real H must give real numbers"
            )
        return found


def _unwritable(array: Floats) -> Floats:
    """The same numbers, not to be written."""
    view = array.view()
    view.flags.writeable = False
    return view


def _volume(H: Floats, finite: bool) -> tuple[Floats, Floats]:
    """The change of volume J - 1, or tr eps, and its derivative by H."""
    if not finite:
        return np.trace(H, axis1=-2, axis2=-1), np.broadcast_to(np.eye(3), H.shape)
    F = np.eye(3) + H
    return np.linalg.det(F) - 1, _cofactor(F)


def _volume_slope(H: Floats, dH: Floats, finite: bool) -> Floats:
    """The change of that derivative in the direction dH."""
    if not finite:
        return np.zeros(np.broadcast_shapes(H.shape, dH.shape))
    F, D = np.broadcast_arrays(np.eye(3) + H, dH)
    columns = [np.cross(D[..., j], F[..., k]) + np.cross(F[..., j], D[..., k]) for j, k in _CYCLIC]
    return np.stack(columns, axis=-1)


_CYCLIC = ((1, 2), (2, 0), (0, 1))


def _cofactor(F: Floats) -> Floats:
    """J F^-T of F (..., 3, 3), the products of its columns."""
    return np.stack([np.cross(F[..., j], F[..., k]) for j, k in _CYCLIC], axis=-1)


@dataclass(frozen=True)
class Secant:
    """A law whose derivative is replaced by its secant, C(H) with stress = C(H) H (paper, eq. 51).

    For laws that have one: tau = E(s) C_1 eps changes to E(s) C_1 d eps, as if E stayed.
    """

    law: Law

    def __post_init__(self) -> None:
        if not (self.law.linear or hasattr(self.law, "secant")):
            raise InputError(
                f"method='secant': {self.law!r} has no secant; it is for the stiffening laws "
                "tau = E(s) C eps (paper, eq. 51). Take method='newton'"
            )

    @property
    def finite(self) -> bool:
        """As the law's."""
        return self.law.finite

    @property
    def linear(self) -> bool:
        """As the law's."""
        return self.law.linear

    @property
    def symmetric(self) -> bool:
        """True: the secant of an isotropic law is."""
        return True

    def stress(self, H: Floats) -> Floats:
        """The law's stress."""
        return self.law.stress(H)

    def derivative(self, H: Floats, dH: Floats) -> Floats:
        """The secant at H times dH."""
        secant: Slope = getattr(self.law, "secant", self.law.derivative)
        return secant(H, dH)

    def energy(self, H: Floats) -> Floats:
        """The law's energy."""
        return self.law.energy(H)


def _answers(law: FunctionLaw) -> None:
    """Refuses a function that does not answer with stress at rest, or cannot be differentiated.

    Also one that does not resist strain there, and a derivative or an energy that is another's.
    """
    rest = np.zeros((2, 3, 3))
    law.shape_stress(rest)  # not with that of the volume: kappa may be infinite
    try:
        slope = law.shape_slope(rest, np.tile(np.diag([1.0, 0.5, 0.2]), (2, 1, 1)))
    except InputError as error:
        if callable(law.slope):
            raise
        raise InputError(
            f"the derivative of FunctionLaw cannot be taken ({error.__cause__ or error}); give "
            "derivative=a function of (H, dH), or 'differences'"
        ) from error
    law.shape_energy(rest)  # whether it answers at all
    if not (np.isfinite(slope).all() and np.any(slope)):
        raise InputError(
            "the derivative of FunctionLaw at rest is zero or not finite: a complex step needs a "
            "function that works with complex numbers; give derivative=... or 'differences'"
        )
    modulus = stiffness_at_rest(law.shape_slope, volume=law.kappa is None)
    refuse_other_slope(law.shape_stress, law.shape_slope, modulus)
    if law.stored is not None:
        refuse_other_energy(law.shape_stress, law.shape_energy, modulus)


def nearest_isotropic(law: Law, H: Floats) -> tuple[Floats, Floats]:
    """The moduli kappa and mu [MPa] (t,) of the isotropic law near the tangent at H (t, 3, 3).

    The nearest, with the same C_iijj = 9 kappa and C_ijij = 3 kappa + 10 mu: what a preconditioner
    needs.

    >>> from bezsoma.mechanics.materials import LinearElastic
    >>> [x.round(12).tolist() for x in nearest_isotropic(LinearElastic(2.5, 0.25), np.eye(3)[None])]
    [[1.666666666667], [1.0]]
    """
    basis = [np.broadcast_to(strain, H.shape) for strain in strains()]
    moduli = [np.einsum("tkl,tkl->t", dH, law.derivative(H, dH)) for dH in basis]
    return moduli[0] / 3, np.sum(moduli[1:], axis=0) / 10


def folds(law: Material, H: Floats) -> Bools:
    """Where in H (..., 3, 3) tissue is turned inside out, J = det(I + H) <= 0, (...).

    There a law at finite strain says nothing; laws at small strain have no such place.

    >>> from bezsoma.mechanics.hyperelastic import NeoHooke
    >>> H = np.stack([np.diag([-0.5, 0, 0]), np.diag([-1.5, 0, 0])])
    >>> folds(NeoHooke(E=1.0, nu=0.25), H).tolist()
    [False, True]
    """
    if not (isinstance(law, Law) and law.finite):
        return np.zeros(H.shape[:-2], bool)
    return np.asarray(np.linalg.det(np.eye(3) + H) <= 0)


def at_rest(law: Law) -> tuple[float, float]:
    """Lame's lambda and mu (MPa) of the linear law that a law is near rest.

    Of an anisotropic law, those of the nearest isotropic one.

    >>> from bezsoma.mechanics.materials import LinearElastic
    >>> [round(modulus, 12) for modulus in at_rest(LinearElastic(E=2.5, nu=0.25))]
    [1.0, 1.0]
    """
    (kappa,), (mu,) = nearest_isotropic(law, np.zeros((1, 3, 3)))
    return float(kappa - 2 * mu / 3), float(mu)


def shear_at_rest(law: MixedLaw) -> float:
    """The shear modulus [MPa] of a law beside a pressure, near rest: the mean over three shears.

    >>> law = FunctionLaw(lambda H: H + np.swapaxes(H, -1, -2), finite=False, kappa=np.inf)
    >>> round(shear_at_rest(law), 12)
    1.0
    """
    H, p, moduli = np.zeros((3, 3)), np.zeros(()), []
    for i, j in ((0, 1), (1, 2), (2, 0)):
        shear = np.zeros((3, 3))
        shear[i, j] = shear[j, i] = 0.5
        moduli.append(law.mixed_derivative(H, p, shear, p)[0][i, j])
    return float(np.mean(moduli))
