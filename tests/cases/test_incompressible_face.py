# SPDX-License-Identifier: BSD-3-Clause
"""The real face at nu = 1/2: its jaw moves, its volume stays."""

from __future__ import annotations

from pathlib import Path

import pytest

import bezsoma as bz
from bezsoma.case.reading import case_from

pytestmark = pytest.mark.real_data


@pytest.mark.parametrize(
    ("size", "degree"),
    [("small", 2), ("small", 3), pytest.param("large", 3, marks=pytest.mark.slow)],
)
def test_the_jaw_moves_and_the_volume_stays(
    size: str, degree: int, root: Path, data: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("BEZSOMA_DATA", str(data))
    path = root / "cases" / f"face_{size}_incompressible.toml"
    text = path.read_text(encoding="utf-8").split("[output]")[0] + "[output]\npictures = []\n"
    results = bz.run_case(case_from(path, text), tmp_path / "out", degree=degree)
    summary = results.summary
    assert [check for check in summary["expectations"] if not check["met"]] == []
    assert summary["held_tets"] == 0
    assert summary["pressure_degree"] == degree - 1
    assert summary["iterations"] < 100
    assert abs(summary["volume_change"]) < 1e-8 * results.mesh.volumes.sum()
    assert summary["largest_determinant"] > 0.1
