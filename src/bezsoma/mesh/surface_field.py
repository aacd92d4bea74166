# SPDX-License-Identifier: BSD-3-Clause
"""A field on a surface: what a picture draws and a face probe reads."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bezsoma import bernstein
from bezsoma.arrays import Floats, Ints
from bezsoma.errors import InputError
from bezsoma.mesh.tets import TetMesh
from bezsoma.mesh.topology import cross


@dataclass(frozen=True, eq=False)
class SurfaceField:
    """The trace of a continuous field on facets: controls (f, m2, ...) of degree n in 2-D.

    It is exact: the controls of a facet *are* those of the tet that lie on it.
    """

    mesh: TetMesh
    facets: Ints
    """The vertices of each facet, ascending (f, 3)."""
    degree: int
    numbers: Ints
    """The numbers of the controls in the field's net (f, m2)."""
    controls: Floats
    """(f, m2, ...) in the order of 2-D multi-indices."""

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of a value."""
        return self.controls.shape[2:]

    @property
    def displacement(self) -> Floats:
        """The controls (f, m2, 3) in mm, once it is seen that they can move points."""
        if self.shape != (3,):
            raise InputError(
                f"a field with values of shape {self.shape} does not move points; "
                "a displacement has the shape (3,)"
            )
        return self.controls

    @cached_property
    def corners(self) -> Floats:
        """The corners of each facet (f, 3, 3) in mm."""
        return self.mesh.points[self.facets]

    @property
    def positions(self) -> Floats:
        """The domain point of each control (f, m2, 3) in mm: the flat facet's own net."""
        return self.places(bernstein.domain_points(self.degree, 2))

    @cached_property
    def turns(self) -> Floats:
        """+1 where the facet's ascending vertices turn counterclockwise seen from outside (f,).

        Between two tets, outside is where the one with the higher number lies.
        """
        turned = self.mesh.outward(self.facets)[:, 1] != self.facets[:, 1]
        return np.where(turned, -1.0, 1.0)

    def at_bary(self, bary: Floats) -> Floats:
        """The values (f, b, ...) at the same barycentric points (b, 3) of every facet."""
        return _evaluated(self.degree, bary, self.controls)

    def places(self, bary: Floats) -> Floats:
        """The places (f, b, 3) in mm of barycentric points (b, 3) on the undeformed facets."""
        places: Floats = np.matmul(np.asarray(bary, dtype=np.float64), self.corners)
        return places

    def net(self, scale: float = 1.0) -> Floats:
        """The surface moved by the field, a displacement, as Bezier triangles: controls (f, m2, 3).

        In mm. The flat facet has its controls at the domain points and the displacement adds its
        own, so the moved surface has the degree of the displacement, exactly.
        """
        return self.positions + scale * self.displacement

    def displaced(self, bary: Floats, scale: float = 1.0) -> Floats:
        """The places (f, b, 3) in mm moved by the field, a displacement, times a scale."""
        return self.places(bary) + scale * _evaluated(self.degree, bary, self.displacement)

    def normals(self, bary: Floats, scale: float = 1.0) -> Floats:
        """The unit outward normals (f, b, 3) of the displaced surface; scale 0: of the facets.

        The surface x + u is a Bezier triangle; its tangents are the differences of its controls.
        Beware: between facets they jump, as the surface is continuous and no smoother.
        """
        net = self.net(scale)
        return patch_normals(self.degree, net, bary) * self.turns[:, None, None]

    def integral(self) -> Floats:
        """The integral over the undeformed surface (...), value times mm2.

        int_F B_alpha = area / C(n+2, 2): each facet's area times its mean control.
        """
        areas = self.mesh.areas(self.facets)
        return np.asarray(np.einsum("f,f...->...", areas, self.controls.mean(axis=1)))


def patch_normals(degree: int, net: Floats, bary: Floats) -> Floats:
    """Unit normals (f, b, 3) of Bezier triangles with the controls (f, m2, 3), degree at least 1.

    The vector product of the tangents, which are n times the differences of neighbouring controls;
    zero where the patch is crushed. It points to where the vertices turn counterclockwise.
    """
    shifts = bernstein.shifts(degree, 2)
    tangents = [
        _evaluated(degree - 1, bary, net[:, shifts[:, i]] - net[:, shifts[:, 0]]) for i in (1, 2)
    ]
    normal = cross(*tangents)
    length = np.linalg.norm(normal, axis=2, keepdims=True)
    unit: Floats = np.divide(normal, length, out=np.zeros_like(normal), where=length > 0)
    return unit


def _evaluated(degree: int, bary: Floats, controls: Floats) -> Floats:
    weights = bernstein.values(degree, np.asarray(bary, dtype=np.float64))
    return np.moveaxis(np.tensordot(weights, controls, (1, 1)), 0, 1)
