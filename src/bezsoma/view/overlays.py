# SPDX-License-Identifier: BSD-3-Clause
"""Lines over a picture: the mesh as it was, the control net of the displaced surface."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bezsoma.arrays import Bools, Floats, Ints
from bezsoma.bernstein import domain_points
from bezsoma.view.camera import Camera
from bezsoma.view.lattice import SIDES, shared_points, small_triangles
from bezsoma.view.pieces import Drawn
from bezsoma.view.rays import Scene
from bezsoma.view.restriction import controls_on, degree_of, values_at
from bezsoma.view.sheet import Strokes
from bezsoma.view.subject import Subject

BEFORE, NET = "#1f4e79", "#7a1f1f"
_STEPS = 6
"""A line is hidden or seen in so many parts."""
_LIFT = 4e-3
"""How far towards the viewer a line is lifted before it may be hidden, of the picture's size."""


@dataclass(frozen=True, eq=False)
class Screen:
    """What hides lines: surfaces in a camera's frame."""

    camera: Camera
    scene: Scene

    @classmethod
    def of(cls, camera: Camera, surfaces: list[Drawn]) -> Screen:
        """The screen of surfaces that are drawn."""
        seen = [camera.seen(each.corners(each.points)) for each in surfaces]
        return cls(camera, Scene(np.concatenate(seen).astype(np.float32)))

    def shows(self, points: Floats) -> Bools:
        """Whether nothing stands between the viewer and points (p, 3)."""
        lift = _LIFT * max(self.camera.size) / self.camera.scale
        origins = self.camera.seen(points) + np.array([0.0, 0.0, lift])
        ahead = np.broadcast_to(np.array([0, 0, 1], np.float32), origins.shape)
        return ~self.scene.blocked(origins.astype(np.float32), np.ascontiguousarray(ahead))

    def segments(self, start: Floats, end: Floats) -> Floats:
        """What is seen of straight lines (s, 3) to (s, 3): pieces (p, 2, 2) in pixels."""
        share = np.linspace(0, 1, _STEPS + 1)[None, :, None]
        along = start[:, None] + share * (end - start)[:, None]
        middle = (along[:, 1:] + along[:, :-1]) / 2
        seen = self.shows(middle.reshape(-1, 3)).reshape(middle.shape[:2])
        flat = self.camera.pixels(along)
        return np.asarray(np.stack([flat[:, :-1], flat[:, 1:]], axis=2)[seen])


def wireframe(
    subject: Subject, screen: Screen, kept: Bools | None = None, rim: Floats | None = None
) -> Strokes:
    """The edges of the surface as it was, hidden by what `screen` holds.

    Of a body cut open they are those between vertices that are `kept` (v,); the `rim` (s, 2, 3)
    of the cut, which nothing is left to hide, is drawn whole.
    """
    edges = np.unique(subject.facets[:, np.array(SIDES)].reshape(-1, 2), axis=0)
    if kept is not None:
        edges = edges[kept[edges].all(axis=1)]
    points = subject.mesh.points
    segments = screen.segments(points[edges[:, 0]], points[edges[:, 1]])
    if rim is not None:
        segments = np.concatenate([segments, screen.camera.pixels(rim)])
    return Strokes(segments, "before", BEFORE, width=1.0)


def control_net(subject: Subject, screen: Screen, whole: Bools | None = None) -> Strokes:
    """The control net of the displaced surface: controls as dots, joined to their neighbours.

    A control is no point of the surface, except at a vertex; the surface lies in the convex hull
    of the controls of each facet. The net of a facet is drawn whole where any of it is seen: it
    winds about the surface, which would else cut it to pieces. Of a body cut open only those
    facets (f,) have one that are `whole`.
    """
    points, numbers = net_points(subject)
    kept = _faced(subject, screen) & (True if whole is None else whole)
    degree = 1 if subject.displacement is None else degree_of(subject.displacement)
    lines = numbers[kept][:, small_triangles(degree)][..., np.array(SIDES)].reshape(-1, 2)
    ends = np.unique(np.sort(lines, axis=1), axis=0)
    flat = screen.camera.pixels(points)
    return Strokes(flat[ends], "control net", NET, width=0.9, dots=flat[np.unique(numbers[kept])])


def _faced(subject: Subject, screen: Screen) -> Bools:
    """Whether any of each displaced facet (f,) is seen, at points inside it."""
    bary = (domain_points(3, 2) + 1 / 3) / 2
    points = bary @ subject.mesh.points[subject.facets]
    if subject.displacement is not None:
        controls = controls_on(subject.mesh, subject.displacement, subject.facets)
        moved = values_at(degree_of(subject.displacement), controls, bary)
        points = points + subject.magnified * moved
    seen = screen.shows(points.reshape(-1, 3)).reshape(points.shape[:2])
    return np.asarray(seen.any(axis=1))


def net_points(subject: Subject) -> tuple[Floats, Ints]:
    """The controls (c, 3) of the displaced surface in mm, and those of each facet (f, m)."""
    mesh, field = subject.mesh, subject.displacement
    degree = 1 if field is None else degree_of(field)
    numbers, count = shared_points(subject.facets, degree)
    points = domain_points(degree, 2) @ mesh.points[subject.facets]
    if field is not None:
        points = points + subject.magnified * controls_on(mesh, field, subject.facets)
    placed = np.empty((count, 3))
    placed[numbers] = points
    return placed, numbers
