# SPDX-License-Identifier: BSD-3-Clause
"""The paper's equations as printed, evaluated as they stand, against what BezSoma computes.

Nothing of BezSoma's closed forms is used on the literal side: matrices are written out as in the
paper and integrals are sums over quadrature points of ample exactness. What is compared is in the
name of each test; where the paper has to be corrected, docs/theory/errata.md says how.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import factorial

import numpy as np
import pytest

import bezsoma as bz
from bezsoma import bernstein
from bezsoma.arrays import Floats
from bezsoma.equations.assembled import assembled
from bezsoma.equations.element import moduli
from bezsoma.equations.forces import forces
from tolerances import CLOSED_FORM

VOIGT = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))
"""The order of eqs. 2 and 4: XX YY ZZ XY YZ ZX."""

BODY_FORCE = np.array([0.3, -0.2, 0.5])


@dataclass
class Literal:
    """One body, and the quadrature of its tets: the paper's side of each comparison."""

    body: bz.Body
    solution: bz.Solution

    @property
    def mesh(self) -> bz.TetMesh:
        return self.body.mesh

    @property
    def net(self) -> bz.ControlNet:
        return self.solution.net

    def rule(self) -> tuple[Floats, Floats]:
        return bernstein.simplex(2 * self.body.degree + 1, 3)

    def jacobian(self, tet: int) -> Floats:
        """J of eq. 56: row i is dP/dL_i with L_4 eliminated, P_i - P_4."""
        corners = self.mesh.points[self.mesh.tets[tet]]
        return corners[:3] - corners[3]

    def shape(self, bary: Floats) -> Floats:
        """The h_i, Bernstein polynomials as eq. 57 has them."""
        alpha = bernstein.indices(self.body.degree, 3)
        ways = [factorial(self.body.degree) / np.prod([factorial(k) for k in a]) for a in alpha]
        return np.array(ways) * np.prod(bary[None, :] ** alpha, axis=1)

    def slopes(self, tet: int, bary: Floats) -> Floats:
        """The (m, 3) dh/dX, dh/dY, dh/dZ by eq. 56, from derivatives by L_1, L_2, L_3."""
        by_L = bernstein.derivatives(self.body.degree, bary)
        eliminated = by_L[:, :3] - by_L[:, 3:]
        return np.linalg.solve(self.jacobian(tet), eliminated.T).T

    def H(self, bary: Floats) -> Floats:
        """H of eq. 29: x, y and z components one after the other."""
        return np.kron(np.eye(3), self.shape(bary))

    def B(self, tet: int, bary: Floats) -> Floats:
        """B of eq. 31, six rows."""
        x, y, z = self.slopes(tet, bary).T
        o = np.zeros_like(x)
        rows = [(x, o, o), (o, y, o), (o, o, z), (y, x, o), (o, z, y), (z, o, x)]
        return np.array([np.concatenate(row) for row in rows])

    def C(self) -> Floats:
        """C of eq. 6."""
        E, nu = self.body.materials.E, self.body.materials.nu
        C = np.full((3, 3), nu) + (1 - 2 * nu) * np.eye(3)
        o = np.zeros((3, 3))
        return E / ((1 + nu) * (1 - 2 * nu)) * np.block([[C, o], [o, (0.5 - nu) * np.eye(3)]])

    def controls(self, tet: int, u: Floats) -> Floats:
        """The vector u hat of eq. 29 of one tet: all x, then all y, then all z."""
        return u[self.net.of_tet[tet]].T.ravel()

    def summed(self, local: list[Floats]) -> Floats:
        """The sum over m of eqs. 34, 35, 45: local vectors (3m,) to the net's (c, 3)."""
        total = np.zeros((self.net.count, 3))
        for tet, vector in enumerate(local):
            np.add.at(total, self.net.of_tet[tet], vector.reshape(3, -1).T)
        return total

    def integrated(self, tet: int, values: list[Floats]) -> Floats:
        _, weights = self.rule()
        whole = abs(np.linalg.det(self.jacobian(tet))) / 6
        return whole * sum(w * v for w, v in zip(weights, values, strict=True))


@pytest.fixture(scope="module", params=[1, 2, 4])
def paper(request: pytest.FixtureRequest) -> Literal:
    mesh = bz.block(size=(2, 1, 1), cells=(2, 1, 1), irregular=0.2, seed=5)
    body = bz.Body(
        mesh,
        degree=request.param,
        materials=bz.LinearElastic(E=1.7, nu=0.3),
        supports=[bz.Fixed("left"), bz.Moved("right", translation=(0.1, 0.05, 0))],
        loads=[bz.BodyForce(BODY_FORCE)],
    )
    return Literal(body, bz.solve(body, solver="direct"))


@pytest.fixture
def bary() -> Floats:
    return np.array([0.1, 0.2, 0.3, 0.4])


def test_geometry_of_a_tet(paper: Literal, bary: Floats) -> None:
    """Eqs. 54 and 55: x = sum L_i x_i; the locator finds those L again."""
    point = bary @ paper.mesh.points[paper.mesh.tets[3]]
    u = paper.solution.displacement
    assert np.allclose(u.at(point[None]), u.at_bary(np.array([3]), bary[None]), atol=1e-14)


def test_bernstein_polynomials(paper: Literal, bary: Floats) -> None:
    """Eq. 57, against `bernstein.values`."""
    assert np.allclose(bernstein.values(paper.body.degree, bary), paper.shape(bary), rtol=1e-13)


def test_a_patch_is_a_sum_of_controls(paper: Literal, bary: Floats) -> None:
    """Eqs. 1, 27, 28, 29 and 58: displacement = H u hat."""
    for tet in (0, 7):
        literal = paper.H(bary) @ paper.controls(tet, paper.solution.displacement.controls)
        found = paper.solution.displacement.at_bary(np.array([tet]), bary[None])[0]
        assert np.allclose(found, literal, rtol=1e-12, atol=1e-14)


def test_derivatives_by_the_jacobian(paper: Literal, bary: Floats) -> None:
    """Eq. 56, against the gradients of the barycentric coordinates."""
    for tet in range(len(paper.mesh.tets)):
        found = bernstein.derivatives(paper.body.degree, bary) @ paper.mesh.gradients[tet]
        assert np.allclose(found, paper.slopes(tet, bary), rtol=1e-12, atol=1e-12)
        assert np.isclose(abs(np.linalg.det(paper.jacobian(tet))), 6 * paper.mesh.volumes[tet])


def test_strain(paper: Literal, bary: Floats) -> None:
    """Eqs. 2, 3, 30 and 31: B u hat, shears twice those of the tensor."""
    for tet in (0, 5):
        literal = paper.B(tet, bary) @ paper.controls(tet, paper.solution.displacement.controls)
        eps = paper.solution.strain.at_bary(np.array([tet]), bary[None])[0]
        six = [eps[i, j] * (1 if i == j else 2) for i, j in VOIGT]
        assert np.allclose(six, literal, rtol=1e-11, atol=1e-13)


def test_stress(paper: Literal, bary: Floats) -> None:
    """Eqs. 4, 5 and 6: C times the strain."""
    for tet in (0, 5):
        strain = paper.B(tet, bary) @ paper.controls(tet, paper.solution.displacement.controls)
        tau = paper.solution.stress.at_bary(np.array([tet]), bary[None])[0]
        assert np.allclose([tau[i, j] for i, j in VOIGT], paper.C() @ strain, atol=1e-12)


def test_moduli(paper: Literal) -> None:
    """Eqs. 10 and 11."""
    law = paper.body.materials
    assert law.kappa == pytest.approx(1.7 / (3 * (1 - 0.6)), rel=1e-14)
    assert law.mu == pytest.approx(1.7 / (2 * 1.3), rel=1e-14)


def test_stiffness_matrix(paper: Literal) -> None:
    """Eqs. 32 and 34: the sum of int B^T C B, against the closed form in C++."""
    bary, _ = paper.rule()
    K = assembled(paper.net, *moduli(paper.body))
    u = np.random.default_rng(1).normal(size=(paper.net.count, 3))
    local = []
    for tet in range(len(paper.mesh.tets)):
        B = [paper.B(tet, point) for point in bary]
        matrix = paper.integrated(tet, [b.T @ paper.C() @ b for b in B])
        local.append(matrix @ paper.controls(tet, u))
    literal = paper.summed(local)
    assert np.abs(K @ u - literal).max() < CLOSED_FORM * np.abs(literal).max()


def test_force_vector(paper: Literal) -> None:
    """Eq. 35: the sum of int H^T f."""
    bary, _ = paper.rule()
    local = [
        paper.integrated(tet, [paper.H(point).T @ BODY_FORCE for point in bary])
        for tet in range(len(paper.mesh.tets))
    ]
    found = forces(paper.body, paper.net)
    assert np.abs(found - paper.summed(local)).max() < CLOSED_FORM * np.abs(found).max()


def test_internal_forces_balance_the_loads(paper: Literal) -> None:
    """Eqs. 8, 33 and 45: int B^T tau = R wherever nothing is prescribed."""
    bary, _ = paper.rule()
    local = []
    for tet in range(len(paper.mesh.tets)):
        tau = paper.solution.stress.at_bary(np.full(len(bary), tet), bary)
        six = np.array([[t[i, j] for i, j in VOIGT] for t in tau])
        work = [paper.B(tet, point).T @ t for point, t in zip(bary, six, strict=True)]
        local.append(paper.integrated(tet, work))
    F, R = paper.summed(local), forces(paper.body, paper.net)
    held = np.union1d(paper.net.of_place("left"), paper.net.of_place("right"))
    free = np.setdiff1d(np.arange(paper.net.count), held)
    largest = np.abs(F).max()
    if len(free):
        assert np.abs((F - R)[free]).max() < 1e-11 * largest
    push = sum(reaction.force for reaction in paper.solution.reactions.values())
    assert np.allclose((F - R)[held].sum(axis=0), push, atol=1e-11 * largest)
    turn = sum(reaction.moment for reaction in paper.solution.reactions.values())
    arms = np.cross(paper.net.points[held], (F - R)[held])
    assert np.allclose(arms.sum(axis=0), turn, atol=1e-10 * largest)


def test_the_solution_has_the_least_potential(paper: Literal) -> None:
    """Eq. 7: Pi = int eps^T tau / 2 - int u^T f grows in every direction from the solution."""
    K, R = assembled(paper.net, *moduli(paper.body)), forces(paper.body, paper.net)
    u = paper.solution.displacement.controls

    def potential(v: Floats) -> float:
        return float((v * (K @ v)).sum() / 2 - (v * R).sum())

    bary, weights = paper.rule()
    stored = sum(
        paper.mesh.volumes[tet] * w * np.tensordot(eps, tau) / 2
        for tet in range(len(paper.mesh.tets))
        for eps, tau, w in zip(
            paper.solution.strain.at_bary(np.full(len(bary), tet), bary),
            paper.solution.stress.at_bary(np.full(len(bary), tet), bary),
            weights,
            strict=True,
        )
    )
    assert paper.solution.energy == pytest.approx(stored, rel=1e-12)
    held = np.union1d(paper.net.of_place("left"), paper.net.of_place("right"))
    for seed in range(5):
        step = 1e-3 * np.random.default_rng(seed).normal(size=u.shape)
        step[held] = 0
        if step.any():
            assert potential(u + step) > potential(u)
            assert potential(u - step) > potential(u)
