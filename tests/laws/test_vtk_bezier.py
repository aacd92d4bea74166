# SPDX-License-Identifier: BSD-3-Clause
"""Bezier cells and VTKHDF files: what VTK, pyvista and meshio make of them, and of the volumes."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest

from bezsoma import bernstein
from bezsoma.errors import InputError, MissingExtra
from bezsoma.mesh import ControlNet, Field, TetMesh, block
from bezsoma.view.grid import written_form
from bezsoma.view.lagrange import vtk_order
from bezsoma.view.vtk import write_surface_vtu, write_vtu
from bezsoma.view.vtkhdf import write_vtkhdf

RNG = np.random.default_rng(3)
WRITERS = {"vtu": write_vtu, "vtkhdf": write_vtkhdf}


def given(degree: int) -> tuple[TetMesh, Field]:
    plain = block((2.0, 1.0, 1.0), 1, (30.0, -9.0, 4.0)).moved(np.eye(3) + 0.1 * np.eye(3, k=1))
    region = (plain.points[plain.tets].mean(axis=1)[:, 0] > 30.6).astype(int)
    mesh = TetMesh(plain.points, plain.tets, region, ("soft", "hard"), plain.surfaces)
    net = ControlNet(mesh, degree)
    return mesh, Field(net, RNG.normal(size=(net.count, 3)))


def read_by_vtk(path: Path) -> Any:
    vtk = pytest.importorskip("vtk", reason="VTK is not installed; it is the twin of these files")
    reader = vtk.vtkHDFReader() if path.suffix == ".vtkhdf" else vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    return reader.GetOutput()


CHOICES = [("vtu", "bezier", degree) for degree in range(1, 11)]
CHOICES += [("vtkhdf", kind, degree) for kind in ("lagrange", "bezier") for degree in (1, 2, 5)]


@pytest.mark.parametrize(("suffix", "kind", "degree"), CHOICES)
def test_vtk_evaluates_the_same_field_and_volume(
    tmp_path: Path, suffix: str, kind: Any, degree: int
) -> None:
    if suffix == "vtkhdf":
        pytest.importorskip("h5py", reason="h5py is not installed: the extra hdf")
    mesh, field = given(degree)
    path = WRITERS[suffix](tmp_path / f"a.{suffix}", mesh, {"u": field}, cells=kind)
    grid = read_by_vtk(path)
    types = {"lagrange": 71, "bezier": 78}
    assert grid.GetNumberOfCells() == len(mesh.tets)
    assert grid.GetNumberOfPoints() == field.net.count  # shared between neighbours
    data, regions = named(grid.GetPointData(), "u"), named(grid.GetCellData(), "region")
    turned = mesh.oriented_tets[:, 3] != mesh.tets[:, 3]
    points, volumes = RNG.dirichlet(np.ones(4), 3 if degree < 4 else 1), []
    for number in range(len(mesh.tets)):
        cell = grid.GetCell(number)
        assert cell.GetCellType() == (10 if degree == 1 else types[kind])
        assert regions[number] == mesh.region[number]
        order = [0, 1, 3, 2] if turned[number] else [0, 1, 2, 3]
        mine = data[[cell.GetPointId(k) for k in range(cell.GetNumberOfPoints())]]
        for bary in points:
            where, weights = place_and_weights(cell, bary[order])
            assert where == pytest.approx(bary @ mesh.points[mesh.tets[number]], abs=1e-9)
            wanted = field.at_bary(np.array([number]), bary[None])[0]
            assert weights @ mine == pytest.approx(wanted, abs=1e-9)
        corners = np.array([cell.GetPoints().GetPoint(k) for k in range(4)])
        volumes.append(np.linalg.det(corners[1:] - corners[0]) / 6)
    assert np.allclose(volumes, mesh.volumes)


def named(data: Any, name: str) -> np.ndarray:
    from vtkmodules.util.numpy_support import vtk_to_numpy

    return np.asarray(vtk_to_numpy(data.GetArray(name)))


def place_and_weights(cell: Any, bary: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Where VTK puts a barycentric point of a cell, and how it weighs the data there."""
    from vtkmodules.vtkCommonCore import reference

    where, weights = [0.0] * 3, [0.0] * cell.GetNumberOfPoints()
    cell.EvaluateLocation(reference(0), list(bary[1:]), where, weights)
    return np.array(where), np.array(weights)


@pytest.mark.parametrize("degree", [2, 3, 5])
def test_bezier_triangles_hold_the_controls_of_their_surface(tmp_path: Path, degree: int) -> None:
    mesh, field = given(degree)
    grid = read_by_vtk(
        write_surface_vtu(tmp_path / "s.vtu", mesh, {"u": field}, "top", cells="bezier")
    )
    data = named(grid.GetPointData(), "u")
    surface = field.on_surface("top")
    for number, turn in enumerate(surface.turns):
        cell = grid.GetCell(number)
        assert cell.GetCellType() == 76
        mine = data[[cell.GetPointId(k) for k in range(cell.GetNumberOfPoints())]]
        order = vtk_order(degree, 2, bool(turn < 0))
        assert np.allclose(mine, surface.controls[number][order], atol=1e-12)


def test_cells_of_another_degree_hold_the_same_field_or_its_interpolant() -> None:
    controls = RNG.normal(size=(10, 1))
    bary = RNG.dirichlet(np.ones(3), 7)
    for kind in ("lagrange", "bezier"):
        higher = written_form(kind, 3, 6, 2) @ controls  # type: ignore[arg-type]
        lower = written_form(kind, 3, 2, 2) @ controls  # type: ignore[arg-type]
        if kind == "lagrange":
            higher = bernstein.interpolation(6, 2) @ higher
            lower = bernstein.interpolation(2, 2) @ lower
        assert np.allclose(bernstein.values(6, bary) @ higher, bernstein.values(3, bary) @ controls)
        rim = bernstein.domain_points(2, 2)
        assert np.allclose(bernstein.values(2, rim) @ lower, bernstein.values(3, rim) @ controls)


def test_a_broken_field_keeps_both_sides_in_either_file(tmp_path: Path) -> None:
    pytest.importorskip("h5py", reason="h5py is not installed: the extra hdf")
    mesh, field = given(3)
    stress = field.gradient_field()
    grids = [
        read_by_vtk(
            write(tmp_path / f"g.{suffix}", mesh, {"H": stress, "u": field}, cells="bezier")
        )
        for suffix, write in WRITERS.items()
    ]
    first, second = (named(grid.GetPointData(), "H") for grid in grids)
    assert first.shape == (len(mesh.tets) * 20, 9) and np.array_equal(first, second)
    words = [named(grid.GetFieldData(), "metadata").tobytes() for grid in grids]
    assert words[0] == words[1] and json.loads(words[0])["point data"] == "controls"
    assert json.loads(words[0])["regions"] == ["soft", "hard"]


@pytest.mark.parametrize("suffix", WRITERS)
def test_pyvista_sees_the_same_points_and_volumes(tmp_path: Path, suffix: str) -> None:
    pyvista = pytest.importorskip("pyvista", reason="pyvista is not installed")
    mesh, field = given(3)
    for kind in ("lagrange", "bezier"):
        path = WRITERS[suffix](tmp_path / f"{kind}.{suffix}", mesh, {"u": field}, cells=kind)
        read = pyvista.read(path)
        assert read.n_cells == len(mesh.tets) and read.n_points == field.net.count
        if kind == "lagrange":
            assert np.allclose(read.compute_cell_sizes()["Volume"], mesh.volumes)
            assert np.allclose(read["u"], field.at(np.asarray(read.points)), atol=1e-9)
        else:
            order = np.lexsort(np.asarray(read.points).round(9).T)
            ours = np.lexsort(field.net.points.round(9).T)
            assert np.allclose(read["u"][order], field.controls[ours])


def test_meshio_reads_values_and_volumes_of_lagrange_cells(tmp_path: Path) -> None:
    mesh, field = given(4)
    read = meshio.read(write_vtu(tmp_path / "a.vtu", mesh, {"u": field}))
    corners = read.points[read.cells[0].data[:, :4]]
    assert np.allclose(np.linalg.det(corners[:, 1:] - corners[:, :1]) / 6, mesh.volumes)
    assert np.allclose(read.point_data["u"], field.at(read.points), atol=1e-10)


# Refusals


def test_other_cells_and_names_are_refused(tmp_path: Path) -> None:
    mesh, field = given(2)
    with pytest.raises(InputError, match=r"no kind of cells 'bezir'.*did you mean 'bezier'"):
        write_vtu(tmp_path / "a.vtu", mesh, field, cells="bezir")  # type: ignore[arg-type]
    pytest.importorskip("h5py", reason="h5py is not installed: the extra hdf")
    with pytest.raises(InputError, match="stands between folders"):
        write_vtkhdf(tmp_path / "a.vtkhdf", mesh, {"u/v": field})
    assert list(tmp_path.iterdir()) == []


def test_without_h5py_the_message_says_what_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "h5py", None)
    with pytest.raises(MissingExtra, match=r"pip install 'bezsoma\[hdf\]'"):
        write_vtkhdf(tmp_path / "a.vtkhdf", *given(1))
    assert list(tmp_path.iterdir()) == []
