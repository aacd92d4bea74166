# SPDX-License-Identifier: BSD-3-Clause
"""A page of flat pictures that others have made: planes through an image, labels over it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import ceil
from pathlib import Path
from typing import Any, Protocol

from bezsoma.arrays import Floats
from bezsoma.errors import InputError
from bezsoma.view.camera import Camera
from bezsoma.view.layout import Layout, sheet_size
from bezsoma.view.sheet import INK, Panel, png, sheet
from bezsoma.view.written import written

COLUMNS = 3


class Plate(Protocol):
    """A picture in space, seen along an axis."""

    @property
    def colours(self) -> Floats:
        """(h, w, 3) from 0 to 1."""

    @property
    def centre(self) -> Floats:
        """(3,) mm, what lies in its middle."""

    @property
    def axes(self) -> Floats:
        """(3, 3) rows: to the viewer's right, upwards, towards the viewer."""

    @property
    def caption(self) -> str:
        """What it shows."""

    @property
    def scale(self) -> float:
        """Pixels per mm."""


def plates_picture(
    path: str | Path | None,
    plates: Sequence[Plate],
    legend: Mapping[str, tuple[float, float, float]],
    *,
    title: str = "",
    notes: Sequence[str] = (),
    overwrite: bool = False,
) -> bytes:
    """A page of plates as PNG, sides marked, with a legend and up to three notes; written too.

    `legend` gives the colour (red, green, blue from 0 to 1) of every name.
    """
    sizes = {plate.colours.shape[:2] for plate in plates}
    if len(sizes) != 1:
        found = " and ".join(f"{w} x {h} pixels" for h, w in sorted(sizes))
        raise InputError(
            f"plates of {found} were given; make all of one size to stand on one page"
            if sizes
            else "no plates were given to draw; give one or more, as plates_picture(path, [plate])"
        )
    height, width, _ = plates[0].colours.shape
    columns = min(COLUMNS, len(plates))
    rows = ceil(len(plates) / columns)
    size = sheet_size((width + 20) * columns + 20, columns, rows, height / width, bool(title))
    layout = Layout(size, columns, rows, bool(title), bars=True)
    zoom = layout.panel[0] / width
    panels = [
        Panel(
            plate.colours,
            Camera(plate.axes, plate.centre, zoom * plate.scale, layout.panel),
            plate.caption,
        )
        for plate in plates
    ]
    figure = sheet(panels, layout, title)
    _legend(figure, layout, legend, notes)
    content = png(figure, title)
    if path is not None:
        written(path, content, overwrite)
    return content


def _legend(
    figure: Any,
    layout: Layout,
    legend: Mapping[str, tuple[float, float, float]],
    notes: Sequence[str],
) -> None:
    """Coloured squares with names, and below them notes, at the lower left of the page."""
    width, height = layout.size
    points = layout.unit * 0.72
    x = 24 * layout.unit
    for name, colour in legend.items():
        y = 1 - (height - 64 * layout.unit) / height
        figure.text(x / width, y, "\u25a0", size=26 * points, color=colour, va="center")
        x += 26 * layout.unit
        figure.text(x / width, y, name, size=15 * points, color=INK, va="center")
        x += (26 + 9.5 * len(name)) * layout.unit
    for number, note in enumerate(notes[:3]):
        y = 1 - (height - (38 - 15 * number) * layout.unit) / height
        figure.text(24 / width * layout.unit, y, note, size=12 * points, color=INK, va="center")
