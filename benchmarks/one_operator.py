# SPDX-License-Identifier: BSD-3-Clause
"""K u timed in this process, with the machine's peaks beside it: started by roofline.py."""

from __future__ import annotations

from functools import partial
from typing import Any

import counts
import isolated
import numpy as np
import peaks
import problem

from bezsoma import _core
from bezsoma.arrays import on_lines
from bezsoma.equations.element import lame_constants
from bezsoma.equations.matrix_free import MatrixFree
from bezsoma.mesh.control_net import ControlNet

KINDS = {8: np.float64, 4: np.float32}


def measure(request: dict[str, Any]) -> dict[str, Any]:
    """All widths and numbers of sides of one degree and instruction set, and the peaks."""
    degree, threads, repeats = (request[key] for key in ("degree", "threads", "repeats"))
    body = problem.body(problem.block(request["unknowns"], degree), degree)
    net = ControlNet(body.mesh, degree)
    operator = MatrixFree(net, lame_constants(body), threads, request["instructions"])
    rows = []
    for width in (8, 4):
        kernel = _core.MatrixFree(
            operator.walk(), threads, request["instructions"], single=width == 4
        )
        apply = kernel.apply if width == 8 else kernel.apply_single
        limit = peaks.flops(width, threads, repeats)
        for sides in request["sides"]:
            x = on_lines((net.count, 3, sides), KINDS[width])
            x[...] = np.random.default_rng(1).random(x.shape)
            y = on_lines(x.shape, x.dtype)
            y[...] = 0
            moved = counts.least_bytes(degree, len(body.mesh.tets), 3 * net.count, width, sides)
            found = {
                "width": width,
                "sides": sides,
                "unknowns": 3 * net.count,
                "tets": len(body.mesh.tets),
                "bytes": moved,
                "seconds": peaks.least(partial(apply, x, y), repeats, threads),
                "triad": peaks.triad(max(moved, 1 << 20), threads),
                "peak_flops": limit,
            }
            rows.append(found)
    same = {key: request[key] for key in ("degree", "threads", "instructions")}
    return {"rows": [same | row for row in rows]}


if __name__ == "__main__":
    isolated.serve(measure)
