# SPDX-License-Identifier: BSD-3-Clause
"""A picture of a head in space: values on a grid that may stand obliquely. LPS, mm, HU."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
import numpy.typing as npt
from scipy import ndimage

from bezsoma.arrays import Floats, Ints, frozen
from bezsoma.errors import InputError

Grid = npt.NDArray[Any]
SQUARE = 1e-3
"""By how much the axes of a grid may miss the right angle."""


@dataclass(frozen=True, eq=False)
class Frame:
    """Where voxels lie: spacing (3,) and origin (3,) in mm, axes (3, 3) as columns, in LPS.

    Voxel (i, j, k) has its centre at origin + axes @ (spacing * (i, j, k)). An index counts
    along x, y, z, the array holds it as values[k, j, i].

    >>> turned = Frame([1, 1, 2], [5, 0, 0], [[0, -1, 0], [1, 0, 0], [0, 0, 1]])
    >>> turned.points(np.array([3, 0, 1])).tolist()
    [5.0, 3.0, 2.0]
    >>> turned.indices(turned.points(np.array([3, 1, 2]))).tolist()
    [3.0, 1.0, 2.0]

    Axes of a mirrored frame are refused, since they would swap left and right in silence:

    >>> Frame([1, 1, 1], [0, 0, 0], np.diag([-1, 1, 1]))
    Traceback (most recent call last):
    bezsoma.errors.InputError: the axes of the picture are a mirror image ...
    """

    spacing: Floats
    origin: Floats
    axes: Floats

    def __post_init__(self) -> None:
        for name, shape in (("spacing", (3,)), ("origin", (3,)), ("axes", (3, 3))):
            array = np.array(getattr(self, name), np.float64)
            if array.shape != shape or not np.isfinite(array).all():
                raise InputError(
                    f"{name} of the picture has to be {shape} finite numbers, not {array.tolist()}"
                )
            object.__setattr__(self, name, frozen(array))
        if not (self.spacing > 0).all():
            raise InputError(
                f"voxels of {self.spacing.tolist()} mm; all three must be positive: export the "
                "picture again with its spacing, or write the true one into its header"
            )
        if np.abs(self.axes.T @ self.axes - np.eye(3)).max() > SQUARE:
            raise InputError(
                f"the axes of the picture are {self.axes.T.tolist()}: not unit vectors at right "
                "angles; export it again without shear"
            )
        if np.linalg.det(self.axes) < 0:
            raise InputError(
                "the axes of the picture are a mirror image (left-handed): which side is left "
                "would be a guess; export it again, or turn one axis over together with its values"
            )

    def points(self, indices: Floats | Ints) -> Floats:
        """Points (..., 3) in mm of indices (..., 3) along x, y, z."""
        return np.asarray((indices * self.spacing) @ self.axes.T + self.origin)

    def indices(self, points: Floats) -> Floats:
        """Indices (..., 3), with fractions, of points (..., 3) in mm."""
        return np.asarray((points - self.origin) @ self.axes / self.spacing)


@dataclass(frozen=True, eq=False)
class Volume:
    """Values (z, y, x) on a frame, HU if it is a CT; `notes` say what reading had to change."""

    values: Grid
    frame: Frame
    notes: tuple[str, ...] = ()

    @property
    def shape(self) -> tuple[int, int, int]:
        """Voxels along x, y, z."""
        z, y, x = self.values.shape
        return x, y, z

    @property
    def corners(self) -> Floats:
        """Centres (8, 3) of the corner voxels in mm."""
        last = np.array(self.shape) - 1
        return self.frame.points(np.stack(np.meshgrid(*[[0, n] for n in last]), -1).reshape(-1, 3))

    def noted(self, *notes: str) -> Volume:
        """The same with more notes."""
        return replace(self, notes=self.notes + notes)

    def with_values(self, values: Grid) -> Volume:
        """Other values (z, y, x) on the same frame."""
        return replace(self, values=values)

    def cropped(self, low: Ints, high: Ints) -> Volume:
        """The part from index `low` (3,) up to, without, `high` (3,), along x, y, z."""
        part = tuple(slice(a, b) for a, b in zip(low[::-1], high[::-1], strict=True))
        origin = self.frame.points(np.asarray(low))
        return replace(self, values=self.values[part], frame=replace(self.frame, origin=origin))

    def along_lps(self) -> Volume:
        """The same voxels with axes exchanged and turned over, so that x runs most to the left.

        No value is changed and none is lost; an oblique frame stays oblique.

        >>> ras = Frame([1, 1, 2], [10, 20, 0], np.diag([-1, -1, 1]))
        >>> volume = Volume(np.arange(24).reshape(2, 3, 4), ras).along_lps()
        >>> volume.frame.axes.tolist() == np.eye(3).tolist(), volume.frame.origin.tolist()
        (True, [7.0, 18.0, 0.0])
        >>> int(volume.values[0, 0, 0])
        11
        """
        order = _nearest_axes(self.frame.axes)
        axes = self.frame.axes[:, order]
        signs = np.where(np.diagonal(axes) < 0, -1, 1)
        last = (np.array(self.shape)[order] - 1) * (signs < 0)
        corner = np.empty(3)
        corner[order] = last
        frame = Frame(self.frame.spacing[order], self.frame.points(corner), axes * signs)
        values = self.values.transpose([2 - a for a in order[::-1]])
        flips = tuple(slice(None, None, int(s)) for s in signs[::-1])
        return replace(self, values=values[flips], frame=frame)

    def parted(self, parts: Ints) -> Volume:
        """Every voxel parted in whole numbers (3,) along x, y, z, linear between; float32.

        The voxels that were there stay, every `parts` of the new ones; with ones nothing changes.

        >>> line = Volume(np.array([[[0, 4, 2]]]), Frame([2, 1, 1], [0, 0, 0], np.eye(3)))
        >>> fine = line.parted(np.array([4, 1, 1]))
        >>> fine.values.tolist(), fine.frame.spacing.tolist()
        ([[[0.0, 1.0, 2.0, 3.0, 4.0, 3.5, 3.0, 2.5, 2.0]]], [0.5, 1.0, 1.0])
        """
        values = self.values
        for axis, n in enumerate(parts[::-1].tolist()):
            if n > 1:
                values = _parted(np.moveaxis(values, axis, 0), n)
                values = np.moveaxis(values, 0, axis)
        frame = replace(self.frame, spacing=self.frame.spacing / parts)
        return replace(self, values=values, frame=frame)

    def resampled(
        self, frame: Frame, shape: tuple[int, int, int], order: Literal[0, 1] = 1
    ) -> Volume:
        """Values on another grid, linear between voxels (order 0: the nearest); outside: edge.

        >>> line = Volume(np.arange(5.0).reshape(1, 1, 5), Frame([2, 1, 1], [0, 0, 0], np.eye(3)))
        >>> half = Frame([1, 1, 1], [0, 0, 0], np.eye(3))
        >>> line.resampled(half, (9, 1, 1)).values[0, 0].tolist()
        [0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0]
        """
        turn = self.frame.axes.T @ frame.axes * frame.spacing / self.frame.spacing[:, None]
        start = self.frame.indices(frame.origin)
        values = ndimage.affine_transform(
            self.values, turn[::-1, ::-1], start[::-1], shape[::-1], order=order, mode="nearest"
        )
        return replace(self, values=values, frame=frame)


def _parted(values: Grid, n: int) -> Grid:
    """Values with n - 1 more between each two along the first axis, linear, float32."""
    last = len(values) - 1
    fine = np.empty((last * n + 1, *values.shape[1:]), np.float32)
    fine[::n] = values
    step = np.diff(fine[::n], axis=0)
    for k in range(1, n):
        fine[k::n] = fine[:-1:n] + np.float32(k / n) * step
    return fine


def _nearest_axes(axes: Floats) -> Ints:
    """Which column is nearest to each of x, y, z, all different."""
    order, left = np.zeros(3, np.int64), np.abs(axes)
    for _ in range(3):
        row, column = np.unravel_index(left.argmax(), left.shape)
        order[row] = column
        left[row], left[:, column] = -1, -1
    return order
