# SPDX-License-Identifier: BSD-3-Clause
"""One block drawn, pulled two ways, sheared and blown up: every law against its closed form."""

from __future__ import annotations

import numpy as np
import pytest

import bezsoma as bz
from laws.law_table import LAWS

HELD = [
    bz.Fixed(place, components=axis)
    for place, axis in (("left", "x"), ("front", "y"), ("bottom", "z"))
]
SIDES = (("right", "x"), ("back", "y"), ("top", "z"))
CLOSED = 1e-9
"""Newton stops at a residual of 1e-12; the closed form's own roots at some 1e-14."""
EVERY = pytest.mark.parametrize("name", LAWS)
WAYS = pytest.mark.parametrize("way", ["built", "plain"])


def law_of(name: str, way: str) -> bz.FunctionLaw:
    """The law of the core, or the same as a user's."""
    return LAWS[name].built() if way == "built" else LAWS[name].plain


def stretched(law: object, stretches: dict[int, float], degree: int = 1) -> bz.Solution:
    """A unit block with some sides moved so that it is stretched, the others free."""
    moved = []
    for axis, stretch in stretches.items():
        shift = np.zeros(3)
        shift[axis] = stretch - 1
        moved.append(bz.Moved(SIDES[axis][0], translation=shift, components=SIDES[axis][1]))
    body = bz.Body(bz.block(), degree, law, HELD + moved)
    return bz.solve(body, solver="direct", rtol=1e-12)


@WAYS
@EVERY
@pytest.mark.parametrize(
    "given", [{2: 1.3}, {2: 0.75}, {1: 1.2, 2: 1.1}, {0: 1.15, 1: 0.9, 2: 1.2}]
)
def test_stretches_and_forces(name: str, way: str, given: dict[int, float]) -> None:
    entry = LAWS[name]
    s = entry.stretches(given)
    P = entry.stresses(s)
    solution = stretched(law_of(name, way), given)
    corner = solution.displacement.at(np.ones((1, 3)))[0]
    assert np.abs(corner - (s - 1)).max() < CLOSED
    for axis, (place, _) in enumerate(SIDES):
        if axis in given:
            assert abs(solution.reactions[place].force[axis] - P[axis]) < CLOSED * np.abs(P).max()


@WAYS
@EVERY
def test_blown_up(name: str, way: str) -> None:
    solution = stretched(law_of(name, way), dict.fromkeys(range(3), 1.1), degree=2)
    P = LAWS[name].stresses(np.full(3, 1.1))
    for axis, (place, _) in enumerate(SIDES):
        assert abs(solution.reactions[place].force[axis] - P[axis]) < CLOSED * np.abs(P).max()


@WAYS
@EVERY
def test_simple_shear(name: str, way: str) -> None:
    value = bz.Polynomial.parse(["0.4*y", 0, 0])
    sides = ("left", "right", "front", "back", "bottom", "top")
    body = bz.Body(bz.block(), 2, law_of(name, way), [bz.Prescribed(*sides, value=value)])
    solution = bz.solve(body, solver="direct", rtol=1e-12)
    stress = solution.body.material_of_region[0].stress(
        solution.displacement.gradient(np.full((1, 3), 0.4))
    )
    assert abs(stress[0, 0, 1] - LAWS[name].shear(0.4)) < CLOSED


@EVERY
def test_energy_is_the_work_of_the_way_there(name: str) -> None:
    """int P dl over the stretch, by Gauss's rule; for laws without energy it is tau : eps."""
    entry = LAWS[name]
    solution = stretched(law_of(name, "built"), {2: 1.3})
    if not entry.energy:
        s = entry.stretches({2: 1.3})
        assert abs(solution.energy - entry.stresses(s) @ (s - 1)) < CLOSED
        return
    t, w = np.polynomial.legendre.leggauss(12)
    stretches = 1 + 0.15 * (t + 1)
    forces = [entry.stresses(entry.stretches({2: float(x)}))[2] for x in stretches]
    assert abs(solution.energy - 0.15 * (w @ forces)) < CLOSED * solution.energy
