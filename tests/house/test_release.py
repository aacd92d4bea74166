# SPDX-License-Identifier: BSD-3-Clause
"""One version, one list of what is installed: everything that states them says the same."""

from __future__ import annotations

import re
import subprocess
import sys
import tomllib
from importlib.metadata import version
from pathlib import Path
from typing import Any

import pytest

import bezsoma as bz
from house.installed import is_permissive, licence, needed


@pytest.fixture(scope="module")
def project(root: Path) -> dict[str, Any]:
    return tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))


def test_the_version_stands_in_one_place(project: dict[str, Any], root: Path) -> None:
    stated = project["project"]["version"]
    assert bz.__version__ == version("bezsoma") == stated
    command = Path(sys.executable).parent / "bezsoma"
    run = subprocess.run([command, "--version"], capture_output=True, text=True, check=True)
    assert run.stdout.split() == ["bezsoma", stated]
    cited = re.search(r"^version: (.+)$", (root / "CITATION.cff").read_text(), re.MULTILINE)
    assert cited is not None and cited[1] == stated
    assert f"\n## {stated}\n" in (root / "CHANGELOG.md").read_text()


def test_what_builds_and_documents_states_no_version_of_its_own(root: Path) -> None:
    """CMake gets none, the pages ask the installed package."""
    cmake = (root / "CMakeLists.txt").read_text()
    assert re.search(r"project\(bezsoma LANGUAGES CXX\)", cmake)
    assert 'version_of("bezsoma")' in (root / "docs/conf.py").read_text()
    assert "__version__ =" not in (root / "src/bezsoma/__init__.py").read_text()


def test_the_abi_of_wheels_is_stable_from_the_python_that_is_said(project: dict[str, Any]) -> None:
    settings = project["tool"]
    assert settings["scikit-build"]["wheel"]["py-api"] == "cp312"
    built = settings["cibuildwheel"]["build"]
    assert built == ["cp311-manylinux_*", "cp312-manylinux_*"]
    assert settings["cibuildwheel"]["linux"]["archs"] == ["x86_64", "aarch64"]


@pytest.mark.parametrize("extra", ["", "imaging"])
def test_all_that_is_installed_is_under_a_permissive_licence(extra: str) -> None:
    names = needed("bezsoma", extra)
    assert {"numpy", "scipy", "pydantic-core", "cyclopts", "embreex"} <= set(names)
    assert [f"{name}: {licence(name)}" for name in names if not is_permissive(licence(name))] == []
    assert licence("bezsoma") == "BSD-3-Clause"


def test_a_licence_that_asks_for_more_would_be_seen() -> None:
    assert [is_permissive(x) for x in ("AGPL-3.0", "LGPLv2+", "unknown")] == [False] * 3
    assert is_permissive("MIT License") and is_permissive("Apache-2.0 OR BSD-2-Clause")
