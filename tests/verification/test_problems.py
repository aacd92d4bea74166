# SPDX-License-Identifier: BSD-3-Clause
"""Every verification problem gives its numbers, which the pages print, and the pictures stand.

A page prints six digits, and they are those that are found, to 2e-5 of the number. What only
rounding makes is another number on another machine: where the tolerance is 1e-6 or less, as much
is granted beside.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from verification.every import FAMILIES, PROBLEMS
from verification.pages import BOOK, contents, section
from verification.pictures import PICTURES
from verification.problem import ANALYTICAL, AT_LEAST, KINDS, Problem, Value

ROUNDING, PRINTED = 1e-6, 2e-5
WRITE = "write them anew: PYTHONPATH=tests ./dev python -m verification.pages FAMILY"


@pytest.mark.parametrize("problem", PROBLEMS, ids=str)
def test_a_problem_gives_its_numbers_and_its_page_prints_them(problem: Problem, root: Path) -> None:
    values = list(problem.values())
    assert values
    assert [value for value in values if not value.good] == []
    lines = printed(problem, root)
    assert len(lines) == len(values), WRITE
    assert [pair for pair in zip(values, lines, strict=True) if not agree(*pair)] == [], WRITE


def printed(problem: Problem, root: Path) -> list[list[str]]:
    """The cells of a problem's table on its page."""
    page = (root / BOOK / f"{problem.family}.md").read_text(encoding="utf-8")
    its = page.partition(f"\n## {problem.name}\n")[2].partition("\n## ")[0]
    rows = [line for line in its.splitlines() if line.startswith("| ")][1:]
    return [[cell.replace("\\|", "|") for cell in row.strip("| ").split(" | ")] for row in rows]


def agree(value: Value, line: list[str]) -> bool:
    """Whether a line of a page is what was found."""
    where, of, found, wanted = line[0], line[1], float(line[2]), float(line[3].split()[-1])
    slack = value.within * (abs(value.wanted) or 1.0) if value.within <= ROUNDING else 0.0
    return (where, of) == (value.where, value.of) and (
        abs(found - value.found) <= slack + PRINTED * abs(value.found)
        and abs(wanted - value.wanted) <= PRINTED * abs(value.wanted)
    )


@pytest.mark.parametrize(
    ("found", "line", "good"),
    [
        (4.14091, ["480 tets", "z, mm", "4.14091", "4.17"], True),
        (4.1411, ["480 tets", "z, mm", "4.14091", "4.17"], False),
        (4.14091, ["481 tets", "z, mm", "4.14091", "4.17"], False),
        (4.14091, ["480 tets", "z, mm", "4.14091", ">= 4.2"], False),
    ],
)
def test_another_number_on_a_page_is_seen(found: float, line: list[str], good: bool) -> None:
    assert agree(Value("z, mm", "480 tets", found, 4.17, 7e-3), line) is good


def test_the_pictures_are_there_and_small(root: Path) -> None:
    there = {each.name: each.read_bytes() for each in (root / BOOK / "pictures").iterdir()}
    assert set(there) == {drawn.file for drawn in PICTURES.values()}
    assert set(PICTURES) <= set(map(str, PROBLEMS))
    assert all(png.startswith(b"\x89PNG") and len(png) < 60_000 for png in there.values())


def test_a_picture_is_drawn_again() -> None:
    drawn = PICTURES["stiffening: Drawn between walls: Frobenius"].content()
    assert drawn.startswith(b"\x89PNG") and 5_000 < len(drawn) < 60_000


def test_there_are_enough() -> None:
    assert len(PROBLEMS) >= 150
    assert len(FAMILIES) >= 12
    assert sum(problem.kind == ANALYTICAL for problem in PROBLEMS) >= 60
    assert {problem.kind for problem in PROBLEMS} <= set(KINDS)
    assert len({str(problem) for problem in PROBLEMS}) == len(PROBLEMS)


def test_the_pages_say_of_every_problem_what_it_says_of_itself(root: Path) -> None:
    """Its name, source, answer, tolerance and picture."""
    for family in FAMILIES:
        page = (root / BOOK / f"{family.name}.md").read_text(encoding="utf-8")
        stale = [p.name for p in family if f"\n{section(p, ())}\n" not in page]
        assert stale == [], WRITE
    assert (root / BOOK / "index.md").read_text(encoding="utf-8") == contents(), WRITE


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
