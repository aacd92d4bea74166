# SPDX-License-Identifier: BSD-3-Clause
"""The core in bad company: memory that runs out, forks, callbacks and signals that come back."""

from __future__ import annotations

import signal
import subprocess
import sys
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import bezsoma as bz
from bezsoma import _core, bernstein
from bezsoma.arrays import Floats, Int32s
from bezsoma.equations.assembled import assembled
from bezsoma.equations.boundary import prescribed
from bezsoma.equations.displacement import Equations
from bezsoma.equations.element import lame_constants, moduli
from bezsoma.equations.matrix_free import MatrixFree, walk
from bezsoma.equations.mixed_free import MixedFree
from bezsoma.equations.pointwise_free import PointwiseFree
from bezsoma.mesh import ControlNet, block
from bezsoma.solvers.krylov import incomplete_cholesky
from bezsoma.solvers.multigrid import (
    degree_one,
    iterated,
    multigrid,
    preconditioned,
    preconditioner,
)
from bezsoma.solvers.saddle import saddle
from processes import prelude

BODY = """
import os, resource, signal, time
import numpy as np
import bezsoma as bz
from bezsoma.equations.matrix_free import MatrixFree
from bezsoma.mesh import ControlNet, block
def body(degree, cells):
    supports = [bz.Fixed("bottom"), bz.Moved("top", translation=(0.1, 0, 0))]
    return bz.Body(block(cells=cells), degree, bz.LinearElastic(1.0, 0.3), supports)
"""


def said(text: str) -> str:
    """What a Python of its own prints, which has to end well."""
    command = [sys.executable, "-S", "-c", prelude() + BODY + text]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=100)
    assert done.returncode == 0, (done.returncode, done.stderr)
    return done.stdout


SCARCE = """
def size():
    return 1024 * int(open("/proc/self/status").read().split("VmSize:")[1].split()[0])
net = ControlNet(block(cells=9), 3)
operator = MatrixFree(net, np.array([[0.6, 0.4]]), 3)
expected = operator @ net.points
x = np.repeat(net.points[:, :, None], 64, axis=2)
y = np.zeros_like(x)
refused = 0
for more in range(0, 200, 3):
    resource.setrlimit(resource.RLIMIT_AS, (size() + more * 2**20, -1))
    try:
        operator.kernel.apply(x, y)
    except MemoryError:
        refused += 1
    else:
        break
    finally:
        resource.setrlimit(resource.RLIMIT_AS, (-1, -1))
    assert (operator @ net.points == expected).all()
print(refused > 4, abs(y - expected[:, :, None]).max() < 1e-14)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="limits of memory are set as on Linux")
def test_memory_that_runs_out_within_a_job_is_an_error_and_not_the_end() -> None:
    """In whichever thread scratch space is wanting: the team works on as before."""
    assert said(SCARCE) == "True True\n"


FORKED = """
net = ControlNet(block(cells=6), 2)
operator = MatrixFree(net, np.array([[0.6, 0.4]]), 3)
expected = operator @ net.points
for generation in range(3):  # a child of a child too
    if os.fork():
        break
signal.alarm(60)
right = (operator @ net.points == expected).all()
right &= bz.solve(body(2, 5), solver="multigrid", threads=3).residual <= 1e-8
tasks = len(os.listdir("/proc/self/task"))
del operator
if generation < 2 or os.getppid() != 1:
    try:
        right &= os.wait()[1] == 0
    except ChildProcessError:
        pass
os._exit(0 if right and tasks == 3 else 1) if generation else print(right, tasks)
"""


def test_what_is_still_held_when_python_ends_is_not_spoken_of() -> None:
    """A law that something holds to the end: here a count of references that nobody gives back."""
    held = (
        "law = bz.NeoHooke(E=1.0, nu=0.3).core\n"
        "import ctypes; ctypes.pythonapi.Py_IncRef(ctypes.py_object(law))\n"
        "print(law.name)"
    )
    command = [sys.executable, "-S", "-c", prelude() + "import bezsoma as bz\n" + held]
    done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=100)
    assert done.stdout == "neo_hooke\n" and not done.stderr


LEFT_AT_WORK = """
import atexit, os, threading, time
stop = threading.Event()
ATEXIT
import numpy as np, bezsoma as bz
from bezsoma.equations.matrix_free import MatrixFree

net = bz.ControlNet(bz.block(cells=6), 3)
operator = MatrixFree(net, np.array([[0.6, 0.4]]), 1)
sides = [bz.Fixed("bottom"), bz.Moved("top", translation=(0.1, 0, 0))]
body = bz.Body(net.mesh, 3, bz.LinearElastic(1.0, 0.3), sides)
begun = threading.Barrier(THREADS + 1)

def slowly(stage, done, note):
    if stage == "solving":
        time.sleep(1.3)

def work():
    bz.solve(body, threads=1)
    begun.wait()
    while not stop.is_set():
        WORK

workers = [threading.Thread(target=work, daemon=True) for _ in range(THREADS)]
for worker in workers:
    worker.start()
begun.wait()
time.sleep(0.1)
START = time.perf_counter()
END
"""
AT_WORK = {
    "solves": ("bz.solve(body, threads=2)", "", "print('done')"),
    "solves with a report": ("bz.solve(body, threads=1, progress=print_no)", "", "print('done')"),
    "solves with a slow report": ("bz.solve(body, progress=slowly)", "", "print('done')"),
    "products": ("operator @ net.points", "", "print('done')"),
    "topology": ("bz.block(cells=9).faces_of_tet", "", "print('done')"),
    "waited for at the end": (
        "operator @ net.points",
        "atexit.register(lambda: (stop.set(), [w.join() for w in workers], print('done')))",
        "",
    ),
    "its operator used at the end": (
        "bz.solve(body, threads=1); operator @ net.points",
        "atexit.register(lambda: print('done' if (operator @ net.points).any() else ''))",
        "",
    ),
    "solved at the end": (
        "bz.solve(body, threads=1)",
        "atexit.register(lambda: print('done' if bz.solve(body).residual < 1e-8 else ''))",
        "",
    ),
    "forks": (
        "operator @ net.points",
        "",
        "import sys\nif not os.fork(): sys.exit(0)\n"
        "print('done' if os.wait()[1] == 0 and time.perf_counter() - START < 20 else '')",
    ),
}


@pytest.mark.skipif(sys.platform != "linux", reason="forks, and how threads end, are of Linux")
@pytest.mark.parametrize("threads", [1, 4])
@pytest.mark.parametrize("name", AT_WORK)
def test_python_ends_in_peace_while_threads_are_at_work(name: str, threads: int) -> None:
    """Daemons in the midst of a solve, as servers and notebooks have them."""
    work, before, end = AT_WORK[name]
    text = LEFT_AT_WORK.replace("THREADS", str(threads)).replace("ATEXIT", before)
    text = text.replace("WORK", work.replace("print_no", "lambda *told: None")).replace("END", end)
    first, second = text.split("import numpy", 1)
    whole = "\n".join([first, prelude(), "import numpy" + second])
    command = [sys.executable, "-W", "ignore", "-S", "-c", whole]
    for _ in range(2):
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=100)
        assert (done.returncode, done.stdout, done.stderr) == (0, "done\n", "")


@pytest.mark.skipif(sys.platform != "linux", reason="threads are counted as on Linux")
def test_an_operator_works_on_in_a_fork() -> None:
    """The child has the operator and none of its threads; it takes new ones."""
    assert said(FORKED) == "True 3\n"


def held(degree: int, cells: int) -> bz.Body:
    """A block between two planes."""
    supports = [bz.Fixed("bottom"), bz.Moved("top", translation=(0.1, 0, 0))]
    return bz.Body(block(cells=cells), degree, bz.LinearElastic(1.0, 0.3), supports)


def unsolved(degree: int, cells: int) -> tuple[Equations, Floats]:
    """The equations of that block without a matrix, and the forces out of balance."""
    body = held(degree, cells)
    net = ControlNet(body.mesh, degree)
    known = prescribed(body, net)
    operator = MatrixFree(net, lame_constants(body), 2)
    equations = Equations(
        net, operator, np.zeros((net.count, 3)), known.mask, known.values, known.of_support
    )
    return equations, np.where(known.mask, 0.0, equations.residual(known.values))


def solved(equations: Equations, b: Floats, report: Callable[[int, float], None]) -> Floats:
    """The free displacement."""
    assert isinstance(equations.stiffness, MatrixFree)
    return multigrid(equations, equations.stiffness, b, 1e-8, report)[0]


def test_a_report_may_use_the_operator_it_is_told_of() -> None:
    """Who is told of an iteration holds the operator's lock already."""
    equations, b = unsolved(3, 5)
    expected, seen = equations.stiffness @ b, list[bool]()

    def told(iteration: int, residual: float) -> None:
        seen.append(bool((equations.stiffness @ b == expected).all()))

    quiet = solved(equations, b, lambda iteration, residual: None)
    assert np.array_equal(quiet, solved(equations, b, told))
    assert len(seen) > 10 and all(seen)


def test_a_signal_within_a_job_cannot_use_the_same_operator() -> None:
    """It would take the threads out of the job that they are in: it is told so.

    Who is told of iterations is C, so within a solve no byte code runs at which the signal could be
    heard; only the team, in the midst of a job, is left to hear it. However quick the machine,
    sooner or later a poll of the team comes between a signal and the end of its solve.
    """
    equations, b = unsolved(4, 6)
    operator, small = equations.stiffness, np.ones_like(b)
    assert isinstance(operator, MatrixFree)
    expected, met = operator @ small, list[str]()
    blocks, size = preconditioner(operator, equations.held), float(np.linalg.norm(b))

    def handler(number: int, frame: Any) -> None:
        try:
            assert (operator @ small == expected).all()
        except RuntimeError as error:
            met.append(str(error))

    before = signal.signal(signal.SIGALRM, handler)
    try:
        for attempt in range(10_000):
            signal.setitimer(signal.ITIMER_REAL, 0.001 * (1 + attempt % 20))
            blocks.solve(b, np.zeros_like(b), size, 1e-12, 50, max)
            if met:
                break
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
    assert met[0].startswith("a job on an operator's threads is under way")
    assert (operator @ small == expected).all()


STOPPED = """
from collections import deque
from itertools import starmap
from operator import call
from bezsoma import _core
def stop(number, frame):
    raise KeyboardInterrupt
signal.signal(signal.SIGALRM, stop)
tets = np.arange(4 * 10**6).reshape(-1, 4) * 7919 % 200_003
tets.sort(axis=1)
kept = deque()  # all is C: no byte code at which a signal could be heard runs in between
timer = (signal.setitimer, signal.ITIMER_REAL, 0.01)
try:
    kept.extend(starmap(call, [timer, *((_core.simplices, tets, 200_003, 3),) * 8]))
except KeyboardInterrupt:
    print("stopped in", "the first" if len(kept) == 1 else f"number {len(kept)}")
mesh = block(cells=5)
print(len(_core.simplices(mesh.tets, len(mesh.points), 3)[0]) == len(mesh.all_faces))
"""


@pytest.mark.skipif(sys.platform == "win32", reason="no such signals")
def test_the_topology_of_a_large_mesh_can_be_stopped_within() -> None:
    assert said(STOPPED) == "stopped in the first\nTrue\n"


def test_an_error_of_a_report_leaves_the_operator_free() -> None:
    def fails(stage: str, fraction: float | None, note: str) -> None:
        if "iteration 3" in note:
            raise KeyError("broken")

    body: Any = held(2, 4)
    with pytest.raises(KeyError):
        bz.solve(body, solver="multigrid", progress=fails)
    assert bz.solve(body, solver="multigrid").residual <= 1e-8


def test_a_report_may_use_the_mixed_operator_it_is_told_of() -> None:
    """As with `MatrixFree`; a lock taken twice would wait for ever."""
    net, pressures = (ControlNet(block(cells=3), degree) for degree in (2, 1))
    form = MixedFree(net, pressures, np.array([[0.4, 0.2]]), 2)
    held = np.zeros((net.count, 3), dtype=bool)
    held[net.of_place("bottom")] = True
    f, g = np.where(held, 0.0, np.sin(7 * net.points)), np.zeros(pressures.count)
    expected, seen = form.apply(f, g)[0], list[bool]()

    def told(iteration: int, residual: float) -> None:
        seen.append(bool((form.apply(f, g)[0] == expected).all()))

    levels = np.zeros((0, pressures.count))
    quiet = saddle(form, held, f, g, levels, 1e-8, lambda iteration, residual: None)
    assert np.array_equal(quiet[0], saddle(form, held, f, g, levels, 1e-8, told)[0])
    assert len(seen) > 5 and all(seen)


@pytest.mark.parametrize("change", [lambda first: first - 5, lambda first: first[::-1]])
def test_controls_that_no_walk_numbered_so_are_refused(change: Callable[[Int32s], Int32s]) -> None:
    """Chunks own what they meet first: other numbers would be written where nobody looks."""
    net = ControlNet(block(cells=2), 3)
    numbers = np.ascontiguousarray(change(net.walked()))
    with pytest.raises(ValueError, match="another order than that in which the walk"):
        _core.MatrixFree(walk(net, np.array([[0.6, 0.4]]), numbers))


@pytest.mark.parametrize("kind", ["below", "beyond", "none", "too few"])
def test_vertices_that_are_none_are_refused(kind: str) -> None:
    """The multigrid's rows are written where the corners of tets say."""
    net = ControlNet(block(cells=2), 2)
    operator = MatrixFree(net, np.array([[0.6, 0.4]]))
    held = np.zeros((net.count, 3), dtype=bool)
    corners, places, vertices = degree_one(net, held)
    assert corners is not None
    wrong = {
        "below": corners - 1,
        "beyond": corners + 1,
        "none": None,
        "too few": np.ascontiguousarray(corners[1:]),
    }
    with pytest.raises(ValueError, match=f"do not fit a walk over {len(corners)} tets"):
        _core.Multigrid(operator.kernel, operator.walk(), wrong[kind], places, held, vertices)
    with pytest.raises(
        ValueError, match=f"held of {net.count - 1} controls .* a walk over {net.count} controls"
    ):
        _core.Multigrid(operator.kernel, operator.walk(), corners, places, held[1:], vertices)
    _core.Multigrid(operator.kernel, operator.walk(), corners, places, held, vertices)


def test_a_walk_is_used_up_by_the_preconditioner_it_makes() -> None:
    """Its numbering is let go, which is much of the memory; a second use says so."""
    net = ControlNet(block(cells=2), 1)
    operator = MatrixFree(net, np.array([[0.6, 0.4]]))
    held = np.zeros((net.count, 3), dtype=bool)
    corners, places, vertices = degree_one(net, held)
    used = operator.walk()
    _core.Multigrid(operator.kernel, used, corners, places, held, vertices)
    with pytest.raises(ValueError, match="given its numbering to the preconditioner"):
        _core.Multigrid(operator.kernel, used, corners, places, held, vertices)


def silent(step: int, residual: float) -> None:
    """Nobody watches."""


def takers() -> dict[str, Callable[[Floats], Any]]:
    """What hands forces or displacements (c, 3) of `held(2, 3)` to the core: `TAKERS`."""
    body = held(2, 3)
    net, mesh = ControlNet(body.mesh, 2), body.mesh
    fixed = prescribed(body, net).mask
    lame = lame_constants(body)
    operator, matrix = MatrixFree(net, lame, 1), assembled(net, *moduli(body), 1)
    mixed = MixedFree(net, ControlNet(mesh, 1), np.array([[0.4, 0.1]]), 1)
    some = np.sin(np.arange(mixed.pressure_net.count, dtype=float))
    laws = PointwiseFree(net, (bz.NeoHooke(E=1.0, nu=0.3).core,), *bernstein.simplex(4, 3), 1)
    factor, blocks = incomplete_cholesky(matrix, fixed), preconditioner(operator, fixed)
    free = preconditioned(operator, fixed)
    return {
        "product": lambda x: operator @ x,
        "product in float32": operator.single,
        "energy": operator.energy,
        "matrix": lambda x: matrix @ x,
        "factor": factor,
        "preconditioner": lambda x: free(x).astype(np.float64),
        "multigrid": lambda x: iterated(blocks, x, 1e-8, silent)[0],
        "from a start": lambda x: iterated(blocks, operator @ x, 1e-8, silent, start=x / 2)[0],
        "saddle": lambda x: saddle(
            mixed, fixed, x, 0 * some, np.zeros((0, len(some))), 1e-8, silent
        )[0],
        "mixed product": lambda x: mixed.apply(x, some)[0],
        "mixed energy": lambda x: mixed.energy(x, some),
        "law": laws.forces,
        "energy of a law": laws.energy,
        "tangent": lambda x: laws.tangent(0.1 * x).apply(x),
    }


TAKERS = (
    *("product", "product in float32", "energy", "matrix", "factor", "preconditioner"),
    *("multigrid", "from a start", "saddle", "mixed product", "mixed energy"),
    *("law", "energy of a law", "tangent"),
)


@pytest.mark.parametrize("name", TAKERS)
def test_arrays_of_any_layout_are_taken_for_what_they_are(name: str) -> None:
    """In the order of Fortran, in float32, with gaps, read-only: the answer is that of plain ones.

    An answer must never go to a copy that the core made of the array which it was to fill.
    """
    take = takers()[name]
    body = held(2, 3)
    net = ControlNet(body.mesh, 2)
    x = np.where(prescribed(body, net).mask, 0.0, 0.01 * np.sin(7 * net.points))
    x = x.astype(np.float32).astype(np.float64)
    expected = np.asarray(take(x))
    assert expected.any()
    gaps = np.zeros((net.count, 6))
    gaps[:, ::2] = x
    locked = x.copy()
    locked.flags.writeable = False
    for given in (np.asfortranarray(x), gaps[:, ::2], locked):
        assert np.asarray(take(given)).tobytes("C") == expected.tobytes()
    if name != "preconditioner":  # of float32 it answers in float32
        single = np.asarray(take(x.astype(np.float32)))
        np.testing.assert_allclose(single, expected, rtol=1e-5, atol=1e-5 * abs(expected).max())
