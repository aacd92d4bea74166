# SPDX-License-Identifier: BSD-3-Clause
"""What the law changes on a real face, in mm: the table and picture of face_laws.md.

    python studies/face_laws.py table [degree ...]
    python studies/face_laws.py picture "15 degrees open" docs/images/face_laws.png

Bodies, motions and laws are those of `bezsoma experiment face_laws`, and two laws more: the paper's
own stiffening (Frobenius), which has no energy, and the one with the energy norm.
"""

from __future__ import annotations

import sys
from io import BytesIO
from pathlib import Path
from time import process_time

import numpy as np
from PIL import Image

import bezsoma as bz
from bezsoma.experiments import face_laws as laws
from bezsoma.experiments.faces import face
from bezsoma.mesh.field import Field

MORE = {
    "stiffening, the paper's": bz.Stiffening(laws.E, laws.NU, 5.0),
    "stiffening, energy norm": bz.Stiffening(laws.E, laws.NU, 5.0, "energy"),
}
LAWS = laws.LAWS | MORE
FIRST = "5 mm forward"
"""The motion for which the two laws more are shown, at degree 2."""


def body(mesh: bz.TetMesh, degree: int, name: str, motion: str) -> bz.Body:
    """The face with its jaw moved."""
    laws.DEGREE = degree
    return laws.body(mesh, LAWS[name], motion)


def row(mesh: bz.TetMesh, degree: int, name: str, motion: str) -> str:
    """One line of the table; where a law finds no balance, how far it came."""
    start, note = process_time(), ""
    try:
        solution = bz.solve(body(mesh, degree, name, motion), rtol=1e-8)
    except bz.NotConverged as failure:
        if failure.last is None:
            return f"| {motion} | {degree} | {name} | - | - | - | no answer: {failure} |"
        solution, note = (
            failure.last,
            f"; at {100 * failure.fraction:.0f} % of the motion: {failure}",
        )
    skin, moved = mesh.vertices_of("skin"), []
    for point in laws.POINTS.values():
        nearest = skin[np.argmin(np.linalg.norm(mesh.points[skin] - np.array(point), axis=1))]
        u = solution.displacement.controls[solution.net.of_vertices(nearest)]
        moved.append(f"{np.linalg.norm(u):.2f} ({', '.join(f'{x:+.2f}' for x in u)})")
    steps = len({each.step for each in solution.path}) or 1
    seconds = process_time() - start
    said = f"{solution.iterations} iterations, {steps} steps, {seconds:.0f} s{note}"
    return f"| {motion} | {degree} | {name} | {' | '.join(moved)} | {said} |"


def table(degrees: list[int]) -> None:
    """All rows, as they come."""
    mesh = face("small").mesh
    print(
        f"| motion | degree | law | {' | '.join(f'{n}, mm' for n in laws.POINTS)} | |", flush=True
    )
    print("|---|---|---|---|---|---|---|")
    for degree in degrees:
        for motion in laws.MOTIONS:
            more = MORE if motion == FIRST and degree == 2 else {}
            for name in laws.LAWS | more:
                print(row(mesh, degree, name, motion), flush=True)


def picture(motion: str, path: str) -> None:
    """The skin by the four laws side by side, coloured by how far it is from the linear answer."""
    mesh, parts, linear = face("small").mesh, [], None
    for name in laws.LAWS:
        u = bz.solve(body(mesh, 2, name, motion), rtol=1e-8).displacement
        linear = u if linear is None else linear
        apart = Field(u.net, u.controls - linear.controls)
        drawn = bz.picture(
            None,
            mesh,
            apart,
            displacement=u,
            surface="skin",
            label="from the linear, mm",
            limits=(0, 4),
            title=name,
            size=(560, 640),
        )
        parts.append(Image.open(BytesIO(drawn)))
    whole = Image.new("RGB", (sum(part.width for part in parts), parts[0].height), "white")
    for number, part in enumerate(parts):
        whole.paste(part, (sum(p.width for p in parts[:number]), 0))
    whole.save(Path(path))


if __name__ == "__main__":
    if sys.argv[1] == "picture":
        picture(*sys.argv[2:4])
    else:
        table([int(degree) for degree in sys.argv[2:]] or [2, 3])
