# SPDX-License-Identifier: BSD-3-Clause
"""Sparse factors by SuperLU; of large matrices in a process of their own, which can be stopped."""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
import weakref
from collections.abc import Callable
from pathlib import Path
from queue import Empty, SimpleQueue
from threading import Thread
from time import perf_counter
from typing import Any

import numpy as np
from scipy.sparse import csc_array
from scipy.sparse.linalg import splu

from bezsoma.arrays import Floats
from bezsoma.errors import InputError

HERE_UP_TO = 3000
"""Rows of a matrix that is factored in a fraction of a second: in this process."""
LARGEST = 2**31 - 1
"""SuperLU counts entries in 32 bits."""
HEARS_EVERY = 0.1
"""Seconds after which whoever waits is told so."""
APART = Path(__file__).with_name("factors_apart.py")

Waiting = Callable[[float], None]
"""Called again and again during a long factorisation with the seconds since it began."""


def factored(
    matrix: csc_array[Any], waiting: Waiting | None = None, **options: Any
) -> Callable[[Floats], Floats]:
    """What takes b (n,) to x (n,) with matrix x = b; `options` are those of `splu`.

    SuperLU cannot be told to stop, and Python hears Ctrl-C only once it is done: a minute at 47 000
    unknowns. So a process of its own factors a large matrix and solves with it. What stops the
    wait, KeyboardInterrupt or an error of whoever is told, ends that process and gives its memory
    back at once. (A thread would not do: it could not be ended, and SciPy frees SuperLU's memory
    under it when Python ends.) Starting it takes half a second; the numbers are the same.

    >>> solve = factored(csc_array(np.array([[2.0, 1], [1, 1]])))
    >>> solve(np.array([3.0, 2])).tolist()
    [1.0, 1.0]
    """
    rows = matrix.shape[0]
    if matrix.nnz > LARGEST:
        raise MemoryError(f"{matrix.nnz} entries are more than SuperLU counts")
    if rows <= HERE_UP_TO:
        factors = splu(matrix, **options)
        return lambda b: np.asarray(factors.solve(_fitting(b, rows)), dtype=np.float64)
    child = _child()
    try:
        _asked(child, (matrix, options), waiting)
    except BaseException:
        _end(child)
        raise

    def solve(b: Floats) -> Floats:
        return np.asarray(_asked(child, _fitting(b, rows), None), dtype=np.float64)

    weakref.finalize(solve, _end, child)
    return solve


def too_large(unknowns: int, instead: str) -> InputError:
    """The refusal of factors that there is no memory for; another solver is named."""
    return InputError(
        f"{unknowns} unknowns are more than the direct solver can hold or count; use "
        f"solver={instead!r}"
    )


def _fitting(b: Floats, rows: int) -> Floats:
    if b.shape[:1] != (rows,):
        raise InputError(
            f"a right-hand side of the shape {b.shape} was given; the matrix has {rows} rows, so "
            f"it must be ({rows},)"
        )
    return b


def _child() -> subprocess.Popen[bytes]:
    """The process, in a session of its own, where no Ctrl-C of a terminal comes."""
    places = os.pathsep.join(path for path in sys.path if path)
    return subprocess.Popen(
        [sys.executable, "-P", str(APART)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        env=os.environ | {"PYTHONPATH": places},
        start_new_session=True,
    )


def _end(child: subprocess.Popen[bytes]) -> None:
    child.kill()
    child.communicate()


def _asked(child: subprocess.Popen[bytes], given: Any, waiting: Waiting | None) -> Any:
    """What the process answers; raised if it is an error."""
    answers: SimpleQueue[Any] = SimpleQueue()
    Thread(target=lambda: answers.put(_exchanged(child, given)), daemon=True).start()
    start = perf_counter()
    answer: Any = answers
    while answer is answers:  # nothing so far
        try:
            answer = answers.get(timeout=HEARS_EVERY)
        except Empty:
            if waiting:
                waiting(perf_counter() - start)
        except BaseException:  # or this answer would be taken for that to the next question
            _end(child)
            raise
    if isinstance(answer, BaseException):
        raise answer
    return answer


def _exchanged(child: subprocess.Popen[bytes], given: Any) -> Any:
    assert child.stdin and child.stdout
    try:
        pickle.dump(given, child.stdin, pickle.HIGHEST_PROTOCOL)
        child.stdin.flush()
        return pickle.load(child.stdout)
    except (OSError, ValueError, EOFError, pickle.UnpicklingError):
        return MemoryError("the process that factors was ended, as systems without memory do")
