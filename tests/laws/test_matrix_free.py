# SPDX-License-Identifier: BSD-3-Clause
"""The operator without a matrix, against the matrix: every degree, lane, side and mesh."""

from __future__ import annotations

from itertools import product
from math import comb

import numpy as np
import pytest

from bezsoma import _core, bernstein
from bezsoma.arrays import Floats
from bezsoma.equations.assembled import BlockMatrix, assembled
from bezsoma.equations.matrix_free import MatrixFree, _rows
from bezsoma.errors import InputError
from bezsoma.mesh import ControlNet, TetMesh, block
from bezsoma.mesh.solids import shell
from tolerances import ROUNDING, SINGLE

SETS = _core.instruction_sets()
DEGREES = range(1, 11)
LAME = np.array([[1.3, 0.7], [140.0, 2.0], [0.0, 30.0], [-0.2, 0.5]])
LANES = 16
"""The most tets in a batch: float32 with 512 bits."""


def materials(mesh: TetMesh, seed: int = 1) -> TetMesh:
    """The same mesh with its tets spread over four regions."""
    region = np.random.default_rng(seed).integers(0, len(LAME), len(mesh.tets))
    region[: len(LAME)] = np.arange(len(LAME))[: len(region)]
    return TetMesh(mesh.points, mesh.tets, region, ("a", "b", "c", "d"))


def several_pieces() -> TetMesh:
    """Three solids that touch nowhere, of very different size and far from each other."""
    solids = (
        block(cells=(2, 1, 1), irregular=0.3),
        block(size=(0.01,) * 3, origin=(3, 0, 0), irregular=0.3, seed=2),
        TetMesh(np.eye(4, 3) * 40 + 7, [[0, 1, 2, 3]]),
    )
    shift = np.cumsum([0] + [len(solid.points) for solid in solids])
    tets = [solid.tets + s for solid, s in zip(solids, shift, strict=False)]
    return TetMesh(np.concatenate([s.points for s in solids]), np.concatenate(tets))


def fan(tets: int) -> TetMesh:
    """So many tets around one edge: an edge and its vertices that all tets of a batch share."""
    angle = 2 * np.pi * np.arange(tets) / tets
    rim = np.column_stack([np.cos(angle), np.sin(angle) * 1.3, 0.2 * np.cos(3 * angle)])
    points = np.concatenate([[[0, 0, -1.0], [0.1, 0, 1.0]], rim])
    turn = 2 + np.arange(tets)
    return TetMesh(
        points,
        np.column_stack([0 * turn, 0 * turn + 1, turn, np.roll(turn, 1)]),
    )


MESHES = {
    "one tet": lambda: TetMesh(np.array([[0, 0, 0], [2, 0.3, 0], [0.1, 1, 0.2], [0.4, 0, 3.0]]),
                               [[0, 1, 2, 3]]),
    "8 tets": lambda: fan(8),
    "one more than a batch": lambda: fan(LANES + 1),
    "irregular": lambda: block(cells=(2, 2, 1), irregular=0.3, seed=3),
    "several pieces": several_pieces,
    "flat": lambda: block(cells=2, irregular=0.3).moved(np.diag([1.0, 1.0, 1e-3])),
}  # fmt: skip


def vectors(net: ControlNet, sides: int = 1, seed: int = 7) -> Floats:
    """Displacements (c, 3, s) without any structure."""
    return np.random.default_rng(seed).standard_normal((net.count, 3, sides))


def matrix_of(net: ControlNet) -> BlockMatrix:
    """The oracle."""
    return assembled(net, *np.ascontiguousarray(LAME[net.mesh.region].T))


def apart(found: Floats, expected: Floats) -> float:
    """How far forces are apart, relative to the largest."""
    return float(np.abs(found - expected).max() / np.abs(expected).max())


@pytest.mark.parametrize("instructions", SETS)
@pytest.mark.parametrize("degree", DEGREES)
def test_it_does_what_the_matrix_does(degree: int, instructions: str) -> None:
    net = ControlNet(materials(block(cells=(2, 2, 1), irregular=0.3, seed=3)), degree)
    K, u = matrix_of(net), vectors(net, 8)
    expected = np.stack([K @ u[..., side] for side in range(8)], axis=-1)
    operator = MatrixFree(net, LAME, 2, instructions)
    assert operator.kernel.instructions == instructions
    for sides in range(1, 9):
        x, f = u[..., :sides], expected[..., :sides]
        assert apart(operator @ x, f) < ROUNDING, sides
        assert apart(operator.single(x.astype(np.float32)), f) < SINGLE, sides


@pytest.mark.parametrize("instructions", SETS)
@pytest.mark.parametrize("degree", DEGREES)
def test_its_energy_is_half_the_work_of_its_forces(degree: int, instructions: str) -> None:
    """On so many tets that no lane can stand for another."""
    net = ControlNet(materials(block(cells=(2, 2, 1), irregular=0.3, seed=3)), degree)
    K, u = matrix_of(net), vectors(net)[..., 0]
    work = float((u * (K @ u)).sum())
    assert abs(MatrixFree(net, LAME, 2, instructions).energy(u) * 2 / work - 1) < ROUNDING


@pytest.mark.parametrize("instructions", SETS)
@pytest.mark.parametrize("name", MESHES)
def test_any_mesh(name: str, instructions: str) -> None:
    mesh = materials(MESHES[name]())
    for degree in (1, 2, 3, 4, 7):
        net = ControlNet(mesh, degree)
        operator, K = MatrixFree(net, LAME, 1, instructions), matrix_of(net)
        for sides in (1, 3):
            u = vectors(net, sides)
            expected = np.stack([K @ u[..., s] for s in range(sides)], axis=-1)
            assert apart(operator @ u, expected) < ROUNDING
            assert apart(operator.single(u.astype(np.float32)), expected) < SINGLE


CHUNKED = {1: 16, 2: 9, 3: 7, 4: 5, 6: 4}
"""Cells along a cube whose tets take several chunks at that degree."""


@pytest.mark.parametrize("degree", CHUNKED)
def test_chunks_add_what_they_share(degree: int) -> None:
    """Controls that several chunks touch: forgotten, twice or in the wrong place is seen here."""
    net = ControlNet(materials(block(cells=CHUNKED[degree], irregular=0.3)), degree)
    assert net.count > 2 * 1500, "a chunk has 1500 controls at least"
    K = matrix_of(net)
    for instructions, threads in product(SETS, (1, 2)):
        operator = MatrixFree(net, LAME, threads, instructions)
        for sides in (1, 5, 12):
            u = vectors(net, sides)
            expected = np.stack([K @ u[..., s] for s in range(sides)], axis=-1)
            assert apart(operator @ u, expected) < ROUNDING
            assert apart(operator.single(u.astype(np.float32)), expected) < SINGLE


@pytest.mark.parametrize("degree", [1, 2, 3, 5])
def test_many_chunks_too(degree: int) -> None:
    """Larger chunks and more, too large for a matrix: an affine field knows its forces by itself.

    Stress is constant, so forces vanish inside, and sum_a f_a x_a^T = V T exactly.
    """
    cells = {1: 40, 2: 22, 3: 16, 5: 10}[degree]
    net = ControlNet(block(cells=cells, irregular=0.3), degree)
    H = np.array([[0.3, -0.1, 0.2], [0.5, 0.7, -0.4], [0.1, 0.2, -0.6]])
    u = net.points @ H.T
    lam, mu = LAME[0]
    stress = lam * np.trace(H) * np.eye(3) + mu * (H + H.T)
    f = MatrixFree(net, LAME[:1], 2) @ u
    assert float((u * f).sum()) == pytest.approx(float((H * stress).sum()), rel=1e-12)
    inside = np.ones(net.count, bool)
    for side in net.mesh.surfaces:
        inside[net.of_place(side)] = False
    assert np.abs(f[inside]).max() < ROUNDING * np.abs(f).max() * 10
    moment = np.einsum("ci,cj->ij", f, net.points)
    np.testing.assert_allclose(moment, stress, atol=1e-12)


@pytest.mark.parametrize("degree", DEGREES)
@pytest.mark.parametrize("tets_at_once", [5, 1 << 12])
def test_its_diagonal_is_that_of_the_matrix(
    degree: int, tets_at_once: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("bezsoma.equations.matrix_free.TETS_AT_ONCE", tets_at_once)
    net = ControlNet(materials(block(cells=(2, 1, 2), irregular=0.3)), degree)
    found = MatrixFree(net, LAME).diagonal()
    expected = matrix_of(net).diagonal
    assert apart(found, expected) < ROUNDING


def test_rigid_motions_cost_nothing() -> None:
    turn = np.array([[0, -3.0, 2], [3, 0, -1], [-2, 1, 0]])
    for degree in DEGREES:
        net = ControlNet(materials(shell(1.0, 1.2, cells=3)), degree)
        u = net.points @ turn.T + [1, 2, 3]
        operator = MatrixFree(net, LAME)
        unit = np.abs(operator @ vectors(net)[..., 0]).max()
        assert np.abs(operator @ u).max() < ROUNDING * unit * 10


def test_symmetric_and_linear() -> None:
    for degree in (1, 2, 4, 9):
        net = ControlNet(materials(block(cells=2, irregular=0.3)), degree)
        operator = MatrixFree(net, LAME)
        u, v = np.moveaxis(vectors(net, 2), -1, 0)
        Ku, Kv = operator @ u, operator @ v
        size = np.abs(v * Ku).sum()
        assert abs(float((v * Ku).sum() - (u * Kv).sum())) < ROUNDING * size
        assert apart(operator @ (3 * u - 2 * v), 3 * Ku - 2 * Kv) < ROUNDING


def test_the_order_of_tets_and_vertices_does_not_matter() -> None:
    """Another order puts every tet into another lane, batch and chunk."""
    for degree in (1, 2, 3, 6):
        mesh = materials(block(cells=(5, 4, 4), irregular=0.3))
        random = np.random.default_rng(degree)
        new = random.permutation(len(mesh.points))
        points, order = np.empty_like(mesh.points), random.permutation(len(mesh.tets))
        points[new] = mesh.points
        other = TetMesh(points, new[mesh.tets][order], mesh.region[order], mesh.regions)
        nets = ControlNet(mesh, degree), ControlNet(other, degree)
        fields = [np.sin(5 * net.points + [0.1, 0.2, 0.3]) for net in nets]
        forces = [MatrixFree(n, LAME) @ u for n, u in zip(nets, fields, strict=True)]
        # the same control is where the points are the same: domain points are distinct
        ranks = [np.lexsort(np.round(net.points, 9).T) for net in nets]
        aligned = [f[rank] for f, rank in zip(forces, ranks, strict=True)]
        assert apart(aligned[1], aligned[0]) < 10 * ROUNDING


def test_sides_do_not_know_of_each_other() -> None:
    """NaN in one right-hand side stays there, and a side's answer does not depend on the others."""
    net = ControlNet(materials(block(cells=(5, 4, 4), irregular=0.3)), 3)
    operator, u = MatrixFree(net, LAME), vectors(net, 5)
    expected = operator @ u
    for side in range(5):
        spoilt = u.copy()
        spoilt[..., side] = np.nan
        found = operator @ spoilt
        assert np.isnan(found[..., side]).all()
        others = [s for s in range(5) if s != side]
        assert (found[..., others] == expected[..., others]).all()
    for side in range(5):
        assert apart(operator @ u[..., side], expected[..., side]) < ROUNDING


def test_what_is_read_beyond_a_run_is_never_used() -> None:
    """A gather may read past a run: a NaN in one control reaches the tets around it only."""
    for degree in (1, 2, 3, 4, 6):
        net = ControlNet(materials(block(cells=(4, 3, 3), irregular=0.3)), degree)
        operator, u = MatrixFree(net, LAME), vectors(net)[..., 0]
        for control in np.linspace(0, net.count - 1, 7).astype(int):
            spoilt = u.copy()
            spoilt[control] = np.nan
            reached = np.unique(net.of_tet[(net.of_tet == control).any(axis=1)])
            found = np.unique(np.nonzero(np.isnan(operator @ spoilt))[0])
            assert found.tolist() == reached.tolist()


@pytest.mark.parametrize("degree", CHUNKED)
def test_applied_again_it_gives_the_same_bits(degree: int) -> None:
    net = ControlNet(materials(block(cells=CHUNKED[degree], irregular=0.3)), degree)
    operator = MatrixFree(net, LAME, 2)
    u = vectors(net, 4)
    first, single = operator @ u[..., 0], operator.single(u.astype(np.float32))
    for sides in (3, 1, 4, 2):  # scratch of another size between
        operator @ u[..., :sides]
        assert (operator @ u[..., 0] == first).all()
    assert (operator.single(u.astype(np.float32)) == single).all()


def test_what_forces_held_before_does_not_matter() -> None:
    """Forces are cleared piece by piece, before they are first met: none is forgotten."""
    for degree, cells in CHUNKED.items():
        net = ControlNet(materials(block(cells=cells, irregular=0.3)), degree)
        operator = MatrixFree(net, LAME, 2)
        for sides in (1, 3, 5, 8):
            u = vectors(net, sides)
            f = np.full_like(u, np.nan)
            operator.kernel.apply(u, f)
            assert np.isfinite(f).all()


def test_a_body_of_materials_is_the_sum_of_its_regions() -> None:
    net = ControlNet(materials(block(cells=3, irregular=0.3)), 3)
    u = vectors(net)[..., 0]
    whole = MatrixFree(net, LAME) @ u
    one = [np.where(np.arange(len(LAME))[:, None] == r, LAME, 0.0) for r in range(len(LAME))]
    assert apart(sum(MatrixFree(net, lame) @ u for lame in one), whole) < ROUNDING


@pytest.mark.parametrize("scale", [1e-6, 1e6])
@pytest.mark.parametrize("modulus", [1e-120, 1e6, 1e120])
def test_units_do_not_matter(scale: float, modulus: float) -> None:
    mesh = materials(block(cells=2, irregular=0.3))
    nets = ControlNet(mesh, 3), ControlNet(mesh.moved(np.eye(3) * scale), 3)
    u = vectors(nets[0])[..., 0]
    expected = MatrixFree(nets[0], LAME) @ u
    found = MatrixFree(nets[1], LAME * modulus) @ u
    assert apart(found / modulus / scale, expected) < ROUNDING


def test_shapes_that_do_not_fit_are_refused() -> None:
    net = ControlNet(block(), 2)
    operator = MatrixFree(net, LAME[:1])
    with pytest.raises(ValueError, match="one row a control"):
        operator @ np.zeros((net.count - 1, 3))
    with pytest.raises(ValueError, match="as many sides"):
        operator.kernel.apply(np.zeros((net.count, 3, 2)), np.zeros((net.count, 3, 1)))
    for shape in ((net.count, 2, 3), (net.count, 6), (3 * net.count,)):
        with pytest.raises(ValueError, match=r"has to be \(c, 3\)"):
            operator @ np.zeros(shape)
    with pytest.raises(TypeError):
        operator.kernel.apply(np.zeros((net.count, 3, 1)), np.zeros((net.count, 3, 1), np.float32))  # type: ignore[arg-type]
    both = np.zeros((net.count + 1, 3, 1))
    for y in (both[:-1], both[1:]):
        with pytest.raises(ValueError, match="must not share memory"):
            operator.kernel.apply(both[:-1], y)
    with pytest.raises(ValueError, match="region must number"):
        MatrixFree(net, LAME[:0]).kernel  # noqa: B018
    with pytest.raises(ValueError, match="lacks that instruction set"):
        MatrixFree(net, LAME[:1], 0, "mmx").kernel  # noqa: B018


@pytest.mark.parametrize("number", [-1, 2])
def test_a_region_that_lame_lacks_is_refused_by_all(number: int) -> None:
    net = ControlNet(block(), 2)
    region = np.zeros(len(net.mesh.tets), np.int64)
    region[3] = number
    operator = MatrixFree(net, LAME[:2], region=region)
    with pytest.raises(ValueError, match="region must number"):
        operator @ np.zeros((net.count, 3))
    with pytest.raises(InputError, match=f"region must number .* 2 rows.* tet 3 has {number};"):
        operator.diagonal()
    for wrong in (region[1:], region + 0.5):
        with pytest.raises(InputError, match="one whole number a tet is needed"):
            MatrixFree(net, LAME[:2], region=wrong).diagonal()


def test_what_is_no_array_of_floats() -> None:
    """Complex numbers would lose their imaginary part; lists and whole numbers are taken."""
    net = ControlNet(block(), 2)
    operator = MatrixFree(net, LAME[:1])
    x = vectors(net)[..., 0]
    for apply in (operator.__matmul__, operator.single):
        with pytest.raises(ValueError, match=r"x is complex128, .* x\.real and x\.imag"):
            apply(x + 1j)
    expected = operator @ x
    assert ((operator @ x.tolist()) == expected).all()
    assert ((operator @ np.asfortranarray(x)) == expected).all()
    assert (operator.single(x.tolist()) == operator.single(x.astype(np.float32))).all()
    whole = np.arange(3 * net.count).reshape(-1, 3) % 7
    assert ((operator @ whole) == (operator @ whole.astype(float))).all()


def test_floats_one_after_another_are_not_copied() -> None:
    x = vectors(ControlNet(block(), 2), sides=4)
    for given in (x, x[..., 0].copy()):
        rows, shape = _rows(given, np.float64)
        assert np.shares_memory(rows, given) and shape == given.shape


@pytest.mark.parametrize("degree", DEGREES)
def test_the_ladder_is_the_mass_matrix(degree: int) -> None:
    """M^m = sum_j a_j E_j E_j^T with a_j = C(m,j)^2 / (C(2m,m) C(2m+3,3)), in whole numbers.

    With E_j = F_j / C(m,j), F_j[b, a] = prod_i C(b_i, a_i), and C(2m,m) C(2m+3,3) M the products
    of C(a_i + b_i, a_i), it is Vandermonde's sum_g C(a, g) C(b, g) = C(a + b, a), four times.
    """
    m = degree - 1
    top = bernstein.indices(m, 3)
    total = np.zeros((len(top),) * 2, dtype=np.int64)
    for j in range(m + 1):
        F = BINOMIAL[top[:, None, :], bernstein.indices(j, 3)].prod(axis=-1)
        total += F @ F.T
        elevation = bernstein.elevation(j, 3, m - j) if j < m else np.eye(len(top))
        np.testing.assert_allclose(F / comb(m, j), elevation, rtol=1e-14)
    mass = BINOMIAL[top[:, None, :] + top, top].prod(axis=-1)
    assert (total == mass).all()
    scale = comb(2 * m, m) * comb(2 * m + 3, 3)
    np.testing.assert_allclose(mass / scale, bernstein.mass(m, m, 3), rtol=1e-14)


BINOMIAL = np.array([[comb(n, k) for k in range(21)] for n in range(21)])
