# SPDX-License-Identifier: BSD-3-Clause
"""Slices and contours: surfaces in a body on which a polynomial has one value.

A slice of the body before it moves is the level of a linear function, one of the moved body that
of normal . (x + u(x)), a polynomial of the degree of u; a contour is the level of any field.
Whatever is then asked for on it is evaluated from the polynomials of the tets, not interpolated.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, sqrt

import numpy as np

from bezsoma import bernstein
from bezsoma.arrays import Floats, Ints
from bezsoma.errors import InputError
from bezsoma.mesh import evaluation
from bezsoma.mesh.broken_field import BrokenField
from bezsoma.mesh.control_net import ControlNet
from bezsoma.mesh.field import Field
from bezsoma.mesh.marching import lattice_numbers, marched, straying
from bezsoma.mesh.nouns import field_given
from bezsoma.mesh.planes import Plane
from bezsoma.mesh.tets import TetMesh
from bezsoma.mesh.topology import cross

MOST_PARTS = 20
"""The finest lattice: 8,000 small tets in each that the level reaches."""
_SLACK = 1e-12


@dataclass(frozen=True, eq=False)
class Level:
    """Triangles in tets on which a field has one value: a slice or a contour.

    Their corners are on the level to rounding. They turn so that the field grows to the side to
    which (b - a) x (c - a) points, before any displacement.
    """

    mesh: TetMesh
    tets: Ints
    """(r,) the tet in which each triangle lies."""
    bary: Floats
    """(r, 3, 4) its corners, barycentric in that tet."""
    vertex: Ints
    """(r, 3) one number for corners that neighbours share; a broken field's do not meet."""
    stray: float
    """By how much, at most, the field differs from the level anywhere on a triangle."""

    def __len__(self) -> int:
        return len(self.tets)

    @property
    def points(self) -> Floats:
        """The corners (r, 3, 3) in mm, before any displacement."""
        return np.asarray(self.bary @ self.mesh.points[self.mesh.tets[self.tets]])

    @property
    def areas(self) -> Floats:
        """The area (r,) of each triangle in mm2, before any displacement."""
        a, b, c = np.moveaxis(self.points, 1, 0)
        return np.asarray(np.linalg.norm(cross(b - a, c - a), axis=1) / 2)

    def at(self, field: Field | BrokenField, inner: Floats | None = None) -> Floats:
        """The values (r, b, ...) at barycentric points (b, 3) of each triangle; else its corners.

        They are the field's own polynomial in the tet, so that on a plane slice they are exact
        between the corners too.
        """
        bary, count = self._within(inner)
        return evaluation.values(field, np.repeat(self.tets, count), bary).reshape(
            len(self), count, *field.shape
        )

    def gradient(self, field: Field | BrokenField, inner: Floats | None = None) -> Floats:
        """The gradients (r, b, ..., 3) at such points, a value a mm."""
        bary, count = self._within(inner)
        return evaluation.gradients(field, np.repeat(self.tets, count), bary).reshape(
            len(self), count, *field.shape, 3
        )

    def places(self, inner: Floats) -> Floats:
        """Where (r, b, 3) those points lie in mm, before any displacement."""
        return np.asarray(inner @ self.points)

    def _within(self, inner: Floats | None) -> tuple[Floats, int]:
        """Barycentric points in the tets (r b, 4), and how many in each triangle."""
        bary = self.bary if inner is None else inner @ self.bary
        return bary.reshape(-1, 4), bary.shape[1]


def contour(
    field: Field | BrokenField, level: float = 0.0, tolerance: float | None = None
) -> Level:
    """The surface on which a scalar field has a value, as triangles in the tets.

    `tolerance`, in the unit of the field, bounds how far it may be from the level anywhere on
    the triangles: tets are cut finely enough, up to 20 parts an edge, or the contour is refused.
    Without it there are as many parts as the degree, and `Level.stray` says what came out. Beware:
    a closed piece of the level so small that it passes between the points of the lattice is not
    seen; between them the field is within `stray` of the level there.

    >>> from bezsoma.mesh.solids import block
    >>> net = ControlNet(block(cells=(2, 2, 2)), 2)
    >>> square = Field.interpolating(net, lambda x: (x**2).sum(axis=1))
    >>> sphere = contour(square, 0.49, tolerance=0.005)  # an eighth of one of radius 0.7
    >>> float(round(sphere.areas.sum() / (4 * np.pi * 0.49 / 8), 2))
    1.0
    """
    field_given(field, "contour(field, level)", "the field")
    if field.shape != ():
        raise InputError(
            f"a contour of values of shape {field.shape} has no meaning; give a scalar field, "
            "such as one component or an interpolated length"
        )
    cut, lowest, highest = _levelled(field, level, tolerance)
    if not len(cut):
        raise InputError(
            f"the field does not reach the level {level:g}: it lies between {lowest:.4g} and "
            f"{highest:.4g} (the range of its controls); choose a level inside its values"
        )
    return cut


def slice_of(
    mesh: TetMesh,
    plane: Plane | str,
    displacement: Field | None = None,
    tolerance: float | None = None,
    parts: int | None = None,
) -> Level:
    """The slice of a body by a plane: before it moves, or, with a displacement, after.

    After the move it is where normal . (x + u(x)) = offset; its corners then lie in the plane
    once the displacement is added, and so do the triangles. `tolerance` in mm bounds how far
    places between the corners, which move with u, leave the plane; `parts` says instead into how
    many the edges of tets are cut, 1 to 20.

    >>> from bezsoma.mesh.solids import block
    >>> cut = slice_of(block((4, 2, 1), (4, 2, 1)), "x=1.5")
    >>> float(round(cut.areas.sum(), 12)), float(np.ptp(cut.points[..., 0]))
    (2.0, 0.0)
    """
    plane = Plane.of(plane)
    cut, *_ = _levelled(height(mesh, plane, displacement), 0.0, tolerance, parts)
    if not len(cut):
        raise InputError(off_the_body(mesh, plane, displacement))
    return cut


def height(
    mesh: TetMesh, plane: Plane, displacement: Field | None = None, magnified: float = 1.0
) -> Field:
    """How far above a plane each point lies, before or after a displacement, in mm: a field."""
    if displacement is None:
        net = ControlNet(mesh, 1)
        return Field(net, plane.heights(net.points))
    net = displacement.net
    return Field(net, plane.heights(net.points + magnified * displacement.controls))


def off_the_body(mesh: TetMesh, plane: Plane, displacement: Field | None) -> str:
    """The sentence for a plane that does not cut the body."""
    above = height(mesh, plane, displacement).controls
    normal = np.array(plane.normal)
    axis = int(np.abs(normal).argmax())
    if abs(normal[axis]) == 1.0:
        along = normal[axis] * (above + plane.offset) + 0.0  # no -0
        reach = f"from {'xyz'[axis]} = {along.min():.4g} to {along.max():.4g} mm"
    else:
        reach = f"from {above.min():.4g} to {above.max():.4g} mm above that plane"
    when = "" if displacement is None else " after it moved"
    return (
        f"the plane {plane} does not cut the body, which{when} reaches {reach}; choose a plane "
        "between"
    )


def _levelled(
    field: Field | BrokenField, level: float, tolerance: float | None, parts: int | None = None
) -> tuple[Level, float, float]:
    """The cut of a field at a level, and the least and largest of all its controls."""
    low, high = (float(bound) for bound in field.bounds())
    near = _SLACK * max(abs(low), abs(high), abs(level))
    tets = _reached(field, level, near)
    controls = field.on_tets(tets) - level
    if parts is None:
        parts = parts_within(field.degree, 3, controls, tolerance)
    numbers = _numbers(field, tets, parts)
    found = marched(field.degree, 3, controls, numbers, parts)
    stray = float(straying(field.degree, 3, controls, parts).max(initial=0.0))
    bary, vertex = _turned(field, level, tets[found.owner], found.bary, found.vertex)
    return Level(field.mesh, tets[found.owner], bary, vertex, stray), low, high


def _reached(field: Field | BrokenField, level: float, near: float) -> Ints:
    """The tets whose controls do not all lie on one side of the level: no other can reach it."""
    every = np.arange(len(field.mesh.tets))
    found = []
    for part in evaluation.tet_portions(field, bernstein.count(field.degree, 3)):
        local = field.on_tets(part)
        crossed = (local.min(axis=1) <= level + near) & (local.max(axis=1) >= level - near)
        found.append(every[part][crossed])
    return np.concatenate(found)


def parts_within(degree: int, dim: int, controls: Floats, tolerance: float | None) -> int:
    """Into how many parts to cut the edges of simplices, for a tolerance or without one."""
    if tolerance is None:
        return degree
    if not (np.isfinite(tolerance) and tolerance > 0):
        raise InputError(f"a tolerance of {tolerance!r} cannot be met; give a positive number")
    stray = float(straying(degree, dim, controls, 1).max(initial=0.0))
    parts = max(1, ceil(sqrt(stray / tolerance) * (1 - 1e-12)))
    if parts > MOST_PARTS:
        raise InputError(
            f"a tolerance of {tolerance:g} would take {parts} parts an edge, and "
            f"{MOST_PARTS} are allowed; {stray / MOST_PARTS**2:.3g} can be had, or less on a "
            "finer mesh"
        )
    return parts


def _numbers(field: Field | BrokenField, tets: Ints, parts: int) -> Ints:
    """Numbers (q, l) of the lattice points of some tets, shared where the field is continuous."""
    if isinstance(field, Field):
        return lattice_numbers(field.mesh.tets[tets], parts)
    size = bernstein.count(parts, 3)
    return np.arange(len(tets) * size).reshape(-1, size)


def _turned(
    field: Field | BrokenField, level: float, tets: Ints, bary: Floats, vertex: Ints
) -> tuple[Floats, Ints]:
    """The triangles turned so that the field grows along their normals."""
    a, b, c = np.moveaxis(bary @ field.mesh.points[field.mesh.tets[tets]], 1, 0)
    normal = cross(b - a, c - a)
    slope = evaluation.gradients(field, tets, bary.mean(axis=1))
    wrong = np.einsum("rd,rd->r", normal, slope) < 0
    order = np.where(wrong[:, None], [0, 2, 1], [0, 1, 2])
    return (
        np.take_along_axis(bary, order[..., None], axis=1),
        np.take_along_axis(vertex, order, axis=1),
    )
