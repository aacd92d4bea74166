# SPDX-License-Identifier: BSD-3-Clause
"""A case that asks for a tolerance: its levels, its folder, its exit status."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import bezsoma as bz
from bezsoma.cli import main
from cases.written import case_file

REFINE = '[refine]\ntolerance = 6e-4\n\n[error]\nradius = 0.4\n\n[[probe]]\nname = "middle"'
PROBE = '[[probe]]\nname = "middle"'
ON_TOP = ("point = [1, 0.5, 0.5]", 'point = [1, 0.5, 1]\non = "top"')


def test_the_last_level_is_what_is_left(tmp_path: Path) -> None:
    results = bz.run_case(case_file(tmp_path, (PROBE, REFINE), ON_TOP), tmp_path / "out")
    again = bz.read_results(tmp_path / "out")
    found = again.summary["refinement"]
    last = found["levels"][-1]
    assert found["reached"]
    assert last["at"][0]["name"] == "middle"
    assert last["at"][0]["error"] <= 6e-4 < found["levels"][0]["at"][0]["error"]
    assert len(again.mesh.tets) == last["tets"] == len(results.mesh.tets)
    assert again.summary["sizes"]["unknowns"] == last["unknowns"]
    assert set(again.mesh.surfaces) == {"left", "right", "front", "back", "bottom", "top"}
    # What is averaged around the probe is near what the probe itself says.
    probed = again.summary["probes"]["middle"]["displacement"]
    assert np.abs(np.subtract(probed, last["at"][0]["value"])).max() < 0.01
    text = (tmp_path / "out" / "README.txt").read_text(encoding="utf-8")
    assert "level by     degree" in text
    assert "those of the mean displacement within 0.4 mm, of xyz together" in text
    assert "    size   error" in text
    probe = again.summary["probes"]["middle"]
    assert (probe["error"], probe["error_radius"]) == (last["at"][0]["error"], 0.4)
    assert "the estimated error is below the tolerance" in text


def test_what_cannot_be_reached_is_a_failure(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    small = ("[output]", '[refine]\nby = "degree"\nmost_unknowns = 700\nat = "top"\n\n[output]')
    case, out = str(case_file(tmp_path, small, ON_TOP)), tmp_path / "out"
    assert main(["run", case, "-o", str(out), "--tolerance", "1e-9", "--quiet"]) == 1
    said = capsys.readouterr()
    assert "refinement ended short of what was asked for" in said.err
    assert "most_unknowns = 700; " in said.err
    assert "mm at 'top' (asked for: 1e-09 mm)" in said.err
    assert "top, mm" in said.out
    found = json.loads((out / "summary.json").read_text())["refinement"]
    assert not found["reached"]
    assert [level["degree"] for level in found["levels"]] == [2, 3, 4]


def test_refined_or_not_a_probe_has_one_radius_and_one_error(tmp_path: Path) -> None:
    """What a run says of all components is what the first level of a refinement says."""
    error = ("[output]", '[error]\nradius = 0.3\ncomponents = "xyz"\n\n[output]')
    case = case_file(tmp_path, error, ON_TOP)
    plain = bz.run_case(case, tmp_path / "plain").summary["probes"]["middle"]
    found = bz.run_case(case, tmp_path / "levels", tolerance=10.0).summary
    assert len(found["refinement"]["levels"]) == 1
    probe = found["probes"]["middle"]
    assert probe["error_radius"] == plain["error_radius"] == 0.3
    assert probe["error"] == pytest.approx(plain["error"], rel=1e-9)


def test_without_a_wish_nothing_is_refined(tmp_path: Path) -> None:
    results = bz.run_case(case_file(tmp_path, ON_TOP), tmp_path / "out")
    assert "refinement" not in results.summary


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ("tolerance = 0", "tolerance"),
        ('tolerance = 0.1\nat = "chin"', "no probe or surface 'chin'"),
        ('tolerance = 0.1\nby = "mush"', "by"),
        ("tolerence = 0.1", "did you mean 'tolerance'"),
    ],
)
def test_what_cannot_be_asked_is_refused_before_work(
    tmp_path: Path, table: str, words: str
) -> None:
    path = case_file(tmp_path, ("[output]", f"[refine]\n{table}\n\n[output]"))
    with pytest.raises(bz.InputError, match=words) as refusal:
        bz.run_case(path, tmp_path / "out")
    assert "refine" in str(refusal.value)
    assert not (tmp_path / "out").exists()


def test_a_tolerance_needs_a_place_and_a_size(tmp_path: Path) -> None:
    path = case_file(tmp_path)
    text = path.read_text()
    start, end = text.index("[[probe]]"), text.index("[output]")
    path.write_text(text[:start] + text[end:])
    with pytest.raises(bz.InputError, match="a tolerance of what"):
        bz.run_case(path, tmp_path / "out", tolerance=0.1)
    with pytest.raises(bz.InputError, match="more than 0"):
        bz.run_case(path, tmp_path / "out", tolerance=-1)
