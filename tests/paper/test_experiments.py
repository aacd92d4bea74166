# SPDX-License-Identifier: BSD-3-Clause
"""The paper's figures as experiments: quick runs give the numbers that docs/experiments prints."""

from __future__ import annotations

import csv
import re
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import bezsoma as bz
from bezsoma import cli
from bezsoma.errors import InputError
from bezsoma.experiments import EXPERIMENTS, faces, figure_9
from bezsoma.experiments.report import Table, Tables, shown
from bezsoma.experiments.run import experiment, run_experiment

ON_PAPER = ("figure_2", "figure_4", "figure_5", "figure_6", "figure_7", "figure_8", "locking")
ON_A_FACE = ("figure_9", "degree_or_mesh")
SHELF = Path("docs/experiments")


def printed(path: Path) -> list[dict[str, str]]:
    """The rows of a CSV file."""
    with path.open(newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def held(table: Table, path: Path) -> None:
    """Each row of a quick run is that of the table that is printed, as far as the table says."""
    rows = {table.key(row): row for row in printed(path)}
    assert len(rows) >= len(table.rows) > 0
    for row in table.rows:
        wanted = rows[table.key(vars(row))]
        for column, within in table.held.items():
            found, number = float(getattr(row, column)), float(wanted[column])
            assert found == pytest.approx(number, rel=within, abs=1e-12), (wanted, column)


@pytest.mark.parametrize("name", ON_PAPER)
def test_a_figure_gives_its_numbers(name: str, root: Path) -> None:
    for file, table in experiment(name).measured(quick=True).items():
        assert table.held
        held(table, root / SHELF / name / f"{file}.csv")


@pytest.mark.real_data
@pytest.mark.parametrize("name", ON_A_FACE)
def test_a_face_gives_its_numbers(
    name: str, root: Path, data: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("BEZSOMA_DATA", str(data))
    for file, table in experiment(name).measured(quick=True).items():
        held(table, root / SHELF / name / f"{file}.csv")


@pytest.mark.real_data
def test_the_laws_of_the_face_give_their_numbers(
    root: Path, data: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("BEZSOMA_DATA", str(data))
    page = (root / "docs/verification/face_laws.md").read_text(encoding="utf-8")
    tables = experiment("face_laws").measured(quick=True)
    held(tables["laws"], root / SHELF / "face_laws" / "laws.csv")
    for row in tables["laws"].rows:
        line = re.search(rf"^\| {row.motion} \| 2 \| {row.law} \|(.+)$", page, re.MULTILINE)
        assert line
        wanted = [float(cell.split()[0]) for cell in line[1].split("|")[:3]]
        assert [row.chin, row.lower_lip, row.cheek] == pytest.approx(wanted, abs=0.006)
        moves = tables["moves"].where(motion=row.motion, law=row.law)
        parts = re.findall(r"\(([^)]+)\)", line[1])
        for move, text in zip(moves, parts, strict=True):
            components = [float(number) for number in text.split(",")]
            assert [move.x, move.y, move.z] == pytest.approx(components, abs=0.006)


@pytest.mark.parametrize("name", EXPERIMENTS)
def test_a_page_prints_what_its_files_hold(name: str, root: Path) -> None:
    folder = root / SHELF / name
    page = (folder / "README.md").read_text(encoding="utf-8")
    files = sorted(folder.glob("*.csv"))
    assert files
    for file in files:
        for row in printed(file):
            line = " | ".join(as_shown(cell) for cell in row.values())
            assert f"| {line} |" in page, (file.name, line)
    assert set(re.findall(r"\]\((\w+\.png)\)", page)) == {
        each.name for each in folder.glob("*.png")
    }


def as_shown(cell: str) -> str:
    """A cell of a CSV file as the page has it."""
    return shown(read(cell))


def read(cell: str) -> int | float | str:
    """What stands in a cell of a CSV file."""
    for kind in (int, float):
        try:
            return kind(cell)
        except ValueError:
            continue
    return cell


def stored(folder: Path) -> dict[str, Table]:
    """The tables that stand beside a page."""
    return {
        file.stem: Table(
            "",
            [SimpleNamespace(**{k: read(v) for k, v in row.items()}) for row in printed(file)],
            (),
        )
        for file in folder.glob("*.csv")
    }


@pytest.mark.parametrize("name", EXPERIMENTS)
def test_a_page_says_what_its_numbers_say(name: str, root: Path) -> None:
    """Every word of what is found, made again from the stored tables, seconds with them."""
    page = (root / SHELF / name / "README.md").read_text(encoding="utf-8")
    found = re.search(r"## What is found\n\n(.+?)\n\n(?:!\[|## )", page, re.DOTALL)
    assert found
    assert found[1] == experiment(name).finding(stored(root / SHELF / name))


def grows_without_end(tables: Tables) -> bool:
    """Figure 6: at a point with every degree; on squares by ever less."""
    point, square = (
        [r.middle for r in tables["by_degree"].where(support=s, force=1.0)]
        for s in ("points", "squares")
    )
    steps = np.diff(square)
    return bool((np.diff(point) > 0).all() and (steps > 0).all() and steps[-1] < steps[0] / 10)


def doubles(tables: Tables) -> bool:
    """Figure 7: twice the force gives twice of everything; no volume is lost at nu = 1/2."""
    parts = ("middle", "least_pressure", "largest_pressure", "volume")
    once, twice = (
        np.array([[getattr(r, part) for part in parts] for r in tables["compared"].where(force=f)])
        for f in (1.0, 2.0)
    )
    lost = [abs(r.volume) for r in tables["compared"].where(nu=0.5)]
    return bool(np.allclose(twice, 2 * once, rtol=1e-9, atol=1e-12)) and max(lost) < 1e-12


def bends(tables: Tables) -> bool:
    """Figure 8: the linear law is in proportion, every other is below it and flattens."""
    per_newton: dict[tuple[str, str], list[float]] = {}
    for r in tables["laws"].rows:
        if r.borne == 1:
            per_newton.setdefault((r.support, r.law), []).append(r.largest / r.force)
    linear = {key: of for key, of in per_newton.items() if key[1] == "linear"}
    others = [of for key, of in per_newton.items() if key not in linear]
    return all(np.ptp(of) < 1e-9 * of[0] for of in linear.values()) and all(
        after < before for of in others for before, after in pairwise(of)
    )


def tissue_matters_more(tables: Tables) -> bool:
    """Figure 9: laws are farther apart than degree 2 is from 3, on both faces."""
    _, small, large, *laws = tables["apart"].rows
    return min(r.mean for r in laws) > max(small.mean, large.mean)


def locks_less(tables: Tables) -> bool:
    """Locking: at nu = 0.4999 the displacement form misses less with every degree."""
    missing = [r.deficit for r in tables["locking"].where(form="displacement", nu=0.4999)]
    return len(missing) == 6 and bool((np.diff(missing) < 0).all())


@pytest.mark.parametrize(
    ("name", "so"),
    [
        ("figure_6", grows_without_end),
        ("figure_7", doubles),
        ("figure_8", bends),
        ("figure_9", tissue_matters_more),
        ("locking", locks_less),
    ],
)
def test_what_a_page_says_without_a_number_is_so(
    name: str, so: Callable[[Tables], bool], root: Path
) -> None:
    assert so(stored(root / SHELF / name))


def rows(root: Path, name: str, file: str, **known: str) -> list[dict[str, str]]:
    """The rows of a printed table with these entries."""
    found = printed(root / SHELF / name / f"{file}.csv")
    return [row for row in found if all(row[k] == v for k, v in known.items())]


@pytest.mark.parametrize(
    ("support", "force", "wanted"),
    [("points", "1.0", [0.74, 1.97, 3.58]), ("squares", "1.0", [0.156, 0.219, 0.234, 0.239])],
)
def test_figure_6_has_the_known_values(
    support: str, force: str, wanted: list[float], root: Path
) -> None:
    """docs/theory/errata.md: of the block by degree, found by an independent prototype."""
    found = [
        float(r["middle"])
        for r in rows(root, "figure_6", "by_degree", support=support, force=force)
    ]
    assert found[: len(wanted)] == pytest.approx(wanted, rel=5e-3)


def test_figure_6_has_no_limit_under_a_point_force(root: Path) -> None:
    """Halving the mesh doubles it (0.37, 0.74, 1.53, 3.11 mm), again and again."""
    found = rows(root, "figure_6", "by_mesh", support="points", degree="1")
    assert [float(r["middle"]) for r in found] == pytest.approx([0.37, 0.74, 1.53, 3.11], rel=0.015)
    assert all(1.95 < float(r["ratio"]) < 2.15 for r in found[1:])


def test_figure_7_is_somewhat_stiffer_in_the_same_form(root: Path) -> None:
    for support, least, most in (("points", 0.0, 0.02), ("squares", 0.1, 0.3)):
        found = rows(root, "figure_7", "compared", support=support, force="1.0", form="mixed")
        soft, stiff = (float(row["middle"]) for row in found)
        assert least < 1 - stiff / soft < most
        assert abs(float(found[1]["volume"])) < 1e-12


def test_figure_8_bends_by_the_reading(root: Path) -> None:
    """Frobenius takes 42 % off, the mean 8 %: docs/theory/errata.md, of the same block."""
    found = {
        r["law"]: float(r["largest"])
        for r in rows(root, "figure_8", "laws", support="squares", force="20.0")
    }
    assert 1 - found["Frobenius"] / found["linear"] == pytest.approx(0.42, abs=0.005)
    assert 1 - found["mean"] / found["linear"] == pytest.approx(0.08, abs=0.005)
    assert found["Frobenius, engineering shears"] < found["Frobenius"]


def test_degree_two_is_first_to_a_tenth_of_a_millimetre(root: Path) -> None:
    found = rows(root, "degree_or_mesh", "runs")
    worst = [max(float(r[k]) for k in ("chin", "lower_lip", "upper_lip")) for r in found]
    good = [r for r, far in zip(found, worst, strict=True) if far <= 0.1]
    best = min(good, key=lambda r: int(r["unknowns"]))
    assert (best["mesh"], best["degree"]) == ("as it is", "2")


def test_the_command_leaves_a_page(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "five"
    assert cli.main(["experiment", "figure_5", "--output", str(folder)]) == 0
    assert "README.md" in capsys.readouterr().out
    assert {path.suffix for path in folder.iterdir()} == {".md", ".csv", ".png"}
    assert cli.main(["experiment", "figure_5", "--output", str(folder)]) == 2
    assert "--overwrite" in capsys.readouterr().err
    assert cli.main(["experiment", "figure_5", "--output", str(folder), "--overwrite"]) == 0
    quick = ["experiment", "figure_5", "--output", str(folder), "--overwrite", "--quick"]
    assert cli.main(quick) == 2
    assert "the page of a whole run" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("what", "said"),
    [
        ("a file", "is a file, not a folder"),
        ("below a file", "is a file, not a folder"),
        ("somebody's notes", "['README.md', 'notes.txt'], which no experiment wrote"),
        ("a folder of their name", "['README.md'], which no experiment wrote"),
        ("a" * 300, "File name too long"),
    ],
)
def test_a_place_that_is_not_its_own_is_left_alone_before_any_work(
    what: str,
    said: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(experiment("figure_5"), "measured", lambda quick: pytest.fail("worked"))
    (tmp_path / "notes.txt").write_text("mine")
    (tmp_path / "README.md").write_text("mine too")
    places = {"a file": "notes.txt", "below a file": "notes.txt/five", "somebody's notes": "."}
    folder = places.get(what, what)
    if what == "a folder of their name":
        (tmp_path / folder / "README.md").mkdir(parents=True)
    command = ["experiment", "figure_5", "--overwrite", "--output", str(tmp_path / folder)]
    assert cli.main(command) == 2
    heard = capsys.readouterr().err
    assert said in heard and ("name another" in heard or "choose another" in heard)
    assert (tmp_path / "README.md").read_text() == "mine too"


def test_the_command_lists_what_there_is(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["experiment"]) == 0
    assert set(EXPERIMENTS) <= set(capsys.readouterr().out.split())
    assert cli.main(["experiment", "figure_10"]) == 2
    assert "did you mean" in capsys.readouterr().err


def test_every_experiment_is_on_the_shelf(root: Path) -> None:
    modules = {p.stem for p in (root / "src/bezsoma/experiments").glob("figure_*.py")}
    assert modules <= set(EXPERIMENTS)
    index = (root / SHELF / "index.md").read_text(encoding="utf-8")
    for name in EXPERIMENTS:
        assert (root / SHELF / name / "README.md").exists() or f"`{name}`" in index


def test_without_real_data_a_phantom_stands_in(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for cached in (faces.face, figure_9.chosen, figure_9.solved):
        cached.cache_clear()
    monkeypatch.setenv("BEZSOMA_DATA", str(tmp_path))
    monkeypatch.chdir(tmp_path)
    try:
        row = figure_9.row("part", "linear, nu = 0.25", 2)
        assert row.face.startswith("phantom")
        assert 0 < row.upper_lip < row.lower_lip < row.chin < 1.2 * faces.FORWARD
        with pytest.raises(InputError, match="BEZSOMA_DATA"):
            run_experiment("face_laws", tmp_path / "laws", quick=True)
    finally:
        for cached in (faces.face, figure_9.chosen, figure_9.solved):
            cached.cache_clear()


def test_a_face_in_eighths_is_the_same_body() -> None:
    whole = faces.Face("phantom", bz.head_phantom("small"), {})
    fine = faces.eighths(whole).mesh
    assert len(fine.tets) == 8 * len(whole.mesh.tets)
    assert fine.volumes.sum() == pytest.approx(whole.mesh.volumes.sum(), rel=1e-13)
    for name, facets in whole.mesh.surfaces.items():
        area = fine.areas(fine.facets_of(name)).sum()
        assert area == pytest.approx(whole.mesh.areas(facets).sum(), rel=1e-12)
        assert np.isin(fine.facets_of(name), fine.vertices_of(name)).all()
