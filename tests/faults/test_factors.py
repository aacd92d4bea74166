# SPDX-License-Identifier: BSD-3-Clause
"""Sparse factors in a process of their own: stopped, failing, let go."""

from __future__ import annotations

import gc
import os
import re
import signal
import sys
import threading
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.sparse import csc_array, diags_array

from bezsoma.errors import InputError, NotConverged
from bezsoma.mechanics import Body, Fixed, LinearElastic, Moved, NeoHooke
from bezsoma.mesh import block
from bezsoma.solvers import factors, solve
from bezsoma.solvers.factors import factored

SIZE = 300
SLOW = """
import pickle, sys, time
from pathlib import Path
pickle.load(sys.stdin.buffer)
Path(__file__).with_suffix(".begun").touch()
time.sleep(60)
"""


@pytest.fixture(autouse=True)
def apart(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """Small matrices are factored apart too; the processes that were started."""
    monkeypatch.setattr(factors, "HERE_UP_TO", 0)
    started: list[Any] = []
    start = factors._child

    def seen() -> Any:
        started.append(start())
        return started[-1]

    monkeypatch.setattr(factors, "_child", seen)
    return started


@pytest.fixture
def for_ever(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A factorisation that never ends."""
    script = tmp_path / "slow.py"
    script.write_text(SLOW)
    monkeypatch.setattr(factors, "APART", script)


def matrix(n: int = SIZE) -> csc_array[Any]:
    """A Laplacian on a line."""
    rows = [-np.ones(n - 1), 2.5 * np.ones(n), -np.ones(n - 1)]
    return csc_array(diags_array(rows, offsets=(-1, 0, 1)))


def held(degree: int, law: Any, pressure: int | None = None) -> Body:
    """A block between two planes."""
    supports = [Fixed("bottom"), Moved("top", translation=(0.05, 0, 0))]
    return Body(block(cells=2), degree, law, supports, pressure_degree=pressure)


BODIES = {
    "elastic": held(2, LinearElastic(1.0, 0.3)),
    "mixed": held(2, LinearElastic(1.0, 0.5), 1),
    "nonlinear": held(2, NeoHooke(E=1.0, nu=0.3)),
    "nonlinear, mixed": held(2, NeoHooke(E=1.0, nu=0.3), 1),
}


def ctrl_c_once_there_is(sign: Path) -> None:
    """A hand that waits until the factorisation has begun."""
    for _ in range(6000):
        if sign.exists():
            break
        time.sleep(0.01)
    os.kill(os.getpid(), signal.SIGINT)


@pytest.mark.skipif(sys.platform == "win32", reason="no such signals")
@pytest.mark.usefixtures("for_ever")
@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
def test_ctrl_c_does_not_wait_for_superlu(
    body: Body, apart: list[Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whatever is solved directly: its process is gone, and the next solve is right."""
    script = factors.APART
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    hand = threading.Thread(target=ctrl_c_once_there_is, args=(script.with_suffix(".begun"),))
    hand.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            solve(body, solver="direct")
    finally:
        hand.join()
        signal.signal(signal.SIGINT, before)
    assert apart[-1].returncode == -signal.SIGKILL
    monkeypatch.setattr(factors, "APART", script.with_name("no more"))
    monkeypatch.setattr(factors, "HERE_UP_TO", 3000)
    assert solve(body, solver="direct").residual < 1e-8


@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
def test_apart_or_here_the_numbers_are_the_same(
    body: Body, apart: list[Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    there = solve(body, solver="direct").displacement.controls
    assert apart
    monkeypatch.setattr(factors, "HERE_UP_TO", 3000)
    assert np.array_equal(solve(body, solver="direct").displacement.controls, there)


def test_processes_end_with_what_solves(apart: list[Any]) -> None:
    """And several live side by side until then."""
    first, second = factored(matrix()), factored(csc_array(2 * matrix()))
    b = np.arange(float(SIZE))
    assert [child.poll() for child in apart] == [None, None]
    assert np.allclose(first(b), 2 * second(b), rtol=1e-12)
    del first, second
    gc.collect()
    assert all(child.poll() is not None for child in apart)


def test_what_goes_wrong_there_is_raised_here(apart: list[Any]) -> None:
    zero = csc_array(diags_array([*np.ones(SIZE - 1), 0.0]))
    with pytest.raises(RuntimeError, match="singular"):
        factored(zero)
    assert apart[-1].poll() is not None
    solve_with = factored(matrix())
    with pytest.raises(ValueError, match=rf"\({SIZE + 1},\) was given; .*must be \({SIZE},\)"):
        solve_with(np.ones(SIZE + 1))
    assert np.allclose(matrix() @ solve_with(np.ones(SIZE)), 1)


def test_a_singular_matrix_is_told_as_before() -> None:
    """All of the boundary held, at nu = 1/2 and with a tet whose vertices are all held."""
    sides = ("left", "right", "front", "back", "bottom", "top")
    body = Body(block(cells=1), 2, LinearElastic(1.0, 0.5), [Fixed(*sides)], incompressible=True)
    with pytest.raises((NotConverged, InputError)):
        solve(body, solver="direct")


def test_a_process_that_the_system_ends_is_told(
    apart: list[Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    script = tmp_path / "killed.py"
    script.write_text("import os, signal\nos.kill(os.getpid(), signal.SIGTERM)\n")
    monkeypatch.setattr(factors, "APART", script)
    for name, other in (("elastic", "multigrid"), ("mixed", "saddle")):
        with pytest.raises(InputError, match=f"can hold or count; use solver='{other}'"):
            solve(BODIES[name], solver="direct")


FACTORS_ONLY = """
import pickle, sys
pickle.load(sys.stdin.buffer)
pickle.dump(None, sys.stdout.buffer)
sys.stdout.flush()
pickle.load(sys.stdin.buffer)
"""


@pytest.mark.parametrize(
    ("name", "solver", "other"),
    [
        ("elastic", "direct", "multigrid"),
        ("mixed", "direct", "saddle"),
        ("nonlinear", "direct", "multigrid"),
        ("nonlinear, mixed", "direct", "multigrid"),
        ("nonlinear, mixed", "multigrid", None),  # which factors the pressure's mass
    ],
)
def test_a_process_that_ends_once_it_has_factored_is_told(
    name: str,
    solver: str,
    other: str | None,
    apart: list[Any],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    script = tmp_path / "half.py"
    script.write_text(FACTORS_ONLY)
    monkeypatch.setattr(factors, "APART", script)
    said = f"can hold or count; use solver='{other}'" if other else "the mass of 27 pressures is"
    with pytest.raises(InputError, match=said):
        solve(BODIES[name], solver=solver)
    assert apart[-1].wait(timeout=60) == 0


def test_more_entries_than_superlu_counts_are_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(factors, "LARGEST", 1000)
    for body in BODIES.values():
        with pytest.raises(InputError, match="can hold or count"):
            solve(body, solver="direct")


def test_a_matrix_that_is_singular_to_rounding_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    def singular(*given: Any, **options: Any) -> None:
        raise RuntimeError("Factor is exactly singular")

    monkeypatch.setattr(sys.modules["bezsoma.solvers.direct"], "factored", singular)
    with pytest.raises(NotConverged, match="unknowns is singular to rounding") as caught:
        solve(BODIES["elastic"], solver="direct")
    assert caught.value.history == (1.0,)


@pytest.mark.usefixtures("for_ever")
def test_a_factorisation_is_shown_and_an_error_of_who_is_told_ends_it(apart: list[Any]) -> None:
    """SuperLU does not say how far it is; how long it has been at work is shown."""
    notes: list[str] = []

    def progress(stage: str, fraction: float | None, note: str) -> None:
        notes.append(f"{stage}: {note}")
        if len(notes) > 2 and notes[-1] == notes[-2]:
            raise KeyError("enough")

    with pytest.raises(KeyError, match="enough"):
        solve(BODIES["elastic"], solver="direct", progress=progress)
    assert re.fullmatch(r"solving: factoring, \d+ s so far", notes[-1])
    assert apart[-1].returncode is not None
