# SPDX-License-Identifier: BSD-3-Clause
"""Threads do not show in the answer, Ctrl-C is heard, and other Python threads run on."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import bezsoma as bz
from bezsoma import _core, bernstein
from bezsoma.arrays import Floats
from bezsoma.equations.assembled import assembled
from bezsoma.equations.boundary import prescribed
from bezsoma.equations.element import lame_constants
from bezsoma.equations.matrix_free import MatrixFree
from bezsoma.equations.mixed_free import MixedFree
from bezsoma.equations.mixed_pointwise_free import PointwiseMixed
from bezsoma.equations.pointwise_free import PointwiseFree
from bezsoma.equations.threads import cores, quota
from bezsoma.errors import InputError
from bezsoma.mechanics import Body, Fixed, LinearElastic, Moved, Precedence, Traction
from bezsoma.mesh import ControlNet, TetMesh, block
from bezsoma.refinement.products import displacement_product
from bezsoma.solvers import Solution, solve
from bezsoma.solvers.multigrid import preconditioned, preconditioner
from cases.written import case_file
from group_files import laid
from processes import prelude

THREADS = (1, 2, 5)
SETS = _core.instruction_sets()
PROMPT = 1.0
"""Seconds of a processor within which Ctrl-C stops a computation."""
LAME = np.array([[0.6, 0.4], [60.0, 4.0]])


def two_materials(cells: tuple[int, int, int]) -> TetMesh:
    """An irregular block, soft and hard."""
    plain = block(cells=cells, irregular=0.3, seed=4)
    hard = (plain.points[plain.tets].mean(axis=1)[:, 2] > 0.6).astype(int)
    return TetMesh(plain.points, plain.tets, hard, ("soft", "hard"), surfaces=plain.surfaces)


def moved(degree: int, cells: tuple[int, int, int]) -> Body:
    """A body of two materials, its left side held, the right one moved and turned."""
    supports = [
        Fixed("left"),
        Moved("right", translation=(0.02, 0.1, 0), axis=(1, 0, 0), angle=0.1, about=(0, 0, 0)),
        Fixed("front", components="y"),
    ]
    joins = [Precedence(side, over="front") for side in ("left", "right")]
    laws = {"soft": LinearElastic(0.015, 0.45), "hard": LinearElastic(1.0, 0.3)}
    return Body(
        two_materials(cells), degree, laws, supports, [Traction("top", value=(0, 0, 1e-3))], joins
    )


@pytest.mark.parametrize("instructions", SETS)
@pytest.mark.parametrize(("degree", "cells"), [(1, 16), (2, 10), (3, 7), (6, 4)])
def test_an_application_has_the_same_bits(degree: int, cells: int, instructions: str) -> None:
    net = ControlNet(two_materials((cells,) * 3), degree)
    u = np.random.default_rng(2).standard_normal((net.count, 3, 8))
    operators = [MatrixFree(net, LAME, threads, instructions) for threads in THREADS]
    assert [operator.kernel.threads for operator in operators] == list(THREADS)
    single = operators[0].single(u[..., 0].astype(np.float32))
    first = {sides: operators[0] @ u[..., :sides] for sides in (1, 3, 8)}
    for operator in operators:
        for _ in range(3):
            for sides, forces in first.items():
                assert (operator @ u[..., :sides] == forces).all()
            assert (operator.single(u[..., 0].astype(np.float32)) == single).all()


def answer(solution: Solution) -> tuple[Floats, float, tuple[float, ...]]:
    """All that a solve leaves."""
    return solution.displacement.controls, solution.energy, solution.history


@pytest.mark.parametrize(("degree", "cells"), [(1, 18), (2, 12), (3, 8), (5, 4)])
def test_a_whole_solve_has_the_same_bits(degree: int, cells: int) -> None:
    body = moved(degree, (cells, cells - 1, cells))
    first, *others = (solve(body, solver="multigrid", threads=n) for n in (*THREADS, 2, 1))
    assert first.iterations > 10
    for other in others:
        for a, b in zip(answer(first), answer(other), strict=True):
            assert np.array_equal(a, b)


def test_instruction_sets_differ_by_rounding_only() -> None:
    net = ControlNet(two_materials((5, 4, 4)), 4)
    u = np.random.default_rng(2).standard_normal((net.count, 3))
    forces = [MatrixFree(net, LAME, 2, name) @ u for name in SETS]
    for f in forces:
        assert np.abs(f - forces[0]).max() < 1e-14 * np.abs(f).max()


def test_many_more_threads_than_pieces() -> None:
    net = ControlNet(block(), 2)
    u = net.points.copy()
    expected = MatrixFree(net, LAME[:1], 1) @ u
    assert (MatrixFree(net, LAME[:1], 40) @ u == expected).all()


def test_operators_come_and_go() -> None:
    """Teams of threads start and end with their operators, used or not."""
    net = ControlNet(block(), 1)
    before = threads_of_this_process()
    for _ in range(50):
        operator = MatrixFree(net, LAME[:1], 5)
        assert operator.kernel.threads == 5
        operator @ net.points
        assert threads_of_this_process() == before + 4
        del operator
        for _ in range(6000):  # a thread that was waited for may be listed a moment longer
            if threads_of_this_process() == before:
                break
            time.sleep(0.01)
    assert threads_of_this_process() == before


def threads_of_this_process() -> int:
    """As the system counts them; 0 where it does not tell, which then says nothing."""
    tasks = Path("/proc/self/task")
    if not tasks.is_dir():
        pytest.skip("this system does not count the threads of a process")
    return len(list(tasks.iterdir()))


# ------------------------------------------------------------------ beside other threads


def test_other_python_threads_run_on_during_a_solve() -> None:
    """A solve whose report is C runs no byte code: what others do within it, the core let them."""
    body, ticks, done = moved(4, (7, 7, 7)), list[int](), threading.Event()
    net = ControlNet(body.mesh, 4)
    operator = MatrixFree(net, lame_constants(body), 2)
    held = prescribed(body, net).mask
    blocks, b = preconditioner(operator, held), np.where(held, 0, np.sin(9 * net.points))
    size = float(np.linalg.norm(b))

    def tick() -> None:
        while not done.wait(0.001):
            ticks.append(1)

    def ticks_within_a_solve() -> int:
        x, before = np.zeros_like(b), len(ticks)
        blocks.solve(b, x, size, 1e-12, 200, max)
        return len(ticks) - before

    clock = threading.Thread(target=tick)
    clock.start()
    try:
        assert any(ticks_within_a_solve() > 20 for _ in range(100))
    finally:
        done.set()
        clock.join()


def test_two_solves_at_once() -> None:
    bodies = [moved(2, (8, 8, 8)), moved(4, (4, 4, 4))]
    expected = [answer(solve(body, solver="multigrid")) for body in bodies]
    found: dict[int, Any] = {}

    def run(which: int) -> None:
        found[which] = answer(solve(bodies[which % 2], solver="multigrid", threads=2))

    runners = [threading.Thread(target=run, args=(which,)) for which in range(4)]
    for runner in runners:
        runner.start()
    for runner in runners:
        runner.join()
    for which in range(4):
        for a, b in zip(expected[which % 2], found[which], strict=True):
            assert np.array_equal(a, b)


SHARED = """
import threading, numpy as np
from bezsoma.equations.boundary import prescribed
from bezsoma.equations.element import lame_constants
from bezsoma.equations.matrix_free import MatrixFree
from bezsoma.mesh import ControlNet, block
from bezsoma.solvers.multigrid import preconditioner
net = ControlNet(block(cells=8), 3)
held = np.zeros((net.count, 3), bool)
held[net.of_place("bottom")] = True
operator = MatrixFree(net, np.array([[0.6, 0.4]]), 2)
expected, wrong = operator @ net.points, []
def apply():
    for _ in range(100):
        if not (operator @ net.points == expected).all():
            wrong.append(1)
def build():
    for _ in range(10):
        preconditioner(operator, held)
threading.excepthook = wrong.append
threads = [threading.Thread(target=each) for each in (apply, apply, apply, build)]
for thread in threads: thread.start()
for thread in threads: thread.join()
print("wrong", len(wrong))
"""


def test_one_operator_in_two_threads() -> None:
    """They take turns, also while a preconditioner is made beside it with the same team.

    Without a lock they would take each other's jobs, and hang or be wrong.
    """
    with script(SHARED) as child:
        try:
            out, err = child.communicate(timeout=200)
        except subprocess.TimeoutExpired:
            child.kill()
            pytest.fail("threads that share one operator wait for each other for ever")
    assert (out, child.returncode) == ("wrong 0\n", 0), err


def script(text: str, *arguments: str) -> subprocess.Popen[str]:
    """A Python of its own that sees the BezSoma that this one sees."""
    return subprocess.Popen(
        [sys.executable, "-S", "-c", prelude() + text, *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


# ------------------------------------------------------------------ Ctrl-C

INTERRUPTED = """
import signal, time, bezsoma as bz
cells, degree, stage, delay = int(sys.argv[1]), int(sys.argv[2]), sys.argv[3], float(sys.argv[4])
signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background job ignores it
signal.signal(signal.SIGPROF, lambda number, frame: signal.raise_signal(signal.SIGINT))
mesh = bz.block(cells=cells)
supports = [bz.Fixed("bottom"), bz.Moved("top", translation=(0.1, 0, 0))]
body = bz.Body(mesh, degree, bz.LinearElastic(1.0, 0.49), supports)
began = []
def progress(now, fraction, note):
    if now == stage and not began:
        began.append(time.process_time())
        signal.setitimer(signal.ITIMER_PROF, delay)
try:
    bz.solve(body, solver="multigrid", rtol=1e-14, progress=progress)
    print("never stopped")
except KeyboardInterrupt:
    print("stopped after", time.process_time() - began[0])
small = bz.Body(bz.block(cells=3), 3, bz.LinearElastic(1.0, 0.3), supports)
a, b = bz.solve(small, solver="multigrid"), bz.solve(small, solver="direct")
print("right" if abs(a.energy / b.energy - 1) < 1e-10 else "wrong")
"""


@pytest.mark.skipif(sys.platform == "win32", reason="no such signals")
@pytest.mark.parametrize("delay", [0.001, 0.4])
@pytest.mark.parametrize(("stage", "degree", "cells"), [("solving", 4, 14), ("numbering", 2, 24)])
def test_ctrl_c_stops_it_and_python_goes_on(
    stage: str, degree: int, cells: int, delay: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """At the start of a stage or some way into it: in Python, while setting up, in a solve.

    All is told in processor time of one thread, so that a machine with other work does not show.
    """
    monkeypatch.setenv("BEZSOMA_THREADS", "1")
    with script(INTERRUPTED, str(cells), str(degree), stage, str(delay)) as child:
        out, errors = child.communicate(timeout=200)
    assert out.startswith("stopped after ") and out.endswith("\nright\n"), (out, errors)
    assert float(out.split()[2]) < delay + PROMPT
    assert child.returncode == 0


def test_an_error_in_the_progress_comes_through() -> None:
    def fails(stage: str, fraction: float | None, note: str) -> None:
        if "iteration 7" in note:
            raise RuntimeError("the display broke")

    body = moved(3, (4, 4, 4))
    with pytest.raises(RuntimeError, match="the display broke"):
        solve(body, solver="multigrid", progress=fails)
    assert solve(body, solver="multigrid").residual <= 1e-8


# ------------------------------------------------------------------ how many


ODD = ("1_0", "+2", "2 3", "\u0662", "\uff12", "\xa02")
"""What int() takes, or nearly."""


@pytest.mark.parametrize("given", ["two", " ", "1.5", "-1", "99999", "nan", "0x4", *ODD])
def test_a_wrong_number_in_the_environment(given: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("BEZSOMA_THREADS", given)
    with pytest.raises(
        InputError, match=r"BEZSOMA_THREADS = .* is no number of threads: give 1 to"
    ):
        solve(moved(1, (2, 2, 2)))


@pytest.mark.parametrize(
    "given",
    [-1, 1.5, True, np.True_, "all", "2", b"2", 99999, float("nan"), [2], np.array([2]), 2**70],
)
def test_a_wrong_number_in_python(given: Any) -> None:
    with pytest.raises(InputError, match=r"threads = .* is no number of threads: give 1 to"):
        solve(moved(1, (2, 2, 2)), threads=given)


@pytest.mark.parametrize("given", [10**6, 1025, -1, True, None, "2"])
def test_no_operator_starts_a_million_threads(given: Any) -> None:
    mesh = block()
    net, pressures, moduli = ControlNet(mesh, 2), ControlNet(mesh, 1), LAME[:1]
    few = MatrixFree(net, moduli, 1)
    laws, rule = (_core.Law("linear", [2.0, 0.6]),), bernstein.simplex(2, 3)
    held = np.zeros((net.count, 3), bool)
    tets = np.ones(len(mesh.tets))
    takers: list[Callable[[], Any]] = [
        lambda: MatrixFree(net, moduli, given).kernel,
        lambda: MatrixFree(net, moduli, given).single(net.points),
        lambda: preconditioned(replace(few, threads=given), held),
        lambda: MixedFree(net, pressures, moduli, given).kernel,
        lambda: PointwiseFree(net, laws, *rule, given).kernel,
        lambda: PointwiseMixed(net, pressures, laws, *rule, given).kernel,
        lambda: assembled(net, tets, tets, given),
        lambda: displacement_product(net, moduli, given),
    ]
    for taker in takers:
        with pytest.raises(InputError, match=f"threads = {given!r} is no number .* 1 to 1024, or"):
            taker()
    assert MatrixFree(net, moduli, np.int64(2)).kernel.threads == 2  # type: ignore[arg-type]


def test_the_environment_is_heard_and_the_argument_before_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    body = moved(2, (3, 3, 3))
    monkeypatch.setenv("BEZSOMA_THREADS", " 3 ")
    assert "3 threads" in solve(body, solver="multigrid").method
    assert "2 threads" in solve(body, solver="multigrid", threads=2).method
    assert "2 threads" in solve(body, solver="multigrid", threads=np.int64(2)).method
    assert f"{cores()} thread" in solve(body, solver="multigrid", threads=0).method
    monkeypatch.setenv("BEZSOMA_THREADS", "\t0002\n")
    assert "2 threads" in solve(body, solver="multigrid").method
    monkeypatch.setenv("BEZSOMA_THREADS", "")  # as a shell leaves what it empties
    assert f"{cores()} thread" in solve(body, solver="multigrid").method


QUOTAS = {
    "none": ({"cpu.max": "max 100000"}, 1024),
    "version 2": ({"cpu.max": "250000 100000"}, 3),
    "version 2, above": ({"cpu.max": "100000 100000", "job/step/cpu.max": "max 100000"}, 1),
    "version 2, own": ({"job/step/cpu.max": "50000 100000"}, 1),
    "version 1": ({"cpu/job/cpu.cfs_quota_us": "400000", "cpu/job/cpu.cfs_period_us": "200000"}, 2),
    "version 1, none": ({"cpu/cpu.cfs_quota_us": "-1", "cpu/cpu.cfs_period_us": "100000"}, 1024),
    "version 1, both in a name": (
        {
            "cpu,cpuacct/job/cpu.cfs_quota_us": "100000",
            "cpu,cpuacct/job/cpu.cfs_period_us": "100000",
        },
        1,
    ),
    "nothing readable": ({"cpu.max": "much"}, 1024),
    "no number": ({"cpu.max": "inf 100000"}, 1024),
}


@pytest.mark.parametrize(("files", "allowed"), QUOTAS.values(), ids=QUOTAS)
def test_all_cores_are_those_that_there_is_time_for(
    files: dict[str, str], allowed: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A container or a batch job may have fewer than the machine: more threads wait for turns."""
    lines = {name: text + "\n" for name, text in files.items()}
    laid(lines, "1:name=systemd:/\n2:cpu,cpuacct:/job\n0::/job/step\n", tmp_path, monkeypatch)
    quota.cache_clear()
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: set(range(7)), raising=False)
    try:
        assert (quota(), cores()) == (allowed, min(allowed, 7))
    finally:
        quota.cache_clear()


@pytest.mark.skipif(sys.platform != "linux", reason="cores are chosen as on Linux")
def test_all_cores_are_those_that_the_process_may_use() -> None:
    text = (
        "import os; os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})\n"
        "import numpy as np, bezsoma as bz\n"
        "from bezsoma.equations.matrix_free import MatrixFree\n"
        "net = bz.ControlNet(bz.block(cells=4), 3)\n"
        "print(MatrixFree(net, np.ones((1, 2))).kernel.threads)"
    )
    command = [sys.executable, "-S", "-c", prelude() + text]
    done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=100)
    assert done.stdout == "1\n"


MOST_TASKS = """
import os, threading, time, bezsoma as bz

def tasks():
    return len(os.listdir("/proc/self/task"))

most, done = 0, False

def look():
    global most
    while not done:
        most = max(most, tasks())
        time.sleep(1e-4)

sides = [bz.Fixed("bottom"), bz.Moved("top", translation=(0.1, 0, 0))]
law = bz.LinearElastic(1.0, 0.3)
bodies = {
    method: bz.Body(bz.block(cells=cells), 2, law, sides, incompressible=method == "saddle")
    for method, cells in (("cg", 9), ("direct", 5), ("multigrid", 9), ("saddle", 5))
}
for method, body in bodies.items():
    bz.solve(body, solver=method, threads=1)  # what is imported may bring threads of a BLAS
    time.sleep(0.1)  # what has ended may be counted for a while
    before, most, done = tasks(), 0, False
    watcher = threading.Thread(target=look)
    watcher.start()
    for _ in range(2):
        bz.solve(body, solver=method, threads=1)
    done = True
    watcher.join()
    print(method, most - before - 1)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="threads are counted as on Linux")
def test_no_solver_takes_more_threads_than_it_was_given() -> None:
    """None where one was; a direct one has others that wait for what another process factors."""
    command = [sys.executable, "-S", "-c", prelude() + MOST_TASKS]
    done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=300)
    most = {name: int(count) for name, count in map(str.split, done.stdout.splitlines())}
    assert most.pop("direct") <= 2
    assert len(most) == 3 and max(most.values()) <= 0


def test_the_case_file_says_how_many(tmp_path: Path) -> None:
    table = '[solver]\nmethod = "multigrid"\nthreads = 3\n\n[output]'
    case = bz.read_case(case_file(tmp_path, ("[output]", table)))
    assert "3 threads" in bz.run_case(case, tmp_path / "out").summary["method"]
    for wrong, said in (("-1", "-1"), ("5000", "1024"), ('"two"', "two"), ("2.5", "2.5")):
        text = table.replace("3", wrong)
        with pytest.raises(InputError, match=r"solver\.threads") as caught:
            bz.read_case(case_file(tmp_path, ("[output]", text), name="wrong.toml"))
        assert said in str(caught.value)


SOLVED_BESIDE_BLAS = """
import os
from pathlib import Path
import bezsoma as bz

def run():
    others = {task for task in Path("/proc/self/task").iterdir() if task.name != str(os.getpid())}
    return {task.name: (task / "schedstat").read_text().split()[0] for task in others}

asleep = True
for degree, cells in ((2, 20), (4, 17)):
    mesh = bz.block(cells=cells)
    top = [bz.Traction("top", value=(1e-3, 0, 0))]
    body = bz.Body(mesh, degree, bz.LinearElastic(E=1, nu=0.3), [bz.Fixed("bottom")], top)
    before = run()
    bz.solve(body, solver="multigrid", threads=1)
    asleep &= before == run()
print(asleep)
"""


@pytest.mark.skipif(not Path("/proc/self/schedstat").exists(), reason="Linux tells what threads do")
def test_a_solve_lets_the_threads_of_blas_sleep() -> None:
    """Woken they wait for more to do without sleeping, on cores that the solver's threads need."""
    own = os.environ | {f"{name}_NUM_THREADS": "2" for name in ("OMP", "OPENBLAS", "MKL")}
    command = [sys.executable, "-S", "-c", prelude() + SOLVED_BESIDE_BLAS]
    done = subprocess.run(command, capture_output=True, text=True, check=True, env=own)
    assert done.stdout == "True\n"
