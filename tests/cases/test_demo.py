# SPDX-License-Identifier: BSD-3-Clause
"""The demo goes the whole way, from a CT to a face, and leaves what a newcomer needs."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest.importorskip("SimpleITK", reason="comes with the extra 'imaging'")

import bezsoma as bz
from bezsoma import cli, demo
from bezsoma.demo import HEAD, MODEL, OURS, PREDICTION, run_demo
from bezsoma.errors import InputError


@pytest.fixture
def coarse(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(demo.HEADS, "small", demo.Head(3.0, 4000, 6.0))


@pytest.mark.slow
def test_the_demo_goes_the_whole_way(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], coarse: None
) -> None:
    folder = tmp_path / "demo"
    words = ["demo", "--size", "small", "--degree", "1", "-q", "-o", str(folder)]
    assert cli.main(words) == 0
    out = capsys.readouterr().out
    assert "not a medical device" in out and "chin" in out
    assert f"before and after: {folder / HEAD}" in out
    assert {path.name for path in folder.iterdir()} == OURS
    assert (folder / HEAD).read_bytes().startswith(b"\x89PNG")
    assert "LOOK at labels.png" in (folder / MODEL / "README.txt").read_text()
    results = bz.read_results(folder / PREDICTION)
    assert results.displacement.degree == 1
    moved = results.summary["probes"]["chin"]["displacement"]
    assert -6.5 < moved[1] < -4.5 and abs(moved[0]) < 0.5
    assert all(0 < probe["error"] < 1 for probe in results.summary["probes"].values())  # mm
    assert cli.main(words) == 2
    assert "holds a demo already" in capsys.readouterr().err


def test_a_demo_touches_nothing_of_others(tmp_path: Path) -> None:
    (tmp_path / "note.txt").write_text("keep me")
    with pytest.raises(InputError, match="did not write"):
        run_demo("small", tmp_path, overwrite=True)
    with pytest.raises(InputError, match="no folder"):
        run_demo("small", tmp_path / "a" / "b")
    assert [path.name for path in tmp_path.iterdir()] == ["note.txt"]
