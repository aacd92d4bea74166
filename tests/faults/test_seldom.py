# SPDX-License-Identifier: BSD-3-Clause
"""Messages that are met seldom: wrong numbers of things, mistaken nets, odd settings and files.

Each is what somebody reads who comes to a corner of the package first.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import bezsoma as bz
from bezsoma.bernstein.nets import de_casteljau_levels, restriction
from bezsoma.cli import tags_named
from bezsoma.errors import InputError
from bezsoma.mechanics.compiled import not_negative
from bezsoma.mesh.broken_field import BrokenField
from bezsoma.mesh.subdivision import Subdivision, subdivision
from bezsoma.model.settings import ModelSettings, read_settings
from bezsoma.refinement.bisection import bisected
from bezsoma.view.convergence import convergence_picture
from bezsoma.view.graph import graph_picture
from bezsoma.view.picture import side_by_side
from bezsoma.view.plates import plates_picture
from bezsoma.view.sheet import colours
from cases.written import case_file

Given = Callable[[Path], Any]
MESH = bz.block()
OTHER = bz.block((1.0, 1.0, 1.0), (2, 1, 1))
FIELD = bz.Field(bz.ControlNet(MESH, 2), np.zeros((bz.ControlNet(MESH, 2).count, 3)))
BROKEN = BrokenField(MESH, 1, np.zeros((len(MESH.tets), 4)))


def case_with(*changes: tuple[str, str]) -> Given:
    return lambda at: bz.read_case(case_file(at, *changes))


def settings_with(text: str) -> Given:
    def read(at: Path) -> ModelSettings:
        (at / "settings.toml").write_text(text, encoding="utf-8")
        return read_settings(at / "settings.toml")

    return read


def moved_corners(_: Path) -> Subdivision:
    into = subdivision(MESH)
    return Subdivision(into.coarse, into.fine, into.parent, into.corners[:, ::-1])


PLACES: dict[str, tuple[Given, tuple[str, ...]]] = {
    "arguments of a blossom": (
        lambda at: de_casteljau_levels([0.0, 0.0, 4.0], 2, [[0.5, 0.5]]),
        ("(1, 2)", "degree 2 takes 2 barycentric points"),
    ),
    "corners of another dimension": (
        lambda at: restriction(2, 2, [[1.0, 0.0]]),
        ("(1, 2)", "each corner has 3 barycentric numbers"),
    ),
    "a place named twice": (
        lambda at: bz.Pressure("skin", "skin", value=1.0),
        ("Pressure names 'skin' 2 times", "act as often", "once"),
    ),
    "a number below zero": (
        lambda at: not_negative(-1.0, "k of Law", "MPa", "or it would gain energy"),
        ("k of Law = -1 MPa", "must not be negative, or it would gain energy"),
    ),
    "controls of another net": (
        lambda at: bz.Field(bz.ControlNet(MESH, 2), np.zeros((3, 3))),
        ("(3, 3)", "degree 2 has 27 controls", "first axis"),
    ),
    "a field lowered": (
        lambda at: FIELD.elevated(1),
        ("degree 2 cannot be lowered to 1 without loss", "2 or more"),
    ),
    "a broken field lowered": (
        lambda at: BROKEN.elevated(0),
        ("degree 1 cannot be lowered to 0 without loss", "1 or more"),
    ),
    "means on another degree": (
        lambda at: BROKEN.averaged(bz.ControlNet(MESH, 2)),
        ("a net of degree 2 was given", "own mesh and degree 1"),
    ),
    "means on another mesh": (
        lambda at: BROKEN.averaged(bz.ControlNet(OTHER, 1)),
        ("a net of degree 1, other mesh, was given", "own mesh and degree 1"),
    ),
    "corners of a subdivision in another order": (
        moved_corners,
        ("of the finer mesh is not where its corners", "mm off", "in the order of the finer tet"),
    ),
    "cuts of another mesh": (
        lambda at: bisected(OTHER, np.array([0]), bisected(MESH, np.array([0])).cuts),
        ("cuts of", "other tets", "give those that came with it, or none"),
    ),
    "a tag without a number": (
        lambda at: tags_named("skin=1, jaw", "--surfaces"),
        ("--surfaces", "jaw' is no name with a tag", "write skin=1,jaw=3"),
    ),
    "a region without a number": (
        lambda at: tags_named("fat", "--regions"),
        ("--regions", "'fat' is no name with a tag", "write fat=1,muscle=2"),
    ),
    "a tag named twice": (
        lambda at: tags_named("skin=1,skin=3", "--regions"),
        ("--regions", "'skin' is named twice", "a name of its own"),
    ),
}

CASES: dict[str, tuple[Given, tuple[str, ...]]] = {
    "a range of three": (
        case_with(("[0.04, 0.06]", "[0.04, 0.05, 0.06]")),
        ("two entries are needed (low, high), not 3",),
    ),
    "parameters of a file": (
        case_with(('solid = "block"', 'file = "head.msh"')),
        ("'parameters' belong to a solid", "'file' takes none"),
    ),
    "a named vertex that is moved to a surface": (
        case_with(("point = [1, 0.5, 0.5]", 'point = "tip"\non = "top"')),
        ("a named vertex lies where it lies", "leave 'on' out"),
    ),
    "few tets": (lambda at: ModelSettings(tets=10), ("tets=10", "1000 to 3000000 can be made")),
    "a long way": (lambda at: ModelSettings(forward=80.0), ("forward=80", "at most 50 mm")),
    "a degree of none": (lambda at: ModelSettings(degree=11), ("degree=11", "1 to 10")),
    "a table that is none": (
        settings_with("[lables]\nbone = 300\n"),
        ("settings.toml", "'lables'", "labels"),
    ),
    "a number for a table": (
        settings_with("labels = 3\n"),
        ("settings.toml", "labels is a table", "write [labels]"),
    ),
    "a key that is none": (
        settings_with("[labels]\nbones = 300.0\n"),
        ("settings.toml", "[labels]", "'bones'", "bone"),
    ),
    "a text for a number": (
        settings_with('[labels]\nbone = "hard"\n'),
        ("settings.toml", "[labels] bone = 'hard'", "say"),
    ),
    "settings that cannot be read": (
        settings_with("[labels\n"),
        ("settings.toml", "not readable TOML"),
    ),
}

PICTURES: dict[str, tuple[Given, tuple[str, ...]]] = {
    "no curve": (
        lambda at: convergence_picture(at / "a.png", {}),
        ("0 curves were given", "can be told apart"),
    ),
    "no graph": (
        lambda at: graph_picture(at / "a.png", [], columns=1),
        ("0 graphs in rows of 1", "one graph or more"),
    ),
    "no shot": (
        lambda at: side_by_side(at / "a.png", []),
        ("0 shots were given", "1 to 4 have room"),
    ),
    "no plate": (
        lambda at: plates_picture(at / "a.png", [], {}),
        ("no plates were given", "one or more"),
    ),
    "a map of colours too dark": (
        lambda at: colours("gray", darkest=1.1),
        ("'gray' is almost black", "'magma_r'"),
    ),
}


@pytest.mark.parametrize("how", [*PLACES, *CASES, *PICTURES])
def test_the_message_says_what_was_given_and_what_can_be_done(how: str, tmp_path: Path) -> None:
    call, words = {**PLACES, **CASES, **PICTURES}[how]
    with pytest.raises(InputError) as refused:
        call(tmp_path)
    message = str(refused.value)
    assert [word for word in words if word not in message] == [], message
    assert not list(tmp_path.glob("*.png"))


def landmarks(**changes: Any) -> Given:
    """A file of landmarks whose markup, or whose first point, is changed."""

    def read(at: Path) -> Any:
        from bezsoma.imaging.slicer import read_landmarks

        point = {"label": "chin", "position": [0, 1, 2], "positionStatus": "defined"}
        point |= {key: changes.pop(key) for key in list(changes) if key in point}
        markup = {"coordinateSystem": "LPS", "controlPoints": [point, *changes.pop("more", ())]}
        (at / "a.mrk.json").write_text(json.dumps({"markups": [markup | changes]}))
        return read_landmarks(at / "a.mrk.json")

    return read


def surface(points: Any, triangles: Any) -> Given:
    def write(at: Path) -> None:
        from bezsoma.imaging.slicer import write_surface

        write_surface(at / "a.stl", np.array(points, float), np.array(triangles))

    return write


TRIANGLE = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
IMAGES: dict[str, tuple[Given, tuple[str, ...]]] = {
    "a label that stands twice": (
        landmarks(more=[{"label": "chin", "position": [0, 0, 0]}]),
        ("the label 'chin' is empty or stands twice", "a name of its own"),
    ),
    "a label without letters": (landmarks(label=""), ("the label '' is empty",)),
    "inches": (landmarks(coordinateUnits="in"), ("coordinateUnits is 'in'", "mm is needed")),
    "a point of two numbers": (
        landmarks(position=[1, 2]),
        ("landmark 'chin' has the position", "three finite numbers", "take it out"),
    ),
    "squares for triangles": (
        surface(TRIANGLE, [[0, 1, 2, 2]]),
        ("triangles of shape (1, 4)", "(t, 3) is needed"),
    ),
    "a triangle of no point": (
        surface(TRIANGLE, [[0, 1, 3]]),
        ("name points 0 to 3", "there are 3", "from 0 to 2"),
    ),
    "a point of a surface at infinity": (
        surface([[0, 0, np.inf]], [[0, 0, 0]]),
        ("points of shape (1, 3)", "finite (p, 3) in mm"),
    ),
}


@pytest.mark.parametrize("how", IMAGES)
def test_of_pictures_too(how: str, tmp_path: Path) -> None:
    pytest.importorskip("SimpleITK", reason="comes with the extra 'imaging'")
    call, words = IMAGES[how]
    with pytest.raises(InputError) as refused:
        call(tmp_path)
    message = str(refused.value)
    assert [word for word in words if word not in message] == [], message
    assert not list(tmp_path.glob("*.stl"))


SETTINGS: dict[str, tuple[str, dict[str, Any], tuple[str, ...]]] = {
    "far planes": ("domain.DomainSettings", {"below": 400.0}, ("below=400", "-300 to 300 mm")),
    "coarse voxels": ("settings.LabelSettings", {"coarse": 0.1}, ("coarse=0.1", "0.3 to 1000 mm")),
    "fat from above": (
        "settings.LabelSettings",
        {"fat": (0.0, -100.0)},
        ("fat=(0.0, -100.0) HU", "from has to be below to"),
    ),
    "small tets": ("tetrahedra.Sizes", {"skin": 1e-3}, ("skin=0.001", "mm can be made")),
    "noise below zero": ("head_ct.head_ct", {"noise": -1.0}, ("noise -1.0 HU", "can be made")),
    "an open mouth": ("head_ct.head_ct", {"mouth": 40.0}, ("mouth 40.0 degrees", "0 to 25")),
}


@pytest.mark.parametrize("how", SETTINGS)
def test_settings_say_what_can_be(how: str) -> None:
    pytest.importorskip("SimpleITK", reason="comes with the extra 'imaging'")
    place, given, words = SETTINGS[how]
    module, name = place.split(".")
    called = getattr(pytest.importorskip(f"bezsoma.imaging.{module}"), name)
    with pytest.raises(InputError) as refused:
        called(**given)
    message = str(refused.value)
    assert [word for word in words if word not in message] == [], message
