# SPDX-License-Identifier: BSD-3-Clause
"""Fields of low degree with a name: they have to come back at every degree that holds them."""

from __future__ import annotations

import numpy as np
import pytest

import bezsoma as bz
from bezsoma import bernstein
from bezsoma.mesh import TetMesh, ball, block
from convergence.polynomials import Floats
from tolerances import HUNG, patch

NUS = (0.0, 0.3, 0.45, -0.3)
E = 0.5
SIZE = (2.0, 0.6, 0.8)


def beam() -> TetMesh:
    """A beam of irregular tets about the x axis, with three of its corners named."""
    mesh = block(SIZE, cells=(4, 1, 2), origin=(-1.0, -0.3, -0.4), irregular=0.3, seed=4)
    corners = {"a": [-1, -0.3, -0.4], "b": [-1, 0.3, -0.4], "c": [-1, -0.3, 0.4]}
    for name, point in corners.items():
        mesh = mesh.with_vertices(name, [point])
    return mesh


def hung(displacement: bz.Polynomial) -> list[bz.Prescribed]:
    """Six components at three vertices: they stop rigid motions and can pull at nothing else."""
    places = {"a": "xyz", "b": "xz", "c": "x"}
    return [bz.Prescribed(p, value=displacement, components=c) for p, c in places.items()]


def samples(mesh: TetMesh) -> tuple[Floats, Floats]:
    """Barycentric points (b, 4) inside a tet, and where they lie in all (t b, 3)."""
    bary, _ = bernstein.simplex(5, 3)
    return bary, (bary @ mesh.points[mesh.tets]).reshape(-1, 3)


def apart(found: Floats, wanted: Floats) -> float:
    """The largest difference, relative to the largest that is wanted."""
    return float(np.abs(found.reshape(wanted.shape) - wanted).max() / np.abs(wanted).max())


def unforced(solution: bz.Solution, stress: float) -> bool:
    """Whether the three vertices pull at nothing, as a force of that stress on 1 mm2."""
    parts = solution.reactions.values()
    return all(np.abs([r.force, r.moment]).max() < patch(1) * stress for r in parts)


@pytest.mark.parametrize("degree", range(1, 11))
@pytest.mark.parametrize("nu", [0.0, 0.45])
def test_rigid_motion_gives_no_stress(degree: int, nu: float) -> None:
    """u = t + w x x, prescribed at three vertices of two tets; the rest follows without force.

    Stress is measured against E |w|, what a strain as large as the turn would give.
    """
    rng = np.random.default_rng(degree)
    corners = np.vstack([np.zeros(3), np.eye(3), np.ones(3)]) + rng.uniform(0, 0.2, (5, 3))
    mesh = TetMesh(corners, [[0, 1, 2, 3], [1, 2, 3, 4]])
    mesh = mesh.with_surface("a", [[0, 1, 2]])
    w = np.array([0.3, -0.5, 0.7])
    spin = np.cross(np.eye(3), w)
    motion = bz.Polynomial.affine(-spin.T, (0.2, 0.1, -0.4))
    held = [bz.Prescribed("a", value=motion)]
    solution = bz.solve(bz.Body(mesh, degree, bz.LinearElastic(E, nu), held), solver="direct")
    bary, points = samples(mesh)
    wanted = np.cross(w, points) + (0.2, 0.1, -0.4)
    force = np.abs(solution.reactions["a"].force).max()
    turn = float(np.linalg.norm(w))
    assert apart(solution.displacement.tabulated(bary), wanted) < patch(degree)
    assert np.abs(solution.stress.tabulated(bary)).max() < patch(degree) * E * turn
    assert force < patch(degree) * E * turn
    assert 0 <= solution.energy < patch(degree) ** 2 * E * turn**2


@pytest.mark.parametrize("degree", range(1, 5))
@pytest.mark.parametrize("nu", NUS)
def test_bar_in_tension(degree: int, nu: float) -> None:
    """Saint-Venant's bar: u = s (x, -nu y, -nu z), stress E s along x, its sides free."""
    s = 0.01
    u = bz.Polynomial.affine(s * np.diag([1, -nu, -nu]))
    loads = [
        bz.Traction("right", value=(E * s, 0, 0)),
        bz.Pressure("left", value=-E * s),
    ]
    body = bz.Body(beam(), degree, bz.LinearElastic(E, nu), hung(u), loads)
    solution = bz.solve(body, solver="direct")
    bary, points = samples(body.mesh)
    stress = np.tile(E * s * np.diag([1.0, 0, 0]), (len(points), 1, 1))
    assert apart(solution.displacement.tabulated(bary), u(points)) < HUNG
    assert apart(solution.stress.tabulated(bary), stress) < HUNG
    assert unforced(solution, E * s)


@pytest.mark.parametrize("degree", range(2, 5))
@pytest.mark.parametrize("nu", NUS)
def test_beam_in_pure_bending(degree: int, nu: float) -> None:
    """Saint-Venant's beam: bent to a radius of 1/c by tractions +-E c z on its ends alone.

    u = c (x z, -nu y z, (-x^2 + nu (y^2 - z^2)) / 2), stress E c z along x (S. Timoshenko and
    J. N. Goodier, Theory of Elasticity, 3rd ed., art. 102).
    """
    u = bz.Polynomial.parse(["0.02*x*z", f"{-nu}*0.02*y*z", f"0.01*(-x**2 + {nu}*(y**2 - z**2))"])
    ends = [
        bz.Traction("right", value=bz.Polynomial.parse([f"{0.02 * E}*z", 0, 0])),
        bz.Pressure("left", value=bz.Polynomial.parse(f"{-0.02 * E}*z")),
    ]
    body = bz.Body(beam(), degree, bz.LinearElastic(E, nu), hung(u), ends)
    solution = bz.solve(body, solver="direct")
    bary, points = samples(body.mesh)
    stress = np.zeros((len(points), 3, 3))
    stress[:, 0, 0] = 0.02 * E * points[:, 2]
    assert apart(solution.displacement.tabulated(bary), u(points)) < HUNG
    assert apart(solution.stress.tabulated(bary), stress) < HUNG
    assert unforced(solution, 0.02 * E)


@pytest.mark.parametrize("degree", range(2, 5))
@pytest.mark.parametrize("nu", NUS)
def test_ball_swells_without_shear(degree: int, nu: float) -> None:
    """A conformal displacement: pressure linear in x on facets that lean every way.

    u = 2 (a.x) x - |x|^2 a has the strain 2 (a.x) I, so stress 6 kappa (a.x) I: the pressure is
    -6 kappa a.x whatever the normal, the body force -6 kappa a. (By differentiation; in three
    dimensions these and affine similarities are all fields without shear, by Liouville.)
    """
    mesh = ball(cells=2 if degree < 4 else 1)
    for name, point in {"a": (1, 0, 0), "b": (0, 1, 0), "c": (0, 0, 1)}.items():
        mesh = mesh.with_vertices(name, [point])
    law = bz.LinearElastic(E, nu)
    kappa = E / (3 * (1 - 2 * nu))
    a = np.array([0.01, -0.03, 0.02])
    ax = "(0.01*x - 0.03*y + 0.02*z)"
    rr = "(x**2 + y**2 + z**2)"
    u = bz.Polynomial.parse(
        [f"2*{ax}*{c} - {rr}*({value})" for c, value in zip("xyz", a.tolist(), strict=True)]
    )
    p = bz.Polynomial.affine(-6 * kappa * np.tile(a, (3, 1)))
    loads = [
        bz.Pressure("outer", value=bz.Polynomial(p.components[:1])),
        bz.BodyForce(tuple(-6 * kappa * a)),
    ]
    solution = bz.solve(bz.Body(mesh, degree, law, hung(u), loads), solver="direct")
    bary, points = samples(mesh)
    wanted = 2 * (points @ a)[:, None] * points - (points**2).sum(axis=1)[:, None] * a
    stress = 6 * kappa * (points @ a)[:, None, None] * np.eye(3)
    assert apart(solution.displacement.tabulated(bary), wanted) < HUNG
    assert apart(solution.stress.tabulated(bary), stress) < HUNG
    assert unforced(solution, kappa * 0.04)
