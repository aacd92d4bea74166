# SPDX-License-Identifier: BSD-3-Clause
"""A case with a pressure of its own: what it leaves in its folder, and how that is read back."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import bezsoma as bz
from bezsoma.mesh import block
from bezsoma.mesh.files import write_mesh
from cases.written import case_file

WATER = ("nu = 0.3", "nu = 0.5")
MIXED = ("degree = 2", "degree = 2\nincompressible = true")
DRAWN = ("pictures = []", 'pictures = ["front"]\nfields = ["pressure", "determinant"]')


def test_the_pressure_is_written_pictured_and_read_back(tmp_path: Path) -> None:
    expect = '[[expect]]\nof = "middle.pressure"\nbetween = [-1, 0]\nsource = "drawn"\n\n'
    expect += '[solver]\nmethod = "direct"\n\n[output]'
    path = case_file(tmp_path, WATER, MIXED, DRAWN, ("[output]", expect))
    results = bz.run_case(path, tmp_path / "out")
    again = bz.read_results(tmp_path / "out")
    assert isinstance(results.pressure, bz.Field) and isinstance(again.pressure, bz.Field)
    assert again.pressure.degree == 1
    assert (again.pressure.controls == results.pressure.controls).all()
    summary = again.summary
    assert all(check["met"] for check in summary["expectations"])
    assert summary["pressure_degree"] == 1
    assert summary["pressure_level"].startswith("determined")
    assert abs(summary["volume_change"]) < 1e-12
    names = ("pressure-front.png", "determinant-front.png", "before-after-front.png")
    assert set(names) <= set(summary["files"]) and set(names) == set(summary["pictures"])
    assert b'Name="pressure"' in (tmp_path / "out" / "displacement.vtu").read_bytes()
    text = (tmp_path / "out" / "README.txt").read_text(encoding="utf-8")
    assert "Pressure of degree 1" in text and "not zero at small strain" in text
    assert "pressure on the displaced surface" in text


def test_a_pressure_that_breaks_is_read_back(tmp_path: Path) -> None:
    plain = block((2.0, 1.0, 1.0), cells=(2, 1, 1))
    region = (plain.points[plain.tets].mean(axis=1)[:, 0] > 1).astype(int)
    mesh = bz.TetMesh(plain.points, plain.tets, region, ("soft", "hard"), plain.surfaces)
    write_mesh(tmp_path / "two.npz", mesh)
    path = case_file(
        tmp_path,
        (
            'solid = "block"\nparameters = { size = [2, 1, 1], cells = [2, 1, 1] }',
            'file = "two.npz"',
        ),
        (
            "[materials.tissue]\nE = 0.015\nnu = 0.3",
            "[materials.soft]\nE = 0.015\nnu = 0.5\n[materials.hard]\nE = 1.5\nnu = 0.3",
        ),
        ("degree = 2", "degree = 3\npressure_degree = 2\npressure_breaks = true"),
    )
    results = bz.run_case(path, tmp_path / "out")
    again = bz.read_results(tmp_path / "out")
    assert isinstance(again.pressure, bz.BrokenField) and isinstance(
        results.pressure, bz.BrokenField
    )
    assert (again.pressure.controls == results.pressure.controls).all()
    inside = again.pressure.at(np.array([[0.999, 0.5, 0.4], [1.001, 0.5, 0.4]]))
    assert abs(inside[0] - inside[1]) > 1e-3


def test_held_tets_are_told_and_split(tmp_path: Path) -> None:
    """The two ends of a block of two cells hold all vertices of some tets."""
    cells = ("cells = [2, 1, 1]", "cells = [1, 1, 1]")
    told = bz.run_case(case_file(tmp_path, WATER, MIXED, cells), tmp_path / "told")
    assert told.summary["held_tets"] > 0
    assert "split_held_tets" in told.summary["warnings"][0]
    key = ("degree = 2", "degree = 2\nsplit_held_tets = true\nincompressible = true")
    split = bz.run_case(case_file(tmp_path, WATER, key, cells), tmp_path / "split")
    assert split.summary["held_tets"] == 0 and split.summary["warnings"] == []
    assert len(split.mesh.tets) > len(told.mesh.tets)


@pytest.mark.parametrize("harm", ["missing", "cut", "other"])
def test_a_damaged_pressure_is_refused(harm: str, tmp_path: Path) -> None:
    bz.run_case(case_file(tmp_path, WATER, MIXED), tmp_path / "out")
    file = tmp_path / "out" / "pressure.npz"
    content = file.read_bytes()
    file.unlink()
    if harm == "cut":
        file.write_bytes(content[:100])
    if harm == "other":
        np.savez(file, degree=2, controls=np.zeros(5), of_tet=np.zeros((2, 10), int))
    with pytest.raises(bz.InputError, match=r"damaged|does not fit"):
        bz.read_results(tmp_path / "out")
