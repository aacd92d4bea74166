# SPDX-License-Identifier: BSD-3-Clause
"""An incompressible displacement that is no polynomial, its pressure, and its exact loads."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

import bezsoma as bz
from bezsoma.mesh import TetMesh
from convergence.waves import PHASE, WAVE, Floats, held_and_loaded, times

ACROSS = np.cross(WAVE, [[0.3, 0.2, 0.5], [0.4, -0.3, 0.2], [0.1, 0.5, -0.2]])
PUSH = np.array([1.0, -2.0, 1.5])


@dataclass(frozen=True)
class Stirring:
    """u = sum_i a_i sin(k_i . x + p_i) with a_i across k_i, so that div u = 0; p = G sin(q . x).

    With nu = 1/2: stress G (H + H^T) - p I, and f = G sum_i |k_i|^2 a_i sin(...) + grad p.
    """

    G: float

    def displacement(self, x: Floats) -> Floats:
        """U (p, 3)."""
        return times(np.sin(times(x, WAVE.T) + PHASE), ACROSS)

    def gradient(self, x: Floats) -> Floats:
        """H (p, 3, 3)."""
        return np.einsum("pi,ij,ik->pjk", np.cos(times(x, WAVE.T) + PHASE), ACROSS, WAVE)

    def pressure(self, x: Floats) -> Floats:
        """P (p,)."""
        return self.G * np.sin((x * PUSH).sum(axis=1))

    def stress(self, x: Floats) -> Floats:
        """The stress (p, 3, 3)."""
        H = self.gradient(x)
        return self.G * (H + np.swapaxes(H, 1, 2)) - self.pressure(x)[:, None, None] * np.eye(3)

    def body_force(self, x: Floats) -> Floats:
        """- div stress (p, 3)."""
        curl = np.sin(times(x, WAVE.T) + PHASE) * (WAVE**2).sum(axis=1)
        return self.G * (times(curl, ACROSS) + np.cos((x * PUSH).sum(axis=1))[:, None] * PUSH)


def errors(mesh: TetMesh, normals: Floats, degree: int, lower: int, fine: int) -> Floats:
    """L2 errors of u and p with a pressure of degree `lower`: every other plane held."""
    flow = Stirring(0.01)
    supports, loads = held_and_loaded(flow, normals, fine)
    law = bz.LinearElastic(3 * flow.G, 0.5)
    body = bz.Body(mesh, degree, law, supports, loads, pressure_degree=lower)
    solution = bz.solve(body, solver="direct", rtol=1e-10)
    assert solution.pressure is not None
    u, p = solution.displacement, solution.pressure
    return np.array([u.l2_error(flow.displacement, fine), p.l2_error(flow.pressure, fine)])
