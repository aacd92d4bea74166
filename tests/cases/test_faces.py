# SPDX-License-Identifier: BSD-3-Clause
"""The real face: its cases run, and what they expect holds."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import bezsoma as bz
from bezsoma.case.reading import Case, case_from

pytestmark = pytest.mark.real_data


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
