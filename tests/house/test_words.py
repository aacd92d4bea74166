# SPDX-License-Identifier: BSD-3-Clause
"""Words, lengths and names that the house has agreed on (docs/floors.md, docs/glossary.md)."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

from house import sources

LONGEST = 600
VAGUE = {"utils", "util", "helpers", "helper", "common", "misc", "manager", "managers", "base"}
EMPTY_PREFIX = re.compile(r"(get|compute|create|do)_")
FORBIDDEN = re.compile(r"node", re.IGNORECASE)
MAY_SAY_IT = {"docs/glossary.md", "docs/floors.md", "docs/theory/errata.md", "CONTRIBUTING.md"}
MAY_PRINT = {"cli.py", "progress.py", "__main__.py"}


def all_code(root: Path) -> list[Path]:
    return [*sources.python(root), *sources.cpp(root), *sources.tests(root)]


def test_every_source_file_states_its_licence(root: Path) -> None:
    others = [root / "dev", root / ".ci/run", root / "CMakeLists.txt"]
    silent = [
        str(file.relative_to(root))
        for file in [*all_code(root), *others]
        if file.exists() and "SPDX-License-Identifier: BSD-3-Clause" not in head(file)
    ]
    assert silent == []


def head(file: Path) -> str:
    return "\n".join(file.read_text(encoding="utf-8").splitlines()[:2])


def test_no_file_is_longer_than_600_lines(root: Path) -> None:
    lengths = {str(f.relative_to(root)): lines(f) for f in all_code(root)}
    assert {name: length for name, length in lengths.items() if length > LONGEST} == {}


def lines(file: Path) -> int:
    return len(file.read_text(encoding="utf-8").splitlines())


def test_no_module_has_a_vague_name(root: Path) -> None:
    parts = {part for f in all_code(root) for part in f.relative_to(root).with_suffix("").parts}
    assert parts & VAGUE == set()


def test_a_control_is_never_called_by_the_forbidden_word(root: Path) -> None:
    """A Bernstein coefficient is no value at a point; the word that pretends so stays out."""
    house = root / "tests" / "house"
    said = [
        f"{file.relative_to(root)}:{number}: {line.strip()}"
        for file in [*all_code(root), *sources.prose(root)]
        if house not in file.parents and str(file.relative_to(root)) not in MAY_SAY_IT
        for number, line in enumerate(file.read_text(encoding="utf-8").splitlines(), 1)
        if FORBIDDEN.search(line)
    ]
    assert said == []


def test_functions_are_named_for_what_they_return(root: Path) -> None:
    named = [
        f"{file.relative_to(root)}: {part.name}"
        for file in sources.python(root)
        for part in ast.walk(ast.parse(file.read_text(encoding="utf-8")))
        if isinstance(part, ast.FunctionDef) and EMPTY_PREFIX.match(part.name)
    ]
    assert named == []


def test_only_the_commands_print(root: Path) -> None:
    printing = {
        str(file.relative_to(root))
        for file in sources.python(root)
        if file.name not in MAY_PRINT
        for part in ast.walk(ast.parse(file.read_text(encoding="utf-8")))
        if isinstance(part, ast.Call) and getattr(part.func, "id", "") == "print"
    }
    assert printing == set()


def test_no_work_is_left_open_in_the_sources(root: Path) -> None:
    mark = re.compile(r"\b(TODO|FIXME|XXX|HACK)\b|NotImplementedError")
    left = [str(f.relative_to(root)) for f in all_code(root) if f.parent.name != "house"]
    assert [name for name in left if mark.search((root / name).read_text(encoding="utf-8"))] == []


def test_every_public_name_is_explained(root: Path) -> None:
    """Ruff checks docstrings one by one; this one also counts what `__all__` hands out."""
    silent = []
    for file in sources.python(root):
        tree = ast.parse(file.read_text(encoding="utf-8"))
        if file.suffix == ".pyi":
            continue
        if not ast.get_docstring(tree):
            silent.append(str(file.relative_to(root)))
        silent += [
            f"{file.relative_to(root)}: {part.name}"
            for part in tree.body
            if isinstance(part, ast.FunctionDef | ast.ClassDef)
            and not part.name.startswith("_")
            and not ast.get_docstring(part)
        ]
    assert silent == []


@pytest.mark.parametrize("name", ["README.md", "LICENSE", "CITATION.cff", "CHANGELOG.md", "dev"])
def test_what_a_newcomer_looks_for_is_there(root: Path, name: str) -> None:
    assert (root / name).read_text(encoding="utf-8").strip()


def test_the_version_is_the_same_everywhere(root: Path) -> None:
    version = re.search(r'^version = "(.+)"$', (root / "pyproject.toml").read_text(), re.M)
    cited = re.search(r"^version: (.+)$", (root / "CITATION.cff").read_text(), re.M)
    assert version and cited
    assert cited[1].strip('"') == version[1]
    assert f"## {version[1]}" in (root / "CHANGELOG.md").read_text()
