# SPDX-License-Identifier: BSD-3-Clause
"""A copy of the project to do harm to, and what its tests say about it."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from house.apart import prefix

LEFT_BEHIND = shutil.ignore_patterns(
    ".git", ".venv", "build", "dist", "_build", "generated", "__pycache__", ".*_cache", "*.so"
)
LIMIT = 600
"""Seconds; an error that makes a test run for ever is noticed too."""


class Verdict(NamedTuple):
    """What the tests said: pytest's exit status, and its first failure or last line."""

    status: int
    words: str


class Workshop:
    """A copy of the project in a folder of its own."""

    def __init__(self, project: Path, folder: Path) -> None:
        self.data = os.environ.get("BEZSOMA_DATA") or str(project.parent / "shared" / "data")
        self.folder = folder / project.name
        shutil.copytree(project, self.folder, ignore=LEFT_BEHIND)
        self.package = self.folder / "src" / "bezsoma"
        for module in installed_core():
            shutil.copy(module, self.package)

    @contextmanager
    def harmed(self, file: str, old: str, new: str) -> Iterator[None]:
        """The file with `old` replaced by `new`, for as long as the block lasts."""
        path = self.folder / file
        text = path.read_text(encoding="utf-8")
        if text.count(old) != 1:
            raise SystemExit(f"{file} has {old!r} {text.count(old)} times; the table needs it once")
        path.write_text(text.replace(old, new), encoding="utf-8")
        try:
            yield
        finally:
            path.write_text(text, encoding="utf-8")

    def build_core(self) -> None:
        """Build the core from the copied sources, and put it where the copied package finds it."""
        build = self.folder / "build"
        if not build.exists():
            hints = [f"-DPython_EXECUTABLE={sys.executable}", f"-Dnanobind_DIR={nanobind()}"]
            options = ["-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", *hints]
            run(["cmake", "-S", str(self.folder), "-B", str(build), *options])
        run(["cmake", "--build", str(build)])
        for old in self.package.glob("_core*.so"):
            old.unlink()
        for new in build.glob("_core*.so"):
            shutil.copy(new, self.package)

    def verdict(self, tests: tuple[str, ...]) -> Verdict:
        """What these tests say about the copy as it is now."""
        line = "import pytest; raise SystemExit(pytest.main(sys.argv[1:]))"
        options = ["-x", "-q", "-p", "no:cacheprovider", "--no-header", "--tb=line"]
        command = [*prefix(self.folder / "src"), line, *options, *tests]
        threads = {name: "1" for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS")}
        environment = {
            **os.environ,
            "BEZSOMA_DATA": self.data,
            "PYTHONDONTWRITEBYTECODE": "1",
            **threads,
        }
        try:
            done = subprocess.run(
                command,
                cwd=self.folder,
                env=environment,
                timeout=LIMIT,
                capture_output=True,
                text=True,
                check=False,
            )
        except subprocess.TimeoutExpired:
            return Verdict(1, f"no end within {LIMIT} s")
        return Verdict(done.returncode, gist(done.stdout + done.stderr))


def gist(text: str) -> str:
    """The first failure of pytest's summary, or else its last line."""
    lines = [line for line in text.splitlines() if line.strip()] or [""]
    told = [line for line in lines if line.startswith(("FAILED ", "ERROR "))]
    return told[0].split(" - ")[0].split(" ", 1)[1] if told else lines[-1]


def installed_core() -> list[Path]:
    """The compiled core that is installed."""
    from bezsoma import _core

    return [Path(str(_core.__file__))]


def nanobind() -> str:
    """Where nanobind keeps what CMake needs."""
    command = [sys.executable, "-m", "nanobind", "--cmake_dir"]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()


def run(command: list[str]) -> None:
    """Run a build command, with the tools of this Python first; its output only if it fails."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    tool = shutil.which(command[0], path=path) or command[0]
    done = subprocess.run(
        [tool, *command[1:]],
        env={**os.environ, "PATH": path},
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode:
        raise SystemExit(f"{' '.join(command)} failed:\n{done.stdout}{done.stderr}")
