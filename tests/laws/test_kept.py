# SPDX-License-Identifier: BSD-3-Clause
"""A preconditioner that is kept as long as it pays, and the moduli from which a new one is made."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import bezsoma as bz
from bezsoma.equations.matrix_free import MatrixFree
from bezsoma.equations.moduli import SOFTEST, moduli_at
from bezsoma.equations.pointwise import Pointwise
from bezsoma.mechanics.laws import at_rest, nearest_isotropic
from bezsoma.mesh.control_net import ControlNet
from bezsoma.solvers import kept
from bezsoma.solvers.kept import Kept
from bezsoma.solvers.multigrid import preconditioned

E, NU = 0.015, 0.45


def heard(*solves: tuple[int, float]) -> Kept:
    """One at the first tangent that has heard of solves (iterations, rtol) in turn."""
    one = Kept(lambda x: lambda r: r)
    one(np.ones(1))
    for iterations, rtol in solves:
        one.learn(iterations, rtol)
        one.at(np.zeros(1))
    return one


def test_it_is_kept_while_solves_cost_what_they_did() -> None:
    assert heard(*[(40, 1e-4)] * 30).built == 1
    assert heard((10, 1e-1), (40, 1e-4), (80, 1e-8)).built == 1  # so many more digits


def test_it_is_built_anew_when_what_is_lost_has_come_to_its_price() -> None:
    assert heard((40, 1e-4), (40 + int(kept.COST), 1e-4)).built == 1
    assert heard((40, 1e-4), (41 + int(kept.COST), 1e-4)).built == 2
    assert heard((40, 1e-4), *[(44, 1e-4)] * 4).built == 2
    # A new one that takes as many is no reason for one more.
    assert heard((40, 1e-4), *[(60, 1e-4)] * 20).built == 2


def test_it_is_built_at_the_state_that_comes_next() -> None:
    states: list[Any] = []
    one = Kept(lambda x: states.append(x) or (lambda r: r))
    one(np.ones(1))
    one.learn(10, 1e-2)
    one.learn(100, 1e-2)
    one.at(np.full(3, 7.0))
    assert states[0] is None and np.array_equal(states[1], np.full(3, 7.0))


def test_one_with_which_a_solve_failed_is_not_kept() -> None:
    """The first solve after it was built has nothing to be measured against."""
    one = heard()
    one.failed()
    one.at(np.zeros(1))
    one.at(np.zeros(1))
    assert one.built == 2


LAWS = {
    "neo-Hooke": bz.NeoHooke(E, NU),
    "Mooney-Rivlin": bz.MooneyRivlin(0.4 * E, 0.1 * E, E),
    "stiffening": bz.Stiffening(E, NU, 5.0, "deviatoric"),
    "linear": bz.LinearElastic(E, NU),
}


@pytest.mark.parametrize("name", LAWS)
def test_moduli_at_rest_are_those_of_the_law(name: str) -> None:
    net = ControlNet(bz.block(cells=2), 2)
    found = moduli_at(Pointwise(net, [LAWS[name]], 6), 0 * net.points)
    assert np.abs(found - at_rest(LAWS[name])).max() < 1e-12 * E


def test_moduli_of_finite_strain_do_not_change_when_the_body_turns() -> None:
    net = ControlNet(bz.block(cells=2), 2)
    pointwise = Pointwise(net, [LAWS["Mooney-Rivlin"]], 6)
    bent = net.points + 0.1 * np.sin(2 * net.points[:, [1, 2, 0]])
    Q = np.linalg.qr(np.random.default_rng(5).standard_normal((3, 3)))[0]
    Q *= np.sign(np.linalg.det(Q))
    still = moduli_at(pointwise, bent - net.points)
    assert np.ptp(still[:, 1]) > 0.01 * E  # they do change from tet to tet
    assert np.abs(moduli_at(pointwise, bent @ Q.T - net.points) - still).max() < 1e-12 * E


def test_moduli_grow_as_the_law_stiffens_and_stay_positive_where_it_softens() -> None:
    net = ControlNet(bz.block(cells=1), 1)
    shear = net.points @ np.array([[0, 0, 0], [0, 0, 0], [0.8, 0, 0.0]])
    grown = moduli_at(Pointwise(net, [LAWS["stiffening"]], 6), shear)
    squared = 0.8**2 / 2  # eps':eps' of a shear of 0.8
    assert np.all(grown[:, 1] > np.exp(5 * squared) * at_rest(LAWS["stiffening"])[1])
    law = bz.StVenantKirchhoff(E, 0.3)  # whose tangent is not positive when pressed so far
    pressed = moduli_at(Pointwise(net, [law], 6), net.points * -0.5)
    lam, mu = at_rest(law)
    assert nearest_isotropic(law, -0.5 * np.eye(3)[None])[1] < 0
    assert np.allclose(pressed[:, 1], SOFTEST * mu)
    assert np.all(pressed @ [1, 2 / 3] >= SOFTEST * (lam + 2 * mu / 3) * (1 - 1e-12))


def test_moduli_stay_in_the_range_of_float32_where_an_exponential_all_but_overflows() -> None:
    """At A s^2 = 640 the tangent has numbers, the blocks of a preconditioner would have none."""
    net = ControlNet(bz.block(cells=2), 2)
    found = moduli_at(
        Pointwise(net, [LAWS["stiffening"]], 6), net.points * [16.0, 0.0, 0.0] / 1.155
    )
    assert found.max() < 1e10 * E
    operator = MatrixFree(net, found, region=np.arange(len(found)))
    r = np.where(net.points[:, 2:] > 0, net.points, 0.0)
    held = np.broadcast_to(net.points[:, 2:] == 0, r.shape)
    assert np.isfinite(preconditioned(operator, held)(r)).all()


def test_a_law_a_tet_is_a_law_a_region_where_they_are_the_same() -> None:
    net = ControlNet(bz.block(cells=2), 3)
    lame, u = np.array([[0.6, 0.4]]), np.sin(7 * net.points)
    many = len(net.mesh.tets)
    each = MatrixFree(net, np.tile(lame, (many, 1)), region=np.arange(many))
    assert np.array_equal(each @ u, MatrixFree(net, lame) @ u)
    double = MatrixFree(net, np.outer(1 + np.arange(many) % 2, lame), region=np.arange(many))
    assert not np.allclose(double @ u, MatrixFree(net, lame) @ u)


def sheared() -> bz.Body:
    """A slab drawn sideways by a quarter of its top: there it stiffens a hundredfold."""
    mesh = bz.block(size=(4.0, 4.0, 1.0), cells=(8, 8, 4))
    top = mesh.facets_of("top")
    middle = mesh.points[top].mean(axis=1)
    mesh = mesh.with_surface("patch", top[(middle[:, 0] < 2) & (middle[:, 1] < 2)])
    supports = [bz.Fixed("bottom"), bz.Moved("patch", translation=(0.9, 0, 0))]
    return bz.Body(mesh, 2, LAWS["stiffening"], supports)


def test_it_pays_where_part_of_a_body_stiffens(monkeypatch: pytest.MonkeyPatch) -> None:
    """466 iterations with the preconditioner of rest, 280 with those that are built anew."""
    body = sheared()
    found = bz.solve(body, solver="multigrid")
    monkeypatch.setattr(kept, "COST", np.inf)
    never = bz.solve(body, solver="multigrid")
    spent, before = (sum(each.linear for each in s.path) for s in (found, never))
    assert spent < 0.75 * before
    u, v = found.displacement.controls, never.displacement.controls
    assert np.abs(u - v).max() < 1e-8 * np.abs(v).max()
