# SPDX-License-Identifier: BSD-3-Clause
"""The paper's third part: literal formulas, and figure 8 as a claim."""

from __future__ import annotations

import numpy as np
import pytest

import bezsoma as bz
from bezsoma.equations.pointwise import Pointwise
from bezsoma.mesh.control_net import ControlNet
from tolerances import CLOSED_FORM

E, NU, A = 0.02, 0.25, 5.0
VOIGT = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))


def strains(count: int = 20) -> np.ndarray:
    """Symmetric gradients, so that H is the strain."""
    H = np.random.default_rng(4).uniform(-0.2, 0.2, (count, 3, 3))
    return (H + np.swapaxes(H, 1, 2)) / 2


def literal(eps: np.ndarray, shears: str) -> np.ndarray:
    """E exp(A s^2) C_1 eps with six numbers, as printed (eqs. 22 to 24)."""
    six = np.array([eps[i, j] * (1 if i == j else 2) for i, j in VOIGT])
    off = 1.0 if shears == "engineering" else 0.5
    square = (six[:3] ** 2).sum() + 2 * ((off * six[3:]) ** 2).sum()
    tau = E * np.exp(A * square) * (bz.LinearElastic(1.0, NU).voigt @ six)
    full = np.zeros((3, 3))
    for value, (i, j) in zip(tau, VOIGT, strict=True):
        full[i, j] = full[j, i] = value
    return full


@pytest.mark.parametrize("shears", ["tensor", "engineering"])
def test_stress_of_the_stiffening_law(shears: str) -> None:
    """Eqs. 22, 23 and 24."""
    law = bz.Stiffening(E, NU, A, shears=shears)
    for eps in strains():
        assert np.abs(law.stress(eps) - literal(eps, shears)).max() < CLOSED_FORM * E


def test_tangent_is_the_corrected_one() -> None:
    """Ct = E(s) [C_1 + A (C_1 eps)(d s^2 / d eps)^T], d s^2 = 2 M eps: eqs. 47 and 48."""
    law, linear = bz.Stiffening(E, NU, A), bz.LinearElastic(1.0, NU)
    for eps, d in zip(strains(), strains(21)[1:], strict=True):
        grown = E * np.exp(A * (eps**2).sum())
        exact = grown * (linear.stress(d) + A * linear.stress(eps) * 2 * (eps * d).sum())
        assert np.abs(law.derivative(eps, d) - exact).max() < CLOSED_FORM * np.abs(exact).max()


def test_internal_forces_are_the_integral_and_not_the_tangent_times_u() -> None:
    """Eq. 45 holds; the third line of eq. 51, F = K U, does for the secant and no other K."""
    net, law = ControlNet(bz.block(), 2), bz.Stiffening(E, NU, A)
    u = 0.3 * np.sin(3 * net.points)
    points = Pointwise(net, (law,), 12)
    F = points.forces(u)
    from bezsoma.mechanics.laws import Secant

    by_secant = Pointwise(net, (Secant(law),), 12).tangent(u).apply(u)
    by_tangent = points.tangent(u).apply(u)
    assert np.abs(by_secant - F).max() < CLOSED_FORM * np.abs(F).max()
    assert np.abs(by_tangent - F).max() > 0.1 * np.abs(F).max()


def test_figure_8_stiffening_tissue_gives_way_less() -> None:
    """The same patch load: the linear block moves on in proportion, the stiffening one less so."""
    mesh = bz.block(cells=2)
    top = {}
    for name, law in (("linear", bz.LinearElastic(E, NU)), ("stiffening", bz.Stiffening(E, NU, A))):
        for load in (0.001, 0.006):
            pull = bz.Traction("top", value=(0, 0, load))
            found = bz.solve(bz.Body(mesh, 2, law, [bz.Fixed("bottom")], [pull]))
            top[name, load] = found.displacement.at(np.array([[0.5, 0.5, 1.0]]))[0, 2]
    assert abs(top["linear", 0.006] / top["linear", 0.001] - 6) < 1e-6
    assert 0.98 < top["stiffening", 0.001] / top["linear", 0.001] < 1
    assert 0.6 < top["stiffening", 0.006] / top["linear", 0.006] < 0.9
