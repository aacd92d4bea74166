# SPDX-License-Identifier: BSD-3-Clause
"""A run says how large its error is, or why it does not."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import bezsoma as bz
from bezsoma.case import estimating
from cases.written import case_file

ERROR = "\n[error]\nradius = 0.2\n"
PLACE = "point = [1, 0.5, 0.5]"


def ran(folder: Path, *changes: tuple[str, str], degree: int | None = None) -> bz.Results:
    """The results of the block with some of its lines changed."""
    case = bz.read_case(case_file(folder, *changes))
    return bz.run_case(case, folder / "out", degree=degree)


def test_a_run_has_its_error_beside_its_values(tmp_path: Path) -> None:
    results = ran(tmp_path, ("[[probe]]", f"{ERROR}\n[[probe]]"))
    error, probe = results.summary["error"], results.summary["probes"]["middle"]
    assert 0 < error["energy"] < 1
    found = error["probes"]["middle"]
    assert found["radius"] == probe["error_radius"] == 0.2
    assert probe["error"] == found["error"] >= np.linalg.norm(found["signed"]) * (1 - 1e-12)
    assert found["mean"] == pytest.approx(probe["displacement"], abs=0.05 * probe["size"])
    assert error["seconds"] > 0
    text = (tmp_path / "out" / "README.txt").read_text(encoding="utf-8")
    assert "% in the energy norm" in text
    assert "within 0.2 mm of each probe, of xyz together" in text
    assert "    size   error" in text


def test_components_are_those_asked_for(tmp_path: Path) -> None:
    results = ran(tmp_path, ("[[probe]]", f'{ERROR}components = "zx"\n\n[[probe]]'))
    found, probe = results.summary["error"]["probes"]["middle"], results.summary["probes"]["middle"]
    assert found["mean"] == pytest.approx(probe["displacement"][::2], abs=0.05 * probe["size"])
    assert probe["error"] == found["error"] >= np.linalg.norm(found["signed"]) * (1 - 1e-12)
    assert "of each probe, of xz together" in (tmp_path / "out" / "README.txt").read_text("utf-8")


def test_the_same_in_python(tmp_path: Path) -> None:
    changes = (
        ("[[probe]]", f'{ERROR}components = "x"\n\n[[probe]]'),
        (PLACE, f'{PLACE}\non = "top"'),
    )
    results = ran(tmp_path, *changes)
    found = results.summary["error"]["probes"]["middle"]
    law, load = bz.LinearElastic(E=0.015, nu=0.3), bz.Polynomial.parse([0, 0, "1e-5*x"])
    body = bz.Body(
        bz.block(size=(2, 1, 1), cells=(2, 1, 1)),
        2,
        law,
        [bz.Fixed("left"), bz.Moved("right", translation=(0.1, 0, 0))],
        [bz.Traction("top", value=load)],
    )
    solution = bz.solve(body)
    goal = bz.PatchMean("top", at=(1, 0.5, 1), radius=0.2, direction="x")
    assert found["signed"] == [pytest.approx(bz.goal_estimate(solution, goal).error, rel=1e-6)]
    energy = bz.energy_estimate(solution).relative
    assert results.summary["error"]["energy"] == pytest.approx(energy, rel=1e-6)


@pytest.mark.parametrize(
    ("change", "degree", "said"),
    [("[error]\nestimate = false\n", None, "not asked for"), ("", 9, "degree 11")],
)
def test_where_it_is_left_out_it_says_why(
    tmp_path: Path, change: str, degree: int | None, said: str
) -> None:
    results = ran(tmp_path, ("[[probe]]", f"{change}\n[[probe]]"), degree=degree)
    assert said in results.summary["error"]["left_out"]
    assert "error" not in results.summary["probes"]["middle"]
    assert "Error: not estimated" in (tmp_path / "out" / "README.txt").read_text("utf-8")


def test_nobody_waits_for_an_estimate_that_was_not_asked_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(estimating, "MOST_UNKNOWNS", 100)
    left_out = ran(tmp_path).summary["error"]["left_out"]
    assert "write estimate = true" in left_out


def test_an_estimate_that_fails_does_not_cost_the_results(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(*_: object, **__: object) -> None:
        raise bz.NotConverged("stands still")

    monkeypatch.setattr(estimating, "raised", fails)
    results = ran(tmp_path)
    assert "stands still" in results.summary["error"]["left_out"]
    assert results.summary["energy"] > 0


def test_a_warning_says_how_its_advice_is_written_in_a_case(tmp_path: Path) -> None:
    (said,) = ran(tmp_path, ("nu = 0.3", "nu = 0.45")).summary["warnings"]
    assert said.endswith("in the case file: incompressible = true beside degree")


def test_tissue_that_folds_between_the_points_of_the_quadrature_is_a_warning(
    tmp_path: Path,
) -> None:
    """One cell deep, its top pushed through the bottom: no point of the quadrature sees it."""
    results = ran(
        tmp_path,
        ("nu = 0.3", 'nu = 0.3\nlaw = "neo-hooke"'),
        ("size = [2, 1, 1], cells = [2, 1, 1]", "size = [1, 1, 1], cells = [1, 1, 1]"),
        ('on = "left"', 'on = "bottom"'),
        ('["right"]', '["top"]'),
        ("[0.1, 0, 0]", "[0, 0, -1.5]"),
        ("point = [1, 0.5, 0.5]", "point = [1, 0.5, 1]"),
        ("between = [0.04, 0.06]", "between = [-9, 9]"),
    )
    said = [each for each in results.summary["warnings"] if "turned inside out" in each]
    assert len(said) == 1 and "cannot be trusted" in said[0]
    assert f"Beware: {said[0]}" in (tmp_path / "out" / "README.txt").read_text("utf-8")


def test_a_run_can_be_run_again_as_it_was_asked_for(tmp_path: Path) -> None:
    folder = tmp_path / "out"
    case = bz.read_case(case_file(tmp_path))
    bz.run_case(case, folder, degree=case.file.degree)
    assert "    bezsoma run case.toml -o another" in (folder / "README.txt").read_text("utf-8")
    bz.run_case(case, folder, degree=3, tolerance=0.5, overwrite=True)
    said = (folder / "README.txt").read_text("utf-8")
    assert "    bezsoma run case.toml --degree 3 --tolerance 0.5 -o another-folder" in said
