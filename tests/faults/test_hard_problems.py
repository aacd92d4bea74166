# SPDX-License-Identifier: BSD-3-Clause
"""What makes a fast solver stumble: bad tets, contrasts, thin shells, pieces, few supports, units.

Each is solved by multigrid and directly; the two have to agree, or the failure has to say so.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.spatial import Delaunay

from bezsoma.equations.assembled import assembled
from bezsoma.equations.element import moduli
from bezsoma.errors import InputError, NotConverged
from bezsoma.mechanics import (
    Body,
    BodyForce,
    Fixed,
    LinearElastic,
    Moved,
    NeoHooke,
    PointForce,
    Prescribed,
    Pressure,
    Traction,
)
from bezsoma.mesh import TetMesh, block
from bezsoma.mesh.solids import ball, shell
from bezsoma.solvers import Solution, solve
from tolerances import HARD

TISSUE = LinearElastic(0.015, 0.45)
ENDS = [Fixed("bottom"), Moved("top", translation=(0.05, 0, 0.02))]


def apart(found: Solution, exact: Solution) -> float:
    """How far two answers are apart in the energy norm, relative to the exact one."""
    K = assembled(exact.net, *moduli(exact.body))
    u = exact.displacement.controls
    e = found.displacement.controls - u
    return float(np.sqrt((e * (K @ e)).sum() / (u * (K @ u)).sum()))


def spread(mesh: TetMesh, hard: np.ndarray) -> TetMesh:
    """The mesh with two regions, its surfaces kept."""
    return TetMesh(
        mesh.points, mesh.tets, hard.astype(int), ("soft", "hard"), surfaces=mesh.surfaces
    )


def contrast(degree: int, ratio: float, pattern: str) -> Body:
    """Two materials: layers, a stiff core, or every second cell."""
    mesh = block(cells=4, irregular=0.2)
    centre = mesh.points[mesh.tets].mean(axis=1)
    hard = {
        "layer": centre[:, 2] > 0.5,
        "core": (abs(centre - 0.5) < 0.25).all(axis=1),
        "checkers": (centre * 4).astype(int).sum(axis=1) % 2 == 0,
        "soft core": (abs(centre - 0.5) > 0.25).any(axis=1),
    }[pattern]
    laws = {"soft": LinearElastic(1.0, 0.45), "hard": LinearElastic(ratio, 0.3)}
    return Body(spread(mesh, hard), degree, laws, ENDS)


def thin(degree: int) -> Body:
    """A flat block, 1 : 50, clamped along one edge of it and bent."""
    mesh = block(size=(50, 50, 1), cells=(10, 10, 1))
    load = Pressure("top", value=1e-6)
    return Body(mesh, degree, LinearElastic(1.0, 0.4), [Fixed("left")], [load])


def skin(degree: int) -> Body:
    """A shell of tissue, 2 mm on 100 mm, pulled by its weight."""
    mesh = shell(98.0, 100.0, cells=8, layers=1)
    held = [Fixed(p, components=c) for p, c in (("x0", "x"), ("y0", "y"), ("z0", "xyz"))]
    return Body(mesh, degree, TISSUE, held, [BodyForce((0, 0, -1e-5))])


def slivers(degree: int) -> Body:
    """A random triangulation: tets a hundred times flatter than good ones among them."""
    points = np.random.default_rng(4).random((120, 3))
    points[:40, 2] = np.repeat([0.0, 1.0], 20)
    tets = Delaunay(points).simplices
    edges = points[tets[:, 1:]] - points[tets[:, :1]]
    size = np.abs(edges).max(axis=(1, 2))
    mesh = TetMesh(points, tets[np.abs(np.linalg.det(edges)) > 1e-3 * size**3])
    for name, z in (("bottom", 0.0), ("top", 1.0)):
        mesh = mesh.with_surface(name, lambda x, z=z: x[:, 2] == z)
    return Body(mesh, degree, LinearElastic(1.0, 0.4), ENDS)


def squeezed(degree: int) -> Body:
    """All tets flat, 1 : 100, in layers that shear over each other."""
    mesh = block(cells=(4, 4, 4), irregular=0.3).moved(np.diag([1, 1, 0.01]))
    return Body(mesh, degree, LinearElastic(1.0, 0.4), ENDS[:1], [Traction("top", value=(1, 0, 0))])


def pieces(degree: int) -> Body:
    """Three solids apart, each supported, of very different size and stiffness."""
    solids = [
        block(cells=3, irregular=0.2),
        block(size=(0.01,) * 3, origin=(2, 0, 0), cells=2),
        block(size=(30,) * 3, origin=(5, 0, 0), cells=2),
    ]
    shift = np.cumsum([0] + [len(s.points) for s in solids])
    names = solids[0].surfaces
    mesh = TetMesh(
        np.concatenate([s.points for s in solids]),
        np.concatenate([s.tets + n for s, n in zip(solids, shift, strict=False)]),
        np.repeat([0, 1, 1], [len(s.tets) for s in solids]),
        ("soft", "hard"),
        surfaces={
            name: np.concatenate(
                [s.surfaces[name] + n for s, n in zip(solids, shift, strict=False)]
            )
            for name in names
        },
    )
    laws = {"soft": TISSUE, "hard": LinearElastic(10.0, 0.3)}
    return Body(mesh, degree, laws, [Fixed("bottom")], [Traction("top", value=(1e-3, 0, 1e-3))])


def eight(degree: int) -> Body:
    """Eight tets around an edge, one face held."""
    angle = np.pi / 4 * np.arange(8)
    rim = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    turn = 2 + np.arange(8)
    mesh = TetMesh(
        np.concatenate([[[0, 0, -1.0], [0, 0, 1.0]], rim]),
        np.column_stack([0 * turn, 0 * turn + 1, turn, np.roll(turn, 1)]),
    )
    mesh = mesh.with_surface("face", mesh.boundary[:1])
    return Body(mesh, degree, TISSUE, [Fixed("face")], [BodyForce((0, 1e-3, 1e-3))])


def one_tet(degree: int) -> Body:
    """One tet on one of its faces."""
    mesh = TetMesh(np.eye(4, 3), [[0, 1, 2, 3]], surfaces={"face": np.array([[0, 1, 2]])})
    return Body(mesh, degree, TISSUE, [Fixed("face")], [BodyForce((0, 1e-3, 1e-3))])


def on_vertices(degree: int) -> Body:
    """Held at single vertices only, by just as many components as a rigid motion has."""
    mesh = block(cells=3, irregular=0.2)
    for name, point in (("a", (0, 0, 0)), ("b", (1, 0, 0)), ("c", (0, 1, 0))):
        mesh = mesh.with_vertices(name, np.array([point], dtype=float))
    held = [Fixed("a"), Fixed("b", components="yz"), Fixed("c", components="z")]
    pull = [Traction("top", value=(0, 0, 0.1)), Traction("bottom", value=(0, 0, -0.1))]
    return Body(mesh, degree, LinearElastic(1.0, 0.4), held, pull)


def on_edges(degree: int) -> Body:
    """Held along two edges of the block only."""
    mesh = block(cells=3)
    low = [[0, 0, z / 3] for z in range(4)]
    mesh = mesh.with_edges("low", np.array(low)).with_edges("high", np.array(low) + [1, 1, 0])
    held = [Fixed("low"), Moved("high", translation=(0.05, 0, 0), components="xy")]
    return Body(mesh, degree, TISSUE, held)


def on_components(degree: int) -> Body:
    """Held by components on planes, which no control is held by wholly but a corner's."""
    planes = {"left": "x", "front": "y", "bottom": "z"}
    held: list[Any] = [Fixed(place, components=axis) for place, axis in planes.items()]
    held.append(Moved("top", translation=(0, 0, 0.1), components="z"))
    return Body(block(cells=4, irregular=0.3), degree, LinearElastic(1.0, 0.49), held)


def nearly_all_held(degree: int) -> Body:
    """Every side is prescribed; two cells leave a vertex inside, and few controls are free."""
    sides = ("left", "right", "front", "back", "bottom", "top")
    stretch = Prescribed(*sides, value=lambda x: x**2 * [0.1, 0.2, -0.1])
    return Body(block(cells=2), degree, TISSUE, [stretch])


def pushed_at_a_point(degree: int) -> Body:
    """All force on one control, next to a clamp."""
    push = PointForce((1, 1, 1), (0, 0, -1e-3))
    return Body(block(cells=3), degree, TISSUE, [Fixed("bottom")], [push])


HARD_ONES: dict[str, tuple[Callable[[int], Body], tuple[int, ...]]] = {
    "nu of 0.45": (lambda n: Body(block(cells=3), n, LinearElastic(1, 0.45), ENDS), (1, 2, 4)),
    "nu of 0.49": (lambda n: Body(block(cells=3), n, LinearElastic(1, 0.49), ENDS), (1, 2, 4)),
    "nu of 0.499": (lambda n: Body(block(cells=3), n, LinearElastic(1, 0.499), ENDS), (2, 4)),
    "nu of -0.9": (lambda n: Body(block(cells=3), n, LinearElastic(1, -0.9), ENDS), (1, 3)),
    "a layer 1e4 stiffer": (lambda n: contrast(n, 1e4, "layer"), (1, 2, 3)),
    "a core 1e4 stiffer": (lambda n: contrast(n, 1e4, "core"), (1, 2, 3)),
    "a core 1e4 softer": (lambda n: contrast(n, 1e4, "soft core"), (1, 2, 3)),
    "checkers of 1e4": (lambda n: contrast(n, 1e4, "checkers"), (1, 2, 3)),
    "a flat block": (thin, (1, 2, 3)),
    "a shell of tissue": (skin, (1, 2, 3)),
    "slivers": (slivers, (1, 2, 3)),
    "squeezed": (squeezed, (1, 2)),
    "pieces": (pieces, (1, 2, 4)),
    "8 tets": (eight, (1, 2, 5, 10)),
    "one tet": (one_tet, (1, 2, 5, 10)),
    "supports at vertices": (on_vertices, (1, 2, 4)),
    "supports on edges": (on_edges, (1, 2, 4)),
    "supports by components": (on_components, (1, 2, 4)),
    "all but few held": (nearly_all_held, (1, 2, 3)),
    "a force on a point": (pushed_at_a_point, (1, 4)),
}

STEPS = {
    "nu of 0.45": (2, 67, 101),
    "nu of 0.49": (2, 137, 203),
    "nu of 0.499": (378, 575),
    "nu of -0.9": (2, 54),
    "a layer 1e4 stiffer": (11, 54, 68),
    "a core 1e4 stiffer": (14, 72, 92),
    "a core 1e4 softer": (11, 47, 55),
    "checkers of 1e4": (11, 61, 81),
    "a flat block": (103, 1180, 1406),
    "a shell of tissue": (122, 1961, 2933),
    "slivers": (30, 298, 681),
    "squeezed": (22, 134),
    "pieces": (17, 75, 107),
    "8 tets": (2, 76, 178, 373),
    "one tet": (2, 8, 72, 175),
    "supports at vertices": (2, 70, 126),
    "supports on edges": (2, 83, 124),
    "supports by components": (28, 121, 192),
    "all but few held": (2, 25, 47),
    "a force on a point": (2, 116),
}
"""Steps that were counted at those degrees, 2026-12-01."""


@pytest.mark.parametrize(
    ("kind", "degree", "steps"),
    [
        (kind, degree, steps)
        for kind, (_, degrees) in HARD_ONES.items()
        for degree, steps in zip(degrees, STEPS[kind], strict=True)
    ],
)
def test_hard_ones_agree_with_the_direct_solver(kind: str, degree: int, steps: int) -> None:
    """In as many steps as were counted, or a twentieth more: instruction sets round otherwise."""
    body = HARD_ONES[kind][0](degree)
    exact = solve(body, solver="direct")
    found = solve(body, solver="multigrid")
    assert found.residual <= 1e-8 * (1 + 1e-6)
    assert apart(found, exact) < HARD
    assert found.energy == pytest.approx(exact.energy, rel=HARD)
    assert found.iterations <= 1.05 * steps + 2


@pytest.mark.parametrize("scale", [1e-6, 1e6])
@pytest.mark.parametrize("modulus", [1e-120, 1e-9, 1e6, 1e120])
def test_units_do_not_matter(scale: float, modulus: float) -> None:
    """Micrometres or kilometres, any modulus: the same steps, the same answer."""

    def body(size: float, E: float) -> Body:
        mesh = block(cells=4, irregular=0.2).moved(np.eye(3) * size)
        carried = [ENDS[0], Moved("top", translation=(0.05 * size, 0, 0))]
        return Body(mesh, 3, LinearElastic(E, 0.4), carried, [Pressure("left", value=0.02 * E)])

    plain, other = (solve(body(*of), solver="multigrid") for of in ((1.0, 1.0), (scale, modulus)))
    u, v = plain.displacement.controls, other.displacement.controls / scale
    assert np.abs(u - v).max() < 1e-6 * np.abs(u).max()
    assert abs(other.iterations - plain.iterations) <= 2
    assert other.residual <= 1e-8 * (1 + 1e-6)


def test_a_sphere_alone_is_held_by_its_skin_only() -> None:
    body = Body(ball(10.0, cells=4), 2, TISSUE, [Fixed("outer")], [BodyForce((0, 0, -1e-4))])
    exact, found = solve(body, solver="direct"), solve(body, solver="multigrid")
    assert apart(found, exact) < HARD


def test_no_load_gives_exactly_zero() -> None:
    found = solve(Body(block(cells=3), 3, TISSUE, [Fixed("top")]), solver="multigrid")
    assert not found.displacement.controls.any()
    assert found.method.startswith("nothing to solve") and found.history == ()


def test_all_held_leaves_nothing_to_solve() -> None:
    sides = ("left", "right", "front", "back", "bottom", "top")
    carried = Moved(*sides, translation=(1, 2, 3))
    found = solve(Body(block(), 3, TISSUE, [carried]), solver="multigrid")
    np.testing.assert_allclose(found.displacement.controls, [[1, 2, 3]] * found.net.count)


def test_what_cannot_converge_says_so_with_its_history() -> None:
    body = Body(block(cells=3), 3, TISSUE, ENDS)
    with pytest.raises(NotConverged) as caught:
        solve(body, solver="multigrid", rtol=1e-30)
    error = caught.value
    assert "rtol = 1e-30 was asked for" in str(error) and "a larger rtol serves" in str(error)
    assert len(error.history) > 20 and error.history[0] == pytest.approx(1)
    assert all(np.isfinite(error.history))
    # what is told at the end is true, and no float64 residual is much smaller than rounding
    assert 1e-18 < error.history[-1] < 1e-12


@pytest.mark.parametrize("solver", ["multigrid", "direct", "cg"])
def test_a_larger_rtol_is_advised_where_it_helps(solver: str) -> None:
    """1 - 2 nu is a few units in the last place: what is left is of the size of the residual."""
    load = [Traction("top", value=(0.01, 0, 0))]
    body = Body(block(cells=3), 3, LinearElastic(1.0, 0.5 - 1e-15), [Fixed("bottom")], load)
    with pytest.raises(NotConverged, match=r"nu (very )?close to 1/2") as caught:
        solve(body, solver=solver)
    left = caught.value.history[-1]
    assert left > 1e-2 or solver == "cg"
    assert ("larger rtol" in str(caught.value)) == (left < 1e-2)


def test_auto_says_where_iterations_came_no_farther() -> None:
    """Beside a material 1e40 times softer the first direction already has no energy."""
    plain = block(cells=3)
    soft = (plain.points[plain.tets].mean(axis=1)[:, 2] > 0.5).astype(int)
    mesh = TetMesh(plain.points, plain.tets, soft, ("hard", "soft"), surfaces=plain.surfaces)
    laws = {"hard": LinearElastic(1.0, 0.3), "soft": LinearElastic(1e-40, 0.3)}
    found = solve(Body(mesh, 1, laws, ENDS), rtol=1e-6)
    assert "since iterations came no farther than" in found.method


@pytest.mark.parametrize("law", [LinearElastic, NeoHooke])
@pytest.mark.parametrize("mixed", [False, True])
@pytest.mark.parametrize("solver", ["auto", "direct", "multigrid"])
def test_a_region_without_tets_changes_nothing(law: Any, mixed: bool, solver: str) -> None:
    """Its law scales neither preconditioner nor residual: laws may be given for a whole atlas."""
    plain = block(cells=3)

    def found(stiff: float) -> Solution:
        mesh = TetMesh(
            plain.points,
            plain.tets,
            np.zeros(len(plain.tets), int),
            ("tissue", "nowhere"),
            surfaces=plain.surfaces,
        )
        laws = {"tissue": law(E=0.01, nu=0.49), "nowhere": law(E=stiff, nu=0.3)}
        return solve(Body(mesh, 2, laws, ENDS, incompressible=mixed), solver=chosen)

    chosen = "saddle" if (solver, mixed, law) == ("multigrid", True, LinearElastic) else solver
    alike, other = found(0.01), found(1e60)
    assert other.history == alike.history
    assert other.displacement.controls.tobytes() == alike.displacement.controls.tobytes()


def test_too_few_iterations_say_so(monkeypatch: pytest.MonkeyPatch) -> None:
    there = sys.modules["bezsoma.solvers.solve"]  # the function of that name hides the module
    monkeypatch.setattr(there, "MOST_ITERATIONS", 7)
    with pytest.raises(NotConverged, match="not done after 7 iterations") as caught:
        solve(Body(block(cells=3), 3, TISSUE, ENDS), solver="multigrid")
    assert len(caught.value.history) == 8
    assert caught.value.history[-1] > 1e-8


def test_rigid_motions_are_refused_before_multigrid_could_stumble() -> None:
    with pytest.raises(InputError, match="can still"):
        solve(
            Body(block(cells=4), 2, TISSUE, [Fixed("bottom", components="z")]), solver="multigrid"
        )


def test_nothing_of_the_solve_depends_on_what_was_solved_before() -> None:
    first = solve(slivers(2), solver="multigrid")
    solve(thin(3), solver="multigrid")
    again = solve(slivers(2), solver="multigrid")
    assert (first.displacement.controls == again.displacement.controls).all()
    assert first.history == again.history


@pytest.mark.parametrize("mixed", [False, True])
def test_auto_factors_thin_plates_where_iterations_stand_still(mixed: bool) -> None:
    """1 : 50, and few tets."""
    plate = block(size=(1, 1, 0.02), cells=(3, 3, 1))
    load = [BodyForce((0, 0, 1e-6))]
    body = Body(plate, 2, LinearElastic(1.0, 0.3), [Fixed("left")], load, incompressible=mixed)
    chosen, factored = solve(body, rtol=1e-7), solve(body, solver="direct", rtol=1e-7)
    assert chosen.method.startswith("direct (SuperLU") and "iterations left" in chosen.method
    assert chosen.displacement.controls.tobytes() == factored.displacement.controls.tobytes()
    with pytest.raises(NotConverged, match="slow"):
        solve(body, solver="saddle" if mixed else "multigrid", rtol=1e-16)
