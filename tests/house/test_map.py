# SPDX-License-Identifier: BSD-3-Clause
"""The map leads from every equation of the paper to code and tests, and back."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from house import map as paper
from house import sources


@pytest.fixture(scope="module")
def rows(root: Path) -> list[paper.Row]:
    return paper.rows(root)


def test_every_equation_is_on_the_map_once(rows: list[paper.Row]) -> None:
    assert [row.number for row in rows] == list(paper.EQUATIONS)


def test_the_page_of_the_equations_has_each_with_its_formula(root: Path) -> None:
    text = (root / "docs/theory/equations.md").read_text(encoding="utf-8")
    parts = re.split(r"^### Eq\. (\d+)$", text, flags=re.MULTILINE)[1:]
    assert [int(number) for number in parts[::2]] == list(paper.EQUATIONS)
    assert [body for body in parts[1::2] if "$$" not in body] == []


def test_an_equation_is_built_or_said_not_to_be(rows: list[paper.Row]) -> None:
    for row in rows:
        if row.state.startswith(paper.NOT_YET):
            assert not row.code, f"eq. {row.number} is not built, and yet has code"
        else:
            assert row.state == paper.BUILT
            assert row.code and row.tests, f"eq. {row.number} is built, without code or test"


def test_what_the_map_names_exists(root: Path) -> None:
    text = (root / "docs/map.md").read_text(encoding="utf-8")
    lost = [
        f"{file.relative_to(root)}:{name}"
        for file, name in paper.references(text, root)
        if not file.exists() or (name and not paper.has(file, name))
    ]
    assert not lost, "\n".join(lost)


def test_code_and_tests_on_the_map_speak_of_their_equation(rows: list[paper.Row]) -> None:
    silent = [
        f"eq. {row.number}: no {kind} on the map speaks of it"
        for row in rows
        if row.state == paper.BUILT
        for kind, places in (("code", row.code), ("test", row.tests))
        if not any(row.number in paper.mentioned(file) for file, _ in places if file.exists())
    ]
    assert not silent, "\n".join(silent)


def test_what_speaks_of_an_equation_is_on_the_map(root: Path, rows: list[paper.Row]) -> None:
    known = {row.number: {ref.file for ref in [*row.code, *row.tests]} for row in rows}
    house = root / "tests" / "house"
    spoken = [*sources.python(root), *sources.cpp(root), *sources.tests(root)]
    lost = [
        f"{file.relative_to(root)} speaks of eq. {number}; docs/map.md does not lead there"
        for file in spoken
        if house not in file.parents
        for number in sorted(paper.mentioned(file))
        if file not in known.get(number, set())
    ]
    assert not lost, "\n".join(lost)


@pytest.mark.parametrize(
    ("text", "spoken"),
    [
        ("the paper, eq. 6", {6}),
        ("(paper, eqs. 33-35 and 45)", {33, 34, 35, 45}),
        ("eqs. (2), (3)", {2, 3}),
        ("# paper, eq.\n    # 12", {12}),
        ("a sequel. 12 of them", set()),
        ("Liu and Joe, BIT 34 (1994), eq. 4", set()),
    ],
)
def test_mentions_are_read_as_people_write_them(
    text: str, spoken: set[int], tmp_path: Path
) -> None:
    (tmp_path / "a.py").write_text(text)
    assert paper.mentioned(tmp_path / "a.py") == spoken
