# SPDX-License-Identifier: BSD-3-Clause
"""Linear elasticity at a point: the law, its moduli, and what it may not depend on.

The law is eqs. 4, 5 and 6 of the paper, its moduli eqs. 10 and 11.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from bezsoma.mechanics import LinearElastic, Material
from tolerances import ROUNDING

RATIOS = [-0.9, 0.0, 0.25, 0.45, 0.4999]


@pytest.fixture
def H() -> np.ndarray:
    return np.random.default_rng(1).normal(size=(7, 3, 3))


def six(tensor: np.ndarray, shear: float) -> np.ndarray:
    """The paper's order XX YY ZZ XY YZ ZX."""
    t = tensor
    return np.array([t[0, 0], t[1, 1], t[2, 2], shear * t[0, 1], shear * t[1, 2], shear * t[2, 0]])


def printed(E: float, nu: float) -> np.ndarray:
    """The matrix of eq. 6 as it is printed, a common factor before the bracket."""
    C = np.zeros((6, 6))
    C[:3, :3] = nu
    C[range(3), range(3)] = 1 - nu
    C[range(3, 6), range(3, 6)] = (1 - 2 * nu) / 2
    return E / ((1 + nu) * (1 - 2 * nu)) * C


@pytest.mark.parametrize("nu", RATIOS)
def test_the_stress_is_that_of_equation_6(H: np.ndarray, nu: float) -> None:
    law = LinearElastic(E=0.015, nu=nu)
    assert np.allclose(law.voigt, printed(0.015, nu), rtol=1e-10, atol=1e-18)
    for gradient, stress in zip(H, law.stress(H), strict=True):
        strain = (gradient + gradient.T) / 2
        expected = printed(0.015, nu) @ six(strain, 2)
        assert np.allclose(six(stress, 1), expected, rtol=0, atol=1e-10 * abs(expected).max())


def test_pulling_a_bar_gives_young_and_poisson_back() -> None:
    """Uniaxial stress s: the strain is s/E along and -nu s/E across."""
    strain = np.diag([1.0, -0.3, -0.3]) / 2.0
    stress = LinearElastic(E=2.0, nu=0.3).stress(strain)
    assert np.allclose(stress, np.diag([1.0, 0, 0]), atol=1e-15)


def test_simple_shear_meets_the_shear_modulus_once() -> None:
    """tau_xy = G gamma, not 2 G gamma (see the errata)."""
    law = LinearElastic.from_shear_bulk(G=3.0, kappa=5.0)
    shear = np.zeros((3, 3))
    shear[0, 1] = 0.1
    assert law.stress(shear)[0, 1] == pytest.approx(0.3, rel=1e-15)


def test_even_pressure_meets_the_bulk_modulus() -> None:
    law = LinearElastic.from_shear_bulk(G=3.0, kappa=5.0)
    assert np.allclose(law.stress(-0.1 * np.eye(3)), -3 * 5.0 * 0.1 * np.eye(3), rtol=1e-15)


@pytest.mark.parametrize("nu", RATIOS)
def test_the_moduli_turn_into_each_other(nu: float) -> None:
    law = LinearElastic(E=0.7, nu=nu)
    back = LinearElastic.from_shear_bulk(law.mu, law.kappa)
    assert back.E == pytest.approx(law.E, rel=1e-12)
    assert back.nu == pytest.approx(law.nu, abs=1e-12)
    assert law.lam + 2 * law.mu / 3 == pytest.approx(law.kappa, rel=1e-12)
    assert law.mu == pytest.approx(law.E * (0.5 - nu) / ((1 + nu) * (1 - 2 * nu)), rel=1e-12)


def test_a_turned_frame_turns_the_stress(H: np.ndarray) -> None:
    law = LinearElastic(E=1.0, nu=0.45)
    Q = Rotation.from_rotvec([0.3, -1.2, 0.7]).as_matrix()
    turned = law.stress(Q @ H @ Q.T)
    assert np.allclose(turned, Q @ law.stress(H) @ Q.T, rtol=0, atol=ROUNDING * 1e2)


def test_a_spin_gives_no_stress_and_stress_is_symmetric(H: np.ndarray) -> None:
    law = LinearElastic(E=1.0, nu=0.3)
    assert np.abs(law.stress(H - np.swapaxes(H, 1, 2))).max() == 0
    assert np.array_equal(law.stress(H), np.swapaxes(law.stress(H), 1, 2))


@pytest.mark.parametrize("nu", RATIOS)
def test_any_strain_costs_energy_and_the_law_has_a_symmetric_form(nu: float) -> None:
    C = LinearElastic(E=1.0, nu=nu).voigt
    assert np.array_equal(C, C.T)
    assert np.linalg.eigvalsh(C).min() > 0


def test_the_protocol_of_materials_is_met() -> None:
    law = LinearElastic(E=1, nu=0)
    assert isinstance(law, Material)
    assert law.linear
    assert law.symmetric
    assert (law.E, law.lam) == (1.0, 0.0)
    assert LinearElastic(np.float32(2), np.int64(0)) == LinearElastic(2.0, 0.0)
