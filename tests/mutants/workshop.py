# SPDX-License-Identifier: BSD-3-Clause
"""A copy of the project to do harm to, and what its tests say about it."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from queue import Empty, SimpleQueue
from typing import NamedTuple

from house.apart import prefix
from mutants.mutant import Mutant
from mutants.planted import DECLARED, DEFINED, planted
from mutants.server import NO_END, RAISED

LEFT_BEHIND = shutil.ignore_patterns(
    ".git", ".venv", "build", "dist", "_build", "generated", "__pycache__", ".*_cache", "*.so"
)
TEAM = "src/core/team.cpp"
UP_TO = "-DBEZSOMA_HIGHEST_DEGREE=4"
"""Kernels of higher degrees are left out where the core is built to look for errors."""
PARTIAL = {"BEZSOMA_PARTIAL_CORE": "1"}
"""Tells tests/conftest.py that this is why kernels are missing."""
LIMIT = 600
"""Seconds; an error that makes a test run for ever is noticed too."""


class Verdict(NamedTuple):
    """What the tests said: pytest's exit status, its first failure or last line, and all of it."""

    status: int
    words: str
    text: str

    def first_failure(self) -> tuple[str, ...]:
        """The first test that failed, alone, or none."""
        lines = [line for line in self.text.splitlines() if line.startswith(("FAILED ", "ERROR "))]
        return tuple(line.split(" ", 1)[1].partition(" - ")[0] for line in lines[:1])


class Workshop:
    """A copy of the project in a folder of its own."""

    def __init__(self, project: Path, folder: Path) -> None:
        self.data = os.environ.get("BEZSOMA_DATA") or str(project.parent / "shared" / "data")
        self.folder = folder / project.name
        shutil.copytree(project, self.folder, ignore=LEFT_BEHIND)
        self.package = self.folder / "src" / "bezsoma"
        self.build = self.folder / "build"
        self.planted = False
        self.idle: SimpleQueue[Server] = SimpleQueue()
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

    def plant(self, mutants: list[Mutant]) -> None:
        """Build a core that has all these errors, of which none is made until it is chosen."""
        self.planted = True
        header = self.folder / "bezsoma_error.hpp"
        if not header.exists():
            header.write_text(DECLARED, encoding="utf-8")
        texts = {TEAM: None, **planted(self.folder, mutants)}
        kept = {file: (self.folder / file).read_text(encoding="utf-8") for file in texts}
        for file, text in texts.items():
            (self.folder / file).write_text(
                (text or kept[file]) + (DEFINED if file == TEAM else ""), encoding="utf-8"
            )
        try:
            self.build_core()
        finally:
            for file, text in kept.items():
                (self.folder / file).write_text(text, encoding="utf-8")

    def build_core(self) -> None:
        """Build the core from the copied sources, and put it where the copied package finds it.

        Of one set of kernels with wide registers and of low degrees, and without all the care for
        speed: an error shows there as it does in all others, and twenty times sooner.
        """
        self.configure(
            f"-DBEZSOMA_KERNEL_OPTIONS=-O1;{UP_TO}",
            f"-DCMAKE_CXX_FLAGS=-include {self.folder / 'bezsoma_error.hpp'}",
        )
        self.make()

    def configure(self, *options: str) -> None:
        """Choose, for the first build, how the core is built: with one set of wide kernels."""
        if (self.build / "CMakeCache.txt").exists():
            return
        hints = [f"-DPython_EXECUTABLE={sys.executable}", f"-Dnanobind_DIR={nanobind()}"]
        kind = ["-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DBEZSOMA_ONE_SET=64"]
        run(["cmake", "-S", str(self.folder), "-B", str(self.build), *kind, *options, *hints])

    def make(self) -> None:
        """Build what has changed, and give it to the copied package."""
        self.close()
        run(["cmake", "--build", str(self.build)])
        for old in self.package.glob("_core*.so"):
            old.unlink()
        for new in self.build.glob("_core*.so"):
            shutil.copy(new, self.package)

    def close(self) -> None:
        """End what runs tests; others begin when they are needed."""
        while not self.idle.empty():
            self.idle.get().close()

    def verdict(self, tests: Sequence[str], chosen: int = -1) -> Verdict:
        """What these tests say about the copy as it is now, with the planted error of a number."""
        options = ["-q", "-p", "no:cacheprovider", "--no-header", "--tb=line", "-x"]
        try:
            server = self.idle.get_nowait()
        except Empty:
            server = Server(self)
        status, text = server.run([*options, *tests], chosen)
        self.idle.put(server)
        if status == NO_END:
            return Verdict(1, f"no end within {LIMIT} s", "")
        found = Verdict(status, gist(text), text)
        # Pytest itself may fall, in the end, over what a test that failed has left behind.
        return found._replace(status=1) if status == RAISED and found.first_failure() else found


class Server:
    """A process that runs pytest again and again in the copy: see server.py."""

    def __init__(self, shop: Workshop) -> None:
        line = f"from mutants.server import main; main({shop.planted})"
        threads = {name: "1" for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS")}
        own = {
            "BEZSOMA_DATA": shop.data,
            "PYTHONDONTWRITEBYTECODE": "1",
            "PYTHONPATH": str(shop.folder / "tests"),
            "COLUMNS": "1000",
            **(PARTIAL if shop.planted else {}),
        }
        self.process = subprocess.Popen(
            [*prefix(shop.folder / "src"), line],
            cwd=shop.folder,
            env=os.environ | threads | own,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def run(self, arguments: list[str], chosen: int) -> tuple[int, str]:
        """The exit status of pytest with these arguments, and what it said."""
        assert self.process.stdin and self.process.stdout
        with tempfile.NamedTemporaryFile("r", encoding="utf-8", errors="replace") as said:
            asked = json.dumps([arguments, chosen, LIMIT, said.name])
            print(asked, file=self.process.stdin, flush=True)
            return int(self.process.stdout.readline()), said.read()

    def close(self) -> None:
        """Let the process end."""
        self.process.communicate()


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
