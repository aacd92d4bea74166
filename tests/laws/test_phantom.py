# SPDX-License-Identifier: BSD-3-Clause
"""The head phantom: a valid mesh, mirror images, anatomy within the ranges usual for adults.

Ranges are wide on purpose (both sexes, two standard deviations and more); they refuse a face
that a surgeon would not believe, not one that is unusual.
"""

from __future__ import annotations

import numpy as np
import pytest

from bezsoma.errors import InputError
from bezsoma.imaging import head_phantom, landmarks
from bezsoma.imaging.anatomy import AZIMUTHS, ROWS
from bezsoma.imaging.phantom import SIZES, least_angles
from bezsoma.imaging.sheets import BONE, SKIN
from bezsoma.mesh import TetMesh

MESHES: dict[str, TetMesh] = {"small": head_phantom("small"), "medium": head_phantom("medium")}
COUNTS = {"small": 2772, "medium": 11088, "large": 88704}
MIRROR = np.array([-1.0, 1.0, 1.0])


@pytest.fixture(params=MESHES)
def mesh(request: pytest.FixtureRequest) -> TetMesh:
    return MESHES[request.param]


def profile(name: str) -> np.ndarray:
    """A point (3,) of the skin in the median plane, by the name of its row."""
    return SKIN.points(np.array(0.0), np.array(float(ROWS.index(name))))


def thickness(name: str, azimuth: float = 0.0) -> float:
    """The least distance in mm from a point of the skin to bone."""
    row = float(ROWS.index(name))
    point = SKIN.points(np.array(azimuth), np.array(row))
    around = np.meshgrid(
        np.linspace(max(azimuth - 20, 0), azimuth + 20, 81), np.linspace(row - 2, row + 2, 81)
    )
    return float(np.linalg.norm(BONE.points(*around) - point, axis=-1).min())


def angle(a: np.ndarray, apex: np.ndarray, b: np.ndarray) -> float:
    p, q = a - apex, b - apex
    return float(np.degrees(np.arccos(p @ q / np.linalg.norm(p) / np.linalg.norm(q))))


def test_one_piece_watertight_and_well_shaped(mesh: TetMesh) -> None:
    """Each edge of a closed surface has two facets, and its areas have no sum."""
    assert not mesh.components().any() and mesh.dropped == 0
    facets = mesh.boundary
    edges = np.concatenate([facets[:, [0, 1]], facets[:, [0, 2]], facets[:, [1, 2]]])
    assert set(np.unique(edges, axis=0, return_counts=True)[1]) == {2}
    assert len(mesh.points) - len(mesh.all_edges) + len(mesh.all_faces) - len(mesh.tets) == 1
    areas = mesh.areas(facets)
    assert np.abs((mesh.normals(facets) * areas[:, None]).sum(axis=0)).max() < 1e-12 * areas.sum()
    assert least_angles(mesh.points[mesh.tets]).min() > 8


def test_surfaces_tile_the_boundary(mesh: TetMesh) -> None:
    assert set(mesh.surfaces) == {"skin", "skull", "jaw", "rami", "mucosa", "neck", "cut"}
    assert all(len(facets) for facets in mesh.surfaces.values())
    facets = np.concatenate(list(mesh.surfaces.values()))
    assert sorted(facets.tolist()) == mesh.boundary.tolist()


def test_left_and_right_are_mirror_images(mesh: TetMesh) -> None:
    """To the last bit: points, tets and every surface."""
    number = {tuple(point): i for i, point in enumerate((mesh.points + 0.0).tolist())}
    image = np.array([number[tuple(point)] for point in (mesh.points * MIRROR + 0.0).tolist()])
    assert (mesh.points[:, 0] == 0).sum() > 20
    for rows in (mesh.tets, *mesh.surfaces.values()):
        assert sorted(np.sort(image[rows], axis=1).tolist()) == sorted(rows.tolist())


def test_supports_that_jump_meet_only_at_the_split(mesh: TetMesh) -> None:
    jaw = mesh.vertices_of("jaw")
    for held in ("skull", "neck"):
        assert not np.intersect1d(jaw, mesh.vertices_of(held)).size
    gap = mesh.points[jaw][:, None] - mesh.points[mesh.vertices_of("skull")]
    assert np.linalg.norm(gap, axis=2).min() > 10
    split = mesh.points[np.intersect1d(jaw, mesh.vertices_of("rami"))]
    assert len(split) > 4 and np.ptp(np.abs(split[:, 0])) < 8


def test_sizes_are_nested() -> None:
    """The same formulas, sampled finer: vertices of a size are vertices of the next."""
    meshes = {**MESHES, "large": head_phantom("large")}
    points = {name: {tuple(p) for p in m.points.round(9).tolist()} for name, m in meshes.items()}
    assert {name: len(m.tets) for name, m in meshes.items()} == COUNTS
    assert points["small"] < points["medium"] < points["large"]
    assert least_angles(meshes["large"].points[meshes["large"].tets]).min() > 8
    volumes = [m.volumes.sum() for m in meshes.values()]
    assert volumes == pytest.approx([457e3] * 3, rel=0.01)


def test_the_answer_is_always_the_same() -> None:
    again = head_phantom("small")
    assert (again.points == MESHES["small"].points).all()
    assert (again.tets == MESHES["small"].tets).all()


def test_landmarks_lie_on_the_skin(mesh: TetMesh) -> None:
    skin = mesh.points[mesh.vertices_of("skin")]
    found = landmarks()
    for point in found.values():
        assert np.abs(skin - point).max(axis=1).min() < 1e-12
    assert (found["left cheek"] == found["right cheek"] * MIRROR).all()
    assert 40 < found["left cheek"][0] < 55  # x points to the patient's left
    heights = [found[name][2] for name in ("chin", "fold", "lower lip", "upper lip", "nose tip")]
    assert heights == sorted(heights)


def test_the_patient_faces_minus_y_with_the_nose_in_front(mesh: TetMesh) -> None:
    assert np.allclose(mesh.points[mesh.points[:, 1].argmin()], landmarks()["nose tip"])


FEATURES = {
    "height of the face": ("G'", "Me'", 2, 115, 140),
    "nasion to menton": ("N'", "Me'", 2, 105, 130),
    "height of the nose": ("N'", "Sn", 2, 46, 60),
    "upper lip": ("Sn", "Stm", 2, 17, 25),
    "lower lip and chin": ("Stm", "Me'", 2, 38, 55),
    "the nose's tip before its base": ("Sn", "Prn", 1, 13, 20),
    "the fold behind the lower lip": ("B'", "Li", 1, 4, 10),
    "the fold behind the chin": ("B'", "Pg'", 1, 2, 7),
}


@pytest.mark.parametrize("name", FEATURES)
def test_lengths_of_the_profile(name: str) -> None:
    first, second, axis, low, high = FEATURES[name]
    assert low < profile(first)[axis] - profile(second)[axis] < high


def test_angles_of_the_profile() -> None:
    """Nasolabial angle, and convexity G'-Sn-Pg' (0 would be a straight line)."""
    assert 95 < angle(profile("columella"), profile("Sn"), profile("Ls")) < 115
    assert 5 < 180 - angle(profile("G'"), profile("Sn"), profile("Pg'")) < 19


def test_breadths() -> None:
    """Between the cheekbones, and between the angles of the jaw, skin to skin."""
    points = MESHES["medium"].points
    across = np.abs(points[:, 0])
    cheek, jaw = np.abs(points[:, 2] - 50) < 8, (np.abs(points[:, 2] + 18) < 6)
    assert 125 < 2 * across[cheek].max() < 148
    assert 100 < 2 * across[jaw & (points[:, 1] > -30)].max() < 125


THICKNESS: dict[tuple[str, float], tuple[float, float]] = {
    ("G'", 0): (4, 8),
    ("brow", 0): (3.5, 7),
    ("N'", 0): (4, 9),
    ("A'", 0): (10, 17),
    ("Ls", 0): (9, 16),
    ("Li", 0): (9, 17),
    ("B'", 0): (8, 14),
    ("Pg'", 0): (8, 14),
    ("Me'", 0): (5, 11),
    ("A'", 45): (8, 20),
    ("Pg'", 45): (8, 18),
    ("bridge", 80): (4, 10),
    ("B'", 75): (10, 22),
}


@pytest.mark.parametrize(("name", "azimuth"), THICKNESS)
def test_thickness_of_soft_tissue(name: str, azimuth: float) -> None:
    low, high = THICKNESS[name, azimuth]
    assert low < thickness(name, azimuth) < high


def test_a_size_that_is_none_is_refused() -> None:
    with pytest.raises(InputError, match=r"no size 'smal'.*large.*medium.*did you mean 'small'"):
        head_phantom("smal")  # type: ignore[arg-type]


def test_tables_fit_together() -> None:
    assert len(ROWS) == len(SKIN.rows) == len(BONE.rows)
    assert (np.diff(AZIMUTHS) > 0).all() and set(SIZES) == set(COUNTS)
    for sheet in (SKIN, BONE):
        assert (np.diff(sheet.rows[:, 0]) > 0).all() and (np.diff(sheet.rows[:, 7]) > 0).all()
