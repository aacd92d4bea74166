# SPDX-License-Identifier: BSD-3-Clause
"""The demo leaves what a newcomer needs, and its face follows the jaw."""

from __future__ import annotations

from pathlib import Path

import pytest

import bezsoma as bz
from bezsoma import cli


def test_the_demo_leaves_what_a_newcomer_needs(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "demo"
    words = ["demo", "--size", "small", "--degree", "2", "-q", "-o", str(folder)]
    assert cli.main(words) == 0
    out = capsys.readouterr().out
    assert "not a medical device" in out
    assert f"look at {folder / 'before-after-three-quarter.png'}" in out
    assert all(name in out for name in ("chin", "fold", "lower_lip", "upper_lip"))
    assert (folder / "before-after-front.png").read_bytes().startswith(b"\x89PNG")
    assert "Do not base treatment on it" in (folder / "README.txt").read_text()
    results = bz.read_results(folder)
    assert results.displacement.degree == 2
    moved = {name: -probe["displacement"][1] for name, probe in results.summary["probes"].items()}
    assert 4 < moved["chin"] < 7
    assert moved["chin"] > moved["upper_lip"] > 0
