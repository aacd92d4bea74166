# SPDX-License-Identifier: BSD-3-Clause
"""What a solve says it will take, against what it takes; and what is refused for it."""

from __future__ import annotations

import subprocess
import sys
import tracemalloc
from pathlib import Path

import pytest

from bezsoma.errors import InputError
from bezsoma.mechanics import Body, Fixed, LinearElastic, Moved
from bezsoma.mesh import ControlNet, block
from bezsoma.solvers import memory, solve

FACTOR = 2.0
"""How far an estimate may be from what is measured, either way."""

MEASURED = """
import re, bezsoma as bz
from pathlib import Path
from bezsoma.mesh import ControlNet
from bezsoma.solvers.memory import estimate
solver, degree, cells = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
mesh = bz.block(cells=cells)
supports = [bz.Fixed("bottom"), bz.Moved("top", translation=(0.1, 0, 0))]
body = bz.Body(mesh, degree, bz.LinearElastic(1.0, 0.3), supports)
small = bz.Body(bz.block(cells=2), 2, body.materials, supports)
bz.solve(small, solver=solver)  # what is imported and set up once
net = ControlNet(mesh, degree)
net.of_place("top"), mesh.boundary, mesh.faces_of_tet, mesh.edges_of_tet, mesh.gradients
def kilobytes(what):
    return int(re.search(what + r":\\s+(\\d+) kB", Path("/proc/self/status").read_text())[1])
Path("/proc/self/clear_refs").write_text("5")  # the peak begins anew
before = kilobytes("VmRSS")
solution = bz.solve(body, solver=solver, rtol=1e-3 if solver == "cg" else 1e-8)
print(3 * net.count, estimate(net, solver), (kilobytes("VmHWM") - before) * 1024)
"""


def measured(solver: str, degree: int, cells: int) -> tuple[int, int, int]:
    """Unknowns, bytes told, bytes taken beyond mesh and net: in a process of its own."""
    if not Path("/proc/self/clear_refs").exists():
        pytest.skip("this system does not tell the peak of a part of a run")
    path = f"import sys; sys.path[:0] = {sys.path!r}\n"
    command = [sys.executable, "-S", "-c", path + MEASURED, solver, str(degree), str(cells)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    unknowns, told, taken = map(int, done.stdout.split())
    return unknowns, told, taken


CELLS = {
    "multigrid": {1: 31, 2: 15, 3: 10, 4: 8, 6: 5},
    "cg": {1: 24, 2: 12, 3: 7, 4: 5, 6: 3},
    "direct": {1: 16, 2: 7, 3: 4, 4: 3, 6: 2},
}
CASES = [(solver, degree, cells) for solver, by in CELLS.items() for degree, cells in by.items()]


@pytest.mark.parametrize(("solver", "degree", "cells"), CASES)
def test_the_estimate_is_right_within_a_factor_of_two(solver: str, degree: int, cells: int) -> None:
    unknowns, told, taken = measured(solver, degree, cells)
    assert told / FACTOR < taken < told * FACTOR, f"{unknowns} unknowns: {taken / told:.2f} of it"


def held(degree: int, cells: int) -> Body:
    """A block between two planes."""
    supports = [Fixed("bottom"), Moved("top", translation=(0.1, 0, 0))]
    return Body(block(cells=cells), degree, LinearElastic(1.0, 0.3), supports)


@pytest.mark.parametrize("solver", ["auto", "multigrid", "cg", "direct"])
def test_what_does_not_fit_is_refused_before_it_is_taken(
    solver: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    body = held(3, 16)
    monkeypatch.setattr(memory, "available", lambda: 5_000_000)
    tracemalloc.start()
    with pytest.raises(InputError) as caught:
        solve(body, solver=solver)
    taken = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    net = ControlNet(body.mesh, 3)
    chosen = "multigrid" if solver == "auto" else solver
    needed = memory.estimate(net, chosen)
    said = str(caught.value)
    assert f"{3 * net.count} unknowns of degree 3 by {chosen!r}" in said
    assert f"about {needed / 2**30:.1f} GiB" in said and "0.0 GiB are free" in said
    assert "take a lower degree or a coarser mesh" in said
    assert ("solver='multigrid'" in said) == (chosen != "multigrid")
    assert taken < 600 * 3 * net.count, (
        "numbering and supports, and nothing of the size of a matrix"
    )


def test_what_fits_just_so_is_not_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    body = held(3, 4)
    needed = memory.estimate(ControlNet(body.mesh, 3), "multigrid")
    monkeypatch.setattr(memory, "available", lambda: needed)
    assert solve(body, solver="multigrid").residual <= 1e-8
    monkeypatch.setattr(memory, "available", lambda: needed - 1)
    with pytest.raises(InputError, match="are free"):
        solve(body, solver="multigrid")


def test_a_system_that_does_not_say_refuses_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(memory, "available", lambda: None)
    assert solve(held(2, 4), solver="multigrid").residual <= 1e-8


def test_available_is_what_the_system_says() -> None:
    there = memory.available()
    assert there is not None and 2**26 < there < 2**50


@pytest.mark.parametrize("solver", ["multigrid", "cg", "direct"])
def test_estimates_grow_with_the_mesh_and_the_degree(solver: str) -> None:
    by_cells = [memory.estimate(ControlNet(block(cells=n), 2), solver) for n in (4, 8, 12)]
    assert by_cells == sorted(by_cells)
    mesh = block(cells=4)
    by_degree = [memory.estimate(ControlNet(mesh, n), solver) for n in range(1, 11)]
    assert by_degree == sorted(by_degree)
