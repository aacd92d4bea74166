# SPDX-License-Identifier: BSD-3-Clause
"""What the mixed form refuses: it says what was given, why it cannot be, and what can."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import bezsoma as bz
from bezsoma.mesh import TetMesh, block

SIDES = ("left", "right", "front", "back", "bottom", "top")
WATER = bz.LinearElastic(E=0.015, nu=0.5)
BOTTOM = [bz.Fixed("bottom")]


def body(degree: int = 2, law: Any = WATER, supports: Any = BOTTOM, **more: Any) -> bz.Body:
    return bz.Body(block(cells=2), degree, law, supports, **more)


def swollen(shift: str = "0.01*x", nu: float = 0.5) -> bz.Solution:
    """All of the boundary pushed apart along x."""
    value = bz.Polynomial.parse([shift, 0, 0])
    held = [bz.Prescribed(*SIDES, value=value)]
    return bz.solve(body(2, bz.LinearElastic(1.0, nu), held, incompressible=True))


def cornered(degree: int) -> bz.Solution:
    """One tet held on three of its facets, the fourth between it and another."""
    points = np.vstack([np.zeros(3), np.eye(3), np.ones(3)])
    mesh = TetMesh(points, [[0, 1, 2, 3], [1, 2, 3, 4]])
    mesh = mesh.with_surface("corner", [[0, 1, 2], [0, 1, 3], [0, 2, 3]])
    load = [bz.PointForce((1.0, 1.0, 1.0), (0, 0, 0.1))]
    given = bz.Body(mesh, degree, WATER, [bz.Fixed("corner")], load, incompressible=True)
    return bz.solve(given)


class Jelly:
    """Something that is a material, and does not split into a shape and a volume."""

    linear = symmetric = True

    def stress(self, H: Any) -> Any:
        return H


Given = Callable[[], object]
REFUSED: dict[str, tuple[Given, tuple[str, ...]]] = {
    "nu of 1/2 without a pressure": (
        body,
        ("region 'tissue' has nu = 1/2", "incompressible=True", "nu up to 0.49"),
    ),
    "nu of 1/2 at degree 1": (lambda: body(1), ("nu = 1/2", "degree=2, incompressible=True")),
    "equal degrees": (
        lambda: body(pressure_degree=2),
        ("degree = 2 with pressure_degree = 2", "equal degree", "pressure_degree=1"),
    ),
    "P3/P3": (
        lambda: body(3, pressure_degree=3),
        ("inf-sup constant falls", "from 1 to 2 (2 is best)"),
    ),
    "a higher pressure degree": (
        lambda: body(2, pressure_degree=4),
        ("pressure_degree = 4", "more pressures than displacements", "pressure_degree=1"),
    ),
    "P1/P1": (
        lambda: body(1, pressure_degree=1),
        ("degree = 1 with a pressure", "P1/P1", "degree=2 with pressure_degree=1"),
    ),
    "incompressible at degree 1": (
        lambda: body(1, incompressible=True),
        ("linear displacements are too few", "degree=2 with pressure_degree=1"),
    ),
    "a constant pressure a tet": (
        lambda: body(3, pressure_degree=0),
        ("pressure_degree = 0", "constant on each tet", "from 1 to 2"),
    ),
    "a pressure of negative degree": (
        lambda: body(pressure_degree=-1),
        ("pressure_degree = -1", "no such degree"),
    ),
    "half a degree": (lambda: body(pressure_degree=1.5), ("1.5", "whole number")),
    "a degree as text": (lambda: body(pressure_degree="1"), ("'1'", "whole number")),
    "a truth value as a degree": (lambda: body(pressure_degree=True), ("True", "whole number")),
    "incompressible as a word": (
        lambda: body(incompressible="yes"),
        ("incompressible = 'yes'", "True or False"),
    ),
    "degree 9": (lambda: body(9, incompressible=True), ("degree = 9", "2 to 8")),
    "a break without a pressure": (
        lambda: body(law=bz.LinearElastic(1.0, 0.3), pressure_breaks=True),
        ("pressure_breaks = True", "no pressure", "incompressible=True"),
    ),
    "another law": (
        lambda: body(law=Jelly(), incompressible=True),
        ("Jelly", "cannot stand beside a pressure", "leave pressure_degree out", "NeoHooke"),
    ),
    "a net flux": (
        swollen,
        ("nu = 1/2", "by 0.01 mm3", "(0.01 of it", "prescribe displacements whose net flux"),
    ),
    "a tiny net flux": (lambda: swollen("1 + 1e-9*x"), ("by 1e-09 mm3", "net flux is zero")),
    "a solver for displacements alone": (
        lambda: bz.solve(body(incompressible=True), solver="multigrid"),
        ("'multigrid'", "displacement alone", "'saddle'"),
    ),
    "a solver for pressures without one": (
        lambda: bz.solve(body(law=bz.LinearElastic(1.0, 0.3)), solver="saddle"),
        ("'saddle'", "this one has none", "'multigrid'"),
    ),
    "rigid motions": (
        lambda: bz.solve(body(supports=[], incompressible=True)),
        ("can still translate",),
    ),
    "tets without any freedom": (
        lambda: cornered(2),
        ("boundary of 1 tet is", "nothing is left to determine the pressure", "unlocked(body)"),
    ),
    "the stress of a displacement at nu = 1/2": (
        lambda: WATER.stress(np.eye(3)),
        ("nu = 1/2", "deviatoric_stress(H) - p I"),
    ),
    "tets to split that are not there": (
        lambda: bz.split(block(), [6]),
        ("tets to split name tet 6", "0 to 5"),
    ),
}


@pytest.mark.parametrize("fault", REFUSED)
def test_the_message_says_what_was_given_and_what_can_be_done(fault: str) -> None:
    given, said = REFUSED[fault]
    with pytest.raises(bz.InputError) as caught:
        given()
    assert [phrase for phrase in said if phrase not in str(caught.value)] == [], str(caught.value)


def test_what_is_close_to_a_fault_is_accepted() -> None:
    """A flux that nu < 1/2 can take, and a boundary moved without any."""
    assert swollen(nu=0.4999).volume_change == pytest.approx(0.01)
    assert swollen("0.01*y").volume_change == pytest.approx(0, abs=1e-15)


def test_a_cornered_tet_is_solved_once_it_is_split() -> None:
    points = np.vstack([np.zeros(3), np.eye(3), np.ones(3)])
    mesh = TetMesh(points, [[0, 1, 2, 3], [1, 2, 3, 4]])
    mesh = mesh.with_surface("corner", [[0, 1, 2], [0, 1, 3], [0, 2, 3]])
    load = [bz.PointForce((1.0, 1.0, 1.0), (0, 0, 0.1))]
    given = bz.Body(mesh, 2, WATER, [bz.Fixed("corner")], load, incompressible=True)
    solution = bz.solve(bz.unlocked(given), solver="direct")
    assert solution.held_tets == 0
    assert solution.residual < 1e-12
    assert np.abs(solution.reactions["corner"].force + [0, 0, 0.1]).max() < 1e-12


@pytest.mark.parametrize("load", [1e-200, 1.0])
def test_tiny_loads_have_answers_in_proportion(load: float) -> None:
    """Squares of 1e-200 are none; the direct solver divided by their sum."""
    pull = [bz.Traction("top", value=(load, 0, 0))]
    solution = bz.solve(body(loads=pull, incompressible=True), solver="direct")
    assert solution.residual < 1e-12
    assert solution.pressure is not None
    assert 0.1 < np.abs(solution.pressure.at(np.full((1, 3), 0.3)))[0] / load < 10


def test_a_huge_load_is_said_to_leave_the_range() -> None:
    pull = [bz.Traction("top", value=(1e200, 0, 0))]
    with pytest.raises(bz.InputError, match="leave the range of floating-point numbers"):
        bz.solve(body(loads=pull, incompressible=True), solver="direct")
