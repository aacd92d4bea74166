# SPDX-License-Identifier: BSD-3-Clause
"""The element matrix: against quadrature, its symmetry, its spectrum, its law of scale."""

from __future__ import annotations

import numpy as np
import pytest

from bezsoma import bernstein
from bezsoma.arrays import Floats
from bezsoma.equations.element import element_matrices, moduli
from bezsoma.errors import InputError
from bezsoma.mechanics import Body, LinearElastic
from bezsoma.mesh import TetMesh, block
from tolerances import CLOSED_FORM, RIGID, ROUNDING

DEGREES = range(1, 11)


def tet(seed: int = 3) -> TetMesh:
    """A tet with no symmetry."""
    corners = np.eye(4, 3) + 0.3 * np.random.default_rng(seed).random((4, 3))
    return TetMesh(corners, [[0, 1, 2, 3]])


def matrix(mesh: TetMesh, degree: int, law: LinearElastic) -> Floats:
    """The element matrix of the one tet of a mesh."""
    one = np.ones(1)
    return element_matrices(degree, mesh.gradients, mesh.volumes, law.lam * one, law.mu * one)[0]


def by_quadrature(mesh: TetMesh, degree: int, law: LinearElastic) -> Floats:
    """int B^T C B with B in Voigt's order XX YY ZZ XY YZ ZX and C of eq. 6, in plain NumPy."""
    bary, weights = bernstein.simplex(2 * degree - 2, 3)
    grad = bernstein.derivatives(degree, bary) @ mesh.gradients[0]
    strains = np.zeros((len(bary), 6, grad.shape[1], 3))
    for row, (i, j) in enumerate([(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)]):
        strains[:, row, :, i] += grad[:, :, j]
        if i != j:
            strains[:, row, :, j] += grad[:, :, i]
    B = strains.reshape(len(bary), 6, -1)
    nu = law.nu
    C = np.zeros((6, 6))
    C[:3, :3] = nu + (1 - 2 * nu) * np.eye(3)
    C[3:, 3:] = (1 - 2 * nu) / 2 * np.eye(3)
    C *= law.E / ((1 + nu) * (1 - 2 * nu))
    CB = (weights[:, None, None] * (C @ B)).reshape(-1, B.shape[2])
    return mesh.volumes[0] * (B.reshape(-1, B.shape[2]).T @ CB)


@pytest.mark.parametrize("degree", DEGREES)
@pytest.mark.parametrize("nu", [0.0, 0.45])
def test_closed_form_is_the_quadrature(degree: int, nu: float) -> None:
    law = LinearElastic(2.0, nu)
    K, expected = matrix(tet(), degree, law), by_quadrature(tet(), degree, law)
    assert np.abs(K - expected).max() < CLOSED_FORM * np.abs(expected).max()


@pytest.mark.parametrize("degree", DEGREES)
def test_symmetric_to_the_last_bit(degree: int) -> None:
    K = matrix(tet(), degree, LinearElastic(1.0, 0.4))
    assert (K == K.T).all()


@pytest.mark.parametrize("degree", DEGREES)
def test_exactly_six_eigenvalues_vanish(degree: int) -> None:
    K = matrix(tet(), degree, LinearElastic(1.0, 0.3))
    sizes = np.abs(np.linalg.eigvalsh(K))
    assert (sizes < RIGID * sizes.max()).sum() == 6


@pytest.mark.parametrize("degree", DEGREES)
def test_rigid_motions_cost_nothing(degree: int) -> None:
    mesh = tet()
    K = matrix(mesh, degree, LinearElastic(1.0, 0.3))
    points = bernstein.domain_points(degree, 3) @ mesh.points
    spin = np.array([[0, -3.0, 1], [3, 0, 2], [-1, -2, 0]])
    for motion in (np.broadcast_to([1.0, -2, 3], points.shape), points @ spin.T):
        assert np.abs(K @ motion.ravel()).max() < 1e-14 * np.abs(K).max() * np.abs(motion).max()


def test_a_stretch_costs_what_eq_6_says() -> None:
    law, mesh = LinearElastic(2.0, 0.3), tet()
    for degree in (1, 3, 5):
        u = (bernstein.domain_points(degree, 3) @ mesh.points) * [1, 0, 0]
        energy = u.ravel() @ matrix(mesh, degree, law) @ u.ravel() / 2
        assert energy == pytest.approx(mesh.volumes[0] * law.voigt[0, 0] / 2, rel=1e-12)


def test_scales_as_length() -> None:
    mesh, law = tet(), LinearElastic(1.0, 0.2)
    small = TetMesh(1e-6 * mesh.points, mesh.tets)
    K, expected = matrix(small, 3, law), 1e-6 * matrix(mesh, 3, law)
    assert np.abs(K - expected).max() < ROUNDING * np.abs(expected).max()


def test_each_tet_has_its_own_material() -> None:
    mesh = block()
    mesh = TetMesh(mesh.points, mesh.tets, region=[0, 1, 0, 1, 0, 1], regions=("a", "b"))
    laws = {"a": LinearElastic(1.0, 0.3), "b": LinearElastic(5.0, 0.1)}
    lam, mu = moduli(Body(mesh, 1, laws, []))
    together = element_matrices(2, mesh.gradients, mesh.volumes, lam, mu)
    for number, (K, region) in enumerate(zip(together, "ababab", strict=True)):
        alone = TetMesh(mesh.points[mesh.tets[number]], [[0, 1, 2, 3]])
        np.testing.assert_allclose(K, matrix(alone, 2, laws[region]), rtol=0, atol=1e-13)


def test_another_law_is_refused() -> None:
    class Stiffening:
        linear = symmetric = False

        def stress(self, H: Floats) -> Floats:
            return H

    with pytest.raises(InputError, match=r"no Lame constants.*needs LinearElastic"):
        moduli(Body(block(), 1, Stiffening(), []))
