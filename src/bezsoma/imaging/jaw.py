# SPDX-License-Identifier: BSD-3-Clause
"""The mandible apart from the skull, also where a condyle touches its fossa or teeth touch.

Every piece of bone belongs to the side that it is joined to by the wider bridge. A neck of a
condyle is wider than the patch where the condyle touches, a root wider than where two teeth meet.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy import ndimage

from bezsoma.arrays import Bools, Floats, Ints
from bezsoma.errors import InputError
from bezsoma.imaging.bone import MARROW_HU, marrow
from bezsoma.imaging.head_mask import distance
from bezsoma.imaging.settings import LabelSettings
from bezsoma.imaging.volume import Frame

STEP = 0.2
"""mm: widths closer than this count as equal, and distance decides."""
CROWN = 80.0
"""mm: so far below its top there is nothing but skull."""
CAP = 20.0
"""mm below the top of the skull, where its vault is broad and a spine is not."""
VAULT = (65.0, 230.0)
"""mm: from how wide and long to how wide and long the vault is there."""
TALLEST = 245.0
"""mm: a chin lies no further below the top of the skull."""
BAND = 15.0
"""mm to either side of the median plane where the chin is looked for."""
BEHIND = 30.0
"""mm: a chin lies no further behind the front of the face."""
DEPTH = 50.0
"""mm: in the median plane, what lies so far behind the chin is no mandible."""
HEIGHT = 14.0
"""mm: so much of the chin's height is taken as its seed."""
LEAST, MOST = 8e3, 250e3
"""mm3 of a mandible."""


@dataclass(frozen=True, eq=False)
class Seeds:
    """Voxels (m, 3) along x, y, z that certainly belong to the skull and to the mandible."""

    skull: Ints
    chin: Ints


def seeds(found: Bools, frame: Frame, settings: LabelSettings) -> Seeds:
    """Where to start: given points, or crown and chin by the anatomy of an upright head (LPS)."""
    index = np.argwhere(found)[:, ::-1]
    if not len(index):
        raise InputError(
            f"no bone is in view (nothing above {settings.bone:g} HU); is it a CT in HU of a head?"
        )
    points = frame.points(index)
    if settings.skull is not None:
        skull = _seed(settings.skull, "skull", index, points)
    else:
        skull = index[points[:, 2] > points[:, 2].max() - CROWN]
        _check_cap(points[points[:, 2] > points[:, 2].max() - CAP])
    if settings.chin is not None:
        chin = _seed(settings.chin, "chin", index, points)
    else:
        chin = index[_chin(points, frame)]
    if settings.skull is None:
        skull = np.concatenate([skull, index[_behind(points, frame.points(chin))]])
    return Seeds(skull, chin)


def _seed(point: tuple[float, float, float], name: str, index: Ints, points: Floats) -> Ints:
    """The bone within 3 mm of a given point."""
    gap = np.linalg.norm(points - np.array(point), axis=1)
    if gap.min() > 3:
        raise InputError(
            f"{name}={point} is no point of bone: the nearest bone lies {gap.min():.4g} mm away; "
            "points are mm in LPS (x to the left, y to posterior, z to superior)"
        )
    return np.asarray(index[gap <= 3])


def _check_cap(points: Floats) -> None:
    """Refuses a top (m, 3) that is no vault: a neck, or half a head."""
    x, y, _ = np.ptp(points, axis=0)
    if not (VAULT[0] <= x <= VAULT[1] and VAULT[0] <= y <= VAULT[1]):
        raise InputError(
            f"the uppermost {CAP:g} mm of bone measure {x:.4g} mm from side to side and {y:.4g} "
            f"from front to back, a vault of a skull {VAULT[0]:g} to {VAULT[1]:g}: the head is "
            "upside down, not upright, or its top is not in view; say skull=(x, y, z) and chin=, "
            "points in their bone (mm, LPS)"
        )


def _chin(points: Floats, frame: Frame) -> Bools:
    """Which of the bone's points (b, 3) are the chin: the lowest bone of the face's front."""
    top = points[:, 2].max()
    crown = points[points[:, 2] > top - CROWN]
    middle = (crown[:, 0].min() + crown[:, 0].max()) / 2
    face = (points[:, 2] < top - CROWN) & (points[:, 2] > top - TALLEST)
    face &= np.abs(points[:, 0] - middle) < BAND
    if not face.any():
        raise InputError(
            f"no bone lies more than {CROWN:g} mm below the top of the skull: the lower jaw is not "
            "in view, or the head does not stand upright (z has to point to superior)"
        )
    front = float(np.percentile(points[face, 1], 0.5))
    near = face & (points[:, 1] < front + BEHIND)
    lowest = float(points[near, 2].min())
    chin = near & (points[:, 2] < lowest + HEIGHT)
    bottom = frame.points(np.zeros(3))[2]
    if top - lowest < 130:
        raise InputError(
            f"the lowest bone of the face lies only {top - lowest:.4g} mm below the top of the "
            "skull: the chin is not in view, or the head is upside down; otherwise say chin=(x, y, "
            "z), a point in the bone of the chin, and skull="
        )
    if lowest - bottom < 2 * frame.spacing[2] and frame.axes[2, 2] > 0.99:
        raise InputError(
            "the chin is cut by the lowest slice; a picture of the whole jaw is needed"
        )
    return np.asarray(chin)


def _behind(points: Floats, chin: Floats) -> Bools:
    """Which points (b, 3) lie in the median plane, far behind the chin (c, 3): the spine."""
    x, y, _ = chin.mean(axis=0)
    return np.asarray((np.abs(points[:, 0] - x) < BAND) & (points[:, 1] > y + DEPTH))


def mandible(found: Bools, frame: Frame, settings: LabelSettings) -> tuple[Bools, float]:
    """The mandible among the bone (z, y, x), and the half width in mm of the widest bridge cut.

    0 means that it hung together with the skull nowhere.
    """
    start = seeds(found, frame, settings)
    side, bridge = flooded(distance(found, frame.spacing), start)
    jaw = side == 2
    jaw |= _loose(found & (side == 0), jaw, side == 1, frame.spacing)
    volume = float(jaw.sum() * np.prod(frame.spacing))
    if not LEAST <= volume <= MOST:
        raise InputError(
            f"the mandible cannot be told apart: {volume / 1e3:.4g} cm3 of bone hang together with "
            f"the chin (a mandible has {LEAST / 1e3:g} to {MOST / 1e3:g}; skull and jaw meet by a "
            f"bridge {2 * bridge:.3g} mm wide); say chin= and skull=, points in their bone, raise "
            "bone=, or give a segmentation"
        )
    return jaw, bridge


def with_marrow(jaw: Bools, values: Any, spacing: Floats, settings: LabelSettings) -> Bools:
    """The mandible with the marrow behind cortex that is thin or open in places.

    Apart from the skull it can be closed, by a ball of radius `cortex`, without growing to it; what
    then is a hole is marrow, and so are the gaps of the cortex beside it.
    """
    if settings.cortex == 0 or not jaw.any():
        return jaw
    room = np.ceil(2 * settings.cortex / spacing[::-1]).astype(int)
    box = tuple(
        slice(max(s.start - n, 0), s.stop + n)
        for s, n in zip(ndimage.find_objects(jaw.astype(np.int8))[0], room, strict=True)
    )
    part, hounsfield = jaw[box], values[box]
    near = distance(~part, spacing) <= settings.cortex
    closed = (distance(near, spacing) > settings.cortex) | part
    wide = replace(settings, marrow=4 * settings.marrow)
    inside = marrow(closed, hounsfield, spacing, wide) & ~closed
    if inside.any():
        inside |= closed & (distance(~inside, spacing) <= settings.cortex)
    whole = jaw.copy()
    whole[box] |= inside & (hounsfield > MARROW_HU)
    return whole


def flooded(width: Any, start: Seeds) -> tuple[Any, float]:
    """Sides (z, y, x): 1 skull, 2 mandible, 0 neither; and the width at which both first met.

    Floods from both seeds, through the widest bone first: at every level all that can be reached
    over bone at least so wide is taken, step by step, so that the nearer side wins a tie.
    """
    padded = np.pad(width, 1)
    flat, shape = padded.ravel(), padded.shape
    side = np.zeros(flat.shape, np.int8)
    strides = np.array([1, shape[2], shape[1] * shape[2]])
    for number, index in ((1, start.skull), (2, start.chin)):
        side[(index + 1) @ strides] = number
    offsets = _offsets(strides)
    bridge = 0.0
    edge = np.flatnonzero(side)
    for level in np.arange(np.ceil(flat.max() / STEP), -1, -1) * STEP:
        open_ = flat >= max(level, 1e-6)
        edge, met = _level(side, edge, open_, flat, offsets)
        bridge = max(bridge, level if met else 0.0)
    return side.reshape(shape)[1:-1, 1:-1, 1:-1], bridge


def _offsets(strides: Ints) -> Ints:
    """To the 18 neighbours that share a face or an edge, faces first."""
    steps = [np.array(s) - 1 for s in np.ndindex(3, 3, 3)]
    near = sorted((s for s in steps if 0 < np.abs(s).sum() < 3), key=lambda s: np.abs(s).sum())
    return np.array([s @ strides for s in near])


def _level(side: Any, edge: Ints, open_: Bools, flat: Any, offsets: Ints) -> tuple[Ints, bool]:
    """Take all that can be reached; the voxels that still border on bone, and whether sides met."""
    met = False
    waiting = []
    while len(edge):
        beside = edge[:, None] + offsets
        free = (side[beside] == 0) & (flat[beside] > 0)
        met |= bool(((side[beside] > 0) & (side[beside] != side[edge][:, None]) & open_[beside]
                     & open_[edge][:, None]).any())  # fmt: skip
        now = free & open_[beside]
        waiting.append(edge[(free & ~now).any(axis=1)])
        row, column = np.nonzero(now)
        taken, first = np.unique(beside[row, column], return_index=True)
        side[taken] = side[edge[row[first]]]
        edge = taken
    return (np.unique(np.concatenate(waiting)) if waiting else edge), met


def _loose(rest: Bools, jaw: Bools, skull: Bools, spacing: Floats) -> Bools:
    """Pieces that hang together with neither side but lie within 2 mm of the jaw alone: teeth."""
    parts, count = ndimage.label(rest, np.ones((3, 3, 3)))
    if not count:
        return rest
    to_jaw, to_skull = distance(~jaw, spacing), distance(~skull, spacing)
    numbers = np.arange(1, count + 1)
    near = ndimage.minimum(to_jaw, parts, numbers)
    far = ndimage.minimum(to_skull, parts, numbers)
    mine = np.concatenate([[False], (near < 2) & (near < far)])
    return np.asarray(mine[parts])
