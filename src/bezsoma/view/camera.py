# SPDX-License-Identifier: BSD-3-Clause
"""Orthographic cameras named by anatomy, and the letters that say which side is which.

The frame is LPS: x to the patient's left, y to posterior, z to superior. A view is named by
where the viewer stands; seen from the front, the patient's left is on the viewer's right.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from bezsoma.arrays import Floats, frozen
from bezsoma.errors import InputError, unknown

VIEWS = MappingProxyType(
    {
        "front": ((0.0, -1.0, 0.0), (0.0, 0.0, 1.0)),
        "back": ((0.0, 1.0, 0.0), (0.0, 0.0, 1.0)),
        "left": ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
        "right": ((-1.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
        "three-quarter": ((-0.60, -0.78, 0.12), (0.0, 0.0, 1.0)),
        "three-quarter left": ((0.60, -0.78, 0.12), (0.0, 0.0, 1.0)),
        "bottom": ((0.0, 0.0, -1.0), (0.0, -1.0, 0.0)),
        "top": ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0)),
    }
)
"""For every view the direction towards the viewer, and which way is up in the picture."""
_LETTERS = (("L", "R"), ("P", "A"), ("S", "I"))


@dataclass(frozen=True, eq=False)
class Camera:
    """An orthographic camera: no vanishing point, so a millimetre is as long near as far."""

    axes: Floats
    """(3, 3) rows: to the viewer's right, up, and towards the viewer; orthonormal."""
    centre: Floats
    """(3,) the point in mm that lands in the middle of the picture."""
    scale: float
    """Pixels per mm."""
    size: tuple[int, int]
    """Width and height in pixels."""

    def seen(self, points: Floats) -> Floats:
        """Points (..., 3) in the camera's frame: right, up, towards the viewer, in mm."""
        return np.asarray((points - self.centre) @ self.axes.T)

    def pixels(self, points: Floats) -> Floats:
        """Where points (..., 3) in mm land: column and row (..., 2) in pixels.

        Columns run to the right from the left rim, rows down from the upper rim; the middle of
        the first pixel is (0.5, 0.5).

        >>> camera = Camera(axes("front"), np.zeros(3), 2.0, (100, 80))
        >>> camera.pixels(np.array([10.0, 7.0, 5.0])).tolist()  # left, so right; up, so above
        [70.0, 30.0]
        """
        across, up = np.moveaxis(self.seen(points)[..., :2], -1, 0)
        width, height = self.size
        return np.stack([width / 2 + self.scale * across, height / 2 - self.scale * up], axis=-1)

    def letters(self) -> tuple[str, str, str, str]:
        """What lies to the viewer's right, left, above and below: 'L', 'R', 'A', 'P', 'S', 'I'.

        >>> Camera(axes("front"), np.zeros(3), 1.0, (1, 1)).letters()
        ('L', 'R', 'S', 'I')
        >>> Camera(axes("right"), np.zeros(3), 1.0, (1, 1)).letters()
        ('A', 'P', 'S', 'I')
        """
        right, above = (direction_letters(axis) for axis in self.axes[:2])
        left, below = (direction_letters(-axis) for axis in self.axes[:2])
        return right, left, above, below

    def facing(self) -> str:
        """The side of the patient that faces the viewer, as letters."""
        return direction_letters(self.axes[2])


def direction_letters(direction: Floats, least: float = 0.35) -> str:
    """Anatomical letters of a unit direction (3,), the strongest first; weak parts are left out.

    >>> direction_letters(np.array([0.0, -0.8, 0.6])), direction_letters(np.array([1.0, 0, 0]))
    ('AS', 'L')
    """
    order = np.argsort(-np.abs(direction), kind="stable")
    strong = [i for i in order if abs(direction[i]) >= least]
    return "".join(_LETTERS[i][0 if direction[i] > 0 else 1] for i in strong)


def axes(view: str) -> Floats:
    """The camera's axes (3, 3) of a named view: right, up and towards the viewer as rows.

    They are right-handed in every view, so no picture is a mirror image:

    >>> bool(all(np.isclose(np.linalg.det(axes(view)), 1.0) for view in VIEWS))
    True
    """
    if view not in VIEWS:
        raise InputError(unknown("view", view, VIEWS, "a picture"))
    towards, up = (np.array(vector) for vector in VIEWS[view])
    towards = towards / np.linalg.norm(towards)
    right = np.cross(up, towards)
    right /= np.linalg.norm(right)
    return frozen(np.stack([right, np.cross(towards, right), towards]))


def turned(frame: Floats, degrees: float) -> Floats:
    """The axes (3, 3) of a viewer who walked to the right around what is seen, by an angle.

    The axis is that of the patient's which is nearest to up, so what stands upright stays so, and
    who looked down a little looks down from everywhere. A quarter of the way round from the front
    is the patient's left:

    >>> bool(np.allclose(turned(axes("front"), 90.0), axes("left")))
    True
    """
    cos, sin = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    nearest = int(np.abs(frame[1]).argmax())
    axis = np.sign(frame[1, nearest]) * np.eye(3)[nearest]
    along = np.outer(frame @ axis, axis)
    return frozen(cos * frame + sin * np.cross(axis, frame) + (1 - cos) * along)


def around(
    frames: Sequence[Floats], points: Floats, size: tuple[int, int], margin: float = 0.07
) -> list[Camera]:
    """Cameras with these axes, of one centre and one scale, each of which shows all points."""
    centre = frozen((points.min(axis=0) + points.max(axis=0)) / 2)
    room = np.array(size) * (0.5 - margin)
    reach = [np.abs((points - centre) @ frame[:2].T).max(axis=0) for frame in frames]
    least = 1e-12 * max(1.0, float(np.abs(points).max()))
    scale = float((room / np.maximum(reach, least)).min())
    return [Camera(frame, centre, scale, size) for frame in frames]


def fitted(view: str, points: Floats, size: tuple[int, int], margin: float = 0.07) -> Camera:
    """The camera of a named view that shows all points (p, 3) in mm, with a margin around."""
    return fitted_alike(axes(view), [points], size, margin)[0]


def fitted_alike(
    frame: Floats, subjects: Sequence[Floats], size: tuple[int, int], margin: float = 0.07
) -> list[Camera]:
    """A camera with these axes for the points (p, 3) of each subject, all of one scale."""
    room = np.array(size) * (1 - 2 * margin)
    centres, scales = [], []
    for points in subjects:
        low, high = (bound(points @ frame.T, axis=0) for bound in (np.min, np.max))
        extent = np.maximum(high - low, 1e-12 * max(1.0, float(np.abs(points).max())))
        scales.append(float((room / extent[:2]).min()))
        centres.append(frozen((low + high) / 2 @ frame))
    return [Camera(frame, centre, min(scales), size) for centre in centres]
