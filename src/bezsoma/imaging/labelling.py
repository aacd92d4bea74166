# SPDX-License-Identifier: BSD-3-Clause
"""From a CT to labels: air, soft tissue, bone, the mandible apart, hollows; muscle and fat."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from bezsoma.arrays import Bools, Floats, Ints
from bezsoma.errors import InputError
from bezsoma.imaging import bone as bones
from bezsoma.imaging.head_mask import around_head, body, hollows
from bezsoma.imaging.jaw import mandible, with_marrow
from bezsoma.imaging.meaning import AIR, BONE, CAVITY, FAT, MANDIBLE, MUSCLE, NAMES, SOFT
from bezsoma.imaging.reading import Segmentation
from bezsoma.imaging.settings import LabelSettings
from bezsoma.imaging.volume import Frame, Grid, Volume

FUSED = 3.0
"""mm: a bridge between jaw and skull wider than twice this is more than a touch."""
GROWN = 170.0
"""mm from the top of the skull to the lower border of the chin, bone to bone. In adults 180 to 235:
about 15 less than from skin to skin, which is 195 to 250; at birth some 110, at two years 150."""


@dataclass(frozen=True, eq=False)
class Labels:
    """Label numbers (z, y, x), uint8 (`meaning`), of the part of a picture that holds the head."""

    values: Grid
    frame: Frame
    settings: LabelSettings
    low: Ints
    """Where the part begins in the picture, along x, y, z."""
    notes: tuple[str, ...]
    """What a person should know and look at."""

    def volumes(self) -> dict[str, float]:
        """The volume in cm3 of every label but air."""
        count = np.bincount(self.values.ravel(), minlength=len(NAMES))
        size = float(np.prod(self.frame.spacing)) / 1e3
        return {NAMES[n]: float(count[n] * size) for n in NAMES if n != AIR and count[n]}

    def mask(self, *labels: int) -> Bools:
        """Where (z, y, x) any of the labels stands."""
        return np.isin(self.values, labels)

    def whole(self, volume: Volume) -> Grid:
        """The same numbers on the whole grid of the picture they were made from."""
        values = np.zeros(volume.values.shape, np.uint8)
        x, y, z = (slice(a, a + n) for a, n in zip(self.low, self.values.shape[::-1], strict=True))
        values[z, y, x] = self.values
        return values


def labels(
    volume: Volume, settings: LabelSettings | None = None, given: Segmentation | None = None
) -> Labels:
    """What every voxel of a CT is. `notes` of the answer are to be read, and its sheet looked at.

    `given` masks named bone, mandible or skin (the whole head inside it) take the place of what
    the image alone would give; they have to lie on the grid of the picture.
    """
    settings = LabelSettings() if settings is None else settings
    low, high = around_head(volume, settings)
    part = volume.cropped(low, high)
    masks = _given(given, volume, low, high)
    notes = list(volume.notes)
    solid = masks.get("skin", None)
    solid = body(part, settings) if solid is None else solid
    hollow = hollows(solid, settings, part.frame.spacing) & ~solid
    values = np.where(solid, SOFT, AIR).astype(np.uint8)
    values[hollow] = CAVITY if settings.cavities == "apart" else SOFT
    level = bones.noise(part, solid)
    notes.append(f"noise in soft tissue: {level:.3g} HU")
    quiet = bones.quietened(part, level, settings)
    notes += _metal(part, solid, settings)
    found, jaw = _bones(part.with_values(quiet), solid, settings, masks, notes)
    values[found] = BONE
    values[jaw & (found | (values == SOFT))] = MANDIBLE
    if settings.tissues:
        _tissues(values, quiet, settings)
    return Labels(values, part.frame, settings, low, tuple(notes))


def _bones(
    quiet: Volume, solid: Bools, settings: LabelSettings, masks: dict[str, Bools], notes: list[str]
) -> tuple[Bools, Bools]:
    """All bone and the mandible with its marrow (z, y, x), looked for on voxels under `coarse`."""
    spacing = quiet.frame.spacing
    parts = np.ceil(spacing / settings.coarse - 1e-6).astype(int)
    fine = quiet.parted(parts)

    def on_fine(mask: Bools) -> Bools:
        if (parts == 1).all():
            return mask
        return np.asarray(quiet.with_values(mask.astype(np.float32)).parted(parts).values > 0.5)

    if (parts > 1).any():
        sizes = " x ".join(f"{x:.3g}" for x in fine.frame.spacing)
        notes.append(f"bone was looked for on voxels of {sizes} mm, linear between those given")
    given = {name: on_fine(mask) for name, mask in masks.items()}
    found = given.get("bone")
    if found is None:
        whole = float(np.linalg.norm(spacing)) <= settings.plate  # some voxels are full of cortex
        alike = replace(settings, fuller=1.0) if whole else settings
        found = bones.bone(fine.values, on_fine(solid), fine.frame.spacing, alike)
    found = found | given.get("mandible", np.zeros_like(found))
    jaw = np.zeros_like(found)
    if settings.mandible:
        jaw = _jaw(found, fine, settings, given, notes)
    back = tuple(slice(None, None, n) for n in parts[::-1].tolist())
    return found[back], jaw[back]


def _jaw(
    found: Bools, fine: Volume, settings: LabelSettings, given: dict[str, Bools], notes: list[str]
) -> Bools:
    if "mandible" in given:
        return given["mandible"]
    jaw, bridge = mandible(found, fine.frame, settings)
    if bridge == 0:
        notes.append("mandible and skull touch nowhere")
    else:
        notes.append(f"mandible and skull touch; cut at a bridge {2 * bridge:.3g} mm wide")
    if bridge > FUSED:
        notes.append("LOOK: that bridge is wide; a joint may be fused, or a cut in a wrong place")
    notes += _small(found, jaw, fine.frame, settings)
    return jaw | (with_marrow(jaw, fine.values, fine.frame.spacing, settings) & ~found)


def _small(found: Bools, jaw: Bools, frame: Frame, settings: LabelSettings) -> list[str]:
    """A warning of a head that is no adult's; where `skull` is given its top may not be in view."""

    def heights(mask: Bools) -> Floats:
        return frame.points(np.argwhere(mask)[:, ::-1])[:, 2]

    height = float(heights(found).max() - heights(jaw).min())
    if height >= GROWN or settings.skull is not None:
        return []
    return [
        f"LOOK: {height:.3g} mm from the top of the skull to the chin are a child's, or the scale "
        f"is wrong (adults have {GROWN:g} and more)"
    ]


def _metal(part: Volume, solid: Bools, settings: LabelSettings) -> list[str]:
    """A warning of streaks, where there is metal inside the head."""
    size = float(((part.values > settings.metal) & solid).sum() * np.prod(part.frame.spacing))
    if size <= settings.streaks:
        return []
    return [
        f"LOOK: {size:.3g} mm3 of metal (above {settings.metal:g} HU) draw streaks; labels near "
        "them are doubtful"
    ]


def _tissues(values: Grid, quiet: Grid, settings: LabelSettings) -> None:
    """Tell muscle and fat apart by their windows; skin and what lies between stays soft tissue."""
    for label, (low, high) in ((MUSCLE, settings.muscle), (FAT, settings.fat)):
        values[(values == SOFT) & (quiet >= low) & (quiet <= high)] = label


def _given(given: Segmentation | None, volume: Volume, low: Ints, high: Ints) -> dict[str, Bools]:
    """The masks that somebody gave, on the part of the picture."""
    if given is None:
        return {}
    known = ("bone", "mandible", "skin")
    masks = {name.lower(): mask for name, mask in given.masks.items() if name.lower() in known}
    if not masks:
        raise InputError(
            f"the segmentation has {sorted(given.masks)}; at least one of {list(known)} is needed "
            "(name them with names=)"
        )
    found = {}
    for name, mask in masks.items():
        whole = Volume(mask.astype(np.uint8), given.frame)
        same = mask.shape == volume.values.shape and np.allclose(
            whole.corners, volume.corners, atol=0.01 * float(volume.frame.spacing.min())
        )
        if not same:
            whole = _on(whole, volume)
        found[name] = replace(whole, frame=volume.frame).cropped(low, high).values > 0
    return found


def _on(mask: Volume, volume: Volume) -> Volume:
    """A mask on the grid of the picture, by the nearest voxel; Slicer crops what is empty."""
    framed = replace(mask, values=np.pad(mask.values, 1))
    origin = mask.frame.points(np.array([-1, -1, -1]))
    framed = replace(framed, frame=replace(mask.frame, origin=origin))
    if not (framed.values.any()):
        raise InputError(
            "a segment of the segmentation is empty: no voxel is in it; fill it where it was made, "
            "or leave it out"
        )
    return framed.resampled(volume.frame, volume.shape, order=0)
