# SPDX-License-Identifier: BSD-3-Clause
"""Every verification problem gives its numbers, and the pages speak of every one."""

from __future__ import annotations

from pathlib import Path

import pytest

from verification.every import FAMILIES, PROBLEMS
from verification.pages import BOOK
from verification.problem import ANALYTICAL, AT_LEAST, KINDS, Problem, Value


@pytest.mark.parametrize("problem", PROBLEMS, ids=str)
def test_a_problem_gives_its_numbers(problem: Problem) -> None:
    values = list(problem.values())
    assert values
    assert [value for value in values if not value.good] == []


def test_there_are_enough() -> None:
    assert len(PROBLEMS) >= 150
    assert len(FAMILIES) >= 12
    assert sum(problem.kind == ANALYTICAL for problem in PROBLEMS) >= 60
    assert {problem.kind for problem in PROBLEMS} <= set(KINDS)
    assert len({str(problem) for problem in PROBLEMS}) == len(PROBLEMS)


def test_the_pages_speak_of_every_problem(root: Path) -> None:
    for family in FAMILIES:
        page = (root / BOOK / f"{family.name}.md").read_text(encoding="utf-8")
        missing = [p.name for p in family if f"\n## {p.name}\n" not in page]
        assert missing == [], "write them: PYTHONPATH=tests ./dev python -m verification.pages"


@pytest.mark.parametrize(
    ("value", "good"),
    [
        (Value("", "", 1.04, 1.0, 0.05), True),
        (Value("", "", 0.94, 1.0, 0.05), False),
        (Value("", "", 2.9, 3.0, 0.15, AT_LEAST), True),
        (Value("", "", 2.8, 3.0, 0.15, AT_LEAST), False),
        (Value("", "", float("nan"), 1.0, 0.05), False),
        (Value("", "", -1e-3, 0.0, 1e-4), False),
    ],
)
def test_a_wrong_number_is_seen(value: Value, good: bool) -> None:
    assert value.good is good
