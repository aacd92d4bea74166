# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of a mesh by its named surfaces, and of a predicted part in its place."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from bezsoma.arrays import Floats, Ints
from bezsoma.errors import InputError
from bezsoma.mesh import Field, TetMesh
from bezsoma.mesh.nouns import field_given, mesh_given
from bezsoma.view.camera import Camera, fitted
from bezsoma.view.layout import Layout, sheet_size
from bezsoma.view.light import REST, SKIN
from bezsoma.view.numbers import numbers_on
from bezsoma.view.shading import Layer, shaded
from bezsoma.view.sheet import Bar, Panel, colours, png, round_levels, sheet
from bezsoma.view.subject import CREASE, NEAR, SIDE, SKIN_CREASE
from bezsoma.view.surfaces import Surface, displaced
from bezsoma.view.written import written

COLOURS: Mapping[str, tuple[float, float, float]] = {
    "skin": SKIN, "mandible": (0.40, 0.62, 0.95), "jaw": (0.40, 0.62, 0.95),
    "skull": (0.93, 0.89, 0.74), "mucosa": (0.88, 0.50, 0.52), "gap": (0.95, 0.75, 0.30),
}  # fmt: skip
"""Red, green, blue of surfaces by name; others are grey."""
FREE = ("skin", "cut")
"""What hides the rest and is left away where bones are shown."""
PALE = (0.86, 0.80, 0.77)
"""The head around the predicted part."""


def mesh_picture(
    path: str | Path | None, mesh: TetMesh, *, title: str = "", overwrite: bool = False
) -> bytes:
    """A page as PNG: the mesh with its edges from two sides, and its inner surfaces from two.

    Surfaces are coloured by their names (`COLOURS`); it is written if a path is given.
    """
    mesh_given(mesh, "mesh_picture(path, mesh)")
    inner = [name for name in mesh.surfaces if name not in FREE] or list(mesh.surfaces)
    shown = (("three-quarter", list(mesh.surfaces), True), ("back", list(mesh.surfaces), True),
             ("three-quarter", inner, False), ("front", inner, False))  # fmt: skip
    layout = Layout(sheet_size(1600, 2, 2, 0.72, bool(title)), 2, 2, bool(title), bars=True)
    panels = []
    for view, names, wires in shown:
        facets = np.concatenate([mesh.surfaces[name] for name in names] or [mesh.boundary])
        camera = fitted(view, mesh.points[np.unique(facets)], layout.panel)
        layers = [
            _layer(mesh, camera, mesh.surfaces[name], COLOURS.get(name, REST), wires, name)
            for name in names
        ]
        layers = layers or [_layer(mesh, camera, mesh.boundary, REST, wires, "")]
        caption = f"{view}: {', '.join(names) or 'boundary'}"
        panels.append(Panel(shaded(camera, layers).colours, camera, caption))
    return _finished(path, panels, layout, title, overwrite)


def head_picture(
    path: str | Path | None,
    mesh: TetMesh,
    displacement: Field,
    around: TetMesh,
    *,
    views: tuple[str, str] = ("three-quarter", "right"),
    title: str = "",
    overwrite: bool = False,
) -> bytes:
    """A page as PNG: a whole head before and after, and how far its skin moved, from two sides.

    `around` has the surface `head`: the skin beyond the part `mesh`, whose own surface is `skin`.
    """
    call = "head_picture(path, mesh, displacement, around)"
    mesh_given(mesh, call)
    mesh_given(around, call)
    field_given(displacement, call, "the displacement")
    for owner, name in ((mesh, "skin"), (around, "head")):
        if name not in owner.surfaces:
            raise InputError(f"{call}: a surface {name!r} is needed; there is {owner.places}")
    skin = mesh.surfaces["skin"]
    points = np.concatenate([around.points[np.unique(around.surfaces["head"])],
                             mesh.points[np.unique(skin)]])  # fmt: skip
    layout = Layout(sheet_size(1800, 3, 2, 1.05, bool(title)), 3, 2, bool(title), bars=True)
    cameras = [fitted(view, points, layout.panel) for view in views]
    nearest = max(cameras, key=lambda camera: camera.scale)
    rest = _layer(around, nearest, around.surfaces["head"], PALE, False, "skin")
    before = _layer(mesh, nearest, skin, SKIN, False, "skin")
    moved = _surface(mesh, nearest, skin, "skin", displacement)
    after = Layer(moved, SKIN, translucent=True)
    lengths, bar = _lengths(mesh, displacement, moved)
    painted = Layer(moved, values=lengths, limits=bar.limits, table=bar.table, levels=bar.levels)
    panels = []
    for view, camera in zip(views, cameras, strict=True):
        for layer, caption in ((before, "before"), (after, "after"), (painted, "how far it moved")):
            picture = shaded(camera, [layer, rest]).colours
            scale = bar if layer is painted and view == views[-1] else None
            panels.append(Panel(picture, camera, f"{view}, {caption}", scale))
    return _finished(path, panels, layout, title, overwrite)


def _layer(
    mesh: TetMesh,
    camera: Camera,
    facets: Ints,
    colour: tuple[float, float, float],
    wires: bool,
    name: str,
) -> Layer:
    surface = _surface(mesh, camera, facets, name, None)
    return Layer(surface, colour, translucent=name == "skin", wires=wires)


def _surface(
    mesh: TetMesh, camera: Camera, facets: Ints, name: str, displacement: Field | None
) -> Surface:
    """A surface cut as finely as a camera asks for."""
    crease = SKIN_CREASE if name == "skin" else CREASE
    near, side = NEAR / camera.scale, SIDE / camera.scale
    return displaced(mesh, facets, displacement, near, crease, longest=side)


def _lengths(mesh: TetMesh, displacement: Field, surface: Surface) -> tuple[Floats, Bar]:
    """How far each sample (s,) of the skin moved in mm, and the bar that says so."""
    lengths = numbers_on(mesh, displacement, surface, None)
    top = float(lengths.max())
    return lengths, Bar("mm", (0.0, top), colours("magma_r"), round_levels(0.0, max(top, 1e-9)))


def _finished(
    path: str | Path | None, panels: list[Panel], layout: Layout, title: str, overwrite: bool
) -> bytes:
    content = png(sheet(panels, layout, title), title)
    if path is not None:
        written(path, content, overwrite)
    return content
