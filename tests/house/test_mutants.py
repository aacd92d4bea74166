# SPDX-License-Identifier: BSD-3-Clause
"""The table of deliberate errors fits the sources as they are now (./dev mutants runs it)."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutants import table


def test_there_are_enough_in_both_languages() -> None:
    assert len(table.ALL) >= 20
    assert len(table.CPP) >= 8
    assert [m for m in table.IN_CI if not m.is_cpp] == list(table.PYTHON)
    assert sum(m.is_cpp for m in table.IN_CI) == 3


@pytest.mark.parametrize("mutant", table.ALL, ids=[mutant.what for mutant in table.ALL])
def test_each_stands_once_in_its_file(mutant: table.Mutant, root: Path) -> None:
    assert (root / mutant.file).read_text(encoding="utf-8").count(mutant.old) == 1
    assert mutant.old != mutant.new
    assert all((root / test.split("::")[0]).exists() for test in mutant.tests)
