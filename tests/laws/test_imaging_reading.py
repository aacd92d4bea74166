# SPDX-License-Identifier: BSD-3-Clause
"""CT volumes keep place, side and value through every format and odd form of a series."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import dicom_files as dicom

pytest.importorskip("SimpleITK", reason="comes with the extra 'imaging'")

from bezsoma.imaging import (
    Frame,
    Volume,
    dicom_series,
    read_landmarks,
    read_segmentation,
    read_volume,
    write_landmarks,
    write_segmentation,
    write_surface,
    write_volume,
)
from bezsoma.imaging.child import Child

HALF_VOXEL = 0.51
"""Values of the pattern are linear, so a resampled one may only differ by rounding to whole HU."""


@pytest.fixture(scope="module")
def child() -> Iterator[Child]:
    with Child() as reader:
        yield reader


def turned(angle: float = 0.3) -> Any:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[1, 0, 0], [0, c, -s], [0, s, c]]) @ [[c, -s, 0], [s, c, 0], [0, 0, 1]]


def same(volume: Volume, hounsfield: Any, frame: Frame, closeness: float = 0.0) -> None:
    """Every voxel of the truth is found at its place in space."""
    z, y, x = (a.ravel() for a in np.indices(hounsfield.shape))
    index = volume.frame.indices(frame.points(np.stack([x, y, z], axis=1)))
    assert np.abs(index - np.rint(index)).max() < 1e-3
    i, j, k = np.rint(index).astype(int).T
    assert np.abs(volume.values[k, j, i] - hounsfield[z, y, x]).max() <= closeness


def test_a_series_in_any_order_of_files(tmp_path: Path, child: Child) -> None:
    truth = dicom.pattern()
    volume = read_volume(dicom.written(tmp_path / "a", dicom.stack(truth)), child=child)
    same(volume, truth, Frame([2, 3, 4], [-30, 11, 5], np.eye(3)))
    assert volume.notes == () and volume.values.dtype == np.int16


def test_an_oblique_series_and_one_from_the_top_down(tmp_path: Path, child: Child) -> None:
    truth = dicom.pattern()
    for number, axes in enumerate((turned(), turned() @ np.diag([1, -1, -1]))):
        folder = dicom.written(tmp_path / str(number), dicom.stack(truth, 4, axes[:, :2].T.ravel()))
        volume = read_volume(folder, child=child)
        same(volume, truth, Frame([2, 3, 4], [-30, 11, 5], axes))
        assert (np.diagonal(volume.frame.axes) > 0.8).all()


def test_a_tilted_gantry_is_sheared_back(tmp_path: Path, child: Child) -> None:
    truth = dicom.pattern()
    truth[:] = np.maximum(truth, 100)
    truth[:, :, :2] = -1000
    folder = dicom.written(tmp_path / "a", dicom.stack(truth, 4, shear=0.6))
    volume = read_volume(folder, child=child)
    assert "stand square" in volume.notes[0]
    k = 10
    wanted = truth[k, 5:-3, 4:] - 7 * 0.6 * k / 3  # what lay 6 mm further along the columns
    assert np.abs(volume.values[k, 5:17, 4:] - wanted).max() <= HALF_VOXEL


@pytest.mark.parametrize("shear", [1.5, -1.5])
@pytest.mark.parametrize("reach", [(25, 45), (4, 56)])
def test_a_tilted_gantry_loses_nothing(
    shear: float, reach: tuple[int, int], tmp_path: Path, child: Child
) -> None:
    """A body that stands at one place of the room, nearly outside the last slice or filling all."""
    first, last = reach
    truth = np.full((24, 60, 40), -1000)
    for k, plane in enumerate(truth):  # by whole rows of 3 mm in every other slice
        start = first - round(shear * k / 3) if last - first < 30 else first
        plane[max(start, 0) : max(start, 0) + last - first, 10:30] = 100
    slices = dicom.stack(truth, 3, shear=shear)
    volume = read_volume(dicom.written(tmp_path / "a", slices), child=child)
    assert "widened" in volume.notes[0]
    for k in range(0, 24, 2):
        given, found = (np.argwhere(plane > 0) for plane in (truth[k], volume.values[k]))
        assert len(given) == len(found) == 20 * (last - first)
        i, j = given[:, 1], given[:, 0]
        where = slices[k].position + 2.0 * i[:, None] * [1, 0, 0] + 3.0 * j[:, None] * [0, 1, 0]
        index = np.concatenate([found[:, ::-1], np.full((len(found), 1), k)], axis=1)
        assert np.abs(volume.frame.points(index) - where).max() < 1e-6


def test_doubles_are_dropped_and_uneven_steps_evened(tmp_path: Path, child: Child) -> None:
    truth = dicom.pattern()
    slices = dicom.stack(truth)
    double = read_volume(dicom.written(tmp_path / "a", [*slices, slices[5]]), child=child)
    same(double, truth, Frame([2, 3, 4], [-30, 11, 5], np.eye(3)))
    assert "there twice" in double.notes[0]
    slices[6].position = slices[6].position + [0, 0, 0.8]
    uneven = read_volume(dicom.written(tmp_path / "b", slices), child=child)
    assert "apart; resampled to 4 mm" in uneven.notes[0]
    assert uneven.values[6, 5, 5] == round(truth[6, 5, 5] - 3 * 0.8 / 4.8)


def test_gaps_are_filled_only_when_asked(tmp_path: Path, child: Child) -> None:
    truth = dicom.pattern()
    slices = dicom.stack(truth)
    del slices[6]
    folder = dicom.written(tmp_path / "a", slices)
    volume = read_volume(folder, interpolate=True, child=child)
    same(volume, truth, Frame([2, 3, 4], [-30, 11, 5], np.eye(3)), HALF_VOXEL)
    assert "interpolated" in volume.notes[0]


def test_series_are_listed_and_chosen_and_nobody_is_named(tmp_path: Path, child: Child) -> None:
    truth = dicom.pattern()
    other = dicom.stack(truth + 50)
    for number, one in enumerate(other):
        one.changes = {(0x0020, 0x000E): "1.2.3.5", (0x0008, 0x103E): "bone", (0x0020, 0x0011): 7,
                       (0x0008, 0x0018): f"1.2.7.{number}"}  # fmt: skip
    folder = dicom.written(tmp_path / "a", [*dicom.stack(truth), *other])
    (folder / "notes.txt").write_text("no image")
    assert dicom_series(folder) == ["1.2.3.4: 14 slices of CT (head)",
                                    "1.2.3.5: 14 slices of CT, number 7 (bone)"]  # fmt: skip
    for words in ("bone", "1.2.3.5", "7"):
        volume = read_volume(folder, series=words, child=child)
        assert volume.values[3, 5, 5] == truth[3, 5, 5] + 50
    assert "Doe" not in repr(volume) + str(volume.notes) and "4711" not in repr(volume)
    write_volume(tmp_path / "out.nrrd", volume.values, volume.frame)
    assert b"Doe" not in (tmp_path / "out.nrrd").read_bytes()


@pytest.mark.parametrize("ending", [".nrrd", ".nii", ".nii.gz", ".mha", ".mhd"])
@pytest.mark.parametrize("form", ["oblique", "flipped"])
def test_every_format_keeps_places_sides_and_volume(
    tmp_path: Path, ending: str, form: str, child: Child
) -> None:
    """Written by SimpleITK itself, read by us: the same value at the same point of the patient."""
    import SimpleITK as sitk  # noqa: N813

    truth = dicom.pattern().astype(np.int16)
    axes = turned() if form == "oblique" else np.diag([-1.0, -1, 1])
    image = sitk.GetImageFromArray(truth)
    image.SetSpacing((2.0, 3.0, 4.0))
    image.SetOrigin((-30.0, 11.0, 5.0))
    image.SetDirection(axes.ravel().tolist())
    sitk.WriteImage(image, str(tmp_path / f"a{ending}"))
    volume = read_volume(tmp_path / f"a{ending}", child=child)
    same(volume, truth, Frame([2, 3, 4], [-30, 11, 5], axes))


def test_our_nrrd_is_read_the_same_by_simpleitk(tmp_path: Path) -> None:
    import SimpleITK as sitk  # noqa: N813

    frame = Frame([2, 3, 4], [-30, 11, 5], turned())
    values = dicom.pattern().astype(np.int16)
    for name in ("a", "b"):
        write_volume(tmp_path / f"{name}.nrrd", values, frame)
    assert (tmp_path / "a.nrrd").read_bytes() == (tmp_path / "b.nrrd").read_bytes()
    image = sitk.ReadImage(str(tmp_path / "a.nrrd"))
    assert np.array_equal(sitk.GetArrayFromImage(image), values)
    point = image.TransformIndexToPhysicalPoint((7, 5, 3))
    assert np.allclose(point, frame.points(np.array([7, 5, 3])), atol=1e-9)


def test_segmentations_go_out_and_come_back_by_name(tmp_path: Path, child: Child) -> None:
    values = np.zeros((12, 15, 20), np.uint8)
    values[2:5, 3:9, 4:8], values[6:9, 3:9, 4:8] = 2, 3
    frame = Frame([2, 3, 4], [-30, 11, 5], turned())
    write_segmentation(tmp_path / "a.seg.nrrd", values, frame)
    found = read_segmentation(tmp_path / "a.seg.nrrd", child=child)
    assert set(found.masks) == {"bone", "mandible"}
    assert np.array_equal(found.masks["mandible"], values == 3)
    named = read_segmentation(tmp_path / "a.seg.nrrd", {3: "jaw"}, child=child)
    assert set(named.masks) == {"bone", "jaw"}


def test_landmarks_keep_their_side_in_both_frames(tmp_path: Path) -> None:
    points = {"right condyle": np.array([-47.0, 4, 30]), "Pg": np.array([0.0, -89, -32])}
    write_landmarks(tmp_path / "a.mrk.json", points)
    text = (tmp_path / "a.mrk.json").read_text()
    (tmp_path / "b.mrk.json").write_text(text.replace('"LPS"', '"RAS"'))
    same_frame, other = (read_landmarks(tmp_path / f"{name}.mrk.json") for name in "ab")
    assert all(np.array_equal(same_frame[name], points[name]) for name in points)
    assert other["right condyle"].tolist() == [47, -4, 30]


@pytest.mark.parametrize("ending", [".stl", ".ply", ".obj"])
def test_surfaces_say_their_frame_and_can_be_read(tmp_path: Path, ending: str) -> None:
    import meshio

    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3]])
    triangles = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    path = tmp_path / f"a{ending}"
    write_surface(path, points, triangles)
    assert b"SPACE=LPS" in path.read_bytes()[:200]
    mesh = meshio.read(path)
    corners = np.asarray(mesh.points)[mesh.cells_dict["triangle"]]
    assert np.allclose(corners, points[triangles], atol=1e-6)


def test_stated_hounsfield_units_are_taken(tmp_path: Path, child: Child) -> None:
    grey = np.zeros((12, 15, 20), np.uint8)
    grey[3:9, 3:9, 3:9] = 80
    write_volume(tmp_path / "a.nrrd", grey, Frame([4, 4, 4], [0, 0, 0], np.eye(3)))
    volume = read_volume(tmp_path / "a.nrrd", hounsfield=(16.06, -1016), child=child)
    assert int(volume.values.max()) == round(16.06 * 80 - 1016) and "as stated" in volume.notes[0]
