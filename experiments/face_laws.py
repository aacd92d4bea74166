# SPDX-License-Identifier: BSD-3-Clause
"""What the law changes, in mm: a real face, its jaw moved forward or opened, by four laws.

    python experiments/face_laws.py [degree ...] > docs/verification/face_laws.md

The small mesh of the lower face: the tooth-bearing part of the mandible moves 5 or 10 mm forward
(the rami stay, the jump graded over as many mm), or the whole mandible opens by 15 degrees about
its condyles. All laws have the same stiffness at rest, E = 15 kPa and nu = 0.45; stiffening is the
deviatoric measure, which has an energy (the paper's own loses ellipticity in the graded band, where
strains near one: see docs/theory/nonlinear.md); Mooney-Rivlin is incompressible, with a pressure of
its own. Printed is how far skin points move, and where a law
finds no equilibrium, how far it came.
"""

from __future__ import annotations

import sys
from pathlib import Path
from time import perf_counter

import numpy as np

import bezsoma as bz

DATA = Path(__file__).resolve().parents[2] / "shared" / "data"
E, NU = 0.015, 0.45
G = E / 3
LAWS = {
    "linear": bz.LinearElastic(E, NU),
    "stiffening": bz.Stiffening(E, NU, 5.0, "deviatoric"),
    "neo-Hooke": bz.NeoHooke(E, NU),
    "Mooney-Rivlin, mixed": bz.MooneyRivlin(0.4 * G, 0.1 * G, np.inf),
}
POINTS = {
    "chin": (248, 137.7, 30),
    "lower lip": (248.5, 136.2, 53),
    "cheek": (195, 165, 50),
}
TURN = {"axis": (103, 3, 0), "about": (199, 228, 97)}
MOTIONS = {
    "5 mm forward": ("jaw", {"translation": (0, -5, 0)}),
    "10 mm forward": ("jaw", {"translation": (0, -10, 0)}),
    "15 degrees open": ("both", {"angle": np.radians(15), **TURN}),
}


def body(mesh: bz.TetMesh, degree: int, law: object, motion: str) -> bz.Body:
    """The face with its jaw moved."""
    which, how = MOTIONS[motion]
    mixed = {"incompressible": True} if motion and isinstance(law, bz.MooneyRivlin) else {}
    if which == "both":
        supports = [bz.Fixed("skull"), bz.Moved("jaw", "rami", **how)]
        return bz.Body(mesh, degree, law, supports, **mixed)
    supports = [bz.Fixed("skull", "rami"), bz.Moved("jaw", **how)]
    joins = [bz.Graded(over="rami", to="jaw", band=abs(how["translation"][1]))]
    return bz.Body(mesh, degree, law, supports, joins=joins, **mixed)


def row(mesh: bz.TetMesh, degree: int, name: str, motion: str) -> str:
    """One line of the table."""
    start, note = perf_counter(), ""
    try:
        solution = bz.solve(body(mesh, degree, LAWS[name], motion), rtol=1e-8)
    except bz.NotConverged as failure:
        if failure.last is None:
            return f"| {motion} | {degree} | {name} | - | - | - | no answer: {failure} |"
        solution = failure.last
        note = f"; only {100 * failure.fraction:.0f} % of the motion"
    points = mesh.points
    skin = mesh.vertices_of("skin")
    moved = []
    for point in POINTS.values():
        nearest = skin[np.argmin(np.linalg.norm(points[skin] - point, axis=1))]
        u = solution.displacement.controls[solution.net.of_vertices(nearest)]
        moved.append(f"{np.linalg.norm(u):.2f} ({', '.join(f'{x:+.2f}' for x in u)})")
    steps = len({each.step for each in solution.path}) or 1
    seconds = perf_counter() - start
    said = f"{solution.iterations} iterations, {steps} steps, {seconds:.0f} s{note}"
    return f"| {motion} | {degree} | {name} | {' | '.join(moved)} | {said} |"


def main() -> None:
    """The table, line by line."""
    mesh = bz.read_mesh(
        DATA / "face_small" / "face_small.npz",
        surfaces={"skin": 1, "skull": 2, "jaw": 3, "rami": 4, "cut": 5},
    )
    print(f"| motion | degree | law | {' | '.join(f'{name}, mm' for name in POINTS)} | |")
    print("|---|---|---|---|---|---|---|")
    for degree in map(int, sys.argv[1:] or ["2", "3"]):
        for motion in MOTIONS:
            for name in LAWS:
                print(row(mesh, degree, name, motion), flush=True)


if __name__ == "__main__":
    main()
