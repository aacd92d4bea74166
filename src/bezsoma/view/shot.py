# SPDX-License-Identifier: BSD-3-Clause
"""What a picture shows and how: everything but the camera, the page and the file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from bezsoma.arrays import Floats
from bezsoma.errors import InputError
from bezsoma.mesh import Field, TetMesh
from bezsoma.mesh.nouns import field_given, mesh_given
from bezsoma.mesh.planes import Plane
from bezsoma.view.camera import Camera
from bezsoma.view.light import BONE, CLAY, REST, SKIN, TISSUE
from bezsoma.view.numbers import Measure, numbers_on
from bezsoma.view.overlays import Screen, control_net, wireframe
from bezsoma.view.pieces import Drawn, clipped
from bezsoma.view.restriction import AnyField
from bezsoma.view.sections import Section, level_surface
from bezsoma.view.shading import Layer, shaded
from bezsoma.view.sheet import Bar, Panel, Strokes, colours, round_levels
from bezsoma.view.subject import Named, Subject, is_skin
from bezsoma.view.surfaces import Surface, displaced

_NOTHING = 1 / 512
"""A range that begins this near zero, relative to its end, begins at zero: half a colour of 256."""
_VEIL = 0.38
"""How much of what is seen through a translucent surface is that surface."""


class Part(NamedTuple):
    """A surface of a picture, and its numbers (..) where it is coloured by a field."""

    surface: Drawn
    numbers: Floats | None
    colour: tuple[float, float, float]
    skin: bool = False
    rim: bool = False
    """Whether its edges are drawn in any case."""


@dataclass(frozen=True, eq=False)
class Shot:
    """A surface or a body cut open, plain or coloured by a field, moved or not.

    What each word means stands at `picture`, which makes one of its arguments; `side_by_side`,
    `film` and `show` take shots as they are.
    """

    mesh: TetMesh
    colour: AnyField | None = None
    displacement: Field | None = None
    magnified: float = 1.0
    surface: Named = None
    rest: bool = True
    translucent: Named = None
    plane: Plane | str | None = None
    carried: bool = False
    before: bool = False
    net: bool = False
    measure: Measure | None = None
    label: str = ""
    limits: tuple[float, float] | None = None
    table: str = "viridis"
    wires: bool = False
    levels: tuple[float, ...] = ()
    caption: str | None = None

    def checked(self, call: str) -> Shot:
        """The same shot, once what it holds was found fit to be drawn."""
        mesh_given(self.mesh, call)
        for field, what in ((self.colour, "the colour"), (self.displacement, "the displacement")):
            if field is not None:
                field_given(field, call, what)
        if self.before and self.displacement is None:
            raise InputError(f"{call}: nothing moves, so there is no 'before' to draw over it")
        if self.plane is not None:
            Plane.of(self.plane)
        scalar = self.colour is not None and self.colour.shape == () and self.measure is None
        if self.levels and not (scalar and self.plane is None):
            raise InputError(
                f"{call}: levels are those of a scalar colour without a measure, in a body that is "
                "not cut open; give a field of one component, and no plane"
            )
        _ = self.subject  # its faults are told here
        return self

    @cached_property
    def subject(self) -> Subject:
        """The facets that are seen."""
        return Subject.of(
            self.mesh,
            self.surface,
            self.rest,
            self.displacement,
            self.magnified,
            self.translucent,
        )

    def seen(self, camera: Camera) -> Seen:
        """All that this camera sees of it, in parts."""
        section = self.section(camera)
        face = None if section is None else section.face(self.colour, self.measure, self.wires)
        front, back, veil = self.subject.every_surface(camera.scale, self.displacement is not None)
        numbers = None
        if self.colour is not None and section is None:
            numbers = numbers_on(self.mesh, self.colour, front, self.measure)

        def kept(surface: Surface) -> Drawn:
            return surface if section is None else section.behind(surface)

        if self.levels:
            outside = Part(front, numbers, SKIN, True)
            return Seen(self._level_parts(), outside, self._strokes(camera, [outside], None))
        skin = is_skin(self.surface)
        paint = SKIN if skin else CLAY if self.translucent is None else BONE
        solid = [Part(kept(front), numbers, paint, skin)]
        if back is not None:
            solid.append(Part(kept(back), None, REST))
        if face is not None:
            solid.append(Part(face[0], face[1], TISSUE, rim=True))
        veiled = None if veil is None else Part(kept(veil), None, SKIN, True)
        return Seen(tuple(solid), veiled, self._strokes(camera, solid, section))

    def _level_parts(self) -> tuple[Part, ...]:
        """The surfaces inside on which the colour has its levels."""
        parts = []
        for level in self.levels:
            assert self.colour is not None  # as `checked` saw
            inside = level_surface(self.colour, level, self._drawn)
            parts.append(Part(inside, np.full(inside.vertex.shape, float(level)), TISSUE))
        return tuple(parts)

    @property
    def _drawn(self) -> Field | None:
        """The displacement as it is drawn, mm."""
        given = self.displacement
        if given is None or self.magnified == 1.0:
            return given
        return Field(given.net, self.magnified * given.controls)

    def section(self, camera: Camera) -> Section | None:
        """The plane that cuts it open, if one does, turned to the viewer."""
        if self.plane is None:
            return None
        return Section.of(self.mesh, self.plane, self._drawn, self.carried, camera)

    def _strokes(
        self, camera: Camera, solid: list[Part], section: Section | None
    ) -> tuple[Strokes, ...]:
        """The lines over it."""
        strokes = []
        if self.before:
            facets = np.concatenate([self.subject.facets, self.subject.rest])
            old: Drawn = displaced(self.mesh, facets, None)
            hiding, kept, rim = [old], None, np.empty((0, 2, 3))
            if section is not None:
                kept = section.kept()
                hiding = [clipped(old, section.plane.heights(old.points))]
                if (cut := section.face_before()) is not None:
                    face, rim = cut
                    hiding.append(face)
            strokes.append(wireframe(self.subject, Screen.of(camera, hiding), kept, rim))
        if self.net:
            screen = Screen.of(camera, [part.surface for part in solid])
            whole = None if section is None else section.keeps(self.subject.facets)
            strokes.append(control_net(self.subject, screen, whole))
        return tuple(strokes)


class Seen(NamedTuple):
    """What a camera sees of a shot."""

    solid: tuple[Part, ...]
    veil: Part | None
    strokes: tuple[Strokes, ...]

    def numbers(self) -> Floats:
        """All numbers that a colour stands for, (n,)."""
        parts = self.solid if self.veil is None else (*self.solid, self.veil)
        return np.concatenate([part.numbers.ravel() for part in parts if part.numbers is not None])


def panel(shot: Shot, seen: Seen, camera: Camera, caption: str, bar: Bar | None) -> Panel:
    """The picture of a shot; `bar` is what its colours stand for."""
    solid = [_layer(part, bar, shot.wires) for part in seen.solid if len(part.surface.points)]
    shown = shaded(camera, solid).colours
    if seen.veil is not None and len(seen.veil.surface.points):
        veil = shaded(camera, [*solid, _layer(seen.veil, None, False)]).colours
        shown = _VEIL * veil + (1 - _VEIL) * shown
    return Panel(shown, camera, caption, bar, strokes=seen.strokes)


def bar_of(shots: Sequence[Shot], seen: Sequence[Seen]) -> Bar | None:
    """One colour bar for all that is coloured, as the first of them wants it."""
    coloured = [pair for pair in zip(shots, seen, strict=True) if pair[0].colour is not None]
    if not coloured:
        return None
    numbers = np.concatenate([each.numbers() for _, each in coloured])
    first = coloured[0][0]
    return bar(numbers, first.label, first.limits, first.table)


def bar(numbers: Floats, label: str, limits: tuple[float, float] | None, table: str) -> Bar:
    """The colour bar of these numbers: their range, unless limits are given."""
    low, high = (float(numbers.min()), float(numbers.max())) if limits is None else limits
    if limits is None and 0 < low < _NOTHING * high:
        low = 0.0
    if not (np.isfinite([low, high]).all() and low <= high):
        raise InputError(f"limits {limits!r} do not go from a lower to a higher number")
    levels = round_levels(low, high) if high > low else np.empty(0)
    return Bar(label, (low, high), colours(table), levels)


def _layer(part: Part, bar: Bar | None, wires: bool) -> Layer:
    if part.numbers is None or bar is None:
        return Layer(part.surface, part.colour, translucent=part.skin, wires=wires or part.rim)
    return Layer(
        part.surface,
        values=part.numbers,
        limits=bar.limits,
        table=bar.table,
        wires=wires or part.rim,
        levels=bar.levels,
    )
