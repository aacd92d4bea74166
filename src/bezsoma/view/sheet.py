# SPDX-License-Identifier: BSD-3-Clause
"""A page of pictures: panels with captions, sides marked, scale and colour bars; PNG bytes.

Drawn on figure objects of their own (Agg), never through matplotlib's global state, so that a
picture made inside somebody's notebook or thread changes nothing there. One pixel of a panel is
one pixel of the page.
"""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass
from math import floor, log10
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import ListedColormap, Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Rectangle
from matplotlib.ticker import MaxNLocator
from PIL import Image

from bezsoma import __version__
from bezsoma.arrays import Floats
from bezsoma.errors import InputError, unknown
from bezsoma.view.camera import Camera
from bezsoma.view.layout import Layout

Bytes = npt.NDArray[np.uint8]
INK, PALE = "#22262b", "#7a828c"
NOTICE = "Research software, not a medical device."
_DPI = 100
_BESIDE = 8
"""So many names of bands have room beside each other."""
_LETTER = 0.0175
"""The width of a letter under the colour bar, of the bar's."""


@dataclass(frozen=True, eq=False)
class Bar:
    """A colour bar: what it measures with its unit, and the values at its two ends."""

    label: str
    limits: tuple[float, float]
    table: Floats
    levels: Floats
    """Where it carries ticks and the picture thin lines."""


@dataclass(frozen=True, eq=False)
class Outline:
    """A silhouette to be drawn as a line: the part (h, w) of each pixel that is covered."""

    coverage: Floats
    label: str
    colour: str
    dashed: bool = False


@dataclass(frozen=True, eq=False)
class Strokes:
    """Straight lines over a picture, and dots: a wireframe, a control net."""

    segments: Floats
    """(s, 2, 2) from where to where, in pixels of the panel."""
    label: str
    colour: str
    width: float = 1.0
    """In pixels of a panel that is 760 wide."""
    dots: Floats | None = None
    """(d, 2) in pixels of the panel."""


@dataclass(frozen=True, eq=False)
class Panel:
    """One picture on the page."""

    colours: Floats
    """(h, w, 3) from 0 to 1."""
    camera: Camera
    caption: str
    bar: Bar | None = None
    outlines: tuple[Outline, ...] = ()
    strokes: tuple[Strokes, ...] = ()


def colours(name: str, darkest: float = 0.06) -> Floats:
    """The 256 colours (256, 3) of one of matplotlib's maps, as far as shape shows in them.

    Equal steps of a value look equal in viridis, cividis, magma, inferno, plasma and their
    reverses (`_r`), also in grey; most others invent edges or hide them. No light and shade is
    seen on what is almost black, so the dark end with luminance below `darkest` is left out and
    the rest stretched, which keeps equal steps equal.

    >>> luminance = colours("magma_r") ** 2.2 @ [0.2126, 0.7152, 0.0722]
    >>> bool(luminance.min() > 0.05), bool((np.diff(luminance) < 0).all())
    (True, True)
    """
    if name not in colormaps:
        raise InputError(unknown("colour map", name, colormaps, "matplotlib"))
    full = np.asarray(colormaps[name](np.linspace(0, 1, 256)), float)[:, :3]
    bright = np.flatnonzero(full**2.2 @ np.array([0.2126, 0.7152, 0.0722]) >= darkest)
    if not len(bright):
        raise InputError(f"colour map {name!r} is almost black; 'viridis' and 'magma_r' are not")
    place = np.linspace(bright[0], bright[-1], 256)
    return np.stack([np.interp(place, np.arange(256), channel) for channel in full.T], axis=1)


def round_levels(low: float, high: float, most: int = 7) -> Floats:
    """Round numbers strictly inside an interval, evenly spaced.

    >>> round_levels(0.0, 5.3).tolist()
    [1.0, 2.0, 3.0, 4.0, 5.0]
    """
    ticks = np.asarray(MaxNLocator(most, steps=[1, 2, 2.5, 5, 10]).tick_values(low, high))
    margin = 1e-9 * (high - low)
    return ticks[(ticks > low + margin) & (ticks < high - margin)]


def scale_length(mm: float) -> float:
    """The longest of 1, 2, 5, 10, ... mm that is at most the length given.

    >>> [scale_length(x) for x in (34.0, 50.0, 0.7, 1999.0)]
    [20.0, 50.0, 0.5, 1000.0]
    """
    power = 10.0 ** floor(log10(mm))
    return next(step * power for step in (5.0, 2.0, 1.0) if step * power <= mm * (1 + 1e-12))


def sheet(panels: Sequence[Panel], layout: Layout, title: str = "") -> Figure:
    """The page as a figure; its axes are the panels, each with a colour bar after it if any."""
    width, height = layout.size
    figure = Figure(figsize=(width / _DPI, height / _DPI), dpi=_DPI, facecolor="white")
    FigureCanvasAgg(figure)
    for number, panel in enumerate(panels):
        _draw(figure, layout, number, panel)
    points = layout.unit * 72 / _DPI
    if layout.title:
        y = 1 - 34 * layout.unit / height
        figure.text(
            0.5, y, title, size=25 * points, color=INK, weight="bold", ha="center", va="center"
        )
    _note(figure, width, height, layout.unit)
    return figure


def _note(figure: Figure, width: int, height: int, unit: float) -> None:
    """What drew the page, in its lower right."""
    figure.text(
        1 - 20 * unit / width,
        16 * unit / height,
        f"bezsoma {__version__}.  {NOTICE}",
        size=13 * unit * 72 / _DPI,
        color=PALE,
        ha="right",
        va="center",
    )


@dataclass(frozen=True, eq=False)
class Curve:
    """Positive numbers (n,), one after the other or over others (n,); gaps where they are zero."""

    label: str
    values: Floats
    colour: str
    dashed: bool = False
    over: Floats | None = None


def chart(
    curves: Sequence[Curve],
    bands: Sequence[tuple[float, float, str]],
    across: str,
    title: str,
    size: tuple[int, int],
    up: str = "",
) -> Figure:
    """A page with curves over their numbers 1, 2, ..., logarithmic; bands are named from x to x.

    Where curves are over numbers of their own, both axes are logarithmic.
    """
    width, height = size
    unit = width / 800
    points = unit * 72 / _DPI
    figure = Figure(figsize=(width / _DPI, height / _DPI), dpi=_DPI, facecolor="white")
    FigureCanvasAgg(figure)
    axes = _axes(figure, 90 * unit, 84 * unit, width - 120 * unit, height - 178 * unit)
    whole = max([1, *(len(curve.values) for curve in curves)])
    rotation = 90 if len(bands) > _BESIDE else 0
    for number, (start, end, name) in enumerate(bands):
        axes.axvspan(start, end, color="#eef0f2" if number % 2 else "white", zorder=0)
        if rotation and end - start < 0.02 * whole:
            continue  # a name would run into the next
        middle, top = (start + end) / 2, axes.get_xaxis_transform()
        look: dict[str, Any] = {
            "size": 11 * points,
            "color": PALE,
            "ha": "center",
            "rotation": rotation,
        }
        axes.text(middle, 1.01, name, transform=top, **look)
    for curve in curves:
        x = np.arange(1, len(curve.values) + 1) if curve.over is None else curve.over
        shown = np.where(curve.values > 0, curve.values, np.nan)
        style = "--" if curve.dashed else "-"
        axes.plot(x, shown, style, marker="o", ms=5 * points, color=curve.colour, label=curve.label)
    if all(curve.over is None for curve in curves):
        axes.set(yscale="log", xlim=(0.5, whole + 0.5))
        axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    else:
        axes.set(xscale="log", yscale="log")
        axes.grid(which="both", color="#e6e8ea", lw=0.8 * points, zorder=0)
    axes.set_xlabel(across, size=15 * points, color=INK)
    axes.set_ylabel(up, size=15 * points, color=INK)
    axes.tick_params(which="both", labelsize=14 * points, color=INK, labelcolor=INK)
    axes.legend(fontsize=14 * points, frameon=False, labelcolor=INK)
    figure.suptitle(title, size=19 * points, color=INK)
    _note(figure, width, height, unit)
    return figure


@dataclass(frozen=True, eq=False)
class Line:
    """Points (n, 2) of a graph, joined (`style` "-", "--", ":" or "" for not) or marked."""

    points: Floats
    label: str = ""
    colour: str = INK
    style: str = "-"
    mark: str = ""
    width: float = 1.6
    above: int = 2


@dataclass(frozen=True, eq=False)
class Tiles:
    """Polygons (k, c, 2) of a graph, the later over the earlier; a colour each (k, 3 or 4)."""

    corners: Floats
    colours: Floats


@dataclass(frozen=True, eq=False)
class Graph:
    """Curves with axes; or, as a `drawing`, lines and polygons without axes, to scale.

    `logarithmic` holds "x", "y", both or neither; `words` are texts (x, y, text) beside points.
    """

    title: str
    lines: Sequence[Line]
    across: str = ""
    up: str = ""
    logarithmic: str = ""
    tiles: Sequence[Tiles] = ()
    words: Sequence[tuple[float, float, str]] = ()
    drawing: bool = False


def graphs(shown: Sequence[Graph], columns: int, title: str, size: tuple[int, int]) -> Figure:
    """A page of graphs, row by row."""
    width, height = size
    figure = Figure(
        figsize=(width / _DPI, height / _DPI), dpi=_DPI, facecolor="white", layout="constrained"
    )
    FigureCanvasAgg(figure)
    rows = -(-len(shown) // columns)
    places = figure.subplots(rows, columns, squeeze=False).ravel()
    for axes, graph in zip(places, shown, strict=False):
        _graph(axes, graph)
    for axes in places[len(shown) :]:
        axes.axis("off")
    if title:
        figure.suptitle(title, size=15, color=INK, weight="bold")
    figure.supxlabel(f"bezsoma {__version__}.  {NOTICE}", x=0.995, ha="right", size=8.5, color=PALE)
    return figure


def _graph(axes: Axes, graph: Graph) -> None:
    for tiles in graph.tiles:
        faces = list(tiles.corners)
        edges = tuple(map(tuple, tiles.colours))
        axes.add_collection(PolyCollection(faces, facecolors=edges, edgecolors=edges, lw=0.2))
    for line in graph.lines:
        axes.plot(
            *line.points.T,
            linestyle=line.style or "none",
            marker=line.mark or None,
            ms=5,
            lw=line.width,
            color=line.colour,
            label=line.label or None,
            zorder=line.above,
        )
    for x, y, text in graph.words:
        axes.annotate(text, (x, y), (4, 3), textcoords="offset points", size=8.5, color=INK)
    axes.set_title(graph.title, size=12, color=INK)
    if graph.drawing:
        axes.autoscale_view()
        axes.set_aspect("equal", adjustable="datalim")
        axes.axis("off")
    else:
        axes.set_xlabel(graph.across, size=11, color=INK)
        axes.set_ylabel(graph.up, size=11, color=INK)
        axes.set_xscale("log" if "x" in graph.logarithmic else "linear")
        axes.set_yscale("log" if "y" in graph.logarithmic else "linear")
        axes.grid(alpha=0.3)
        _plain_numbers(axes)
    if any(line.label for line in graph.lines):
        axes.legend(fontsize=8.5, frameon=False, labelcolor=INK)


def _plain_numbers(axes: Axes) -> None:
    """Where a logarithmic axis spans less than two decades, 0.4 is read better than a power."""
    for axis, (low, high) in ((axes.xaxis, axes.get_xlim()), (axes.yaxis, axes.get_ylim())):
        if axis.get_scale() == "log" and high < 100 * low:
            axis.set_major_formatter(lambda value, _: f"{value:g}")
            axis.set_minor_formatter(lambda value, _: f"{value:g}")


def png(figure: Figure, title: str = "") -> bytes:
    """The page as a PNG file; it names the software, and neither a person nor a date."""
    stream = io.BytesIO()
    software = f"bezsoma {__version__}. {NOTICE}"
    figure.savefig(stream, format="png", metadata={"Software": software, "Title": title or None})
    return stream.getvalue()


def pixels(figure: Figure) -> Bytes:
    """The page as it looks on a screen: (h, w, 3) from 0 to 255."""
    canvas: Any = figure.canvas
    canvas.draw()
    return np.asarray(canvas.buffer_rgba(), np.uint8)[..., :3].copy()


def gif(frames: Sequence[Bytes], seconds: float) -> bytes:
    """An animated GIF without end of frames (h, w, 3), each shown for so many seconds.

    All frames share 256 colours, chosen from six of them: a palette of its own for each would
    flicker.
    """
    chosen = [frames[k] for k in np.linspace(0, len(frames) - 1, min(6, len(frames))).astype(int)]
    palette = Image.fromarray(np.concatenate(chosen)).quantize(256, Image.Quantize.MEDIANCUT)
    images = [
        Image.fromarray(each).quantize(palette=palette, dither=Image.Dither.NONE) for each in frames
    ]
    stream = io.BytesIO()
    images[0].save(
        stream,
        format="GIF",
        save_all=True,
        append_images=images[1:],
        duration=round(1000 * seconds),
        loop=0,
        comment=f"bezsoma {__version__}. {NOTICE}".encode(),
    )
    return stream.getvalue()


def _axes(figure: Figure, left: float, top: float, width: float, height: float) -> Axes:
    """Axes at pixels of the page, counted from its upper left."""
    across, down = figure.get_size_inches() * _DPI
    return figure.add_axes(
        (left / across, 1 - (top + height) / down, width / across, height / down)
    )


def _draw(figure: Figure, layout: Layout, number: int, panel: Panel) -> None:
    """One panel: picture, caption, outlines, marks and bars."""
    (width, height), (left, top) = layout.panel, layout.corner(number)
    points = layout.unit * 72 / _DPI
    axes = _axes(figure, left, top, width, height)
    axes.imshow(
        np.rint(255 * panel.colours).astype(np.uint8),
        extent=(0, width, height, 0),
        interpolation="nearest",
        aspect="auto",
    )
    axes.set(xlim=(0, width), ylim=(height, 0), xticks=[], yticks=[])
    for spine in axes.spines.values():
        spine.set(color="#d5d8dc", linewidth=1.2 * points)
    axes.set_title(panel.caption, size=19 * points, color=INK, pad=9 * points)
    handles = [*_outlines(axes, panel.outlines, points), *_strokes(axes, panel.strokes, points)]
    if handles:
        axes.legend(
            handles=handles,
            loc="lower right",
            fontsize=14 * points,
            frameon=False,
            labelcolor=INK,
            borderaxespad=1.2,
        )
    _sides(axes, panel.camera, points)
    _scale_bar(axes, panel.camera, points)
    if panel.bar is not None:
        _colour_bar(figure, layout, (left, top + height), panel.bar)


def _sides(axes: Axes, camera: Camera, points: float) -> None:
    """Letters of the patient's sides at the rims, left and right in a ring of their own colour.

    Where the view is along the line from left to right, a ring in the corner says which side of
    the patient one sees.
    """
    width, height = camera.size
    step = 24 * points * _DPI / 72
    right, left, above, below = camera.letters()
    places = (
        (right, width - step, height / 2),
        (left, step, height / 2),
        (above, width / 2, step),
        (below, width / 2, height - step),
    )
    for letters, x, y in places:
        _mark(axes, letters, x, y, points)
    facing = camera.facing()
    if not set("LR") & set(right + left):
        side = {"L": "left", "R": "right"}.get(facing[0], facing)
        _mark(axes, facing[0], step, step, points)
        axes.text(
            2 * step,
            step,
            f"the patient's {side} side",
            size=14 * points,
            color=INK,
            va="center_baseline",
        )


def _mark(axes: Axes, letters: str, x: float, y: float, points: float) -> None:
    """Letters at a pixel; those of left and right stand white in a filled ring."""
    strong = bool(set("LR") & set(letters))
    radius = 15 * points * _DPI / 72
    if strong:
        axes.add_patch(Circle((x, y), radius, facecolor=INK, edgecolor="white", zorder=6))
    axes.text(
        x,
        y,
        letters,
        size=(16 if len(letters) == 1 else 13) * points,
        color="white" if strong else PALE,
        weight="bold" if strong else "normal",
        ha="center",
        va="center",
        family="DejaVu Sans Mono",  # whose I is no bar
        zorder=7,
    )


def _scale_bar(axes: Axes, camera: Camera, points: float) -> None:
    """A bar of a round number of mm in the lower left."""
    width, height = camera.size
    length = scale_length(0.22 * width / camera.scale)
    pixel = points * _DPI / 72
    left, bottom = 22 * pixel, height - 22 * pixel
    bar = Rectangle(
        (left, bottom - 5 * pixel),
        length * camera.scale,
        5 * pixel,
        facecolor=INK,
        edgecolor="none",
        zorder=6,
        gid="scale bar",
    )
    axes.add_patch(bar)
    axes.text(
        left + length * camera.scale / 2,
        bottom - 10 * pixel,
        f"{length:g} mm",
        size=14 * points,
        color=INK,
        ha="center",
        va="bottom",
        zorder=6,
    )


def _outlines(axes: Axes, outlines: Sequence[Outline], points: float) -> list[Line2D]:
    """Silhouettes as lines through half covered pixels; what stands for them in a legend."""
    handles = []
    for outline in outlines:
        rows, columns = outline.coverage.shape
        x, y = np.arange(columns) + 0.5, np.arange(rows) + 0.5
        style: Any = (0, (4.0, 2.2)) if outline.dashed else "solid"
        wide = (1.9 if outline.dashed else 2.2) * points
        axes.contour(
            x,
            y,
            outline.coverage,
            levels=[0.5],
            colors=[outline.colour],
            linestyles=[style],
            linewidths=wide,
            zorder=4 + outline.dashed,
        )
        handles.append(Line2D([], [], color=outline.colour, ls=style, lw=wide, label=outline.label))
    return handles


def _strokes(axes: Axes, strokes: Sequence[Strokes], points: float) -> list[Line2D]:
    """Lines and dots; what stands for them in a legend."""
    handles = []
    for each in strokes:
        wide = each.width * points
        lines = LineCollection(
            list(each.segments), colors=each.colour, linewidths=wide, capstyle="round", zorder=3
        )
        axes.add_collection(lines, autolim=False)
        marker = None if each.dots is None else "o"
        if each.dots is not None:
            axes.plot(*each.dots.T, "o", ms=3.4 * points, color=each.colour, mew=0, zorder=3.5)
        handles.append(
            Line2D(
                [], [], color=each.colour, lw=wide, marker=marker, ms=5 * points, label=each.label
            )
        )
    return handles


def _colour_bar(figure: Figure, layout: Layout, corner: tuple[int, int], bar: Bar) -> None:
    """A bar below the panel whose ends are the limits, with ticks where the picture has lines."""
    left, top = corner
    width, unit = layout.panel[0], layout.unit
    points = unit * 72 / _DPI
    low, high = bar.limits
    axes = _axes(figure, left + 0.18 * width, top + 12 * unit, 0.64 * width, 15 * unit)
    span = (low, high) if high > low else (low, low + 1.0)
    axes.imshow(
        np.linspace(0, 1, 256)[None],
        extent=(*span, 0, 1),
        cmap=ListedColormap(list(map(tuple, bar.table))),
        norm=Normalize(0, 1),
        aspect="auto",
    )
    ends = list(span) if high > low else [low]
    ticks = [*ends, *bar.levels.tolist()]
    words = [f"{tick:.3g}" if tick in ends or _far(tick, ends, span) else "" for tick in ticks]
    axes.set(xlim=span, yticks=[], label="colour bar")
    axes.set_xticks(ticks, words)
    axes.vlines(bar.levels, 0, 1, color="black", alpha=0.55, lw=0.9 * points)
    axes.tick_params(
        labelsize=14 * points, color=INK, labelcolor=INK, length=4 * points, pad=3.2 * points
    )
    axes.set_xlabel(bar.label, size=15 * points, color=INK, labelpad=3.5 * points)
    for spine in axes.spines.values():
        spine.set(color=INK, linewidth=0.8 * points)


def _far(value: float, ends: Sequence[float], span: tuple[float, float]) -> bool:
    """Whether the number of a level does not run into that of the bar's end."""
    letters = np.array([len(f"{each:.3g}") + len(f"{value:.3g}") for each in ends]) / 2
    apart = np.maximum(0.07, _LETTER * letters) * (span[1] - span[0])
    return bool((np.abs(np.array(ends) - value) > apart).all())
