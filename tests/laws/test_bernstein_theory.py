# SPDX-License-Identifier: BSD-3-Clause
"""The page on Bernstein polynomials: its examples run, and what it names exists."""

from __future__ import annotations

import doctest
import re
from pathlib import Path

from bezsoma import bernstein as bb


def page(root: Path) -> Path:
    return root / "docs" / "theory" / "bernstein.md"


def test_the_examples_of_the_page_run(root: Path) -> None:
    result = doctest.testfile(str(page(root)), module_relative=False, encoding="utf-8")
    assert result.failed == 0
    assert result.attempted >= 8


def test_the_page_names_every_function_and_no_other(root: Path) -> None:
    text = re.sub(r"```.*?```", "", page(root).read_text(encoding="utf-8"), flags=re.DOTALL)
    named = {name for name in re.findall(r"`(\w+)`", text)}
    inner = {"multinomials", "parents"}  # of use inside the package only
    assert named - {"blossom"} == set(bb.__all__) - inner - {"blossom"}
    assert "blossom" in named
