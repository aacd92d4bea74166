# SPDX-License-Identifier: BSD-3-Clause
"""The part of a head that may move: tissue in a box of straight cuts, and what borders on it."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any, Literal

import numpy as np
from scipy import ndimage

from bezsoma.arrays import Bools, Floats
from bezsoma.errors import InputError
from bezsoma.imaging.head_mask import distance
from bezsoma.imaging.labelling import Labels
from bezsoma.imaging.meaning import AIR, BONE, CAVITY, MANDIBLE
from bezsoma.imaging.volume import Frame, Grid

SURFACES = ("skin", "skull", "mandible", "mucosa", "gap")
"""What may border on the tissue; `cut` are the sides of the box."""
SKIN, SKULL, JAW, MUCOSA, GAP = range(5)
MARGIN = 15.0
"""mm looked at beyond the box, so that what lies there still counts near its sides."""
SMALLEST = 20.0
"""mm: a box thinner than this holds no face."""
Corner = tuple[float | None, float | None, float | None]


@dataclass(frozen=True)
class DomainSettings:
    """Where the head is cut and what counts as bone there; mm, LPS."""

    low: Corner = (None, None, None)
    """mm: planes x, y, z at which the domain begins; None: by the distances below, or nowhere."""
    high: Corner = (None, None, None)
    """mm: those at which it ends."""
    below: float = 12.0
    """mm from the lowest point of the mandible to the lower plane."""
    above: float = 10.0
    """mm from its highest point to the upper plane."""
    behind: float = 8.0
    """mm from its hindmost point to the hind plane. In front and at the sides the skin ends it."""
    sealed: float = 5.0
    """mm: hollows of the skull with openings that a ball of this radius closes count as skull."""
    apart: float = 5.0
    """mm: where mandible and skull come nearer, as in joints and between teeth, no tissue is put,
    and what borders on that gap is free: so the two bones share no vertex. 0: no gap."""
    cover: float = 2.0
    """mm under the air outside that are tissue whatever their label: bone lies under skin."""
    hollows: Literal["filled", "open"] = "filled"
    """Whether other air inside the head counts as tissue, or stays, with a surface `mucosa`."""
    loose: float = 10.0
    """cm3: smaller pieces of bone, such as the hyoid, are neither held nor moved: tissue."""
    smooth: float = 0.8
    """mm, one sigma: how far the steps of voxels are smoothed."""

    def __post_init__(self) -> None:
        for name in ("sealed", "apart", "cover", "loose", "smooth"):
            value = getattr(self, name)
            if not (np.isfinite(value) and 0 <= value <= 100):
                raise InputError(f"{name}={value}: a number from 0 to 100 is needed")
        for name in ("below", "above", "behind"):
            if not (np.isfinite(getattr(self, name)) and abs(getattr(self, name)) <= 300):
                raise InputError(f"{name}={getattr(self, name)}: -300 to 300 mm can be")
        for name in ("low", "high"):
            corner = getattr(self, name)
            if len(corner) != 3 or not all(x is None or np.isfinite(x) for x in corner):
                raise InputError(f"{name}={corner}: three numbers in mm are needed, or None")
        if self.hollows not in ("filled", "open"):
            raise InputError(f"hollows={self.hollows!r}: say 'filled' or 'open'")

    def stated(self) -> dict[str, object]:
        """Name and value of every setting, for reports."""
        return {field.name: getattr(self, field.name) for field in fields(self)}


@dataclass(frozen=True, eq=False)
class Domain:
    """Tissue in a box: grids (z, y, x) on a frame, read between voxels. mm."""

    low: Floats
    """(3,) the corner of the box."""
    high: Floats
    open: Bools
    """(2, 3) whether the box ends in air, below and above along each axis: no cut."""
    frame: Frame
    level: Grid
    """Distance from the surface of the tissue, smoothed, negative inside."""
    exact: Grid
    """The same as the voxels have it."""
    border: Grid
    """What the nearest voxel outside the tissue is: an index into `SURFACES`."""
    to_segment: Grid
    """Distance from the mandible."""
    to_skin: Grid
    """Distance from the air outside."""
    thickness: Grid
    """How far apart the nearest two of skin, skull and mandible lie: a layer's thickness."""
    notes: tuple[str, ...]

    def at(self, grid: Grid, points: Floats, order: Literal[0, 1] = 1) -> Floats:
        """Values (p,) of one of its grids at points (p, 3): linear, or (order 0) of the nearest."""
        where = self.frame.indices(points).T[::-1]
        found = ndimage.map_coordinates(grid, where, order=order, mode="nearest", output=np.float64)
        return np.asarray(found)

    def volume(self) -> float:
        """mm3 of the voxels of tissue in the box."""
        inside = (self.exact < 0) & _inside(self.frame, self.exact.shape, self.low, self.high)
        return float(inside.sum() * np.prod(self.frame.spacing))


def domain(labels: Labels, settings: DomainSettings | None = None) -> Domain:
    """The part of a labelled head that may move, cut as the settings say."""
    settings = DomainSettings() if settings is None else settings
    low, high, open_ = _box(labels, settings)
    part, frame = _part(labels, low, high)
    inside = _inside(frame, part.shape, low, high)
    to_skin = distance(part != AIR, frame.spacing)
    jaw, skull, notes = _bones(part, to_skin, frame, settings)
    _check_bones(jaw & inside, skull & inside, low, high)
    to_jaw, to_skull = distance(~jaw, frame.spacing), distance(~skull, frame.spacing)
    voxel = float(frame.spacing.mean())  # distances run between middles of voxels
    gap = (to_jaw + to_skull < settings.apart + voxel) & (settings.apart > 0)
    near = np.maximum(to_jaw, to_skull) < settings.apart / 2 + voxel / 2
    border = np.full(part.shape, SKULL, np.uint8)
    border[part == AIR], border[jaw] = SKIN, JAW
    border[gap & (near | ~(jaw | skull))] = GAP
    tissue = ~((part == AIR) | jaw | skull | gap)
    if settings.hollows == "open":
        tissue &= part != CAVITY
        border[(part == CAVITY) & ~skull] = MUCOSA
    tissue, lost = _largest(tissue, inside, part == AIR, border)
    if lost:
        size = lost * float(np.prod(frame.spacing)) / 1e3
        notes.append(f"{size:.3g} cm3 of tissue hang together with the rest nowhere: left away")
    level, nearest = _signed(tissue, border, frame)
    sigma = settings.smooth / frame.spacing[::-1]
    smooth = ndimage.gaussian_filter(level, sigma, truncate=3) if settings.smooth else level
    thickness = np.sort(np.stack([to_skin, to_jaw, to_skull]), axis=0)[:2].sum(axis=0)
    return Domain(low, high, open_, frame, smooth, level, nearest, to_jaw, to_skin, thickness,
                  tuple(notes))  # fmt: skip


def _box(labels: Labels, settings: DomainSettings) -> tuple[Floats, Floats, Bools]:
    """Corners of the box, and which of its sides end in air."""
    jaw = np.argwhere(labels.mask(MANDIBLE))[:, ::-1]
    if not len(jaw):
        raise InputError(
            "the labels have no mandible, from which the domain is measured; make them with "
            "mandible=True, or give a segmentation that has one"
        )
    bone = labels.frame.points(jaw)
    head = labels.frame.points(np.argwhere(labels.values != AIR)[:, ::-1])
    low, high = np.full(3, -np.inf), np.full(3, np.inf)
    low[2] = bone[:, 2].min() - settings.below
    high[1:] = bone[:, 1].max() + settings.behind, bone[:, 2].max() + settings.above
    for corner, given in ((low, settings.low), (high, settings.high)):
        for axis, value in enumerate(given):
            corner[axis] = corner[axis] if value is None else value
    within = ((head > low) & (head < high)).all(axis=1)
    if not within.any():
        raise InputError(
            f"the domain from {_said(low)} to {_said(high)} mm lies beside the head, which reaches "
            f"from {_said(head.min(axis=0))} to {_said(head.max(axis=0))} mm; mm in LPS: x to the "
            "left, y to posterior, z to superior"
        )
    room = 2 * labels.frame.spacing.max()
    low = np.maximum(low, head[within].min(axis=0) - room)
    high = np.minimum(high, head[within].max(axis=0) + room)
    if not (high - low > SMALLEST).all():
        raise InputError(
            f"the domain would reach from {_said(low)} to {_said(high)} mm, thinner than "
            f"{SMALLEST:g} mm; no face fits in: move its planes apart"
        )
    ends = labels.frame.points(np.array([[0, 0, 0], np.array(labels.values.shape[::-1]) - 1]))
    if np.allclose(labels.frame.axes, np.eye(3), atol=1e-6):
        low, high = np.maximum(low, ends[0]), np.minimum(high, ends[1])
    reach = np.stack([head[within].min(axis=0) - low, high - head[within].max(axis=0)])
    return low, high, np.asarray(reach > 1.2 * labels.frame.spacing.max())


def _check_bones(jaw: Bools, skull: Bools, low: Floats, high: Floats) -> None:
    for mask, name, what in ((jaw, "mandible", "moves"), (skull, "skull", "stays")):
        if not mask.any():
            raise InputError(
                f"no bone of the {name} lies in the domain from {_said(low)} to {_said(high)} mm, "
                f"so that nothing there {what}; move its planes"
            )


def _said(point: Floats) -> str:
    return "(" + ", ".join(f"{x:.4g}" for x in point) + ")"


def _part(labels: Labels, low: Floats, high: Floats) -> tuple[Grid, Frame]:
    """The labels around a box, and their frame."""
    corners = np.stack(np.meshgrid(*zip(low, high, strict=True)), -1).reshape(-1, 3)
    index = labels.frame.indices(corners)
    margin = MARGIN / labels.frame.spacing
    first = np.maximum(np.floor(index.min(axis=0) - margin), 0).astype(int)
    last = np.ceil(index.max(axis=0) + margin).astype(int) + 1
    x, y, z = (slice(a, b) for a, b in zip(first, last, strict=True))
    frame = Frame(labels.frame.spacing, labels.frame.points(first), labels.frame.axes)
    return labels.values[z, y, x], frame


def _inside(frame: Frame, shape: tuple[int, ...], low: Floats, high: Floats) -> Bools:
    """Which voxels (z, y, x) have their centre in a box."""
    found = np.ones(shape, np.bool_)
    k, j, i = np.ogrid[tuple(slice(n) for n in shape)]
    for axis in range(3):
        a, b, c = frame.axes[axis] * frame.spacing
        place = frame.origin[axis] + a * i + b * j + c * k
        found &= (place >= low[axis]) & (place <= high[axis])
    return found


def _bones(
    part: Grid, to_skin: Grid, frame: Frame, settings: DomainSettings
) -> tuple[Bools, Bools, list[str]]:
    """The mandible and the skull with its hollows; small loose bones are neither."""
    notes: list[str] = []
    size = float(np.prod(frame.spacing)) / 1e3
    deep = to_skin > settings.cover
    jaw, skull = (part == MANDIBLE) & deep, (part == BONE) & deep
    for mask in (jaw, skull):
        parts, count = ndimage.label(mask, np.ones((3, 3, 3)))
        volumes = np.bincount(parts.ravel(), minlength=count + 1) * size
        keep = volumes >= min(settings.loose, volumes[1:].max(initial=0.0))
        keep[0] = False
        if (lost := volumes[1:][~keep[1:]].sum()) > 0.1:
            notes.append(f"{lost:.3g} cm3 of small loose bones count as tissue")
        mask &= keep[parts]
    skull |= _closed(skull, settings.sealed, frame.spacing) & deep & ~jaw
    skull |= ndimage.binary_fill_holes(skull) & ~jaw
    return jaw, skull, notes


def _closed(mask: Bools, radius: float, spacing: Floats) -> Bools:
    """A mask with what a ball cannot enter from outside."""
    if radius == 0:
        return mask
    near = distance(~mask, spacing) <= radius
    return np.asarray((distance(near, spacing) > radius) | mask)


def _largest(tissue: Bools, inside: Bools, air: Bools, border: Grid) -> tuple[Bools, int]:
    """The tissue whose part in the box hangs together, and how many voxels were lost.

    What was lost borders as skin if air touches it, else as skull; `border` is told so.
    """
    parts, count = ndimage.label(tissue & inside)
    if not count:
        raise InputError("there is no soft tissue in the domain; move its planes")
    size = np.bincount(parts.ravel())
    keep = int(size[1:].argmax()) + 1
    lost = (parts > 0) & (parts != keep)
    touched = np.unique(parts[ndimage.binary_dilation(air) & lost])
    border[lost] = SKULL
    border[lost & np.isin(parts, touched)] = SKIN
    return tissue & ~lost, int(size[1:].sum() - size[keep])


def _signed(tissue: Bools, border: Grid, frame: Frame) -> tuple[Any, Grid]:
    """Distance (z, y, x), mm, from faces between tissue and the rest; what the nearest rest is."""
    spacing = frame.spacing[::-1]
    within, nearest = ndimage.distance_transform_edt(tissue, sampling=spacing, return_indices=True)
    signed = ndimage.distance_transform_edt(~tissue, sampling=spacing).astype(np.float32)
    half = np.float32(frame.spacing.mean() / 2)
    signed = np.where(tissue, half - within.astype(np.float32), signed - half)
    z, y, x = nearest
    return signed, border[z, y, x]
