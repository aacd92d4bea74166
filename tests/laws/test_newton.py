# SPDX-License-Identifier: BSD-3-Clause
"""The nonlinear solver: it finds the same answer on every way, quickly, and says how.

Eqs. 21, 25, 26, 43, 44, 46, 49, 50 and 52 of the paper are what it solves; eq. 53 is not when it
stops.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

import bezsoma as bz
from bezsoma.equations.following import FollowingPressure
from bezsoma.equations.pointwise import Pointwise
from bezsoma.mesh.control_net import ControlNet
from laws import plain_laws as plain

E, NU = 0.015, 0.4
STEPS = 1e-9
"""How little the answer may depend on the load steps, of the largest displacement."""
PATH = 1e-8
"""Two ways to the same answer, each stopped at a residual of 1e-10."""


SIDES = [bz.Fixed(at, components=c) for at, c in (("left", "x"), ("front", "y"), ("bottom", "z"))]


def bent(
    law: Any, degree: int = 2, shift: float = 0.5, cells: Any = (3, 1, 1), **more: Any
) -> bz.Body:
    """A short bar, one end held, the other moved across and a little along."""
    moved = bz.Moved("right", translation=(0.1 * shift, 0, shift))
    mesh = bz.block(size=(3.0, 1.0, 1.0), cells=(3, 1, 1))
    return bz.Body(mesh, degree, law, [bz.Fixed("left"), moved])


def controls(body: bz.Body, **how: Any) -> Any:
    """The displacement's controls."""
    return bz.solve(body, **how).displacement.controls


def apart(one: Any, other: Any) -> float:
    """The largest difference, of the largest displacement."""
    return float(np.abs(one - other).max() / np.abs(other).max())


@pytest.mark.parametrize("measure", ["frobenius", "mean", "energy", "deviatoric"])
def test_without_stiffening_the_answer_is_the_linear_one(measure: str) -> None:
    law = bz.Stiffening(E, NU, 0.0, measure=measure)
    found = controls(bent(law), solver="direct", rtol=1e-13)
    assert apart(found, controls(bent(bz.LinearElastic(E, NU)), solver="direct")) < 1e-12


@pytest.mark.parametrize(
    "law", [bz.Stiffening(E, NU, 5.0), bz.NeoHooke(E, NU), bz.MooneyRivlin(E, E / 3, E)]
)
def test_answer_does_not_depend_on_the_steps(law: Any) -> None:
    body = bent(law, 2, 1.0)
    once = controls(body, solver="direct", rtol=1e-12, steps=1)
    for steps in (2, 5, [0.1, 0.7, 1.0], "auto"):
        assert apart(controls(body, solver="direct", rtol=1e-12, steps=steps), once) < STEPS


def test_small_motions_give_the_linear_answer_whatever_the_law() -> None:
    linear = controls(bent(bz.LinearElastic(E, NU), 2, 1e-5))
    for law in (bz.NeoHooke(E, NU), bz.StVenantKirchhoff(E, NU), bz.Stiffening(E, NU, 5.0)):
        assert apart(controls(bent(law, 2, 1e-5), solver="direct"), linear) < 1e-4


@pytest.mark.parametrize(
    "law",
    [
        bz.NeoHooke(E, NU),
        bz.VerondaWestmann(E, 0.7, 10 * E),
        bz.Guccione(E, 8.0, 2.0, 4.0, 5 * E, (1, 0, 0)),
        bz.Ogden([E], [3.0], 5 * E),
        bz.Stiffening(E, NU, 5.0),
    ],
)
def test_last_steps_are_quadratic(law: Any) -> None:
    """The residual is squared, up to a constant, once it is small."""
    path = bz.solve(bent(law, 2, 0.8), solver="direct", rtol=1e-12, steps=1).path
    sizes = [each.residual for each in path if each.residual > 1e-13]
    near = [(a, b) for a, b in pairwise(sizes) if a < 0.02]
    assert len(path) <= 9 and near
    for before, after in near:
        assert after < max(50 * before**2, 1e-12)


@pytest.mark.parametrize("method", ["modified", "secant"])
def test_cheaper_iterations_find_the_same(method: str) -> None:
    body = bent(bz.Stiffening(E, NU, 5.0), 2, 0.4)
    full, cheap = (bz.solve(body, solver="direct", method=each) for each in ("newton", method))
    assert apart(cheap.displacement.controls, full.displacement.controls) < PATH
    assert cheap.iterations > full.iterations


@pytest.mark.parametrize("law", [bz.Stiffening(E, NU, 5.0), bz.NeoHooke(E, NU)])
def test_without_a_matrix_it_finds_the_same(law: Any) -> None:
    body = bent(law, 3, 0.7)
    direct, free = (bz.solve(body, solver=each) for each in ("direct", "multigrid"))
    assert apart(free.displacement.controls, direct.displacement.controls) < PATH
    assert max(each.linear for each in free.path) > 1
    assert abs(free.energy - direct.energy) < PATH * direct.energy


def test_law_of_a_user_gives_what_the_core_gives() -> None:
    for solver in ("direct", "multigrid"):
        one, other = (
            controls(bent(law), solver=solver)
            for law in (bz.NeoHooke(E, NU), plain.neo_hooke(E, NU))
        )
        assert apart(one, other) < PATH


def test_laws_of_two_regions_meet() -> None:
    """A linear and a nonlinear half, against both written as functions."""
    mesh = bz.block(size=(2.0, 1.0, 1.0), cells=(2, 1, 1))
    region = (mesh.points[mesh.tets].mean(axis=1)[:, 0] > 1).astype(int)
    mesh = bz.TetMesh(
        mesh.points, mesh.tets, region=region, regions=("soft", "hard"), surfaces=mesh.surfaces
    )
    supports = [bz.Fixed("left"), bz.Moved("right", translation=(0.4, 0, 0.3))]
    laws = [
        {"soft": bz.NeoHooke(E, NU), "hard": bz.LinearElastic(3 * E, NU)},
        {"soft": plain.neo_hooke(E, NU), "hard": plain.stiffening(3 * E, NU, 0.0)},
    ]
    one, other = (controls(bz.Body(mesh, 2, each, supports)) for each in laws)
    assert apart(one, other) < PATH


def test_turned_body_is_not_strained() -> None:
    """By 150 degrees, on the true way there: without force or energy for laws at finite strain."""
    turn = bz.Moved("left", "right", axis=(0, 1, 1), angle=np.radians(150), about=(1, 2, 3))
    body = bz.Body(bz.block(cells=2), 2, bz.NeoHooke(E, NU), [turn])
    solution = bz.solve(body)
    exact = turn.displacement(solution.net.points)
    assert np.abs(solution.displacement.controls - exact).max() < 1e-8
    assert solution.energy < 1e-14
    assert len({each.fraction for each in solution.path}) > 1


@pytest.mark.parametrize("solver", ["direct", "multigrid"])
def test_body_turned_a_whole_turn_is_where_it_was(solver: str) -> None:
    """Forces, ways and their work are all rounding there: nothing to measure the work by."""
    turn = bz.Moved("bottom", axis=(1, 0, 1), angle=2 * np.pi, about=(5, 5, 5))
    found = bz.solve(bz.Body(bz.block(cells=2), 2, bz.NeoHooke(1.0, 0.3), [turn]), solver=solver)
    assert found.path[-1].step == 1 and found.iterations <= 5
    assert np.abs(found.displacement.controls).max() < 1e-14


def test_far_carried_body_converges() -> None:
    """All forces are rounding there, so that nothing may be measured by them alone."""
    body = bz.Body(
        bz.block(), 2, bz.NeoHooke(E, NU), [bz.Moved("left", "right", translation=(50, 0, 0))]
    )
    assert np.abs(controls(body) - (50, 0, 0)).max() < 1e-10


def test_change_of_following_forces_is_their_derivative() -> None:
    net = ControlNet(bz.block(cells=2), 3)
    load = bz.Pressure("top", value=bz.Polynomial.parse("1 + x*y"), following=True)
    pressure = FollowingPressure(net, load, "top")
    u, du = 0.1 * np.sin(5 * net.points), np.cos(9 * net.points)
    h = 1e-5
    slope = (pressure.forces(u + h * du) - pressure.forces(u - h * du)) / (2 * h)
    assert np.allclose((pressure.matrix(u) @ du.ravel()).reshape(-1, 3), slope, atol=1e-9)


def test_closed_surface_under_following_pressure_feels_no_net_force() -> None:
    net = ControlNet(bz.ball(cells=3), 2)
    load = bz.Pressure("outer", value=2.0, following=True)
    f = FollowingPressure(net, load, "outer").forces(0.2 * np.sin(3 * net.points))
    assert np.abs(f.sum(axis=0)).max() < 1e-13


@pytest.mark.parametrize("solver", ["direct", "multigrid"])
def test_cube_pressed_from_all_sides(solver: str) -> None:
    """Cauchy stress is -p, so that P = -p l^2 for the stretch l in all directions."""
    p, mu, lam = 0.3, 2 / 2 / 1.3, 2 * 0.3 / 1.3 / 0.4
    load = bz.Pressure("right", "back", "top", value=p, following=True)
    solution = bz.solve(bz.Body(bz.block(), 2, bz.NeoHooke(2.0, 0.3), SIDES, [load]), solver=solver)
    stretch = 1 + solution.displacement.at(np.ones((1, 3)))[0, 0]
    P = mu * (stretch - 1 / stretch) + 3 * lam * np.log(stretch) / stretch
    assert abs(P + p * stretch**2) < 1e-9
    assert np.allclose(solution.stress.at(np.full((1, 3), 0.4)), -p * np.eye(3), atol=1e-8)


def test_history_has_every_iteration() -> None:
    solution = bz.solve(bent(bz.NeoHooke(E, NU), 2, 1.0), steps=3)
    assert [each.step for each in solution.path] == sorted(each.step for each in solution.path)
    assert {each.step for each in solution.path} == {1, 2, 3}
    assert solution.path[-1].fraction == 1 and solution.path[-1].residual <= 1e-10
    assert solution.path[-1].energy <= 1e-10
    assert solution.history == tuple(each.residual for each in solution.path)


@pytest.mark.parametrize("threads", [1, 2])
def test_reactions_balance_dead_loads(threads: int) -> None:
    body = bz.Body(
        bz.block(size=(3.0, 1.0, 1.0), cells=(3, 1, 1)),
        2,
        bz.NeoHooke(E, NU),
        [bz.Fixed("left")],
        [bz.Traction("right", value=(0, 0, 2e-4))],
    )
    solution = bz.solve(body, threads=threads)
    assert np.abs(solution.reactions["left"].force + (0, 0, 2e-4)).max() < 1e-12


def test_tangent_of_the_core_is_that_over_arrays() -> None:
    from bezsoma.equations.internal import internal_forces

    net = ControlNet(bz.block(cells=2), 3)
    u, du = 0.05 * np.sin(5 * net.points), np.cos(9 * net.points)
    for law in (bz.NeoHooke(E, NU), bz.Stiffening(E, NU, 5.0)):
        compiled, plainly = internal_forces(net, (law,), 8), Pointwise(net, (law,), 8)
        f, df = compiled.forces(u), compiled.tangent(u).apply(du)
        assert np.abs(f - plainly.forces(u)).max() < 1e-13 * np.abs(f).max()
        assert np.abs(df - plainly.tangent(u).apply(du)).max() < 1e-13 * np.abs(df).max()


@pytest.mark.parametrize("solver", ["direct", "multigrid"])
@pytest.mark.parametrize(
    ("law", "force"),
    [
        (bz.NeoHooke(2.0, 0.5), 2 / 3 * (1.4 - 1.4**-2)),
        (bz.MooneyRivlin(0.3, 0.1, np.inf), 2 * (1.4 - 1.4**-2) * (0.3 + 0.1 / 1.4)),
        (bz.Ogden([1.0], [3.0], np.inf), 1.4**2 - 1.4**-2.5),
        (
            bz.VerondaWestmann(0.5, 0.4, np.inf),
            2 * (1.4 - 1.4**-2) * 0.2 * (np.exp(0.4 * (1.4**2 + 2 / 1.4 - 3)) - 0.5 / 1.4),
        ),
    ],
)
def test_incompressible_bar(law: Any, force: float, solver: str) -> None:
    """F = dW/dl with the other stretches l^(-1/2): the textbook's uniaxial formulas."""
    drawn = bz.Moved("top", translation=(0, 0, 0.4), components="z")
    body = bz.Body(bz.block(), 2, law, [*SIDES, drawn], incompressible=True)
    solution = bz.solve(body, solver=solver)
    assert abs(solution.reactions["top"].force[2] - force) < 1e-8
    assert abs(solution.volume_change) < 1e-9
    stress = np.zeros((3, 3))
    stress[2, 2] = 1.4 * force
    assert np.allclose(solution.stress.at(np.full((1, 3), 0.4)), stress, atol=1e-7)


@pytest.mark.parametrize("law", [bz.Stiffening(E, 0.45, 5.0), bz.MooneyRivlin(E, E / 3, 10 * E)])
def test_pressure_of_its_own_gives_the_same_where_strain_is_uniform(law: Any) -> None:
    body = bz.Body(
        bz.block(), 2, law, [*SIDES, bz.Moved("top", translation=(0, 0, 0.3), components="z")]
    )
    one, other = bz.solve(body), bz.solve(replace(body, pressure_degree=1))
    assert apart(other.displacement.controls, one.displacement.controls) < PATH
    assert abs(other.energy - one.energy) < 1e-7 * one.energy or not law.symmetric


@pytest.mark.parametrize(
    ("cells", "solver", "why"),
    [
        (2, "auto", "not more than 3000"),
        (11, "auto", "more than 3000"),
        (2, "direct", "as asked for"),
    ],
)
def test_the_method_says_why_tangents_are_factored_or_not(
    cells: int, solver: str, why: str
) -> None:
    drawn = [bz.Fixed("bottom"), bz.Moved("top", translation=(0, 0, 0.01))]
    body = bz.Body(bz.block(cells=cells), 1, bz.NeoHooke(1.0, 0.3), drawn)
    method = bz.solve(body, solver=solver).method
    assert method.endswith(why) and ("not more" in method) == ("not more" in why)
    assert ("factored (SuperLU)" in method) == (cells == 2)
