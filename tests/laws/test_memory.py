# SPDX-License-Identifier: BSD-3-Clause
"""What a solve says it will take, against what it takes; and what is refused for it."""

from __future__ import annotations

import subprocess
import sys
import tracemalloc
from dataclasses import replace
from pathlib import Path

import pytest

from bezsoma.errors import InputError
from bezsoma.mechanics import Body, Fixed, LinearElastic, Moved, NeoHooke
from bezsoma.mesh import ControlNet, block
from bezsoma.solvers import memory, solve
from processes import prelude

FACTOR = {"multigrid": 2.0, "cg": 2.0, "direct": 1.6}
"""How far an estimate may be from what is measured, either way."""

MEASURED = """
import os, re, sys, bezsoma as bz
from pathlib import Path
from bezsoma.mesh import ControlNet
from bezsoma.solvers.memory import estimate
solver = sys.argv[1]
supports = [bz.Fixed("bottom"), bz.Moved("top", translation=(0.1, 0, 0))]
law = bz.LinearElastic(1.0, 0.3)
bz.solve(bz.Body(bz.block(cells=2), 2, law, supports), solver=solver)  # what is imported once

def kilobytes(what):
    return int(re.search(what + r":\\s+(\\d+) kB", Path("/proc/self/status").read_text())[1])

for case in sys.argv[2:]:
    sys.stdout.flush()
    if os.fork():
        assert os.wait()[1] == 0
        continue
    degree, cells = map(int, case.split("x"))
    mesh = bz.block(cells=cells)
    net = ControlNet(mesh, degree)
    net.of_place("top"), mesh.boundary, mesh.faces_of_tet, mesh.edges_of_tet, mesh.gradients
    Path("/proc/self/clear_refs").write_text("5")  # the peak begins anew
    before = kilobytes("VmRSS")
    bz.solve(bz.Body(mesh, degree, law, supports), solver=solver,
             rtol=1e-3 if solver == "cg" else 1e-8)
    print(degree, 3 * net.count, estimate(net, solver), 1024 * (kilobytes("VmHWM") - before))
    sys.stdout.flush()
    os._exit(0)
"""


def measured(solver: str, cells: dict[int, int]) -> list[tuple[int, ...]]:
    """Degree, unknowns, bytes told and bytes taken beyond mesh and net, each in its own process."""
    if not Path("/proc/self/clear_refs").exists():
        pytest.skip("this system does not tell the peak of a part of a run")
    cases = [f"{degree}x{count}" for degree, count in cells.items()]
    command = [sys.executable, "-S", "-c", prelude() + MEASURED, solver, *cases]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return [tuple(map(int, line.split())) for line in done.stdout.splitlines()]


CELLS = {
    "multigrid": {1: 31, 2: 15, 3: 10, 4: 8, 6: 5},
    "cg": {1: 24, 2: 12, 3: 7, 4: 5, 6: 3},
    "direct": {1: 16, 2: 7, 3: 4, 4: 3, 6: 2},
}


@pytest.mark.parametrize("solver", CELLS)
def test_the_estimate_is_right_within_a_factor(solver: str) -> None:
    factor = FACTOR[solver]
    found = measured(solver, CELLS[solver])
    assert [degree for degree, *_ in found] == list(CELLS[solver])
    wrong = {
        degree: f"{taken / told:.2f} of what is told for {unknowns} unknowns"
        for degree, unknowns, told, taken in found
        if not told / factor < taken < told * factor
    }
    assert wrong == {}


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


def test_bodies_with_a_pressure_or_other_laws_are_refused_too(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    linear = held(3, 4)
    mixed = replace(linear, pressure_degree=2)
    finite = replace(linear, materials=NeoHooke(E=1.0, nu=0.3))
    monkeypatch.setattr(memory, "available", lambda: 500_000)
    for body, solver, other in [(mixed, "direct", "saddle"), (finite, "direct", "multigrid")]:
        with pytest.raises(InputError, match=f"are free; .* or solver='{other}'"):
            solve(body, solver=solver)
        with pytest.raises(InputError, match=f"by '{other}' take about"):
            solve(body, solver=other)


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
