# SPDX-License-Identifier: BSD-3-Clause
"""Incompressible solutions: rates k + 1 in displacement and k in pressure; polynomials exactly.

D. Boffi, F. Brezzi and M. Fortin, Mixed Finite Element Methods and Applications (2013), chapter 8.
"""

from __future__ import annotations

import numpy as np
import pytest

from convergence.stirring import Stirring, errors
from convergence.waves import irregular, regular
from tolerances import RATE_SLACK

CELLS = {2: (4, 6), 3: (2, 4), 4: (2, 3), 5: (1, 2), 6: (1, 2)}
LEVELS = {2: (1, 2), 3: (1, 2), 4: (0, 1), 5: (0, 1), 6: (0, 1)}


def test_body_force_is_the_divergence_of_the_stress() -> None:
    flow, h = Stirring(2.0), 1e-4
    x = np.random.default_rng(0).uniform(-1, 1, (20, 3))
    steps = h * np.eye(3)
    divergence = sum(
        (flow.stress(x + e)[:, :, j] - flow.stress(x - e)[:, :, j]) / (2 * h)
        for j, e in enumerate(steps)
    )
    assert np.abs(np.trace(flow.gradient(x), axis1=1, axis2=2)).max() < 1e-14
    assert np.abs(divergence + flow.body_force(x)).max() < 1e-5


@pytest.mark.parametrize("degree", [2, 3, 4, 5, pytest.param(6, marks=pytest.mark.slow)])
def test_rates_on_regular_tets(degree: int) -> None:
    coarse, fine = CELLS[degree]
    first, second = (
        errors(*regular(n), degree, degree - 1, 2 * degree + 4) for n in (coarse, fine)
    )
    rate = np.log(first / second) / np.log(fine / coarse)
    assert (rate >= np.array([degree + 1, degree]) - RATE_SLACK).all(), rate


@pytest.mark.parametrize("degree", LEVELS)
def test_rates_on_irregular_tets(degree: int) -> None:
    first, second = (
        errors(*irregular(n), degree, degree - 1, 2 * degree + 4) for n in LEVELS[degree]
    )
    rate = np.log2(first / second)
    assert (rate >= np.array([degree + 1, degree]) - RATE_SLACK).all(), rate
