# SPDX-License-Identifier: BSD-3-Clause
"""Contours on a surface: lines on which the trace of a field has one value."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bezsoma import bernstein
from bezsoma.arrays import Floats, Ints
from bezsoma.errors import InputError
from bezsoma.mesh.field import Field
from bezsoma.mesh.levels import parts_within
from bezsoma.mesh.marching import lattice_numbers, marched, straying
from bezsoma.mesh.nouns import field_given
from bezsoma.mesh.tets import TetMesh


@dataclass(frozen=True, eq=False)
class Isolines:
    """Straight pieces on facets, their ends on the level to rounding."""

    mesh: TetMesh
    facets: Ints
    """(s, 3) the vertices of the facet of each piece, ascending."""
    bary: Floats
    """(s, 2, 3) its ends, barycentric on that facet."""
    vertex: Ints
    """(s, 2) one number for ends that neighbours share."""
    stray: float
    """By how much, at most, the field differs from the level anywhere on a piece."""

    def __len__(self) -> int:
        return len(self.facets)

    @property
    def points(self) -> Floats:
        """The ends (s, 2, 3) in mm, before any displacement."""
        return np.asarray(self.bary @ self.mesh.points[self.facets])

    def at(self, field: Field) -> Floats:
        """The values (s, 2, ...) at the ends: add those of a displacement to move the lines."""
        controls = field.controls[field.net.of_facets(self.facets)]
        weights = bernstein.values(field.degree, self.bary)
        return np.asarray(np.einsum("sem,sm...->se...", weights, controls))


def isolines(
    field: Field, level: float, place: str | Ints | None = None, tolerance: float | None = None
) -> Isolines:
    """The lines on a surface, or the whole boundary, on which a scalar field has a value.

    `tolerance`, in the unit of the field, bounds how far it is from the level anywhere on them,
    as for `contour`. On the top of a block the level x y = 1/4 is a hyperbola:

    >>> from bezsoma.mesh import ControlNet, block
    >>> net = ControlNet(block(cells=(2, 2, 2)), 2)
    >>> found = isolines(Field.interpolating(net, lambda x: x[:, 0] * x[:, 1]), 0.25, "top")
    >>> x, y, z = found.points.reshape(-1, 3).T
    >>> bool(np.allclose(x * y, 0.25, atol=1e-14) and (z == 1).all())
    True
    """
    field_given(field, "isolines(field, level)", "the field")
    if not isinstance(field, Field) or field.shape != ():
        raise InputError(
            "lines of one value need a continuous scalar field; give one component, or "
            "averaged() of a broken field"
        )
    trace = field.on_surface(place)
    low, high = trace.controls.min(axis=1), trace.controls.max(axis=1)
    crossed = np.flatnonzero((low <= level) & (high >= level))
    controls, facets = trace.controls[crossed] - level, trace.facets[crossed]
    parts = parts_within(field.degree, 2, controls, tolerance)
    found = marched(field.degree, 2, controls, lattice_numbers(facets, parts), parts)
    if not len(found.owner):
        raise InputError(
            f"the field does not reach the level {level:g} there: it lies between {low.min():.4g} "
            f"and {high.max():.4g} (the range of its controls); choose a level inside its values"
        )
    stray = float(straying(field.degree, 2, controls, parts).max(initial=0.0))
    return Isolines(field.mesh, facets[found.owner], found.bary, found.vertex, stray)
