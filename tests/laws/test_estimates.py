# SPDX-License-Identifier: BSD-3-Clause
"""Estimated errors beside true ones, where these are known or taken from a much richer answer."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import tolerances
from bezsoma.arrays import Floats
from bezsoma.equations.forces import forces
from bezsoma.equations.matrix_free import MatrixFree
from bezsoma.errors import InputError, NotConverged
from bezsoma.mechanics import Fixed, LinearElastic, Moved, PointForce, Precedence, Prescribed
from bezsoma.mechanics.body import Body
from bezsoma.mechanics.hyperelastic import NeoHooke
from bezsoma.mechanics.loads import BodyForce, Traction
from bezsoma.mechanics.polynomial import Polynomial
from bezsoma.mechanics.stiffening import Stiffening
from bezsoma.mesh.control_net import ControlNet
from bezsoma.mesh.field import Field
from bezsoma.mesh.solids import block, cook, l_block
from bezsoma.mesh.tets import TetMesh
from bezsoma.refinement.estimates import (
    GoalEstimate,
    energy_estimate,
    goal_estimate,
    vector_estimate,
)
from bezsoma.refinement.goals import InnerMean, PatchMean, SurfaceMean
from bezsoma.refinement.means import mean, weights
from bezsoma.refinement.raised import raised
from bezsoma.solvers.solution import Solution
from bezsoma.solvers.solve import solve

TOP = PatchMean("top", at=(0.45, 0.55, 1.0), radius=0.3, direction="z")
LOAD = Traction("top", value=Polynomial.parse(["0.1*x", 0, "-0.2*y"]))


def loaded(degree: int, law: object, cells: int = 2, **how: object) -> Body:
    """A cube on a fixed floor with a traction on top."""
    return Body(block(cells=cells, irregular=0.2), degree, law, [Fixed("bottom")], [LOAD], **how)


def pressed(degree: int, law: object, **how: object) -> Body:
    """A quarter of a block, pressed smoothly from above: nothing in it is singular."""
    load = Traction("top", value=Polynomial.parse([0, 0, "-0.3*(1-x^2)^2*(1-y^2)^2"]))
    held = [Fixed(place, components=axis) for place, axis in zip(SIDES, "xyz", strict=True)]
    return Body(block(cells=2, irregular=0.2), degree, law, held, [load], **how)


SIDES = ("left", "front", "bottom")


def potential(solution: Solution) -> float:
    """The stored energy less the work of the loads, N mm."""
    work = forces(solution.body, solution.net) * solution.displacement.controls
    return solution.energy - float(work.sum())


def effectivity(found: GoalEstimate, true: float) -> float:
    """Estimated over true error, both against what can be told at all."""
    floor = 0.01 * found.product
    return max(abs(found.error), floor) / max(abs(true), floor)


def waves(x: Floats) -> Floats:
    """A displacement without change of volume: -div stress = mu (2^2 + 3^2) u."""
    s, c = np.sin(2 * x), np.cos(3 * x)
    return np.column_stack([s[:, 1] * c[:, 2], s[:, 2] * c[:, 0], s[:, 0] * c[:, 1]])


@pytest.mark.parametrize(("degree", "cells"), [(1, 6), (2, 2), (3, 2), (4, 1)])
def test_a_known_displacement(degree: int, cells: int) -> None:
    """Smooth, all of the boundary prescribed by a function: no degree meets it exactly."""
    mesh, law = block(cells=cells, irregular=0.3), LinearElastic(E=1.04, nu=0.3)
    held = [Prescribed(side, value=waves) for side in mesh.surfaces]
    body = Body(mesh, degree, law, held, [BodyForce(lambda x: 0.4 * 13 * waves(x))])
    solution = solve(body)
    found = energy_estimate(solution)
    net = ControlNet(mesh, 7)
    exact = net.interpolated(waves)
    lacking = (exact - net.elevated(solution.displacement.controls, solution.net)).ravel()
    true = MatrixFree(net, np.array([[law.lam, law.mu]])).energy(lacking.reshape(-1, 3))
    assert abs(math.sqrt(found.total / true) - 1) < tolerances.SMOOTH_EFFECTIVITY
    assert abs(found.of_tet.sum() - found.total) < 1e-12 * found.total
    goal = InnerMean(at=(0.45, 0.5, 0.4), radius=0.3, direction="x")
    judged = goal_estimate(solution, goal)
    assert 0.5 < effectivity(judged, mean(goal, Field(net, exact)) - judged.value) < 2


def l_pulled(degree: int, cells: int = 2, power: float = 1.0) -> Body:
    """The L, on rollers at one end and pulled at the other; graded towards its corner."""
    mesh = l_block(cells=cells)
    _, (points, *rest) = mesh.__reduce__()
    flat = np.sign(points[:, :2]) * np.abs(points[:, :2]) ** power
    mesh = TetMesh(np.column_stack([flat, points[:, 2]]), *rest)
    rollers = [("right", "x"), ("front", "y"), ("bottom", "z"), ("top", "z")]
    held = [Fixed(place, components=axis) for place, axis in rollers]
    load = [Traction("left", value=(-0.1, 0.02, 0))]
    return Body(mesh, degree, LinearElastic(E=1.0, nu=0.3), held, load)


@pytest.fixture(scope="module")
def l_truth() -> tuple[float, float]:
    """The potential and the goal of the L on a mesh graded towards its corner."""
    solution = solve(l_pulled(5, 4, 3.0))
    return potential(solution), mean(L_GOAL, solution.displacement)


L_GOAL = PatchMean("back", at=(0, 1, 0.5), radius=0.4, direction="x")


@pytest.mark.parametrize("degree", [2, 3, 4])
def test_beside_a_singular_edge(degree: int, l_truth: tuple[float, float]) -> None:
    """Where two more degrees see 0.77 of the error at degree 4, and the rest has to be told."""
    solution = solve(l_pulled(degree))
    true = potential(solution) - l_truth[0]
    found = energy_estimate(solution)
    assert 0.9 < math.sqrt(found.total / true) < 1.1
    judged = goal_estimate(solution, L_GOAL)
    assert 0.5 < effectivity(judged, l_truth[1] - judged.value) < 2
    assert abs(judged.error) < judged.product


def test_the_goal_of_the_load_is_the_energy() -> None:
    """Cook: the mean over the loaded side is the work of the load, its dual the solution itself."""
    held = [Fixed("clamped"), Fixed("front", "back", components="z")]
    load = [Traction("loaded", value=(0, 1 / 16, 0))]
    body = Body(cook(cells=(4, 4, 1)), 2, LinearElastic(E=1.0, nu=1 / 3), held, load)
    solution = solve(body)
    energy = energy_estimate(solution)
    judged = goal_estimate(solution, SurfaceMean("loaded", direction="y"))
    assert abs(judged.value - 2 * solution.energy) < 1e-8 * judged.value
    assert abs(judged.error / (2 * energy.total) - 1) < tolerances.LOOSE_SOLVES
    assert abs(judged.product / (2 * energy.total) - 1) < tolerances.LOOSE_SOLVES
    assert abs(judged.of_tet.sum() - 2 * raised(solution).gain) < 0.05 * judged.error


def test_what_is_solved_exactly_has_no_error() -> None:
    mesh = block(cells=2, irregular=0.3)
    stretch = Polynomial.parse(["0.1*x+0.02*y", 0, "-0.03*z"])
    held = [Prescribed(side, value=stretch) for side in mesh.surfaces]
    solution = solve(Body(mesh, 2, LinearElastic(E=1.0, nu=0.3), held))
    assert energy_estimate(solution).relative < 1e-6
    assert abs(goal_estimate(solution, TOP).error) < 1e-9


@pytest.mark.parametrize(
    ("law", "how"),
    [
        (LinearElastic(E=1.0, nu=0.5), {"incompressible": True}),
        (LinearElastic(E=1.0, nu=0.45), {"pressure_degree": 1}),
        (NeoHooke(E=1.0, nu=0.3), {}),
        (NeoHooke(E=1.0, nu=0.5), {"incompressible": True}),
        (Stiffening(E=1.0, nu=0.3, A=3.0), {}),
    ],
    ids=["incompressible", "mixed", "neo-Hooke", "neo-Hooke, mixed", "stiffening"],
)
def test_other_forms_beside_a_richer_answer(law: object, how: dict[str, Any]) -> None:
    """Mixed forms, and bodies that are not linear, beside the same body in degree 5."""
    higher = {**how, "pressure_degree": 4} if how else {}
    solution, truth = solve(pressed(2, law, **how)), solve(pressed(5, law, **higher))
    richer = raised(solution)
    found = energy_estimate(solution, richer=richer)
    high, exact = raised(solution, 3), raised(truth, 0)
    net = high.pressures
    assert net is None or net.degree == 4
    true = high.square(exact.written - high.written)
    assert 0.7 < math.sqrt(found.total / true) < 1.5
    for goal in (TOP, PatchMean("right", at=(1, 0.3, 0.6), radius=0.4, direction="x")):
        judged = goal_estimate(solution, goal, richer=richer)
        assert 0.5 < effectivity(judged, mean(goal, truth.displacement) - judged.value) < 2


@pytest.mark.parametrize(
    ("law", "how"),
    [
        (LinearElastic(E=1.0, nu=0.3), {}),
        (LinearElastic(E=1.0, nu=0.5), {"incompressible": True}),
        (NeoHooke(E=1.0, nu=0.3), {}),
    ],
    ids=["linear", "incompressible", "neo-Hooke"],
)
def test_a_vector_lacks_what_its_components_do(law: object, how: dict[str, Any]) -> None:
    """Beside three goals, and beside the truth of a higher degree."""
    higher = {**how, "pressure_degree": 4} if how else {}
    solution, truth = solve(pressed(2, law, **how)), solve(pressed(5, law, **higher))
    richer = raised(solution)
    found = vector_estimate(solution, TOP, richer=richer)
    goals = [replace(TOP, direction=axis) for axis in "xyz"]
    single = [goal_estimate(solution, goal, richer=richer) for goal in goals]
    assert np.allclose(found.value, [each.value for each in single], rtol=1e-12, atol=0)
    apart = np.abs(found.error - [each.error for each in single])
    assert (apart < 0.02 * np.array([each.product for each in single])).all()
    along = found.along.goal.direction @ found.error  # rates turn the error a little
    assert along == pytest.approx(np.linalg.norm(found.error), rel=0.01)
    true = [
        mean(goal, truth.displacement) - each.value
        for goal, each in zip(goals, single, strict=True)
    ]
    floor = 0.01 * found.along.product
    assert 0.5 < found.size / max(float(np.linalg.norm(true)), floor) < 2


def test_what_a_loose_solve_leaves_counts_by_the_dual() -> None:
    """A correction that is a fifth too short tells nearly the same error of a goal."""
    solution = solve(pressed(2, LinearElastic(E=1.0, nu=0.3)))
    whole, short = raised(solution), raised(solution)
    for each, full in ((short.between, whole.between), (short, whole)):
        vars(each)["step"] = 0.8 * full.step
    told, again = (goal_estimate(solution, TOP, richer=each).error for each in (whole, short))
    assert again == pytest.approx(told, rel=0.03)


def test_an_energy_is_wrong_by_that_of_what_was_left_alone() -> None:
    """A step that is a fifth too short has 0.64 of the energy; 0.96 of it is told."""
    richer = raised(solve(pressed(2, LinearElastic(E=1.0, nu=0.3))))
    exact = richer.tangent.solve(richer.residual, 1e-12).dx
    vars(richer)["step"] = 0.8 * exact
    assert richer.gain == pytest.approx(0.96 * richer.square(exact), rel=1e-8)


def test_one_degree_up_is_enough_at_degree_1() -> None:
    """Beside two degrees up: what one sees and a fixed rest come to nearly the same."""
    solution = solve(loaded(1, LinearElastic(E=1.0, nu=0.3), 4))
    richer = raised(solution)
    assert richer.body.degree == 2
    more = energy_estimate(solution, richer=raised(solution, 2))
    assert energy_estimate(solution, richer=richer).relative == pytest.approx(more.relative, 0.1)
    one, two = (goal_estimate(solution, TOP, richer=r) for r in (richer, raised(solution, 2)))
    assert abs(one.error - two.error) < 0.1 * two.product


def test_a_patch_smaller_than_the_tets_has_a_dual_that_comes_slowly() -> None:
    """The product counts the dual's own rest: by the other rate it were 0.62 of it."""
    law, goal = LinearElastic(E=1.0, nu=0.3), replace(TOP, radius=0.15)

    def dual_energy(body: Body) -> float:
        base = raised(solve(body), 0)
        load = weights(goal, base.net).ravel()
        return float(load @ base.dual(load)) / 2

    coarse = loaded(3, law, 1)
    lacking = dual_energy(loaded(4, law, 4)) - dual_energy(coarse)
    solution = solve(coarse)
    found = goal_estimate(solution, goal)
    dual = (found.product / 2) ** 2 / energy_estimate(solution).total
    assert 0.75 < math.sqrt(dual / lacking) < 1.35


def test_threads_do_not_show() -> None:
    solution = solve(loaded(2, LinearElastic(E=1.0, nu=0.3)), threads=1)
    one, two = (energy_estimate(solution, threads=n) for n in (1, 2))
    assert (one.of_tet == two.of_tet).all()


def test_the_highest_degrees_are_refused() -> None:
    body = Body(block(), 9, LinearElastic(E=1.0, nu=0.3), [Fixed("bottom")], [LOAD])
    with pytest.raises(InputError, match="degree 11"):
        energy_estimate(solve(body))


def test_an_error_that_no_iteration_finds_is_said() -> None:
    """The solution was factored, which no estimate is: it may not be told to take that solver."""
    body = Body(block(cells=4), 1, LinearElastic(E=1.0, nu=0.4999999), [Fixed("bottom")], [LOAD])
    solution = solve(body, solver="direct", rtol=1e-6)
    with pytest.raises(NotConverged, match="iterations left") as said:
        goal_estimate(solution, TOP)
    assert "incompressible=True" in str(said.value)
    assert "direct" not in str(said.value)
    assert said.value.history[0] == 1


def test_what_has_no_finite_energy_is_said() -> None:
    law = LinearElastic(E=1.0, nu=0.3)
    force = PointForce((1.0, 1.0, 1.0), (0, 0, -1))
    pushed = solve(Body(block(cells=2), 1, law, [Fixed("bottom")], [force]))
    assert "a point force acts at (1, 1, 1) mm" in energy_estimate(pushed).warnings[0]
    assert goal_estimate(pushed, TOP).warnings == energy_estimate(pushed).warnings
    held = [Fixed("bottom"), Moved("left", translation=(0, 0, 0.1))]
    join = [Precedence("left", over="bottom")]
    torn = solve(Body(block(cells=2), 1, law, held, [], join))
    assert "jumps by 0.1 mm" in energy_estimate(torn).warnings[0]
    assert energy_estimate(solve(loaded(1, law))).warnings == ()


def test_a_support_of_points_is_named_only_where_it_bears() -> None:
    law, mesh = LinearElastic(E=1.0, nu=0.3), block(cells=2)
    mesh = mesh.with_vertices("corners", [(0, 0, 0), (1, 0, 0), (0, 1, 0)])
    hung = solve(Body(mesh, 1, law, [Fixed("corners")], [LOAD]))
    assert "'corners' is a vertex" in energy_estimate(hung).warnings[0]
    both = [Traction(side, value=(0, 0, s)) for side, s in (("top", 0.1), ("bottom", -0.1))]
    balanced = solve(Body(mesh, 1, law, [Fixed("corners", components="z")] + IN_PLANE, both))
    assert energy_estimate(balanced).warnings == ()


IN_PLANE = [Fixed("left", components="x"), Fixed("front", components="y")]
