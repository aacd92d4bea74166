# SPDX-License-Identifier: BSD-3-Clause
"""VTU files: the order of VTK's points, values and geometry read back, what is refused."""

from __future__ import annotations

import json
import os
import stat
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import meshio
import numpy as np
import pytest

from bezsoma.bernstein import count, domain_points, interpolation, values
from bezsoma.errors import InputError
from bezsoma.mesh import BrokenField, ControlNet, Field, TetMesh, ball, block, read_mesh
from bezsoma.mesh.foreign import listing_of
from bezsoma.mesh.tagged import mesh_of
from bezsoma.view.lagrange import lattice, vtk_order
from bezsoma.view.vtk import write_surface_vtu, write_vtu

# Barycentric indices as VTK 9.7 gives them (vtkHigherOrderTetra::BarycentricIndex), its fourth
# first, written as digits: (4, 0, 0, 0) is "4000".
VTK_TETRA_4 = (
    "4000 0400 0040 0004 3100 2200 1300 0310 0220 0130 1030 2020 3010 3001 2002 1003"
    " 0301 0202 0103 0031 0022 0013 2101 1201 1102 0121 0112 0211 2011 1012 1021 2110 1120 1210"
    " 1111"
)
TYPES = {"Float64": "<f8", "Int32": "<i4", "Int64": "<i8", "UInt8": "u1", "UInt16": "<u2"}


def wavy(points: np.ndarray) -> np.ndarray:
    """A vector field that is no polynomial."""
    x, y, z = points.T
    return np.stack([np.sin(3 * x) * y, np.cos(2 * y + z), x * y * z - z**3], axis=1)


def field_of(mesh: TetMesh, degree: int) -> Field:
    net = ControlNet(mesh, degree)
    return Field(net, net.interpolated(wavy))


def arrays(path: Path) -> dict[str, Any]:
    """Every array of a VTU file by name, read by hand."""
    head, rest = path.read_bytes().split(b'<AppendedData encoding="raw">\n_', 1)
    appended, end = rest.rsplit(b"\n</AppendedData>", 1)
    found: dict[str, Any] = {}
    for element in ElementTree.fromstring(head + end).iter("DataArray"):
        start = int(element.attrib["offset"])
        size = int.from_bytes(appended[start : start + 8], "little")
        array = np.frombuffer(appended[start + 8 : start + 8 + size], TYPES[element.attrib["type"]])
        parts = int(element.attrib.get("NumberOfComponents", 1))
        found[element.attrib["Name"]] = array.reshape(-1, parts) if parts > 1 else array
    return found


def cells(found: dict[str, Any]) -> np.ndarray:
    return found["connectivity"].reshape(len(found["offsets"]), -1)


def test_order_is_what_vtk_says_at_degree_four() -> None:
    listed = [[int(digit) for digit in row] for row in VTK_TETRA_4.split()]
    assert lattice(4, 3).tolist() == listed


@pytest.mark.parametrize("degree", range(1, 11))
def test_order_is_rim_first_and_the_inside_again_a_tetrahedron(degree: int) -> None:
    rows = lattice(degree, 3)
    dimension = (rows > 0).sum(axis=1)
    assert (np.diff(dimension) >= 0).all()
    inside = rows[dimension == 4]
    assert np.array_equal(inside - 1, lattice(degree - 4, 3))
    for face in ((0, 1, 3), (2, 3, 1), (0, 3, 2), (0, 2, 1)):
        missing = 6 - sum(face)
        on = rows[(dimension == 3) & (rows[:, missing] == 0)]
        assert np.array_equal(on[:, face] - 1, lattice(degree - 3, 2))


def test_triangle_of_degree_ten_goes_round_its_rings() -> None:
    rows = lattice(10, 2)
    ring = rows.min(axis=1)
    assert ring.tolist() == [0] * 30 + [1] * 21 + [2] * 12 + [3] * 3
    for level in range(3):
        one = rows[ring == level]
        rest = 10 - 3 * level
        around = np.concatenate([one[3 : 2 + rest], one[1:2], one[2 + rest : 1 + 2 * rest]])
        assert (np.abs(np.diff(around, axis=0)).sum(axis=1) == 2).all()


@pytest.mark.parametrize("degree", [1, 2, 3, 5, 8])
def test_values_read_back_are_the_field(tmp_path: Path, degree: int) -> None:
    mesh = block(cells=(2, 1, 1), irregular=0.3)
    field = field_of(mesh, degree)
    found = arrays(write_vtu(tmp_path / "a.vtu", mesh, {"u": field}))
    assert len(found["Points"]) == field.net.count
    back = np.argsort(vtk_order(degree, 3))
    ours = cells(found)[:, back]
    controls = interpolation(degree, 3) @ found["u"][ours]
    corners = found["Points"][cells(found)[:, :4]]
    rng = np.random.default_rng(1)
    bary = rng.dirichlet(np.ones(4), size=len(mesh.tets))
    read = np.einsum("tm,tmk->tk", values(degree, bary), controls)
    points = np.einsum("ti,tid->td", bary, corners)
    assert np.allclose(read, field.at(points), atol=1e-11)
    det = np.linalg.det(corners[:, 1:] - corners[:, :1])
    assert (det > 0).all() and np.isclose(det.sum() / 6, mesh.volumes.sum())


def test_lower_degrees_are_lifted_and_regions_and_words_are_kept(tmp_path: Path) -> None:
    plain = block(cells=(2, 1, 1))
    region = (plain.points[plain.tets].mean(axis=1)[:, 0] > 0.5).astype(int)
    mesh = TetMesh(plain.points, plain.tets, region, ("fat & skin", "muscle <1>"))
    net = ControlNet(mesh, 3)
    fields = {"u": field_of(mesh, 2), 'p "p" <q>': Field(net, np.ones(net.count))}
    path = write_vtu(tmp_path / "a.vtu", mesh, fields, metadata={"case": "x -- y", "frame": "RAS"})
    found = arrays(path)
    assert cells(found).shape[1] == count(3, 3)
    assert np.array_equal(found["region"], mesh.region)
    assert np.allclose(found['p "p" <q>'], 1)
    words = json.loads(found["metadata"].tobytes())
    assert words["regions"] == ["fat & skin", "muscle <1>"]
    assert words["length unit"] == "mm" and words["frame"].startswith("LPS")
    assert words["case"] == "x -- y" and "not a medical device" in words["notice"]
    assert np.allclose(found["u"], fields["u"].at(found["Points"]), atol=1e-12)


def test_both_sides_of_a_jump_are_kept(tmp_path: Path) -> None:
    mesh = block(cells=(2, 1, 1))
    controls = np.arange(len(mesh.tets))[:, None, None, None] * np.ones((1, 4, 3, 3))
    controls = controls + 100 * np.arange(9).reshape(3, 3)
    broken = BrokenField(mesh, 1, controls)
    found = arrays(write_vtu(tmp_path / "a.vtu", mesh, {"s": broken, "u": field_of(mesh, 2)}))
    assert len(found["Points"]) == len(mesh.tets) * 10
    of_tet = found["s"][cells(found)]
    expected = np.arange(len(mesh.tets))[:, None, None] + 100 * np.arange(9)
    assert np.allclose(of_tet, expected)
    text = (tmp_path / "a.vtu").read_text(encoding="utf-8", errors="replace")
    assert 'ComponentName1="XY"' in text and 'ComponentName2="Z"' in text


def test_a_constant_on_each_tet_is_written_as_such(tmp_path: Path) -> None:
    mesh = block()
    broken = BrokenField(mesh, 0, np.arange(6.0)[:, None])
    found = arrays(write_vtu(tmp_path / "a.vtu", mesh, {"e": broken}))
    assert np.allclose(found["e"][cells(found)], np.arange(6.0)[:, None])


@pytest.mark.parametrize("degree", [1, 2, 4])
def test_surface_cells_face_outwards(tmp_path: Path, degree: int) -> None:
    mesh = ball(2.0)
    field = field_of(mesh, degree)
    found = arrays(write_surface_vtu(tmp_path / "s.vtu", mesh, {"u": field}))
    corners = found["Points"][cells(found)[:, :3]]
    assert np.isclose(np.linalg.det(corners).sum() / 6, mesh.volumes.sum())
    assert len(found["Points"]) == 2 + len(corners) // 2 * degree**2
    assert np.allclose(found["u"], field.at(found["Points"], outside="nearest"), atol=1e-10)


def test_surface_of_a_broken_field_and_of_several_names(tmp_path: Path) -> None:
    mesh = block(cells=(1, 1, 2))
    broken = BrokenField(mesh, 2, np.einsum("t,m->tm", np.arange(12.0), np.ones(10)))
    found = arrays(write_surface_vtu(tmp_path / "s.vtu", mesh, {"e": broken}, ("top", "left")))
    rows = cells(found)
    assert rows.shape == (6, 6)
    middle = found["Points"][rows[:, :3]].mean(axis=1)
    assert (np.isclose(middle[:, 2], 1) | np.isclose(middle[:, 0], 0)).all()
    a, b, c = np.moveaxis(found["Points"][rows[:, :3]], 1, 0)
    assert (np.cross(b - a, c - a)[np.isclose(middle[:, 2], 1), 2] > 0).all()
    inner = middle - 1e-6 * np.cross(b - a, c - a)
    assert np.allclose(found["e"][rows].mean(axis=1), broken.at(inner))


@pytest.mark.parametrize("degree", [1, 2, 3])
def test_meshio_reads_it(tmp_path: Path, degree: int) -> None:
    mesh = block(cells=(2, 1, 1))
    field = field_of(mesh, degree)
    read = meshio.read(write_vtu(tmp_path / "a.vtu", mesh, {"u": field}))
    kind = {1: "tetra"}.get(degree, "VTK_LAGRANGE_TETRAHEDRON")
    assert read.cells[0].type == kind and len(read.cells[0].data) == len(mesh.tets)
    assert np.allclose(read.point_data["u"], field.at(read.points), atol=1e-12)
    assert np.array_equal(read.cell_data["region"][0], mesh.region)


def test_straight_cells_are_read_back_as_a_mesh(tmp_path: Path) -> None:
    mesh = block(cells=(2, 1, 1), irregular=0.3)
    back = read_mesh(write_vtu(tmp_path / "a.vtu", mesh, {"u": field_of(mesh, 1)}))
    assert len(back.points) == len(mesh.points)
    assert np.allclose(back.volumes, mesh.volumes, rtol=1e-14)
    middles = [each.points[each.tets].mean(axis=1) for each in (back, mesh)]
    assert np.allclose(*middles, atol=1e-15)


def three_regions() -> TetMesh:
    """Two that have tets, and one between them that has none."""
    plain = block(cells=(2, 1, 1))
    region = 2 * (plain.points[plain.tets].mean(axis=1)[:, 0] > 0.5)
    return TetMesh(plain.points, plain.tets, region, ("fat & skin", "marrow", "mus\u00e9cle <1>"))


def test_regions_and_their_names_are_read_back(tmp_path: Path) -> None:
    mesh = three_regions()
    path = write_vtu(tmp_path / "a.vtu", mesh, {"u": field_of(mesh, 1)})
    for back in (read_mesh(path), read_mesh(path, tags="region")):
        assert back.regions == mesh.regions
        assert np.array_equal(back.region, mesh.region)
    named = read_mesh(path, regions={"fat": 0})
    assert named.regions == ("fat", *mesh.regions[1:])
    assert np.array_equal(named.region, mesh.region)
    with pytest.raises(InputError, match="'marrow' is given twice"):
        read_mesh(path, regions={"marrow": 0})
    with pytest.raises(InputError, match="tag 7, but the file has none"):
        read_mesh(path, regions={"fat": 7})


def test_regions_are_known_beside_what_another_program_added(tmp_path: Path) -> None:
    mesh = three_regions()
    read = meshio.read(write_vtu(tmp_path / "a.vtu", mesh))
    read.cell_data["chosen"] = [np.arange(len(mesh.tets)) % 5]
    assert mesh_of(listing_of(read, None, wanted=True), None, None).regions == mesh.regions
    assert mesh_of(listing_of(read, "chosen", wanted=False), None, None).regions[1] == "region 1"


OURS: dict[str, Any] = {"software": "bezsoma 9", "regions": ["fat", "marrow", "muscle"]}
DAMAGED: dict[str, Any] = {
    "cut short": json.dumps(OURS)[:-5],
    "no text": "\udcff",
    "nested without end": "[" * 100_000,
    "no table": "[1, 2]",
    "of another program": json.dumps({**OURS, "software": "other"}),
    "by a number": json.dumps({**OURS, "software": 3}),
    "no regions": json.dumps({"software": "bezsoma 9"}),
    "a number for regions": json.dumps({**OURS, "regions": 3}),
    "a table for regions": json.dumps({**OURS, "regions": {"fat": 1, "marrow": 2, "muscle": 3}}),
    "numbers for names": json.dumps({**OURS, "regions": [1, 2, 3]}),
    "a blank name": json.dumps({**OURS, "regions": ["fat", " ", "muscle"]}),
    "a name twice": json.dumps({**OURS, "regions": ["fat", "fat", "muscle"]}),
    "too few names": json.dumps({**OURS, "regions": ["fat", "marrow"]}),
    "numbers, not bytes": np.arange(9.0),
}


@pytest.mark.parametrize("name", DAMAGED)
def test_damaged_words_are_passed_over(name: str, tmp_path: Path) -> None:
    mesh, words = three_regions(), DAMAGED[name]
    read = meshio.read(write_vtu(tmp_path / "a.vtu", mesh))
    assert listing_of(read, None, wanted=False).tets.names[1] == "marrow"
    if isinstance(words, str):
        words = np.frombuffer(words.encode(errors="surrogateescape"), np.uint8)
    read.field_data["metadata"] = words
    back = mesh_of(listing_of(read, None, wanted=False), None, None)
    assert back.regions == ("tissue", "region 2")
    assert np.array_equal(2 * back.region, mesh.region)


@pytest.mark.parametrize("degree", [1, 2, 3, 4, 6, 8, 10])
def test_vtk_evaluates_the_same_polynomial(tmp_path: Path, degree: int) -> None:
    vtk = pytest.importorskip("vtk", reason="VTK is not installed; it is the twin of this order")
    mesh = block(cells=(1, 1, 1), irregular=0.2)
    path = tmp_path / "a.vtu"
    field = field_of(mesh, degree)
    write_vtu(path, mesh, {"u": field})
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    grid = reader.GetOutput()
    data = grid.GetPointData().GetArray("u")
    rng = np.random.default_rng(degree)
    for number in range(grid.GetNumberOfCells()):
        cell = grid.GetCell(number)
        assert cell.GetClassName() == ("vtkTetra" if degree == 1 else "vtkLagrangeTetra")
        weights = [0.0] * cell.GetNumberOfPoints()
        point, sub = [0.0] * 3, vtk.reference(0)
        cell.EvaluateLocation(sub, list(rng.dirichlet(np.ones(4))[:3]), point, weights)
        ids = [cell.GetPointId(i) for i in range(cell.GetNumberOfPoints())]
        read = np.array(weights) @ np.array([data.GetTuple3(i) for i in ids])
        assert np.allclose(read, field.at(np.array([point]))[0], atol=1e-9)
    sizes = vtk.vtkCellSizeFilter()
    sizes.SetInputData(grid)
    sizes.Update()
    volumes = sizes.GetOutput().GetCellData().GetArray("Volume")
    read_volumes = [volumes.GetTuple1(i) for i in range(len(mesh.tets))]
    assert np.allclose(read_volumes, mesh.volumes)


@pytest.mark.parametrize("degree", [0, 11, True, 2.0, "3"])
def test_degrees_that_cannot_be_written_are_refused(tmp_path: Path, degree: Any) -> None:
    with pytest.raises(InputError, match="degree 1 to 10"):
        write_vtu(tmp_path / "a.vtu", block(), {}, degree)


def test_a_field_alone_gets_a_name(tmp_path: Path) -> None:
    mesh = block()
    net = ControlNet(mesh, 1)
    alone: dict[str, Any] = {
        "displacement": field_of(mesh, 2),
        "field": BrokenField(mesh, 0, np.arange(6.0)[:, None]),
    }
    for name, field in alone.items():
        found = arrays(write_vtu(tmp_path / f"{name}.vtu", mesh, field))
        named = arrays(write_vtu(tmp_path / f"{name} named.vtu", mesh, {name: field}))
        assert np.array_equal(found[name], named[name])
    scalar = write_surface_vtu(tmp_path / "s.vtu", mesh, Field(net, np.ones(net.count)))
    assert np.allclose(arrays(scalar)["field"], 1)
    assert set(arrays(write_vtu(tmp_path / "m.vtu", mesh))) == set(
        arrays(write_vtu(tmp_path / "none.vtu", mesh, {}))
    )


def test_a_field_of_another_mesh_is_refused(tmp_path: Path) -> None:
    other = field_of(block(cells=(2, 1, 1)), 1)
    with pytest.raises(InputError, match=r"'u' lives on another mesh \(12 tets"):
        write_vtu(tmp_path / "a.vtu", block(), {"u": other})


def test_an_unknown_surface_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"no surface 'topp'.*did you mean 'top'"):
        write_surface_vtu(tmp_path / "a.vtu", block(), {}, "topp")


def test_files_are_whole_and_not_replaced_unasked(tmp_path: Path) -> None:
    path = write_vtu(tmp_path / "a.vtu", block(), {})
    with pytest.raises(InputError, match="overwrite=True"):
        write_vtu(path, block(), {})
    write_vtu(path, block(cells=(2, 1, 1)), {}, overwrite=True)
    assert len(arrays(path)["region"]) == 12
    with pytest.raises(InputError, match="no folder"):
        write_vtu(tmp_path / "none" / "a.vtu", block(), {})
    with pytest.raises(InputError, match="is a folder"):
        write_vtu(tmp_path, block(), {})
    assert [entry.name for entry in tmp_path.iterdir()] == ["a.vtu"]


def test_a_read_only_folder_is_refused(tmp_path: Path) -> None:
    if os.geteuid() == 0:
        pytest.skip("the superuser may write everywhere")
    tmp_path.chmod(stat.S_IRUSR | stat.S_IXUSR)
    with pytest.raises(InputError, match="choose another folder"):
        write_vtu(tmp_path / "a.vtu", block(), {})


def test_a_disk_that_fills_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: Any) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", full)
    with pytest.raises(InputError, match="No space left on device"):
        write_vtu(tmp_path / "a.vtu", block(), {})
    assert list(tmp_path.iterdir()) == []


def test_large_arrays_span_several_blocks(tmp_path: Path) -> None:
    mesh = block(cells=(9, 9, 9))
    found = arrays(write_vtu(tmp_path / "a.vtu", mesh, {"u": field_of(mesh, 4)}))
    assert found["u"].nbytes > 1 << 20
    assert np.allclose(found["u"], wavy(found["Points"]), atol=1e-12)
    assert len(domain_points(4, 3)) == cells(found).shape[1]
