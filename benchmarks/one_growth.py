# SPDX-License-Identifier: BSD-3-Clause
"""One body from a mesh file to results on disk in this process: started by growth.py."""

from __future__ import annotations

import tempfile
from pathlib import Path
from time import perf_counter
from typing import Any

import isolated
import problem

import bezsoma as bz
from bezsoma.results import write_fields


def run(request: dict[str, Any]) -> dict[str, Any]:
    """Make the mesh file, or measure what is done with it."""
    path, degree = Path(request["mesh"]), request["degree"]
    if "unknowns" in request:
        bz.write_mesh(path, problem.block(request["unknowns"], degree), overwrite=True)
        return {}
    return measured(path, degree, request["threads"])


def measured(path: Path, degree: int, threads: int) -> dict[str, Any]:
    """Seconds by stage, iterations, memory."""
    warm_up(degree, threads)
    imported = isolated.resident()
    isolated.forget_peak()
    start = perf_counter()
    body = problem.body(bz.read_mesh(path), degree)
    reading = perf_counter() - start
    told: dict[str, float] = {}
    peaks = {"reading": isolated.own_peak()}

    def progress(stage: str, fraction: float | None, note: str) -> None:
        named = "iterations" if stage == "solving" and fraction is not None else stage
        if named not in told:
            told[named], peaks["before " + named] = perf_counter(), isolated.own_peak()

    start = perf_counter()
    solution = bz.solve(body, solver="multigrid", threads=threads, progress=progress)
    whole = perf_counter() - start
    peak = isolated.peak()
    return {
        "degree": degree,
        "unknowns": 3 * solution.net.count,
        "tets": len(body.mesh.tets),
        "iterations": solution.iterations,
        "residual": solution.residual,
        "solve": whole,
        "stages": {"reading": reading} | stages(solution, told, whole) | written(solution),
        "bytes_imported": imported,
        "bytes_peak": peak,
        "bytes_peaks": peaks,
        "bytes_peak_written": isolated.peak(),
    }


def warm_up(degree: int, threads: int) -> None:
    """Do it all once with a small body, so that what a process does once is not counted."""
    with tempfile.TemporaryDirectory() as folder:
        bz.write_mesh(Path(folder) / "mesh.npz", problem.block(0, degree))
        body = problem.body(bz.read_mesh(Path(folder) / "mesh.npz"), degree)
    written(bz.solve(body, solver="multigrid", threads=threads))


def stages(solution: bz.Solution, told: dict[str, float], whole: float) -> dict[str, float]:
    """Seconds by stage; iterations are told apart from what makes the preconditioner.

    What `solve` spends outside its stages is the making of the operator, which waits for its first
    use: the residual at zero free displacement.
    """
    known = dict(solution.timings)
    solving = known.pop("solving")
    if "stiffness" in known:
        known["stiffness"] += whole - solving - sum(known.values())
    known["preconditioner"] = told["iterations"] - told["solving"]
    known["iterations"] = solving - known["preconditioner"]
    return known


def written(solution: bz.Solution) -> dict[str, float]:
    """Seconds for the files of a results folder."""
    with tempfile.TemporaryDirectory() as folder:
        start = perf_counter()
        write_fields(Path(folder), solution.displacement)
        middle = perf_counter()
        fields = {"displacement": solution.displacement}
        bz.write_vtu(Path(folder) / "u.vtu", solution.body.mesh, fields)
        return {"writing": middle - start, "writing VTU": perf_counter() - middle}


if __name__ == "__main__":
    isolated.serve(run)
