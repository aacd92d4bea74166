# SPDX-License-Identifier: BSD-3-Clause
"""Theorems of linear elasticity that a discrete answer obeys to rounding, whatever its degree.

Work of loads is measured here anew, by quadrature of load times displacement.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
import pytest

import bezsoma as bz
from bezsoma import bernstein
from bezsoma.arrays import Floats
from bezsoma.mesh import TetMesh, ball, block
from tolerances import CLOSED_FORM, TWIN

DEGREES = (1, 2, 3, 5)
CORNER = (1.2, 1.0, 0.9)

t = bz.Polynomial.parse(["0.01*x*y", "0.02*(1 - z)", "0.01*y^2"])
p = bz.Polynomial.parse("0.01*(1 + x - y*z)")
f = bz.Polynomial.parse(["0.01", "0.02*y*z", "-0.03*x"])
PULLED = (bz.Traction("top", value=t), bz.BodyForce(f, regions=["soft"]))
PRESSED = (bz.Pressure("back", value=p), bz.PointForce(CORNER, (0.001, -0.002, 0.003)))


def slab() -> TetMesh:
    """An irregular block of two regions."""
    mesh = block(CORNER, cells=(3, 2, 2), irregular=0.3, seed=11)
    region = (mesh.points[mesh.tets].mean(axis=1)[:, 2] > 0.45).astype(int)
    return TetMesh(mesh.points, mesh.tets, region, ("soft", "stiff"), mesh.surfaces)


LAWS = {"soft": bz.LinearElastic(0.015, 0.45), "stiff": bz.LinearElastic(0.5, -0.2)}


@lru_cache
def solved(degree: int, loads: tuple, supports: tuple = (bz.Fixed("left"),)) -> bz.Solution:
    return bz.solve(bz.Body(slab(), degree, LAWS, supports, loads), solver="direct")


def pushes(load: object, mesh: TetMesh, degree: int) -> list[tuple[Floats, Floats]]:
    """Points (q, 3) and the forces (q, 3) N that a load puts there, fine enough for `degree`."""
    if isinstance(load, bz.PointForce):
        return [(np.array([load.at]), load.force[None])]
    if isinstance(load, bz.BodyForce):
        wanted = [mesh.regions.index(name) for name in load.regions or mesh.regions]
        tets = np.flatnonzero(np.isin(mesh.region, wanted))
        bary, weights = bernstein.simplex(degree + load.value.degree, 3)
        x = (bary @ mesh.points[mesh.tets[tets]]).reshape(-1, 3)
        return [(x, (mesh.volumes[tets, None] * weights).reshape(-1, 1) * load.value(x))]
    found = []
    bary, weights = bernstein.simplex(degree + load.value.degree, 2)
    for facets in (mesh.facets_of(name) for name in load.surfaces):
        x = (bary @ mesh.points[facets]).reshape(-1, 3)
        normals = np.repeat(mesh.normals(facets), len(bary), axis=0)
        value = load.value(x) * (-normals if isinstance(load, bz.Pressure) else 1.0)
        found.append((x, (mesh.areas(facets)[:, None] * weights).reshape(-1, 1) * value))
    return found


def work(loads: Sequence, solution: bz.Solution) -> float:
    """Loads times a displacement, N mm."""
    mesh, u = solution.body.mesh, solution.displacement
    parts = [part for load in loads for part in pushes(load, mesh, u.degree)]
    return sum(float((force * u.at(x)).sum()) for x, force in parts)


@pytest.mark.parametrize("degree", DEGREES)
def test_betti(degree: int) -> None:
    """The work of one set of loads on the answer to another equals that the other way round."""
    one, other = solved(degree, PULLED), solved(degree, PRESSED)
    assert work(PULLED, other) == pytest.approx(work(PRESSED, one), rel=TWIN)


@pytest.mark.parametrize("degree", DEGREES)
def test_clapeyron(degree: int) -> None:
    """The stored energy is half the work of the loads, where supports do not move."""
    loads = PULLED + PRESSED
    solution = solved(degree, loads)
    assert solution.energy == pytest.approx(work(loads, solution) / 2, rel=TWIN)


@pytest.mark.parametrize("degree", DEGREES)
def test_clapeyron_with_moved_supports(degree: int) -> None:
    """And of the reactions: force . t + moment . w for the support that follows t + w x x."""
    step, w = np.array([0.02, -0.01, 0.03]), np.array([0.01, 0.02, -0.03])
    motion = bz.Polynomial.affine(-np.cross(np.eye(3), w).T, step)
    supports = (bz.Fixed("left"), bz.Prescribed("right", value=motion))
    solution = solved(degree, PULLED, supports)
    pull = solution.reactions["right"]
    done = work(PULLED, solution) + pull.force @ step + pull.moment @ w
    assert solution.energy == pytest.approx(done / 2, rel=TWIN)


@pytest.mark.parametrize("degree", DEGREES)
def test_superposition(degree: int) -> None:
    """Answers to 2 A - 3 B add up: displacement, stress and reactions."""
    one, other = solved(degree, PULLED), solved(degree, PRESSED)
    scaled = (
        *(bz.Traction("top", value=lambda x: 2 * t(x), exactness=degree + 2),),
        bz.BodyForce(lambda x: 2 * f(x), regions=["soft"], exactness=degree + 2),
        bz.Pressure("back", value=lambda x: -3 * p(x), exactness=degree + 2),
        bz.PointForce(CORNER, (-0.003, 0.006, -0.009)),
    )
    both = solved(degree, scaled)
    for name in ("displacement", "stress"):
        a, b, ab = (getattr(each, name).controls for each in (one, other, both))
        assert np.abs(2 * a - 3 * b - ab).max() < TWIN * np.abs(ab).max()
    forces = [each.reactions["left"].force for each in (one, other, both)]
    assert np.abs(2 * forces[0] - 3 * forces[1] - forces[2]).max() < TWIN


@pytest.mark.parametrize("degree", DEGREES)
@pytest.mark.parametrize(
    "supports",
    [
        (bz.Fixed("left"),),
        (bz.Fixed("left"), bz.Moved("right", axis=(1, 1, 0), angle=0.1, about=(0, 0, 0))),
        (bz.Fixed("left"), bz.Fixed("bottom"), bz.Fixed("front", components="y")),
    ],
    ids=["one support", "two", "three that meet"],
)
def test_reactions_balance_loads(degree: int, supports: tuple) -> None:
    """Forces and moments about the origin; a load on what is held counts as well."""
    loads = (*PULLED, *PRESSED, bz.Traction("left", value=(0.01, 0.02, 0.03)))
    solution = solved(degree, loads, supports)
    parts = [part for load in loads for part in pushes(load, solution.body.mesh, 1)]
    pull = solution.reactions.values()
    force = sum(r.force for r in pull) + sum(F.sum(axis=0) for _, F in parts)
    moment = sum(r.moment for r in pull) + sum(np.cross(x, F).sum(axis=0) for x, F in parts)
    size = max(np.abs([r.force, r.moment]).max() for r in pull)
    assert np.abs([force, moment]).max() < CLOSED_FORM * size


@pytest.mark.parametrize("degree", (1, 2, 4))
def test_left_and_right_are_alike(degree: int) -> None:
    """A ball whose halves mirror each other, held below and pulled down: so do the halves' answers.

    The mesh is its own mirror image in x; nothing in the numbering is.
    """
    mesh = ball(cells=2).with_surface("cap", lambda x: x[:, 2] < -0.6)
    loads = [bz.BodyForce((0, 0.001, -0.002)), bz.Pressure("outer", value=0.003)]
    law = bz.LinearElastic(0.015, 0.45)
    solution = bz.solve(bz.Body(mesh, degree, law, [bz.Fixed("cap")], loads), solver="direct")
    bary = np.array([[0.25] * 4, [0.7, 0.1, 0.15, 0.05]])
    x = (bary @ mesh.points[mesh.tets]).reshape(-1, 3)
    mirror = np.array([-1.0, 1, 1])
    u, there = solution.displacement.at(x), solution.displacement.at(x * mirror)
    assert np.abs(u - there * mirror).max() < TWIN * np.abs(u).max()
    tau, there = solution.stress.at(x), solution.stress.at(x * mirror)
    assert np.abs(tau - there * np.outer(mirror, mirror)).max() < TWIN * np.abs(tau).max()
    assert abs(solution.reactions["cap"].force[0]) < TWIN * solution.reactions["cap"].force[2]


@pytest.mark.parametrize("degree", (1, 2, 4))
def test_an_octant_with_planes_of_symmetry_is_the_whole(degree: int) -> None:
    """A ball pressed by 1 + x^2 + 2 y^2 + 3 z^2: its octant, held across three planes, alone.

    The whole ball hangs on its centre and two points of the axes, where symmetry leaves no force.
    """
    law = bz.LinearElastic(0.015, 0.4)
    load = bz.Pressure("outer", value=bz.Polynomial.parse("0.001*(1 + x^2 + 2*y^2 + 3*z^2)"))
    whole = ball(cells=2)
    for name, point in {"centre": (0, 0, 0), "a": (1, 0, 0), "b": (0, 1, 0)}.items():
        whole = whole.with_vertices(name, [point])
    pins = [bz.Fixed("centre"), bz.Fixed("a", components="yz"), bz.Fixed("b", components="z")]
    planes = [bz.Fixed(f"{axis}0", components=axis) for axis in "xyz"]
    one = bz.solve(bz.Body(whole, degree, law, pins, [load]), solver="direct")
    part = bz.solve(
        bz.Body(ball(cells=2, octant=True), degree, law, planes, [load]), solver="direct"
    )
    mesh = part.body.mesh
    x = mesh.points[mesh.tets].mean(axis=1)
    u, stress = part.displacement.at(x), part.stress.at(x)
    assert np.abs(one.displacement.at(x) - u).max() < TWIN * np.abs(u).max()
    assert np.abs(one.stress.at(x) - stress).max() < TWIN * np.abs(stress).max()
    assert one.energy == pytest.approx(8 * part.energy, rel=TWIN)
    assert np.abs(one.reactions["centre"].force).max() < TWIN * part.reactions["x0"].force[0]
