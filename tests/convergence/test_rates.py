# SPDX-License-Identifier: BSD-3-Clause
"""Manufactured solutions: errors fall at the rates of the theory, k + 1 in L2 and k in H1.

S. C. Brenner and L. R. Scott, The Mathematical Theory of Finite Element Methods, 3rd ed. (2008),
theorems 5.4.4 and 5.4.8 (Aubin and Nitsche), for solutions as smooth as plane waves.
"""

from __future__ import annotations

import numpy as np
import pytest

from convergence.waves import Waves, errors, irregular, regular
from tolerances import RATE_SLACK

CELLS = {1: (10, 15), 2: (3, 6), 3: (2, 4), 4: (2, 4), 5: (1, 2), 6: (1, 2)}
LEVELS = {1: (3, 4), 2: (1, 2), 3: (1, 2), 4: (0, 1), 5: (0, 1), 6: (0, 1)}
"""Meshes so coarse that all take seconds, and so fine that the rate is that of the limit."""


def test_body_force_is_the_divergence_of_the_stress() -> None:
    """By central differences of step h: their error is h^2 k^3, so 1e-7 here."""
    waves, h = Waves(2.0, 0.4), 1e-4
    x = np.random.default_rng(0).uniform(-1, 1, (20, 3))
    steps = h * np.eye(3)
    divergence = sum(
        (waves.stress(x + e)[:, :, j] - waves.stress(x - e)[:, :, j]) / (2 * h)
        for j, e in enumerate(steps)
    )
    slope = [(waves.displacement(x + e) - waves.displacement(x - e)) / (2 * h) for e in steps]
    assert np.abs(divergence + waves.body_force(x)).max() < 1e-5
    assert np.abs(np.stack(slope, axis=2) - waves.gradient(x)).max() < 1e-5


@pytest.mark.parametrize("degree", CELLS)
def test_rates_on_regular_tets(degree: int) -> None:
    coarse, fine = CELLS[degree]
    first, second = (errors(*regular(n), degree, Waves(0.02, 0.3)) for n in (coarse, fine))
    rate = np.log(first / second) / np.log(fine / coarse)
    assert (rate >= np.array([degree + 1, degree]) - RATE_SLACK).all(), rate


@pytest.mark.parametrize("degree", LEVELS)
@pytest.mark.parametrize("nu", [0.0, 0.45])
def test_rates_on_irregular_tets(degree: int, nu: float) -> None:
    first, second = (errors(*irregular(n), degree, Waves(0.02, nu)) for n in LEVELS[degree])
    rate = np.log2(first / second)
    assert (rate >= np.array([degree + 1, degree]) - RATE_SLACK).all(), rate
