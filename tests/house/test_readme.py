# SPDX-License-Identifier: BSD-3-Clause
"""What the README says is true: its example runs, its links lead somewhere."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import bezsoma as bz
from house import sources

LINK = re.compile(r"\]\((?!https?:|#|mailto:)([^)#\s]+)(?:#[^)]*)?\)")
MADE_LATER = "generated/"
"""The reference is written by Sphinx, which itself complains of links that lead nowhere."""


def blocks(root: Path, language: str) -> list[str]:
    text = (root / "README.md").read_text(encoding="utf-8")
    return re.findall(rf"```{language}\n(.*?)```", text, re.DOTALL)


def test_the_example_runs(root: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (example,) = blocks(root, "python")
    monkeypatch.chdir(tmp_path)
    scope: dict[str, object] = {}
    exec(compile(example, "README.md", "exec"), scope)
    solution = scope["solution"]
    assert isinstance(solution, bz.Solution)
    middle = solution.displacement.at(np.array([[20.0, 10.0, 5.0]]))[0]
    assert middle[0] == pytest.approx(2.5, abs=0.05), "the middle of a stretched block moves half"
    assert solution.reactions["right"].force[0] == pytest.approx(0.4, abs=0.005)
    assert (tmp_path / "stretched.vtu").stat().st_size > 0


def test_the_first_two_commands_are_commands(root: Path) -> None:
    lines = blocks(root, "sh")[0].splitlines()
    assert [line.split("#")[0].strip() for line in lines] == ["./dev demo", "./dev test"]
    usage = subprocess.run([root / "dev", "help"], capture_output=True, text=True, check=True)
    assert all(word in usage.stdout for word in ("demo", "test", "lint", "docs", "bench"))


def test_an_unknown_command_is_refused(root: Path) -> None:
    run = subprocess.run([root / "dev", "tset"], capture_output=True, text=True, check=False)
    assert run.returncode == 2
    assert "no command 'tset'" in run.stderr and "usage" in run.stderr


def test_links_between_pages_lead_somewhere(root: Path) -> None:
    dead = [
        f"{page.relative_to(root)}: {target}"
        for page in sources.prose(root)
        for target in LINK.findall(page.read_text(encoding="utf-8"))
        if not target.startswith(MADE_LATER) and not (page.parent / target).exists()
    ]
    assert dead == []


def test_the_command_is_installed() -> None:
    command = Path(sys.executable).parent / "bezsoma"
    run = subprocess.run([command, "--version"], capture_output=True, text=True, check=True)
    assert bz.__version__ in run.stdout
