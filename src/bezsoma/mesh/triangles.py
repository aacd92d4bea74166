# SPDX-License-Identifier: BSD-3-Clause
"""The nearest point on a set of triangles, exactly."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from bezsoma.arrays import Floats, Ints
from bezsoma.errors import InputError
from bezsoma.mesh.topology import cross

PAIRS = 1 << 18
"""Pairs of point and triangle looked at together."""
FIRST = 8
"""Triangles a point is compared with before it asks for more."""
THIN = 1e-8
"""A triangle of twice this area, relative to its reach squared, has no trustworthy normal."""
NORMAL = 1e-6
"""More than the angle by which any other normal can be wrong."""
ROUNDING = 1e-12
SIDES = ((1, 2), (2, 0), (0, 1))


class Nearest(NamedTuple):
    """The nearest points of a surface: where they are and how far."""

    facet: Ints
    """The row of the facet in the surface (p,)."""
    bary: Floats
    """Barycentric coordinates on that facet (p, 3), none negative."""
    distance: Floats
    """mm (p,)."""


@dataclass(frozen=True, eq=False)
class SizeClass:
    """Triangles of about one size: a tree of their centroids, and the largest reach from one."""

    tree: cKDTree
    numbers: Ints
    reach: float


@dataclass(frozen=True, eq=False)
class Triangles:
    """Triangles (f, 3, 3) in mm, sorted by size and place.

    A triangle that reaches r from its centroid c is no nearer to x than |x - c| - r.  So for each
    class of sizes the centroids are asked for in the order of their distance until that bound
    passes the best distance found, and no triangle is missed.
    """

    corners: Floats
    centroids: Floats
    normals: Floats
    """Unit normals (f, 3); zero where a triangle is too thin to have a good one."""
    reach: Floats
    """How far the corners are from the centroid, at most, (f,) in mm."""
    classes: tuple[SizeClass, ...]

    @classmethod
    def of(cls, corners: Floats) -> Triangles:
        """The triangles with these corners (f, 3, 3), made ready for questions."""
        if not len(corners):
            raise InputError("a surface without facets has no nearest point; name one that has")
        centroids = corners.mean(axis=1)
        reach = np.sqrt(((corners - centroids[:, None]) ** 2).sum(axis=2).max(axis=1))
        level = np.frexp(reach)[1]
        groups = [np.flatnonzero(level == value) for value in np.unique(level)]
        classes = [SizeClass(cKDTree(centroids[g]), g, float(reach[g].max())) for g in groups]
        normals = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        length = np.linalg.norm(normals, axis=1, keepdims=True)
        normals *= np.where(length > THIN * reach[:, None] ** 2, 1.0, 0.0)
        normals /= np.where(length > 0, length, 1.0)
        return cls(corners, centroids, normals, reach, tuple(classes))

    def nearest(self, points: Floats) -> Nearest:
        """The nearest point on the triangles to each of the points (p, 3).

        >>> corner = Triangles.of(np.array([[[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]]))
        >>> corner.nearest(np.array([[0.25, 0.25, 2.0], [2.0, 0.0, 0.0], [0.5, -1.0, 0.0]]))
        Nearest(facet=array([0, 0, 0]),
                bary=array([[0.5 , 0.25, 0.25], [0.  , 1.  , 0.  ], [0.5 , 0.5 , 0.  ]]),
                distance=array([2., 1., 1.]))
        """
        best = Nearest(
            np.zeros(len(points), dtype=np.int64),
            np.zeros((len(points), 3)),
            np.full(len(points), np.inf),
        )
        for group in self.classes:
            self._improved(points, group, best)
        return best

    def _improved(self, points: Floats, group: SizeClass, best: Nearest) -> None:
        """Replace what this class of triangles knows better, in rounds of doubling length."""
        left, seen, total = np.arange(len(points)), 0, len(group.numbers)
        while len(left) and seen < total:
            upto = min(total, max(FIRST, 2 * seen))
            still = []
            ranks = list(range(seen + 1, upto + 1))
            for portion in np.array_split(left, -(-len(left) * upto // PAIRS)):
                found = group.tree.query(points[portion], k=ranks)
                away, ranked = np.asarray(found[0]), np.asarray(found[1])
                # a centroid is a point of the surface, so the nearest of them is a bound as well
                bound = np.minimum(best.distance[portion], away[:, 0])
                row, column = np.nonzero(away - group.reach <= bound[:, None])
                asked, triangles = portion[row], group.numbers[ranked[row, column]]
                near = self._least(points[asked], triangles) <= bound[row]
                _compare(points, asked[near], self.corners, triangles[near], best)
                still.append(portion[away[:, -1] - group.reach <= best.distance[portion]])
            left, seen = np.concatenate(still), upto

    def _least(self, points: Floats, triangles: Ints) -> Floats:
        """A lower bound of the distance (q,): to a disc around each triangle, in its plane."""
        offset = points - self.centroids[triangles]
        height = np.einsum("qd,qd->q", offset, self.normals[triangles])
        square = np.einsum("qd,qd->q", offset, offset)
        aside = np.sqrt(np.maximum(square - height**2, 0.0)) - self.reach[triangles]
        least: Floats = np.hypot(height, np.maximum(aside, 0.0))
        return least * (1 - ROUNDING) - NORMAL * self.reach[triangles]


def _compare(points: Floats, asked: Ints, corners: Floats, triangles: Ints, best: Nearest) -> None:
    """Let the points asked (q,), each as often as it has triangles (q,), keep the nearest."""
    bary, distance = nearest_on_triangles(points[asked], corners[triangles])
    order = np.lexsort((triangles, distance, asked))
    first = order[np.unique(asked[order], return_index=True)[1]]
    point, facet = asked[first], triangles[first]
    closer = distance[first] < best.distance[point]
    closer |= (distance[first] == best.distance[point]) & (facet < best.facet[point])
    first, point = first[closer], point[closer]
    best.facet[point] = triangles[first]
    best.distance[point] = distance[first]
    best.bary[point] = bary[first]


def nearest_on_triangles(points: Floats, corners: Floats) -> tuple[Floats, Floats]:
    """The point of each triangle (q, 3, 3) nearest to its point (q, 3): bary (q, 3), distance (q,).

    The foot of the perpendicular, where it falls inside, competes with the nearest points of the
    three sides.  Each candidate is a point of the triangle and its distance is measured, not
    derived, so a flat triangle, whose perpendicular is rounding, cannot lead astray.
    """
    candidates = [_foot(points, corners), *(_on_side(points, corners, side) for side in SIDES)]
    best, distance = candidates[0], _distance(points, corners, candidates[0])
    for bary in candidates[1:]:
        other = _distance(points, corners, bary)
        closer = other < distance
        best[closer], distance[closer] = bary[closer], other[closer]
    return best, distance


def _distance(points: Floats, corners: Floats, bary: Floats) -> Floats:
    offset = np.einsum("qi,qid->qd", bary, corners - points[:, None])
    distance: Floats = np.linalg.norm(offset, axis=1)
    return distance


def _foot(points: Floats, corners: Floats) -> Floats:
    """The foot of the perpendicular, pulled into the triangle where it lies outside."""
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    offset, normal = points - corners[:, 0], cross(a, b)
    square = np.einsum("qd,qd->q", normal, normal)
    bary = np.empty((len(points), 3))
    for i, area in ((1, cross(offset, b)), (2, cross(a, offset))):
        bary[:, i] = np.einsum("qd,qd->q", area, normal) / np.where(square > 0, square, 1.0)
    bary[:, 0] = 1.0 - bary[:, 1] - bary[:, 2]
    bary = np.maximum(bary, 0.0)
    bary /= bary.sum(axis=1, keepdims=True)
    return bary


def _on_side(points: Floats, corners: Floats, side: tuple[int, int]) -> Floats:
    """The nearest point on one side."""
    start, end = corners[:, side[0]], corners[:, side[1]]
    along = end - start
    length = np.einsum("qd,qd->q", along, along)
    share = np.einsum("qd,qd->q", points - start, along) / np.where(length > 0, length, 1.0)
    bary = np.zeros((len(points), 3))
    bary[:, side[1]] = np.clip(share, 0.0, 1.0)
    bary[:, side[0]] = 1.0 - bary[:, side[1]]
    return bary
