# SPDX-License-Identifier: BSD-3-Clause
"""The mixed form against scikit-fem's Taylor-Hood elements, same tets, P2/P1."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest

import bezsoma as bz
from tolerances import MIXED_TWIN
from twins.bodies import (
    BACK,
    BOTTOM,
    FRONT,
    LEFT,
    RIGHT,
    TOP,
    Told,
    jaw,
    planes,
    pressed_ball,
    slab,
)
from twins.scikit import Floats, Held, Volume
from twins.taylor_hood import TaylorHood

NUS = (0.3, 0.4999, 0.5)
MIXED = "soft beside rigid"
STIFF = (0.015, 1.5, 0.2)


def enclosed(irregular: float) -> Told:
    """All six sides given a motion that keeps every volume, and a force inside."""
    whole = bz.Polynomial.parse(["0.1*x**2 + 0.2*y*z", "-0.2*x*y + 0.1*z", "0.1*x - 0.1*y**2"])
    names = ("left", "right", "front", "back", "bottom", "top")
    sides = (LEFT, RIGHT, FRONT, BACK, BOTTOM, TOP)
    held = tuple(Held(name, side, stirred) for name, side in zip(names, sides, strict=True))
    force = bz.BodyForce(bz.Polynomial.parse(["0.01*y*z", "-0.02*x", "0.03*x**2"]))
    return Told(
        slab(irregular),
        ((bz.Prescribed(*names, value=whole), held),),
        ((force, Volume(pushed)),),
    )


def stirred(x: Floats) -> Floats:
    x, y, z = x.T
    return np.stack([0.1 * x**2 + 0.2 * y * z, -0.2 * x * y + 0.1 * z, 0.1 * x - 0.1 * y**2], 1)


def pushed(x: Floats, n: Floats) -> Floats:
    x, y, z = x.T
    return np.stack([0.01 * y * z, -0.02 * x, 0.03 * x**2], axis=1)


@lru_cache(maxsize=1)
def solved(build, irregular: float, nu) -> tuple[bz.Solution, TaylorHood]:  # type: ignore[no-untyped-def]
    told = build(irregular)
    count = len(told.mesh.regions)
    nus = (0.5, 0.3, -0.3) if nu == MIXED else (nu,) * 3
    moduli = tuple(zip(STIFF, nus, strict=True))[:count]
    laws = {r: bz.LinearElastic(*pair) for r, pair in zip(told.mesh.regions, moduli, strict=True)}
    supports, loads = [ours for ours, _ in told.supports], [ours for ours, _ in told.loads]
    body = bz.Body(told.mesh, 2, laws, supports, loads, told.joins, pressure_degree=1)
    plain = replace(told).twin(2)
    names = ("points", "tets", "region", "degree", "supports", "loads")
    given = {name: getattr(plain, name) for name in names}
    level = build is enclosed and nu == 0.5
    twin = TaylorHood(moduli=moduli, enclosed=level, **given)
    return bz.solve(body, solver="direct", rtol=1e-12), twin


@pytest.fixture(
    scope="module",
    params=[
        (b, i, nu)
        for b in (jaw, planes, pressed_ball, enclosed)
        for i in (0.0, 0.3)
        for nu in (*NUS, MIXED)
        if not (b is pressed_ball and nu == MIXED)
    ],
    ids=lambda given: f"{given[0].__name__}-{given[1]}-{given[2]}",
)
def pair(request: pytest.FixtureRequest) -> tuple[bz.Solution, TaylorHood]:
    return solved(*request.param)


def apart(ours: Floats, theirs: Floats) -> float:
    return float(np.abs(ours - theirs).max() / np.abs(theirs).max())


def test_displacement_pressure_and_energy(pair: tuple[bz.Solution, TaylorHood]) -> None:
    ours, twin = pair
    points = twin.samples.reshape(-1, 3)
    assert apart(ours.displacement.at(points), twin.sampled.reshape(-1, 3)) < MIXED_TWIN
    assert ours.pressure is not None
    assert apart(ours.pressure.at(points), twin.sampled_pressure.ravel()) < MIXED_TWIN
    assert ours.energy == pytest.approx(twin.energy, rel=MIXED_TWIN)


def test_stress_is_that_of_shear_and_pressure(pair: tuple[bz.Solution, TaylorHood]) -> None:
    """Eq. 16 pointwise, from the twin's own gradient and pressure."""
    ours, twin = pair
    H, p = twin.gradient, twin.sampled_pressure[..., None, None]
    eps = (H + np.swapaxes(H, -1, -2)) / 2
    third = np.trace(H, axis1=2, axis2=3)[..., None, None] / 3
    theirs = 2 * twin.shear[:, :, None, None] * (eps - third * np.eye(3)) - p * np.eye(3)
    found = ours.stress.at(twin.samples.reshape(-1, 3)).reshape(theirs.shape)
    assert apart(found, theirs) < MIXED_TWIN


def test_the_level_is_stated(pair: tuple[bz.Solution, TaylorHood]) -> None:
    ours, twin = pair
    assert ours.level.startswith("not determined") == twin.enclosed
