# SPDX-License-Identifier: BSD-3-Clause
"""Ours, as a user calls it: `bz.solve(body)`, with reactions and energy."""

from __future__ import annotations

import problem

import bezsoma as bz
from engines import Answer
from engines.clock import Clock


def configurations(degree: int, unknowns: int) -> list[str]:
    """Nothing to choose."""
    return ["multigrid"]


def prepared(tets: problem.Tets, degree: int) -> bz.Body:
    """The mesh, checked and with its surfaces named, as a body."""
    surfaces = {"bottom": tets.bottom, "patch": tets.patch}
    return problem.body(bz.TetMesh(tets.points, tets.tets, surfaces=surfaces), degree)


def solved(
    body: bz.Body, degree: int, configuration: str, threads: int, tolerance: float
) -> Answer:
    """Set-up ends where the first iteration is told of."""
    clock, first = Clock(), []

    def progress(stage: str, fraction: float | None, note: str) -> None:
        if stage == "solving" and fraction is not None and not first:
            first.append(clock.wall())

    solution = bz.solve(
        body, solver=configuration, rtol=tolerance, threads=threads, progress=progress
    )
    both, processor = clock.wall(), clock.processor()
    return Answer(
        3 * solution.net.count,
        first[0],
        both - first[0],
        processor,
        solution.iterations,
        solution.residual,
        solution.energy,
    )
