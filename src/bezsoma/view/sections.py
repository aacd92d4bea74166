# SPDX-License-Identifier: BSD-3-Clause
"""A body cut open by a plane: the face of the cut, evaluated in the tets, and what stays behind."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, sqrt

import numpy as np

from bezsoma.arrays import Bools, Floats, Ints
from bezsoma.bernstein import domain_points
from bezsoma.errors import InputError
from bezsoma.mesh import BrokenField, Field, TetMesh
from bezsoma.mesh.levels import Level, contour, slice_of
from bezsoma.mesh.planes import Plane
from bezsoma.view.camera import Camera
from bezsoma.view.lattice import corners_of
from bezsoma.view.numbers import Measure, measured
from bezsoma.view.pieces import Drawn, Pieces, clipped, refined
from bezsoma.view.restriction import AnyField, controls_on, on_same_mesh, values_at
from bezsoma.view.surfaces import Surface

_TRIANGLES = 40_000
"""About so many make up the face, for its colours to be smooth."""
_MOST_PARTS = 8
"""So many parts an edge suffice for that, however few the tets are."""
_EDGE_ON = 0.1
"""A plane this nearly along the line of sight shows no face."""
_ROUNDING = 1e-12
"""A corner this far before the plane is in it, of the body's size."""


@dataclass(frozen=True, eq=False)
class Section:
    """A plane that cuts a body open for one viewer."""

    mesh: TetMesh
    plane: Plane
    """Its normal points to the viewer's side, which is taken away."""
    displacement: Field | None
    """In mm, as drawn."""
    carried: bool
    """Whether it cut the body before the move, and the cut moved along."""

    @classmethod
    def of(
        cls,
        mesh: TetMesh,
        plane: Plane | str,
        displacement: Field | None,
        carried: bool,
        at: Camera,
    ) -> Section:
        """The plane as seen by a camera; refused where its face would not be seen."""
        given = Plane.of(plane)
        facing = float(np.array(given.normal) @ at.axes[2])
        if abs(facing) < _EDGE_ON:
            raise InputError(
                f"the plane {given} is seen edge-on from here; look along its normal: view='left' "
                "shows x=.., 'front' y=.., 'top' z=.."
            )
        if facing < 0:
            given = Plane((-given.normal[0], -given.normal[1], -given.normal[2]), -given.offset)
        return cls(mesh, given, displacement, carried)

    def behind(self, surface: Surface) -> Pieces:
        """What stays of a surface that is drawn."""
        places = surface.places if self.carried else surface.points
        return clipped(surface, self.plane.heights(places))

    def kept(self) -> Bools:
        """Which vertices (v,) lay behind the plane before the move."""
        return np.asarray(self.plane.heights(self.mesh.points) <= 0)

    def keeps(self, facets: Ints) -> Bools:
        """Which facets (f, 3) stay whole, by where their corners are drawn."""
        places = self.mesh.points[facets]
        if self.displacement is not None and not self.carried:
            controls = controls_on(self.mesh, self.displacement, facets)
            places = places + values_at(self.displacement.degree, controls, np.eye(3))
        heights = self.plane.heights(places.reshape(-1, 3)).reshape(-1, 3)
        return np.asarray((heights <= _ROUNDING * np.ptp(self.mesh.points)).all(axis=1))

    def face(
        self, colour: AnyField | None, measure: Measure | None, wires: bool
    ) -> tuple[Drawn, Floats | None]:
        """The face of the cut and its values (r, 3); its rim is drawn, with `wires` tets too."""
        moves = self.displacement
        if moves is None or self.carried:  # exact however coarse, so the patches are cut
            cut = slice_of(self.mesh, self.plane)
            parts = min(_MOST_PARTS, ceil(sqrt(_TRIANGLES / len(cut))))
        else:  # in the plane at the corners of triangles alone, so the tets are cut
            fine = ceil(sqrt(_TRIANGLES / (2 * len(self.mesh.tets) ** (2 / 3))))
            finest = max(moves.degree, min(_MOST_PARTS, fine))
            cut, parts = slice_of(self.mesh, self.plane, moves, parts=finest), 1
        inner = domain_points(parts, 2)
        places = cut.places(inner)
        if moves is not None:
            places = places + cut.at(moves, inner)
        pieces = refined(places, self._normals(cut, inner), _rims(cut, wires), parts)
        if colour is None:
            return pieces, None
        on_same_mesh(self.mesh, colour, "colour")
        values = cut.at(colour, inner)
        numbers = measured(values.reshape(*values.shape[:2], -1), measure)
        return pieces, corners_of(numbers, parts)

    def face_before(self) -> tuple[Drawn, Floats] | None:
        """The face that the plane cut into the body before the move; None where it missed it.

        With it the straight lines (s, 2, 3) of its rim, in mm.
        """
        heights = self.plane.heights(self.mesh.points)
        grain = _ROUNDING * float(np.ptp(self.mesh.points))
        if heights.min() >= -grain or heights.max() <= grain:
            return None
        face, _ = Section(self.mesh, self.plane, None, False).face(None, None, False)
        corners = face.corners(face.points)
        sides = np.stack([corners[:, [1, 2]], corners[:, [2, 0]], corners[:, [0, 1]]], axis=1)
        return face, np.asarray(sides[face.rims])

    def _normals(self, cut: Level, inner: Floats) -> Floats:
        """The unit normals (r, b, 3) of the face."""
        normal = np.broadcast_to(np.array(self.plane.normal), (len(cut), len(inner), 3))
        return carried_normals(cut, normal, self.displacement if self.carried else None, inner)


def level_surface(field: Field | BrokenField, level: float, displacement: Field | None) -> Pieces:
    """The surface on which a scalar field has a value, moved along; normals exact."""
    cut = contour(field, level)
    corners = np.eye(3)
    places = cut.points if displacement is None else cut.points + cut.at(displacement)
    normals = carried_normals(cut, cut.gradient(field), displacement, corners)
    return refined(places, normals, np.zeros((len(cut), 3), bool), 1)


def carried_normals(
    cut: Level, normals: Floats, displacement: Field | None, inner: Floats
) -> Floats:
    """Unit normals (r, b, 3) after a displacement: along F^-T n, with F = I + grad u."""
    if displacement is not None:
        F = np.eye(3) + cut.gradient(displacement, inner)
        turned = np.linalg.solve(np.swapaxes(F, -1, -2), normals[..., None])
        normals = np.asarray(turned[..., 0], np.float64)
    length = np.linalg.norm(normals, axis=-1, keepdims=True)
    return np.asarray(normals / np.where(length > 0, length, 1.0))


def _rims(cut: Level, inner: bool) -> Bools:
    """Which edges (r, 3) opposite each corner are drawn: the rim, and inner ones in tets' faces."""
    sides = np.stack([cut.vertex[:, [(k + 1) % 3, (k + 2) % 3]] for k in range(3)], axis=1)
    rows = np.sort(sides.reshape(-1, 2), axis=1)
    _, number, times = np.unique(rows, axis=0, return_inverse=True, return_counts=True)
    rim = (times[number.ravel()] == 1).reshape(-1, 3)
    if not inner:
        return np.asarray(rim)
    on = cut.bary == 0
    face = [(on[:, (k + 1) % 3] & on[:, (k + 2) % 3]).any(axis=1) for k in range(3)]
    return np.asarray(rim | np.stack(face, axis=1))
