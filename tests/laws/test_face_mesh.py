# SPDX-License-Identifier: BSD-3-Clause
"""Tets in the true labels of the phantom: quality, volumes, names, sides, sameness."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import bezsoma as bz
from bezsoma.arrays import Floats
from bezsoma.imaging import (
    Domain,
    DomainSettings,
    FaceMesh,
    Frame,
    Labels,
    LabelSettings,
    Sizes,
    domain,
    face_mesh,
    face_points,
    head_around,
    head_ct,
    sizes_for,
)
from bezsoma.imaging.domain import MUCOSA
from bezsoma.imaging.meaning import AIR, CAVITY, MANDIBLE, SOFT
from bezsoma.imaging.tetrahedra import CUT
from bezsoma.mesh.pinches import pinched
from bezsoma.mesh.quality import dihedral_angles
from tolerances import ANGLE, SURFACE_VOXELS, TISSUE_VOLUME

COARSE = Sizes(segment=9.0, skin=14.0, bone=11.0, largest=40.0, layer=0.9)


def truth(**form: float) -> Labels:
    head = head_ct((2.5, 2.5, 2.5), joint=4, noise=0, **form)  # type: ignore[arg-type]
    return Labels(head.truth, head.volume.frame, LabelSettings(), np.zeros(3, np.int64), ())


@pytest.fixture(scope="module")
def found() -> Labels:
    return truth()


@pytest.fixture(scope="module")
def part(found: Labels) -> Domain:
    return domain(found)


@pytest.fixture(scope="module")
def made(part: Domain) -> FaceMesh:
    return face_mesh(part, COARSE)


def test_no_angle_is_bad_and_no_tet_is_held_at_all_corners(made: FaceMesh) -> None:
    angles = dihedral_angles(made.mesh)
    assert ANGLE < angles.min() and angles.max() < 180 - ANGLE
    held = np.zeros(len(made.mesh.points), bool)
    for name in ("skull", "mandible"):
        held[made.mesh.vertices_of(name)] = True
    assert not held[made.mesh.tets].all(axis=1).any()
    assert made.report["held_tets"] == 0


def test_the_boundary_is_watertight_named_and_of_one_piece(made: FaceMesh) -> None:
    mesh = made.mesh
    assert not len(pinched(mesh.boundary)) and not mesh.components().any()
    named = np.concatenate(list(mesh.surfaces.values()))
    assert sorted(map(tuple, named.tolist())) == sorted(map(tuple, mesh.boundary.tolist()))
    assert set(mesh.surfaces) == {"skin", "skull", "mandible", "gap", "cut"}


def test_surfaces_lie_where_the_labels_end(part: Domain, made: FaceMesh) -> None:
    assert made.report["volume"] == pytest.approx(part.volume(), rel=TISSUE_VOLUME)
    off = made.report["off_voxels"]
    assert isinstance(off, dict) and max(off.values()) < SURFACE_VOXELS


def test_cuts_are_planes_to_the_last_bit(part: Domain, made: FaceMesh) -> None:
    corners = made.mesh.points[made.mesh.surfaces[CUT]]
    flat = np.ptp(corners, axis=1) == 0
    assert flat.any(axis=1).all()
    sides = {(k, float(v)) for k in range(3) for v in np.unique(corners[flat[:, k], 0, k])}
    assert {k for k, _ in sides} == {1, 2} and len(sides) == 3
    assert sorted(v for k, v in sides if k == 2) == [part.low[2], part.high[2]]


def test_bones_keep_apart_where_they_come_near(made: FaceMesh) -> None:
    """The moved bone shares few vertices with the skull: the gap parts them.

    Some it does, since these cells of 9 mm and more are wider than the gap of 5 mm.
    """
    jaw = made.mesh.vertices_of("mandible")
    assert len(np.intersect1d(jaw, made.mesh.vertices_of("skull"))) < 0.08 * len(jaw)
    assert len(np.intersect1d(jaw, made.mesh.vertices_of("gap"))) > 20


def test_the_same_labels_give_the_same_bits(found: Labels, made: FaceMesh) -> None:
    again = face_mesh(domain(found), COARSE).mesh
    assert again.points.tobytes() == made.mesh.points.tobytes()
    assert again.tets.tobytes() == made.mesh.tets.tobytes()
    for name, facets in made.mesh.surfaces.items():
        assert np.array_equal(again.surfaces[name], facets)


def test_left_stays_left(found: Labels, made: FaceMesh) -> None:
    """A hollow in the left cheek is missing in the mesh at positive x, and only there."""
    z, y, x = np.indices(found.values.shape)
    points = found.frame.points(np.stack([x, y, z], axis=-1))
    ball = np.linalg.norm(points - [48, -20, -15], axis=-1) < 9
    values = np.where(ball & (found.values == SOFT), AIR, found.values).astype(np.uint8)
    sides = []
    for mesh in (made.mesh, face_mesh(domain(replace(found, values=values)), COARSE).mesh):
        middle = mesh.points[mesh.tets].mean(axis=1)[:, 0]
        sides.append([mesh.volumes[middle * sign > 0].sum() for sign in (1, -1)])
    (left, right), (hollow, whole) = sides
    assert left - hollow > 800 and abs(right - whole) < 0.1 * (left - hollow)


def test_a_turned_picture_gives_the_same_face(made: FaceMesh) -> None:
    """An oblique grid changes nothing but where voxels lie."""
    straight, oblique = made, face_mesh(domain(truth(tilt=8.0)), COARSE)
    volumes = [made.mesh.volumes.sum() for made in (straight, oblique)]
    assert volumes[0] == pytest.approx(volumes[1], rel=3 * TISSUE_VOLUME)
    for name in ("mandible", "skin"):
        across = [m.mesh.points[m.mesh.vertices_of(name)][:, 0] for m in (straight, oblique)]
        ends = [np.percentile(x, [1, 99]) for x in across]  # coarse cells pierce thin tissue
        assert np.abs(ends[0] - ends[1]).max() < 5


def test_planes_cut_where_they_are_told_to(found: Labels) -> None:
    made = face_mesh(domain(found, DomainSettings(low=(0, None, -40), high=(None, 5, 20))), COARSE)
    low, high = made.mesh.box
    assert low[0] == 0 and low[2] == -40 and high[1] == 5 and high[2] == 20


def test_an_open_mouth_has_mucosa() -> None:
    labels = truth(mouth=12.0)
    assert (labels.values == CAVITY).any()
    settings = DomainSettings(hollows="open")
    mesh = face_mesh(domain(labels, settings), COARSE).mesh
    mouth = mesh.points[mesh.vertices_of("mucosa")]
    low = mouth[mouth[:, 2] < 5]
    assert len(low) > 50 and np.abs(low[:, 0]).max() < 30
    assert not (domain(labels).border == MUCOSA).any()


def test_sizes_grow_from_the_segment(part: Domain, made: FaceMesh) -> None:
    """Far from the segment tets are larger, by as much as sizes wanted there are."""
    mesh = made.mesh
    middle = mesh.points[mesh.tets].mean(axis=1)
    edge, wanted = np.cbrt(12 * mesh.volumes), COARSE.wanted(part, middle)
    away = part.at(part.to_segment, middle)
    near, far = (np.median(edge[which]) for which in (away < 4, away > 25))
    asked = np.median(wanted[away > 25]) / np.median(wanted[away < 4])
    assert asked > 1.3 and far / near == pytest.approx(asked, rel=0.15)
    assert 0.5 < near / COARSE.segment < 1.4


def test_about_as_many_tets_as_asked_for(part: Domain) -> None:
    sizes = sizes_for(part, 12_000, Sizes(layer=0.9))
    assert sizes.skin / sizes.segment == pytest.approx(Sizes().skin / Sizes().segment)
    assert len(face_mesh(part, sizes).mesh.tets) == pytest.approx(12_000, rel=0.1)


def test_a_known_block_of_labels_keeps_its_volume() -> None:
    """Two bones in a block of tissue: exact volumes, in voxels that are no cubes."""
    values = np.zeros((40, 60, 60), np.uint8)
    values[4:36, 5:55, 5:55] = SOFT
    values[10:16, 20:40, 10:50] = MANDIBLE
    values[26:32, 20:40, 10:50] = 2
    frame = Frame(np.array([1.5, 1.5, 2.0]), np.zeros(3), np.eye(3))
    labels = Labels(values, frame, LabelSettings(), np.zeros(3, np.int64), ())
    settings = DomainSettings(above=60, behind=60, below=60, loose=0.1, sealed=0)
    mesh = face_mesh(domain(labels, settings), Sizes(3, 4, 4, 8)).mesh
    voxels = (values == SOFT).sum() * 4.5
    assert mesh.volumes.sum() == pytest.approx(voxels, rel=TISSUE_VOLUME)
    assert set(mesh.surfaces) == {"skin", "skull", "mandible"}
    jaw = mesh.surfaces["mandible"]
    middle = np.average(mesh.points[jaw].mean(axis=1), axis=0, weights=mesh.areas(jaw))
    assert np.abs(middle - [44.25, 44.25, 25]).max() < 0.5


def test_landmarks_lie_on_the_skin_in_order(found: Labels, made: FaceMesh) -> None:
    points = face_points(found)
    assert points["chin"][2] > -45 and points["left_cheek"][0] > 30 > points["chin"][0]
    assert points["right_cheek"][0] < -30

    def to_skin(point: Floats) -> float:
        skin = made.mesh.points[made.mesh.vertices_of("skin")]
        return float(np.linalg.norm(skin - point, axis=1).min())

    assert max(to_skin(point) for point in points.values()) < 8


def test_the_head_around_goes_on_where_the_part_ends(found: Labels, part: Domain) -> None:
    around = head_around(found, part)
    head = around.points[around.facets_of("head")].mean(axis=1)
    inside = ((head > part.low + 3) & (head < part.high - 3)).all(axis=1)
    assert not inside.any() and head[:, 2].max() > 140
    assert len(head) < len(around.boundary)


def test_the_mandible_of_the_mesh_moves_the_chin(made: FaceMesh) -> None:
    shared = np.intersect1d(made.mesh.vertices_of("mandible"), made.mesh.vertices_of("skull"))
    joins = [bz.Gap(free="skull", at="mandible", width=5)] if len(shared) else []
    body = bz.Body(
        made.mesh, degree=1, materials=bz.LinearElastic(E=0.015, nu=0.45), joins=joins,
        supports=[bz.Fixed("skull"), bz.Moved("mandible", translation=(0, -5, 0))],
    )  # fmt: skip
    moved = bz.solve(body).displacement.at([[0, -98, -30], [0, -98, 30]], outside="nearest")
    assert -5.5 < moved[0, 1] < -4.2 and abs(moved[1, 1]) < 1.5


@pytest.mark.real_data
@pytest.mark.slow
def test_a_real_head_is_filled_with_good_tets(data: Path) -> None:
    """From the labels of one threshold: the whole way takes minutes (docs/theory/imaging.md)."""
    pytest.importorskip("SimpleITK")
    from bezsoma.imaging import labels, read_volume

    volume = read_volume(data / "visible_human_head" / "head_ct.nrrd")
    part = volume.cropped(np.array([110, 115, 0]), np.array([395, 345, 234]))
    found = labels(part, LabelSettings(sealed=0))
    cut = DomainSettings(low=(None, None, 11.5), high=(None, 227.5, 91.5))
    made = face_mesh(domain(found, cut), Sizes().scaled(1.3))
    assert dihedral_angles(made.mesh).min() > ANGLE
    assert max(made.report["off_voxels"].values()) < SURFACE_VOXELS  # type: ignore[attr-defined]
    chin = face_points(found)["chin"]
    assert np.abs(chin - [248, 137.7, 30]).max() < 3
