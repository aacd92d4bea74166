# SPDX-License-Identifier: BSD-3-Clause
"""Flat pictures of a CT and its labels: planes through the head, and how its surfaces look."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from bezsoma.arrays import Bools, Floats, frozen
from bezsoma.imaging.labelling import Labels
from bezsoma.imaging.meaning import AIR, BONE, CAVITY, COLOURS, MANDIBLE, NAMES
from bezsoma.imaging.volume import Grid, Volume

PIXEL = 0.8
"""mm of a pixel."""
WINDOW = (-300.0, 900.0)
"""HU shown as black and as white."""
VEIL = 0.42
"""How much of a label's colour lies over the grey."""
RIGHT, FRONT, BELOW = (
    ((0, -1, 0), (0, 0, 1)),
    ((1, 0, 0), (0, 0, 1)),
    ((1, 0, 0), (0, -1, 0)),
)
"""What points to the right and upwards, seen from the patient's right, from the front and from
below (LPS): no picture is a mirror image."""
OBLIQUE = ((0.79, -0.61, 0), (0.07, 0.09, 0.993))
"""The same from the patient's right, half in front, and a little above."""


@dataclass(frozen=True, eq=False)
class Plate:
    """A picture: colours (h, w, 3) from 0 to 1, where it stands, and what it shows."""

    colours: Floats
    centre: Floats
    """(3,) mm, the middle of the picture."""
    axes: Floats
    """(3, 3) rows: to the viewer's right, upwards, towards the viewer; orthonormal."""
    caption: str

    scale: float = 1 / PIXEL
    """Pixels per mm."""


def label_plates(volume: Volume, labels: Labels, size: tuple[int, int] = (400, 400)) -> list[Plate]:
    """Six pictures (w, h pixels) to check labels by: three planes, skin, and bones from two sides.

    Planes are those of LPS through the middle of the mandible (if there is one, else of the bone),
    the coronal one further behind, through its condyles; an oblique grid is cut along LPS too.
    """
    jaw = labels.mask(MANDIBLE) if labels.mask(MANDIBLE).any() else labels.mask(BONE)
    jaw = jaw if jaw.any() else ~labels.mask(AIR)
    points = labels.frame.points(np.argwhere(jaw)[:, ::-1])
    low, high = points.min(axis=0), points.max(axis=0)
    middle = (low + high) / 2
    condyles = points[points[:, 2] > high[2] - 8].mean(axis=0)
    whole = labels.frame.points((np.array(labels.values.shape[::-1]) - 1) / 2)
    planes = [
        ("axial", BELOW, [*whole[:2], low[2] + 0.35 * (high[2] - low[2])]),
        ("coronal, through the condyles", FRONT, [whole[0], condyles[1], whole[2]]),
        ("sagittal, median", RIGHT, [middle[0], *whole[1:]]),
    ]
    plates = [_plane(volume, labels, np.array(at), view, size, name) for name, view, at in planes]
    hard = labels.mask(BONE, MANDIBLE)
    for mask, view, name in (
        (~labels.mask(AIR), OBLIQUE, "skin"),
        (hard, OBLIQUE, "bones"),
        (hard, FRONT, "bones from the front"),
    ):
        plates.append(surface_plate(labels, mask, view, size, name))
    return plates


def legend(labels: Labels) -> dict[str, tuple[float, float, float]]:
    """Colour (red, green, blue from 0 to 1) of every label that is there, by name."""
    present = set(np.unique(labels.values).tolist())
    return {NAMES[n]: colour for n, colour in COLOURS.items() if n in present}


def _axes(view: tuple[tuple[float, ...], tuple[float, ...]]) -> Floats:
    right = np.array(view[0]) / np.linalg.norm(view[0])
    up = np.array(view[1]) - right * (right @ np.array(view[1]))
    up /= np.linalg.norm(up)
    return frozen(np.stack([right, up, np.cross(right, up)]))


def _pixels(centre: Floats, axes: Floats, size: tuple[int, int]) -> Floats:
    """Points (h, w, 3) in mm of the middles of pixels, the first row on top."""
    width, height = size
    across = (np.arange(width) + 0.5 - width / 2) * PIXEL
    down = (np.arange(height) + 0.5 - height / 2) * PIXEL
    return np.asarray(centre + across[None, :, None] * axes[0] - down[:, None, None] * axes[1])


def _nearest(values: Grid, indices: Floats, outside: float) -> Grid:
    """Values at the voxels nearest to indices (..., 3)."""
    near = np.rint(indices).astype(np.int64)
    shape = np.array(values.shape[::-1])
    inside = ((near >= 0) & (near < shape)).all(axis=-1)
    x, y, z = np.moveaxis(np.clip(near, 0, shape - 1), -1, 0)
    return np.where(inside, values[z, y, x], outside)


def _plane(
    volume: Volume,
    labels: Labels,
    centre: Floats,
    view: tuple[tuple[float, ...], tuple[float, ...]],
    size: tuple[int, int],
    caption: str,
) -> Plate:
    """Grey values of a plane under a veil of its labels' colours."""
    axes = _axes(view)
    points = _pixels(centre, axes, size)
    hounsfield = _nearest(volume.values, volume.frame.indices(points), -1000)
    grey = np.clip((hounsfield - WINDOW[0]) / (WINDOW[1] - WINDOW[0]), 0, 1)[..., None]
    found = _nearest(labels.values, labels.frame.indices(points), AIR).astype(int)
    table = np.zeros((max(NAMES) + 1, 3))
    for number, colour in COLOURS.items():
        table[number] = colour
    veil = np.where(found == CAVITY, 0.8, VEIL)[..., None] * (found != AIR)[..., None]
    colours = (1 - veil) * grey + veil * table[found]
    outside = found == AIR
    colours[outside] = 1 - 0.8 * grey[outside]  # on white, so that what was taken away is seen
    return Plate(frozen(colours), centre, axes, caption)


def surface_plate(
    labels: Labels,
    mask: Bools,
    view: tuple[tuple[float, ...], tuple[float, ...]],
    size: tuple[int, int],
    caption: str,
) -> Plate:
    """How a mask (z, y, x) looks: rays step through it, shaded by the slope of its blurred edge."""
    axes = _axes(view)
    centre = labels.frame.points((np.array(labels.values.shape[::-1]) - 1) / 2)
    soft = ndimage.gaussian_filter(mask.astype(np.float32), 0.8)
    reach = 0.5 * float(np.linalg.norm(np.array(mask.shape[::-1]) * labels.frame.spacing))
    step = float(labels.frame.spacing.min())
    hit, where = _first_hits(labels, soft, _pixels(centre, axes, size), axes[2], reach, step)
    light = _axes(view)[2] * 0.75 + axes[1] * 0.5 - axes[0] * 0.35
    shade = _shade(labels, soft, where[hit], light / np.linalg.norm(light))
    found = _nearest(labels.values, where[hit] - 0.8 * (axes[2] @ labels.frame.axes), AIR).astype(
        int
    )
    tint = np.array([COLOURS.get(n, COLOURS[BONE]) for n in range(max(NAMES) + 1)])
    colours = np.ones((*hit.shape, 3))
    colours[hit] = tint[found] * shade[:, None]
    return Plate(frozen(colours), centre, axes, caption)


def _first_hits(
    labels: Labels, soft: Grid, points: Floats, towards: Floats, reach: float, step: float
) -> tuple[Bools, Floats]:
    """Which rays (h, w) hit, and at which indices (h, w, 3)."""
    start = labels.frame.indices(points + reach * towards)
    advance = -step * (towards @ labels.frame.axes) / labels.frame.spacing
    where = start.reshape(-1, 3)
    hit = np.zeros(len(where), np.bool_)
    under_way = np.arange(len(where))
    shape = np.array(soft.shape[::-1])
    for _ in range(int(2 * reach / step)):
        where[under_way] += advance
        now = _nearest(soft, where[under_way], 0) > 0.5
        hit[under_way[now]] = True
        gone = ((advance > 0) & (where[under_way] > shape)) | (
            (advance < 0) & (where[under_way] < 0)
        )
        under_way = under_way[~now & ~gone.any(axis=1)]
    return hit.reshape(points.shape[:2]), where.reshape(points.shape)


def _shade(labels: Labels, soft: Grid, where: Floats, light: Floats) -> Floats:
    """Brightness (m,) from 0 to 1 at indices (m, 3) by the direction of the blurred edge there."""
    slopes = []
    for axis in range(3):
        ends = []
        for side in (-1.0, 1.0):
            beside = where.copy()
            beside[:, axis] += side
            ends.append(ndimage.map_coordinates(soft, beside.T[::-1], order=1, mode="nearest"))
        slopes.append((ends[0] - ends[1]) / labels.frame.spacing[axis])
    normal = np.stack(slopes, axis=1) @ labels.frame.axes.T
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-9)
    return np.asarray(0.25 + 0.75 * np.clip(normal @ light, 0, 1))
