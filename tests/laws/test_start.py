# SPDX-License-Identifier: BSD-3-Clause
"""An earlier solution starts the next solve: fewer iterations, the same answer, the same rule."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import bezsoma as bz
from bezsoma.mechanics import Fixed, LinearElastic, Moved, NeoHooke, Pressure, Traction
from bezsoma.mechanics.body import Body
from bezsoma.mesh.field import Field
from bezsoma.mesh.solids import block
from bezsoma.refinement.bisection import bisected
from bezsoma.solvers.solution import Solution
from bezsoma.solvers.solve import solve
from bezsoma.solvers.start import Begun
from tolerances import ENERGY_NORM, ITERATIVE

SUPPORTS = [Fixed("left"), Moved("right", translation=(0.1, -0.2, 0.05))]


def body(degree: int = 2, cells: int = 3, **more: object) -> Body:
    mesh = block((3, 1, 1), cells=(3 * cells, cells, cells), irregular=0.2)
    return Body(mesh, degree, LinearElastic(1.0, 0.4), SUPPORTS, **more)  # type: ignore[arg-type]


def on_finer(solution: Solution) -> tuple[Body, Begun]:
    """The body on a mesh with half of the tets cut, and the same fields there."""
    step = bisected(solution.body.mesh, np.arange(0, len(solution.body.mesh.tets), 4), times=2)
    pressure = solution.pressure and solution.pressure.subdivided(step.into)
    begun = Begun(solution.displacement.subdivided(step.into), pressure)
    return replace(solution.body, mesh=step.mesh), begun


def apart(one: Solution, other: Solution) -> float:
    difference = one.displacement.controls - other.displacement.controls
    return float(np.abs(difference).max() / np.abs(other.displacement.controls).max())


@pytest.mark.parametrize("solver", ["multigrid", "cg"])
def test_a_finer_mesh_needs_fewer_iterations(solver: str) -> None:
    finer, begun = on_finer(solve(body(), solver=solver))
    cold, warm = solve(finer, solver=solver), solve(finer, solver=solver, start=begun)
    assert warm.iterations < 0.9 * cold.iterations
    assert warm.history[0] < 0.5
    assert cold.history[0] == 1.0
    assert warm.residual <= 1e-8
    assert apart(warm, cold) < ITERATIVE


def test_a_higher_degree_and_another_mesh_do_too() -> None:
    earlier = solve(body(), solver="multigrid")
    cold = solve(body(4), solver="multigrid")
    assert solve(body(4), start=earlier, solver="multigrid").iterations < cold.iterations
    elsewhere = body(2, cells=2)
    cold = solve(elsewhere, solver="multigrid")
    warm = solve(elsewhere, start=earlier, solver="multigrid")
    assert warm.iterations < cold.iterations
    assert apart(warm, cold) < ITERATIVE
    lower = solve(body(1), start=earlier, solver="multigrid")
    assert lower.iterations < solve(body(1), solver="multigrid").iterations


def test_what_is_solved_already_takes_no_iteration() -> None:
    earlier = solve(body(), solver="multigrid")
    again = solve(earlier.body, solver="multigrid", start=earlier)
    assert again.iterations == 0
    assert again.residual <= 1e-8
    assert apart(again, earlier) < ENERGY_NORM


def test_a_start_is_no_answer() -> None:
    """The rule is relative to zero free displacement: a bad start is iterated away."""
    plain = body()
    net = solve(plain, solver="multigrid").net
    draw = np.random.default_rng(0).standard_normal((net.count, 3))
    wild = Begun(Field(net, draw))
    warm, cold = solve(plain, solver="multigrid", start=wild), solve(plain, solver="direct")
    assert warm.history[0] > 1
    assert warm.residual <= 1e-8
    assert apart(warm, cold) < ITERATIVE
    direct = solve(plain, solver="direct", start=wild)
    assert direct.displacement.controls.tobytes() == cold.displacement.controls.tobytes()


@pytest.mark.parametrize("breaks", [False, True])
def test_both_equations_start_together(breaks: bool) -> None:
    water = LinearElastic(1.0, 0.5)
    soft = replace(body(cells=2), materials=water, pressure_degree=1, pressure_breaks=breaks)
    mesh = soft.mesh
    half = (mesh.points[mesh.tets].mean(axis=1)[:, 0] > 1.5).astype(int)
    two = bz.TetMesh(mesh.points, mesh.tets, half, ("a", "b"), dict(mesh.surfaces))
    stiff = LinearElastic(3.0, 0.5)
    soft = replace(soft, mesh=two, materials={"a": water, "b": stiff})
    finer, begun = on_finer(solve(soft, solver="saddle"))
    cold, warm = solve(finer, solver="saddle"), solve(finer, solver="saddle", start=begun)
    assert warm.iterations < cold.iterations
    assert warm.history[0] < 0.5
    assert warm.residual <= 1e-8
    assert apart(warm, cold) < ITERATIVE
    assert warm.pressure is not None
    assert cold.pressure is not None
    assert type(warm.pressure) is type(cold.pressure)
    off = np.abs(warm.pressure.controls - cold.pressure.controls).max()
    assert off < 1e-5 * np.abs(cold.pressure.controls).max()
    again = solve(finer, solver="saddle", start=warm)
    assert again.iterations == 0
    assert again.residual <= 1e-8


def bent(**more: object) -> Body:
    mesh = block((4, 1, 1), cells=(3, 1, 1))
    load = Traction("right", value=(0, 0, 0.01))
    return Body(mesh, 2, NeoHooke(1.0, 0.4), [Fixed("left")], [load], **more)  # type: ignore[arg-type]


@pytest.mark.parametrize("mixed", [False, True])
@pytest.mark.parametrize("solver", ["direct", "multigrid"])
def test_newton_starts_near_the_whole_load(mixed: bool, solver: str) -> None:
    earlier = solve(bent(incompressible=mixed), solver=solver)
    finer, begun = on_finer(earlier)
    cold, warm = solve(finer, solver=solver), solve(finer, solver=solver, start=begun)
    assert len(warm.path) < len(cold.path)
    assert warm.residual <= 1e-10
    assert apart(warm, cold) < ITERATIVE
    again = solve(finer, solver=solver, start=warm)
    assert [step.linear for step in again.path] == [0]
    assert 0 < again.residual <= 1e-10


def test_newton_goes_back_to_rest_where_a_start_fails() -> None:
    plain = bent()
    cold = solve(plain)
    inside_out = Begun(Field.interpolating(cold.net, lambda x: -2.0 * x))
    warm = solve(plain, start=inside_out)
    assert "no start" in warm.path[0].events[0]
    assert apart(warm, cold) < ITERATIVE


def test_loads_that_follow_start_too() -> None:
    plain = replace(bent(), loads=[Pressure("top", value=0.005, following=True)])
    finer, begun = on_finer(solve(plain))
    cold, warm = solve(finer), solve(finer, start=begun)
    assert len(warm.path) < len(cold.path)
    assert apart(warm, cold) < ITERATIVE


def test_any_number_of_threads_gives_the_same_bits() -> None:
    finer, begun = on_finer(solve(body(cells=2), solver="multigrid"))
    bits = {
        solve(finer, solver="multigrid", start=begun, threads=n).displacement.controls.tobytes()
        for n in (1, 2, 3)
    }
    assert len(bits) == 1


@pytest.mark.parametrize("start", [3, "previous", body()])
def test_what_is_no_start_is_refused(start: object) -> None:
    with pytest.raises(bz.InputError, match="a solve starts from what has a displacement"):
        solve(body(), start=start)  # type: ignore[arg-type]


def test_a_start_of_no_numbers_is_refused() -> None:
    net = solve(body(1, cells=1)).net
    nothing = np.full((net.count, 3), np.nan)
    with pytest.raises(bz.InputError, match="three finite components"):
        solve(body(1, cells=1), start=Begun(Field(net, nothing)))
