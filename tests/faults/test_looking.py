# SPDX-License-Identifier: BSD-3-Clause
"""`bezsoma picture` and `bezsoma film`: what they write, and what they say when they cannot."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from bezsoma import cli, read_results, results_picture, run_case
from bezsoma.case import fields, showing
from bezsoma.equations.stress import von_mises
from cases.written import case_file
from tolerances import CLOSED_FORM

Printed = pytest.CaptureFixture[str]


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A results folder of the small block."""
    folder = tmp_path_factory.mktemp("looking")
    run_case(case_file(folder), folder / "out")
    return folder / "out"


def ran(*words: object) -> int:
    return cli.main([str(word) for word in words])


def size_of(name: str) -> tuple[int, int]:
    with Image.open(name) as shown:
        return shown.size


def test_a_picture_stands_where_it_was_wanted(
    finished: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Printed
) -> None:
    monkeypatch.chdir(tmp_path)
    assert ran("picture", finished, "--field", "stress", "--slice", "x=0.7", "--wires") == 0
    assert capsys.readouterr().out.strip() == "out-stress-left.png"
    assert size_of("out-stress-left.png") == (1000, 900)
    assert ran("picture", finished, "--over", "original", "--net", "-o", "seen.png") == 0
    assert size_of("seen.png") == (1000, 900)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["out-stress-left.png", "seen.png"]


def test_a_film_stands_where_it_was_wanted(
    finished: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Printed
) -> None:
    monkeypatch.chdir(tmp_path)
    assert ran("film", finished, "--frames", 3, "--seconds", 1, "-q") == 0
    assert capsys.readouterr().out.strip() == "out.gif"
    with Image.open("out.gif") as shown:
        assert shown.n_frames == 3  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--field", "strss"], "no field 'strss'; results has [.*(did you mean 'stress'?)"),
        (["--view", "lft"], "no view 'lft'; .*(did you mean 'left'?)"),
        (["--slice", "x=5"], "the plane x = 5 mm does not cut the body, which after it moved"),
        (["--slice", "x=five"], "'x=five' is no plane; write x=12.5"),
        (["--slice", "x=1", "--view", "top"], "is seen edge-on from here; look along its normal"),
        (["--surface", "lft"], "no surface 'lft'; this mesh has [.*(did you mean 'left'?)"),
        (["--translucent", "skin"], "no surface 'skin'; this mesh has"),
        (["--over", "orignal"], "(did you mean 'original'?)"),
        (["--magnified", "nan"], "cannot be drawn nan times"),
    ],
)
def test_what_cannot_be_drawn_is_said_and_nothing_is_left(
    words: list[str], said: str, finished: Path, tmp_path: Path, capsys: Printed
) -> None:
    assert ran("picture", finished, *words, "-o", tmp_path / "a.png") == 2
    err = capsys.readouterr().err
    for part in said.split(".*"):
        assert part in err
    assert "Traceback" not in err and list(tmp_path.iterdir()) == []


def test_what_is_no_results_folder_or_stands_in_the_way_is_said_at_once(
    finished: Path, tmp_path: Path, capsys: Printed, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert ran("picture", tmp_path / "nothing", "-o", tmp_path / "a.png") == 2
    assert "it does not exist; give the folder of a run" in capsys.readouterr().err
    assert ran("film", tmp_path, "-o", tmp_path / "a.gif", "-q") == 2
    assert "it has no 'summary.json'" in capsys.readouterr().err
    (tmp_path / "a.png").write_bytes(b"mine")
    monkeypatch.setattr(showing, "read_results", lambda folder: pytest.fail("too late"))
    assert ran("picture", finished, "-o", tmp_path / "a.png") == 2
    assert "a.png' exists; say --overwrite to replace it" in capsys.readouterr().err
    assert (tmp_path / "a.png").read_bytes() == b"mine"
    assert ran("film", finished, "-o", tmp_path / "no" / "a.gif") == 2
    assert "there is no folder" in capsys.readouterr().err


def test_a_film_that_cannot_be_is_refused(finished: Path, tmp_path: Path, capsys: Printed) -> None:
    for words, said in (
        (["--frames", "1"], "give 2 to 240"),
        (["--turn", "999"], "give -360 to 360"),
        (["--field", "colour"], "no field 'colour'"),
    ):
        assert ran("film", finished, *words, "-q", "-o", tmp_path / "a.gif") == 2
        assert said in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_every_field_has_numbers_and_a_label_with_its_unit(finished: Path) -> None:
    results = read_results(finished)
    bary = np.array([[0.1, 0.2, 0.3, 0.4]])
    tets = np.array([0])
    for name, (label, _) in fields.FIELDS.items():
        shown = fields.field_of(results, name)
        values = shown.field.at_bary(tets, bary).reshape(1, -1)
        number = values if shown.measure is None else shown.measure(values)
        assert np.isfinite(number).all() and shown.label == label
        assert label.endswith((", mm", ", MPa")) or name in ("divergence", "determinant")


def test_the_stress_of_results_is_that_of_the_solution(finished: Path) -> None:
    results = read_results(finished)
    bary, tets = np.array([[0.1, 0.2, 0.3, 0.4]]), np.array([3])
    H = results.displacement.gradient_bary(tets, bary)[0]
    E, nu = 0.015, 0.3
    G, lam = E / (2 + 2 * nu), E * nu / ((1 + nu) * (1 - 2 * nu))
    wanted = G * (H + H.T) + lam * np.trace(H) * np.eye(3)
    size = np.abs(wanted).max()
    for name, number in (("xx", wanted[0, 0]), ("yz", wanted[1, 2]), ("zx", wanted[2, 0])):
        shown = fields.field_of(results, f"stress_{name}")
        values = shown.field.at_bary(tets, bary).reshape(1, 9)
        assert shown.measure is not None
        assert abs(shown.measure(values)[0] - number) < CLOSED_FORM * size
    shown = fields.field_of(results, "stress")
    assert shown.measure is not None
    found = shown.measure(shown.field.at_bary(tets, bary).reshape(1, 9))[0]
    assert abs(found - von_mises(wanted)) < CLOSED_FORM * size
    pressure = fields.field_of(results, "pressure")
    mean = np.trace(wanted) / 3
    assert abs(pressure.field.at_bary(tets, bary)[0] + mean) < CLOSED_FORM * size


def test_the_same_picture_in_python(finished: Path) -> None:
    content = results_picture(None, finished, field="pressure", plane="z=0.5", size=(300, 300))
    assert Image.open(io.BytesIO(content)).size == (300, 300)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["picture", "-o", "a.jpg"], "would hold a PNG; end it in .png"),
        (["film", "-q", "-o", "a.mov"], "end it in .gif or .mp4"),
    ],
)
def test_a_name_that_promises_another_kind_of_file_is_refused(
    words: list[str], said: str, finished: Path, monkeypatch: pytest.MonkeyPatch, capsys: Printed
) -> None:
    monkeypatch.chdir(finished.parent)
    assert ran(words[0], finished, *words[1:]) == 2
    assert said in capsys.readouterr().err
    assert not (finished.parent / words[-1]).exists()
