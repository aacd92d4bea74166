# SPDX-License-Identifier: BSD-3-Clause
"""Reads docs/map.md: which code and which tests belong to which equation of the paper."""

from __future__ import annotations

import ast
import re
from pathlib import Path
from typing import NamedTuple

EQUATIONS = range(1, 59)
BUILT, NOT_YET = "built", "not yet"
ROW = re.compile(r"^\|\s*(\d+)\s*\|(.*)\|\s*$", re.MULTILINE)
REFERENCE = re.compile(r"`([\w./]+\.(?:py|cpp|hpp|toml|md))(?::\s*([\w.]+))?`")
NUMBERS = r"\(?\d+\)?(?:(?:-|, | and )\(?\d+\)?)*"
MENTION = re.compile(rf"(?<!\(\d{{4}}\), )\b[Ee]qs?\.\s+({NUMBERS})")
"""After a year in parentheses it is an equation of somebody else."""
SPAN = re.compile(r"\(?(\d+)\)?-\(?(\d+)\)?|\(?(\d+)\)?")


class Reference(NamedTuple):
    """A file, and the function or class in it where one is named."""

    file: Path
    name: str


class Row(NamedTuple):
    """One equation: the code that realises it, the tests that hold it, and whether it is built."""

    number: int
    code: list[Reference]
    tests: list[Reference]
    state: str


def rows(project: Path) -> list[Row]:
    """The table of equations."""
    found = []
    text = (project / "docs/map.md").read_text(encoding="utf-8").split("## Equations")[1]
    for number, cells in ROW.findall(text):
        _, code, tests, state = (cell.strip() for cell in cells.split("|"))
        found.append(Row(int(number), references(code, project), references(tests, project), state))
    return found


def references(text: str, project: Path) -> list[Reference]:
    """What a text names in code letters: `mesh/tets.py:TetMesh`, `tests/laws/test_nets.py`."""
    return [Reference(place(path, project), name) for path, name in REFERENCE.findall(text)]


def place(path: str, project: Path) -> Path:
    """Where a path of the map lies: in the package, in the core, or as written."""
    options = [project / "src/bezsoma" / path, project / "src" / path, project / path]
    return next((option for option in options if option.exists()), options[0])


def mentioned(file: Path) -> set[int]:
    """The equations that a file speaks of: eq. 6, eqs. 33-35, eqs. 2, 3 and 30."""
    text = re.sub(r"\n\s*(#|//)?\s*", " ", file.read_text(encoding="utf-8"))
    return {number for found in MENTION.findall(text) for number in numbers(found)}


def numbers(text: str) -> set[int]:
    """The numbers of a list with spans.

    >>> sorted(numbers("2, 3 and 33-35"))
    [2, 3, 33, 34, 35]
    """
    spans = ((int(a or c), int(b or c)) for a, b, c in SPAN.findall(text))
    return {number for first, last in spans for number in range(first, last + 1)}


def has(file: Path, name: str) -> bool:
    """Whether a file defines a name: a function, a class, a method, a constant."""
    text = file.read_text(encoding="utf-8")
    if file.suffix != ".py":
        return re.search(rf"\b{name}\s*\(", text) is not None
    scope: list[ast.stmt] = ast.parse(text).body
    for part in name.split("."):
        found = next((item for item in scope if part in defined(item)), None)
        if found is None:
            return False
        scope = getattr(found, "body", [])
    return True


def defined(item: ast.stmt) -> set[str]:
    """The names that one statement defines."""
    if isinstance(item, ast.FunctionDef | ast.ClassDef):
        return {item.name}
    targets = [item.target] if isinstance(item, ast.AnnAssign) else getattr(item, "targets", [])
    return {target.id for target in targets if isinstance(target, ast.Name)}
