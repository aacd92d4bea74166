# SPDX-License-Identifier: BSD-3-Clause
"""Public functions given the wrong noun: the message says what was given and what can stand there.

Most of them are what a hurried reader of the first example would type.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import bezsoma as bz
from bezsoma.view.vtk import write_surface_vtu
from cases.written import case_file

Given = Callable[[Path], Any]
MESH = bz.block()
NET = bz.ControlNet(MESH, 1)
FIELD = bz.Field(NET, np.zeros((NET.count, 3)))
TISSUE = bz.LinearElastic(E=0.015, nu=0.45)


@cache
def solution() -> Any:
    supports = [bz.Fixed("bottom"), bz.Moved("top", translation=(0, 0, 0.1))]
    return bz.solve(bz.Body(MESH, 1, TISSUE, supports))


CALLS: dict[str, tuple[Callable[..., Any], tuple[str, ...]]] = {
    "a picture of a solution": (
        lambda at: bz.picture(at / "a.png", solution()),
        ("picture(path, mesh", "a Solution cannot be the mesh", "solution.displacement.mesh"),
    ),
    "a picture of a field": (
        lambda at: bz.picture(at / "a.png", FIELD),  # type: ignore[arg-type]
        ("a Field cannot be the mesh", "field.mesh there", "the field after it"),
    ),
    "a picture of a body": (
        lambda at: bz.picture(at / "a.png", solution().body),
        ("a Body cannot be the mesh", "give body.mesh"),
    ),
    "a picture coloured by a solution": (
        lambda at: bz.picture(at / "a.png", MESH, solution()),
        ("a Solution cannot be the colour", "give solution.displacement"),
    ),
    "a picture coloured by numbers": (
        lambda at: bz.picture(None, MESH, np.zeros(8)),  # type: ignore[arg-type]
        ("an array of shape (8,) cannot be the colour", "Field(net, controls)"),
    ),
    "a picture displaced by a solution": (
        lambda at: bz.picture(None, MESH, displacement=solution()),
        ("a Solution cannot be the displacement", "give solution.displacement"),
    ),
    "a picture in the wrong order": (
        lambda at: bz.picture(MESH, at / "a.png"),  # type: ignore[arg-type]
        ("a TetMesh cannot be the path", "text or a Path"),
    ),
    "a face of a solution": (
        lambda at: bz.face_picture(at / "a.png", MESH, solution()),
        ("face_picture(", "a Solution cannot be the displacement", "give solution.displacement"),
    ),
    "a face without a displacement": (
        lambda at: bz.face_picture(at / "a.png", MESH, None),  # type: ignore[arg-type]
        ("None cannot be the displacement", "give a Field"),
    ),
    "a VTU of a solution": (
        lambda at: bz.write_vtu(at / "a.vtu", solution()),
        ("write_vtu(path, mesh, fields)", "a Solution cannot be the mesh", "as the field"),
    ),
    "a VTU of a mesh and a solution": (
        lambda at: bz.write_vtu(at / "a.vtu", MESH, solution()),
        ("a Solution cannot be the fields", "give solution.displacement"),
    ),
    "a VTU of a solution by name": (
        lambda at: bz.write_vtu(at / "a.vtu", MESH, {"u": solution()}),
        ("a Solution cannot be field 'u'", "give solution.displacement"),
    ),
    "a VTU of numbers": (
        lambda at: bz.write_vtu(at / "a.vtu", MESH, {"u": np.zeros(3)}),  # type: ignore[dict-item]
        ("an array of shape (3,) cannot be field 'u'", "Field(net, controls)"),
    ),
    "a VTU of fields in a list": (
        lambda at: bz.write_vtu(at / "a.vtu", MESH, [FIELD]),  # type: ignore[arg-type]
        ("a list cannot be the fields", '{"u": field}'),
    ),
    "a VTU of a field named by a number": (
        lambda at: bz.write_vtu(at / "a.vtu", MESH, {3: FIELD}),  # type: ignore[dict-item]
        ("the number 3 cannot name a field", "text"),
    ),
    "a surface of a field": (
        lambda at: write_surface_vtu(at / "a.vtu", FIELD),  # type: ignore[arg-type]
        ("write_surface_vtu(", "a Field cannot be the mesh"),
    ),
    "a mesh file of a solution": (
        lambda at: bz.write_mesh(at / "a.npz", solution()),
        ("write_mesh(path, mesh)", "a Solution cannot be the mesh", "displacement.mesh"),
    ),
    "a mesh file in the wrong order": (
        lambda at: bz.write_mesh(MESH, at / "a.npz"),  # type: ignore[arg-type]
        ("a TetMesh cannot be the path",),
    ),
    "a mesh file of a path": (
        lambda at: bz.write_mesh(at / "a.npz", "b.vtu"),  # type: ignore[arg-type]
        ("the text 'b.vtu' cannot be the mesh", "read_mesh reads one"),
    ),
    "a mesh file of a number": (
        lambda at: bz.write_mesh(at / "a.npz", 3),  # type: ignore[arg-type]
        ("the number 3 cannot be the mesh", "read_mesh(path) or block()"),
    ),
    "a number for a file": (
        lambda at: bz.read_mesh(3),  # type: ignore[arg-type]
        ("read_mesh(path)", "the number 3 cannot be the path", "text or a Path"),
    ),
    "nothing for a file": (
        lambda at: bz.read_mesh(None),  # type: ignore[arg-type]
        ("None cannot be the path",),
    ),
    "a body for a case": (
        lambda at: bz.run_case(solution().body, at / "out"),
        ("run_case(case, folder)", "a Body cannot be the case", "read_case(path)"),
    ),
    "a case that is not there": (
        lambda at: bz.run_case(str(at / "none.toml"), at / "out"),
        ("none.toml",),
    ),
    "text for points": (
        lambda at: FIELD.at("abc"),  # type: ignore[arg-type]
        ("'abc' are no points", "[[0, 0, 0]]"),
    ),
    "rags for points": (
        lambda at: FIELD.gradient([[0, 0], [0]]),  # type: ignore[arg-type]
        ("[[0, 0], [0]] are no points", "(p, 3) in mm"),
    ),
    "one point": (
        lambda at: FIELD.at([0, 0, 0]),  # type: ignore[arg-type]
        ("points of shape (3,)", "(p, 3) in mm", "one point is [[x, y, z]]"),
    ),
    "points in the plane": (
        lambda at: FIELD.at(np.zeros((5, 2))),
        ("points of shape (5, 2)", "(p, 3) in mm is needed"),
    ),
    "points for a stress": (
        lambda at: solution().stress.at(np.zeros(3)),
        ("points of shape (3,)", "one point is [[x, y, z]]"),
    ),
    "a field on a mesh": (
        lambda at: bz.Field(MESH, np.zeros(8)),  # type: ignore[arg-type]
        ("a TetMesh cannot be the net", "ControlNet(mesh, degree)"),
    ),
    "a field of a function": (
        lambda at: bz.Field(NET, lambda x: x),  # type: ignore[arg-type]
        ("a function that is no array", "Field.interpolating"),
    ),
    "a field of a word": (
        lambda at: bz.Field.interpolating(NET, "x"),  # type: ignore[arg-type]
        ("a str that is no array of numbers", "one for each point"),
    ),
}


@pytest.mark.parametrize("call", CALLS)
def test_the_message_says_what_was_given_and_what_can_stand_there(
    call: str, tmp_path: Path
) -> None:
    given, words = CALLS[call]
    with pytest.raises(bz.InputError) as refused:
        given(tmp_path)
    message = str(refused.value)
    assert [word for word in words if word not in message] == [], message
    assert len(message) < 400
    assert list(tmp_path.iterdir()) == []


def test_a_case_may_be_given_by_its_path(tmp_path: Path) -> None:
    file = case_file(tmp_path)
    by_path = bz.run_case(str(file), str(tmp_path / "one"))
    read = bz.run_case(bz.read_case(file), tmp_path / "two")
    assert np.array_equal(by_path.displacement.controls, read.displacement.controls)


def test_a_solution_shows_itself_in_one_line() -> None:
    assert repr(solution()) == (
        f"Solution(degree=1, unknowns=24, method={solution().method!r}, "
        f"energy={solution().energy:.6g} N mm, largest_displacement=0.1 mm, "
        f"advice={solution().advice!r})"
    )


def test_a_load_shows_itself_as_it_was_called() -> None:
    def swell(x: np.ndarray) -> np.ndarray:
        return x

    assert repr(bz.Traction("top", value=swell)) == "Traction('top', value=<function swell>)"
    assert repr(bz.Pressure("top", value=2, exactness=3)) == (
        "Pressure('top', value=2.0, exactness=3)"
    )
    assert "lambda" not in repr(bz.BodyForce((0, 0, 1)))
