# SPDX-License-Identifier: BSD-3-Clause
"""Supports that leave rigid motions are refused with the motions named; look-alikes are not."""

from __future__ import annotations

import numpy as np
import pytest

from bezsoma.errors import InputError
from bezsoma.mechanics import Body, Fixed, LinearElastic, Moved, Prescribed, Support, Traction
from bezsoma.mesh import TetMesh, block
from bezsoma.solvers import solve

LAW = LinearElastic(1.0, 0.3)
CORNER = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)


def cube() -> TetMesh:
    """A unit cube with some of its vertices named."""
    mesh = block(cells=2)
    return (
        mesh.with_vertices("one", [[0, 0, 0]])
        .with_vertices("two", [[0, 0, 0], [1, 0, 0]])
        .with_vertices("three", [[0, 0, 0], [1, 0, 0], [0, 1, 0]])
        .with_vertices("row", [[0, 0, 0], [0.5, 0, 0], [1, 0, 0]])
        .with_vertices("far", [[1, 0, 0]])
        .with_vertices("top corner", [[0, 1, 0]])
    )


def refusal(mesh: TetMesh, *supports: Support, degree: int = 1) -> str:
    """The message with which a body is refused."""
    with pytest.raises(InputError) as raised:
        solve(Body(mesh, degree, LAW, list(supports)))
    message = str(raised.value)
    assert "\n\n" not in message and message[0].islower()
    return message


def test_no_support() -> None:
    said = refusal(cube())
    assert "the body is held nowhere: it can still translate and rotate freely" in said
    assert "Hold (Fixed, Moved, Prescribed) a surface" in said


@pytest.mark.parametrize("degree", [1, 2, 3])
def test_one_vertex(degree: int) -> None:
    said = refusal(cube(), Fixed("one"), degree=degree)
    assert "can still rotate in every direction about the point (0, 0, 0) mm" in said


@pytest.mark.parametrize("place", ["two", "row"])
def test_vertices_on_a_line(place: str) -> None:
    said = refusal(cube(), Fixed(place))
    assert "can still rotate about the axis through (0.5, 0, 0) mm along x" in said
    assert "translate" not in said


def test_one_plane_of_symmetry() -> None:
    said = refusal(cube(), Fixed("bottom", components="z"), degree=2)
    assert "translate in every direction across z" in said
    assert "rotate about the axis through (0.5, 0.5, 0.5) mm along z" in said


def test_two_planes_of_symmetry() -> None:
    said = refusal(cube(), Fixed("bottom", components="z"), Fixed("left", components="x"))
    assert "can still translate along y." in said
    assert "rotate" not in said


def test_a_slide_with_a_prescribed_value() -> None:
    said = refusal(cube(), Moved("top", translation=(0, 0, 1), components="xy"))
    assert "can still translate along z" in said


def test_single_components() -> None:
    said = refusal(cube(), Fixed("one", components="x"), Fixed("far", components="y"))
    assert "can still translate along z, and rotate about the axis" in said


def test_two_axes() -> None:
    said = refusal(cube(), Fixed("one"), Fixed("far", components="z"))
    assert "rotate about the axis through (0.5, 0, 0) mm along x" in said
    assert "rotate about the axis through (0, 0, 0.5) mm along z" in said


def test_a_screw() -> None:
    """Held is what u = (0, 0, 1) + (1, 1, 1) x p leaves at rest, and nothing else does."""
    mesh = TetMesh(
        np.concatenate([CORNER, [[1, 1, 1]]]),
        [[0, 1, 2, 3], [1, 2, 3, 4]],
        vertices={"a": [0], "b": [1], "e": [4]},
    )
    said = refusal(
        mesh, Fixed("a", components="y"), Fixed("b", components="xz"), Fixed("e", components="xy")
    )
    assert "along (0.5774, 0.5774, 0.5774) while it slides along it by 2.094 mm a turn" in said
    assert "(a screw)" in said and "translate" not in said


def test_far_away_in_micrometres_and_turned() -> None:
    mesh = cube()
    turn = np.array([[0.6, -0.8, 0], [0.8, 0.6, 0], [0, 0, 1]])
    far = mesh.moved(turn, (1000, -2000, 500))
    said = refusal(far, Fixed("two"))
    assert "through (1000.3, -1999.6, 500) mm along (0.6, 0.8, 0)" in said
    small = TetMesh(mesh.points * 1e-3, mesh.tets, vertices=mesh.vertices)
    assert "through (0.0005, 0, 0) mm along x" in refusal(small, Fixed("two"))


def test_a_part_that_floats() -> None:
    one = block()
    mesh = TetMesh(
        np.concatenate([one.points, one.points + np.array([5, 0, 0])]),
        np.concatenate([one.tets, one.tets + len(one.points)]),
        surfaces={"bottom": one.surfaces["bottom"]},
    )
    said = refusal(mesh, Fixed("bottom"))
    assert "part 2 (6 tets, around (5.5, 0.5, 0.5) mm) is held nowhere" in said
    assert "not welded" not in said


def test_parts_joined_at_a_vertex() -> None:
    mesh = TetMesh(
        np.concatenate([CORNER, -CORNER[1:]]),
        [[0, 1, 2, 3], [0, 4, 5, 6]],
        surfaces={"held": [[0, 1, 2]]},
    )
    said = refusal(mesh, Fixed("held"))
    assert "part 2 (1 tet, around" in said
    assert "can still rotate in every direction about the point (0, 0, 0) mm" in said
    assert "touch in single vertices or edges are hinged there and not joined" in said


@pytest.mark.parametrize("degree", [1, 3])
def test_parts_joined_at_an_edge(degree: int) -> None:
    mesh = TetMesh(
        np.concatenate([CORNER, -CORNER[2:]]),
        [[0, 1, 2, 3], [0, 1, 4, 5]],
        surfaces={"held": [[0, 1, 2]]},
    )
    said = refusal(mesh, Fixed("held"), degree=degree)
    assert "can still rotate about the axis through (0.25, 0, 0) mm along x" in said
    assert "part 1 " not in said


def test_unwelded_tets() -> None:
    welded = block(cells=3)
    mesh = TetMesh(
        welded.points[welded.tets].reshape(-1, 3),
        np.arange(4 * len(welded.tets)).reshape(-1, 4),
        vertices={"held": [0, 1, 2, 3]},
    )
    said = refusal(mesh, Fixed("held"))
    assert "the mesh is not welded" in said and "162 parts" in said
    assert "numpy.unique(points.round(6), axis=0, return_inverse=True)" in said


def test_the_advice_for_unwelded_tets_works() -> None:
    welded = block(cells=2)
    points = welded.points[welded.tets].reshape(-1, 3)
    tets = np.arange(4 * len(welded.tets)).reshape(-1, 4)
    points, number = np.unique(points.round(6), axis=0, return_inverse=True)
    tets = number.reshape(-1)[tets]
    mesh = TetMesh(points, tets).with_surface("bottom", lambda p: p[:, 2] == 0)
    assert solve(Body(mesh, 1, LAW, [Fixed("bottom")])).energy == 0


def test_many_floating_parts_are_counted() -> None:
    one, count = block(), 12
    mesh = TetMesh(
        np.concatenate([one.points + np.array([3 * i, 0, 0]) for i in range(count)]),
        np.concatenate([one.tets + i * len(one.points) for i in range(count)]),
        surfaces={"bottom": one.surfaces["bottom"]},
    )
    said = refusal(mesh, Fixed("bottom"))
    assert "and 8 further parts can move" in said


ACCEPTED = {
    "three vertices": [Fixed("three")],
    "three planes of symmetry": [
        Fixed("bottom", components="z"),
        Fixed("left", components="x"),
        Fixed("front", components="y"),
    ],
    "a vertex, a line, a plane": [
        Fixed("one"),
        Fixed("far", components="yz"),
        Fixed("top corner", components="z"),
    ],
    "one surface": [Fixed("top")],
    "everything": [Fixed("left", "right", "front", "back", "bottom", "top")],
}


@pytest.mark.parametrize("supports", ACCEPTED.values(), ids=ACCEPTED)
@pytest.mark.parametrize("degree", [1, 2])
def test_look_alikes_without_load_stay_exactly_where_they_are(
    supports: list[Support], degree: int
) -> None:
    solution = solve(Body(cube(), degree, LAW, supports))
    assert (solution.displacement.controls == 0).all()
    assert solution.energy == 0 and solution.iterations == 0 and solution.residual == 0


def test_every_control_prescribed() -> None:
    """A single cell of degree 1 has no free control; the answer is what was prescribed."""
    mesh = block()
    sides = Prescribed(
        "left", "right", "front", "back", "bottom", "top", value=lambda p: 0.1 * p[:, ::-1]
    )
    solution = solve(Body(mesh, 1, LAW, [sides]))
    np.testing.assert_allclose(
        solution.displacement.at(mesh.points), 0.1 * mesh.points[:, ::-1], atol=1e-15
    )
    assert solution.free == 0 and solution.energy > 0


def test_three_vertex_hinges_hold_a_part() -> None:
    """A tet that stands on three vertices of a block, between which the block has no one face."""
    one = block(cells=2)
    on_top = CORNER[:3] + CORNER[3]
    feet = [np.flatnonzero((one.points == foot).all(axis=1))[0] for foot in on_top]
    mesh = TetMesh(
        np.concatenate([one.points, [[0.2, 0.2, 2]]]),
        np.concatenate([one.tets, [[*feet, len(one.points)]]]),
        surfaces={"bottom": one.surfaces["bottom"]},
    )
    assert mesh.components().max() == 1
    assert solve(Body(mesh, 1, LAW, [Fixed("bottom")])).energy == 0


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e3])
def test_scanner_coordinates_and_other_units(scale: float) -> None:
    mesh = block(size=(scale,) * 3, cells=2, origin=(1000 * scale, -900 * scale, 400 * scale))
    pull = Traction("top", value=(0, 0, 0.1))
    solution = solve(Body(mesh, 2, LAW, [Fixed("bottom")], [pull]))
    assert solution.reactions["bottom"].force[2] == pytest.approx(-0.1 * scale**2, rel=1e-9)
