# SPDX-License-Identifier: BSD-3-Clause
"""What holds for every mesh: topology, Gauss, partition of unity, indifference to order."""

from __future__ import annotations

import copy
import pickle
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest

from bezsoma.errors import InputError
from bezsoma.mesh import TetMesh, ball, block, l_block, shell
from bezsoma.mesh.topology import EDGES, FACES
from tolerances import ROUNDING

MESHES = {
    "one tet": TetMesh(np.eye(4, 3), [[0, 1, 2, 3]]),
    "block": block((3, 2, 1), (3, 2, 2), irregular=0.3),
    "far block": block((3, 2, 1), (2, 2, 2), origin=(1000, -1000, 500), irregular=0.3),
    "micrometres": block((3e-6, 2e-6, 1e-6), 2),
    "ball": ball(2, 3),
    "shell": shell(1, 2, 2),
    "whole shell": shell(1, 2, 2, octant=False),
    "L": l_block(cells=2, layers=2),
}
EULER = {"whole shell": 2}
"""V - E + F - T: 1 for what can be shrunk to a point; a hollow sphere has a cavity."""


@pytest.fixture(params=MESHES)
def mesh(request: pytest.FixtureRequest) -> TetMesh:
    return MESHES[request.param]


@pytest.mark.parametrize("name", MESHES)
def test_euler(name: str) -> None:
    mesh = MESHES[name]
    sizes = [len(x) for x in (mesh.points, mesh.all_edges, mesh.all_faces, mesh.tets)]
    assert sizes[0] - sizes[1] + sizes[2] - sizes[3] == EULER.get(name, 1)


def test_edges_and_faces_against_plain_sets(mesh: TetMesh) -> None:
    edges = sorted({pair for row in mesh.tets.tolist() for pair in combinations(row, 2)})
    faces = sorted({three for row in mesh.tets.tolist() for three in combinations(row, 3)})
    assert mesh.all_edges.tolist() == [list(pair) for pair in edges]
    assert mesh.all_faces.tolist() == [list(three) for three in faces]


def test_local_order_of_edges_and_faces(mesh: TetMesh) -> None:
    for local, pair in enumerate(EDGES):
        rows = mesh.all_edges[mesh.edges_of_tet[:, local]]
        assert (rows == mesh.tets[:, pair]).all()
    for local, three in enumerate(FACES):
        assert local not in three
        rows = mesh.all_faces[mesh.faces_of_tet[:, local]]
        assert (rows == mesh.tets[:, three]).all()


def test_every_row_ascends_and_arrays_are_read_only(mesh: TetMesh) -> None:
    rows = (mesh.tets, mesh.all_edges, mesh.all_faces, mesh.boundary, *mesh.surfaces.values())
    assert all((np.diff(row) > 0).all() for row in rows)
    held = (mesh.points, mesh.region, mesh.volumes, mesh.gradients, mesh.tets_of_face)
    assert not any(array.flags.writeable for array in (*rows, *held))
    with pytest.raises(TypeError):
        mesh.surfaces["other"] = mesh.boundary  # type: ignore[index]


def test_tets_of_a_face_have_it(mesh: TetMesh) -> None:
    for side in (0, 1):
        there = mesh.tets_of_face[:, side] >= 0
        tets = mesh.tets[mesh.tets_of_face[there, side]]
        has = (mesh.all_faces[there][:, :, None] == tets[:, None, :]).any(axis=2).all(axis=1)
        assert has.all()
    assert (mesh.tets_of_face[:, 0] >= 0).all()
    assert ((mesh.tets_of_face >= 0).sum() == 4 * len(mesh.tets)).all()


def test_boundary_is_closed_and_gauss_gives_the_volume(mesh: TetMesh) -> None:
    """The area vectors add up to nothing, and the flux of x/3 is the volume (about the centre)."""
    normals, areas = mesh.normals(mesh.boundary), mesh.areas(mesh.boundary)
    vectors = normals * areas[:, None]
    assert np.abs(vectors.sum(axis=0)).max() <= 10 * ROUNDING * areas.sum()
    at = mesh.points[mesh.boundary].mean(axis=1) - mesh.box.mean(axis=0)
    volume = mesh.volumes.sum()
    assert np.einsum("fd,fd->", at, vectors) / 3 == pytest.approx(volume, rel=10 * ROUNDING)


def test_outward_rows_agree_with_normals(mesh: TetMesh) -> None:
    a, b, c = np.moveaxis(mesh.points[mesh.outward(mesh.boundary)], 1, 0)
    assert (np.einsum("fd,fd->f", np.cross(b - a, c - a), mesh.normals(mesh.boundary)) > 0).all()


def test_edges_of_the_boundary_belong_to_an_even_number_of_facets(mesh: TetMesh) -> None:
    pairs = np.concatenate([mesh.boundary[:, pair] for pair in ((0, 1), (0, 2), (1, 2))])
    _, counts = np.unique(pairs, axis=0, return_counts=True)
    assert (counts % 2 == 0).all()


def test_gradients_are_those_of_barycentric_coordinates(mesh: TetMesh) -> None:
    """L_i is 1 at vertex i and 0 at the others, and its gradient has the length 1 / height."""
    corners = mesh.points[mesh.tets]
    size = np.ptp(mesh.points, axis=0).max()
    for i in range(4):
        for j in range(4):
            along = corners[:, j] - corners[:, i]
            change = np.einsum("td,td->t", mesh.gradients[:, i], along)
            assert change == pytest.approx(-1.0 if i != j else 0.0, abs=ROUNDING * 10)
    assert np.abs(mesh.gradients.sum(axis=1)).max() * size < ROUNDING * 100
    heights = 1 / np.linalg.norm(mesh.gradients, axis=2)
    areas = np.stack([mesh.areas(mesh.tets[:, face]) for face in FACES], axis=1)
    assert (heights * areas / 3) / mesh.volumes[:, None] == pytest.approx(1, rel=1e-12)


def test_order_of_tets_and_vertices_and_orientation_do_not_matter() -> None:
    mesh = block((3, 2, 1), (3, 2, 2), irregular=0.3)
    random = np.random.default_rng(1)
    old = random.permutation(len(mesh.points))
    new = np.argsort(old)
    tets = random.permuted(new[mesh.tets], axis=1)[random.permutation(len(mesh.tets))]
    surfaces = {name: random.permuted(new[f], axis=1) for name, f in mesh.surfaces.items()}
    other = TetMesh(mesh.points[old], tets, surfaces=surfaces)
    assert np.sort(other.volumes) == pytest.approx(np.sort(mesh.volumes), rel=1e-12)
    for name in mesh.surfaces:
        assert other.areas(other.surfaces[name]).sum() == pytest.approx(
            mesh.areas(mesh.surfaces[name]).sum(), rel=1e-13
        )
        normals = other.normals(other.surfaces[name])
        assert normals == pytest.approx(mesh.normals(mesh.surfaces[name]), abs=1e-13)


def test_a_shift_far_away_changes_no_bit_of_a_volume() -> None:
    """Coordinates in eighths stay exact at 2**40, so differences give the very same numbers."""
    near = block((2, 1, 1), (4, 2, 2))
    far = near.moved(shift=(2.0**40, -(2.0**39), 2.0**38))
    assert (near.volumes == far.volumes).all()
    assert (near.gradients == far.gradients).all()


def test_moved_scales_turns_and_mirrors() -> None:
    mesh = block((3, 2, 1), (2, 2, 2), irregular=0.3)
    turn = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    for matrix in (turn, -turn, np.diag([1.0, 1.0, -1.0]), 1e-6 * turn):
        moved = mesh.moved(matrix, (10, 20, 30))
        scale = abs(np.linalg.det(matrix))
        assert moved.volumes.sum() == pytest.approx(6 * scale, rel=1e-8)
        assert (moved.tets == mesh.tets).all()
        assert moved.places == mesh.places
        normal = moved.normals(moved.surfaces["left"])[0]
        expected = matrix @ np.array([-1.0, 0, 0])
        assert normal == pytest.approx(expected / np.linalg.norm(expected), abs=1e-8)


def test_components_hang_together_by_faces_only() -> None:
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1], [2, 0, 0], [2, 1, 0]])
    by_face = TetMesh(points, [[0, 1, 2, 3], [1, 2, 3, 4]])
    by_edge = TetMesh(points, [[0, 1, 2, 3], [1, 2, 4, 5]])
    by_vertex = TetMesh(points, [[0, 1, 2, 3], [1, 4, 5, 6]])
    assert [len(set(m.components().tolist())) for m in (by_face, by_edge, by_vertex)] == [1, 2, 2]


def test_unused_points_are_dropped_and_counted_and_the_rest_keeps_its_order() -> None:
    points = np.array([[9, 9, 9], [0, 0, 0], [1, 0, 0], [8, 8, 8], [0, 1, 0], [0, 0, 1]])
    mesh = TetMesh(points, [[5, 4, 2, 1]], surfaces={"base": [[1, 2, 4]]}, vertices={"tip": [5]})
    assert mesh.dropped == 2
    assert "2 unused points dropped" in repr(mesh)
    assert (mesh.points == points[[1, 2, 4, 5]]).all()
    assert mesh.surfaces["base"].tolist() == [[0, 1, 2]]
    assert mesh.vertices["tip"].tolist() == [3]


def test_what_is_given_is_copied() -> None:
    points, tets = np.eye(4, 3), np.array([[0, 1, 2, 3]])
    mesh = TetMesh(points, tets)
    points[:], tets[:] = 7, 7
    assert mesh.volumes[0] == pytest.approx(1 / 6)


def test_places_and_their_kinds() -> None:
    mesh = block(cells=2).with_edges("rim", [(0, 0, 0), (1, 0, 0), (1, 1, 0)])
    mesh = mesh.with_vertices("tip", (1, 1, 1)).with_vertices("pair", numbers=[0, 3])
    assert mesh.places[-3:] == ("rim", "tip", "pair")
    kinds = [mesh.place_kind(name) for name in ("left", "rim", "tip")]
    assert kinds == ["surface", "edge", "vertex"]
    length = np.linalg.norm(np.diff(mesh.points[mesh.edges["rim"]], axis=1), axis=2).sum()
    assert length == pytest.approx(2)
    assert mesh.points[mesh.vertices["tip"]].tolist() == [[1, 1, 1]]
    assert (mesh.points[mesh.vertices_of("left"), 0] == 0).all()
    assert len(mesh.vertices_of("left")) == 9
    assert len(mesh.vertices_of("rim")) == 5
    assert mesh.with_edges("again", mesh.edges["rim"]).edges["again"].tolist() == (
        mesh.edges["rim"].tolist()
    )


def test_surface_by_rule_and_surface_inside() -> None:
    mesh = block((2, 1, 1), (2, 1, 1))
    low = mesh.with_surface("low", lambda x: (x[:, 2] == 0) & (x[:, 0] <= 1))
    assert low.areas(low.surfaces["low"]).sum() == pytest.approx(1)
    inner = mesh.all_faces[(mesh.points[mesh.all_faces][:, :, 0] == 1).all(axis=1)]
    cut = mesh.with_surface("cut", inner)
    assert cut.areas(cut.surfaces["cut"]).sum() == pytest.approx(1)
    with pytest.raises(InputError, match="between two tets"):
        cut.normals(cut.surfaces["cut"])


def test_tets_of_facets(mesh: TetMesh) -> None:
    tets = mesh.tets[mesh.tets_of_facets(mesh.boundary)]
    assert (mesh.boundary[:, :, None] == tets[:, None, :]).any(axis=2).all()


def test_pickles_and_deep_copies_whole() -> None:
    mesh = block(cells=2).with_vertices("tip", (1, 1, 1))
    for other in (pickle.loads(pickle.dumps(mesh)), copy.deepcopy(mesh)):
        assert (other.points == mesh.points).all()
        assert other.places == mesh.places
        assert repr(other) == repr(mesh)


def test_the_mean_size_neither_keeps_volumes_nor_drops_them(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Two solves at once on one mesh: whatever one is about, the other finds what it left."""
    mesh = block((3, 2, 1), (3, 2, 2), irregular=0.3)
    size = mesh.mean_size
    assert "volumes" not in mesh.__dict__
    assert size == float(np.cbrt(mesh.volumes.mean()))
    mesh, other = (block((3, 2, 1), (3, 2, 2), irregular=0.3) for _ in range(2))
    expected, found = other.volumes, TetMesh._volumes

    def met(self: TetMesh) -> np.ndarray:
        """Another solve reads the volumes just then."""
        monkeypatch.setattr(TetMesh, "_volumes", found)
        assert (self.volumes == expected).all()
        return found(self)

    monkeypatch.setattr(TetMesh, "_volumes", met)
    assert mesh.mean_size == size
    assert "volumes" in mesh.__dict__
    assert mesh.mean_size == size


@pytest.mark.real_data
def test_the_real_face(data: Path) -> None:
    with np.load(data / "face_small/face_small.npz") as face:
        mesh = TetMesh(face["points"], face["tets"], surfaces={"all": face["facets"]})
        assert (mesh.outward(face["facets"]) == face["facets"]).any()
        sides = np.moveaxis(mesh.points[face["facets"]], 1, 0)
        given = np.cross(sides[1] - sides[0], sides[2] - sides[0])
        assert (np.einsum("fd,fd->f", given, mesh.normals(face["facets"])) > 0).all()
        assert (mesh.tets_of_facets(face["facets"]) == face["facet_tet"]).all()
    assert len(mesh.surfaces["all"]) == len(mesh.boundary)
    assert 353e3 < mesh.volumes.sum() < 355e3
    assert set(mesh.components().tolist()) == {0}
