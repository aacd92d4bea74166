# SPDX-License-Identifier: BSD-3-Clause
"""Bodies and solutions travel between processes, whatever is prescribed on them."""

from __future__ import annotations

import copy
import pickle
from typing import Any

import numpy as np
import pytest

from bezsoma.arrays import Floats
from bezsoma.mechanics import (
    Body,
    Fixed,
    FunctionLaw,
    Graded,
    LinearElastic,
    Moved,
    NeoHooke,
    Polynomial,
    Prescribed,
    Pressure,
    Traction,
)
from bezsoma.mesh import TetMesh, block
from bezsoma.solvers import Solution, solve


def push(points: Floats) -> Floats:
    """A traction that is no polynomial."""
    return 1e-3 * np.sin(points)


def hard(H: Floats) -> Floats:
    """A law of one's own, at small strain."""
    strain: Floats = (H + np.swapaxes(H, -1, -2)) / 2
    return strain


def two_regions() -> TetMesh:
    """A block, half of it of another name."""
    mesh = block(cells=2)
    right = mesh.points[mesh.tets].mean(axis=1)[:, 0] > 0.5
    return TetMesh(
        mesh.points, mesh.tets, right.astype(int), ("left", "right"), surfaces=mesh.surfaces
    )


MESH = two_regions()
HELD = [Fixed("bottom"), Moved("top", translation=(0.02, 0, 0))]
BODIES = {
    "numbers": Body(
        MESH, 2, LinearElastic(1.0, 0.3), HELD, [Traction("right", value=(0, 1e-3, 0))]
    ),
    "a function": Body(MESH, 2, LinearElastic(1.0, 0.3), HELD, [Traction("right", value=push)]),
    "a polynomial": Body(
        MESH,
        2,
        LinearElastic(1.0, 0.3),
        [Fixed("bottom"), Prescribed("top", value=Polynomial.parse(["0.1*x*y", 0, 0]))],
        [Pressure("right", value=1e-3)],
    ),
    "a material a region": Body(
        MESH,
        2,
        {"left": LinearElastic(1.0, 0.3), "right": LinearElastic(5.0, 0.5)},
        HELD,
        incompressible=True,
        pressure_breaks=True,
    ),
    "graded": Body(
        MESH,
        2,
        LinearElastic(1.0, 0.3),
        [Fixed("left"), Moved("top", translation=(0.02, 0, 0))],
        joins=[Graded(over="left", to="top", band=0.5)],
    ),
    "a law of the core": Body(MESH, 2, NeoHooke(E=1.0, nu=0.3), HELD),
    "a law of one's own": Body(MESH, 1, FunctionLaw(hard, finite=False), HELD),
}


@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
@pytest.mark.parametrize("way", [lambda x: pickle.loads(pickle.dumps(x)), copy.deepcopy])
def test_a_body_and_its_solution_come_back_the_same(body: Body, way: Any) -> None:
    there = solve(way(body), solver="direct")
    assert isinstance(there, Solution)
    back: Solution = way(there)
    here = solve(body, solver="direct")
    assert np.array_equal(back.displacement.controls, here.displacement.controls)
    assert back.energy == here.energy and back.iterations == here.iterations
    assert repr(back.body.supports) == repr(body.supports)
    assert repr(back.body.loads) == repr(body.loads)
    assert back.summary()["reactions"] == here.summary()["reactions"]
    x = np.full((1, 3), 0.4)
    assert np.array_equal(back.stress.at(x), here.stress.at(x))


def test_a_function_without_a_name_says_so() -> None:
    """Python's own message, which names it; nothing else is in the way."""
    loads = [Traction("right", value=lambda x: 0 * x)]
    body = Body(MESH, 1, LinearElastic(1.0, 0.3), HELD, loads)
    with pytest.raises((AttributeError, pickle.PicklingError), match="lambda"):
        pickle.dumps(solve(body))
    assert np.array_equal(copy.deepcopy(body).loads[0].value(MESH.points), 0 * MESH.points)  # type: ignore[union-attr]
