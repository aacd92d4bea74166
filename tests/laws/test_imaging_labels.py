# SPDX-License-Identifier: BSD-3-Clause
"""Labels of the CT phantom against its truth at voxel centres, and of a real head."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy import ndimage

from bezsoma.imaging import (
    HeadCt,
    Labels,
    LabelSettings,
    Segmentation,
    head_ct,
    label_plates,
    labels,
    legend,
    read_volume,
)
from bezsoma.imaging.meaning import AIR, BONE, CAVITY, FAT, MANDIBLE, MUSCLE, SOFT
from tolerances import DICE_JAW, DICE_TISSUE, SKIN_VOXELS

MEDIUM = (1.5, 1.5, 1.5)
WAYS: Mapping[str, tuple[tuple[float, float, float], dict[str, Any], float]] = {
    "touching, noisy": (MEDIUM, {"joint": 0, "bite": 0, "noise": 45}, 5),
    "open mouth, oblique": (MEDIUM, {"mouth": 10, "tilt": 9, "noise": 25}, 9),
}
SLOW: Mapping[str, tuple[tuple[float, float, float], dict[str, Any], float]] = {
    "finer": ((1.2, 1.2, 1.2), {"joint": 0, "bite": 0, "noise": 45}, 5),
    "thick slices": ((1, 1, 2), {"joint": 0}, 5),
    "very noisy": (MEDIUM, {"joint": 0, "bite": 0, "noise": 60}, 5),
    "coarser": ((2, 2, 2), {"joint": 1.5}, 5),
    "between": ((1.35, 1.35, 1.35), {"mouth": 10, "noise": 10}, 9),
}


def dice(a: Any, b: Any) -> float:
    return float(2 * (a & b).sum() / (a.sum() + b.sum()))


def thick(bone: Any) -> Any:
    """Bone thicker than two voxels: what an opening by a ball of one voxel leaves."""
    core = ndimage.distance_transform_edt(bone) > 1
    return (ndimage.distance_transform_edt(~core) <= 1) & bone


def skin_distance(head: HeadCt, found: Any) -> float:
    """Mean distance in voxels of faces between head and air from the true skin."""
    off = []
    for axis in range(3):
        near, far = (np.take(found, range(a, found.shape[axis] - 1 + a), axis) for a in (0, 1))
        levels = [np.take(head.skin, range(a, found.shape[axis] - 1 + a), axis) for a in (0, 1)]
        off.append(np.abs(np.add(*levels) / 2)[near != far])
    return float(np.concatenate(off).mean() / head.volume.frame.spacing.max())


def test_coarse_voxels_are_parted_where_bone_is_looked_for() -> None:
    """Labels come back at the centres of the voxels that were given, and the notes say so."""
    head = head_ct((3, 3, 3), joint=4)
    whole, parted = (
        labels(head.volume, LabelSettings(mandible=False, coarse=size)) for size in (1000, 1.5)
    )
    assert "voxels of 1.5 x 1.5 x 1.5 mm" in " ".join(parted.notes)
    assert not any("voxels of" in note for note in whole.notes)
    bone = np.isin(head.truth, (BONE, MANDIBLE))
    found = [answer.whole(head.volume) == BONE for answer in (whole, parted)]
    assert found[0].shape == found[1].shape == bone.shape
    assert dice(found[1], bone) > dice(found[0], bone) + 0.005  # seen: 0.903 and 0.912


def check(
    spacing: tuple[float, float, float],
    form: dict[str, Any],
    sealed: float,
) -> None:
    head = head_ct(spacing, **form)
    answer = labels(head.volume, LabelSettings(sealed=sealed))
    found, truth = answer.whole(head.volume), head.truth
    assert dice(found == SOFT, truth == SOFT) >= DICE_TISSUE
    assert dice(found == MANDIBLE, truth == MANDIBLE) >= DICE_JAW
    bone = np.isin(truth, (BONE, MANDIBLE))
    strong = thick(bone)
    counted = np.isin(found, (BONE, MANDIBLE)) & (~bone | strong)
    assert dice(counted, strong) >= DICE_TISSUE
    assert skin_distance(head, found != AIR) <= SKIN_VOXELS
    condyles = [head.volume.frame.indices(np.array([x, 4, 30])) for x in (-47.0, 47)]
    assert all(found[tuple(np.rint(c).astype(int)[::-1])] == MANDIBLE for c in condyles)


@pytest.mark.parametrize("way", WAYS)
def test_labels_meet_the_truth(way: str) -> None:
    check(*WAYS[way])


@pytest.mark.slow
@pytest.mark.parametrize("way", SLOW)
def test_labels_meet_the_truth_on_other_grids(way: str) -> None:
    check(*SLOW[way])


@pytest.fixture(scope="module")
def coarse() -> HeadCt:
    return head_ct((2, 2, 2), noise=10, joint=3)


@pytest.fixture(scope="module")
def found(coarse: HeadCt) -> Labels:
    return labels(coarse.volume, LabelSettings(tissues=True, coarse=2))


def test_jaw_and_skull_of_the_truth_meet_only_where_they_are_told_to() -> None:
    """With gaps over condyles and between teeth they are apart by more than a voxel everywhere."""

    def meeting(head: HeadCt) -> Any:
        beside = ndimage.binary_dilation(head.truth == MANDIBLE, np.ones((3, 3, 3)))
        return head.volume.frame.points(np.argwhere(beside & (head.truth == BONE))[:, ::-1])

    assert not len(meeting(head_ct((2, 2, 2), joint=3, bite=3)))
    heights = meeting(head_ct((2, 2, 2), joint=0, bite=0))[:, 2]
    assert len(heights) and (np.minimum(abs(heights), abs(heights - 36)) < 4).all()


def test_rest_table_and_wires_are_gone(coarse: HeadCt, found: Labels) -> None:
    whole = found.whole(coarse.volume)
    rest = (coarse.volume.values > -300) & (coarse.skin > 3)
    assert rest.sum() > 20_000
    assert (whole[rest] != AIR).mean() < 0.02
    z, y, x = np.indices(whole.shape)
    points = coarse.volume.frame.points(np.stack([x, y, z], axis=-1))
    worn = (coarse.volume.values > 400) & (np.abs(coarse.skin) < 2)
    worn &= (np.abs(np.abs(points[..., 0]) - 45) < 2) & (points[..., 1] < 0)
    assert worn.sum() > 10 and not np.isin(whole[worn], (BONE, MANDIBLE)).any()


def test_left_stays_left(coarse: HeadCt, found: Labels) -> None:
    """A tooth taken out on the patient's left is missing at positive x."""
    values = coarse.volume.values.copy()
    index = coarse.volume.frame.indices(np.array([28.0, -44, -8]))
    i, j, k = np.rint(index).astype(int)
    values[k - 3 : k + 4, j - 3 : j + 4, i - 3 : i + 4] = 50
    answer = labels(coarse.volume.with_values(values), LabelSettings(mandible=False, coarse=2))
    lost = np.argwhere(found.mask(BONE, MANDIBLE) & ~answer.mask(BONE, MANDIBLE))[:, ::-1]
    assert len(lost) and (found.frame.points(lost)[:, 0] > 15).all()


def test_the_same_picture_gives_the_same_labels(coarse: HeadCt, found: Labels) -> None:
    again = labels(coarse.volume, LabelSettings(tissues=True, coarse=2))
    assert np.array_equal(again.values, found.values) and again.notes == found.notes


def test_tissues_lie_in_their_windows(coarse: HeadCt, found: Labels) -> None:
    whole, hounsfield = found.whole(coarse.volume), coarse.volume.values
    assert (hounsfield[whole == FAT] <= -30).all() and (hounsfield[whole == MUSCLE] >= 10).all()
    assert (whole == FAT).sum() > 20_000 and (whole == MUSCLE).sum() > 100_000


def test_hollows_are_apart_or_tissue_as_stated(coarse: HeadCt, found: Labels) -> None:
    assert dice(found.whole(coarse.volume) == CAVITY, coarse.truth == CAVITY) > 0.85
    filled = labels(coarse.volume, LabelSettings(cavities="tissue", mandible=False, coarse=2))
    assert not filled.mask(CAVITY).any()
    assert np.array_equal(filled.mask(AIR), found.mask(AIR))


def test_metal_is_noticed() -> None:
    head = head_ct((2, 2, 2), filling=True, joint=3)
    notes = labels(head.volume, LabelSettings(mandible=False, coarse=2)).notes
    assert any("metal" in note for note in notes)


def test_a_given_segmentation_takes_the_place_of_the_image(coarse: HeadCt) -> None:
    frame = coarse.volume.frame
    masks = {"mandible": coarse.truth == MANDIBLE, "bone": coarse.truth == BONE}
    answer = labels(coarse.volume, given=Segmentation(masks, frame))  # parted and back
    whole = answer.whole(coarse.volume)
    assert np.array_equal(whole == MANDIBLE, masks["mandible"])
    assert np.array_equal(whole == BONE, masks["bone"])


def test_plates_show_sides_and_labels(coarse: HeadCt, found: Labels) -> None:
    plates = label_plates(coarse.volume, found, (120, 120))
    assert len(plates) == 6 and "mandible" in legend(found)
    for plate in plates:
        assert np.allclose(plate.axes @ plate.axes.T, np.eye(3))
        assert np.isclose(np.linalg.det(plate.axes), 1)
        assert plate.colours.shape == (120, 120, 3) and 0 <= plate.colours.min()
        assert plate.colours.max() <= 1 and plate.colours.std() > 0.05


@pytest.mark.real_data
@pytest.mark.slow
def test_the_mandible_of_a_real_head_is_whole(data: Path) -> None:
    pytest.importorskip("SimpleITK")
    volume = read_volume(data / "visible_human_head" / "head_ct.nrrd")
    part = volume.cropped(np.array([110, 115, 0]), np.array([395, 345, 234]))
    answer = labels(part, LabelSettings(sealed=0))
    jaw = answer.mask(MANDIBLE)
    parts, count = ndimage.label(jaw, np.ones((3, 3, 3)))
    sizes = np.bincount(parts.ravel())[1:]
    assert sizes.max() > 0.97 * sizes.sum() and 25e3 < sizes.sum() < 40e3
    for condyle in ((199, 228, 97), (302, 231, 97)):
        i, j, k = np.rint(answer.frame.indices(np.array(condyle))).astype(int)
        assert jaw[k - 6 : k + 7, j - 6 : j + 7, i - 6 : i + 7].sum() > 100
    points = answer.frame.points(np.argwhere(jaw)[:, ::-1])
    assert np.ptp(points[:, 0]) > 100 and 60 < np.ptp(points[:, 2]) < 95
    assert count < 12
