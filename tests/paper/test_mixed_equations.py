# SPDX-License-Identifier: BSD-3-Clause
"""The paper's mixed form as it stands with its two corrections, against what is computed.

B_V has six entries and C_D is diag(2G, 2G, 2G, G, G, G): docs/theory/errata.md. With the printed
ones the comparisons fail, which a test shows.
"""

from __future__ import annotations

import numpy as np
import pytest

import bezsoma as bz
from bezsoma.arrays import Floats
from bezsoma.bernstein import indices
from bezsoma.equations.mixed import MixedMatrix, deviatoric_lame, mixed_matrix, mixed_moduli
from paper.test_equations import VOIGT, Literal
from tolerances import CLOSED_FORM

ROW = np.array([1.0, 1, 1, 0, 0, 0])
"""Eq. 41, corrected: what sums the normal strains."""
E, NU = 1.7, 0.3
G, KAPPA = E / (2 * (1 + NU)), E / (3 * (1 - 2 * NU))
C_D = np.diag([2 * G, 2 * G, 2 * G, G, G, G])
"""Eq. 42, corrected."""
SPLIT = np.eye(6) - np.outer(ROW, ROW) / 3
"""B_D = SPLIT B: takes a third of the volumetric strain off the normal strains (eq. 19)."""


@pytest.fixture(scope="module", params=[2, 3])
def paper(request: pytest.FixtureRequest) -> Literal:
    mesh = bz.block(size=(2, 1, 1), cells=(2, 1, 1), irregular=0.2, seed=5)
    held = [bz.Fixed("left"), bz.Moved("right", translation=(0.1, 0.05, 0))]
    load = [bz.Traction("top", value=(0.1, 0, -0.2))]
    law = bz.LinearElastic(E=E, nu=NU)
    body = bz.Body(mesh, request.param, law, held, load, incompressible=True)
    return Literal(body, bz.solve(body, solver="direct", rtol=1e-12))


@pytest.fixture(scope="module")
def matrix(paper: Literal) -> MixedMatrix:
    assert isinstance(paper.solution.pressure, bz.Field)
    return mixed_matrix(paper.net, paper.solution.pressure.net, mixed_moduli(paper.body))


def h_p(paper: Literal, bary: Floats) -> Floats:
    """H_P of eq. 38: Bernstein polynomials of the pressure's degree."""
    degree = paper.body.pressure_degree
    assert degree is not None
    powers = indices(degree, 3)
    factorial = [1, 1, 2, 6, 24]
    ways = [factorial[degree] / np.prod([factorial[k] for k in a]) for a in powers]
    return np.array(ways) * np.prod(bary[None] ** powers, axis=1)


def six(tensor: Floats, shears: int) -> Floats:
    return np.array([tensor[i, j] * (1 if i == j else shears) for i, j in VOIGT])


@pytest.fixture
def bary() -> Floats:
    return np.array([0.1, 0.2, 0.3, 0.4])


def test_volumetric_and_deviatoric_strain(paper: Literal, bary: Floats) -> None:
    """Eqs. 12, 13, 19 and 36: B_V u hat is div u; stress of eq. 18 is C_D B_D u hat."""
    u = paper.solution.displacement
    for tet in (0, 5):
        strain = paper.B(tet, bary) @ paper.controls(tet, u.controls)
        at = (np.array([tet]), bary[None])
        found = paper.solution.divergence.at_bary(*at)[0]
        assert found == pytest.approx(ROW @ strain, rel=1e-11, abs=1e-13)
        H = u.gradient_bary(*at)[0]
        literal = C_D @ (SPLIT @ strain)
        assert np.allclose(six(paper.body.materials.deviatoric_stress(H), 1), literal, atol=1e-13)


def test_stress_in_two_parts(paper: Literal, bary: Floats) -> None:
    """Eqs. 9 and 18: kappa eps_V + 2 G eps' is the stress of C."""
    strain = np.array([0.1, -0.2, 0.05, 0.3, -0.1, 0.2])
    literal = KAPPA * (ROW @ strain) * ROW + C_D @ (SPLIT @ strain)
    assert np.allclose(paper.C() @ strain, literal, rtol=1e-13)


def test_pressure(paper: Literal, bary: Floats) -> None:
    """Eqs. 14, 15, 16: stress = 2 G eps' - p I, p = -tr(stress)/3; and -kappa eps_V in the mean."""
    solution = paper.solution
    assert isinstance(solution.pressure, bz.Field)
    for tet in (0, 7):
        at = (np.array([tet]), bary[None])
        p = h_p(paper, bary) @ solution.pressure.on_tets(np.array([tet]))[0]
        strain = paper.B(tet, bary) @ paper.controls(tet, solution.displacement.controls)
        tau = six(solution.stress.at_bary(*at)[0], 1)
        assert np.allclose(tau, C_D @ (SPLIT @ strain) - p * ROW, atol=1e-13)
        assert -(ROW @ tau) / 3 == pytest.approx(p, rel=1e-11)
    total = solution.pressure.integral()
    assert total == pytest.approx(-KAPPA * solution.divergence.integral(), rel=1e-10)


def test_blocks_of_the_mixed_system(paper: Literal, matrix: MixedMatrix) -> None:
    """Eqs. 37, 38, 39, 40 and 41: sums of int B_D^T C_D B_D, -B_V^T H_P and H_P^T H_P / kappa."""
    assert isinstance(paper.solution.pressure, bz.Field)
    points, _ = paper.rule()
    net = paper.solution.pressure.net
    rng = np.random.default_rng(1)
    u, p = rng.normal(size=(paper.net.count, 3)), rng.normal(size=net.count)
    forces, volumes = [], np.zeros(net.count)
    for tet in range(len(paper.mesh.tets)):
        own, pressed = paper.controls(tet, u), p[net.of_tet[tet]]
        B = [paper.B(tet, point) for point in points]
        H = [h_p(paper, point) for point in points]
        shear = paper.integrated(tet, [(SPLIT @ b).T @ C_D @ (SPLIT @ b) for b in B])
        mixed = paper.integrated(tet, [-np.outer(ROW @ b, h) for b, h in zip(B, H, strict=True)])
        mass = paper.integrated(tet, [np.outer(h, h) / KAPPA for h in H])
        forces.append(shear @ own + mixed @ pressed)
        np.add.at(volumes, net.of_tet[tet], mixed.T @ own - mass @ pressed)
    f, g = matrix.apply(u, p)
    literal = paper.summed(forces)
    assert np.abs(f - literal).max() < CLOSED_FORM * np.abs(literal).max()
    assert np.abs(g - volumes).max() < CLOSED_FORM * np.abs(volumes).max()


def test_virtual_work_and_weak_pressure(paper: Literal, matrix: MixedMatrix) -> None:
    """Eqs. 17 and 20: both hold for every free v and every q, at the answer."""
    solution = paper.solution
    assert isinstance(solution.pressure, bz.Field)
    f, g = matrix.apply(solution.displacement.controls, solution.pressure.controls)
    free = (np.abs(paper.net.points[:, 0] - 1) < 0.99) & (paper.net.points[:, 2] < 0.99)
    assert np.abs(f[free]).max() < 1e-12 * np.abs(f).max()
    assert np.abs(g).max() < 1e-14


def test_deviatoric_matrix(paper: Literal) -> None:
    """Eqs. 19, 36 and 42: B_D^T C_D B_D costs what lambda = -2/3 G, mu = G do; as printed, not."""
    lam, mu = deviatoric_lame(np.array([[G, 0.0]]))[0]
    isotropic = lam * np.outer(ROW, ROW) + np.diag([2 * mu] * 3 + [mu] * 3)
    assert np.allclose(SPLIT.T @ C_D @ SPLIT, isotropic, rtol=1e-14)
    printed = SPLIT.T @ (2 * G * np.eye(6)) @ SPLIT
    shear = np.array([0, 0, 0, 0.1, 0, 0])
    assert shear @ printed @ shear == pytest.approx(2 * (shear @ isotropic @ shear))
