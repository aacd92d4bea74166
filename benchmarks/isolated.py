# SPDX-License-Identifier: BSD-3-Clause
"""Runs in a process of their own, so that memory and threads of one are not those of another.

The parent calls `ran(script, request)`; the script's `__main__` calls `serve(function)`, which
reads the request, runs and prints the reply as its last line.
"""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import psutil

HERE = Path(__file__).parent
THREADS = ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS", "BEZSOMA_THREADS")
MARK = "reply: "


def ran(script: str, request: dict[str, Any], threads: int, limit: float = 900.0) -> dict[str, Any]:
    """The reply of benchmarks/<script> to a request, or {"failed": why}."""
    environment = os.environ | {name: str(threads) for name in THREADS} | {"MKL_DYNAMIC": "FALSE"}
    command = [sys.executable, str(HERE / script), json.dumps(request)]
    try:
        done = subprocess.run(
            command, env=environment, capture_output=True, text=True, timeout=limit, check=False
        )
    except subprocess.TimeoutExpired:
        return {"failed": f"not done after {limit:g} s"}
    replies = [line for line in done.stdout.splitlines() if line.startswith(MARK)]
    if done.returncode or not replies:
        said = (done.stderr.strip() or "nothing was said").splitlines()[-1]
        return {"failed": f"exit {done.returncode}: {said[:200]}"}
    return dict(json.loads(replies[-1].removeprefix(MARK)))


def serve(function: Callable[[dict[str, Any]], dict[str, Any]]) -> None:
    """Answer the request on the command line."""
    print(MARK + json.dumps(function(json.loads(sys.argv[1]))), flush=True)


def resident() -> int:
    """The bytes of memory that this process holds now."""
    return int(psutil.Process().memory_info().rss)


def forget_peak() -> None:
    """Let `peak` count from now on, where the system can (Linux); elsewhere from the start."""
    if sys.platform == "linux":
        Path("/proc/self/clear_refs").write_text("5")


def peak() -> int:
    """The most bytes that this process held since `forget_peak`, and each child that it has now.

    That is an upper bound where there are children, which hold their most at other times and share
    pages. They are looked for among all processes, in about a millisecond: not while time is taken.
    """
    if sys.platform == "linux":
        children = psutil.Process().children(recursive=True)
        return own_peak() + sum(own_peak(str(child.pid)) for child in children)
    return own_peak()


def own_peak(process: str = "self") -> int:
    """The same of one process alone; 0 of one that has ended."""
    if sys.platform == "linux":
        try:
            lines = Path(f"/proc/{process}/status").read_text().splitlines()
        except (FileNotFoundError, ProcessLookupError):  # a child that has just ended
            lines = []
        most = (int(line.split()[1]) * 1024 for line in lines if line.startswith("VmHWM:"))
        return next(most, 0)  # none where it waits to be asked how it ended
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss  # bytes on macOS
