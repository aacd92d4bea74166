# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of surfaces and fields as PNG, made without a display: what is drawn, and where.

The surface that is drawn is the displaced polynomial patch itself, cut finely enough that its
triangles stray from it by less than a quarter of a pixel. Lengths are mm, the frame is LPS.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from bezsoma.arrays import Floats
from bezsoma.errors import InputError
from bezsoma.mesh import Field, TetMesh
from bezsoma.mesh.nouns import field_given, mesh_given, path_given
from bezsoma.view.camera import axes, fitted
from bezsoma.view.layout import Layout, sheet_size
from bezsoma.view.light import CLAY, REST, SKIN
from bezsoma.view.restriction import (
    AnyField,
    controls_on,
    degree_of,
    on_same_mesh,
    values_at,
)
from bezsoma.view.shading import Layer, coverage, shaded
from bezsoma.view.sheet import Bar, Outline, Panel, colours, png, round_levels, sheet
from bezsoma.view.subject import Named, Subject, is_skin
from bezsoma.view.surfaces import Surface
from bezsoma.view.written import written

Measure = Callable[[Floats], Floats]


def picture(
    path: str | Path | None,
    mesh: TetMesh,
    colour: AnyField | None = None,
    *,
    displacement: Field | None = None,
    magnified: float = 1.0,
    surface: Named = None,
    rest: bool = True,
    view: str = "three-quarter",
    measure: Measure | None = None,
    label: str = "",
    limits: tuple[float, float] | None = None,
    table: str = "viridis",
    wires: bool = False,
    title: str = "",
    size: tuple[int, int] = (1000, 900),
    overwrite: bool = False,
) -> bytes:
    """A picture of a surface as PNG, plain or coloured by a field; written if a path is given.

    `surface` is one name, several, or None for the whole boundary; with `rest` the other boundary
    facets stand beside it in grey. `colour` is a scalar, or a vector (its length is shown), or
    anything with a `measure` that turns values (p, k) into numbers (p,); `label` says what it is,
    with the unit. `limits` default to the range on the surface. `displacement` in mm moves the
    surface, `magnified` times, which the caption then says.
    """
    call = "picture(path, mesh, colour, displacement=)"
    _checked(call, path, mesh, (colour, "the colour"), (displacement, "the displacement"))
    subject = Subject.of(mesh, surface, rest, displacement, magnified)
    layout = Layout(_size(size), 1, 1, bool(title), colour is not None)
    camera = fitted(view, subject.points(), layout.panel)
    front, back = subject.surfaces(camera.scale, moved=displacement is not None)
    layer, bar = _plain(front, surface, wires), None
    if colour is not None:
        numbers = _numbers(mesh, colour, front, measure)
        bar = _bar(numbers, label, limits, table)
        layer = _painted(front, numbers, bar, wires)
    panel = Panel(
        shaded(camera, _with_rest(layer, back, wires)).colours,
        camera,
        _caption(view, displacement, magnified),
        bar,
    )
    content = png(sheet([panel], layout, title), title)
    if path is not None:
        written(path, content, overwrite)
    return content


def face_picture(
    path: str | Path | None,
    mesh: TetMesh,
    displacement: Field,
    *,
    surface: Named = None,
    rest: bool = True,
    view: str = "three-quarter",
    profile: str = "right",
    limits: tuple[float, float] | None = None,
    table: str = "magma_r",
    title: str = "",
    size: tuple[int, int] | None = None,
    overwrite: bool = False,
) -> bytes:
    """One sheet as PNG: a face before, after, how far it moved in mm, and both outlines.

    `surface` defaults to the surface named skin where the mesh has one, else to the whole
    boundary. All panels have one scale but the outlines, which are seen from `profile`. Without
    `size` the sheet is 1600 pixels wide and as high as suits what it shows.
    """
    call = "face_picture(path, mesh, displacement)"
    _checked(call, path, mesh)
    field_given(displacement, call, "the displacement")
    chosen = "skin" if surface is None and "skin" in mesh.surfaces else surface
    subject = Subject.of(mesh, chosen, rest, displacement, 1.0)
    points = subject.points()
    size = _fitting(view, points, bool(title)) if size is None else size
    layout = Layout(_size(size), 2, 2, bool(title), True)
    camera = fitted(view, points, layout.panel)
    before, after = (subject.surfaces(camera.scale, moved) for moved in (False, True))
    lengths = _numbers(mesh, displacement, after[0], None)
    top = float(lengths.max()) if limits is None else 0.0
    bar = _bar(lengths, "mm", limits or (0.0, top), table)
    painted = _painted(after[0], lengths, bar, wires=False)
    panels = [
        *(
            Panel(
                shaded(camera, _with_rest(_plain(front, chosen), back)).colours,
                camera,
                name,
            )
            for name, (front, back) in (("before", before), ("after", after))
        ),
        Panel(
            shaded(camera, _with_rest(painted, after[1])).colours,
            camera,
            f"size of the displacement, at most {lengths.max():.3g} mm",
            bar,
        ),
        _profile(chosen, profile, layout.panel, before[0], after[0]),
    ]
    content = png(sheet(panels, layout, title), title)
    if path is not None:
        written(path, content, overwrite)
    return content


def _checked(call: str, path: Any, mesh: Any, *fields: tuple[Any, str]) -> None:
    """Refuses what is no path, mesh or field; no path and no field are fine."""
    if path is not None:
        path_given(path, call)
    mesh_given(mesh, call)
    for field, what in fields:
        if field is not None:
            field_given(field, call, what)


def _profile(
    surface: Named, view: str, size: tuple[int, int], before: Surface, after: Surface
) -> Panel:
    """Both silhouettes over a pale picture of the surface after."""
    points = np.concatenate([before.points.reshape(-1, 3), after.points.reshape(-1, 3)])
    camera = fitted(view, points, size, margin=0.1)
    pale = shaded(camera, [_plain(after, surface)]).colours
    outlines = (
        Outline(coverage(camera, after), "after", "#b3312c"),
        Outline(coverage(camera, before), "before", "#1f4e79", dashed=True),
    )
    return Panel(0.45 * pale + 0.55, camera, "outline, before and after", outlines=outlines)


def _numbers(mesh: TetMesh, field: AnyField, surface: Surface, measure: Measure | None) -> Floats:
    """One number (f, m) at every sample of the surface: the field's, or its measure's."""
    on_same_mesh(mesh, field, "colour")
    controls = controls_on(mesh, field, surface.facets)
    values = values_at(degree_of(field), controls, surface.bary)
    parts = values.shape[2]
    if measure is None and parts not in (1, 3):
        raise InputError(
            f"a field of {parts} components has no colour of its own; give measure=, a function"
            f" from values (p, {parts}) to numbers (p,)"
        )
    if measure is None:
        found = values[..., 0] if parts == 1 else np.linalg.norm(values, axis=2)
    else:
        found = np.asarray(measure(values.reshape(-1, parts)), float).reshape(values.shape[:2])
    if not np.isfinite(found).all():
        raise InputError("the field to be coloured is NaN or infinite on the surface")
    return np.asarray(found)


def _bar(numbers: Floats, label: str, limits: tuple[float, float] | None, table: str) -> Bar:
    """The colour bar of these numbers: their range, unless limits are given."""
    low, high = (float(numbers.min()), float(numbers.max())) if limits is None else limits
    if not (np.isfinite([low, high]).all() and low <= high):
        raise InputError(f"limits {limits!r} do not go from a lower to a higher number")
    levels = round_levels(low, high) if high > low else np.empty(0)
    return Bar(label, (low, high), colours(table), levels)


def _plain(surface: Surface, name: Named, wires: bool = False) -> Layer:
    """A surface without a field on it: skin looks like skin, anything else like clay."""
    skin = is_skin(name)
    return Layer(surface, SKIN if skin else CLAY, translucent=skin, wires=wires)


def _painted(surface: Surface, numbers: Floats, bar: Bar, wires: bool) -> Layer:
    return Layer(
        surface,
        values=numbers,
        limits=bar.limits,
        table=bar.table,
        wires=wires,
        levels=bar.levels,
    )


def _with_rest(layer: Layer, rest: Surface | None, wires: bool = False) -> list[Layer]:
    return [layer] if rest is None else [layer, Layer(rest, REST, wires=wires)]


def _fitting(view: str, points: Floats, title: bool) -> tuple[int, int]:
    """The size of a sheet of two by two panels with room for what is tall, none wasted on it."""
    extent = np.ptp(points @ axes(view).T, axis=0)
    ratio = extent[1] / max(extent[0], 1e-12 * extent.max())
    return sheet_size(1600, 2, 2, min(0.9, max(0.62, 0.8 * ratio)), title)


def _size(size: tuple[int, int]) -> tuple[int, int]:
    """Width and height in pixels, checked."""
    if len(size) != 2 or not all(isinstance(n, int | np.integer) and 0 < n <= 8192 for n in size):
        raise InputError(f"size {size!r} is not (width, height) in whole pixels up to 8192")
    return int(size[0]), int(size[1])


def _caption(view: str, displacement: Field | None, magnified: float) -> str:
    """Where the viewer stands, and how the displacement is drawn."""
    if displacement is None or magnified == 1.0:
        return view
    return f"{view}; displacement drawn {magnified:g} times"
