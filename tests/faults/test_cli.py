# SPDX-License-Identifier: BSD-3-Clause
"""The commands: what they print, their exit status, and that no refusal is a traceback."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
import pytest

from bezsoma import NotConverged, block, cli, write_mesh
from bezsoma.case import refining, running
from cases.written import case_file

Printed = pytest.CaptureFixture[str]


def ran(*words: object) -> int:
    """The exit status of `bezsoma` with these words."""
    return cli.main([str(word) for word in words])


def test_a_run_says_what_came_out_and_where_to_look(tmp_path: Path, capsys: Printed) -> None:
    case = case_file(tmp_path, ("pictures = []", 'pictures = ["front"]'))
    assert ran("run", case, "-o", tmp_path / "out") == 0
    out, err = capsys.readouterr()
    assert "research software and not a medical device" in out
    assert "middle" in out
    assert "1 of 1 expected numbers were met" in out
    assert f"look at {tmp_path / 'out' / 'before-after-front.png'}, then " in out
    assert "reading the mesh" in err
    assert "\x1b" not in out + err


def test_a_quiet_run_shows_no_progress(tmp_path: Path, capsys: Printed) -> None:
    assert ran("run", case_file(tmp_path), "-q", "-o", tmp_path / "out") == 0
    assert capsys.readouterr().err == ""


def test_the_folder_is_named_for_the_case_and_its_degree(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = case_file(tmp_path, name="pull.toml")
    monkeypatch.chdir(tmp_path)
    assert ran("run", path.name, "-q", "--degree", 1) == 0
    assert (tmp_path / "pull-degree-1" / "summary.json").is_file()


def test_results_that_stand_there_are_replaced_only_when_told_so(
    tmp_path: Path, capsys: Printed
) -> None:
    words = ["run", case_file(tmp_path), "-q", "-o", tmp_path / "out"]
    assert ran(*words) == 0
    old = (tmp_path / "out").stat().st_ino
    assert ran(*words) == 2
    assert "--overwrite" in capsys.readouterr().err
    assert ran(*words, "--overwrite") == 0
    assert (tmp_path / "out").stat().st_ino != old
    assert sorted(path.name for path in tmp_path.iterdir()) == ["case.toml", "out"]


def test_an_expectation_that_is_not_met_fails_but_leaves_the_results(
    tmp_path: Path, capsys: Printed
) -> None:
    path = case_file(tmp_path, ("[0.04, 0.06]", "[0.5, 0.6]"))
    assert ran("run", path, "-q", "-o", tmp_path / "out") == 1
    out, err = capsys.readouterr()
    assert "expected middle.x from 0.5 to 0.6 (half of what the right side moves), found 0.0" in err
    assert "0 of 1 expected numbers were met" in out
    assert "NOT MET" in (tmp_path / "out" / "README.txt").read_text()


def test_an_expectation_speaks_of_its_own_degrees_only(tmp_path: Path, capsys: Printed) -> None:
    path = case_file(tmp_path, ("[0.04, 0.06]", "[0.5, 0.6]\ndegrees = [1]"))
    assert ran("run", path, "-q", "-o", tmp_path / "two") == 0
    assert ran("run", path, "-q", "-o", tmp_path / "one", "--degree", 1) == 1
    capsys.readouterr()


@pytest.mark.parametrize("degree", [0, 11, -1])
def test_a_degree_that_is_not_built_is_refused(
    degree: int, tmp_path: Path, capsys: Printed
) -> None:
    assert ran("run", case_file(tmp_path), "--degree", degree, "-o", tmp_path / "out") == 2
    err = capsys.readouterr().err
    assert f"degree = {degree}" in err
    assert "1 to 10" in err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["rum"], ["rum", "run", "--help"]),
        (["run"], ["CASE", "--help"]),
        (["run", "a.toml", "--dgree", "2"], ["--dgree", "--degree"]),
        (["run", "a.toml", "--degree", "two"], ["two", "int"]),
        (["run", "nowhere.toml"], ["no case 'nowhere.toml'"]),
        (["demo", "--size", "huge"], ["huge", "small", "large"]),
        (["mesh", "info", "nowhere.npz"], ["nowhere.npz"]),
        (["mesh", "info", "a.npz", "--surfaces", "skin"], ["'skin' is no name with a tag"]),
        (["mesh", "info", "a.npz", "--surfaces", "a=1,a=2"], ["'a' is named twice"]),
        (["mesh", "info", "a.npz", "--regions", "fat"], ["--regions: 'fat' is no name with a tag"]),
        (["mesh", "inof"], ["inof", "info"]),
    ],
)
def test_words_that_cannot_be_used_are_refused_in_one_sentence(
    words: list[str],
    said: list[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: Printed,
) -> None:
    monkeypatch.chdir(tmp_path)
    assert ran(*words) == 2
    out, err = capsys.readouterr()
    assert err.startswith("bezsoma: ")
    assert [word for word in said if word not in err] == [], err
    assert "Traceback" not in out + err


def stopped_by(error: BaseException) -> Any:
    """A solver that raises."""

    def solve(*given: Any, **options: Any) -> NoReturn:
        raise error

    return solve


@pytest.mark.parametrize(
    ("error", "status", "said"),
    [
        (NotConverged("stopped after 9 steps", [1.0]), 1, "stopped after 9 steps"),
        (KeyboardInterrupt(), 130, "stopped; nothing half-done was left behind"),
    ],
)
def test_a_run_that_does_not_end_well_leaves_nothing(
    error: BaseException,
    status: int,
    said: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: Printed,
) -> None:
    path = case_file(tmp_path)
    monkeypatch.setattr(refining, "solve", stopped_by(error))
    assert ran("run", path, "-q", "-o", tmp_path / "out") == status
    assert capsys.readouterr().err == f"bezsoma: {said}\n"
    assert [path.name for path in tmp_path.iterdir()] == ["case.toml"]


def test_being_terminated_while_writing_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Printed
) -> None:
    path = case_file(tmp_path)

    def terminated(folder: Path, *rest: Any) -> None:
        (folder / "half").write_text("half")
        os.kill(os.getpid(), signal.SIGTERM)

    monkeypatch.setattr(running, "write_results", terminated)
    before = signal.getsignal(signal.SIGTERM)
    assert ran("run", path, "-q", "-o", tmp_path / "out") == 130
    assert signal.getsignal(signal.SIGTERM) is before
    assert [path.name for path in tmp_path.iterdir()] == ["case.toml"]
    capsys.readouterr()


def test_a_mesh_is_described(tmp_path: Path, capsys: Printed) -> None:
    path = tmp_path / "block.npz"
    write_mesh(path, block(size=(2, 1, 3), cells=(2, 1, 3)))
    assert ran("mesh", "info", path) == 0
    out = capsys.readouterr().out
    assert "24 vertices, 36 tets, 44 outer facets" in out
    assert "1 piece, volume 6 mm3" in out
    assert "from (0, 0, 0) to (2, 1, 3) mm" in out
    assert "surface top" in out
    assert "dihedral, degrees    45.00" in out
    assert "mean ratio" in out


def test_tags_of_a_mesh_are_named(tmp_path: Path, capsys: Printed) -> None:
    mesh = block(size=(2, 1, 3), cells=(2, 1, 3))
    tags = np.where(mesh.points[mesh.tets].mean(axis=1)[:, 2] < 1, 1, 2)
    facets = mesh.facets_of("top")
    path = tmp_path / "tagged.npz"
    np.savez(
        path,
        points=mesh.points,
        tets=mesh.tets,
        tet_tags=tags,
        facets=facets,
        facet_tags=np.full(len(facets), 7),
    )
    assert ran("mesh", "info", path, "--surfaces", "skin=7", "--regions", "fat=1,muscle=2") == 0
    out = capsys.readouterr().out
    assert [name for name in ("surface skin", "region  fat", "region  muscle") if name in out] == [
        "surface skin",
        "region  fat",
        "region  muscle",
    ]


def test_curved_cells_of_our_own_are_told_where_their_mesh_is(
    tmp_path: Path, capsys: Printed
) -> None:
    path = case_file(tmp_path)
    assert ran("run", path, "-q", "-o", tmp_path / "out") == 0
    capsys.readouterr()
    assert ran("mesh", "info", tmp_path / "out" / "displacement.vtu") == 2
    assert "read mesh.npz beside it" in capsys.readouterr().err
    assert ran("mesh", "info", tmp_path / "out" / "mesh.npz") == 0
    capsys.readouterr()


def test_help_is_enough_to_start_from(capsys: Printed) -> None:
    assert ran("--help") == 0
    out = capsys.readouterr().out
    assert "Start with: bezsoma demo" in out
    assert all(
        word in out
        for word in ("run", "model", "demo", "mesh", "--version", "not a medical device")
    )
    assert ran("run", "--help") == 0
    out = " ".join(capsys.readouterr().out.replace("│", " ").split())
    assert "--overwrite" in out
    assert "CASE-degree-N" in out
    assert "`bezsoma demo` leaves one, case.toml" in out
    assert ran("demo", "--help") == 0
    out = " ".join(capsys.readouterr().out.replace("│", " ").split())
    assert "bezsoma-demo-SIZE" in out
    assert "The case.toml in its folder `model` is an example" in out
    assert ran() == 0
    assert "Start with" in capsys.readouterr().out


def test_the_command_itself_runs_and_does_not_wait_for_what_it_does_not_need() -> None:
    """Asked for its version it imports neither the ray tracer nor the plotting library."""
    code = (
        "import sys; from bezsoma.cli import main; status = main(['--version']); "
        "print(sorted({'matplotlib', 'embreex', 'scipy', 'numpy'} & set(sys.modules))); "
        "sys.exit(status)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    version, modules = done.stdout.splitlines()
    assert version.startswith("bezsoma ")
    assert modules == "[]"


def test_the_command_as_a_program_refuses_with_status_2(tmp_path: Path) -> None:
    words = [sys.executable, "-m", "bezsoma", "run", str(tmp_path / "case.toml")]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr.startswith("bezsoma: no case")
    assert done.stdout == ""
