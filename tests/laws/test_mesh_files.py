# SPDX-License-Identifier: BSD-3-Clause
"""Meshes that go through a file come back: volumes, regions, places, and what tags are called."""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np
import pytest

from bezsoma.mesh import TetMesh, block, read_mesh, shell, write_mesh
from bezsoma.mesh.abaqus import POINTS
from bezsoma.mesh.files import FORMATS, WRITTEN

NAMED = (".npz", ".inp", ".vtu", ".vtk", ".msh")
MEDIT = (".mesh", ".meshb")


@pytest.fixture(scope="module")
def mesh() -> TetMesh:
    """Two regions, a surface that overlaps others, edges, vertices, names with odd signs."""
    solid = shell(1, 2, 3).moved(shift=(1000.1, -0.3, 1 / 3))
    middle = solid.points[solid.tets].mean(axis=1)
    both = np.concatenate([solid.surfaces["x0"], solid.surfaces["y0"]])
    return TetMesh(
        solid.points,
        solid.tets,
        region=(middle[:, 0] > 1000.7).astype(int),
        regions=("muscle", "fat tissue"),
        surfaces={**solid.surfaces, "x0 + y0: beide Ränder": both},
        edges={"rim 1": solid.all_edges[:7]},
        vertices={"tip/é": [0, 3], "one": [5]},
    )


def same_places(read: TetMesh, mesh: TetMesh) -> None:
    assert read.places == mesh.places or set(read.places) == set(mesh.places)
    for kind in ("surfaces", "edges", "vertices"):
        for name, rows in getattr(mesh, kind).items():
            assert sorted(getattr(read, kind)[name].tolist()) == sorted(rows.tolist())


def same_regions(read: TetMesh, mesh: TetMesh) -> None:
    for index, name in enumerate(mesh.regions):
        volume = read.volumes[read.region == read.regions.index(name)].sum()
        assert volume == pytest.approx(mesh.volumes[mesh.region == index].sum(), rel=1e-13)


@pytest.mark.parametrize("suffix", NAMED)
def test_named_formats_lose_nothing(mesh: TetMesh, tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"mesh{suffix}"
    write_mesh(path, mesh)
    read = read_mesh(path)
    assert (read.points == mesh.points).all()
    assert sorted(read.tets.tolist()) == sorted(mesh.tets.tolist())
    assert read.dropped == 0
    same_regions(read, mesh)
    same_places(read, mesh)


def test_npz_keeps_the_order_of_everything(mesh: TetMesh, tmp_path: Path) -> None:
    write_mesh(tmp_path / "mesh.npz", mesh)
    read = read_mesh(tmp_path / "mesh.npz")
    assert (read.tets == mesh.tets).all()
    assert (read.region == mesh.region).all()
    assert (read.regions, read.places) == (mesh.regions, mesh.places)
    write_mesh(tmp_path / "again.npz", read)
    assert (tmp_path / "again.npz").read_bytes() == (tmp_path / "mesh.npz").read_bytes()


@pytest.mark.parametrize("suffix", MEDIT)
def test_medit_keeps_numbers_in_the_place_of_names(
    mesh: TetMesh, tmp_path: Path, suffix: str
) -> None:
    path = tmp_path / f"mesh{suffix}"
    plain = TetMesh(mesh.points, mesh.tets, mesh.region, mesh.regions, mesh.surfaces, mesh.edges)
    write_mesh(path, plain)
    assert read_mesh(path).places == (*(f"surface {i + 1}" for i in range(6)), "edge 1")
    names = {name: i + 1 for i, name in enumerate(plain.surfaces)}
    read = read_mesh(path, surfaces=names, regions={"muscle": 1, "fat tissue": 2})
    assert (read.points == mesh.points).all()
    same_regions(read, plain)
    for name, facets in plain.surfaces.items():
        assert sorted(read.surfaces[name].tolist()) == sorted(facets.tolist())


@pytest.mark.parametrize("suffix", WRITTEN[1:])
def test_other_programs_get_positive_tets_and_outward_facets(tmp_path: Path, suffix: str) -> None:
    write_mesh(tmp_path / f"mesh{suffix}", block(cells=2))
    kind = "abaqus" if suffix == ".inp" else FORMATS[suffix]
    foreign = meshio.read(tmp_path / f"mesh{suffix}", file_format=kind)
    a, b, c, d = np.moveaxis(foreign.points[foreign.get_cells_type("tetra")], 1, 0)
    assert (np.einsum("td,td->t", np.cross(b - a, c - a), d - a) > 0).all()
    if suffix != ".inp":
        a, b, c = np.moveaxis(foreign.points[foreign.get_cells_type("triangle")], 1, 0)
        assert (np.einsum("fd,fd->f", np.cross(b - a, c - a), a + b + c - 1.5) > 0).all()


def tagged() -> meshio.Mesh:
    """A block of two regions as another program would give it: tags 7 and 9, facets 1 and 0."""
    solid = block(cells=2)
    tags = np.where(solid.points[solid.tets].mean(axis=1)[:, 2] > 0.5, 9, 7).astype(np.int32)
    facets = np.concatenate([solid.surfaces["top"], solid.surfaces["left"]])
    marks = np.repeat(np.array([1, 0], np.int32), 8)
    return meshio.Mesh(
        solid.points.copy(),
        [("triangle", facets.copy()), ("tetra", solid.tets.copy())],
        cell_data={"marks": [marks, tags]},
    )


@pytest.mark.parametrize(
    ("suffix", "kind", "array"),
    [
        (".vtu", "vtu", "marks"),
        (".vtk", "vtk", "marks"),
        (".vtk", "vtk42", "marks"),
        (".msh", "gmsh22", "gmsh:physical"),
        (".mesh", "medit", "medit:ref"),
        (".meshb", "medit", "medit:ref"),
        (".vol", "netgen", "netgen:index"),
        (".avs", "avsucd", "avsucd:material"),
        (".bdf", "nastran", "nastran:ref"),
    ],
)
def test_tags_of_other_programs(tmp_path: Path, suffix: str, kind: str, array: str) -> None:
    foreign = tagged()
    foreign.cell_data[array] = foreign.cell_data.pop("marks")
    if kind == "gmsh22":
        foreign.cell_data["gmsh:geometrical"] = [x.copy() for x in foreign.cell_data[array]]
    path = tmp_path / f"other{suffix}"
    foreign.write(path, file_format=kind)
    plain = read_mesh(path)
    assert plain.regions == ("region 7", "region 9")
    assert "surface 1" in plain.places
    mesh = read_mesh(path, surfaces={"lid": 1}, regions={"fat": 9})
    assert mesh.regions == ("region 7", "fat")
    assert mesh.volumes[mesh.region == 1].sum() == pytest.approx(0.5)
    assert mesh.areas(mesh.surfaces["lid"]).sum() == pytest.approx(1)
    assert (mesh.points[mesh.vertices_of("lid"), 2] == 1).all()


@pytest.mark.parametrize(("suffix", "kind"), [(".su2", "su2"), (".f3grid", "flac3d")])
def test_formats_that_carry_tets_only(tmp_path: Path, suffix: str, kind: str) -> None:
    solid = block((1, 2, 3), 2)
    foreign = meshio.Mesh(solid.points.copy(), [("tetra", solid.oriented_tets)])
    foreign.write(tmp_path / f"other{suffix}", file_format=kind)
    mesh = read_mesh(tmp_path / f"other{suffix}")
    assert mesh.volumes.sum() == pytest.approx(6, rel=1e-6)


GMSH_41 = """$MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
2
2 1 "lid"
3 2 "soft tissue"
$EndPhysicalNames
$Entities
0 0 1 1
1 0 0 0 1 1 1 1 1 0
1 0 0 0 1 1 1 1 2 1 1
$EndEntities
${P}s
1 5 1 5
3 1 0 5
1
2
3
4
5
0 0 0
1 0 0
0 1 0
0 0 1
5 5 5
$End{P}s
$Elements
2 2 1 2
2 1 2 1
1 1 2 3
3 1 4 1
2 1 2 3 4
$EndElements
"""


def test_gmsh_41_keeps_physical_names(tmp_path: Path) -> None:
    path = tmp_path / "box.msh"
    path.write_text(GMSH_41.replace("{P}", POINTS.capitalize()))
    mesh = read_mesh(path)
    assert mesh.regions == ("soft tissue",)
    assert mesh.surfaces["lid"].tolist() == [[0, 1, 2]]
    assert mesh.dropped == 1
    assert read_mesh(path, surfaces={"base": 1}).places == ("base",)
    assert read_mesh(path, regions={"fat": 2}).regions == ("fat",)


@pytest.mark.parametrize("binary", [False, True])
def test_gmsh_22_and_41_ascii_and_binary(tmp_path: Path, binary: bool) -> None:
    solid = block((1, 2, 3), 2)
    foreign = meshio.Mesh(solid.points.copy(), [("tetra", solid.oriented_tets)])
    for kind in ("gmsh", "gmsh22"):
        path = tmp_path / f"{kind}.msh"
        foreign.write(path, file_format=kind, binary=binary)
        assert read_mesh(path).volumes.sum() == pytest.approx(6)


def test_one_of_several_arrays_holds_the_tags(tmp_path: Path) -> None:
    foreign = tagged()
    foreign.cell_data["parts"] = [np.zeros(16, int), np.arange(48) % 3 + 1]
    foreign.cell_data["ids"] = [np.arange(16), 1000 + 10 * np.arange(48)]
    foreign.write(tmp_path / "two.vtu")
    assert read_mesh(tmp_path / "two.vtu").regions == ("tissue",)
    mesh = read_mesh(tmp_path / "two.vtu", tags="parts")
    assert mesh.regions == ("region 1", "region 2", "region 3")


ABAQUS = f"""*Heading
** made by hand: sets by range, by name, by element; sides of tets
*{POINTS.capitalize()}, NSET=all
11, 0, 0, 0
12, 1., 0, 0
13, 0, 1., 0
14, 0, 0, 1.
15, 1., 1., 1.
99, 7, 7, 7
*Element, type=S3, elset=Lid
7, 11, 12, 13
*ELEMENT, TYPE=C3D4
101, 11, 12, 13,
14
*Element, type=C3D4H, elset=upper
102, 12, 13, 14, 15
*Element, type=MASS, elset=ignored
500, 99
*Elset, elset=everything, generate
101, 102, 1
*Elset, elset=lower
101,
*Elset, elset=inherited
LOWER
*Surface, type=ELEMENT, name=outside
upper, S4
lower, S3
*Nset, nset=tip
15, 99
*Nset, nset=lid
11, 12
*Material, name=fat
*Elastic
15e-3, 0.45
"""


def test_abaqus_sets_and_surfaces(tmp_path: Path) -> None:
    path = tmp_path / "hand.inp"
    path.write_text(ABAQUS.replace("*Elset, elset=inherited\nLOWER\n", ""))
    mesh = read_mesh(path)
    assert mesh.dropped == 1
    assert set(mesh.regions) == {"upper", "lower"}
    assert mesh.surfaces["Lid"].tolist() == [[0, 1, 2]]
    assert mesh.surfaces["outside"].tolist() == [[1, 3, 4], [1, 2, 3]]
    assert mesh.vertices["tip"].tolist() == [4]
    assert mesh.vertices["all"].tolist() == [0, 1, 2, 3, 4]


def test_sides_of_an_abaqus_tet(tmp_path: Path) -> None:
    """S1 to S4 of a C3D4 are its corners 1-2-3, 1-4-2, 2-4-3 and 3-4-1."""
    deck = f"*{POINTS}\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n*ELEMENT, TYPE=C3D4\n1,1,2,3,4\n"
    sides = "".join(f"*SURFACE, NAME=S{i}\n1, S{i}\n" for i in (1, 2, 3, 4))
    (tmp_path / "one.inp").write_text(deck + sides)
    mesh = read_mesh(tmp_path / "one.inp")
    corners = {"S1": [0, 1, 2], "S2": [0, 1, 3], "S3": [1, 2, 3], "S4": [0, 2, 3]}
    assert {name: rows.tolist() for name, rows in mesh.surfaces.items()} == {
        name: [row] for name, row in corners.items()
    }
    write_mesh(tmp_path / "again.inp", mesh)
    lines = (tmp_path / "again.inp").read_text().splitlines()
    row = lines[lines.index("*ELEMENT, TYPE=C3D4") + 1].split(",")[1:]
    a, b, c, d = (int(word) - 1 for word in row)
    said = {"S1": {a, b, c}, "S2": {a, d, b}, "S3": {b, d, c}, "S4": {c, d, a}}
    for name, corner in corners.items():
        written = lines[lines.index(f"*SURFACE, NAME={name}, TYPE=ELEMENT") + 1].split(", ")[1]
        assert said[written] == set(corner)


def test_a_vertex_set_gives_way_to_the_surface_of_its_name(tmp_path: Path) -> None:
    path = tmp_path / "hand.inp"
    text = ABAQUS.replace("*Elset, elset=inherited\nLOWER\n", "")
    path.write_text(text.replace("nset=lid", "nset=Lid"))
    assert read_mesh(path).place_kind("Lid") == "surface"


def test_plain_archive_with_tags(tmp_path: Path) -> None:
    solid = block(cells=2)
    tags = np.arange(len(solid.boundary)) % 3
    path = tmp_path / "plain.npz"
    np.savez(
        path,
        points=solid.points,
        tets=solid.oriented_tets,
        facets=solid.outward(solid.boundary),
        facet_tags=tags,
        facet_tet=solid.tets_of_facets(solid.boundary),
        tet_tags=np.where(np.arange(48) < 24, 0, 5),
        remark="other arrays are left alone",
    )
    mesh = read_mesh(str(path), surfaces={"skin": 2}, regions={"fat": 5})
    assert mesh.places == ("surface 1", "skin")
    assert len(mesh.surfaces["skin"]) == (tags == 2).sum()
    assert mesh.regions == ("tissue", "fat")
    assert read_mesh(path, surfaces={"none": 0}).places == ("none", "surface 1", "surface 2")


def test_overwriting_has_to_be_said(mesh: TetMesh, tmp_path: Path) -> None:
    path = tmp_path / "mesh.vtu"
    path.write_text("precious")
    write_mesh(path, mesh, overwrite=True)
    assert len(read_mesh(path).tets) == len(mesh.tets)
    assert [entry.name for entry in tmp_path.iterdir()] == ["mesh.vtu"]


def test_nothing_is_said_on_the_console(
    mesh: TetMesh, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    for suffix in NAMED:
        write_mesh(tmp_path / f"mesh{suffix}", mesh)
        read_mesh(tmp_path / f"mesh{suffix}")
    assert capfd.readouterr() == ("", "")


SURFACES = {"skin": 1, "skull": 2, "jaw": 3, "rami": 4, "cut": 5}


@pytest.mark.real_data
@pytest.mark.parametrize(
    ("name", "vertices", "tets", "litres"),
    [("face_small", 2197, 9381, 0.354), ("face_large", 17264, 84966, 0.738)],
)
def test_the_real_faces(data: Path, name: str, vertices: int, tets: int, litres: float) -> None:
    mesh = read_mesh(data / name / f"{name}.npz", surfaces=SURFACES)
    assert (len(mesh.points), len(mesh.tets), mesh.dropped) == (vertices, tets, 0)
    assert mesh.places == tuple(SURFACES)
    assert sum(map(len, mesh.surfaces.values())) == len(mesh.boundary)
    assert mesh.volumes.sum() / 1e6 == pytest.approx(litres, abs=0.001)
    plain = read_mesh(data / name / f"{name}.vtu")
    assert (plain.points == mesh.points).all()
    assert (plain.tets == mesh.tets).all()


@pytest.mark.real_data
def test_the_real_face_through_every_format(data: Path, tmp_path: Path) -> None:
    mesh = read_mesh(data / "face_small/face_small.npz", surfaces=SURFACES)
    for suffix in WRITTEN:
        path = tmp_path / f"face{suffix}"
        write_mesh(path, mesh)
        names = {name: i + 1 for i, name in enumerate(SURFACES)} if suffix in MEDIT else None
        read = read_mesh(path, surfaces=names)
        assert (read.points == mesh.points).all()
        assert read.volumes.sum() == pytest.approx(mesh.volumes.sum(), rel=1e-13)
        for surface in SURFACES:
            area = read.areas(read.surfaces[surface]).sum()
            assert area == pytest.approx(mesh.areas(mesh.surfaces[surface]).sum(), rel=1e-13)
