# SPDX-License-Identifier: BSD-3-Clause
"""Rigid motions: what is found by geometry is what the matrix cannot resist."""

from __future__ import annotations

import sys
import tracemalloc
from types import FrameType
from typing import Any

import numpy as np
import pytest

from bezsoma.arrays import Bools, Floats
from bezsoma.equations import rigid
from bezsoma.equations.assembled import assembled
from bezsoma.equations.boundary import prescribed
from bezsoma.equations.parts import parts_of
from bezsoma.equations.rigid import refuse_rigid_motions, rigid_motions
from bezsoma.equations.stress import strain, stress
from bezsoma.mechanics import Body, Fixed, LinearElastic
from bezsoma.mesh import ControlNet, TetMesh, block
from bezsoma.mesh.field import Field
from tolerances import RIGID

HINGED = [[0, 1, 2, 3], [0, 4, 5, 6], [4, 5, 6, 7], [1, 2, 8, 9], [8, 10, 11, 12]]
"""Tets that meet at a point, by a face, by an edge, at a point."""


def hinged(seed: int = 0) -> TetMesh:
    """Four parts that hang together by vertices and an edge, in general position."""
    inner = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 0, 0], [0, -1, 0], [0, 0, -1]]
    outer = [[-1, -1, -1], [1, 1, 1], [1, 1, 0], [2, 2, 1], [1, 2, 2], [2, 1, 2]]
    points = np.array(inner + outer, float)
    return TetMesh(points + 0.1 * np.random.default_rng(seed).random((13, 3)), HINGED)


def zero_energies(net: ControlNet, held: Bools) -> int:
    """How many eigenvalues of the free part of the stiffness matrix vanish."""
    ones = np.ones(len(net.mesh.tets))
    K = assembled(net, ones, ones).scipy().toarray()
    free = ~held.ravel()
    scale = 1 / np.sqrt(K.diagonal()[free])
    sizes = np.abs(np.linalg.eigvalsh(scale[:, None] * K[np.ix_(free, free)] * scale))
    return int((sizes < RIGID).sum())


def motions(net: ControlNet, held: Bools) -> int:
    """How many independent motions are found; they are told part by part, so take the joint rank.

    A joint motion shows up in the basis of each part with the same columns.
    """
    left = rigid_motions(net, held, parts_of(net.mesh))
    groups: dict[int, list[Floats]] = {}
    for motion in left:
        groups.setdefault(motion.group, []).append(motion.basis)
    return sum(np.linalg.matrix_rank(np.concatenate(rows)) for rows in groups.values())


@pytest.mark.parametrize("seed", range(40))
@pytest.mark.parametrize("degree", [1, 2])
def test_as_many_as_the_matrix_has(seed: int, degree: int) -> None:
    random = np.random.default_rng(seed)
    net = ControlNet(hinged(seed), degree)
    held = np.zeros((net.count, 3), bool)
    for _ in range(random.integers(0, 22)):
        held[random.integers(net.count), random.integers(3)] = True
    assert motions(net, held) == zero_energies(net, held)


@pytest.mark.parametrize("faces", ["", "bottom", "bottom left", "bottom left front"])
def test_planes_of_symmetry(faces: str) -> None:
    net = ControlNet(block(cells=(2, 1, 1), irregular=0.2), 2)
    held = np.zeros((net.count, 3), bool)
    for face in faces.split():
        held[net.of_place(face), ["left", "front", "bottom"].index(face)] = True
    count = [6, 3, 1, 0][len(faces.split())]
    assert motions(net, held) == zero_energies(net, held) == count


@pytest.mark.parametrize("degree", [1, 2, 5, 10])
def test_rigid_motions_give_no_stress(degree: int) -> None:
    mesh = block(cells=2, irregular=0.2)
    body = Body(mesh, degree, LinearElastic(1.0, 0.45), [])
    net = ControlNet(mesh, degree)
    spin = np.array([[0, -3.0, 1], [3, 0, 2], [-1, -2, 0]])
    field = Field(net, net.points @ spin.T + [5.0, -7, 9])
    assert np.abs(strain(field).controls).max() < 1e-13 * np.abs(field.controls).max()
    assert np.abs(stress(body, field).controls).max() < 1e-12 * np.abs(field.controls).max()


def test_the_basis_is_of_motions_that_respect_what_holds() -> None:
    net = ControlNet(block(origin=(1000, -500, 200)), 1)
    held = np.zeros((net.count, 3), bool)
    held[0], held[1, 2] = True, True
    (left,) = rigid_motions(net, held, parts_of(net.mesh))
    for t, w in zip(left.basis[:3].T, left.basis[3:].T, strict=True):
        u = t + np.cross(w, (net.points - left.centre) / left.radius)
        assert np.abs(u[held]).max() < 1e-12


def test_a_ring_of_three_parts() -> None:
    """Three tets, each hinged to the next at one vertex of a triangle."""
    corners = [[0, 0, 0], [4, 0, 0], [2, 3, 0]]
    outside = [[2, -1, 1], [2, -1, -1], [4, 2, 1], [4, 2, -1], [0, 2, 1], [0, 2, -1]]
    mesh = TetMesh([*corners, *outside], [[0, 1, 3, 4], [1, 2, 5, 6], [2, 0, 7, 8]])
    net = ControlNet(mesh, 1)
    held = np.zeros((net.count, 3), bool)
    assert parts_of(mesh).count == 3
    assert motions(net, held) == zero_energies(net, held) == 9
    for vertex, expected in ((3, 6), (5, 3), (7, 0)):
        held[net.of_vertices(np.array([vertex]))] = True
        assert motions(net, held) == zero_energies(net, held) == expected


def test_frames_and_units_do_not_matter() -> None:
    for scale, shift in ((1e-6, 0.0), (1.0, 1e4), (1e3, -1e6), (1e-3, 1.0)):
        mesh = block(cells=2, irregular=0.2)
        mesh = TetMesh(mesh.points * scale + shift, mesh.tets, surfaces=mesh.surfaces)
        net = ControlNet(mesh, 2)
        held = np.zeros((net.count, 3), bool)
        for axis, place in enumerate(("left", "front", "bottom")):
            assert motions(net, held) == [6, 3, 1][axis]
            held[net.of_place(place), axis] = True
        assert motions(net, held) == 0


def calls_on(cells: int) -> tuple[int, float]:
    """How many calls of Python it takes to look at a held block, and the most bytes a tet."""
    mesh = block(cells=cells)
    net = ControlNet(mesh, 2)
    held = np.zeros((net.count, 3), bool)
    held[net.of_place("bottom")] = True
    assert len(net.of_tet)
    calls = 0

    def count(frame: FrameType, event: str, argument: Any) -> None:
        nonlocal calls
        calls += event == "call"

    tracemalloc.start()
    sys.setprofile(count)
    try:
        refuse_rigid_motions(net, held)
    finally:
        sys.setprofile(None)
        most = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
    return calls, most / len(mesh.tets)


def test_many_tets_are_no_more_steps() -> None:
    """Nothing is done tet by tet, nor kept for pairs of them."""
    few, many = calls_on(6), calls_on(18)
    assert many[0] < few[0] + 100
    assert many[1] < 2 * few[1]


def test_supports_of_a_body_hold_it() -> None:
    body = Body(block(), 3, LinearElastic(1.0, 0.3), [Fixed("top")])
    net = ControlNet(body.mesh, body.degree)
    refuse_rigid_motions(net, prescribed(body, net).mask)


def test_all_of_many_held_rows_count() -> None:
    """The bottom alone would let it slide and turn: the few rows at the top come last of many."""
    mesh = block(cells=24)
    supports = [Fixed("bottom", components="z"), Fixed("top", components="xy")]
    body = Body(mesh, 1, LinearElastic(E=1.0, nu=0.3), supports)
    net = ControlNet(mesh, 1)
    refuse_rigid_motions(net, prescribed(body, net).mask)


@pytest.mark.parametrize("count", [0, 1, 6, 7, 255, 256, 257, 1000, 70_000])
def test_fewer_rows_have_images_of_the_same_lengths(count: int) -> None:
    rows = np.random.default_rng(count).standard_normal((count, 6))
    rows[:, 5] = rows[:, 4]
    found = rigid._fewer(rows)
    assert len(found) <= 6
    assert np.abs(found.T @ found - rows.T @ rows).max(initial=0) <= 1e-12 * max(1, count)
