# SPDX-License-Identifier: BSD-3-Clause
"""What a solve says it will take, against what it takes; and what is refused for it."""

from __future__ import annotations

import subprocess
import sys
import tracemalloc
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bezsoma.equations.stress import swelling
from bezsoma.errors import InputError
from bezsoma.mechanics import Body, Fixed, LinearElastic, Moved, NeoHooke
from bezsoma.mesh import ControlNet, TetMesh, block
from bezsoma.mesh.field import Field
from bezsoma.solvers import memory, solve
from group_files import laid
from processes import prelude

FACTOR = 2.0
"""How far an estimate may be from what is measured, either way."""

MEASURED = """
import os, re, sys, bezsoma as bz
from pathlib import Path
from bezsoma.solvers import factors
from bezsoma.solvers.memory import estimate
factors.HERE_UP_TO = 10**9  # all in the process that is measured
solver, form = sys.argv[1:3]
supports = [bz.Fixed("bottom"), bz.Moved("top", translation=(0.1, 0, 0))]
law = bz.NeoHooke(E=1.0, nu=0.3) if "nonlinear" in form else bz.LinearElastic(1.0, 0.3)

def solved(mesh, degree):
    pressure = degree - 1 if "mixed" in form else None
    body = bz.Body(mesh, degree, law, supports, pressure_degree=pressure)
    bz.solve(body, solver=solver, rtol=1e-3 if solver == "cg" else 1e-8)
    return estimate(mesh, degree, solver, pressure, "nonlinear" not in form)

def kilobytes(what):
    return int(re.search(what + r":\\s+(\\d+) kB", Path("/proc/self/status").read_text())[1])

solved(bz.block(cells=2), 2)  # what is imported once
for case in sys.argv[3:]:
    sys.stdout.flush()
    if os.fork():
        assert os.wait()[1] == 0
        continue
    degree, cells = map(int, case.split("x"))
    mesh = bz.block(cells=cells)
    Path("/proc/self/clear_refs").write_text("5")  # the peak begins anew
    before = kilobytes("VmRSS")
    told = solved(mesh, degree)
    print(degree, told, 1024 * (kilobytes("VmHWM") - before))
    sys.stdout.flush()
    os._exit(0)
"""


def measured(solver: str, form: str, cells: dict[int, int]) -> list[tuple[int, ...]]:
    """Degree, bytes told and bytes taken beyond the mesh, each in its own process."""
    if not Path("/proc/self/clear_refs").exists():
        pytest.skip("this system does not tell the peak of a part of a run")
    cases = [f"{degree}x{count}" for degree, count in cells.items()]
    command = [sys.executable, "-S", "-c", prelude() + MEASURED, solver, form, *cases]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return [tuple(map(int, line.split())) for line in done.stdout.splitlines()]


CELLS = {
    ("multigrid", "elastic"): {1: 31, 2: 15, 3: 10, 4: 8, 6: 5},
    ("cg", "elastic"): {1: 24, 2: 12, 3: 7, 4: 5, 6: 3},
    ("direct", "elastic"): {1: 16, 2: 7, 3: 4, 4: 3, 6: 2},
    ("saddle", "mixed"): {2: 14, 3: 9, 4: 7, 6: 5},
    ("direct", "mixed"): {2: 6, 3: 4, 4: 3},
    ("multigrid", "nonlinear"): {1: 20, 2: 10, 4: 5},
    ("direct", "nonlinear"): {1: 10, 2: 5, 3: 3},
    ("multigrid", "nonlinear, mixed"): {2: 7, 3: 5},
    ("direct", "nonlinear, mixed"): {2: 5, 3: 3},
}


@pytest.mark.parametrize(("solver", "form"), CELLS)
def test_the_estimate_is_right_within_a_factor(solver: str, form: str) -> None:
    found = measured(solver, form, CELLS[solver, form])
    assert [degree for degree, *_ in found] == list(CELLS[solver, form])
    wrong = {
        degree: f"{taken / told:.2f} of the {told / 2**20:.0f} MiB told"
        for degree, told, taken in found
        if not told / FACTOR < taken < told * FACTOR
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
    needed = memory.estimate(body.mesh, 3, chosen)
    said = str(caught.value)
    assert f"{3 * net.count} unknowns of degree 3 by {chosen!r}" in said
    assert f"about {memory.size(needed)}, and 5 MB are free" in said
    assert "take a lower degree or a coarser mesh" in said
    assert ("solver='multigrid'" in said) == (chosen != "multigrid")
    assert taken < 3 * net.count, "nothing of the size of the problem, not even its numbering"


def test_change_of_volume_takes_less_than_the_gradients_would() -> None:
    """Else it would be the most that a solve at finite strain needs."""
    body = Body(block(cells=20), 2, NeoHooke(1.0, 0.3), [Fixed("bottom")])
    drawn = Field.interpolating(ControlNet(body.mesh, 2), lambda x: 0.1 * x)
    assert abs(swelling(body, drawn) - 0.331) < 1e-12  # once before, so that nothing is new
    tracemalloc.start()
    swelling(body, drawn)
    taken = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert taken < 0.6 * len(body.mesh.tets) * 4 * 9 * 8


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
    needed = memory.estimate(body.mesh, 3, "multigrid")
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


GROUPS = {
    "no limit": ({"memory.max": "max\n", "memory.current": "5000\n"}, None),
    "version 2": ({"memory.max": "9000\n", "memory.current": "5000\n"}, 4000),
    "version 2, half of it pages of files": (
        {
            "memory.max": "9000\n",
            "memory.current": "5000\n",
            "memory.stat": "anon 2500\nfile 2500\ninactive_file 2000\nactive_file 500\n",
        },
        6000,
    ),
    "version 2, over its limit": ({"memory.max": "9000\n", "memory.current": "9500\n"}, 0),
    "version 1": (
        {
            "memory/memory.limit_in_bytes": "9000\n",
            "memory/memory.usage_in_bytes": "5000\n",
            "memory/memory.stat": "inactive_file 1\ntotal_inactive_file 2000\n",
        },
        6000,
    ),
    "a batch job's own, version 2": (
        {
            "memory.max": "99000\n",
            "memory.current": "5000\n",
            "job/memory.max": "9000\n",
            "job/memory.current": "8000\n",
            "job/step/memory.max": "max\n",
            "job/step/memory.current": "10\n",
        },
        1000,
    ),
    "a batch job's own, version 1": (
        {
            "memory/job/memory.limit_in_bytes": "9000\n",
            "memory/job/memory.usage_in_bytes": "8000\n",
        },
        1000,
    ),
    "nothing readable": ({"memory.max": "much\n"}, None),
    "no groups": ({}, None),
}


@pytest.mark.parametrize(("files", "left"), GROUPS.values(), ids=GROUPS)
def test_what_a_control_group_leaves(
    files: dict[str, str], left: int | None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A container or a batch job may have less than the machine; what only caches files is free."""
    own = "1:name=systemd:/\n2:cpu,memory:/x\n3:memory:/job\n0::/job/step\n"
    laid(files, own, tmp_path, monkeypatch)
    there = memory.available()
    assert there == left if left is not None else there is not None and there > 2**26


@pytest.mark.parametrize("solver", ["multigrid", "saddle", "cg", "direct"])
@pytest.mark.parametrize("linear", [True, False])
def test_estimates_grow_with_the_mesh_and_the_degree(solver: str, linear: bool) -> None:
    mixed = 1 if solver == "saddle" else None

    def told(cells: int, degree: int) -> int:
        return memory.estimate(block(cells=cells), degree, solver, mixed, linear)

    by_cells, by_degree = [told(n, 2) for n in (4, 8, 12)], [told(4, n) for n in range(2, 11)]
    assert by_cells == sorted(by_cells) and by_degree == sorted(by_degree)


def test_a_pressure_and_a_law_take_more() -> None:
    mesh = block(cells=4)
    for solver in ("saddle", "direct"):
        alone = memory.estimate(mesh, 3, solver)
        assert memory.estimate(mesh, 3, solver, pressure_degree=2) > 1.1 * alone
        assert memory.estimate(mesh, 3, solver, linear=False) > 1.1 * alone


def test_a_mesh_of_parts_with_holes_is_counted_nearly() -> None:
    """Euler's formula knows nothing of them, and they are few."""
    cube = block(cells=4)
    middle = np.abs(cube.points[cube.tets].mean(axis=1) - 0.5).max(axis=1) < 0.25
    hollow = TetMesh(cube.points, cube.tets[~middle])
    far = hollow.points + 5.0
    two = TetMesh(
        np.concatenate([hollow.points, far]),
        np.concatenate([hollow.tets, hollow.tets + len(far)]),
    )
    for mesh in (hollow, two):
        assert abs(memory.Counts(mesh, 2).controls - ControlNet(mesh, 2).count) <= 3
