# SPDX-License-Identifier: BSD-3-Clause
"""Forces and tangents of laws without a matrix, against a plain assembly at the same points."""

from __future__ import annotations

import numpy as np
import pytest

from bezsoma import _core, bernstein
from bezsoma.arrays import Floats
from bezsoma.equations.matrix_free import MatrixFree
from bezsoma.equations.mixed_pointwise_free import PointwiseMixed
from bezsoma.equations.pointwise_free import PointwiseFree
from bezsoma.errors import Inadmissible
from bezsoma.mesh import ControlNet, TetMesh, block
from laws import plain_energies as plain
from tolerances import CLOSED_FORM, ROUNDING, SINGLE

SETS = _core.instruction_sets()
SEVERAL = ("mooney_rivlin", "stiffening_frobenius", "ogden", "guccione")
HYPERELASTIC = ("mooney_rivlin", "ogden", "guccione", "neo_hooke_isochoric")
KINDS = [(degree, True) for degree in range(1, 7)] + [(degree, False) for degree in (1, 2, 3)]
"""Degrees with a rule that comes in fours, and with one that does not."""


def law(name: str) -> _core.Law:
    return _core.Law(name, plain.PARAMETERS[name])


def regions(cells: int = 2) -> TetMesh:
    """Irregular, its tets spread over four regions in no order."""
    mesh = block(cells=cells, irregular=0.3, seed=3)
    region = np.random.default_rng(1).integers(0, 4, len(mesh.tets))
    return TetMesh(mesh.points, mesh.tets, region, ("a", "b", "c", "d"))


def moved(net: ControlNet, size: float = 0.02) -> Floats:
    return np.asarray(size * np.sin(5 * net.points + [0, 1, 2]))


def apart(found: Floats, expected: Floats) -> float:
    return float(np.abs(found - expected).max() / np.abs(expected).max())


def slopes(net: ControlNet, points: Floats) -> Floats:
    """grad B_a at the points of each tet (t, q, m, 3)."""
    partial = bernstein.derivatives(net.degree, points)
    return np.asarray(np.einsum("qmi,tik->tqmk", partial, net.mesh.gradients))


def assembled(net: ControlNet, fields: Floats, answers: Floats, weights: Floats) -> Floats:
    """sum_q w V P grad B_a from P (t, q, 3, 3) and the slopes of the B_a."""
    scale = net.mesh.volumes[:, None] * weights
    local = np.einsum("tq,tqkl,tqml->tmk", scale, answers, fields)
    total = np.zeros((net.count, 3))
    np.add.at(total, net.of_tet, local)
    return total


def by_region(mesh: TetMesh, H: Floats, answer: list[Floats]) -> Floats:
    """Each tet's own of the answers of all laws (laws, t, q, ...)."""
    return np.asarray(np.stack(answer)[mesh.region, np.arange(len(mesh.tets))])


@pytest.mark.parametrize("instructions", SETS)
@pytest.mark.parametrize(("degree", "fours"), KINDS)
def test_against_a_plain_assembly(degree: int, fours: bool, instructions: str) -> None:
    """Several regions whose laws differ in kind; forces and tangents, also in float32."""
    net, laws = ControlNet(regions(), degree), [law(name) for name in SEVERAL]
    points, weights = bernstein.simplex(8 if fours else 30, 3)
    if not fours:
        points, weights = points[:90], weights[:90] / weights[:90].sum()
    operator = PointwiseFree(net, tuple(laws), points, weights, 2, instructions)
    u, du = moved(net), np.cos(9 * net.points)
    B = slopes(net, points)
    H, dH = (np.einsum("tmk,tqml->tqkl", x[net.of_tet], B) for x in (u, du))
    flat, changes = H.reshape(-1, 3, 3), dH.reshape(-1, 3, 3)
    P = by_region(net.mesh, H, [one.stress(flat).reshape(H.shape) for one in laws])
    dP = by_region(net.mesh, H, [one.derivative(flat, changes).reshape(H.shape) for one in laws])
    assert apart(operator.forces(u), assembled(net, B, P, weights)) < CLOSED_FORM
    tangent = operator.tangent(u)
    expected = assembled(net, B, dP, weights)
    assert apart(tangent.apply(du), expected) < CLOSED_FORM
    assert tangent.rough is not None
    assert apart(tangent.rough(du.astype(np.float32)), expected) < 10 * SINGLE
    assert not tangent.symmetric


def test_the_order_of_the_points_is_of_no_matter() -> None:
    """Those that come in fours are found wherever they stand, with their own weights."""
    net, laws = ControlNet(regions(), 3), tuple(law(name) for name in HYPERELASTIC)
    points, weights = bernstein.simplex(8, 3)
    order = np.random.default_rng(5).permutation(len(points))
    sorted_, shuffled = (
        PointwiseFree(net, laws, points[each], weights[each]) for each in (slice(None), order)
    )
    u, du = moved(net), np.cos(9 * net.points)
    assert len(set(weights)) > 2
    assert apart(shuffled.forces(u), sorted_.forces(u)) < ROUNDING
    assert apart(shuffled.tangent(u).apply(du), sorted_.tangent(u).apply(du)) < ROUNDING
    assert abs(shuffled.energy(u) / sorted_.energy(u) - 1) < ROUNDING


def test_a_state_beyond_float32_is_taken_in_float64() -> None:
    """exp(200) is no number there: there is no rough product then."""
    net, rule = ControlNet(block(), 2), bernstein.simplex(6, 3)
    stiff = _core.Law("stiffening_frobenius", [3.0, 0.7, 50.0])
    u, du = np.zeros((net.count, 3)), np.cos(9 * net.points)
    u[:, 2] = 2.0 * net.points[:, 2]
    tangent = PointwiseFree(net, (stiff,), *rule).tangent(u)
    assert np.abs(tangent.apply(du)).max() > 1e80
    assert tangent.rough is None


@pytest.mark.parametrize("degree", [1, 2, 3, 4, 7, 10])
def test_the_linear_law_needs_no_quadrature(degree: int) -> None:
    net = ControlNet(block(cells=2, irregular=0.3), degree)
    points, weights = bernstein.simplex(2 * (degree - 1), 3)
    operator = PointwiseFree(net, (law("linear"),), points, weights)
    K = MatrixFree(net, np.array([[plain.KAPPA - 2 * plain.MU / 3, plain.MU]]))
    u = moved(net, 1.0)
    assert apart(operator.forces(u), K @ u) < ROUNDING
    assert apart(operator.tangent(3 * u).apply(u), K @ u) < ROUNDING
    assert operator.energy(u) == pytest.approx(K.energy(u), rel=ROUNDING)
    assert operator.symmetric


@pytest.mark.parametrize("mixed", [False, True])
def test_forces_are_the_slope_of_the_energy(mixed: bool) -> None:
    mesh = regions()
    net, pressures = ControlNet(mesh, 3), ControlNet(mesh, 2)
    laws = tuple(law(name) for name in HYPERELASTIC)
    rule = bernstein.simplex(8, 3)
    u, du, h = moved(net), np.cos(9 * net.points), 1e-6
    p, dp = np.cos(pressures.points[:, 0]), np.sin(5 * pressures.points[:, 1])
    if mixed:
        both = PointwiseMixed(net, pressures, laws, *rule)
        slope = (both.energy(u + h * du, p + h * dp) - both.energy(u - h * du, p - h * dp)) / 2 / h
        f, g = both.forces(u, p)
        assert slope == pytest.approx(np.vdot(f, du) + g @ dp, rel=1e-7)
    else:
        one = PointwiseFree(net, laws, *rule)
        slope = (one.energy(u + h * du) - one.energy(u - h * du)) / (2 * h)
        assert slope == pytest.approx(np.vdot(one.forces(u), du), rel=1e-7)


@pytest.mark.parametrize("instructions", SETS)
@pytest.mark.parametrize(("degree", "lower"), [(2, 1), (3, 1), (3, 2), (5, 4), (8, 6)])
def test_the_mixed_form_against_a_plain_assembly(
    degree: int, lower: int, instructions: str
) -> None:
    mesh = regions(1)
    net, pressures = ControlNet(mesh, degree), ControlNet(mesh, lower)
    laws = [law(name) for name in SEVERAL]
    points, weights = bernstein.simplex(8, 3)
    operator = PointwiseMixed(net, pressures, tuple(laws), points, weights, 2, instructions)
    u, p, du = moved(net), np.cos(pressures.points[:, 0]), np.cos(9 * net.points)
    dp = np.sin(5 * pressures.points[:, 1])
    B, q = slopes(net, points), bernstein.values(lower, points)
    H, dH = (np.einsum("tmk,tqml->tqkl", x[net.of_tet], B) for x in (u, du))
    s, ds = (np.einsum("tm,qm->tq", x[pressures.of_tet], q) for x in (p, dp))
    flat = [x.reshape(-1, 3, 3) for x in (H, dH)]
    pairs = [
        [one.mixed_stress(flat[0], s.ravel()) for one in laws],
        [one.mixed_derivative(flat[0], s.ravel(), flat[1], ds.ravel()) for one in laws],
    ]
    found = [operator.forces(u, p), operator.tangent(u, p).apply(du, dp)]
    for (f, g), answers in zip(found, pairs, strict=True):
        P = by_region(mesh, H, [a[0].reshape(H.shape) for a in answers])
        c = by_region(mesh, H, [a[1].reshape(s.shape) for a in answers])
        assert apart(f, assembled(net, B, P, weights)) < CLOSED_FORM
        scale = mesh.volumes[:, None] * weights
        expected = np.zeros(pressures.count)
        np.add.at(expected, pressures.of_tet, np.einsum("tq,tq,qm->tm", scale, c, q))
        assert apart(g, expected) < CLOSED_FORM


def test_the_same_bits_for_any_number_of_threads() -> None:
    mesh = regions(6)
    net, pressures = ControlNet(mesh, 3), ControlNet(mesh, 2)
    rule = bernstein.simplex(8, 3)
    laws = tuple(law(name) for name in SEVERAL)
    u, du, p = moved(net, 0.01), np.cos(9 * net.points), np.cos(pressures.points[:, 0])
    found = []
    for threads in (1, 2, 5):
        one = PointwiseFree(net, laws, *rule, threads)
        both = PointwiseMixed(net, pressures, laws, *rule, threads)
        found.append(
            (
                one.forces(u),
                one.tangent(u).apply(du),
                one.tangent(u)._in_single(du.astype(np.float32)),
                *both.forces(u, p),
                *both.tangent(u, p).apply(du, p),
            )
        )
        assert one.least_jacobian(u) == PointwiseFree(net, laws, *rule, 1).least_jacobian(u)
    for more in found[1:]:
        assert all(np.array_equal(a, b) for a, b in zip(found[0], more, strict=True))


def test_it_says_where_the_least_jacobian_is() -> None:
    net = ControlNet(regions(), 2)
    points, weights = bernstein.simplex(8, 3)
    operator = PointwiseFree(net, (law("neo_hooke"),) * 4, points, weights)
    u = moved(net, 0.05)
    H = np.einsum("tmk,tqml->tqkl", u[net.of_tet], slopes(net, points))
    J = np.linalg.det(H + np.eye(3))
    least, tet, point = operator.least_jacobian(u)
    assert least == pytest.approx(J.min(), rel=CLOSED_FORM)
    assert J[tet, point] == J.min()


def test_a_state_that_a_law_cannot_bear_is_refused_with_its_place() -> None:
    mesh = regions()
    net = ControlNet(mesh, 2)
    points, weights = bernstein.simplex(6, 3)
    inside_out = PointwiseFree(net, (law("neo_hooke"),) * 4, points, weights)
    u = np.zeros((net.count, 3))
    u[:, 0] = -1.5 * net.points[:, 0]
    with pytest.raises(Inadmissible, match=r"J = -0.5 in region '.', tet") as refused:
        inside_out.forces(u)
    assert refused.value.what == "J"
    assert refused.value.region == mesh.regions[mesh.region[refused.value.tet]]
    with pytest.raises(Inadmissible, match=r"J = -0\.5"):
        inside_out.energy(u)
    stiff = PointwiseFree(net, (law("stiffening_frobenius"),) * 4, points, weights)
    with pytest.raises(Inadmissible, match="exponent = 2000 in region"):
        stiff.forces(20 * u / 1.5)
    with pytest.raises(Inadmissible, match="= nan in region"):
        stiff.forces(u * np.nan)


def test_what_does_not_fit_is_refused() -> None:
    net = ControlNet(block(), 2)
    points, weights = bernstein.simplex(6, 3)
    with pytest.raises(ValueError, match="one law a region"):
        PointwiseFree(net, (law("linear"),) * 2, points, weights).forces(net.points)
    with pytest.raises(ValueError, match="no energy"):
        PointwiseFree(net, (law("stiffening_mean"),), points, weights).energy(net.points)
    with pytest.raises(ValueError, match="needs the mixed form"):
        PointwiseFree(net, (_core.Law("linear", [np.inf, 1]),), points, weights).forces(net.points)
    with pytest.raises(ValueError, match="does not split"):
        pressures = ControlNet(net.mesh, 1)
        PointwiseMixed(net, pressures, (law("neo_hooke"),), points, weights).forces(
            net.points, np.zeros(pressures.count)
        )
