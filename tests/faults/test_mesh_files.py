# SPDX-License-Identifier: BSD-3-Clause
"""Damaged and unfitting mesh files are refused, with the file's name and what can be done."""

from __future__ import annotations

import io
import os
import signal
import stat
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest

from bezsoma.errors import InputError, MeshError
from bezsoma.mesh import ControlNet, Field, TetMesh, block, read_mesh, write_mesh
from bezsoma.mesh.abaqus import POINTS
from bezsoma.mesh.files import WRITTEN
from bezsoma.view.grid import Cells
from bezsoma.view.vtk import write_surface_vtu, write_vtu

PLAIN: dict[str, Any] = {
    "points": np.eye(4, 3),
    "tets": np.array([[0, 1, 2, 3]]),
    "facets": np.array([[0, 1, 2], [1, 2, 3]]),
    "facet_tags": np.array([1, 2]),
    "facet_tet": np.array([0, 0]),
}


@pytest.fixture(autouse=True)
def _never_hang() -> Iterator[None]:
    """A reader that loops at the end of a damaged file fails instead of stopping the suite."""
    signal.alarm(200)
    yield
    signal.alarm(0)


def refused(words: list[str], path: Path, **options: Any) -> None:
    with pytest.raises(InputError) as caught:
        read_mesh(path, **options)
    message = str(caught.value)
    assert [word for word in [path.name, *words] if word not in message] == [], message
    assert len(message) < 700


def archive(path: Path, without: str = "", **changes: Any) -> Path:
    np.savez(path, **{k: v for k, v in {**PLAIN, **changes}.items() if k != without})
    return path


ARCHIVES: dict[str, tuple[Callable[[Path], Path], list[str]]] = {
    "no tets": (lambda p: archive(p, "tets"), ["no array 'tets'", "facet_tags", "'points'"]),
    "no points": (lambda p: archive(p, "points"), ["no array 'points'"]),
    "no facets": (lambda p: archive(p, "facets"), ["no array 'facets'"]),
    "tags too short": (
        lambda p: archive(p, facet_tags=np.array([1])),
        ["facet_tags", "(1,)", "2 facets"],
    ),
    "tags with fractions": (
        lambda p: archive(p, facet_tags=np.array([1.5, 2])),
        ["facet_tags", "float64", "whole numbers"],
    ),
    "tet tags too long": (
        lambda p: archive(p, tet_tags=np.array([1, 2])),
        ["tet_tags", "(2,)", "for 1 tet whole numbers"],
    ),
    "owner out of range": (
        lambda p: archive(p, facet_tet=np.array([0, 1])),
        ["facet 1", "facet_tet", "write the file again"],
    ),
    "owner of another mesh": (
        lambda p: archive(
            p,
            tets=np.array([[0, 1, 2, 3], [1, 2, 3, 4]]),
            points=np.vstack([np.eye(4, 3), [[1, 1, 1]]]),
            facet_tet=np.array([1, 1]),
        ),
        ["facet 0", "tet 1"],
    ),
    "owner too short": (lambda p: archive(p, facet_tet=np.array([0])), ["facet_tet", "(2,)"]),
    "no facet of a tet": (
        lambda p: archive(
            p,
            "facet_tet",
            points=np.vstack([np.eye(4, 3), [[1, 1, 1]]]),
            facets=np.array([[0, 1, 2], [1, 2, 4]]),
        ),
        ["surface 2", "[1, 2, 4]", "no face"],
    ),
    "tets of floats": (
        lambda p: archive(p, "facet_tet", tets=np.array([[0, 1, 2, 3.0]])),
        ["float64", "integers"],
    ),
    "points in 2-D": (lambda p: archive(p, points=np.eye(4, 2)), ["(4, 2)", "2-D"]),
    "points not finite": (lambda p: archive(p, points=np.eye(4, 3) * np.nan), ["nan", "finite"]),
    "pickled objects": (
        lambda p: archive(p, points=np.array([{"a": 1}], dtype=object)),
        ["no sound NumPy archive", "Object arrays"],
    ),
    "text for points": (lambda p: archive(p, points=np.array("hello")), ["points", "()", "(v, 3)"]),
    "a later version": (lambda p: archive(p, bezsoma_mesh=2), ["version 2", "newer BezSoma"]),
    "our form, cut": (lambda p: archive(p, bezsoma_mesh=1), ["no array 'region'", "only"]),
    "our form, without its sizes": (
        lambda p: archive(p, bezsoma_mesh=1, region=[0], regions=["a"], surface_names=["b"]),
        ["no array 'surface_sizes'"],
    ),
    "one array, not an archive": (lambda p: single(p), ["no sound NumPy archive"]),
    "a zip of other things": (lambda p: other_zip(p), ["no sound NumPy archive"]),
    "an archive that swells": (lambda p: bomb(p), ["GiB", "hardly a mesh"]),
}


def single(path: Path) -> Path:
    with path.open("wb") as file:
        np.save(file, np.eye(3))
    return path


def other_zip(path: Path) -> Path:
    with zipfile.ZipFile(path, "w") as file:
        file.writestr("points.npy", "this is no array")
    return path


def bomb(path: Path) -> Path:
    """A small file that claims to unpack to 64 GiB: its directory says so."""
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w", zipfile.ZIP_DEFLATED) as file:
        file.writestr("points.npy", b"0" * 1000)
        file.filelist[0].file_size = 2**36
        file.filelist[0].extra = b""
    path.write_bytes(data.getvalue())
    return path


@pytest.mark.parametrize("name", ARCHIVES)
def test_damaged_archives(name: str, tmp_path: Path) -> None:
    make, words = ARCHIVES[name]
    refused(words, make(tmp_path / "face.npz"))


def test_places_that_do_not_fit_together(tmp_path: Path) -> None:
    write_mesh(tmp_path / "good.npz", block())
    with np.load(tmp_path / "good.npz") as good:
        arrays = {name: good[name] for name in good.files}
    arrays["surface_sizes"] = arrays["surface_sizes"] + 1
    np.savez(tmp_path / "bad.npz", **arrays)
    refused(["surface_sizes", "do not fit together"], tmp_path / "bad.npz")
    arrays["surface_sizes"] = -arrays["surface_sizes"]
    np.savez(tmp_path / "bad.npz", **arrays)
    refused(["surface_sizes", "do not fit together"], tmp_path / "bad.npz")


NAMES: list[tuple[dict[str, Any], list[str]]] = [
    ({"surfaces": {"skin": 7}}, ["'skin'", "tag 7", "[1, 2]"]),
    ({"surfaces": {"skin": 1, "bone": 1}}, ["tag 1", "'skin'", "'bone'", "one is needed"]),
    ({"surfaces": {"skin": "1"}}, ["'skin'", "'1'", "whole number"]),
    ({"surfaces": {"skin": True}}, ["'skin'", "True", "whole number"]),
    ({"surfaces": {"": 1}}, ["''", "not blank"]),
    ({"regions": {"fat": 1}}, ["'fat'", "bear no tags"]),
]


@pytest.mark.parametrize(("options", "words"), NAMES)
def test_names_for_tags_that_are_not_there(
    options: dict[str, Any], words: list[str], tmp_path: Path
) -> None:
    refused(words, archive(tmp_path / "face.npz"), **options)


def test_our_own_form_has_its_names(tmp_path: Path) -> None:
    write_mesh(tmp_path / "block.npz", block())
    refused(["names its surfaces"], tmp_path / "block.npz", surfaces={"skin": 1})


def test_which_array_holds_the_tags(tmp_path: Path) -> None:
    path = tmp_path / "two.vtu"
    solid = block()
    data = {"a": [np.zeros(6, int)], "b": [np.ones(6, int)], "c": [np.linspace(0.1, 1, 6)]}
    meshio.Mesh(solid.points.copy(), [("tetra", solid.tets.copy())], cell_data=data).write(path)
    refused(["several cell arrays", "tags=", "['a', 'b']"], path, regions={"fat": 1})
    refused(["no cell array 'd'", "['a', 'b']"], path, tags="d")
    refused(["no cell array 'c'"], path, tags="c")
    assert read_mesh(path, regions={"fat": 1}, tags="b").regions == ("fat",)


def test_missing_empty_folder_and_unknown_endings(tmp_path: Path) -> None:
    (tmp_path / "face.vtu").write_bytes(b"")
    (tmp_path / "face.stl").write_bytes(b"solid")
    (tmp_path / "folder.npz").mkdir()
    (tmp_path / "ending").write_bytes(b"x")
    refused(["empty", "0 bytes"], tmp_path / "face.vtu")
    refused(["no file", "did you mean 'face.vtu'"], tmp_path / "fase.vtu")
    refused(["no file", "no folder"], tmp_path / "nowhere" / "face.vtu")
    refused(["'.stl'", ".npz", ".vtu"], tmp_path / "face.stl")
    refused(["''", ".npz"], tmp_path / "ending")
    refused(["is a folder"], tmp_path / "folder.npz")
    (tmp_path / "disc.mesh").write_text("MFEM mesh v1.0\n\ndimension\n3\n")
    refused(["MFEM", "VTU"], tmp_path / "disc.mesh")


@pytest.mark.skipif(os.geteuid() == 0, reason="the superuser may read everything")
def test_no_permission_to_read(tmp_path: Path) -> None:
    path = archive(tmp_path / "face.npz")
    path.chmod(0)
    refused(["cannot be opened", "ermission"], path)


def test_a_reader_that_is_denied_is_told_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def denied(self: Path, *args: object, **options: object) -> None:
        raise PermissionError(13, "Permission denied", str(self))

    path = archive(tmp_path / "face.npz")
    monkeypatch.setattr(Path, "open", denied)
    refused(["cannot be opened", "Permission denied"], path)


@pytest.mark.parametrize("suffix", [".vtu", ".vtk", ".msh", ".mesh", ".meshb", ".vol", ".su2"])
@pytest.mark.parametrize("content", [b"no mesh at all\n", bytes(range(256)) * 4, b"\n\n\n"])
def test_of_another_format_than_the_ending_says(
    suffix: str, content: bytes, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / f"face{suffix}"
    path.write_bytes(content)
    refused([], path)
    assert capfd.readouterr() == ("", "")


def test_what_a_reader_says_is_passed_on(tmp_path: Path) -> None:
    path = tmp_path / "face.vtu"
    path.write_text("<VTKFile")
    refused(["cannot be read as .vtu", "damaged, cut short, or of another format", ".npz"], path)


@pytest.mark.parametrize("suffix", WRITTEN)
def test_cut_short_anywhere(suffix: str, tmp_path: Path) -> None:
    """A file that ends early is refused; only where nothing is lost may it be read."""
    whole = block(cells=2)
    path = tmp_path / f"face{suffix}"
    write_mesh(path, whole)
    content = path.read_bytes()
    for part in np.linspace(1, len(content) - 40, 40).astype(int).tolist():
        path.write_bytes(content[:part])
        try:
            read = read_mesh(path)
        except MeshError as error:
            assert path.name in str(error)
        else:
            assert suffix in (".inp", ".mesh", ".msh")
            assert 0 < len(read.tets) <= len(whole.tets)


@pytest.mark.parametrize("suffix", WRITTEN)
def test_bytes_changed_anywhere(suffix: str, tmp_path: Path) -> None:
    """Whatever a damaged file says, the answer is a mesh that passed the checks, or a refusal."""
    path = tmp_path / f"face{suffix}"
    write_mesh(path, block(cells=(2, 1, 1)))
    content = path.read_bytes()
    random = np.random.default_rng(7)
    for _ in range(60):
        damaged = bytearray(content)
        for at in random.integers(0, len(content), 3):
            damaged[at] = random.integers(0, 256)
        path.write_bytes(damaged)
        try:
            assert (read_mesh(path).volumes > 0).all()
        except InputError as error:
            assert path.name in str(error)


def foreign(path: Path, cells: list[tuple[str, Any]], points: Any = None) -> Path:
    grid = np.stack(np.meshgrid(*[np.arange(3.0)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    meshio.Mesh(grid if points is None else points, cells).write(path)
    return path


ROW = np.array([[0, 9, 3, 1]])
CELLS: dict[str, tuple[list[tuple[str, Any]], list[str]]] = {
    "a surface": ([("triangle", ROW[:, :3])], ["no tets", "['triangle']", "filled with tets"]),
    "curved tets": ([("tetra10", np.arange(10)[None])], ["tetra10", "order 1"]),
    "hexahedra": ([("hexahedron", np.arange(8)[None])], ["hexahedron", "split"]),
    "tets and wedges": ([("tetra", ROW), ("wedge", np.arange(6)[None])], ["['wedge']", "split"]),
    "tets and quadrilaterals": ([("tetra", ROW), ("quad", ROW)], ["['quad']", "split"]),
    "tets and curved triangles": (
        [("tetra", ROW), ("triangle6", np.arange(6)[None])],
        ["triangle6", "order 1"],
    ),
}


@pytest.mark.parametrize("name", CELLS)
def test_other_cells_than_straight_tets(name: str, tmp_path: Path) -> None:
    cells, words = CELLS[name]
    refused(words, foreign(tmp_path / "other.vtu", cells))


@pytest.mark.parametrize("kind", ["lagrange", "bezier"])
def test_curved_cells_of_our_own(kind: Cells, tmp_path: Path) -> None:
    net = ControlNet(block(), 2)
    field = Field(net, np.zeros((net.count, 3)))
    words = [f"VTK_{kind.upper()}_TETRAHEDRON", "straight", "curved", "read mesh.npz beside it"]
    refused(words, write_vtu(tmp_path / "solid.vtu", net.mesh, field, cells=kind))
    words[0] = f"VTK_{kind.upper()}_TRIANGLE"
    refused(words, write_surface_vtu(tmp_path / "skin.vtu", net.mesh, field, cells=kind))


def test_untagged_triangles_lines_and_points_are_left_out(tmp_path: Path) -> None:
    cells = [("tetra", ROW), ("triangle", ROW[:, 1:]), ("line", ROW[:, :2]), ("vertex", ROW.T)]
    mesh = read_mesh(foreign(tmp_path / "other.vtu", cells))
    assert (mesh.places, len(mesh.tets), mesh.dropped) == ((), 1, 23)


HEAD = f"*{POINTS}\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n5,1,1,1\n*ELEMENT, TYPE=C3D4\n1,1,2,3,4\n"
DECKS: dict[str, tuple[str, list[str]]] = {
    "empty deck": ("*HEADING\nnothing\n", ["no points or no tets", "C3D4"]),
    "hexahedra": (f"{HEAD}*ELEMENT, TYPE=C3D8\n7,1,2,3,4,5,1,2,3\n", ["C3D8", "linear tets"]),
    "curved tets": (f"{HEAD}*ELEMENT, TYPE=C3D10\n", ["C3D10", "linear tets"]),
    "cut row": (f"{HEAD}2,2,3\n", ["8 numbers", "multiple of 5", "cut short"]),
    "point not listed": (f"{HEAD}2,2,3,4,9\n", ["point 9", "does not list"]),
    "two parts": (f"{HEAD}*{POINTS}\n1,5,5,5\n", ["point 1", "twice", "as one"]),
    "element twice": (f"{HEAD}1,2,3,4,5\n", ["element number", "twice"]),
    "unknown set": (f"{HEAD}*ELSET, ELSET=a\nfat\n", ["ELSET", "'fat'", "not defined"]),
    "set without a name": (f"{HEAD}*ELSET\n1\n", ["ELSET", "no ELSET="]),
    "sets overlap": (
        f"{HEAD}2,2,3,4,5\n3,1,2,3,5\n*ELSET, ELSET=a\n1,2\n*ELSET, ELSET=b\n2\n",
        ["tets 1", "'a'", "'b'", "disjoint"],
    ),
    "side of nothing": (
        f"{HEAD}*SURFACE, NAME=s, TYPE=ELEMENT\n1, S7\n",
        ["'s'", "'S7'", "S1 to S4"],
    ),
    "no numbers": (f"{HEAD}x,y\n", ["cannot be read as .inp"]),
    "placed part": (f"*INSTANCE, NAME=a\n1,2,3\n{HEAD}", ["INSTANCE", "one part"]),
    "included": (f"*INCLUDE, INPUT=other.inp\n{HEAD}", ["INCLUDE", "flat"]),
    "2-D": (f"*{POINTS}\n1,0,0\n*ELEMENT, TYPE=C3D4\n1,1,1,1,1\n", ["three coordinates"]),
}


@pytest.mark.parametrize("name", DECKS)
def test_abaqus_decks(name: str, tmp_path: Path) -> None:
    text, words = DECKS[name]
    path = tmp_path / "deck.inp"
    path.write_text(text)
    refused(words, path)


def unwritten(words: list[str], path: Path, mesh: TetMesh, **options: Any) -> None:
    before = sorted(path.parent.iterdir()) if path.parent.is_dir() else []
    with pytest.raises(InputError) as caught:
        write_mesh(path, mesh, **options)
    assert [word for word in words if word not in str(caught.value)] == [], str(caught.value)
    assert (sorted(path.parent.iterdir()) if path.parent.is_dir() else []) == before


def test_what_cannot_be_written(tmp_path: Path) -> None:
    mesh = block()
    (tmp_path / "there.npz").write_text("precious")
    unwritten(["there.npz", "overwrite=True"], tmp_path / "there.npz", mesh)
    assert (tmp_path / "there.npz").read_text() == "precious"
    unwritten(["'.stl'", ".npz"], tmp_path / "face.stl", mesh)
    unwritten(["no folder", "make it first"], tmp_path / "nowhere" / "face.npz", mesh)
    tip = mesh.with_vertices("tip", (0, 0, 0))
    unwritten([".mesh", "no named vertices", ".npz"], tmp_path / "face.mesh", tip)
    twice = TetMesh(mesh.points, mesh.tets, None, ("top",), {"top": mesh.surfaces["top"]})
    unwritten(["'top'", "rename"], tmp_path / "face.msh", twice)
    comma = mesh.with_surface("a, b", mesh.surfaces["top"])
    unwritten(["'a, b'", "Abaqus", "rename"], tmp_path / "face.inp", comma)


@pytest.mark.parametrize("suffix", WRITTEN)
def test_a_full_disc_leaves_nothing_behind(
    suffix: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*places: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", full)
    path = tmp_path / f"face{suffix}"
    unwritten([path.name, "No space left"], path, block())


@pytest.mark.skipif(os.geteuid() == 0, reason="the superuser may write everywhere")
def test_a_folder_that_is_read_only(tmp_path: Path) -> None:
    tmp_path.chmod(stat.S_IRUSR | stat.S_IXUSR)
    unwritten(["could not be written", "ermission"], tmp_path / "face.npz", block())
    tmp_path.chmod(stat.S_IRWXU)
