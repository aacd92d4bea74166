# SPDX-License-Identifier: BSD-3-Clause
"""Polynomial displacements and pressures come back from the mixed form, whatever holds them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pytest

import bezsoma as bz
from bezsoma.mesh import TetMesh, block
from convergence.polynomials import Floats, Terms, combined, derivative, formula, values
from convergence.waves import irregular
from tolerances import patch


def drawn(degree: int, rng: np.random.Generator) -> Terms:
    """A polynomial with all terms up to a degree."""
    powers = [p for p in np.ndindex(*(degree + 1,) * 3) if sum(p) <= degree]
    return dict(zip(powers, rng.uniform(-1, 1, len(powers)).tolist(), strict=True))


@dataclass(frozen=True, eq=False)
class Pair:
    """A displacement and a pressure, G = 1; the stress is H + H^T - 2/3 tr(H) I - p I."""

    u: tuple[Terms, ...]
    p: Terms

    @classmethod
    def incompressible(cls, degree: int, lower: int) -> Pair:
        """The curl of anything, and any pressure."""
        rng = np.random.default_rng(degree)
        a = [drawn(degree + 1, rng) for _ in "xyz"]
        turns = ((2, 1), (0, 2), (1, 0))
        u = (combined((0.3, derivative(a[i], j)), (-0.3, derivative(a[j], i))) for i, j in turns)
        return cls(tuple(u), drawn(lower, rng))

    @classmethod
    def compressible(cls, lower: int, softness: float) -> Pair:
        """Anything the divergence of which has the pressure's degree: p = -kappa div u."""
        rng = np.random.default_rng(lower)
        u = tuple(drawn(lower + 1, rng) for _ in "xyz")
        return cls(u, combined(*((-1 / softness, derivative(u[i], i)) for i in range(3))))

    @cached_property
    def stress(self) -> list[list[Terms]]:
        """MPa."""
        H = [[derivative(each, axis) for axis in range(3)] for each in self.u]
        volumetric = combined(*((-2 / 3, H[k][k]) for k in range(3)), (-1.0, self.p))
        return [
            [
                combined((1.0, H[k][m]), (1.0, H[m][k]), (float(k == m), volumetric))
                for m in range(3)
            ]
            for k in range(3)
        ]

    def traction(self, normal: Floats) -> bz.Polynomial:
        """Stress times a unit normal."""
        n = normal.tolist()
        return formula(*(combined(*zip(n, row, strict=True)) for row in self.stress))

    @cached_property
    def force(self) -> bz.Polynomial:
        """- div stress."""
        rows = self.stress
        return formula(
            *(combined(*((-1.0, derivative(row[m], m)) for m in range(3))) for row in rows)
        )


def body(mesh: TetMesh, pair: Pair, degree: int, lower: int, nu: float, enclosed: bool) -> bz.Body:
    """Half of the facets prescribed and exact tractions on the others, or all prescribed."""
    law = bz.LinearElastic(2 + 2 * nu, nu)
    cut = 0 if enclosed else len(mesh.boundary) // 2
    facets, loads = mesh.boundary, [bz.BodyForce(pair.force)]
    for number in range(cut):
        mesh = mesh.with_surface(f"facet {number}", facets[number : number + 1])
        normal = mesh.normals(facets[number : number + 1])[0]
        loads += [bz.Traction(f"facet {number}", value=pair.traction(normal))]
    mesh = mesh.with_surface("held", facets[cut:])
    held = [bz.Prescribed("held", value=formula(*pair.u))]
    return bz.unlocked(bz.Body(mesh, degree, law, held, loads, pressure_degree=lower))


@pytest.mark.parametrize(("degree", "lower"), [(2, 1), (3, 1), (3, 2), (4, 3), (5, 4), (6, 5)])
@pytest.mark.parametrize("nu", [0.3, 0.4999, 0.5])
@pytest.mark.parametrize("enclosed", [False, True])
def test_pairs_of_polynomials_come_back(degree: int, lower: int, nu: float, enclosed: bool) -> None:
    softness = 3 * (1 - 2 * nu) / (2 + 2 * nu)
    pair = Pair.compressible(lower, softness) if softness else Pair.incompressible(degree, lower)
    mesh = irregular(0)[0] if degree > 3 else block(cells=(2, 1, 1), irregular=0.3)
    solution = bz.solve(body(mesh, pair, degree, lower, nu, enclosed), solver="direct")
    u = bz.Field.interpolating(solution.net, lambda x: values(pair.u, x)).controls
    assert isinstance(solution.pressure, bz.Field)
    net = solution.pressure.net
    p = bz.Field.interpolating(net, lambda x: values([pair.p], x)[:, 0]).controls
    assert solution.level.startswith("not") == (enclosed and nu == 0.5)
    if enclosed and nu == 0.5:
        p = p - bz.Field(net, p).integral() / net.mesh.volumes.sum()
    assert np.abs(solution.displacement.controls - u).max() < ROUNDED * np.abs(u).max()
    assert np.abs(solution.pressure.controls - p).max() < PRESSED * np.abs(p).max()


ROUNDED = 100 * patch(1)
"""Controls of degree 6 from an indefinite matrix: two digits more than `patch` allows."""
PRESSED = 1e4 * patch(1)
"""Pressures are a degree less and their matrix less well conditioned."""
