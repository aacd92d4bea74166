# SPDX-License-Identifier: BSD-3-Clause
"""Manufactured solutions of laws that are not linear: errors fall at the rates k + 1 and k."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

import bezsoma as bz
from bezsoma.mechanics.laws import Law
from convergence.waves import (
    PHASE,
    SIZE,
    WAVE,
    Floats,
    Waves,
    held_and_loaded,
    irregular,
    regular,
    times,
)
from tolerances import RATE_SLACK

CELLS = {1: (8, 12), 2: (2, 4), 3: (2, 3), 4: (2, 3), 5: (1, 2)}
"""Meshes so coarse that all take seconds, and so fine that the rate is that of the limit."""
SCALE = 0.08
"""Of the waves, whose gradients then reach 0.27: far beyond what small strain would forgive."""
LAW = bz.NeoHooke(E=1.0, nu=0.3)


@dataclass(frozen=True)
class FiniteWaves:
    """The plane waves of `Waves`, scaled, and the loads that a law needs to bear them."""

    law: Law

    def displacement(self, x: Floats) -> Floats:
        """U (p, 3)."""
        return SCALE * Waves(1.0, 0.3).displacement(x)

    def gradient(self, x: Floats) -> Floats:
        """H (p, 3, 3)."""
        return SCALE * Waves(1.0, 0.3).gradient(x)

    def stress(self, x: Floats) -> Floats:
        """P (p, 3, 3)."""
        return self.law.stress(self.gradient(x))

    def body_force(self, x: Floats) -> Floats:
        """- div P (p, 3): the law's derivative in the direction dH/dx_j, column j of it."""
        second = -SCALE * SIZE * np.sin(times(x, WAVE.T) + PHASE)
        H, force = self.gradient(x), np.zeros((len(x), 3))
        for j in range(3):
            dH = (second * WAVE[:, j])[:, :, None] * WAVE
            force -= self.law.derivative(H, dH)[:, :, j]
        return force


def errors(mesh: bz.TetMesh, normals: Floats, degree: int, law: Law) -> Floats:
    """The L2 and H1 errors: every other plane held, exact dead tractions elsewhere."""
    waves, fine = FiniteWaves(law), 2 * degree + 5
    supports, loads = held_and_loaded(waves, normals, fine)
    body = bz.Body(mesh, degree, law, supports, loads)
    u = bz.solve(body, exactness=fine).displacement
    return np.array([u.l2_error(waves.displacement, fine), u.h1_error(waves.gradient, fine)])


def test_body_force_balances_the_stress() -> None:
    """By central differences of step h, right to some 1e-7 here."""
    waves, h = FiniteWaves(LAW), 1e-4
    x = np.random.default_rng(0).uniform(-1, 1, (20, 3))
    divergence = sum(
        (waves.stress(x + e)[:, :, j] - waves.stress(x - e)[:, :, j]) / (2 * h)
        for j, e in enumerate(h * np.eye(3))
    )
    assert np.abs(divergence + waves.body_force(x)).max() < 1e-6


@pytest.mark.parametrize("degree", CELLS)
def test_rates_at_finite_strain(degree: int) -> None:
    coarse, fine = CELLS[degree]
    first, second = (errors(*regular(n), degree, LAW) for n in (coarse, fine))
    rate = np.log(first / second) / np.log(fine / coarse)
    assert (rate >= np.array([degree + 1, degree]) - RATE_SLACK).all(), rate


@pytest.mark.parametrize("degree", [2, 3])
def test_rates_of_stiffening_tissue_on_irregular_tets(degree: int) -> None:
    law = bz.Stiffening(E=1.0, nu=0.3, A=5.0)
    first, second = (errors(*irregular(level), degree, law) for level in (1, 2))
    rate = np.log2(first / second)
    assert (rate >= np.array([degree + 1, degree]) - RATE_SLACK).all(), rate
