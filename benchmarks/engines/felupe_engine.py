# SPDX-License-Identifier: BSD-3-Clause
"""felupe, degrees 1 and 2 on small blocks, with MKL PARDISO."""

from __future__ import annotations

from typing import Any

import felupe
import numpy as np
import problem
from pypardiso import spsolve

from engines import Answer
from engines.clock import Clock

UP_TO = 120_000


def configurations(degree: int, unknowns: int) -> list[str]:
    """One way, for small blocks."""
    return ["pardiso"] if degree <= 2 and unknowns <= UP_TO else []


def prepared(tets: problem.Tets, degree: int) -> tuple[problem.Tets, Any]:
    """The same tets, turned as felupe wants them, with middles of edges at degree 2."""
    edges = tets.points[tets.tets[:, 1:]] - tets.points[tets.tets[:, :1]]
    mirrored = np.linalg.det(edges) < 0
    cells = np.where(mirrored[:, None], tets.tets[:, [0, 1, 3, 2]], tets.tets)
    mesh = felupe.Mesh(tets.points, cells, "tetra")
    return tets, mesh if degree == 1 else mesh.add_midpoints_edges()


def solved(
    mesh: tuple[problem.Tets, Any],
    degree: int,
    configuration: str,
    threads: int,
    tolerance: float,
) -> Answer:
    """One linear solve: assembly, partition, factorisation."""
    tets, points = mesh
    clock = Clock()
    region = (felupe.RegionTetra if degree == 1 else felupe.RegionQuadraticTetra)(points)
    field = felupe.FieldContainer([felupe.Field(region, dim=3)])
    clamped = felupe.Boundary(field[0], fz=0)
    _, dof1 = felupe.dof.partition(field, {"clamped": clamped})
    solid = felupe.SolidBody(felupe.LinearElastic(E=problem.E, nu=problem.NU), field)
    matrix = solid.assemble.matrix().tocsr()
    f = _traction(tets, points.points, degree).ravel()
    matrix, b = matrix[dof1][:, dof1], f[dof1]
    setting_up = clock.wall()
    x = spsolve(matrix, b)
    both, processor = clock.wall(), clock.processor()
    residual = float(np.linalg.norm(b - matrix @ x) / np.linalg.norm(b))
    return Answer(len(f), setting_up, both - setting_up, processor, 1, residual, float(b @ x / 2))


def _traction(tets: problem.Tets, points: np.ndarray[Any, Any], degree: int) -> Any:
    """The forces of a constant traction: thirds at the vertices, or at the middles of the edges."""
    a, b, c = (tets.points[tets.patch[:, i]] for i in range(3))
    thirds = np.linalg.norm(np.cross(b - a, c - a), axis=1)[:, None] / 6 * problem.TRACTION
    f = np.zeros_like(points)
    if degree == 1:
        for i in range(3):
            np.add.at(f, tets.patch[:, i], thirds)
        return f
    grid = {tuple(p): i for i, p in enumerate(np.round(points * 2**20).astype(np.int64).tolist())}
    for middles in ((a + b) / 2, (b + c) / 2, (c + a) / 2):
        keys = np.round(middles * 2**20).astype(np.int64).tolist()
        np.add.at(f, [grid[tuple(key)] for key in keys], thirds)
    return f
