# SPDX-License-Identifier: BSD-3-Clause
"""The demo leaves what a newcomer needs, and its face follows the jaw."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import bezsoma as bz
from bezsoma import cli
from bezsoma.demo import LOOKED_AT, demo_case
from bezsoma.imaging import landmarks


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
    assert 6 > moved["fold"] > moved["chin"] > 5
    assert moved["chin"] > moved["lower_lip"] > moved["upper_lip"] > moved["nose_tip"] > -0.1


def test_the_demo_looks_at_landmarks_of_its_head() -> None:
    places = landmarks()
    probes = demo_case("large").file.probe
    assert [probe.name for probe in probes] == [name.replace(" ", "_") for name in LOOKED_AT]
    for name, probe in zip(LOOKED_AT, probes, strict=True):
        assert np.abs(np.array(probe.point) - places[name]).max() < 0.06


def test_what_holds_the_demo_is_what_its_head_has() -> None:
    """All that is bone or beside it is held or moved; skin, mucosa and cut are free."""
    mesh = bz.head_phantom("small")
    named = {place for support in demo_case("small").file.support for place in support.on}
    assert named == set(mesh.surfaces) - {"skin", "mucosa", "cut"}
