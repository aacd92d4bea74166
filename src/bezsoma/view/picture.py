# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of surfaces and fields as PNG, made without a display: what is drawn, and where.

The surface that is drawn is the displaced polynomial patch itself, cut finely enough that its
triangles stray from it by less than a quarter of a pixel. Lengths are mm, the frame is LPS.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from bezsoma.arrays import Floats
from bezsoma.errors import InputError
from bezsoma.mesh import Field, TetMesh
from bezsoma.mesh.nouns import field_given, mesh_given, path_given
from bezsoma.mesh.planes import Plane
from bezsoma.view.camera import axes, fitted, fitted_alike
from bezsoma.view.layout import Layout, sheet_size
from bezsoma.view.light import CLAY, REST, SKIN
from bezsoma.view.numbers import Measure, numbers_on
from bezsoma.view.restriction import AnyField
from bezsoma.view.shading import Layer, coverage, shaded
from bezsoma.view.sheet import Bar, Outline, Panel, png, sheet
from bezsoma.view.shot import Shot, bar, bar_of, panel
from bezsoma.view.subject import Named, Subject, is_skin
from bezsoma.view.surfaces import Surface
from bezsoma.view.written import vacant, written


def picture(
    path: str | Path | None,
    mesh: TetMesh,
    colour: AnyField | None = None,
    *,
    displacement: Field | None = None,
    magnified: float = 1.0,
    surface: Named = None,
    rest: bool = True,
    translucent: Named = None,
    plane: Plane | str | None = None,
    carried: bool = False,
    before: bool = False,
    net: bool = False,
    view: str = "three-quarter",
    measure: Measure | None = None,
    label: str = "",
    limits: tuple[float, float] | None = None,
    table: str = "viridis",
    wires: bool = False,
    levels: tuple[float, ...] = (),
    title: str = "",
    size: tuple[int, int] = (1000, 900),
    overwrite: bool = False,
) -> bytes:
    """A picture of a surface as PNG, plain or coloured by a field; written if a path is given.

    `surface` is one name, several, or None for the whole boundary; with `rest` the other boundary
    facets stand beside it in grey, and what `translucent` names is seen through. `colour` is a
    scalar, or a vector (its length is shown), or anything with a `measure` that turns values
    (p, k) into numbers (p,); `label` says what it is, with the unit. `limits` default to the
    range of what is seen. `displacement` in mm moves the surface, `magnified` times, which the
    caption then says.

    `plane`, such as "x=12.5" (mm), cuts the body open where it is drawn, and the face of the cut
    alone is coloured; with `carried` it cuts the body before it moves, and the cut moves along.
    `before` draws the edges of the mesh as they were over it, `net` the control net of the
    displaced surface, `wires` the edges of the mesh. `levels` are shown as surfaces inside, on
    which a scalar `colour` has these values, behind a translucent outside.
    """
    call = "picture(path, mesh, colour, displacement=)"
    place_given(path, overwrite, call)
    shot = Shot(
        mesh,
        colour,
        displacement=displacement,
        magnified=magnified,
        surface=surface,
        rest=rest,
        translucent=translucent,
        plane=plane,
        carried=carried,
        before=before,
        net=net,
        measure=measure,
        label=label,
        limits=limits,
        table=table,
        wires=wires,
        levels=levels,
    )
    content = page([shot], view, title, size, call)
    if path is not None:
        written(path, content, overwrite)
    return content


def side_by_side(
    path: str | Path | None,
    shots: Sequence[Shot],
    *,
    view: str = "three-quarter",
    title: str = "",
    size: tuple[int, int] | None = None,
    overwrite: bool = False,
) -> bytes:
    """Up to four shots beside each other as PNG, of one scale, with one range of colours.

    The first that is coloured gives `limits`, `label` and `table` for all. Without `size` each
    shot is 700 pixels wide.

    >>> from bezsoma.mesh import ControlNet, block
    >>> mesh = block((20.0, 10.0, 10.0), (2, 1, 1))
    >>> bent = Field.interpolating(ControlNet(mesh, 2), lambda x: x**2 / 40)
    >>> sheet = side_by_side(None, [Shot(mesh, bent), Shot(mesh, bent, bent)])
    """
    place_given(path, overwrite, "side_by_side(path, shots)")
    if not 1 <= len(shots) <= 4:
        raise InputError(f"{len(shots)} shots were given; 1 to 4 have room beside each other")
    wide = (720 * len(shots) + 20, 800) if size is None else size
    content = page(shots, view, title, wide, "side_by_side(path, shots)")
    if path is not None:
        written(path, content, overwrite)
    return content


def page(shots: Sequence[Shot], view: str, title: str, size: tuple[int, int], call: str) -> bytes:
    """Shots beside each other as PNG, one camera and one range of colours for all."""
    frame = axes(view)
    every = [shot.checked(call) for shot in shots]
    coloured = any(shot.colour is not None for shot in every)
    layout = Layout(page_size(size), len(every), 1, bool(title), coloured)
    cameras = fitted_alike(frame, [shot.subject.points() for shot in every], layout.panel)
    seen = [shot.seen(camera) for shot, camera in zip(every, cameras, strict=True)]
    colours = bar_of(every, seen)
    panels = [
        panel(shot, each, camera, _caption(shot, view), None if shot.colour is None else colours)
        for shot, each, camera in zip(every, seen, cameras, strict=True)
    ]
    return png(sheet(panels, layout, title), title)


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
    place_given(path, overwrite, call)
    mesh_given(mesh, call)
    field_given(displacement, call, "the displacement")
    chosen = "skin" if surface is None and "skin" in mesh.surfaces else surface
    subject = Subject.of(mesh, chosen, rest, displacement, 1.0)
    points = subject.points()
    size = _fitting(view, points, bool(title)) if size is None else size
    layout = Layout(page_size(size), 2, 2, bool(title), True)
    camera = fitted(view, points, layout.panel)
    before, after = (subject.surfaces(camera.scale, moved) for moved in (False, True))
    lengths = numbers_on(mesh, displacement, after[0], None)
    top = float(lengths.max()) if limits is None else 0.0
    scale = bar(lengths, "mm", limits or (0.0, top), table)
    painted = _painted(after[0], lengths, scale)
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
            scale,
        ),
        _profile(chosen, profile, layout.panel, before[0], after[0]),
    ]
    content = png(sheet(panels, layout, title), title)
    if path is not None:
        written(path, content, overwrite)
    return content


def place_given(path: Any, overwrite: bool, call: str, *endings: str) -> None:
    """Refuses, before any work, what is no path or a place that is taken; None is fine."""
    if path is not None:
        vacant(path_given(path, call), overwrite, *(endings or (".png",)))


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


def _plain(surface: Surface, name: Named) -> Layer:
    """A surface without a field on it: skin looks like skin, anything else like clay."""
    skin = is_skin(name)
    return Layer(surface, SKIN if skin else CLAY, translucent=skin)


def _painted(surface: Surface, numbers: Floats, scale: Bar) -> Layer:
    return Layer(
        surface, values=numbers, limits=scale.limits, table=scale.table, levels=scale.levels
    )


def _with_rest(layer: Layer, rest: Surface | None) -> list[Layer]:
    return [layer] if rest is None else [layer, Layer(rest, REST)]


def _fitting(view: str, points: Floats, title: bool) -> tuple[int, int]:
    """The size of a sheet of two by two panels with room for what is tall, none wasted on it."""
    extent = np.ptp(points @ axes(view).T, axis=0)
    ratio = extent[1] / max(extent[0], 1e-12 * extent.max())
    return sheet_size(1600, 2, 2, min(0.9, max(0.62, 0.8 * ratio)), title)


def page_size(size: tuple[int, int]) -> tuple[int, int]:
    """Width and height in pixels, checked."""
    if len(size) != 2 or not all(isinstance(n, int | np.integer) and 0 < n <= 8192 for n in size):
        raise InputError(f"size {size!r} is not (width, height) in whole pixels up to 8192")
    return int(size[0]), int(size[1])


def _caption(shot: Shot, view: str) -> str:
    """What it shows; or where the viewer stands, how it is cut, how the displacement is drawn."""
    if shot.caption is not None:
        return shot.caption
    said = [view]
    if shot.plane is not None:
        said.append(f"cut at {Plane.of(shot.plane)}{' before it moved' if shot.carried else ''}")
    if shot.displacement is not None and shot.magnified != 1.0:
        said.append(f"displacement drawn {shot.magnified:g} times")
    return "; ".join(said)
