# SPDX-License-Identifier: BSD-3-Clause
"""Known problems as case files: each gives the numbers it expects, and would miss wrong ones."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import bezsoma as bz
import tolerances
from bezsoma import cli
from bezsoma.case.reading import case_from
from bezsoma.mesh.solids import shell, square_bar

FOLDER = Path(__file__).resolve().parents[2] / "cases" / "verification"
CASES = sorted(FOLDER.glob("*.toml"))
DEAREST = {"cook": 4, "cook_incompressible": 4, "cook_mixed": 3, "muscle_beam": 3}
"""The highest degree that the suite takes time for; `bezsoma run --degree` goes further."""


def degrees(path: Path) -> list[int]:
    """The degree of a case, and all others of which it expects something."""
    case = bz.read_case(path)
    spoken = {degree for expect in case.file.expect for degree in expect.degrees or ()}
    highest = DEAREST.get(path.stem, 10)
    return sorted(degree for degree in spoken | {case.file.degree} if degree <= highest)


RUNS = [pytest.param(p, k, id=f"{p.stem}-{k}") for p in CASES for k in degrees(p)]


def test_there_are_as_many_as_the_page_says(root: Path) -> None:
    page = (root / "docs" / "verification" / "known_problems.md").read_text(encoding="utf-8")
    assert {path.stem for path in CASES} == set(re.findall(r"cases/verification/(\w+)\.toml", page))
    assert len(CASES) >= 18


@pytest.mark.parametrize(("path", "degree"), RUNS)
def test_a_known_problem_gives_its_numbers_by_command(
    path: Path, degree: int, tmp_path: Path
) -> None:
    folder = tmp_path / "out"
    words = ["run", str(path), "--output", str(folder), "--degree", str(degree), "--quiet"]
    status = cli.main(words)
    checks = bz.read_results(folder).summary["expectations"]
    assert [check for check in checks if not check["met"]] == []
    assert status == 0
    assert len(checks) >= 2


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_a_wrong_modulus_does_not_pass(path: Path, tmp_path: Path) -> None:
    """Five per cent more of E, G or Guccione's C: what no tolerance here may let through."""
    text, changed = re.subn(
        r"^(E|G|C) = (.+)$",
        lambda match: f"{match[1]} = {1.05 * float(match[2])!r}",
        path.read_text(encoding="utf-8"),
        flags=re.MULTILINE,
    )
    assert changed
    (tmp_path / "two_parts.mesh").write_bytes((FOLDER / "two_parts.mesh").read_bytes())
    results = bz.run_case(case_from(tmp_path / path.name, text), tmp_path / "out")
    assert not all(check["met"] for check in results.summary["expectations"])


def sphere() -> bz.Body:
    return bz.Body(
        shell(inner=1, outer=2, cells=12, layers=3),
        degree=2,
        materials=bz.LinearElastic(E=1, nu=0.3),
        supports=[bz.Fixed(f"{axis}0", components=axis) for axis in "xyz"],
        loads=[bz.Pressure("inner", value=0.01)],
    )


def elliptic_torsion() -> bz.Body:
    value = bz.Polynomial.parse
    sides = {
        "top": ["-0.008*y", "0.002*x", 0],
        "right": [0, 0, "-0.008*y"],
        "left": [0, 0, "0.008*y"],
        "back": [0, 0, "0.002*x"],
        "front": [0, 0, "-0.002*x"],
    }
    return bz.Body(
        square_bar(width=1, length=3, cells=2, layers=4),
        degree=2,
        materials=bz.LinearElastic(E=1.3, nu=0.3),
        supports=[bz.Prescribed("bottom", value=value([0, 0, "-0.006*x*y"]))],
        loads=[bz.Traction(name, value=value(formulas)) for name, formulas in sides.items()],
    )


def two_parts() -> bz.Body:
    names = {"left": 1, "right": 2, "front": 3, "back": 4, "bottom": 5, "top": 6}
    regions = {"lower": 1, "upper": 2}
    return bz.Body(
        bz.read_mesh(FOLDER / "two_parts.mesh", surfaces=names, regions=regions),
        degree=1,
        materials={"lower": bz.LinearElastic(1, 0.25), "upper": bz.LinearElastic(10, 0.4)},
        supports=[
            bz.Fixed("left", "right", components="x"),
            bz.Fixed("front", "back", components="y"),
            bz.Fixed("bottom", components="z"),
        ],
        loads=[bz.Pressure("top", value=0.1)],
    )


@pytest.mark.parametrize(
    ("name", "body"),
    [("sphere", sphere), ("torsion_elliptic", elliptic_torsion), ("two_parts", two_parts)],
)
def test_file_and_python_give_the_same_numbers(name: str, body, tmp_path: Path) -> None:
    filed = bz.run_case(bz.read_case(FOLDER / f"{name}.toml"), tmp_path / "out")
    solution = bz.solve(body(), solver="direct")
    controls = solution.displacement.controls
    assert np.abs(filed.displacement.controls - controls).max() < (
        tolerances.ROUNDING * np.abs(controls).max()
    )
    summary = solution.summary()
    assert filed.summary["energy"] == pytest.approx(summary["energy"], rel=1e-13)
    for place, reaction in summary["reactions"].items():
        for part in ("force", "moment"):
            size = np.abs(reaction[part]).max()
            assert filed.summary["reactions"][place][part] == pytest.approx(
                reaction[part], abs=1e-12 * size
            )
