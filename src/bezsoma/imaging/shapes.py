# SPDX-License-Identifier: BSD-3-Clause
"""Rounded bodies by formula, cast into a grid of voxels: what the CT phantom is made of. mm."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from bezsoma.arrays import Floats, Ints
from bezsoma.imaging.volume import Frame

Singles = npt.NDArray[np.float32]
FAR = 60.0
"""mm; what lies further from a body than this need not be told apart."""
NEAR = 4.0
"""mm; levels are told apart at least as far as this from a body."""


@dataclass(frozen=True)
class Ellipsoid:
    """An ellipsoid about `middle` with half axes `half` along x, y, z, in mm.

    Its level is k (k - 1) / l with k = |q / half|, l = |q / half^2|: zero on the surface, and near
    it the distance to first order.

    >>> egg = Ellipsoid((0, 0, 0), (4, 2, 1))
    >>> egg.level(np.array([[4, 0, 0], [4.01, 0, 0], [0, 0, 0.99]])).round(3).tolist()
    [0.0, 0.01, -0.01]
    """

    middle: tuple[float, float, float]
    half: tuple[float, float, float]

    def box(self) -> Floats:
        """The two corners (2, 3) around it."""
        return np.asarray(np.array([self.middle] * 2) + np.outer([-1, 1], self.half))

    def level(self, points: Floats) -> Floats:
        """Levels (...) at points (..., 3)."""
        q = (points - _as(points, self.middle)) / _as(points, self.half)
        k = np.sqrt(np.einsum("...d,...d->...", q, q)) + 1e-9
        q = q / _as(points, self.half)
        return np.asarray(k * (k - 1) / (np.sqrt(np.einsum("...d,...d->...", q, q)) + 1e-9))


@dataclass(frozen=True)
class Rod:
    """A rod from `start` to `end` with round ends, in mm; its radius runs from first to second.

    `tall` stretches it along z. Its level is the distance to the axis less the radius there.

    >>> rod = Rod((0, 0, 0), (10, 0, 0), 2, 3)
    >>> rod.level(np.array([[0.0, 2, 0], [5, 0, 2.5], [14, 0, 0]])).tolist()
    [0.0, 0.0, 1.0]
    """

    start: tuple[float, float, float]
    end: tuple[float, float, float]
    first: float
    second: float
    tall: float = 1.0

    def box(self) -> Floats:
        """The two corners (2, 3) around it."""
        ends = np.array([self.start, self.end])
        reach = max(self.first, self.second) * np.array([1, 1, self.tall])
        return np.stack([ends.min(axis=0) - reach, ends.max(axis=0) + reach])

    def level(self, points: Floats) -> Floats:
        """Levels (...) at points (..., 3)."""
        stretch = _as(points, (1, 1, self.tall))
        a, b = _as(points, self.start) / stretch, _as(points, self.end) / stretch
        q, axis = points / stretch - a, b - a
        part = np.clip(q @ axis / max(float(axis @ axis), 1e-12), 0, 1)
        off = q - part[..., None] * axis
        radius = self.first + part * (self.second - self.first)
        return np.asarray(np.sqrt(np.einsum("...d,...d->...", off, off)) - radius)


@dataclass(frozen=True)
class Turned:
    """A body turned about an axis along x through `pivot`, by an angle in rad, y towards z."""

    body: Ellipsoid | Rod
    pivot: tuple[float, float, float]
    angle: float

    @property
    def _turn(self) -> Floats:
        c, s = np.cos(self.angle), np.sin(self.angle)
        return np.array([[1, 0, 0], [0, c, -s], [0, s, c]])

    def box(self) -> Floats:
        """The two corners (2, 3) around it."""
        low, high = self.body.box()
        corners = np.stack(np.meshgrid(*zip(low, high, strict=True)), -1).reshape(-1, 3)
        moved = (corners - self.pivot) @ self._turn.T + self.pivot
        return np.stack([moved.min(axis=0), moved.max(axis=0)])

    def level(self, points: Floats) -> Floats:
        """Levels (...) at points (..., 3)."""
        pivot, turn = _as(points, self.pivot), _as(points, self._turn)
        return self.body.level((points - pivot) @ turn + pivot)


def _as(points: Floats, numbers: object) -> Floats:
    """Numbers of the same precision as points, which for a grid is single."""
    return np.asarray(numbers, points.dtype)


Body = Ellipsoid | Rod | Turned


@dataclass(frozen=True, eq=False)
class Grid:
    """A grid of voxels (x, y, z) to cast bodies into."""

    frame: Frame
    shape: tuple[int, int, int]

    def empty(self) -> Singles:
        """Levels (z, y, x) of nothing at all."""
        return np.full(self.shape[::-1], FAR, np.float32)

    def cast(self, bodies: Sequence[Body], blend: float = 0.0, margin: float = NEAR) -> Singles:
        """Levels (z, y, x) of the union of bodies, negative inside, blended over `blend` mm.

        The blend of levels a and b is min(a, b) - h^2/(4 blend) with h = max(blend - |a - b|, 0).
        Where no body is nearer than `margin` mm it is FAR.
        """
        levels = self.empty()
        for body in bodies:
            part, points = self._around(body.box(), margin + blend)
            if points.size:
                a, b = levels[part], body.level(points).astype(np.float32)
                near = np.maximum(blend - np.abs(a - b), 0)
                levels[part] = np.minimum(a, b) - (near**2 / (4 * blend) if blend else 0)
        return levels

    def _around(self, box: Floats, margin: float) -> tuple[tuple[slice, ...], Floats]:
        """The part of the grid around a box in mm, and its voxels' centres (z, y, x, 3)."""
        low, high = box[0] - margin, box[1] + margin
        corners = np.stack(np.meshgrid(*zip(low, high, strict=True)), -1).reshape(-1, 3)
        index = self.frame.indices(corners)
        first = np.clip(np.floor(index.min(axis=0)).astype(int), 0, self.shape)
        last = np.clip(np.ceil(index.max(axis=0)).astype(int) + 1, first, self.shape)
        return (
            tuple(slice(a, b) for a, b in zip(first[::-1], last[::-1], strict=True)),
            self.points(first, last),
        )

    def points(self, first: npt.ArrayLike = (0, 0, 0), last: npt.ArrayLike | None = None) -> Floats:
        """Centres (z, y, x, 3) in mm of the voxels from one index up to, without, another."""
        low, high = np.asarray(first), np.asarray(self.shape if last is None else last)
        steps = self.frame.axes * self.frame.spacing
        x, y, z = (
            (np.arange(a, b)[:, None] * step).astype(np.float32)
            for a, b, step in zip(low, high, steps.T, strict=True)
        )
        origin = self.frame.origin.astype(np.float32)
        return np.asarray(z[:, None, None] + (y[:, None] + (x + origin)))


def coverage(levels: Singles) -> tuple[Ints, Singles]:
    """Which voxels a body reaches, as flat numbers (m,), and what part (m,) of each is inside.

    A plane cuts a voxel into parts that depend on its offset and direction; to first order the
    part is 1/2 - f / (|f_x| + |f_y| + |f_z|), f_i the change of the level over a voxel, whatever
    the levels' scale. A plane half a voxel away along an axis leaves the voxel untouched:

    >>> levels = np.broadcast_to(3 * (np.arange(5.0) - 1.75), (5, 5, 5)).astype(np.float32)
    >>> reached, part = coverage(levels)
    >>> part[reached // 5 == 12].tolist()
    [1.0, 1.0, 0.25]
    """
    flat = levels.ravel()
    reached = np.flatnonzero(flat < NEAR)
    part = np.ones(len(reached), np.float32)
    mixed = np.flatnonzero(flat[reached] > -NEAR)
    place = np.stack(np.unravel_index(reached[mixed], levels.shape))
    width = np.zeros(len(mixed), np.float32)
    for axis in range(3):
        ends = []
        for step in (-1, 1):
            beside = place.copy()
            beside[axis] = np.clip(beside[axis] + step, 0, levels.shape[axis] - 1)
            ends.append(np.clip(levels[tuple(beside)], -NEAR, NEAR))
        width += np.abs(ends[1] - ends[0]) / 2
    level = flat[reached[mixed]]
    part[mixed] = np.clip(0.5 - level / np.maximum(width, 1e-6), 0, 1)
    some = part > 0
    return reached[some], part[some]
