# SPDX-License-Identifier: BSD-3-Clause
"""A case file says the same as Python does, and its results come back bit for bit."""

from __future__ import annotations

import json
from math import radians
from pathlib import Path

import numpy as np
import pytest

import bezsoma as bz
import tolerances
from bezsoma.case.build import made
from bezsoma.case.quantities import Measured
from bezsoma.case.sources import found
from bezsoma.errors import MissingExtra
from bezsoma.view import rays
from cases.written import BLOCK, case_file


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the case, its results and nothing else."""
    folder = tmp_path_factory.mktemp("block")
    pictures = ("pictures = []", 'stress = true\npictures = "front"')
    exact = ("[output]", '[solver]\nmethod = "direct"\n\n[output]')
    case = bz.read_case(case_file(folder, pictures, exact))
    bz.run_case(case, folder / "out")
    return folder


def body() -> bz.Body:
    """The same block in Python."""
    return bz.Body(
        bz.block(size=(2, 1, 1), cells=(2, 1, 1)),
        degree=2,
        materials=bz.LinearElastic(E=0.015, nu=0.3),
        supports=[bz.Fixed("left"), bz.Moved("right", translation=(0.1, 0, 0))],
        loads=[bz.Traction("top", value=bz.Polynomial.parse([0, 0, "1e-5*x"]))],
    )


def test_a_case_is_what_python_says(folder: Path) -> None:
    solution = bz.solve(body(), solver="direct")
    results = bz.read_results(folder / "out")
    difference = results.displacement.controls - solution.displacement.controls
    assert np.abs(difference).max() <= tolerances.TWIN * 0.1
    assert results.summary["energy"] == pytest.approx(solution.energy, rel=tolerances.TWIN)


def test_results_come_back_without_loss(tmp_path: Path) -> None:
    case = bz.read_case(case_file(tmp_path))
    left = bz.run_case(case, tmp_path / "out")
    back = bz.read_results(tmp_path / "out")
    assert back.displacement.controls.tobytes() == left.displacement.controls.tobytes()
    assert back.mesh.points.tobytes() == left.mesh.points.tobytes()
    assert np.array_equal(back.mesh.tets, left.mesh.tets)
    assert back.mesh.regions == left.mesh.regions
    assert list(back.mesh.places) == list(left.mesh.places)
    for name in left.mesh.surfaces:
        assert np.array_equal(back.mesh.facets_of(name), left.mesh.facets_of(name))
    assert back.summary == json.loads(json.dumps(left.summary))
    assert back.case == left.case == case.text
    points = np.array([[0.3, 0.4, 0.5]])
    assert back.displacement.at(points).tobytes() == left.displacement.at(points).tobytes()


def test_the_case_is_kept_byte_for_byte(tmp_path: Path) -> None:
    path = tmp_path / "case.toml"
    path.write_bytes(BLOCK.replace("\n", "\r\n").replace("A block", "Ein Würfel").encode())
    bz.run_case(bz.read_case(path), tmp_path / "out")
    assert (tmp_path / "out" / "case.toml").read_bytes() == path.read_bytes()
    assert bz.read_results(tmp_path / "out").case.encode() == path.read_bytes()


def test_the_summary_has_what_a_reader_asks_for(folder: Path) -> None:
    summary = bz.read_results(folder / "out").summary
    assert summary["degree"] == 2
    assert summary["sizes"]["tets"] == 12
    assert summary["versions"]["bezsoma"] == bz.__version__
    assert "not a medical device" in summary["notice"]
    assert summary["largest_displacement"] == pytest.approx(0.1, rel=1e-3)
    assert set(summary["reactions"]) >= {"left", "right"}
    assert summary["probes"]["middle"]["displacement"][0] == pytest.approx(0.05, rel=0.05)
    assert summary["residual"] < 1e-8
    pulled = summary["reactions"]["right"]["force"][0] + summary["reactions"]["left"]["force"][0]
    assert pulled == pytest.approx(0, abs=1e-12)


def test_every_file_is_explained(folder: Path) -> None:
    text = (folder / "out" / "README.txt").read_text()
    names = [path.name for path in (folder / "out").iterdir()]
    assert {"before-after-front.png", "displacement.vtu", "summary.json"} <= set(names)
    assert [name for name in names if name not in text] == []
    assert "see the documentation" not in text


def test_pictures_and_curved_cells_are_written(folder: Path) -> None:
    picture = (folder / "out" / "before-after-front.png").read_bytes()
    assert picture.startswith(b"\x89PNG")
    assert len(picture) > 10_000
    vtu = (folder / "out" / "displacement.vtu").read_text(errors="replace")
    assert "stress" in vtu


def test_quantities_are_taken_from_the_solution() -> None:
    """A uniform stretch has everything in closed form."""
    E, nu, stretch = 2.0, 0.25, 0.01
    law = bz.LinearElastic(E=E, nu=nu)
    value = bz.Polynomial.parse([f"{stretch}*x", 0, 0])
    mesh = bz.block(size=(2, 1, 1))
    sides = bz.Prescribed(*mesh.surfaces, value=value)
    solution = bz.solve(bz.Body(mesh, 2, law, [sides]), solver="direct")
    measured = Measured(solution, {"p": np.array([1.0, 0.5, 0.25])})
    along, across = (law.lam + 2 * law.mu) * stretch, law.lam * stretch
    expected = {
        "energy": along * stretch * 2 / 2,
        "volume_change": 2 * stretch,
        "largest_displacement": 2 * stretch,
        "p.x": stretch,
        "p.size": stretch,
        "p.strain.xx": stretch,
        "p.stress.xx": along,
        "p.stress.yy": across,
        "p.von_mises": along - across,
    }
    found = {name: measured.number(name) for name in expected}
    assert found == pytest.approx(expected, rel=tolerances.TWIN)
    assert measured.number("p.stress.xy") == pytest.approx(0, abs=1e-12)
    assert measured.number("p.y") == pytest.approx(0, abs=1e-12)


def test_reactions_are_asked_for_by_place() -> None:
    """A bar pulled without lateral hold: the force is E A strain, its moment about the origin."""
    mesh = bz.block(size=(2, 1, 1))
    supports = [bz.Fixed("left", components="x"), bz.Fixed("front", components="y")]
    supports += [bz.Fixed("bottom", components="z")]
    supports += [bz.Moved("right", translation=(0.02, 0, 0), components="x")]
    solution = bz.solve(bz.Body(mesh, 2, bz.LinearElastic(E=2.0, nu=0.25), supports))
    measured = Measured(solution, {})
    expected = {
        "reaction.right.x": 0.02,
        "reaction.left.x": -0.02,
        "reaction.right.size": 0.02,
        "moment.right.y": 0.01,
        "moment.right.z": -0.01,
    }
    found = {name: measured.number(name) for name in expected}
    assert found == pytest.approx(expected, rel=tolerances.TWIN)


def test_degrees_of_a_turn_become_radians(tmp_path: Path) -> None:
    turned = ("translation = [0.1, 0, 0]", "degrees = 30\naxis = [0, 0, 2]\nabout = [1, 2, 3]")
    support = made(bz.read_case(case_file(tmp_path, turned)).file.support[1])
    assert support.angle == radians(30)
    at = np.array([[2.0, 2.0, 3.0]])
    assert at + support.displacement(at) == pytest.approx(
        np.array([[1 + np.cos(np.pi / 6), 2.5, 3.0]])
    )


def test_every_kind_of_table_is_built_and_solved(tmp_path: Path) -> None:
    extra = """
[[support]]
type = "prescribed"
on = "back"
components = "y"
value = [0, "0.01*x*z", 0]

[[join]]
type = "graded"
over = "back"
to = "left"
band = 0.9

[[join]]
type = "precedence"
place = "right"
over = "back"

[[load]]
type = "pressure"
on = "bottom"
value = "1e-6 + 1e-6*y"

[[load]]
type = "body"
value = [0, 0, -1.03e-5]
regions = "tissue"

[[load]]
type = "point"
at = "corner"
force = [0, 0, 1e-6]

[[load]]
type = "point"
at = [1, 0, 1]
force = [0, 0, 1e-6]

[solver]
method = "cg"
rtol = 1e-10

[[probe]]
name = "above"
point = [1, 0.5, 1.5]
on = "top"

[[probe]]
name = "vertex"
point = "corner"
"""
    places = "\n[mesh.vertices]\ncorner = [1, 0, 0]\n\n[mesh.edges]\nrim = [[0, 0, 1], [1, 0, 1]]\n"
    path = case_file(
        tmp_path, ("[[probe]]", extra + "\n[[probe]]"), ("\n[materials", places + "\n[materials")
    )
    results = bz.run_case(bz.read_case(path), tmp_path / "out")
    assert "conjugate gradients" in results.summary["method"]
    above = results.summary["probes"]["above"]
    assert above["point"] == [1, 0.5, 1]
    assert above["off_by"] == 0.5
    assert results.summary["probes"]["vertex"]["point"] == [1, 0, 0]
    assert results.summary["probes"]["vertex"]["off_by"] == 0
    assert "rim" in results.mesh.places


LOOK_ALIKES = {
    "whole numbers for numbers": [("nu = 0.3", "nu = 0"), ("[0.1, 0, 0]", "[1, 0, 0]")],
    "one name with and without brackets": [('on = "left"', 'on = ["left"]')],
    "moduli by name": [("E = 0.015\nnu = 0.3", "G = 0.005\nkappa = 0.01")],
    "a constant as a formula": [('"1e-5*x"', '"1e-5"')],
    "components in another order": [('on = "left"', 'on = "left"\ncomponents = "zxy"')],
    "lines ended as on Windows": [("\n", "\r\n")],
    "a comment after a header": [("[mesh]", "[mesh] # where the [tets] come from")],
}


@pytest.mark.parametrize("kind", LOOK_ALIKES)
def test_what_looks_wrong_and_is_right_is_accepted(kind: str, tmp_path: Path) -> None:
    case = bz.read_case(case_file(tmp_path, *LOOK_ALIKES[kind]))
    assert len(case.file.support) == 2
    assert case.file.support[0].components == "xyz"


def test_a_body_without_loads_that_is_held_stays_where_it_is(tmp_path: Path) -> None:
    changes = ('type = "moved"', 'type = "fixed"'), ("translation = [0.1, 0, 0]\n", "")
    still = ('value = [0, 0, "1e-5*x"]', "value = [0, 0, 0]"), ("[0.04, 0.06]", "[0, 0]")
    results = bz.run_case(bz.read_case(case_file(tmp_path, *changes, *still)), tmp_path / "out")
    assert not results.displacement.controls.any()
    assert results.summary["expectations"][0]["met"]


def test_what_may_not_be_meant_is_said(tmp_path: Path) -> None:
    far = ("point = [1, 0.5, 0.5]", 'point = [1, 0.5, 2]\non = "top"')
    case = bz.read_case(case_file(tmp_path, far))
    results = bz.run_case(case, tmp_path / "out")
    assert results.summary["warnings"] == ["the probe 'middle' was taken to its surface over 1 mm"]
    assert "Beware: the probe 'middle'" in (tmp_path / "out" / "README.txt").read_text()


def test_data_is_looked_for_beside_the_case_first(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    homes = {name: tmp_path / name for name in ("case", "variable", "folder")}
    for home in homes.values():
        home.mkdir()
        (home / "face.npz").touch()
    monkeypatch.setenv("BEZSOMA_DATA", str(homes["variable"]))
    for home in homes.values():
        assert found("face.npz", "../folder", homes["case"]) == home / "face.npz"
        (home / "face.npz").unlink()


def test_the_cases_on_offer_are_sound(root: Path) -> None:
    """Every case of the project can be read; whether its numbers hold is for others to say."""
    cases = sorted((root / "cases").rglob("*.toml"))
    assert len(cases) >= 4
    assert [bz.read_case(path).title for path in cases]


def test_the_head_by_formula_is_a_case_like_any_other(root: Path, tmp_path: Path) -> None:
    case = bz.read_case(root / "cases" / "head_phantom.toml")
    assert case.file.degree == 3
    assert case.file.support[1].translation == (0, -6, 0)
    path = tmp_path / "again.toml"
    path.write_text(case.text)
    assert bz.read_case(path).file == case.file


def test_nothing_is_lost_where_no_picture_can_be_drawn(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Some platforms have no wheel of what draws."""

    def absent() -> None:
        raise MissingExtra("pictures need the package embreex")

    monkeypatch.setattr(rays, "_embree", absent)
    results = bz.run_case(
        bz.read_case(case_file(tmp_path, ("pictures = []", 'pictures = "front"'))), tmp_path / "out"
    )
    assert results.summary["pictures"] == []
    assert any("no pictures were drawn" in text for text in results.summary["warnings"])
    assert "no pictures were drawn" in (tmp_path / "out" / "README.txt").read_text()
    assert (tmp_path / "out" / "displacement.vtu").exists()
