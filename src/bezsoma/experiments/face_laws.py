# SPDX-License-Identifier: BSD-3-Clause
"""What the law changes, in mm: a real face, its jaw moved forward or opened, by four laws.

The small mesh of the lower face: the tooth-bearing part of the mandible moves 5 or 10 mm forward
(the rami stay, the jump graded over as many mm), or the whole mandible opens by 15 degrees about
its condyles. All laws have the same stiffness at rest, E = 15 kPa and nu = 0.45; stiffening is the
deviatoric measure, which has an energy (the paper's own loses ellipticity in the graded band, where
strains near one: see docs/theory/nonlinear.md); Mooney-Rivlin is incompressible, with a pressure of
its own. Where a law finds no equilibrium, the table says how far it came.
"""

from __future__ import annotations

from dataclasses import dataclass
from time import process_time
from typing import Annotated, Any

import numpy as np

import bezsoma as bz
from bezsoma.arrays import Floats
from bezsoma.experiments.faces import face
from bezsoma.experiments.report import Report, Table, Tables
from bezsoma.mechanics.materials import Material
from bezsoma.mechanics.supports import Support

E, NU, DEGREE = 0.015, 0.45, 2
G = E / 3
LAWS: dict[str, Material] = {
    "linear": bz.LinearElastic(E, NU),
    "stiffening": bz.Stiffening(E, NU, 5.0, "deviatoric"),
    "neo-Hooke": bz.NeoHooke(E, NU),
    "Mooney-Rivlin, mixed": bz.MooneyRivlin(0.4 * G, 0.1 * G, np.inf),
}
POINTS = {"chin": (248, 137.7, 30), "lower lip": (248.5, 136.2, 53), "cheek": (195, 165, 50)}
TURN: dict[str, Any] = {"axis": (103, 3, 0), "about": (199, 228, 97)}
MOTIONS: dict[str, tuple[str, dict[str, Any]]] = {
    "5 mm forward": ("jaw", {"translation": (0, -5, 0)}),
    "10 mm forward": ("jaw", {"translation": (0, -10, 0)}),
    "15 degrees open": ("both", {"angle": np.radians(15), **TURN}),
}


@dataclass(frozen=True)
class Row:
    """How far three vertices of the skin move by one law."""

    motion: str
    law: str
    chin: Annotated[float, "chin, mm"]
    lower_lip: Annotated[float, "lower lip, mm"]
    cheek: Annotated[float, "cheek, mm"]
    borne: Annotated[float, "part of the motion"]
    iterations: int
    steps: int
    seconds: Annotated[float, "processor s"]


def body(mesh: bz.TetMesh, law: Material, motion: str) -> bz.Body:
    """The face with its jaw moved."""
    which, how = MOTIONS[motion]
    mixed = isinstance(law, bz.MooneyRivlin)
    if which == "both":
        supports: list[Support] = [bz.Fixed("skull"), bz.Moved("jaw", "rami", **how)]
        return bz.Body(mesh, DEGREE, law, supports, incompressible=mixed)
    supports = [bz.Fixed("skull", "rami"), bz.Moved("jaw", **how)]
    joins = [bz.Graded(over="rami", to="jaw", band=abs(how["translation"][1]))]
    return bz.Body(mesh, DEGREE, law, supports, joins=joins, incompressible=mixed)


def row(mesh: bz.TetMesh, name: str, motion: str) -> Row:
    """One line of the table; where no equilibrium was found, the last one that was."""
    start, borne = process_time(), 1.0
    try:
        solution = bz.solve(body(mesh, LAWS[name], motion), rtol=1e-8)
    except bz.NotConverged as failure:
        if failure.last is None:
            none = float("nan")
            return Row(motion, name, none, none, none, 0.0, 0, 0, process_time() - start)
        solution, borne = failure.last, failure.fraction
    steps = len({each.step for each in solution.path}) or 1
    seconds = process_time() - start
    chin, lip, cheek = (lengths(mesh, solution, np.array(point)) for point in POINTS.values())
    return Row(motion, name, chin, lip, cheek, borne, solution.iterations, steps, seconds)


def lengths(mesh: bz.TetMesh, solution: bz.Solution, point: Floats) -> float:
    """How far the vertex of the skin nearest to a point has moved, mm."""
    skin = mesh.vertices_of("skin")
    nearest = skin[np.argmin(np.linalg.norm(mesh.points[skin] - point, axis=1))]
    u = solution.displacement.controls[solution.net.of_vertices(nearest)]
    return float(np.linalg.norm(u))


def measured(quick: bool = False) -> Tables:
    """All laws and motions; quick: 5 mm by the three laws without a pressure."""
    here = face("small")
    if here.name.startswith("phantom"):
        raise bz.InputError(
            "this experiment opens a jaw about its condyles, whose place is known for the Visible "
            "Human only; set BEZSOMA_DATA to the folder that holds face_small/face_small.npz"
        )
    pairs = [(motion, law) for motion in MOTIONS for law in LAWS]
    chosen = pairs[:3] if quick else pairs
    rows = [row(here.mesh, law, motion) for motion, law in chosen]
    held = {"chin": 1e-3, "lower_lip": 1e-3, "cheek": 1e-3, "borne": 1e-9}
    about = f"Degree {DEGREE}, E = 15 kPa and nu = 0.45 at rest; lengths of the displacement."
    return {"laws": Table(about, rows, ("motion", "law"), held)}


def told(tables: Tables) -> Report:
    """The page."""
    said = []
    for motion in MOTIONS:
        rows = list(tables["laws"].where(motion=motion, borne=1.0))
        spans = {
            name: np.ptp([getattr(row, name.replace(" ", "_")) for row in rows]) for name in POINTS
        }
        parts = ", ".join(f"{span:.2f} mm at the {name}" for name, span in spans.items())
        said.append(f"- {motion}: the laws differ by {parts}.")
    return Report(
        "What the law changes on a face",
        "Linear elasticity was taken for the face because of the small displacements of the "
        "surgical procedure.",
        "\n".join(said),
        "For 5 mm the paper is right: the law hardly shows. For 10 mm the lips show it, and a "
        "planner who opens a jaw needs a law at finite strain. Stiffening is the deviatoric "
        "measure here: the paper's own (Frobenius), moved by 5 mm, comes as far as 87.5 % of the "
        "motion, where it has lost strong ellipticity in five tets beside the band between jaw and "
        "rami, and the error says so. docs/verification/face_laws.md has components too.",
        tables,
        {},
    )
