# SPDX-License-Identifier: BSD-3-Clause
"""Where on a page of pictures each panel stands, in pixels."""

from __future__ import annotations

from dataclasses import dataclass

from bezsoma.errors import InputError


@dataclass(frozen=True)
class Layout:
    """How a page of `size` pixels is divided; everything scales with its width.

    Colour bars, if any, stand below the last row of panels.
    """

    size: tuple[int, int]
    columns: int
    rows: int
    title: bool
    bars: bool

    @property
    def unit(self) -> float:
        """Pixels of what is one pixel on a page with panels 760 wide."""
        return self.size[0] / (800 * self.columns)

    def _pixels(self, length: float) -> int:
        return round(length * self.unit)

    @property
    def panel(self) -> tuple[int, int]:
        """Width and height of a panel in pixels."""
        width = (self.size[0] - (self.columns + 1) * self._pixels(20)) // self.columns
        free = self.size[1] - self._top() - self._pixels(92 if self.bars else 34)
        each = free // self.rows - self._pixels(46)
        if width < 80 or each < 80:
            raise InputError(
                f"a picture of {self.size[0]} x {self.size[1]} pixels leaves panels of {width} x"
                f" {each}; ask for at least {200 * self.columns} x {330 * self.rows}"
            )
        return width, each

    def corner(self, number: int) -> tuple[int, int]:
        """Left and upper rim of a panel in pixels from the page's upper left."""
        row, column = divmod(number, self.columns)
        width, height = self.panel
        gap = self._pixels(20)
        above = (row + 1) * self._pixels(46) + row * height
        return gap + column * (width + gap), self._top() + above

    def _top(self) -> int:
        """Height of the page's title in pixels."""
        return self._pixels(54 if self.title else 0)


def sheet_size(width: int, columns: int, rows: int, ratio: float, title: bool) -> tuple[int, int]:
    """The size in pixels of a page whose panels are `ratio` times as high as wide, with bars.

    >>> Layout(sheet_size(1600, 2, 2, 0.75, title=True), 2, 2, title=True, bars=True).panel
    (770, 578)
    """
    flat = Layout((width, 100_000), columns, rows, title, bars=True)
    across, down = flat.panel
    return width, 100_000 - rows * (down - round(ratio * across))
