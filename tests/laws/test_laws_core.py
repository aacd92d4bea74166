# SPDX-License-Identifier: BSD-3-Clause
"""The laws of the core: against plain twins, their own energies, frames and limits."""

from __future__ import annotations

import numpy as np
import pytest

from bezsoma import _core
from bezsoma.arrays import Floats
from laws import plain_energies as plain
from tolerances import ROUNDING

SETS = _core.instruction_sets()
LAWS = _core.law_names()
FINITE = tuple(n for n in LAWS if _core.Law(n, plain.PARAMETERS[n]).finite)
WITH_ENERGY = tuple(plain.ENERGIES)
SPLIT = tuple(n for n in LAWS if _core.Law(n, plain.PARAMETERS[n]).splits)
COMPLEX_STEP = 1e-11
"""Stress of a twin by complex steps: its eigenvalues or determinants lose a digit or two."""
DIFFERENCES = 1e-8
"""Central differences with a step of 1e-4 and one extrapolation."""


def law(name: str, instructions: str = "") -> _core.Law:
    return _core.Law(name, plain.PARAMETERS[name], instructions)


def states(count: int = 40, size: float = 0.12, seed: int = 3) -> Floats:
    """Displacement gradients (n, 3, 3) of strains of some tens of percent, and turned."""
    H = np.random.default_rng(seed).standard_normal((count, 3, 3)) * size
    return np.asarray(rotations(count) @ (np.eye(3) + H) - np.eye(3))


def gentle(count: int = 40) -> Floats:
    """For laws at small strain: not turned."""
    return np.random.default_rng(4).standard_normal((count, 3, 3)) * 0.12


def states_of(name: str) -> Floats:
    return states() if name in FINITE else gentle()


def rotations(count: int) -> Floats:
    Q = np.linalg.qr(np.random.default_rng(8).standard_normal((count, 3, 3)))[0]
    return np.asarray(Q * np.sign(np.linalg.det(Q))[:, None, None])


def apart(found: Floats, expected: Floats) -> float:
    return float(np.abs(found - expected).max() / np.abs(expected).max())


@pytest.mark.parametrize("instructions", SETS)
@pytest.mark.parametrize("name", LAWS)
def test_stress_is_what_its_twin_says(name: str, instructions: str) -> None:
    H = states_of(name)
    for some in (H, H[:1], 1e-5 * H):
        if name == "ogden" and len(some) > 1 and np.abs(some).max() < 1e-3:
            continue  # the twin's eigenvalues of nearly equal stretches are worse than the law's
        found = law(name, instructions).stress(some)
        assert apart(found, plain.stress(name, some)) < COMPLEX_STEP


@pytest.mark.parametrize("name", WITH_ENERGY)
def test_energy_is_what_its_twin_says(name: str) -> None:
    H = states_of(name)
    assert apart(law(name).energy(H), plain.ENERGIES[name].energy(H).real) < ROUNDING * 10


@pytest.mark.parametrize("instructions", SETS)
@pytest.mark.parametrize("name", LAWS)
def test_the_derivative_is_that_of_the_stress(name: str, instructions: str) -> None:
    H, dH = states_of(name), np.random.default_rng(9).standard_normal((40, 3, 3))
    one = law(name, instructions)

    def slope(h: float) -> Floats:
        return np.asarray((one.stress(H + h * dH) - one.stress(H - h * dH)) / (2 * h))

    h = 1e-4
    if "mean" in name:  # stay on one side of the kinks
        keep = np.abs(H + np.swapaxes(H, 1, 2)).min(axis=(1, 2)) > 4 * h * np.abs(dH).max()
        H, dH = H[keep], dH[keep]
    found = one.derivative(H, dH)
    assert apart(found, (4 * slope(h / 2) - slope(h)) / 3) < DIFFERENCES


@pytest.mark.parametrize("name", LAWS)
def test_the_derivative_is_symmetric_where_there_is_an_energy(name: str) -> None:
    H = states_of(name)
    a, b = np.random.default_rng(2).standard_normal((2, len(H), 3, 3))
    one = law(name)
    ab, ba = plain.dot(b, one.derivative(H, a)), plain.dot(a, one.derivative(H, b))
    lack = float(np.abs(ab - ba).max() / np.abs(ab).max())
    assert (lack < ROUNDING) == one.has_energy


@pytest.mark.parametrize("name", SPLIT)
def test_the_mixed_form_is_the_same_law(name: str) -> None:
    """With p = -kappa (J - 1) or its like, P is that of the displacement form and c vanishes."""
    H = states_of(name)
    one, p = law(name), np.zeros(len(H))
    _, c = one.mixed_stress(H, p)
    _, slope = one.mixed_derivative(H, p, np.zeros_like(H), np.ones(len(H)))
    p = -c / slope
    P, c = one.mixed_stress(H, p)
    assert np.abs(c).max() < ROUNDING
    assert apart(P, one.stress(H)) < ROUNDING


@pytest.mark.parametrize("name", SPLIT)
def test_the_mixed_derivative(name: str) -> None:
    rng, H, h = np.random.default_rng(6), states_of(name), 1e-5
    dH, p, dp = rng.standard_normal(H.shape), rng.standard_normal(len(H)), rng.standard_normal(40)
    one = law(name)
    more, less = one.mixed_stress(H + h * dH, p + h * dp), one.mixed_stress(H - h * dH, p - h * dp)
    for a, b, found in zip(more, less, one.mixed_derivative(H, p, dH, dp), strict=True):
        assert apart(found, (a - b) / (2 * h)) < 1e-7
    if one.has_energy:
        P, c = one.mixed_stress(H, p)
        W = one.mixed_energy(H + h * dH, p + h * dp) - one.mixed_energy(H - h * dH, p - h * dp)
        assert apart(W / (2 * h), plain.dot(P, dH) + c * dp) < 1e-7


@pytest.mark.parametrize("name", LAWS)
def test_at_rest_it_is_the_linear_law(name: str) -> None:
    """No stress at rest, exactly; the derivative there is kappa and mu (Guccione: no one mu)."""
    one, e = law(name), plain.strain(gentle())
    zero = np.zeros_like(e)
    assert not one.stress(zero).any()
    found = one.derivative(zero, e)
    mu = {"mooney_rivlin": 1.0, "ogden": 0.5 + 0.45 + 0.09, "veronda_westmann": 0.36}
    if name != "guccione":
        tau = 2 * mu.get(name, plain.MU) * plain.deviator(e)
        tau += plain.KAPPA * plain.trace(e)[:, None, None] * np.eye(3)
        assert apart(found, tau) < ROUNDING
    if one.finite:
        spin = gentle() - np.swapaxes(gentle(), 1, 2)
        assert np.abs(one.derivative(zero, spin)).max() < ROUNDING


@pytest.mark.parametrize("name", FINITE)
def test_a_turn_turns_the_stress(name: str) -> None:
    """P(Q F) = Q P(F) for 100 rotations Q: the observer does not matter."""
    F = np.eye(3) + gentle(100)
    Q, one = rotations(100), law(name)
    P = one.stress(F - np.eye(3))
    assert apart(one.stress(Q @ F - np.eye(3)), Q @ P) < ROUNDING * 10
    if name != "guccione":  # isotropic: nor does the frame of the material
        assert apart(one.stress(F @ Q - np.eye(3)), P @ Q) < ROUNDING * 10


@pytest.mark.parametrize("name", [n for n in LAWS if n not in FINITE])
def test_which_measures_of_strain_are_invariant(name: str) -> None:
    """tau(Q H Q^T) = Q tau Q^T for 100 rotations; the mean and the literal eq. 24 fail it."""
    H, Q, one = gentle(100), rotations(100), law(name)
    T = np.swapaxes(Q, 1, 2)
    lack = apart(one.stress(Q @ H @ T), Q @ one.stress(H) @ T)
    if "mean" in name or "engineering" in name:
        assert lack > 1e-3
    else:
        assert lack < ROUNDING


def test_the_erratum_of_equation_24() -> None:
    """Uniaxial stress, axial strain 0.2, nu = 1/4, turned by 45 degrees: E/E0 1.25 becomes 2.00."""
    E, nu, A = 1.0, 0.25, 5.0
    parameters = [E / (3 * (1 - 2 * nu)), E / (2 * (1 + nu)), A]
    H = np.diag([0.2, -0.05, -0.05])[None]
    r = np.sqrt(0.5)
    Q = np.array([[r, -r, 0], [r, r, 0], [0, 0, 1]])
    for name, turned in (
        ("stiffening_frobenius", 1.252),
        ("stiffening_frobenius_engineering", 2.0),
    ):
        one = _core.Law(name, parameters)
        assert one.stress(H)[0, 0, 0] / 0.2 == pytest.approx(1.252, abs=1e-3)
        back = Q.T @ one.stress(Q @ H @ Q.T)[0] @ Q
        assert back[0, 0] / 0.2 == pytest.approx(turned, abs=1e-2)


@pytest.mark.parametrize("gap", [0.0, 1e-12, 1e-8, 1e-4, 0.03, 0.06, 0.2])
def test_ogden_where_stretches_coincide(gap: float) -> None:
    """alpha = 2 alone is neo-Hooke: also where two or three stretches are equal or nearly so."""
    one, other = _core.Law("ogden", [3.0, 0.7, 2.0]), law("neo_hooke_isochoric")
    Q, dH = rotations(20), np.random.default_rng(1).standard_normal((20, 3, 3))
    for stretches in ([1.3, 1.3 + gap, 0.8], [1.1, 1.1 + gap, 1.1 - gap]):
        F = Q @ np.diag(stretches) @ np.swapaxes(Q, 1, 2)[::-1]
        H = F - np.eye(3)
        assert apart(one.stress(H), other.stress(H)) < 1e-12
        assert apart(one.derivative(H, dH), other.derivative(H, dH)) < 1e-12


def test_exponential_and_logarithm_to_the_last_digits() -> None:
    """Through laws of one entry: exp over its whole range, ln J from 1e-3 to 1e3.

    5 s^2 is exact for these s: what is seen is the exponential, not its argument's rounding.
    """
    s = np.arange(1, 11.8 * 256) / 256
    H = np.zeros((len(s), 3, 3))
    H[:, 0, 1] = 2 * s
    tau = _core.Law("stiffening_deviatoric", [1.0, 0.5, 2.5]).stress(H)[:, 0, 1]
    assert np.abs(tau / (s * np.exp(5 * s**2)) - 1).max() < 1e-15
    H = np.zeros((4000, 3, 3))
    H[:, 0, 0] = x = np.geomspace(1e-3, 1e3, 4000) - 1
    P = _core.Law("neo_hooke", [1.0, 0.0]).stress(H)[:, 0, 0]
    assert np.abs(P * (1 + x) / np.log1p(x) - 1).max() < 1e-14


def test_what_a_law_cannot_bear_is_said() -> None:
    H = np.zeros((3, 3, 3))
    H[2, 0, 0] = -1.5
    with pytest.raises(ValueError, match=r"J = -0.5.* in row 2"):
        law("neo_hooke").stress(H)
    H[2] = np.diag([20.0, 0, 0])
    with pytest.raises(ValueError, match=r"exp\(2000.* in row 2"):
        law("stiffening_frobenius").stress(H)
    with pytest.raises(ValueError, match="no energy"):
        law("stiffening_mean").energy(H)
    with pytest.raises(ValueError, match="mixed form"):
        _core.Law("linear", [np.inf, 1.0]).stress(H)
    with pytest.raises(ValueError, match="does not split"):
        law("st_venant_kirchhoff").mixed_stress(H, np.zeros(3))
    with pytest.raises(ValueError, match="no law 'rubber'"):
        _core.Law("rubber", [1.0])
    with pytest.raises(ValueError, match="3 parameters, kappa first, not 4"):
        _core.Law("ogden", [1.0, 0.5, 2.0, 1.0])
