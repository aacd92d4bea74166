# SPDX-License-Identifier: BSD-3-Clause
"""How long a solve takes, by degree and method: ./dev bench.

A block of Kuhn's tets is clamped below and drawn sideways on the middle quarter of its top: a
smooth body with a load as in the paper's figure 6, spread over a patch. The cells are chosen so
that all degrees have about as many unknowns.
"""

from __future__ import annotations

import argparse
import os
import platform
import time

import numpy as np

import bezsoma as bz

DEGREES = (1, 2, 3, 4, 6)


def block(unknowns: int, degree: int) -> bz.TetMesh:
    """A unit block with about so many unknowns at that degree, its middle top quarter named."""
    cells = max(1, round(((unknowns / 3) ** (1 / 3) - 1) / degree))
    mesh = bz.block(cells=(cells, cells, cells))
    return mesh.with_surface("patch", patch(mesh))


def patch(mesh: bz.TetMesh) -> np.ndarray:
    """The facets of the top whose middle lies in its middle quarter; all where cells are few."""
    top = mesh.facets_of("top")
    off = np.abs(mesh.points[top].mean(axis=1)[:, :2] - 0.5).max(axis=1)
    return top[off < 0.25] if (off < 0.25).any() else top


def body(mesh: bz.TetMesh, degree: int) -> bz.Body:
    """The block clamped below, with a traction on the patch."""
    return bz.Body(
        mesh,
        degree=degree,
        materials=bz.LinearElastic(E=1.0, nu=0.3),
        supports=[bz.Fixed("bottom")],
        loads=[bz.Traction("patch", value=(0.01, 0, 0))],
    )


def row(degree: int, solver: str, unknowns: int) -> str:
    """One line of the table: sizes, seconds, iterations."""
    problem = body(block(unknowns, degree), degree)
    start = time.perf_counter()
    solution = bz.solve(problem, solver=solver)
    whole = time.perf_counter() - start
    solving = solution.timings["solving"]
    count = 3 * solution.net.count
    return (
        f"{degree:6d} {solver:>7} {len(problem.mesh.tets):8d} {count:9d} {solution.iterations:10d}"
        f" {whole - solving:9.2f} {solving:9.2f} {count / whole / 1e3:10.0f}"
    )


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(prog="./dev bench", description=__doc__)
    parser.add_argument("--unknowns", type=int, default=20_000, help="about how many")
    parser.add_argument("--degrees", type=int, nargs="+", default=DEGREES)
    parser.add_argument("--solvers", nargs="+", default=["direct", "cg"])
    options = parser.parse_args()
    print(f"bezsoma {bz.__version__}, {platform.machine()}, {os.cpu_count()} cores")
    print("degree  solver     tets  unknowns iterations  set-up s   solve s  unknowns/ms")
    for degree in options.degrees:
        for solver in options.solvers:
            print(row(degree, solver, options.unknowns), flush=True)


if __name__ == "__main__":
    main()
