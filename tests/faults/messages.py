# SPDX-License-Identifier: BSD-3-Clause
"""Writes docs/verification/faults.md: every message that a test provokes and reads.

`PYTHONPATH=tests ./dev python -m faults.messages` runs tests/faults, and notes what is raised
where a test expects an error and what the commands say when they refuse.
"""

from __future__ import annotations

import io
import os
import re
import sys
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from bezsoma import cli
from bezsoma.errors import BezSomaError

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "verification" / "faults.md"
WHAT = {
    "test_bodies": "Bodies: materials, supports and loads",
    "test_calls": "Calls from Python",
    "test_cases": "Case files",
    "test_cli": "Commands",
    "test_core": "The core",
    "test_factors": "Sparse factors",
    "test_hard_problems": "Problems that are hard to solve",
    "test_imaging": "Pictures and segmentations",
    "test_looking": "Pictures that are asked for",
    "test_mesh_files": "Mesh files",
    "test_meshes": "Meshes",
    "test_mixed": "Incompressible bodies",
    "test_model": "From a CT to a model",
    "test_nonlinear": "Large strain",
    "test_refinement": "Refinement",
    "test_results": "Results that are written",
    "test_rigid_motions": "Supports that leave something loose",
    "test_seldom": "Met seldom",
}


class Fault(NamedTuple):
    """A test with its case, and the message that it provoked."""

    test: str
    message: str


class Notes:
    """The messages that were heard, each once."""

    def __init__(self) -> None:
        self.found: dict[Fault, None] = {}

    def note(self, message: str) -> None:
        """Remember a message of the test that runs; places of this machine are left out."""
        text = re.sub(r"/[^\s']*/pytest-\d+/(?:[^/\s']+/)?", "", message.strip())
        text = text.replace(f"{ROOT}/", "").replace(str(Path(sys.prefix)), "...")
        test = os.environ["PYTEST_CURRENT_TEST"].rsplit(" (", 1)[0].removeprefix("tests/faults/")
        text = re.sub(r"\(process \d+\)", "(process 4711)", text)
        self.found[Fault(test, re.sub(r" at 0x[0-9a-f]+", "", text))] = None

    def listen(self, patch: pytest.MonkeyPatch) -> None:
        """Hear what `pytest.raises` meets and what the commands print when they refuse."""
        leave, command = pytest.RaisesExc.__exit__, cli.main

        def met(expected: Any, kind: Any, error: Any, trace: Any) -> bool:
            if isinstance(error, (BezSomaError, ValueError)):
                self.note(str(error))
            return bool(leave(expected, kind, error, trace))

        def said(*arguments: Any, **options: Any) -> int:
            heard = Heard(sys.stderr)
            with pytest.MonkeyPatch.context() as here:
                here.setattr(sys, "stderr", heard)
                status = command(*arguments, **options)
            if status not in (0, None):
                self.note(heard.last())
            return status

        patch.setattr(pytest.RaisesExc, "__exit__", met)
        patch.setattr(cli, "main", said)


class Heard(io.TextIOBase):
    """Standard error, heard on its way."""

    def __init__(self, out: Any) -> None:
        self.out = out
        self.text: list[str] = []

    def write(self, text: str) -> int:
        self.text.append(text)
        return int(self.out.write(text))

    def flush(self) -> None:
        self.out.flush()

    def isatty(self) -> bool:
        return bool(self.out.isatty())

    def last(self) -> str:
        """What was said from the word error on."""
        said = "".join(self.text).strip()
        return said[max(said.rfind("error:"), 0) :]


def page(faults: list[Fault]) -> str:
    """All messages, file by file."""
    parts = [
        "# What is said when something is wrong",
        f"{len(faults)} messages, each provoked by a test in `tests/faults` that reads it for what "
        "was given, why it cannot work and what can. This page is written from those tests by\n\n"
        "```sh\nPYTHONPATH=tests ./dev python -m faults.messages\n```",
    ]
    for file, what in WHAT.items():
        here = [fault for fault in faults if fault.test.startswith(f"{file}.py::")]
        if here:
            parts.append(f"## {what}")
            parts.append("\n\n".join(map(entry, here)))
    return "\n\n".join(parts) + "\n"


def entry(fault: Fault) -> str:
    """A message under the name of its test."""
    name = fault.test.split("::", 1)[1].removeprefix("test_").replace("_", " ")
    said = "\n".join(f"    {line}".rstrip() for line in fault.message.splitlines())
    return re.sub(r"([*`<>|$])", r"\\\1", name) + f":\n\n{said}"


def main() -> int:
    """Run the tests of faults and write the page."""
    notes = Notes()
    with pytest.MonkeyPatch.context() as patch:
        notes.listen(patch)
        status = pytest.main(["-q", "-p", "no:cacheprovider", *(sys.argv[1:] or ["tests/faults"])])
    if status == 0:
        PAGE.write_text(page(list(notes.found)), encoding="utf-8")
    return int(status)


if __name__ == "__main__":
    sys.exit(main())
