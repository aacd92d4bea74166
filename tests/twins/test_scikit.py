# SPDX-License-Identifier: BSD-3-Clause
"""BezSoma's answers against scikit-fem's on the same mesh and degree (docs/verification)."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import pytest

import bezsoma as bz
from tolerances import TWIN
from twins.bodies import BODIES
from twins.scikit import Floats, Twin

Pair = tuple[bz.Solution, Twin]


@lru_cache(maxsize=1)
def solved(name: str, irregular: float, degree: int) -> Pair:
    told = BODIES[name](irregular)
    return told.solution(degree), told.twin(degree)


@pytest.fixture(scope="module", params=[1, 2], ids=["degree 1", "degree 2"])
def degree(request: pytest.FixtureRequest) -> int:
    return request.param


@pytest.fixture(scope="module", params=[0.0, 0.3], ids=["regular", "irregular"])
def irregular(request: pytest.FixtureRequest) -> float:
    return request.param


@pytest.fixture(scope="module", params=list(BODIES))
def pair(request: pytest.FixtureRequest, irregular: float, degree: int) -> Pair:
    return solved(request.param, irregular, degree)


def apart(ours: Floats, theirs: Floats) -> float:
    """The largest difference, relative to the largest of theirs."""
    return float(np.abs(ours - theirs).max() / np.abs(theirs).max())


def at_samples(field: bz.Field | bz.BrokenField, twin: Twin) -> Floats:
    """A field's values (t, q, ...) at the twin's samples, found as a user would find them."""
    points = twin.samples
    return field.at(points.reshape(-1, 3)).reshape(*points.shape[:2], *field.shape)


def test_displacement_as_a_field(pair: Pair) -> None:
    ours, twin = pair
    assert apart(at_samples(ours.displacement, twin), twin.sampled) < TWIN


def test_displacement_at_vertices_and_midpoints(pair: Pair) -> None:
    """Where scikit-fem's unknowns lie: on faces, edges and vertices, shared by many tets."""
    ours, twin = pair
    found = ours.displacement.at(twin.basis.doflocs.T)
    theirs = twin.displacement
    rows = np.arange(len(theirs))
    assert apart(found[rows, twin.axis], theirs) < TWIN


def test_stress(pair: Pair) -> None:
    ours, twin = pair
    assert apart(at_samples(ours.stress, twin), twin.stress) < TWIN


def test_gradient_and_strain(pair: Pair) -> None:
    ours, twin = pair
    H = twin.gradient
    points = twin.samples
    found = ours.displacement.gradient(points.reshape(-1, 3)).reshape(H.shape)
    assert apart(found, H) < TWIN
    assert apart(at_samples(ours.strain, twin), (H + np.swapaxes(H, -1, -2)) / 2) < TWIN


def test_energy_and_volume_change(pair: Pair) -> None:
    ours, twin = pair
    assert ours.energy == pytest.approx(twin.energy, rel=TWIN)
    size = np.abs(np.trace(twin.gradient, axis1=2, axis2=3)).max() * twin.basis.dx.sum()
    assert abs(ours.volume_change - twin.volume_change) < TWIN * size


def test_reactions(pair: Pair) -> None:
    """Place by place, force and moment; together where places that hold the same meet.

    A control between two places counts for one of them. How much force that is depends on the
    functions it is measured by, and those of Bernstein and Lagrange differ from degree 2 on: the
    split between places that touch is no property of the body, their sum is.
    """
    ours, twin = pair
    split = not ours.body.joins or ours.net.degree == 1
    for places in [[place] for place in ours.reactions] if split else [list(ours.reactions)]:
        mine = [ours.reactions[place] for place in places]
        force, moment = twin.reaction(*places)
        size = np.abs(force).max()
        assert np.abs(sum(r.force for r in mine) - force).max() < TWIN * size
        assert np.abs(sum(r.moment for r in mine) - moment).max() < TWIN * size


def test_forces_of_loads_add_up_alike(pair: Pair) -> None:
    """The whole load by scikit-fem's quadrature, against BezSoma's reactions (balance)."""
    ours, twin = pair
    pushed = np.array([twin.forces[twin.axis == k].sum() for k in range(3)])
    pulled = sum(r.force for r in ours.reactions.values())
    size = max(np.abs(r.force).max() for r in ours.reactions.values())
    assert np.abs(pushed + pulled).max() < TWIN * size
