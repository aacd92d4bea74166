# SPDX-License-Identifier: BSD-3-Clause
"""The real face: its cases run, and what they expect holds."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import bezsoma as bz
from bezsoma.arrays import Floats
from bezsoma.case.build import body_of
from bezsoma.case.expectations import probe_points
from bezsoma.case.reading import Case, case_from, read_case
from bezsoma.case.sources import mesh_of

pytestmark = pytest.mark.real_data

DIRECTIONS = {"jaw_forward": (-1, 1), "opening": (1, -1)}
"""The README counts forward and up in the one case, back and down in the other."""
ROW = re.compile(r"^\| (small|large), (\d) \| ([\d,]+) \| (.+) \|$", re.MULTILINE)
PRINTED = 0.02
"""How far a number in the README may be from the answer, mm: it has two digits."""
STEPS = {2: 81, 3: 98}
"""Steps on the large face at nu = 0.45, jaw forward, as the design measured."""
COLUMNS = ("chin", "fold", "lower_lip", "upper_lip")


def face(root: Path, data: Path, monkeypatch: pytest.MonkeyPatch, name: str) -> Case:
    """A case of the face without its pictures, which take longer than the solution."""
    monkeypatch.setenv("BEZSOMA_DATA", str(data))
    path = root / "cases" / f"face_small_{name}.toml"
    return case_from(path, path.read_text(encoding="utf-8") + "\n[output]\npictures = []\n")


@pytest.mark.parametrize("degree", [1, 2])
def test_the_face_follows_the_jaw_forward(
    degree: int, root: Path, data: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    case = face(root, data, monkeypatch, "jaw_forward")
    results = bz.run_case(case, tmp_path / "out", degree=degree)
    assert [check for check in results.summary["expectations"] if not check["met"]] == []
    moved = {name: -probe["displacement"][1] for name, probe in results.summary["probes"].items()}
    assert moved["chin"] > moved["lower_lip"] > moved["upper_lip"] > moved["right_cheek"] > 0


def test_the_chin_goes_down_and_back_when_the_mouth_opens(
    root: Path, data: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    results = bz.run_case(face(root, data, monkeypatch, "opening"), tmp_path / "out", degree=1)
    assert [check for check in results.summary["expectations"] if not check["met"]] == []
    x, y, z = results.summary["probes"]["chin"]["displacement"]
    assert abs(x) < 1
    assert y > 0 > z


def test_the_skull_touches_neither_jaw_nor_rami(data: Path) -> None:
    """Why the opening case needs no join."""
    tags = {"skin": 1, "skull": 2, "jaw": 3, "rami": 4, "cut": 5}
    for size in ("small", "large"):
        mesh = bz.read_mesh(data / f"face_{size}" / f"face_{size}.npz", surfaces=tags)
        of = {name: set(np.unique(mesh.facets_of(name)).tolist()) for name in tags}
        assert of["skull"].isdisjoint(of["jaw"] | of["rami"])
        assert not of["jaw"].isdisjoint(of["rami"])


@pytest.mark.parametrize("size", ["small", "large"])
@pytest.mark.parametrize("case", list(DIRECTIONS))
def test_the_table_in_the_readme_is_what_the_cases_give(
    case: str, size: str, root: Path, data: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("BEZSOMA_DATA", str(data))
    read = read_case(root / "cases" / f"face_{size}_{case}.toml")
    mesh = mesh_of(read)
    points = probe_points(read, mesh)
    table = {d: (n, numbers) for s, d, n, numbers in rows(root, case) if s == size}
    assert list(table) == [1, 2, 3]
    for degree, (unknowns, printed) in table.items():
        solution = bz.solve(body_of(read, mesh, degree))
        assert solution.free == unknowns
        if size == "large" and case == "jaw_forward" and degree in STEPS:
            assert solution.iterations <= STEPS[degree]
        moved = solution.displacement.at(np.array([points[name] for name in COLUMNS]))
        found = moved[:, 1:] * DIRECTIONS[case]
        assert np.abs(found - printed).max() < PRINTED


def rows(root: Path, case: str) -> list[tuple[str, int, int, Floats]]:
    """The rows of one table: mesh, degree, unknowns, and two numbers (4, 2) mm for each point."""
    text = (root / "README.md").read_text(encoding="utf-8")
    table = text.split("<!-- table of the face: begin -->")[1].split("**")[2:5:2]
    chosen = table[list(DIRECTIONS).index(case)]
    return [
        (
            size,
            int(degree),
            int(unknowns.replace(",", "")),
            np.array([[float(n) for n in cell.split("/")] for cell in cells.split("|")]),
        )
        for size, degree, unknowns, cells in ROW.findall(chosen)
    ]
