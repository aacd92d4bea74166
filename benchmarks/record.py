# SPDX-License-Identifier: BSD-3-Clause
"""What a measurement was made on, and where it is stored."""

from __future__ import annotations

import json
import os
import platform
import sys
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import psutil

import bezsoma as bz
from bezsoma import _core

PEERS = ("ngsolve", "scikit-fem", "pypardiso", "mkl", "felupe", "pyamg", "numpy", "scipy")
RESULTS = Path(__file__).parent / "results"


def surroundings() -> dict[str, Any]:
    """Date, machine in words, load, versions and the command."""
    return {
        "date": datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
        "machine": machine(),
        "load": [round(load, 2) for load in os.getloadavg()],
        "versions": {"bezsoma": bz.__version__, "python": platform.python_version()} | _versions(),
        "command": " ".join(["python", "benchmarks/" + Path(sys.argv[0]).name, *sys.argv[1:]]),
    }


def machine() -> str:
    """Processor, cores, memory and the widest instruction set in use."""
    memory = psutil.virtual_memory().total / 2**30
    return (
        f"{_processor()}, {os.cpu_count()} cores, {memory:.0f} GiB, {platform.system()}, "
        f"kernels for {_core.instruction_sets()[0]}"
    )


def stored(name: str, found: dict[str, Any], text: str) -> None:
    """Print a text, and leave it and the numbers in benchmarks/results."""
    print(text)
    kept(name, found)
    (RESULTS / f"{name}.md").write_text(text + "\n", encoding="utf-8")


def kept(name: str, found: dict[str, Any]) -> None:
    """Leave the numbers so far in benchmarks/results, should a long run be cut short."""
    RESULTS.mkdir(exist_ok=True)
    (RESULTS / f"{name}.json").write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")


def read(name: str) -> dict[str, Any]:
    """The numbers that were kept under a name."""
    found: dict[str, Any] = json.loads((RESULTS / f"{name}.json").read_text(encoding="utf-8"))
    return found


def table(head: list[str], rows: list[list[str]]) -> str:
    """Markdown."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def _versions() -> dict[str, str]:
    found = {}
    for package in PEERS:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            continue
    return found


def _processor() -> str:
    """Its family, as the system calls it."""
    if sys.platform == "linux":
        for line in Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    return platform.processor() or platform.machine()
