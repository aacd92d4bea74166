# SPDX-License-Identifier: BSD-3-Clause
"""The files of the project, by kind."""

from __future__ import annotations

from pathlib import Path

BUILT = ("_build", "generated", "__pycache__")


def files(project: Path, *patterns: str) -> list[Path]:
    """The files that fit any of the patterns, nothing built or cached among them."""
    found = {path for pattern in patterns for path in project.glob(pattern) if path.is_file()}
    return sorted(path for path in found if not set(BUILT) & set(path.parts))


def python(project: Path) -> list[Path]:
    """The package's Python files."""
    return files(project, "src/**/*.py", "src/**/*.pyi")


def cpp(project: Path) -> list[Path]:
    """The core's C++ files."""
    return files(project, "src/core/*.?pp")


def tests(project: Path) -> list[Path]:
    """The tests and what they share, the benchmarks, the tools."""
    return files(project, "tests/**/*.py", "benchmarks/**/*.py", "tools/**/*.py")


def prose(project: Path) -> list[Path]:
    """What people read: the documentation, the cases, the files at the top."""
    return files(project, "docs/**/*.md", "docs/**/*.rst", "cases/**/*.toml", "*.md", "*.cff")
