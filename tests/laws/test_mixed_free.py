# SPDX-License-Identifier: BSD-3-Clause
"""The mixed form without a matrix against closed forms, and the iteration that solves with it."""

from __future__ import annotations

from math import comb

import numpy as np
import pytest

from bezsoma import _core, bernstein
from bezsoma.arrays import Bools, Floats
from bezsoma.equations.assembled import assembled
from bezsoma.equations.boundary import prescribed
from bezsoma.equations.forces import forces
from bezsoma.equations.matrix_free import MatrixFree
from bezsoma.equations.mixed import MixedEquations, mixed_matrix
from bezsoma.equations.mixed_free import MixedFree
from bezsoma.errors import NotConverged
from bezsoma.mechanics import Body, Fixed, LinearElastic, Traction
from bezsoma.mesh import ControlNet, TetMesh, block
from bezsoma.mesh.torn import pressure_net
from bezsoma.solvers.saddle import saddle
from bezsoma.solvers.saddle_direct import direct_saddle
from tolerances import ROUNDING

SETS = _core.instruction_sets()
PAIRS = [(k, m) for k in range(2, 9) for m in range(1, k)]
MODULI = np.array([[0.7, 0.3], [2.0, 0.0], [30.0, 1.1]])
"""G and 1/kappa of three regions, the second incompressible."""
STEPS = {2: 38, 3: 44, 4: 58}
"""To 1e-8 at nu = 1/2 on the cube below: at two applications a step, far below the 190, 245 and
355 applications of the design's MINRES."""
FLAT = 1.10
"""How far steps may grow when the mesh is refined."""
CARRIED = 1e-9
"""A pressure of an enclosed cube, L2, from residuals of 1e-12. By the inverse of the matrix these
leave 1.4e-11 (degree 2) and 1.9e-10 (degree 4) at most, and 4e-8 in single controls: those of tets
in corners, where free displacements are few (Schur complement: 0.03 of the mass matrix)."""
SOLVED = 1e-8
"""Two solves to 1e-12, relative to the largest."""


def regions(mesh: TetMesh, seed: int = 1) -> TetMesh:
    """The same mesh with its tets spread over three regions."""
    region = np.random.default_rng(seed).integers(0, len(MODULI), len(mesh.tets))
    region[: len(MODULI)] = np.arange(len(MODULI))
    return TetMesh(mesh.points, mesh.tets, region, ("a", "b", "c"), surfaces=mesh.surfaces)


def torn(mesh: TetMesh) -> TetMesh:
    """The same tets, with vertices of their own in every region."""
    own, tets = np.unique(mesh.tets * 3 + mesh.region[:, None], return_inverse=True)
    return TetMesh(mesh.points[own // 3], tets.reshape(-1, 4), mesh.region, mesh.regions)


def coupling(k: int, m: int) -> Floats:
    """int d_i B_a B_b / V with d_i for L_i, (4, a, b): the closed form, by whole numbers."""
    a, b = bernstein.indices(k, 3), bernstein.indices(m, 3)
    whole = comb(k - 1 + m, m) * comb(k + m + 2, 3)
    table = np.array([[comb(n, r) for r in range(17)] for n in range(17)])
    found = np.zeros((4, len(a), len(b)))
    for i in range(4):
        rows = np.flatnonzero(a[:, i])
        below = a[rows] - np.eye(4, dtype=int)[i]
        sums = below[:, None, :] + b
        found[i, rows] = k * table[sums, b[None].repeat(len(rows), 0)].prod(axis=-1) / whole
    return found


def closed_form(net: ControlNet, pressures: ControlNet, u: Floats, p: Floats) -> tuple[Floats, ...]:
    """f and g by element matrices: K of lambda = -2/3 G, and K_up and K_pp of ERRATA's formulas."""
    mesh, m = net.mesh, pressures.degree
    G, compressibility = MODULI[mesh.region].T
    f = assembled(net, np.ascontiguousarray(-2 / 3 * G), np.ascontiguousarray(G)) @ u
    corners = mesh.points[mesh.tets]
    inner = np.linalg.inv(corners[:, 1:] - corners[:, :1]).transpose(0, 2, 1)
    gradients = np.concatenate([-inner.sum(axis=1, keepdims=True), inner], axis=1)
    D = np.einsum("t,tik,iab->takb", mesh.volumes, gradients, coupling(net.degree, m))
    np.add.at(f, net.of_tet, -np.einsum("takb,tb->tak", D, p[pressures.of_tet]))
    g = np.zeros(pressures.count)
    np.add.at(g, pressures.of_tet, -np.einsum("takb,tak->tb", D, u[net.of_tet]))
    volumes = mesh.volumes * compressibility
    M = bernstein.mass(m, m, 3)
    np.add.at(g, pressures.of_tet, -np.einsum("t,ab,tb->ta", volumes, M, p[pressures.of_tet]))
    return f, g


def fields(net: ControlNet, pressures: ControlNet, seed: int = 7) -> tuple[Floats, Floats]:
    """Displacements and pressures without any structure."""
    random = np.random.default_rng(seed)
    return random.standard_normal((net.count, 3)), random.standard_normal(pressures.count)


def apart(found: Floats, expected: Floats) -> float:
    """How far vectors are apart, relative to the largest entry."""
    return float(np.abs(found - expected).max() / np.abs(expected).max())


@pytest.mark.parametrize(("k", "m"), PAIRS)
def test_it_does_what_the_matrices_do(k: int, m: int) -> None:
    mesh = regions(block(cells=(2, 2, 1), irregular=0.3, seed=3))
    net = ControlNet(mesh, k)
    for other in (mesh, torn(mesh)):
        pressures = ControlNet(other, m)
        u, p = fields(net, pressures)
        f, g = closed_form(net, pressures, u, p)
        for instructions in SETS:
            operator = MixedFree(net, pressures, MODULI, 2, instructions)
            assert operator.kernel.instructions == instructions
            found = operator.apply(u, p)
            assert apart(found[0], f) < ROUNDING
            assert apart(found[1], g) < ROUNDING


@pytest.mark.parametrize(("k", "m", "cells"), [(2, 1, 9), (3, 2, 7), (4, 3, 5), (5, 1, 4)])
def test_chunks_add_what_they_share(k: int, m: int, cells: int) -> None:
    """Several chunks, of a pressure that breaks and one that does not, and any threads."""
    mesh = regions(block(cells=cells, irregular=0.3))
    net = ControlNet(mesh, k)
    assert net.count > 2 * 1500, "a chunk has 1500 controls at least"
    for other in (mesh, torn(mesh)):
        pressures = ControlNet(other, m)
        u, p = fields(net, pressures)
        f, g = closed_form(net, pressures, u, p)
        found = [MixedFree(net, pressures, MODULI, threads).apply(u, p) for threads in (1, 2, 5)]
        assert apart(found[0][0], f) < ROUNDING and apart(found[0][1], g) < ROUNDING
        for again in found[1:]:
            assert (again[0] == found[0][0]).all() and (again[1] == found[0][1]).all()


@pytest.mark.parametrize("k", range(2, 9))
def test_symmetric_and_rigid_motions_cost_nothing(k: int) -> None:
    mesh = regions(block(cells=2, irregular=0.3))
    net, pressures = ControlNet(mesh, k), ControlNet(mesh, k - 1)
    operator = MixedFree(net, pressures, MODULI)
    (u, p), (v, q) = fields(net, pressures), fields(net, pressures, 8)
    (f, g), (h, j) = operator.apply(u, p), operator.apply(v, q)
    one, two = float((v * f).sum() + (q * g).sum()), float((u * h).sum() + (p * j).sum())
    assert abs(one - two) < ROUNDING * float(np.abs(v * f).sum() + np.abs(q * g).sum())
    turn = np.array([[0, -3.0, 2], [3, 0, -1], [-2, 1, 0]])
    carried = operator.apply(net.points @ turn.T + [1, 2, 3], np.zeros(pressures.count))
    assert max(np.abs(carried[0]).max(), np.abs(carried[1]).max()) < ROUNDING * np.abs(f).max() * 9
    assert operator.energy(net.points @ turn.T, 0 * p) < ROUNDING * operator.energy(u, p)


@pytest.mark.parametrize(("k", "m"), [(2, 1), (4, 3), (6, 2)])
def test_energy_is_half_the_work_of_both(k: int, m: int) -> None:
    mesh = regions(block(cells=2, irregular=0.3))
    net, pressures = ControlNet(mesh, k), ControlNet(mesh, m)
    operator = MixedFree(net, pressures, MODULI)
    u, p = fields(net, pressures)
    shear = float((u * operator.apply(u, 0 * p)[0]).sum())
    swelling = -float((p * operator.apply(0 * u, p)[1]).sum())
    assert operator.energy(u, p) == pytest.approx((shear + swelling) / 2, rel=1e-12)


@pytest.mark.parametrize("m", range(1, 8))
def test_the_mass_of_the_pressure(m: int) -> None:
    mesh = regions(block(cells=2, irregular=0.3))
    net, pressures = ControlNet(mesh, 8), ControlNet(mesh, m)
    weight = np.array([2.0, 0.5, 3.0])
    p = fields(net, pressures)[1]
    expected = np.zeros(pressures.count)
    scaled = mesh.volumes * weight[mesh.region]
    parts = np.einsum("t,ab,tb->ta", scaled, bernstein.mass(m, m, 3), p[pressures.of_tet])
    np.add.at(expected, pressures.of_tet, parts)
    assert apart(MixedFree(net, pressures, MODULI).mass(weight, p), expected) < ROUNDING


def test_what_does_not_fit_is_refused() -> None:
    mesh = block(cells=2)
    net = ControlNet(mesh, 3)
    with pytest.raises(ValueError, match="degrees must be 2 to 8"):
        MixedFree(net, net, MODULI[:1]).kernel  # noqa: B018
    operator = MixedFree(net, ControlNet(mesh, 2), MODULI[:1])
    with pytest.raises(ValueError, match="one row a control"):
        operator.apply(np.zeros((net.count, 3)), np.zeros(3))
    shuffled = np.asarray(ControlNet(mesh, 1).starts[0][mesh.tets[::-1]], dtype=np.int32)
    from bezsoma.equations.matrix_free import walk

    with pytest.raises(ValueError, match="in another order than that in which"):
        _core.MixedFree(walk(net, MODULI[:1]), 1, np.ascontiguousarray(shuffled))


class Problem:
    """The design's cube, clamped below, loaded on the middle of its top, and its operator."""

    def __init__(
        self, k: int, cells: int, moduli: Floats = MODULI[:1] * [1, 0], threads: int = 0
    ) -> None:
        mesh = block(cells=cells)
        if len(moduli) > 1:
            mesh = regions(block(cells=cells, irregular=0.3))
        mesh = mesh.with_surface(
            "middle", lambda x: (x[:, 2] == 1) & (abs(x[:, :2] - 0.5) < 0.25 + 1e-9).all(axis=1)
        )
        tissue = LinearElastic(1.0, 0.3)  # names places and loads only
        law = {name: tissue for name in mesh.regions}
        body = Body(mesh, k, law, [Fixed("bottom")], [Traction("middle", value=(0, 0, -1.0))])
        self.net, self.pressures = ControlNet(mesh, k), ControlNet(mesh, k - 1)
        self.held: Bools = prescribed(body, self.net).mask
        self.f = np.where(self.held, 0.0, forces(body, self.net))
        self.operator = MixedFree(self.net, self.pressures, moduli, threads)
        self.levels = np.zeros((0, self.pressures.count))

    def solved(self, g: Floats | None = None, rtol: float = 1e-8) -> tuple[Floats, Floats, int]:
        given = np.zeros(self.pressures.count) if g is None else g
        u, p, history = saddle(
            self.operator, self.held, self.f, given, self.levels, rtol, lambda *_: None
        )
        assert history[0] <= 1 and history[-1] <= rtol * (1 + 1e-6)
        f, _ = self.operator.apply(u, p)
        left = np.where(self.held, 0.0, self.f - f)
        assert np.linalg.norm(left) <= rtol * 1.001 * np.hypot(
            np.linalg.norm(self.f), self.weight * np.linalg.norm(given)
        )
        assert not u[self.held].any()
        return u, p, len(history) - 1

    @property
    def weight(self) -> float:
        """2 G / h."""
        return float(2 * self.operator.moduli[:, 0].max() / np.cbrt(self.net.mesh.volumes.mean()))


@pytest.mark.parametrize("k", STEPS)
def test_steps_are_few_and_do_not_grow_with_the_mesh(k: int) -> None:
    sizes = (8, 12) if k == 2 else (6, 8) if k == 3 else (4, 6)
    steps = [Problem(k, cells).solved()[2] for cells in sizes]
    assert steps[1] <= STEPS[k], steps
    assert steps[1] <= FLAT * steps[0] + 1, steps


def test_threads_do_not_show() -> None:
    first = Problem(3, 6, MODULI, 1).solved()
    for threads in (2, 5):
        again = Problem(3, 6, MODULI, threads).solved()
        assert (again[0] == first[0]).all() and (again[1] == first[1]).all()


@pytest.mark.parametrize(("k", "cells"), [(2, 4), (3, 3), (5, 2)])
def test_compressible_without_a_pressure(k: int, cells: int) -> None:
    """Three materials: a pressure eliminated by hand, K + B^T (M/kappa)^-1 B, gives the same u."""
    moduli = np.array([[0.7, 0.3], [2.0, 0.5], [30.0, 1.1]])
    problem = Problem(k, 4 if k == 2 else cells * 2, moduli)
    u, p, _ = problem.solved(rtol=1e-12)
    zero = np.zeros(problem.pressures.count)
    compressed = problem.operator.apply(u, zero)[1]  # - int q div u = int q p / kappa
    assert apart(problem.operator.mass(moduli[:, 1], p), compressed) < SOLVED
    assert problem.operator.energy(u, p) == pytest.approx(
        float((u * problem.f).sum()) / 2, rel=SOLVED
    )


@pytest.mark.parametrize("k", [2, 4])
def test_an_enclosed_body_has_a_pressure_of_mean_zero(k: int) -> None:
    """A body force that is a gradient moves nothing: it is carried by the pressure alone."""
    mesh = block(cells=3, irregular=0.2)
    net, pressures = ControlNet(mesh, k), ControlNet(mesh, k - 1)
    held = np.zeros((net.count, 3), bool)
    for side in mesh.surfaces:
        held[net.of_place(side)] = True
    operator = MixedFree(net, pressures, MODULI[1:2])
    q = pressures.interpolated(lambda x: 3 * x[:, 0] - 2 * x[:, 2] + 5)
    f = np.where(held, 0.0, operator.apply(np.zeros((net.count, 3)), q)[0])
    one = np.ones((1, pressures.count))
    u, p, _ = saddle(operator, held, f, np.zeros(pressures.count), one, 1e-12, lambda *_: None)
    assert np.abs(u).max() < 1e-10
    wrong = p - (q - 5.5)
    # As int (p - q)^2: single controls of high degree say 300 times less of the pressure itself.
    assert np.sqrt(wrong @ operator.mass(np.ones(1), wrong)) < CARRIED
    assert abs(operator.mass(np.ones(1), p).sum()) < ROUNDING


@pytest.mark.parametrize("instructions", SETS)
def test_leaps_of_the_residual_are_not_followed_for_ever(instructions: str) -> None:
    """A contrast of 1e4 and a pressure that breaks: without new beginnings residuals of 1e16."""
    mesh = block(cells=3, irregular=0.3)
    stiff = (mesh.points[mesh.tets].mean(axis=1)[:, 0] > 0.5).astype(int)
    mesh = TetMesh(mesh.points, mesh.tets, stiff, ("soft", "stiff"), surfaces=mesh.surfaces)
    tissue = LinearElastic(1.0, 0.3)  # names places and loads only
    pull = [Traction("top", value=(1.0, 0, 0))]
    body = Body(mesh, 3, tissue, [Fixed("bottom")], pull)
    net, pressures = ControlNet(mesh, 3), pressure_net(mesh, 2, breaks=True)
    held = prescribed(body, net).mask
    f = np.where(held, 0.0, forces(body, net))
    moduli = np.array([[1.0, 0], [1e4, 0]])
    operator = MixedFree(net, pressures, moduli, instructions=instructions)
    none = np.zeros((0, pressures.count))
    _, p, _ = saddle(operator, held, f, np.zeros(len(none.T)), none, 1e-6, lambda *_: None)
    matrix = mixed_matrix(net, pressures, moduli)
    equations = MixedEquations(net, pressures, matrix, f, held, 0 * f, {}, none)
    assert apart(p, direct_saddle(equations, matrix)[1]) < 1e-4


def test_soft_and_stiff_tets_thrown_together_are_weighed_where_they_are() -> None:
    """Contrast 1000, tet by tet: some 550 steps; 1073 with one weight for all."""
    cube = block(cells=3)
    stiff = np.random.default_rng(0).integers(0, 2, len(cube.tets))
    mesh = TetMesh(cube.points, cube.tets, stiff, ("soft", "stiff"), surfaces=cube.surfaces)
    pull = [Traction("top", value=(1.0, 0, -1.0))]
    body = Body(mesh, 3, LinearElastic(1.0, 0.3), [Fixed("bottom")], pull)
    net, pressures = ControlNet(mesh, 3), ControlNet(mesh, 2)
    held = prescribed(body, net).mask
    f = np.where(held, 0.0, forces(body, net))
    operator = MixedFree(net, pressures, np.array([[1.0, 0], [1e3, 0]]))
    none = np.zeros((0, pressures.count))
    *_, history = saddle(operator, held, f, np.zeros(len(none.T)), none, 1e-8, lambda *_: None)
    assert len(history) < 800


def test_what_does_not_converge_says_so() -> None:
    problem = Problem(2, 4)
    zero = np.zeros(problem.pressures.count)
    with pytest.raises(NotConverged, match="after 3 steps") as caught:
        saddle(
            problem.operator, problem.held, problem.f, zero, problem.levels, 1e-8,
            lambda *_: None, most=3,
        )  # fmt: skip
    assert len(caught.value.history) == 4


def test_the_deviatoric_part_is_the_elastic_operator() -> None:
    net = ControlNet(block(cells=2, irregular=0.3), 4)
    u, p = fields(net, ControlNet(net.mesh, 3))
    f, _ = MixedFree(net, ControlNet(net.mesh, 3), MODULI[:1]).apply(u, 0 * p)
    assert apart(f, MatrixFree(net, np.array([[-2 / 3 * 0.7, 0.7]])) @ u) < ROUNDING
