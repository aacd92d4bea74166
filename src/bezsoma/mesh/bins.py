# SPDX-License-Identifier: BSD-3-Clause
"""Boxes sorted into grids by their size, so that all boxes around a point are found at once.

One grid fails on graded meshes: its cells are too large for the small boxes or too small for the
large ones.  Here a box whose longest side lies in (h/2, h], h a power of two, goes into the grid
of spacing h, of which it touches at most two cells along each axis.  A point looks into one cell
of every grid that is in use.  Nothing is missed, by construction; memory is at most eight entries
a box.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from bezsoma.arrays import Floats, Ints

CELL_BITS = 19
"""Bits a cell number has along an axis; beyond it cells share an entry, which costs time only."""
MARGIN = 1e-6
"""What a box stays below its spacing, so that rounding cannot make it touch a third cell."""


@dataclass(frozen=True, eq=False)
class BoxBins:
    """Axis-parallel boxes (b, 3) to (b, 3), found by the points that lie in them.

    >>> low = np.array([[0.0, 0, 0], [0, 0, 0]])
    >>> bins = BoxBins.of(low, np.array([[1.0, 1, 1], [64, 64, 64]]))
    >>> [boxes.tolist() for _, boxes in bins.around(np.array([[0.5, 0.5, 0.5], [9, 9, 9]]), 100)]
    [[0], [1, 1]]
    """

    low: Floats
    high: Floats
    origin: Floats
    levels: Ints
    """The exponents of the spacings in use."""
    cells: Ints
    """The keys of the cells that hold boxes, ascending (q,)."""
    starts: Ints
    """Where the boxes of each cell begin in `boxes` (q + 1,)."""
    boxes: Ints

    @classmethod
    def of(cls, low: Floats, high: Floats) -> BoxBins:
        """The bins of boxes with these lower and upper corners."""
        origin = low.min(axis=0)
        _, level = np.frexp((high - low).max(axis=1) * (1 + MARGIN))
        first = _cell(low - origin, level)
        last = _cell(high - origin, level)
        keys, boxes = [], []
        for corner in np.ndindex(2, 2, 2):
            # where first and last agree along an axis, the second cell would be the first again
            new = np.flatnonzero((last - first >= corner).all(axis=1))
            keys.append(_key(first[new] + corner, level[new]))
            boxes.append(new)
        key, box = np.concatenate(keys), np.concatenate(boxes)
        order = np.lexsort((box, key))
        cells, starts = np.unique(key[order], return_index=True)
        ends = np.append(starts, len(key))
        return cls(low, high, origin, np.unique(level), cells, ends, box[order])

    def around(self, points: Floats, most: int) -> Iterator[tuple[Ints, Ints]]:
        """All pairs of a point (p, 3) and a box that holds it, a portion at a time.

        Yields the numbers of points (q,) and of boxes (q,); some `most` pairs a portion, more
        where a single point has more.
        """
        inside = np.flatnonzero(
            (points >= self.origin).all(axis=1) & (points <= self.high.max(axis=0)).all(axis=1)
        )
        for level in self.levels:
            key = _key(_cell(points[inside] - self.origin, level), level)
            at = np.minimum(np.searchsorted(self.cells, key), len(self.cells) - 1)
            hit = np.flatnonzero(self.cells[at] == key)
            starts = self.starts[at[hit]]
            counts = self.starts[at[hit] + 1] - starts
            for begin, end in _portions(counts, most):
                asked = np.repeat(inside[hit[begin:end]], counts[begin:end])
                box = self.boxes[_ranges(starts[begin:end], counts[begin:end])]
                held = (points[asked] >= self.low[box]) & (points[asked] <= self.high[box])
                holds = np.flatnonzero(held.all(axis=1))
                yield asked[holds], box[holds]


def _cell(offset: Floats, level: Ints) -> Ints:
    """The cell (b, 3) of spacing 2**level in which each offset (b, 3) lies."""
    scaled: Floats = np.ldexp(offset, -np.asarray(level)[..., None])
    cell: Ints = np.floor(scaled).astype(np.int64)
    return cell


def _key(cell: Ints, level: Ints) -> Ints:
    """One integer for a cell (b, 3) of a level (b,), the bits of the four side by side."""
    wrapped = cell & ((1 << CELL_BITS) - 1)
    key = np.asarray(level, dtype=np.int64) & 63
    for axis in range(3):
        key = (key << CELL_BITS) | wrapped[:, axis]
    return key


def _portions(counts: Ints, most: int) -> Iterator[tuple[int, int]]:
    """Ranges of `counts` (q,) that each add up to some `most`."""
    total = np.cumsum(counts)
    begin = 0
    while begin < len(counts):
        past = total[begin - 1] if begin else 0
        end = max(begin + 1, int(np.searchsorted(total, past + most, side="right")))
        yield begin, end
        begin = end


def _ranges(starts: Ints, counts: Ints) -> Ints:
    """The numbers start, start + 1, ... of each range, one range after another.

    >>> _ranges(np.array([5, 0]), np.array([2, 3])).tolist()
    [5, 6, 0, 1, 2]
    """
    shift = np.cumsum(counts) - counts
    ranges: Ints = np.arange(counts.sum()) + np.repeat(starts - shift, counts)
    return ranges
