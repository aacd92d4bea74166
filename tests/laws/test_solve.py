# SPDX-License-Identifier: BSD-3-Clause
"""What any solve has to respect: polynomials come back, forces balance, frames do not matter."""

from __future__ import annotations

import doctest
import json
from collections.abc import Callable
from fractions import Fraction
from itertools import product
from pathlib import Path

import numpy as np
import pytest

from bezsoma import bernstein
from bezsoma.arrays import Floats
from bezsoma.equations.assembled import assembled
from bezsoma.equations.element import moduli
from bezsoma.equations.forces import forces
from bezsoma.equations.stress import von_mises
from bezsoma.errors import InputError, NotConverged
from bezsoma.mechanics import (
    Body,
    BodyForce,
    Fixed,
    LinearElastic,
    Moved,
    PointForce,
    Polynomial,
    Precedence,
    Prescribed,
    Pressure,
    Traction,
)
from bezsoma.mesh import TetMesh, block
from bezsoma.solvers import Solution, solve
from tolerances import INVARIANCE, ITERATIVE, ROUNDING, patch

SIDES = ("left", "right", "front", "back", "bottom", "top")
PROBES = np.random.default_rng(5).random((20, 3)) * 0.8 + 0.1
Components = tuple[tuple[tuple[int, int, int], Fraction], ...]


def random_polynomial(degree: int, seed: int) -> Polynomial:
    """Three components, all monomials up to the degree, coefficients in [-1, 1]."""
    random = np.random.default_rng(seed)
    powers = [p for p in product(range(degree + 1), repeat=3) if sum(p) <= degree]
    return Polynomial(
        tuple(
            tuple((p, Fraction(int(random.integers(-8, 9)) or 1, 8)) for p in powers)
            for _ in range(3)
        )
    )


def combined(*scaled: tuple[float, Components]) -> Components:
    """The sum of factors times components."""
    total: dict[tuple[int, int, int], Fraction] = {}
    for factor, terms in scaled:
        for power, coefficient in terms:
            total[power] = total.get(power, Fraction(0)) + Fraction(factor) * coefficient
    return tuple(sorted(term for term in total.items() if term[1]))


def stress_of(u: Polynomial, law: LinearElastic) -> list[list[Components]]:
    """The stress of a polynomial displacement, in exact fractions."""
    H = [[u.derivative(j).components[i] for j in range(3)] for i in range(3)]
    trace = [(law.lam, H[k][k]) for k in range(3)]
    return [
        [
            combined((law.mu, H[i][j]), (law.mu, H[j][i]), *(trace if i == j else []))
            for j in range(3)
        ]
        for i in range(3)
    ]


def manufactured(u: Polynomial, degree: int, law: LinearElastic, mesh: TetMesh) -> Body:
    """The body whose displacement is u: three sides prescribed, tractions on the others."""
    tau = stress_of(u, law)
    force = [
        combined(*((-1, Polynomial((tau[i][j],)).derivative(j).components[0]) for j in range(3)))
        for i in range(3)
    ]
    loads = [
        Traction(side, value=Polynomial(tuple(combined((sign, tau[i][axis])) for i in range(3))))
        for side, axis, sign in (("front", 1, -1), ("back", 1, 1), ("top", 2, 1))
    ]
    supports = [Prescribed("left", "bottom", "right", value=u)]
    return Body(mesh, degree, law, supports, [BodyForce(Polynomial(tuple(force))), *loads])


def everywhere(solution: Solution) -> tuple[Floats, Floats]:
    """Points in every tet (p, 3), and the displacement there (p, 3)."""
    bary = bernstein.simplex(2 * solution.net.degree, 3)[0]
    mesh = solution.body.mesh
    points = np.einsum("qi,tid->tqd", bary, mesh.points[mesh.tets]).reshape(-1, 3)
    return points, solution.displacement.tabulated(bary).reshape(-1, 3)


@pytest.mark.parametrize("nu", [0.3, 0.45])
@pytest.mark.parametrize("degree", [1, 2, 3, 4, 5, 6, 7, 8, 10])
def test_polynomials_come_back(degree: int, nu: float) -> None:
    u, law = random_polynomial(degree, seed=degree), LinearElastic(2.0, nu)
    cells = 2 if degree < 6 else 1
    mesh = block(cells=cells, irregular=0.25, seed=degree, origin=(-0.5, -0.5, -0.5))
    solution = solve(manufactured(u, degree, law, mesh), solver="direct")
    points, found = everywhere(solution)
    expected = u(points)
    assert np.abs(found - expected).max() < patch(degree) * np.abs(expected).max()


def test_a_degree_more_than_needed_changes_nothing() -> None:
    u, law = random_polynomial(2, seed=1), LinearElastic(2.0, 0.3)
    points, found = everywhere(solve(manufactured(u, 4, law, block(cells=2)), solver="direct"))
    assert np.abs(found - u(points)).max() < patch(4)


def test_stress_of_a_polynomial() -> None:
    u, law = random_polynomial(3, seed=2), LinearElastic(2.0, 0.4)
    solution = solve(manufactured(u, 3, law, block(cells=2, irregular=0.2)), solver="direct")
    for i, j in product(range(3), repeat=2):
        expected = Polynomial((stress_of(u, law)[i][j],))(PROBES).reshape(-1)
        assert np.abs(solution.stress.at(PROBES)[:, i, j] - expected).max() < 1e-11


def pulled(degree: int, mesh: TetMesh | None = None) -> Body:
    """A block on its bottom, carried, pulled, pressed, pushed and heavy."""
    mesh = block(cells=2, irregular=0.2, seed=4) if mesh is None else mesh
    loads = [
        Traction("top", value=Polynomial.parse(["0.1*x", "0.05", "0.2*y - x"])),
        Pressure("right", value=0.07),
        BodyForce((0.01, 0.02, -0.3)),
        PointForce((1, 1, 1), (0.02, 0, 0.01)),
    ]
    supports = [Moved("bottom", translation=(0.01, 0.02, 0)), Fixed("left", components="x")]
    joins = [Precedence("bottom", over="left")]
    return Body(mesh, degree, LinearElastic(1.5, 0.4), supports, loads, joins)


@pytest.mark.parametrize("degree", [1, 2, 3, 4])
def test_conjugate_gradients_agree_with_the_direct_solver(degree: int) -> None:
    exact = solve(pulled(degree), solver="direct")
    iterated = solve(pulled(degree), solver="cg", rtol=1e-10)
    u = exact.displacement.controls
    assert np.abs(iterated.displacement.controls - u).max() < ITERATIVE * np.abs(u).max()
    assert iterated.residual <= 1e-10 and exact.residual < 1e-13
    assert iterated.history[0] == exact.history[0] == 1
    assert iterated.history[-1] == pytest.approx(iterated.residual, rel=0.05)
    assert iterated.energy == pytest.approx(exact.energy, rel=ITERATIVE)


@pytest.mark.parametrize("degree", [1, 2, 5])
def test_reactions_balance_the_loads(degree: int) -> None:
    solution = solve(pulled(degree), solver="direct")
    force = sum(reaction.force for reaction in solution.reactions.values())
    moment = sum(reaction.moment for reaction in solution.reactions.values())
    top, right = np.array([0.05, 0.05, 0.1 - 0.5]), np.array([-0.07, 0, 0])
    weight, push = np.array([0.01, 0.02, -0.3]), np.array([0.02, 0, 0.01])
    np.testing.assert_allclose(force, -(top + right + weight + push), atol=1e-12)
    # int p x t over the top, by hand: t = (x/10, 1/20, y/5 - x), p = (x, y, 1)
    top_moment = np.array([1 / 15 - 1 / 4 - 1 / 20, 1 / 20 - 1 / 20 + 1 / 3, 1 / 40 - 1 / 40])
    middle = np.array([0.5, 0.5, 0.5])
    others = np.cross([1, 0.5, 0.5], right) + np.cross(middle, weight) + np.cross([1, 1, 1], push)
    np.testing.assert_allclose(moment, -(top_moment + others), atol=1e-12)


def test_energy_is_half_the_work_of_what_acts() -> None:
    body = pulled(3)
    solution = solve(body, solver="direct")
    work = float((forces(body, solution.net) * solution.displacement.controls).sum())
    work += float(solution.reactions["bottom"].force @ [0.01, 0.02, 0])
    assert solution.energy == pytest.approx(work / 2, rel=1e-12)


def test_energy_is_that_of_the_matrix() -> None:
    solution = solve(pulled(2), solver="direct")
    u = solution.displacement.controls
    K = assembled(solution.net, *moduli(solution.body))
    assert solution.energy == pytest.approx(float((u * (K @ u)).sum()) / 2, rel=1e-12)


def test_volume_change_is_the_flux_through_the_boundary() -> None:
    solution = solve(pulled(3), solver="direct")
    mesh, u = solution.body.mesh, solution.displacement
    flux = u.on_surface().controls.mean(axis=1)
    normals, areas = mesh.normals(mesh.boundary), mesh.areas(mesh.boundary)
    assert solution.volume_change == pytest.approx(
        float((areas * (flux * normals).sum(axis=1)).sum()), rel=1e-10
    )


def test_a_carried_body_stores_no_energy() -> None:
    turn = Moved("bottom", translation=(5, -3, 2), axis=(1, 2, 3), angle=1e-9, about=(9, 9, 9))
    body = Body(block(cells=2, irregular=0.2), 3, LinearElastic(1.0, 0.45), [turn])
    solution = solve(body, solver="direct")
    assert solution.energy < 1e-25
    assert np.abs(solution.stress.controls).max() < ROUNDING * 10


def test_stretch_of_a_bar() -> None:
    """Uniaxial stress E times the strain, for any degree; von Mises and principal agree."""
    planes = [Fixed(p, components=c) for p, c in (("left", "x"), ("front", "y"), ("bottom", "z"))]
    body = Body(block(cells=2, irregular=0.2), 3, LinearElastic(3.0, 0.45), planes)
    body = Body(body.mesh, 3, body.materials, planes, [Traction("top", value=(0, 0, 0.06))])
    solution = solve(body, solver="direct")
    strain = np.diag([-0.45 * 0.02, -0.45 * 0.02, 0.02])
    np.testing.assert_allclose(solution.displacement.at(PROBES), PROBES @ strain, atol=1e-14)
    np.testing.assert_allclose(solution.von_mises_at(PROBES), 0.06, rtol=1e-11)
    np.testing.assert_allclose(solution.von_mises.at(PROBES), 0.06, rtol=1e-11)
    np.testing.assert_allclose(solution.stress.averaged().at(PROBES)[:, 2, 2], 0.06, rtol=1e-11)
    principal = np.broadcast_to([0.06, 0, 0], (len(PROBES), 3))
    np.testing.assert_allclose(solution.principal_stresses_at(PROBES), principal, atol=1e-12)
    np.testing.assert_allclose(solution.principal_stresses.at(PROBES), principal, atol=1e-12)
    np.testing.assert_allclose(solution.strain.at(PROBES)[0], strain, atol=1e-13)


def test_interpolated_von_mises_is_exact_in_the_domain_points() -> None:
    solution = solve(pulled(3), solver="direct")
    bary = bernstein.domain_points(2, 3)
    inside = bary[(bary > 0).sum(axis=1) > 1]
    values = solution.von_mises.tabulated(inside)
    np.testing.assert_allclose(values, von_mises(solution.stress.tabulated(inside)), rtol=1e-10)
    assert solution.von_mises.shape == () and solution.von_mises.degree == 2


def test_two_materials_in_series() -> None:
    """A stack of two layers between planes: springs E_i A / l_i in series, at nu = 0."""
    mesh = block(cells=(1, 1, 2))
    upper = mesh.points[mesh.tets].mean(axis=1)[:, 2] > 0.5
    mesh = TetMesh(
        mesh.points, mesh.tets, upper.astype(int), ("soft", "hard"), surfaces=mesh.surfaces
    )
    laws = {"soft": LinearElastic(1.0, 0.0), "hard": LinearElastic(4.0, 0.0)}
    supports = [Fixed("bottom"), Moved("top", translation=(0, 0, 0.1))]
    solution = solve(Body(mesh, 2, laws, supports))
    assert solution.reactions["top"].force[2] == pytest.approx(0.1 / (0.5 / 1 + 0.5 / 4))


def largest_difference(
    solution: Solution, other: Solution, map_points: Callable[[Floats], Floats], turn: Floats
) -> float:
    """How far two answers are apart in displacement, relative to the largest; other = turned."""
    u = solution.displacement.at(PROBES)
    v = other.displacement.at(map_points(PROBES)) @ turn
    return float(np.abs(u - v).max() / np.abs(u).max())


def test_the_order_of_tets_and_vertices_does_not_matter() -> None:
    mesh = block(cells=2, irregular=0.2, seed=4)
    random = np.random.default_rng(1)
    new = random.permutation(len(mesh.points))
    points = np.empty_like(mesh.points)
    points[new] = mesh.points
    tets = random.permuted(new[random.permutation(mesh.tets)], axis=1)
    other = TetMesh(points, tets, surfaces={k: new[f] for k, f in mesh.surfaces.items()})
    for degree in (1, 3):
        a, b = (solve(pulled(degree, m), solver="direct") for m in (mesh, other))
        assert largest_difference(a, b, lambda p: p, np.eye(3)) < INVARIANCE
        assert b.energy == pytest.approx(a.energy, rel=INVARIANCE)


@pytest.mark.parametrize(
    ("scale", "shift"), [(1.0, (1000, -1000, 500)), (1e-6, (0, 0, 0)), (1e-6, (1e-3, 0, 0))]
)
@pytest.mark.parametrize("degree", [1, 4])
def test_place_turn_and_unit_do_not_matter(
    scale: float, shift: tuple[float, float, float], degree: int
) -> None:
    """Lengths times scale, the frame turned and shifted; moduli and tractions stay."""
    axis, angle = np.array([1.0, 2, 2]) / 3, 0.7
    skew = np.cross(np.eye(3), axis)
    turn = np.eye(3) + np.sin(angle) * skew.T + (1 - np.cos(angle)) * skew @ skew
    mesh = block(cells=2, irregular=0.2, seed=4)
    other = mesh.moved(scale * turn, shift)

    def body(mesh: TetMesh, R: Floats, size: float) -> Body:
        carried = Moved("bottom", translation=R @ [0.01 * size, 0, 0.02 * size])
        loads = [
            Traction("top", value=R @ [0.1, 0.2, -0.3]),
            BodyForce(R @ [0.1, 0, 0.2] / size),
            Pressure("right", value=0.1),
        ]
        return Body(mesh, degree, LinearElastic(1.5, 0.45), [carried], loads)

    a = solve(body(mesh, np.eye(3), 1.0), solver="direct")
    b = solve(body(other, turn, scale), solver="direct")
    apart = largest_difference(a, b, lambda p: p @ (scale * turn).T + shift, turn / scale)
    assert apart < INVARIANCE
    assert b.energy == pytest.approx(a.energy * scale**3, rel=INVARIANCE)
    force = b.reactions["bottom"].force / scale**2 @ turn
    np.testing.assert_allclose(force, a.reactions["bottom"].force, atol=INVARIANCE)


@pytest.mark.parametrize("E", [1e-120, 1e-9, 1e9, 1e120])
@pytest.mark.parametrize("solver", ["direct", "cg", "multigrid"])
def test_the_size_of_the_modulus_does_not_matter(E: float, solver: str) -> None:
    supports = [Fixed("bottom"), Moved("top", translation=(0.1, 0, 0))]
    reference, other = (
        solve(Body(block(cells=2), 2, LinearElastic(e, 0.3), supports), solver=solver)
        for e in (1.0, E)
    )
    u, v = reference.displacement.controls, other.displacement.controls
    np.testing.assert_allclose(v, u, atol=1e-9)
    assert other.energy / E == pytest.approx(reference.energy, rel=1e-7)


def test_bounds_of_the_largest_displacement() -> None:
    for degree in (1, 2, 4):
        solution = solve(pulled(degree), solver="direct")
        size = np.linalg.norm(solution.displacement.at(PROBES), axis=1).max()
        assert size <= solution.largest_displacement_bound
        assert solution.largest_displacement <= solution.largest_displacement_bound * (1 + 1e-14)
    first = solve(pulled(1), solver="direct")
    assert first.largest_displacement == pytest.approx(first.largest_displacement_bound)


def test_no_load_gives_exactly_zero() -> None:
    for solver in ("auto", "direct", "cg", "multigrid"):
        solution = solve(Body(block(), 2, LinearElastic(1.0, 0.3), [Fixed("top")]), solver=solver)
        assert not solution.displacement.controls.any()
        assert solution.method.startswith("nothing to solve")
        assert solution.history == () and solution.energy == 0


def hanging(cells: int, nu: float = 0.3, degree: int = 1) -> Body:
    law = LinearElastic(1.0, nu)
    return Body(block(cells=cells), degree, law, [Fixed("top")], [BodyForce((0, 0, 1))])


@pytest.mark.parametrize("cells", [1, 12])
def test_auto_iterates_and_says_so(cells: int) -> None:
    chosen = solve(hanging(cells))
    assert chosen.method.startswith("conjugate gradients with multigrid")
    assert chosen.method.endswith("since that is quickest")
    assert 0 < chosen.residual <= 1e-8
    insisted = solve(hanging(cells), solver="cg", rtol=1e-3)
    assert "incomplete Cholesky" in insisted.method and insisted.method.endswith("as asked for")
    assert insisted.residual <= 1e-3
    if cells > 1:  # one cell has no fill that is left out, so that one step is exact
        assert insisted.method.endswith("incomplete Cholesky, as asked for")
        assert insisted.residual > 1e-8


@pytest.mark.parametrize("start", [False, True])
@pytest.mark.parametrize(
    ("hard", "creeps"), [(hanging(3, 0.49999, 2), True), (hanging(4, 1 / 2 - 1e-7), False)]
)
def test_auto_factors_a_small_body_that_iterations_do_not_solve(
    hard: Body, creeps: bool, start: bool
) -> None:
    told: list[str] = []
    begin = solve(hanging(4)) if start else None
    chosen = solve(hard, start=begin, progress=lambda stage, done, note: told.append(note))
    factored = solve(hard, solver="direct")
    assert chosen.method.startswith("direct (SuperLU, scaled and refined), since ")
    assert ("since 296 iterations left" in chosen.method) == creeps
    assert chosen.method.endswith(f"of the residual and {chosen.free} unknowns are few")
    assert chosen.displacement.controls.tobytes() == factored.displacement.controls.tobytes()
    assert chosen.history == factored.history and chosen.timings.keys() == factored.timings.keys()
    assert any("multigrid" in note for note in told) and any("direct" in note for note in told)


def test_auto_factors_no_large_body() -> None:
    with pytest.raises(NotConverged, match="conjugate gradients"):
        solve(hanging(12), rtol=1e-30)


def test_progress_tells_of_every_stage() -> None:
    told: list[tuple[str, float | None, str]] = []
    solution = solve(pulled(2), solver="cg", progress=lambda *what: told.append(what))
    stages = list(dict.fromkeys(stage for stage, _, _ in told))
    assert stages == ["numbering", "supports", "loads", "stiffness", "solving", "reactions"]
    assert list(solution.timings) == stages
    fractions = [f for stage, f, _ in told if stage == "solving" and f is not None]
    assert len(fractions) == solution.iterations and fractions[-1] == 1
    assert all(0 <= f <= 1 for f in fractions)
    assert any("residual" in note for _, _, note in told)


def test_summary_is_json() -> None:
    solution = solve(pulled(2))
    summary = json.loads(json.dumps(solution.summary()))
    assert summary["sizes"]["tets"] == 48
    assert summary["sizes"]["unknowns"] == 3 * solution.net.count
    assert summary["energy"] == solution.energy
    assert summary["reactions"]["bottom"]["force"] == solution.reactions["bottom"].force.tolist()
    assert set(summary["versions"]) == {"bezsoma", "python", "numpy", "scipy"}
    assert summary["largest_displacement"] <= summary["largest_displacement_bound"]


def test_wrong_arguments_are_refused() -> None:
    with pytest.raises(InputError, match=r"no solver 'direkt'.*did you mean 'direct'"):
        solve(pulled(1), solver="direkt")
    for rtol in (0, -1e-8, 1.0, float("nan"), "small"):
        with pytest.raises(InputError, match=r"rtol = .*between 0 and 1"):
            solve(pulled(1), rtol=rtol)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="it solves a Body"):
        solve(block())  # type: ignore[arg-type]
    with pytest.raises(InputError, match="progress = 3 cannot be called: give a function"):
        solve(pulled(1), progress=3)  # type: ignore[arg-type]


def test_rtol_may_be_a_number_of_numpy() -> None:
    found = solve(pulled(2), solver="multigrid", rtol=np.float32(1e-5))  # type: ignore[arg-type]
    assert found.residual <= 1.01e-5


@pytest.mark.parametrize("solver", ["direct", "cg", "multigrid"])
def test_more_than_rounding_allows_is_not_claimed(solver: str) -> None:
    with pytest.raises(NotConverged, match=r"rtol = 1e-17.*rounding|rounding.*rtol = 1e-17"):
        solve(pulled(3), solver=solver, rtol=1e-17)


def test_forces_out_of_range_are_refused() -> None:
    huge = Body(
        block((1e5, 1e5, 1e5)),
        1,
        LinearElastic(1e305, 0.3),
        [Fixed("bottom"), Moved("top", translation=(1e3, 0, 0))],
    )
    with pytest.raises(InputError, match=r"leave the range.*check the units"):
        solve(huge)


def test_every_side_prescribed_leaves_the_interior() -> None:
    u = Polynomial.parse(["x*y", "y*z - x", "0.5*z**2"])
    body = Body(block(cells=2), 2, LinearElastic(1.0, 0.2), [Prescribed(*SIDES, value=u)])
    assert 0 < solve(body).free < solve(body).displacement.controls.size


@pytest.mark.parametrize("page", ["displacement", "solvers"])
def test_the_examples_of_the_theory_pages_run(root: Path, page: str) -> None:
    file = root / "docs" / "theory" / f"{page}.md"
    result = doctest.testfile(str(file), module_relative=False, encoding="utf-8")
    assert result.failed == 0 and result.attempted >= 8
