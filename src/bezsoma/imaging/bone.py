# SPDX-License-Identifier: BSD-3-Clause
"""Bone from Hounsfield units: a threshold, and at its surface the local half-way value."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy import ndimage

from bezsoma.arrays import Bools, Floats
from bezsoma.imaging.settings import LabelSettings
from bezsoma.imaging.volume import Volume

MARROW_HU = -250.0
"""HU: a hole of bone that is emptier than this holds air, not marrow."""
PEELS = 2
"""Layers of surface that may be too thin of bone to be bone: a plane cuts at most two voxels deep
along an axis."""
CORTEX = 90.0
"""Per cent of a surface of bone beside which no voxel is denser than this head's cortex."""


def noise(volume: Volume, inside: Bools) -> float:
    """The noise in HU (one sigma) of soft tissue, from second differences along x.

    These have 6 times the variance of independent values, and their median does not see edges:
    sigma = median |d| / (0.6745 sqrt(6)).

    >>> from bezsoma.imaging.volume import Frame
    >>> values = np.random.default_rng(0).normal(50, 30, (20, 40, 40)).astype(np.int16)
    >>> volume = Volume(values, Frame([1, 1, 1], [0, 0, 0], np.eye(3)))
    >>> bool(abs(noise(volume, values < 2000) / 30 - 1) < 0.05)
    True
    """
    step = max(1, len(volume.values) // 40)
    v, soft = volume.values[::step].astype(np.float32), inside[::step]
    soft = soft[:, :, 1:-1] & (np.abs(v[:, :, 1:-1]) < 250)
    second = np.abs(v[:, :, 2:] - 2 * v[:, :, 1:-1] + v[:, :, :-2])[soft]
    return float(np.median(second) / (0.6745 * 6**0.5)) if second.size else 0.0


def quietened(volume: Volume, level: float, settings: LabelSettings) -> Any:
    """Values (z, y, x) with the noise smoothed to about `quiet`, by a Gaussian under a voxel wide.

    Independent noise shrinks by (2 sqrt(pi) s)^(3/2) under a Gaussian of s voxels (s over 0.5).
    """
    wanted = level / max(settings.quiet, 1e-6)
    if wanted <= 1:
        return volume.values
    s = min(max(wanted ** (2 / 3) / (2 * np.pi**0.5), 0.4), 0.75)
    finest = volume.frame.spacing.min()
    sigma = s * np.minimum(1, 2 * finest / volume.frame.spacing)[::-1]
    return ndimage.gaussian_filter(volume.values.astype(np.float32), sigma, truncate=3)


def bone(values: Any, inside: Bools, spacing: Floats, settings: LabelSettings) -> Bools:
    """Bone (z, y, x) inside the head.

    Where `halfway`, a voxel at the surface stays only if it is denser than half-way between soft
    tissue and the bone nearby: then more than half of it is bone.
    """
    found = (values > settings.bone) & inside
    if settings.halfway:
        too_thin = values < level_between(values, 0.5, found, spacing, settings)
        for _ in range(PEELS):
            found &= ~(too_thin & ~ndimage.binary_erosion(found, border_value=1))
    found |= marrow(found, values, spacing, settings)
    return without_specks(found, settings.speck / float(np.prod(spacing)))


def level_between(
    values: Any, part: float, found: Bools, spacing: Floats, settings: LabelSettings
) -> Any:
    """HU (z, y, x) that lie `part` of the way from `soft` to the bone nearby.

    That is as dense as its densest voxel within `reach`, two voxels at least, since beside an edge
    no voxel need be full of bone. Where cortex is no wider than a voxel, none is: so it is up to
    `fuller` times as dense, but for that no denser than this head's cortex, which is seen where
    the surface of what was `found` is densest.

    >>> plate = np.zeros((9, 9, 9))
    >>> plate[4] = 800  # two thirds full of bone
    >>> plate[4, :, :2] = 1200  # full
    >>> level = level_between(plate, 0.5, plate > 0, np.ones(3), LabelSettings(soft=0))
    >>> level[4, 4, [1, 6]].round().tolist(), level[0, 4, 6].tolist()
    ([600.0, 520.0], 0.0)
    """
    reach = np.clip(np.rint(settings.reach / spacing[::-1]), 2, 4).astype(int)
    dense = ndimage.maximum_filter(values, size=tuple((2 * reach + 1).tolist())).astype(np.float32)
    dense -= np.float32(settings.soft)
    surface = found & ~ndimage.binary_erosion(found, border_value=1)
    if surface.any():
        cortex = np.float32(np.percentile(dense[surface], CORTEX))
        np.maximum(dense, np.minimum(np.float32(settings.fuller) * dense, cortex), out=dense)
    dense *= np.float32(part)
    dense += np.float32(settings.soft)
    return dense


def marrow(found: Bools, values: Any, spacing: Floats, settings: LabelSettings) -> Bools:
    """Holes of bone that are smaller than `marrow` in slices along two axes, and hold no air.

    One axis would not do: two rows of teeth that touch enclose holes as well.
    """
    filled = np.zeros(found.shape, np.uint8)
    for axis in range(3):
        area = float(np.prod(np.delete(spacing[::-1], axis)))
        for k in range(found.shape[axis]):
            part: list[Any] = [slice(None)] * 3
            part[axis] = k
            plane = found[tuple(part)]
            if plane.any():
                filled[tuple(part)] += _small_holes(plane, settings.marrow / area)
    return np.asarray((filled > 1) & (values > MARROW_HU))


def _small_holes(plane: Bools, most: float) -> Bools:
    """Holes of a plane that have at most so many pixels."""
    parts, count = ndimage.label(~plane)
    small = np.bincount(parts.ravel(), minlength=count + 1) <= most
    small[0] = False
    for rim in (parts[0], parts[-1], parts[:, 0], parts[:, -1]):
        small[rim] = False
    return np.asarray(small[parts])


def without_specks(mask: Bools, least: float) -> Bools:
    """A mask without its pieces of fewer than `least` voxels."""
    parts, _ = ndimage.label(mask, np.ones((3, 3, 3)))
    keep = np.bincount(parts.ravel()) >= least
    keep[0] = False
    return np.asarray(keep[parts])
