# SPDX-License-Identifier: BSD-3-Clause
"""Runs pytest again and again from one process that has loaded what is slow to load.

Lines of JSON come in: the arguments of pytest, the number of a planted error, the seconds it may
take, the file for what it says. Each is run in a fork of its own; its exit status goes out. What
BezSoma itself is gets loaded in the fork, unless a core with planted errors asks for nothing else.
"""

from __future__ import annotations

import ctypes
import importlib
import json
import os
import signal
import sys
import time
import traceback
from pathlib import Path

from mutants.planted import VARIABLE

SLOW_TO_LOAD = (
    "numpy",
    "scipy.sparse.linalg",
    "scipy.spatial.transform",
    "scipy.ndimage",
    "pydantic",
    "meshio",
    "pytest",
    "cyclopts",
    "rich.console",
    "PIL.Image",
    "matplotlib.figure",
)
RAISED = 70
NO_END = 1000


def main(with_bezsoma: bool) -> None:
    """Answer until there is nothing more to read."""
    names = (*SLOW_TO_LOAD, "bezsoma") if with_bezsoma else SLOW_TO_LOAD
    for name in names:
        importlib.import_module(name)
    for line in sys.stdin:
        arguments, chosen, limit, said = json.loads(line)
        print(status_of(arguments, chosen, limit, said), flush=True)


def status_of(arguments: list[str], chosen: int, limit: float, said: str) -> int:
    """The exit status of pytest in a fork; below zero a signal, NO_END if it takes too long."""
    child = os.fork()
    if child == 0:
        run(arguments, chosen, said)
    end = time.monotonic() + limit
    pause = 0.005
    while time.monotonic() < end:
        gone, status = os.waitpid(child, os.WNOHANG)
        if gone:
            return os.waitstatus_to_exitcode(status)
        time.sleep(pause)
        pause = min(2 * pause, 0.2)
    os.killpg(child, signal.SIGKILL)
    os.waitpid(child, 0)
    return NO_END


def run(arguments: list[str], chosen: int, said: str) -> None:
    """In the fork: choose the error, run the tests, leave without a look back."""
    os.setpgid(0, 0)
    out = os.open(said, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
    for stream in (1, 2):
        os.dup2(out, stream)
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    status = RAISED
    try:
        choose(chosen)
        import pytest

        status = int(pytest.main(arguments))
    except BaseException:
        traceback.print_exc()
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(status)


def choose(number: int) -> None:
    """Make the planted error of this number, here and in what is started from here."""
    os.environ[VARIABLE] = str(number)
    core = sys.modules.get("bezsoma._core")
    if core and number >= 0:
        here = ctypes.CDLL(str(Path(str(core.__file__))))
        ctypes.c_int.in_dll(here, "bezsoma_error").value = number
