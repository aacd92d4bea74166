# SPDX-License-Identifier: BSD-3-Clause
"""Newton from the answer of degree 1: sooner there, and at the same place."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import bezsoma as bz
from bezsoma.arrays import Floats
from bezsoma.errors import Inadmissible
from bezsoma.solvers import nonlinear
from bezsoma.solvers.load_steps import loaded
from bezsoma.solvers.newton import (
    Balance,
    Breakdown,
    Correction,
    Rule,
    System,
    TangentFailed,
    equilibrium,
)

SAME = 1e-8
"""Two ways to the same answer, each stopped at a residual of 1e-10."""


def drawn(law: Any, cells: int = 6, degree: int = 2, shift: Any = (0, 0, 0.38)) -> bz.Body:
    """A block drawn out by 38 %."""
    supports = [bz.Fixed("bottom"), bz.Moved("top", translation=shift)]
    return bz.Body(bz.block(cells=cells), degree, law, supports)


@pytest.mark.parametrize("law", [bz.Stiffening(1.0, 0.4, 5.0), bz.NeoHooke(1.0, 0.4)])
def test_it_is_there_sooner(law: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """38 % in one step of the load: at most six iterations, fewer than from rest."""
    sooner = bz.solve(drawn(law), solver="multigrid", steps=1)
    monkeypatch.setattr(nonlinear, "_of_degree_one", lambda *how: None)
    later = bz.solve(drawn(law), solver="multigrid", steps=1)
    assert sooner.iterations <= min(6, later.iterations)
    assert sum(each.linear for each in sooner.path) < sum(each.linear for each in later.path)
    difference = np.abs(sooner.displacement.controls - later.displacement.controls).max()
    assert difference < SAME * 0.38


def test_another_branch_of_degree_one_is_not_begun_with() -> None:
    """Pressed by 30 % this law gives way at degree 1; there the tangent of degree 3 has no sign."""
    law = bz.StVenantKirchhoff(1.0, 0.3)
    body = drawn(law, cells=2, degree=3, shift=(0, 0, -0.3))
    found, exact = (bz.solve(body, solver=each, steps=1) for each in ("multigrid", "direct"))
    difference = np.abs(found.displacement.controls - exact.displacement.controls).max()
    assert difference < SAME * 0.3


def test_body_that_is_carried_along_has_no_strain_to_judge_by() -> None:
    """All forces are rounding: they are measured by what the moved supports alone would exert."""
    turn = {"axis": (0, 0, 1), "about": (0, 0, 0), "angle": 0.3}
    supports = [bz.Moved("bottom", "top", translation=(3, 4, 5), **turn)]
    body = bz.Body(bz.block(cells=2), 2, bz.NeoHooke(1.0, 0.3), supports)
    found = bz.solve(body, solver="multigrid", steps=1)
    assert found.residual <= 1e-10 and found.energy < 1e-18


def test_supports_that_hold_every_vertex() -> None:
    """Then degree 1 has nothing to say."""
    sides = ("left", "right", "front", "back", "bottom", "top")
    value = bz.Polynomial.parse(["0.2*x*x", 0, "0.1*y*z"])
    body = bz.Body(bz.block(), 3, bz.NeoHooke(1.0, 0.3), [bz.Prescribed(*sides, value=value)])
    assert bz.solve(body, solver="multigrid").residual <= 1e-10


class Spring:
    """x^3 = t, whose tangent is 3 x^2."""

    def __init__(self, x: Floats) -> None:
        self.slope = 3 * x**2

    def product(self, dx: Floats) -> Floats:
        return self.slope * dx

    def solve(self, b: Floats, rtol: float) -> Correction:
        return Correction(b / self.slope, 1)


class Tired(Spring):
    """The same, but it cannot be solved with to more than a thousandth."""

    def solve(self, b: Floats, rtol: float) -> Correction:
        if rtol < 1e-3:
            raise Breakdown(f"{rtol:g} is too much")
        return Correction(b / self.slope * (1 - 0.9 * rtol), 1)


def test_a_solve_that_does_not_come_as_far_as_asked_still_serves() -> None:
    """Newton's residual is what has to come down; the path says that the solve did not."""
    held, parts = np.zeros(1, bool), (slice(0, 1),)
    system = System(held, parts, (1.0,), lambda t: np.zeros(1), cubic, lambda x, t: Tired(x))
    path: list[Any] = []
    found = equilibrium(system, np.full(1, 2.0), 1.0, 1, Rule(1e-10), path.append)
    assert abs(found[0] - 1) < 1e-10
    assert any("solved to 2 % only: " in event for each in path for event in each.events)


def test_on_the_way_from_degree_one_no_tangent_may_be_other_than_it_should() -> None:
    """What serves on the way of the load might lead to another state from there."""
    held, parts = np.zeros(1, bool), (slice(0, 1),)
    system = System(held, parts, (1.0,), lambda t: np.zeros(1), cubic, lambda x, t: Tired(x))
    near = np.full(1, 2.0)
    with pytest.raises(TangentFailed, match="solved to 2 % only"):
        equilibrium(system, np.full(1, 9.0), 1.0, 1, Rule(1e-10), lambda each: None, near)


class Astray(Spring):
    """The same, but beyond 5 nothing is found."""

    def solve(self, b: Floats, rtol: float) -> Correction:
        if self.slope > 75:
            raise Breakdown("beyond 5")
        return Correction(b / self.slope, 1)


@pytest.mark.parametrize("steps", [(1.0,), None])
def test_a_start_that_leads_nowhere_does_no_harm(steps: Any) -> None:
    """From rest it is found, at the whole load, and the path says so."""
    held, parts = np.zeros(1, bool), (slice(0, 1),)
    system = System(
        held,
        parts,
        (1.0,),
        lambda t: np.zeros(1),
        cubic,
        lambda x, t: Astray(x),
        near=lambda t: np.full(1, 8.0),
    )
    reached = loaded(system, np.full(1, 2.0), steps, Rule(1e-10), lambda each: None)
    assert reached.fraction == 1 and abs(reached.x[0] - 1) < 1e-10
    assert {each.fraction for each in reached.path} == {1.0}
    assert reached.path[0].events[0].startswith("the answer of degree 1 was no start")
    assert "beyond 5" in reached.path[0].events[0]


def cubic(x: Floats, t: float) -> Balance:
    if x[0] > 10:
        raise Inadmissible("beyond 10", "J", 0.0, 0, "", (0.0, 0.0, 0.0))
    return Balance(t - x**3, (t,), 1.0)


@pytest.mark.parametrize(("near", "most"), [(1.001, 3), (20.0, 40)])
def test_a_state_that_cannot_be_is_not_begun_with(near: float, most: int) -> None:
    """From near the answer it takes three iterations; beyond 10 it begins where it was."""
    held, parts = np.zeros(1, bool), (slice(0, 1),)
    system = System(held, parts, (1.0,), lambda t: np.zeros(1), cubic, lambda x, t: Spring(x))
    path: list[Any] = []
    found = equilibrium(system, np.full(1, 9.0), 1.0, 1, Rule(1e-12), path.append, np.full(1, near))
    assert abs(found[0] - 1) < 1e-12 and len(path) <= most
    assert (len(path) > 5) == (near > 10)
