# SPDX-License-Identifier: BSD-3-Clause
"""Where a point lies: in which tet, and which point of a surface is nearest to it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from weakref import WeakKeyDictionary

import numpy as np

from bezsoma.arrays import Floats, Ints
from bezsoma.errors import InputError
from bezsoma.mesh.bins import BoxBins
from bezsoma.mesh.tets import TetMesh
from bezsoma.mesh.triangles import Nearest, Triangles

PAIRS = 1 << 20
"""Pairs of point and tet looked at together."""
SLACK = 1e-10
"""How far outside a tet, relative to its longest side, a point still counts as in it."""
ROUNDING = 64 * np.finfo(np.float64).eps
"""The same relative to the largest coordinate: what reading a point may have cost it."""


@dataclass(frozen=True, eq=False)
class TetBins:
    """The tets of a mesh, sorted so that those around a point are found at once.

    Boxes around the tets are kept in grids, one for each class of size (`bins.BoxBins`), so that
    large and small tets, or slivers, may lie side by side and none is ever missed.
    """

    points: Floats
    tets: Ints
    gradients: Floats
    slack: Floats
    bins: BoxBins

    @classmethod
    def of(cls, mesh: TetMesh) -> TetBins:
        """The bins of a mesh."""
        corners = mesh.points[mesh.tets]
        low, high = corners.min(axis=1), corners.max(axis=1)
        size = (high - low).max(axis=1)
        distance = SLACK * size + ROUNDING * np.abs(mesh.points).max()
        slack = distance[:, None] * np.linalg.norm(mesh.gradients, axis=2)
        bins = BoxBins.of(low - distance[:, None], high + distance[:, None])
        return cls(mesh.points, mesh.tets, mesh.gradients, slack, bins)

    def owners(self, points: Floats) -> Ints:
        """The tet of the lowest number in which each point (p, 3) lies, (p,); -1 where none."""
        owner = np.full(len(points), len(self.tets), dtype=np.int64)
        for asked, candidates in self.bins.around(points, PAIRS):
            bary = self.bary(points[asked], candidates)
            holds = (bary >= -self.slack[candidates]).all(axis=1)
            np.minimum.at(owner, asked[holds], candidates[holds])
        owner[owner == len(self.tets)] = -1
        return owner

    def bary(self, points: Floats, tets: Ints) -> Floats:
        """The barycentric coordinates (p, 4) of each point (p, 3) in its own tet (p,).

        Point = sum_i L_i corner_i, with L_1 + .. + L_4 = 1 (paper, eqs. 54 and 55).
        """
        offset = points - self.points[self.tets[tets, 0]]
        bary: Floats = np.einsum("pid,pd->pi", self.gradients[tets], offset)
        bary[:, 0] += 1.0
        return bary


_BINS: WeakKeyDictionary[TetMesh, TetBins] = WeakKeyDictionary()
"""One search structure for each mesh alive, whoever asks; it holds no reference to the mesh."""


@dataclass(frozen=True, eq=False)
class Locator:
    """Finds the tets that hold points, and the nearest points of surfaces.

    The work to prepare is done once a mesh, at the first question, and shared by all locators
    of that mesh.

    >>> from bezsoma.mesh.solids import block
    >>> mesh = block(cells=(2, 2, 2))
    >>> points = np.random.default_rng(0).uniform(0, 1, (50, 3))
    >>> tets, bary = Locator(mesh).tets_of(points)
    >>> bool(np.allclose(np.einsum("pi,pid->pd", bary, mesh.points[mesh.tets[tets]]), points))
    True
    """

    mesh: TetMesh

    @cached_property
    def bins(self) -> TetBins:
        """The search structure of the mesh."""
        if self.mesh not in _BINS:
            _BINS[self.mesh] = TetBins.of(self.mesh)
        return _BINS[self.mesh]

    @cached_property
    def boundary(self) -> Triangles:
        """The boundary of the mesh, ready for `nearest`."""
        return Triangles.of(self.mesh.points[self.mesh.boundary])

    def tets_of(self, points: Floats) -> tuple[Ints, Floats]:
        """The tet of each point (p, 3) in mm, (p,), and the barycentric coordinates in it (p, 4).

        A point on a face, edge or vertex is given to the tet of the lowest number there.  A point
        outside has tet -1 and coordinates nan; it counts as inside while its distance is below
        1e-10 of the tet's size, so that points computed on the boundary are not lost, and its
        coordinates then are as they are, slightly negative.
        """
        points = finite(points)
        tets = self.bins.owners(points)
        bary = np.full((len(points), 4), np.nan)
        found = np.flatnonzero(tets >= 0)
        bary[found] = self._refined(points[found], tets[found])
        return tets, bary

    def nearest(self, points: Floats, place: str | None = None) -> Nearest:
        """The nearest point of the boundary, or of a named surface, to each point (p, 3) in mm.

        Gives (facet, bary, distance): the row (p,) in `mesh.boundary` or in the named surface,
        the barycentric coordinates there (p, 3), and the distance (p,) in mm, exact for flat
        facets wherever the point lies.
        """
        if place is None:
            return self.boundary.nearest(finite(points))
        return Triangles.of(self.mesh.points[self.mesh.facets_of(place)]).nearest(finite(points))

    def in_tets(self, nearest: Nearest) -> tuple[Ints, Floats]:
        """The tets (p,) and coordinates (p, 4) of nearest points on the boundary."""
        facets = self.mesh.boundary[nearest.facet]
        tets = self.mesh.tets_of_facets(facets)
        same = self.mesh.tets[tets][:, :, None] == facets[:, None, :]
        return tets, np.einsum("pij,pj->pi", same, nearest.bary)

    def _refined(self, points: Floats, tets: Ints) -> Floats:
        """Coordinates (p, 4) that give the points back to rounding, in slivers too.

        In a sliver the coordinates are ill-conditioned; one step of iterative refinement
        puts the rounding where it does no harm: sum_i L_i v_i is x again.
        """
        bary = self.bins.bary(points, tets)
        corners = self.mesh.points[self.mesh.tets[tets]]
        edges = corners[:, 1:] - corners[:, :1]
        rest = points - corners[:, 0] - np.einsum("pi,pid->pd", bary[:, 1:], edges)
        bary[:, 1:] += np.einsum("pid,pd->pi", self.mesh.gradients[tets, 1:], rest)
        bary[:, 0] = 1.0 - bary[:, 1:].sum(axis=1)
        return bary


def finite(points: Floats) -> Floats:
    """The points (p, 3) as float64, checked: a shape or a number that is none is refused."""
    points = np.asarray(points, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 3:
        raise InputError(f"points of shape {points.shape} were given; (p, 3) in mm is needed")
    bad = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if len(bad):
        raise InputError(f"point {bad[0]} is {points[bad[0]].tolist()}; it has to be finite")
    return points
