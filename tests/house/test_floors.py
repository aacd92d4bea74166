# SPDX-License-Identifier: BSD-3-Clause
"""The floors hold, and the check that says so is itself checked by planted violations."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from house import floors
from house.apart import python_on

SPECIAL = [
    "meshio",
    "embreex",
    "matplotlib",
    "PIL",
    "pyvista",
    "cyclopts",
    "rich",
    "SimpleITK",
    "h5py",
    "av",
]


def test_no_floor_imports_from_above(root: Path) -> None:
    assert floors.violations(root) == []


def test_every_module_stands_on_a_floor(root: Path) -> None:
    assert floors.strangers(root) == []


def test_the_cpp_kernels_know_no_python_and_no_circles(root: Path) -> None:
    assert floors.core_violations(root) == []


@pytest.mark.parametrize("package", SPECIAL)
def test_a_special_package_is_imported_in_one_file(root: Path, package: str) -> None:
    assert len(floors.importers(root, package)) <= 1


@pytest.fixture
def house(root: Path, tmp_path: Path) -> Path:
    """A copy of the sources to do harm to."""
    shutil.copytree(root / "src", tmp_path / "src", ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(root / "pyproject.toml", tmp_path)
    return tmp_path


PLANTED = {
    "at the top": ("mesh/tets.py", "from bezsoma.solvers import solve"),
    "relative": ("mesh/tets.py", "from ..equations import element"),
    "from the package's root": ("bernstein/nets.py", "from bezsoma import mesh"),
    "in a function": ("bernstein/nets.py", "def hidden():\n    import bezsoma.mesh.tets"),
    "for types only": (
        "mesh/field.py",
        "if TYPE_CHECKING:\n    from bezsoma.mechanics import Body",
    ),
    "sideways": ("view/vtk.py", "from bezsoma.mechanics.body import Body"),
    "by a string": ("errors.py", "importlib.import_module('bezsoma.mesh')"),
}


@pytest.mark.parametrize("how", PLANTED)
def test_a_planted_import_is_found(house: Path, how: str) -> None:
    file, line = PLANTED[how]
    with (house / "src/bezsoma" / file).open("a") as source:
        source.write(f"\n{line}\n")
    assert [v for v in floors.violations(house) if v.startswith(f"src/bezsoma/{file}:")]


@pytest.mark.parametrize("how", ["in a function", "sideways"])
def test_import_linter_finds_it_too(house: Path, how: str) -> None:
    pytest.importorskip("importlinter", reason="import-linter comes with ./dev lint")
    file, line = PLANTED[how]
    with (house / "src/bezsoma" / file).open("a") as source:
        source.write(f"\n{line}\n")
    run = python_on(
        house / "src",
        "from importlinter.cli import lint_imports as run; raise SystemExit(run())",
        house,
    )
    assert run.returncode != 0
    assert "BROKEN" in run.stdout, run.stdout + run.stderr


def test_a_stranger_is_found(house: Path) -> None:
    (house / "src/bezsoma/attic.py").write_text("")
    assert floors.strangers(house) == ["attic"]


@pytest.mark.parametrize(
    ("file", "line"),
    [
        ("elasticity.cpp", "#include <nanobind/ndarray.h>"),
        ("elasticity.hpp", "#  include <Python.h>"),
        ("elasticity.hpp", '#include "elasticity.hpp"'),
    ],
)
def test_a_planted_include_is_found(house: Path, file: str, line: str) -> None:
    with (house / "src/core" / file).open("a") as source:
        source.write(f"\n{line}\n")
    assert any(file in found for found in floors.core_violations(house))


def test_a_second_importer_is_found(house: Path) -> None:
    (house / "src/bezsoma/mesh/one.py").write_text("import meshio")
    (house / "src/bezsoma/mesh/two.py").write_text("def f():\n    from meshio import read")
    assert len(floors.importers(house, "meshio")) >= 2
