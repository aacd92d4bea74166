# SPDX-License-Identifier: BSD-3-Clause
"""What a picture shows: a surface, what stands beside it, and how both were moved."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bezsoma.arrays import Floats, Ints
from bezsoma.bernstein import domain_points
from bezsoma.errors import InputError
from bezsoma.mesh import Field, TetMesh
from bezsoma.view.restriction import controls_on, degree_of, facets_named, on_same_mesh
from bezsoma.view.surfaces import Surface, displaced

Named = str | tuple[str, ...] | None
NEAR = 0.25
"""How far triangles may be from the polynomial surface, in pixels."""
SIDE = 6.0
"""How long their sides are at most, for shades and colours to be smooth between corners, in pixels.

As it was before the move; a magnified one stretches them."""
CREASE, SKIN_CREASE = 0.7, 2.0
"""Where facets meet at a larger angle in rad, an edge is seen; skin has none but the sharpest."""


@dataclass(frozen=True, eq=False)
class Subject:
    """What is to be seen: the surface that matters, and the rest of the boundary in grey."""

    mesh: TetMesh
    facets: Ints
    rest: Ints
    veil: Ints
    """Facets that are seen through."""
    displacement: Field | None
    """In mm."""
    magnified: float
    crease: float
    """The angle in rad beyond which facets keep an edge between them."""

    @classmethod
    def of(
        cls,
        mesh: TetMesh,
        surface: Named,
        rest: bool,
        displacement: Field | None,
        magnified: float,
        translucent: Named = None,
    ) -> Subject:
        """The subject of these facets, once all of it is checked."""
        if displacement is not None:
            _check_displacement(mesh, displacement)
        if not np.isfinite(magnified):
            raise InputError(f"a displacement cannot be drawn {magnified} times; give a number")
        facets = facets_named(mesh, surface)
        veil = facets[:0] if translucent is None else facets_named(mesh, translucent)
        facets = _without(facets, veil)
        if not len(facets):
            raise InputError(
                f"all that would be seen is translucent ({translucent!r}); name a surface behind it"
            )
        others = _without(mesh.boundary, np.concatenate([facets, veil])) if rest else facets[:0]
        crease = SKIN_CREASE if is_skin(surface) else CREASE
        return cls(mesh, facets, others, veil, displacement, magnified, crease)

    def points(self) -> Floats:
        """Points (p, 3) mm that a camera must show: corners and controls, before and after.

        A displaced patch lies in the convex hull of its controls, so nothing sticks out.
        """
        every = np.concatenate([self.facets, self.rest, self.veil])
        corners = self.mesh.points[every]
        if self.displacement is None:
            return np.asarray(corners.reshape(-1, 3))
        degree = degree_of(self.displacement)
        controls = self.magnified * controls_on(self.mesh, self.displacement, every)
        after = domain_points(degree, 2) @ corners + controls
        return np.concatenate([corners.reshape(-1, 3), after.reshape(-1, 3)])

    def surfaces(self, scale: float, moved: bool) -> tuple[Surface, Surface | None]:
        """The surface that matters and the rest, before or after the displacement."""
        front, back, _ = self.every_surface(scale, moved)
        return front, back

    def every_surface(
        self, scale: float, moved: bool
    ) -> tuple[Surface, Surface | None, Surface | None]:
        """The surface that matters, the rest, and what is seen through, before or after."""
        field = self.displacement if moved else None
        near, side = NEAR / scale, SIDE / scale
        first, second, third = (
            displaced(self.mesh, facets, field, near, crease, self.magnified, side)
            if len(facets)
            else None
            for facets, crease in (
                (self.facets, self.crease),
                (self.rest, CREASE),
                (self.veil, SKIN_CREASE),
            )
        )
        assert first is not None  # a named surface of a mesh is never empty
        return first, second, third


def is_skin(surface: Named) -> bool:
    """Whether a surface is shown as skin: by its name, the only thing that says what it is.

    >>> is_skin("skin"), is_skin(("jaw", "skin")), is_skin("jaw"), is_skin(None)
    (True, True, False, False)
    """
    return "skin" in ((surface,) if isinstance(surface, str) else surface or ())


def _check_displacement(mesh: TetMesh, displacement: Field) -> None:
    """Refuses what does not move points of this mesh in space."""
    if not isinstance(displacement, Field):
        raise InputError(
            "a displacement that jumps between tets cannot be drawn; give a Field, such as"
            " averaged() of a broken one"
        )
    on_same_mesh(mesh, displacement, "displacement")
    shape = np.asarray(displacement.controls).shape
    if shape[1:] != (3,):
        raise InputError(
            f"a displacement has three components in mm, but these controls have shape {shape}"
        )
    if not np.isfinite(displacement.controls).all():
        raise InputError("the displacement holds NaN or infinite controls; it cannot be drawn")


def _without(facets: Ints, taken: Ints) -> Ints:
    """Those of the facets (f, 3) that are not among `taken`."""
    rows, number = np.unique(np.concatenate([facets, taken]), axis=0, return_inverse=True)
    keep = np.ones(len(rows), np.bool_)
    keep[number.ravel()[len(facets) :]] = False
    return facets[keep[number.ravel()[: len(facets)]]]
