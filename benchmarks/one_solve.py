# SPDX-License-Identifier: BSD-3-Clause
"""One solve by one engine in this process: started by peers.py, not by hand."""

from __future__ import annotations

from dataclasses import asdict
from importlib import import_module
from pathlib import Path
from time import perf_counter
from typing import Any

import isolated
import problem

TIGHTENED = 4


def solve(request: dict[str, Any]) -> dict[str, Any]:
    """A warm-up on a few cells, then the solve; tightened until the true residual holds."""
    engine = import_module(f"engines.{request['engine']}_engine")
    degree, way, threads = (request[key] for key in ("degree", "configuration", "threads"))
    small = problem.tets(3 * (2 * degree + 1) ** 3, degree)
    engine.solved(engine.prepared(small, degree), degree, way, threads, 1e-4)
    imported = isolated.resident()
    start = perf_counter()
    mesh = engine.prepared(problem.read_tets(Path(request["tets"])), degree)
    preparing, meshed = perf_counter() - start, isolated.resident()
    tolerance = request["tolerance"]
    for _ in range(TIGHTENED):
        isolated.forget_peak()
        answer = engine.solved(mesh, degree, way, threads, tolerance)
        peak = isolated.peak()
        if answer.residual <= problem.RTOL:
            break
        tolerance *= 0.5 * problem.RTOL / answer.residual
    else:
        return {"failed": f"residual {answer.residual:.1e} after {answer.iterations} iterations"}
    return asdict(answer) | {
        "together": answer.together,
        "preparing": preparing,
        "tolerance": tolerance,
        "bytes_imported": imported,
        "bytes_meshed": meshed,
        "bytes_peak": peak,
    }


if __name__ == "__main__":
    isolated.serve(solve)
