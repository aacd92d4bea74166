# SPDX-License-Identifier: BSD-3-Clause
"""Steps where the fast way has its limits: python benchmarks/limits.py.

The counts of docs/theory/fast.md: a nearly incompressible cube, a stiffness that jumps by 1e4, and
sheets one tet thick. All at degree 2; steps do not depend on the machine but for its rounding.
"""

from __future__ import annotations

from typing import Any

import numpy as np

import bezsoma as bz

CELLS, DEGREE, JUMP, DRAWS = 6, 2, 1e4, 5


def main() -> None:
    """Print all counts."""
    for nu in (0.3, 0.45, 0.49, 0.499):
        print(f"cube, nu = {nu}: {steps(cube(), bz.LinearElastic(1.0, nu))}", flush=True)
    centre = places(cube())
    layers = {
        "the upper half": centre[:, 2] > 0.5,
        "layers one cell thick": (centre[:, 2] * CELLS).astype(int) % 2 == 0,
        "a core of 2 cells a side": (abs(centre - 0.5) < 1 / CELLS).all(axis=1),
    }
    for name, stiff in layers.items():
        print(f"{name} stiffer by {JUMP:g}: {jumping(stiff)}", flush=True)
    for part in (0.5, 0.1):
        print(f"{part:.0%} of the cells, drawn: {drawn(part)}", flush=True)
    for wide in (1, 2, 5):
        print(f"sheet 50 : 50 : 1, tets {wide} : 1: {sheet(wide)}", flush=True)


def cube() -> bz.TetMesh:
    """Of 1 mm, with the middle quarter of its top as `patch`."""
    mesh = bz.block(cells=CELLS)
    top = mesh.surfaces["top"]
    middle = (abs(mesh.points[top].mean(axis=1)[:, :2] - 0.5) < 0.25).all(axis=1)
    return mesh.with_surface("patch", top[middle])


def places(mesh: bz.TetMesh) -> np.ndarray[Any, Any]:
    """The centres of the tets, (t, 3) mm."""
    return mesh.points[mesh.tets].mean(axis=1)


def steps(mesh: bz.TetMesh, laws: Any) -> int:
    """Clamped below, pressed on the patch."""
    pressed = [bz.Pressure("patch", value=0.01)]
    body = bz.Body(mesh, DEGREE, laws, [bz.Fixed("bottom")], pressed)
    return bz.solve(body, solver="multigrid").iterations


def jumping(stiff: np.ndarray[Any, Any]) -> int:
    """The cube with its stiff tets, (t,) bool, at nu = 0.3."""
    mesh = cube()
    mesh = bz.TetMesh(
        mesh.points, mesh.tets, stiff.astype(int), ("soft", "stiff"), surfaces=mesh.surfaces
    )
    laws = {"soft": bz.LinearElastic(1.0, 0.3), "stiff": bz.LinearElastic(JUMP, 0.3)}
    return steps(mesh, laws)


def drawn(part: float) -> list[int]:
    """Cells drawn at random are the stiff ones, several draws."""
    mesh = cube()
    cell = (places(mesh) * CELLS).astype(int) @ [1, CELLS, CELLS**2]
    draws = (np.random.default_rng(seed).random(CELLS**3) < part for seed in range(DRAWS))
    return sorted(jumping(stiff[cell]) for stiff in draws)


def sheet(wide: int) -> int:
    """Clamped on one side and pressed; tets one sheet thick and so many times as wide."""
    mesh = bz.block(size=(50, 50, 1), cells=(50 // wide, 50 // wide, 1))
    law, pressed = bz.LinearElastic(1.0, 0.4), [bz.Pressure("top", value=1e-6)]
    body = bz.Body(mesh, DEGREE, law, [bz.Fixed("left")], pressed)
    return bz.solve(body, solver="multigrid").iterations


if __name__ == "__main__":
    main()
