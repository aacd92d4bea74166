# SPDX-License-Identifier: BSD-3-Clause
"""Landmarks of the skin found on its profile in the median plane, and on the cheeks. mm, LPS."""

from __future__ import annotations

import numpy as np
from scipy import ndimage

from bezsoma.arrays import Floats
from bezsoma.errors import InputError
from bezsoma.imaging.labelling import Labels
from bezsoma.imaging.meaning import AIR, MANDIBLE

STEP = 0.25
"""mm between samples along a line and from line to line."""
BAND = 15.0
"""mm to either side of the middle of the mandible where its chin is."""
CHIN = 22.0
"""mm above the lowest bone of the chin, up to which the chin's skin stands out."""
TURN = 0.3
"""mm: a smaller bump of the profile is none."""
PROFILE = (("fold", 25.0), ("lower_lip", 20.0), ("mouth", 14.0), ("upper_lip", 16.0))
"""What follows the chin upwards, valley and hill in turn, and within how many mm."""
NOSE = 45.0
"""mm above the upper lip, within which the tip of the nose stands out most."""
CHEEK = 0.45
"""Where the cheeks are looked at, as part of the breadth of the mandible from the middle."""


def face_points(labels: Labels) -> dict[str, Floats]:
    """Points (3,) of the skin by name: chin, fold, lips, nose_tip, cheeks, as far as they are seen.

    They are found by form alone, for tables and pictures: the chin stands out most over the bone of
    the chin; valleys and hills follow upwards. Where the profile has no such turn, what lies above
    is left out. No cephalometry rests on them.
    """
    jaw = np.argwhere(labels.mask(MANDIBLE))[:, ::-1]
    if not len(jaw):
        raise InputError(
            "the labels have no mandible, from which landmarks are looked for; make them with "
            "mandible=True, or give a segmentation that has one"
        )
    bone = labels.frame.points(jaw)
    low, high = bone.min(axis=0), bone.max(axis=0)
    middle = (low[0] + high[0]) / 2
    lowest = bone[np.abs(bone[:, 0] - middle) < BAND, 2].min()
    heights = np.arange(lowest - 5, lowest + 140, STEP)
    front = _front(labels, np.full(len(heights), middle), heights)
    found = _turns(heights, ndimage.gaussian_filter1d(front, 1.2 / STEP, mode="nearest"), lowest)
    points = {name: np.array([middle, front[i], heights[i]]) for name, i in found.items()}
    points.pop("mouth", None)
    if "chin" in points:
        height = points.get("lower_lip", points["chin"] + [0, 0, 20.0])[2]
        for name, side in (("left_cheek", 1), ("right_cheek", -1)):
            x = middle + side * CHEEK * (high[0] - low[0])
            y = _front(labels, np.array([x]), np.array([height]))[0]
            if np.isfinite(y):
                points[name] = np.array([x, y, height])
    return points


def _front(labels: Labels, x: Floats, z: Floats) -> Floats:
    """How far to the front (y, mm) the head reaches at x and z (m,); NaN where it is not met."""
    corners = np.stack(np.meshgrid(*[[0, n - 1] for n in labels.values.shape[::-1]]), -1)
    reach = labels.frame.points(corners.reshape(-1, 3))[:, 1]
    y = np.arange(reach.min(), reach.max(), STEP)
    points = np.stack([np.repeat(x, len(y)), np.tile(y, len(x)), np.repeat(z, len(y))], axis=1)
    where = labels.frame.indices(points).T[::-1]
    head = (labels.values != AIR).astype(np.float32)
    inside = ndimage.map_coordinates(head, where, order=1, mode="constant") > 0.5
    inside = inside.reshape(len(x), len(y))
    return np.where(inside.any(axis=1), y[inside.argmax(axis=1)], np.nan)


def _turns(heights: Floats, front: Floats, lowest: float) -> dict[str, int]:
    """Places in a profile by name; forward is negative, so a hill is a least value.

    >>> z = np.arange(0, 100, 0.25)
    >>> wave = -3 * np.cos((z - 10) / 12 * np.pi)  # hills at 10, 34, 58 mm, valleys between
    >>> [(name, float(z[i])) for name, i in _turns(z, wave, 0.0).items()][:4]
    [('chin', 10.0), ('fold', 22.0), ('lower_lip', 34.0), ('mouth', 46.0)]
    """
    near = np.flatnonzero((heights < lowest + CHIN) & np.isfinite(front))
    if not len(near):
        return {}
    at = int(near[front[near].argmin()])
    found = {"chin": at}
    sign = 1.0
    for name, reach in PROFILE:
        last = min(at + int(reach / STEP), len(front) - 1)
        turn = _extremum(sign * front[at : last + 1])
        if turn is None:
            return found
        at, sign = at + turn, -sign
        found[name] = at
    last = min(at + int(NOSE / STEP), len(front) - 1)
    part = front[at : last + 1]
    if np.isfinite(part).any():
        tip = int(np.nanargmin(part))
        if 0 < tip < len(part) - 1:
            found["nose_tip"] = at + tip
    return found


def _extremum(part: Floats) -> int | None:
    """Where values first reach a top from which they fall by `TURN` again."""
    top = 0
    for i, value in enumerate(part.tolist()):
        if not np.isfinite(value):
            return None
        if value > part[top]:
            top = i
        elif part[top] - value > TURN and part[top] - part[0] > TURN:
            return top
    return None
