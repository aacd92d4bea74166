# SPDX-License-Identifier: BSD-3-Clause
"""Where the head is: air outside, head rest, wires and table taken away, hollows inside found."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy import ndimage

from bezsoma.arrays import Bools, Floats, Ints
from bezsoma.errors import InputError
from bezsoma.imaging.settings import LabelSettings
from bezsoma.imaging.volume import Volume

COARSE = 2.5
"""mm: the grid on which the head is first looked for."""
MARGIN = 12.0
"""mm of air kept around the head."""
SHALLOW = 4.0
"""mm under the surface: hard things that lie no deeper are worn, not grown."""
FOOT = 0.1
"""What part of such a piece may border on something deeper."""
SMALLEST, LARGEST = 300e3, 40e6
"""mm3 of what can be a head (a child's with little neck) or one with shoulders."""


def around_head(volume: Volume, settings: LabelSettings) -> tuple[Ints, Ints]:
    """Indices (3,), (3,) along x, y, z between which the largest body in the picture lies."""
    step = np.maximum(1, np.rint(COARSE / volume.frame.spacing)).astype(int)
    solid = volume.values[:: step[2], :: step[1], :: step[0]] > settings.skin
    largest = _largest(ndimage.binary_opening(solid))
    found = ndimage.find_objects(largest.astype(np.int8))
    size = float(largest.sum() * np.prod(step * volume.frame.spacing))
    if not found or not SMALLEST <= size <= LARGEST:
        raise InputError(
            f"the largest body in the picture has {size / 1e3:.4g} cm3; a head has "
            f"{SMALLEST / 1e3:g} to {LARGEST / 1e3:g} (is the picture in mm and HU, and is the "
            "whole head in view?)"
        )
    margin = np.ceil(MARGIN / volume.frame.spacing).astype(int) + step
    low = np.array([s.start for s in found[0]])[::-1] * step - margin
    high = np.array([s.stop for s in found[0]])[::-1] * step + margin
    return np.maximum(low, 0), np.minimum(high, volume.shape)


def _largest(mask: Bools, structure: Any = None) -> Bools:
    """The largest connected part of a mask."""
    parts, count = ndimage.label(mask, structure)
    if count == 0:
        return np.zeros_like(mask)
    return np.asarray(parts == np.bincount(parts.ravel())[1:].argmax() + 1)


def distance(mask: Bools, spacing: Floats) -> Any:
    """Distances (z, y, x), mm, float32, from the voxels of a mask to the nearest outside it."""
    return ndimage.distance_transform_edt(mask, sampling=spacing[::-1]).astype(np.float32)


def body(volume: Volume, settings: LabelSettings) -> Bools:
    """The head without air, and without what fits in no ball of radius `thin`: an opening."""
    solid = volume.values > settings.skin
    if settings.thin == 0:
        return _largest(solid)
    spacing = volume.frame.spacing
    radius = settings.thin + spacing.max() / 2  # distances run to the middle of the next voxel
    deep = distance(solid, spacing)
    worn = _on_the_skin(volume.values > settings.bone, deep)
    if worn.any():
        solid &= ~worn
        deep = distance(solid, spacing)
    core = _largest(deep > radius)
    del deep
    if not core.any():
        raise InputError(
            f"nothing in the picture is thicker than {2 * settings.thin:g} mm; a head is: is it in "
            "mm and HU, and in view? Otherwise take a smaller thin="
        )
    opened = distance(~core, spacing) <= radius
    del core
    return np.asarray(opened & solid)


def _on_the_skin(hard: Bools, deep: Any) -> Bools:
    """Where hard pieces lie just under the surface without a broad foot below: wires, rings.

    Bone that comes near the skin continues below nearly everywhere, a wire at its ends at most.
    """
    shallow = hard & (deep <= SHALLOW)
    parts, count = ndimage.label(shallow, np.ones((3, 3, 3)))
    foot = ndimage.binary_dilation(hard & (deep > SHALLOW)) & shallow
    size = np.bincount(parts.ravel(), minlength=count + 1)
    worn = np.bincount(parts[foot], minlength=count + 1) < FOOT * size
    worn[0] = False
    return np.asarray(ndimage.binary_dilation(worn[parts]) & (deep <= SHALLOW))


def hollows(solid: Bools, settings: LabelSettings, spacing: Floats) -> Bools:
    """Air inside the head (z, y, x): what is left behind when openings are sealed, and the plugs.

    A closing by a ball of radius `sealed` shuts nostrils, lips and ear canals. Inside is then air
    that has no way to the sides or the top of the picture, and what the closing filled deeper than
    `sealed` under the surface; folds of the skin that it filled are shallower and stay outside. The
    lowest slice is no way out: there the windpipe is cut, not open.
    """
    if settings.sealed == 0:
        return _enclosed(solid)
    x, y, z = np.ceil(2 * settings.sealed / spacing).astype(int)
    solid = np.pad(solid, ((0, z), (y, y), (x, x)))
    closed = distance(distance(~solid, spacing) <= settings.sealed, spacing) > settings.sealed
    closed |= solid
    inside = _enclosed(closed)
    closed |= inside
    inside |= (distance(closed, spacing) > settings.sealed) & ~solid
    if inside.any():
        inside |= closed & (distance(~inside, spacing) <= settings.sealed) & ~solid
    inside |= _enclosed(solid | inside)
    return inside[: solid.shape[0] - z, y : solid.shape[1] - y, x : solid.shape[2] - x]


def _enclosed(solid: Bools) -> Bools:
    """What of the rest has no way to the sides or the top."""
    parts, count = ndimage.label(~solid)
    outside = np.zeros(count + 1, np.bool_)
    outside[0] = True
    for face in (parts[-1], parts[:, 0], parts[:, -1], parts[:, :, 0], parts[:, :, -1]):
        outside[np.unique(face)] = True
    return np.asarray(~outside[parts])
