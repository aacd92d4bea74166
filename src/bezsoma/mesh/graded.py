# SPDX-License-Identifier: BSD-3-Clause
"""A graded lattice of well-shaped tets that fills a box: body-centred cubic, on an octree.

Every cell of the octree has a vertex in its middle. Across a face that two cells of one size share,
their middles and an edge of the face make a tet; its dihedral angles are 60 and 90 degrees. Where
sizes change, and at the sides of the box, such tets are halved or quartered, and half pyramids fill
what is left (Labelle and Shewchuk, Isosurface Stuffing, ACM TOG 26(3), 2007, section 4;
doi:10.1145/1276377.1276448). All angles lie
between 45 and 120 degrees, whatever the sizes.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import ndimage

from bezsoma.arrays import Bools, Floats, Ints

ROUNDED = 2**-0.5
"""Sizes are rounded to the next of the octree: a cell stays whole down to this part of its size."""


@dataclass(frozen=True, eq=False)
class Octree:
    """Cells that halve from level to level, balanced: cells that touch differ by one level."""

    level: Ints
    """(i, j, k) of every finest cell the level of the leaf it lies in; 0 is the finest."""
    levels: int
    """The coarsest level."""

    @classmethod
    def of(cls, sizes: Floats, finest: float, levels: int) -> Octree:
        """The coarsest balanced octree whose cells are about as small as `sizes` (i, j, k) say.

        Sizes are those wanted at the finest cells, in the unit of `finest`, the size of these;
        the shape has to be a multiple of 2**levels.

        >>> sizes = np.full((8, 8, 8), 8.0)
        >>> sizes[0, 0, 0] = 1
        >>> np.bincount(Octree.of(sizes, 1.0, 3).level.ravel()).tolist()
        [8, 56, 448]
        """
        split: list[Bools] = []
        for level in range(1, levels + 1):
            wanted = _pooled(sizes, 2**level, np.min) < ROUNDED * finest * 2**level
            if split:
                wide = ndimage.binary_dilation(split[-1], np.ones((3, 3, 3), np.bool_))
                wanted |= _pooled(wide, 2, np.any)
            split.append(wanted)
        found = np.full(sizes.shape, levels, np.int64)
        for level in range(levels, 0, -1):
            found[_spread(split[level - 1], 2**level)] = level - 1
        return cls(found, levels)

    def leaves(self, level: int) -> Ints:
        """The indices (m, 3) of the leaves of a level, counted in cells of that size."""
        return np.argwhere(self.level[:: 2**level, :: 2**level, :: 2**level] == level)

    def at(self, cells: Ints) -> Ints:
        """The levels (...) at finest cells (..., 3); -1 outside the box."""
        shape = np.array(self.level.shape)
        inside = ((cells >= 0) & (cells < shape)).all(axis=-1)
        i, j, k = np.moveaxis(np.clip(cells, 0, shape - 1), -1, 0)
        return np.where(inside, self.level[i, j, k], -1)


def _pooled(grid: Any, size: int, by: Any) -> Any:
    """One value for each block of size^3."""
    i, j, k = (n // size for n in grid.shape)
    return by(grid.reshape(i, size, j, size, k, size), axis=(1, 3, 5))


def _spread(grid: Any, size: int) -> Any:
    """Every value repeated over a block of size^3."""
    return grid.repeat(size, 0).repeat(size, 1).repeat(size, 2)


def lattice(octree: Octree) -> tuple[Ints, Ints]:
    """Vertices (v, 3) in halves of a finest cell, and tets (t, 4), that fill the box of an octree.

    They fill it exactly, whatever the sizes:

    >>> sizes = np.full((8, 4, 4), 4.0)
    >>> sizes[0, 0, 0] = 1
    >>> vertices, tets = lattice(Octree.of(sizes, 1.0, 2))
    >>> a, b, c, d = (vertices[tets[:, i]].astype(float) for i in range(4))
    >>> volumes = np.abs(np.einsum("td,td->t", b - a, np.cross(c - a, d - a))) / 6
    >>> bool(volumes.min() > 0), float(volumes.sum()) == 8 * 4 * 4 * 8
    (True, True)
    """
    corners = np.concatenate([np.concatenate(list(_of_level(octree, n)))
                              for n in range(octree.levels + 1)])  # fmt: skip
    span = 2 * np.array(octree.level.shape) + 1
    key = (corners[..., 0] * span[1] + corners[..., 1]) * span[2] + corners[..., 2]
    known, tets = np.unique(key, return_inverse=True)
    rest, z = np.divmod(known, span[2])
    return np.stack([*np.divmod(rest, span[1]), z], axis=1), tets.reshape(-1, 4)


def _of_level(octree: Octree, level: int) -> Iterator[Ints]:
    """Tets (t, 4, 3) of the leaves of a level, those to a neighbour of one size counted once."""
    leaves = octree.leaves(level)
    yield np.zeros((0, 4, 3), np.int64)
    for axis in range(3):
        for side in (0, 1):
            beyond = leaves * 2**level
            beyond[:, axis] += 2**level if side else -1
            there = octree.at(beyond)
            if side:
                yield from _halves(octree, level, leaves[there == level], axis, side, middle=False)
            open_ = (there < level) | (there < 0)
            yield from _halves(octree, level, leaves[open_], axis, side, middle=True)
            yield from _pyramids(level, leaves[there > level], axis, side)


def _halves(
    octree: Octree, level: int, leaves: Ints, axis: int, side: int, *, middle: bool
) -> Iterator[Ints]:
    """Tets from the middle of leaves, over that of a face or of the next leaf, to its edges."""
    half = 2**level
    centre = (2 * leaves + 1) * half
    other = centre.copy()
    other[:, axis] += (1 if side else -1) * half * (1 if middle else 2)
    for along, across in ((a, b) for a in range(3) for b in range(3) if len({axis, a, b}) == 3):
        for far in (0, 1):
            start = 2 * leaves * half
            start[:, axis] += 2 * half * side
            start[:, across] += 2 * half * far
            end, halfway = start.copy(), start.copy()
            end[:, along] += 2 * half
            halfway[:, along] += half
            cut = _is_cut(octree, level, start, along)
            for one, two, which in (
                (start, end, ~cut), (start, halfway, cut), (halfway, end, cut),
            ):  # fmt: skip
                yield np.stack([centre, other, one, two], axis=1)[which]


def _is_cut(octree: Octree, level: int, start: Ints, along: int) -> Bools:
    """Whether a smaller cell touches each edge (m,) of a level that begins at `start` (m, 3)."""
    cut = np.zeros(len(start), np.bool_)
    first, second = (axis for axis in range(3) if axis != along)
    for a in (0, -1):
        for b in (0, -1):
            cell = start // 2
            cell[:, first] += a
            cell[:, second] += b
            there = octree.at(cell)
            cut |= (there >= 0) & (there < level)
    return cut


def _pyramids(level: int, leaves: Ints, axis: int, side: int) -> Iterator[Ints]:
    """Two half pyramids to a face of a larger leaf, parted where that leaf's own tets are."""
    half = 2**level
    centre = (2 * leaves + 1) * half
    first, second = (a for a in range(3) if a != axis)
    corners = []
    for a, b in ((0, 0), (1, 0), (1, 1), (0, 1)):
        corner = 2 * leaves * half
        corner[:, axis] += 2 * half * side
        corner[:, first] += 2 * half * a
        corner[:, second] += 2 * half * b
        corners.append(corner)
    equal = (leaves[:, first] % 2 == leaves[:, second] % 2)[:, None]
    p, q, r, s = corners
    one, two = np.where(equal, p, q), np.where(equal, r, s)
    for third in (np.where(equal, q, r), np.where(equal, s, p)):
        yield np.stack([centre, one, two, third], axis=1)
