# SPDX-License-Identifier: BSD-3-Clause
"""Who imports whom, read from the sources: also inside functions, by string, and in C++ includes.

import-linter holds the floors in `./dev lint`; this reads the same table with eyes of its own, so
that the two check each other, and adds what import-linter cannot see.
"""

from __future__ import annotations

import ast
import re
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

PACKAGE = "bezsoma"
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"][^>"]+[>"])', re.MULTILINE)
BINDING = "bindings"


class Import(NamedTuple):
    """One import: the file and line it stands in, and the dotted name it asks for."""

    file: Path
    line: int
    name: str


def imports(file: Path, package: str) -> Iterator[Import]:
    """Every import of a file, wherever it hides; relative ones resolved from `package`."""
    for part in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        for name in names(part, package):
            yield Import(file, part.lineno, name)  # type: ignore[attr-defined]


def names(part: ast.AST, package: str) -> list[str]:
    """What one statement or call imports, as dotted names."""
    if isinstance(part, ast.Import):
        return [alias.name for alias in part.names]
    if isinstance(part, ast.ImportFrom):
        above = package.split(".")
        source = above[: len(above) + 1 - part.level] if part.level else []
        source = [*source, *(part.module or "").split(".")] if part.module else source
        # `from a import b` may import the module a.b: both are asked for.
        return [".".join([*source, alias.name]) for alias in part.names]
    if isinstance(part, ast.Call) and called(part) in ("import_module", "__import__"):
        return [a.value for a in part.args[:1] if isinstance(a, ast.Constant)]
    return []


def called(call: ast.Call) -> str:
    """The last word of what is called: import_module, of importlib.import_module(...)."""
    return getattr(call.func, "attr", getattr(call.func, "id", ""))


def package_of(file: Path, source: Path) -> str:
    """The dotted package that a file's relative imports start from."""
    return ".".join(file.relative_to(source).parent.parts)


def all_imports(source: Path) -> list[Import]:
    """Every import of every module under `source`, the folder that holds the package."""
    files = sorted((source / PACKAGE).rglob("*.py"))
    return [found for file in files for found in imports(file, package_of(file, source))]


def floors(project: Path) -> list[list[list[str]]]:
    """The floors of pyproject.toml, top first; a floor is groups that do not see each other."""
    table = tomllib.loads((project / "pyproject.toml").read_text(encoding="utf-8"))
    contract = next(c for c in table["tool"]["importlinter"]["contracts"] if c["type"] == "layers")
    return [
        [[name.strip(" ()") for name in group.split(":")] for group in floor.split("|")]
        for floor in contract["layers"]
    ]


def home(name: str, places: dict[str, tuple[int, int]]) -> str | None:
    """Which module of the table a dotted name belongs to, if any."""
    parts = name.split(".")
    return parts[1] if parts[0] == PACKAGE and len(parts) > 1 and parts[1] in places else None


def violations(project: Path) -> list[str]:
    """Each import that goes up, or sideways to a sibling, as a sentence."""
    places = {
        name: (floor, group)
        for floor, groups in enumerate(floors(project))
        for group, names_ in enumerate(groups)
        for name in names_
    }
    source = project / "src"
    found = []
    for file, line, name in all_imports(source):
        own = file.relative_to(source / PACKAGE).parts[0].removesuffix(".py")
        theirs = home(name, places)
        if own not in places or theirs is None or theirs == own:
            continue
        (up, side), (down, beside) = places[own], places[theirs]
        if down < up or (down == up and side != beside):
            found.append(f"{file.relative_to(project)}:{line} imports {name}")
    return found


def strangers(project: Path) -> list[str]:
    """Modules of the package that stand on no floor."""
    known = {name for floor in floors(project) for group in floor for name in group}
    folder = project / "src" / PACKAGE
    modules = {p.name.removesuffix(".py") for p in folder.iterdir() if is_module(p)}
    return sorted(modules - known)


def is_module(path: Path) -> bool:
    """Whether a path is a module or a package that could be imported by its own name."""
    if path.is_dir():
        return any(path.glob("*.py"))
    return path.suffix == ".py" and not path.name.startswith("__")


def importers(project: Path, package: str) -> list[str]:
    """The files that import a package from outside, relative to the sources."""
    source = project / "src"
    return sorted(
        {
            str(found.file.relative_to(source))
            for found in all_imports(source)
            if found.name.split(".")[0] == package
        }
    )


def includes(file: Path) -> list[str]:
    """What a C++ file includes, brackets or quotes and all."""
    return INCLUDE.findall(file.read_text(encoding="utf-8"))


def core_violations(project: Path) -> list[str]:
    """C++ files that know Python though they are no binding, or that include in a circle."""
    core = project / "src" / "core"
    files = sorted(core.glob("*.?pp"))
    found = [
        f"src/core/{file.name} includes {name}"
        for file in files
        if not file.name.startswith(BINDING)
        for name in includes(file)
        if "nanobind" in name or "Python.h" in name or BINDING in name
    ]
    below = {f.name: {n.strip('"') for n in includes(f) if n[0] == '"'} for f in files}
    return found + [f"src/core/{name} includes itself" for name in below if in_circle(name, below)]


def in_circle(name: str, below: dict[str, set[str]]) -> bool:
    """Whether a file is among what it includes, directly or not."""
    seen: set[str] = set()
    ahead = set(below[name])
    while ahead:
        one = ahead.pop()
        seen.add(one)
        ahead |= below.get(one, set()) - seen
    return name in seen
