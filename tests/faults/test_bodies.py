# SPDX-License-Identifier: BSD-3-Clause
"""Faults in materials, values, supports, joins, loads and degrees, and look-alikes that are fine.

Every fault names what was given and what can be done: the test reads the message for both.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from bezsoma.equations.boundary import prescribed
from bezsoma.equations.forces import forces
from bezsoma.errors import InputError
from bezsoma.mechanics import (
    Body,
    BodyForce,
    Fixed,
    Gap,
    Graded,
    LinearElastic,
    Moved,
    PointForce,
    Polynomial,
    Precedence,
    Prescribed,
    Pressure,
    Traction,
)
from bezsoma.mesh.control_net import ControlNet
from bezsoma.mesh.solids import block
from bezsoma.mesh.tets import TetMesh

TISSUE = LinearElastic(E=0.015, nu=0.45)
Given = Callable[[], Any]


def slab() -> TetMesh:
    """Floor split into jaw (x < 3) and rami (x > 3); two regions; an inner surface; places."""
    plain = block(size=(6, 2, 2), cells=(6, 2, 2))
    side = (plain.points[plain.tets].mean(axis=1)[:, 0] > 3).astype(int)
    mesh = TetMesh(plain.points, plain.tets, side, ("fat", "muscle"), surfaces=dict(plain.surfaces))
    mesh = mesh.with_surface("jaw", lambda x: (x[:, 2] == 0) & (x[:, 0] <= 3))
    mesh = mesh.with_surface("rami", lambda x: (x[:, 2] == 0) & (x[:, 0] >= 3))
    inner = mesh.all_faces[(mesh.points[mesh.all_faces, 0] == 3).all(axis=1)]
    mesh = mesh.with_surface("inside", inner)
    mesh = mesh.with_edges("line", np.array([[3.0, 0, 0], [3, 1, 0], [3, 2, 0]]))
    return mesh.with_vertices("tips", np.array([[6.0, 0, 0], [6, 2, 0]]))


MESH = slab()


def body(
    supports: Any = (), loads: Any = (), joins: Any = (), degree: Any = 2, materials: Any = TISSUE
) -> Body:
    return Body(MESH, degree, materials, supports, loads, joins)


def equations(supports: Any = (), loads: Any = (), joins: Any = (), degree: int = 2) -> None:
    stated, net = body(supports, loads, joins, degree), ControlNet(MESH, degree)
    prescribed(stated, net)
    forces(stated, net)


JUMP = [Moved("jaw", translation=(0, -5, 0)), Fixed("rami")]
THREE = [*JUMP, Moved("right", translation=(0, 0, 1))]


MATERIALS: dict[str, tuple[Given, tuple[str, ...]]] = {
    "no stiffness": (lambda: LinearElastic(0, 0.3), ("E = 0 MPa", "must be positive", "0.015")),
    "negative E": (lambda: LinearElastic(-1, 0.3), ("E = -1 MPa", "must be positive")),
    "E not a number": (lambda: LinearElastic(float("nan"), 0.3), ("nan", "must be finite")),
    "infinite E": (lambda: LinearElastic(float("inf"), 0.3), ("inf", "must be finite")),
    "E as text": (lambda: LinearElastic("15 kPa", 0.3), ("'15 kPa'", "text", "one number")),
    "E as a truth value": (lambda: LinearElastic(True, 0.3), ("True", "one number")),
    "nu beyond 1/2": (
        lambda: LinearElastic(1, 0.7),
        ("nu = 0.7", "at most 1/2", "bulk modulus would be negative", "nu=0.5"),
    ),
    "nu of -1": (lambda: LinearElastic(1, -1), ("nu = -1", "above -1", "-1 < nu < 1/2")),
    "a modulus that overflows": (
        lambda: LinearElastic(1e308, 0.4999999),
        ("1e+308", "range of floating-point", "unit of E"),
    ),
    "E that underflows": (lambda: LinearElastic(5e-324, 0.3), ("4.94066e-324", "floating-point")),
    "negative G": (
        lambda: LinearElastic.from_shear_bulk(-2, 1),
        ("G = -2 MPa", "must both be positive"),
    ),
    "kappa of zero": (
        lambda: LinearElastic.from_shear_bulk(1, 0),
        ("kappa = 0 MPa", "must both be positive"),
    ),
    "kappa that rounds to nu = 1/2": (
        lambda: LinearElastic.from_shear_bulk(1, 1e20),
        ("1e+20", "rounds to 1/2", "kappa = inf"),
    ),
}

VALUES: dict[str, tuple[Given, tuple[str, ...]]] = {
    "an unknown letter": (
        lambda: Polynomial.parse("0.1*x + w"),
        ("'0.1*x + w'", "position 9", "'w' cannot stand", "allowed are numbers, x, y, z"),
    ),
    "a call": (
        lambda: Polynomial.parse("__import__('os').getcwd()"),
        ("position 1", "'__import__' cannot stand in a formula", "allowed are"),
    ),
    "a sine": (lambda: Polynomial.parse("2*sin(x)"), ("position 3", "'sin' cannot stand")),
    "a broken formula": (lambda: Polynomial.parse("x +* 2"), ("'x +* 2'", "cannot be read")),
    "an empty formula": (lambda: Polynomial.parse("  "), ("cannot be read", "allowed are")),
    "an unclosed bracket": (lambda: Polynomial.parse("2*(x + y"), ("2*(x + y", "cannot be read")),
    "a fraction of x": (
        lambda: Polynomial.parse("1/x"),
        ("'1/x'", "division by x, y or z is no polynomial", "division by a number"),
    ),
    "division by zero": (lambda: Polynomial.parse("x/(1 - 1)"), ("position 1", "by zero")),
    "a broken power": (
        lambda: Polynomial.parse("x**0.5"),
        ("position 4", "'0.5' cannot be a power", "whole number from 0 to 10"),
    ),
    "a negative power": (lambda: Polynomial.parse("x^-1"), ("'-1' cannot be a power",)),
    "a missing sign": (
        lambda: Polynomial.parse(" y^2 + 2(x)"),
        ("' y^2 + 2(x)'", "position 8", "'2(x)' cannot stand"),
    ),
    "brackets the wrong way round": (lambda: Polynomial.parse("x)+(y"), ("cannot be read",)),
    "words run together": (lambda: Polynomial.parse("2or x"), ("position 1", "'2or'")),
    "a whole quotient": (lambda: Polynomial.parse("x//2"), ("'x // 2' cannot stand",)),
    "signs without end": (lambda: Polynomial.parse("-" * 1999 + "x"), ("position", "allowed are")),
    "brackets without end": (
        lambda: Polynomial.parse("(" * 999 + "x" + ")" * 999),
        ("more than 50 parentheses",),
    ),
    "a power of a power": (lambda: Polynomial.parse("2**3**2"), ("cannot be a power",)),
    "too high a degree": (
        lambda: Polynomial.parse("x**6 * y**5"),
        ("degree exceeds 10", "Python function instead"),
    ),
    "a tower that would take for ever": (
        lambda: Polynomial.parse("((((x+y+z)^10)^10)^10)^10"),
        ("degree exceeds 10",),
    ),
    "a formula without end": (lambda: Polynomial.parse("x" + "+1" * 5000), ("10000 characters",)),
    "an imaginary number": (lambda: Polynomial.parse("2j*x"), ("'2j' cannot stand",)),
    "letters of another script": (lambda: Polynomial.parse("х + 1"), ("'х' cannot stand",)),  # noqa: RUF001
    "an infinite number": (lambda: Polynomial.parse("1e999*x"), ("'1e999' is too large",)),
    "a vanishing number": (
        lambda: Polynomial.parse("x + 1e-999999999"),
        ("position 5", "'1e-999999999' is too small"),
    ),
    "a number of 5000 digits": (lambda: Polynomial.parse("1." + "3" * 5000), ("too long",)),
    "a number that grows for ever": (
        lambda: Polynomial.parse("(((((9^10)^10)^10)^10)^10)^10"),
        ("a number beyond 1e+200",),
    ),
    "a number divided away": (lambda: Polynomial.parse("1e199/1e-199"), ("number beyond 1e+200",)),
    "no formula": (lambda: Polynomial.parse([]), ("[] is no formula", "one formula for each")),
    "a dict of formulas": (
        lambda: Polynomial.parse({"x": "1"}),  # type: ignore[arg-type]
        ("is no formula", "list with one"),
    ),
    "a formula that is nothing": (lambda: Polynomial.parse([None, 0, 0]), ("not None", "text")),  # type: ignore[list-item]
    "text where numbers stand": (
        lambda: Prescribed("jaw", value="0.1*x"),  # type: ignore[arg-type]
        ("'0.1*x'", "text", "Polynomial.parse"),
    ),
    "two numbers for three": (
        lambda: Prescribed("jaw", value=(1, 2)),
        ("prescribed on 'jaw'", "(1, 2)", "must be 3 numbers"),
    ),
    "a polynomial of one component for three": (
        lambda: Traction("top", value=Polynomial.parse("x")),
        ("traction on 'top'", "1 component", "3 are needed", "three formulas"),
    ),
    "a polynomial of three components for one": (
        lambda: Pressure("top", value=Polynomial.parse(["x", 0, 0])),
        ("pressure on 'top'", "3 component", "one formula"),
    ),
    "a value that is not finite": (
        lambda: Traction("top", value=(0, float("nan"), 0)),
        ("traction on 'top' (MPa) is", "nan", "must be finite"),
    ),
    "a matrix of the wrong shape": (
        lambda: Polynomial.affine(np.eye(2)),
        ("matrix of an affine field", "3 x 3 numbers"),
    ),
}

SUPPORTS: dict[str, tuple[Given, tuple[str, ...]]] = {
    "no place": (Fixed, ("Fixed names no place", "Fixed('skull', ...)")),
    "places in a list": (
        lambda: Fixed(["jaw", "rami"]),  # type: ignore[arg-type]
        ("['jaw', 'rami']", "one after the other"),
    ),
    "an unknown component": (
        lambda: Fixed("jaw", components="xw"),
        ("components='xw'", "letters x, y, z"),
    ),
    "a component twice": (lambda: Fixed("jaw", components="xx"), ("'xx'", "once at most")),
    "no component": (lambda: Moved("jaw", components=""), ("components=''", "one at least")),
    "components in a list": (
        lambda: Fixed("jaw", components=["x"]),  # type: ignore[arg-type]
        ("components=['x']", "such as 'xyz'"),
    ),
    "a translation in the plane": (
        lambda: Moved("jaw", translation=(0, -5)),
        ("translation of Moved (mm)", "(0, -5)", "3 numbers"),
    ),
    "an axis that points nowhere": (
        lambda: Moved("jaw", axis=(0, 0, 0), angle=0.1, about=(0, 0, 0)),
        ("axis of Moved", "length 0", "(0, 0, 1)"),
    ),
    "degrees for radians": (
        lambda: Moved("jaw", angle=30),
        ("30 rad", "radians", "angle=0.523599"),
    ),
    "a turn about nothing": (
        lambda: Moved("jaw", angle=0.1),
        ("'jaw' turns by 0.1 rad", "no axis and no about", "about=(0, 10, 0)"),
    ),
    "a turn about no point": (
        lambda: Moved("jaw", angle=0.1, axis=(1, 0, 0)),
        ("no about is given", "a point in mm"),
    ),
    "a turn about no axis": (
        lambda: Moved("jaw", angle=0.1, about=(1, 0, 0)),
        ("no axis is given", "direction"),
    ),
    "a motion without any": (
        lambda: Moved("jaw", "rami"),
        ("neither a translation (mm) nor an angle (rad)", "say Fixed('jaw', 'rami')"),
    ),
    "an axis and no angle": (
        lambda: Moved("jaw", axis=(1, 0, 0), about=(0, 1, 0)),
        ("nor an angle (rad)", "say how it moves"),
    ),
    "an angle that is not finite": (lambda: Moved("jaw", angle=np.inf), ("angle", "finite")),
    "an unknown place": (
        lambda: body([Fixed("skul", "jaww")]),
        ("Fixed: no place 'skul'", "this mesh has", "'rami'"),
    ),
    "a place misspelt": (lambda: body([Fixed("ramy")]), ("'ramy'", "did you mean 'rami'?")),
    "a support that is no list": (lambda: body(Fixed("jaw")), ("supports = ", "must be a list")),
    "a name for a support": (lambda: body(["jaw"]), ("'jaw' cannot stand there", "Fixed('skull')")),
    "a load among supports": (
        lambda: body([Pressure("jaw", value=1)]),
        ("supports: ", "cannot stand there", "Fixed"),
    ),
    "supports by name": (lambda: body({"jaw": Fixed("jaw")}), ("supports = ", "must be a list")),
    "a function of the wrong shape": (
        lambda: equations([Prescribed("jaw", value=lambda x: x.T)]),
        ("prescribed on 'jaw'", "of shape (3, ", "one row for each point"),
    ),
    "a function that is ragged": (
        lambda: equations([Prescribed("jaw", value=lambda x: [[1], [2, 3]])]),
        ("prescribed on 'jaw'", "one row for each point"),
    ),
    "a function that gives NaN": (
        lambda: equations([Prescribed("jaw", value=lambda x: x / np.where(x > 2.5, np.nan, 1))]),
        ("prescribed on 'jaw'", "nan", "mm", "must be finite"),
    ),
}

JOINS: dict[str, tuple[Given, tuple[str, ...]]] = {
    "two motions on one line": (
        lambda: equations(JUMP),
        (
            "Moved on 'jaw' and Fixed on 'rami'",
            "different displacements (y) at 5 of",
            "first at (3, ",
            "by up to 5 mm",
            "Precedence('jaw', over='rami')",
            "Graded(over='rami', to='jaw', band=<mm>)",
            "Gap(free='rami', at='jaw', width=<mm>)",
        ),
    ),
    "two motions on one place": (
        lambda: equations([Fixed("jaw"), Moved("jaw", translation=(1, 0, 0))]),
        ("(x)", "by up to 1 mm", "only one can hold", "split the components"),
    ),
    "motions that differ by a millionth": (
        lambda: equations([Fixed("rami"), Moved("jaw", translation=(0, 0, 1e-6))]),
        ("(z)", "by up to 1e-06 mm"),
    ),
    "a place joined with itself": (
        lambda: Graded("jaw", "jaw", 1),
        ("Graded joins 'jaw' with itself", "two places that meet"),
    ),
    "a band of no width": (
        lambda: Graded("rami", "jaw", 0),
        ("band of Graded (mm) is 0", "above zero"),
    ),
    "a gap of negative width": (
        lambda: Gap("rami", "jaw", -2),
        ("width of Gap (mm) is -2", "above zero"),
    ),
    "a band as text": (lambda: Graded("rami", "jaw", "5 mm"), ("'5 mm'", "one number")),  # type: ignore[arg-type]
    "a join of a place that is not there": (
        lambda: body(JUMP, joins=[Precedence("jaw", over="ram")]),
        ("Precedence(", "no place 'ram'", "did you mean 'rami'?"),
    ),
    "a join of a place without support": (
        lambda: body(JUMP, joins=[Gap(free="left", at="jaw", width=1)]),
        ("no supported place 'left'", "this body has ['jaw', 'rami']"),
    ),
    "a join of places that do not meet": (
        lambda: body(THREE, joins=[Graded(over="right", to="jaw", band=1)]),
        ("'jaw' and 'right' do not meet", "3 mm apart", "leave it out"),
    ),
    "a precedence of places that do not meet": (
        lambda: body(THREE, joins=[Precedence("right", over="jaw")]),
        ("'right' and 'jaw' do not meet", "3 mm apart"),
    ),
    "a band between overlapping places": (
        lambda: body([*JUMP, Fixed("bottom")], joins=[Graded("bottom", "jaw", 1)]),
        ("'jaw' and 'bottom' share facets", "only Precedence"),
    ),
    "a join of components apart": (
        lambda: body(
            [Fixed("rami", components="x"), Fixed("jaw", components="yz")],
            joins=[Precedence("jaw", over="rami")],
        ),
        ("'jaw' prescribes yz", "'rami' x", "no component in common", "leave the join out"),
    ),
    "two joins of one pair": (
        lambda: body(JUMP, joins=[Precedence("jaw", "rami"), Gap("jaw", "rami", 1)]),
        ("Precedence(", "Gap(", "same places meet", "keep one"),
    ),
    "precedence in a circle": (
        lambda: body(
            [Fixed("left", "front", "bottom")],
            joins=[
                Precedence("left", "front"),
                Precedence("front", "bottom"),
                Precedence("bottom", "left"),
            ],
        ),
        ("runs in a circle", "'left' over 'front' over 'bottom' over 'left'", "leave one"),
    ),
    "a band shorter than an element": (
        lambda: equations(JUMP, joins=[Graded("rami", "jaw", 0.4)]),
        ("band of 0.4 mm", "nearest is 0.5 mm", "edges there are", "degree 2", "longer band"),
    ),
    "a gap that frees everything": (
        lambda: equations(JUMP, joins=[Gap("rami", "jaw", 10)]),
        ("all of 'rami' lies within 10 mm", "shorter width"),
    ),
    "bands that overlap": (
        lambda: equations(THREE, joins=[Graded("rami", "jaw", 2), Graded("rami", "right", 2)]),
        ("overlap at", "of 'rami'", "shorter bands"),
    ),
    "a join that is no join": (
        lambda: body(JUMP, joins=[("jaw", "rami")]),
        ("('jaw', 'rami') cannot stand there", "joins=[Graded("),
    ),
}

LOADS: dict[str, tuple[Given, tuple[str, ...]]] = {
    "a traction on nothing": (lambda: Traction(value=(0, 0, 1)), ("Traction names no place",)),
    "a traction on a surface that is not there": (
        lambda: body(loads=[Traction("tops", value=(0, 0, 1))]),
        ("Traction: no surface 'tops'", "did you mean 'top'?"),
    ),
    "a pressure on mesh edges": (
        lambda: body(loads=[Pressure("line", value=1)]),
        ("Pressure: no surface 'line'", "this mesh has"),
    ),
    "a pressure inside the body": (
        lambda: body(loads=[Pressure("inside", value=1)]),
        ("'inside'", "no outward side", "Traction there instead"),
    ),
    "a pressure with a direction": (
        lambda: Pressure("top", value=(0, 0, 1)),
        ("pressure on 'top'", "one number"),
    ),
    "a body force on a region that is not there": (
        lambda: body(loads=[BodyForce((0, 0, 1), regions=["bone"])]),
        ("BodyForce: no region 'bone'", "['fat', 'muscle']"),
    ),
    "a region that is no list": (
        lambda: BodyForce((0, 0, 1), regions="fat"),
        ("regions='fat'", "must be a list"),
    ),
    "a body force of one number": (lambda: BodyForce(9.81), ("9.81", "3 numbers")),
    "an exactness that is not whole": (
        lambda: Traction("top", value=(0, 0, 1), exactness=2.5),  # type: ignore[arg-type]
        ("exactness=2.5", "whole number from 0 to 40"),
    ),
    "an exactness out of reach": (
        lambda: BodyForce((0, 0, 1), exactness=400),
        ("exactness=400", "from 0 to 40"),
    ),
    "a point force between vertices": (
        lambda: body(loads=[PointForce((0.5, 0.1, 0), (0, 0, 1))]),
        ("no vertex of this mesh lies at [0.5, 0.1, 0.0] mm", "nearest is", "0.51 mm away"),
    ),
    "a point force at two vertices": (
        lambda: body(loads=[PointForce("tips", (0, 0, 1))]),
        ("'tips' holds 2 vertices", "one PointForce for each"),
    ),
    "a point force on a surface": (
        lambda: body(loads=[PointForce("top", (0, 0, 1))]),
        ("no vertex place 'top'", "['tips']", "coordinates"),
    ),
    "a point force of two numbers": (lambda: PointForce("tip", (0, 1)), ("(0, 1)", "3 numbers")),
    "a support among loads": (lambda: body(loads=[Fixed("jaw")]), ("loads: ", "Pressure('skin'")),
    "a load as text": (lambda: body(loads="gravity"), ("loads = 'gravity'", "must be a list")),
    "a load that gives infinity": (
        lambda: equations(loads=[Pressure("top", value=lambda x: x[:, 0] * np.inf + 1)]),
        ("pressure on 'top'", "must be finite"),
    ),
    "a load that gives words": (
        lambda: equations(loads=[Pressure("top", value=lambda x: ["much"] * len(x))]),
        ("pressure on 'top'", "must answer with numbers"),
    ),
}

BODIES: dict[str, tuple[Given, tuple[str, ...]]] = {
    "degree 0": (lambda: body(degree=0), ("degree = 0", "from 1 to 10")),
    "degree 11": (lambda: body(degree=11), ("degree = 11", "from 1 to 10")),
    "degree -1": (lambda: body(degree=-1), ("degree = -1", "from 1 to 10")),
    "a broken degree": (lambda: body(degree=2.0), ("degree = 2.0", "whole number")),
    "a truth value for a degree": (lambda: body(degree=True), ("degree = True", "whole number")),
    "a degree as text": (lambda: body(degree="3"), ("degree = '3'", "whole number", "degree=3")),
    "no mesh": (
        lambda: Body("face.npz", 2, TISSUE, []),  # type: ignore[arg-type]
        ("mesh is 'face.npz'", "TetMesh", "read_mesh"),
    ),
    "a material as text": (
        lambda: body(materials="rubber"),
        ("'rubber' is no material", "LinearElastic(E=0.015, nu=0.45)"),
    ),
    "a material not yet filled in": (
        lambda: body(materials=LinearElastic),
        ("is no material", "LinearElastic(E="),
    ),
    "a region without material": (
        lambda: body(materials={"fat": TISSUE}),
        ("no material for ['muscle']", "['fat', 'muscle']"),
    ),
    "a material for no region": (
        lambda: body(materials={"fat": TISSUE, "muscel": TISSUE}),
        ("no region 'muscel'", "did you mean 'muscle'?"),
    ),
    "a material in numbers": (
        lambda: body(materials={"fat": TISSUE, "muscle": (0.015, 0.45)}),
        ("material of region 'muscle'", "is no material"),
    ),
}

ALL = {**MATERIALS, **VALUES, **SUPPORTS, **JOINS, **LOADS, **BODIES}


@pytest.mark.parametrize("fault", ALL)
def test_the_message_says_what_was_given_and_what_can_be_done(fault: str) -> None:
    given, words = ALL[fault]
    with np.errstate(all="ignore"), pytest.raises(InputError) as refused:
        given()
    message = str(refused.value)
    assert [word for word in words if word not in message] == [], message
    assert "Traceback" not in message
    assert len(message) < 700


def test_there_are_faults_enough() -> None:
    """No name hides another, and there are at least as many as were promised."""
    kinds = (MATERIALS, VALUES, SUPPORTS, JOINS, LOADS, BODIES)
    assert sum(map(len, kinds)) == len(ALL)
    assert len(ALL) >= 70


FINE: dict[str, Given] = {
    "numpy degrees": lambda: body(degree=np.int64(3)),
    "nu close to 1/2": lambda: LinearElastic(1, 0.4999999),
    "a foam that thickens": lambda: LinearElastic(1, -0.5),
    "whole numbers": lambda: LinearElastic(1, 0),
    "no supports": lambda: body(),
    "everything fixed": lambda: equations([Fixed(*MESH.places)]),
    "three symmetry planes": lambda: equations(
        [
            Fixed("left", components="x"),
            Fixed("front", components="y"),
            Fixed("top", components="z"),
        ]
    ),
    "the same value twice": lambda: equations([Fixed("jaw"), Moved("rami", "jaw", angle=0)]),
    "a jump in no common component": lambda: equations(
        [Fixed("rami", components="x"), Moved("jaw", translation=(0, 5, 0), components="yz")]
    ),
    "a jump of nothing graded": lambda: equations(
        [Fixed("rami"), Moved("jaw", translation=(0, 0, 0))], joins=[Graded("rami", "jaw", 2)]
    ),
    "a support and a traction on one surface": lambda: equations(
        [Fixed("top", components="z")], [Traction("top", value=(1, 0, 1))]
    ),
    "supports in a tuple, materials by region": lambda: Body(
        MESH, 2, {"muscle": TISSUE, "fat": TISSUE}, (Fixed("jaw"),)
    ),
    "a traction inside the body": lambda: equations((), [Traction("inside", value=(0, 0, 1))]),
    "a full turn": lambda: Moved("jaw", axis=(0, 0, 1), angle=-2 * np.pi, about=(0, 0, 0)),
    "a pressure as a column": lambda: equations((), [Pressure("top", value=lambda x: x[:, :1])]),
}


@pytest.mark.parametrize("name", FINE)
def test_look_alikes_are_accepted(name: str) -> None:
    FINE[name]()


def test_a_body_holds_copies_that_nobody_changes() -> None:
    materials, supports = {"fat": TISSUE, "muscle": TISSUE}, [Fixed("jaw")]
    stated = Body(MESH, 2, materials, supports)
    materials.clear()
    supports.clear()
    assert stated.material_of_region == (TISSUE, TISSUE)
    assert len(stated.supports) == 1
    with pytest.raises(AttributeError):
        stated.degree = 3  # type: ignore[misc]
