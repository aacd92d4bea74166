# SPDX-License-Identifier: BSD-3-Clause
"""Finding the facets, edges and vertices of a mesh that a place is made of."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from bezsoma.arrays import Bools, Floats, Int32s, Ints, frozen
from bezsoma.errors import MeshError
from bezsoma.mesh.checks import index_array, index_rows, listed, members
from bezsoma.mesh.topology import numbers

NEAR = 1e-6
"""How near a vertex must lie to a stated point or line, as a part of the mesh's extent."""


def facets_given(name: str, given: npt.ArrayLike, renumbered: Ints, faces: Int32s) -> Ints:
    """The facets (f, 3) of a surface, ascending; each must be a face of a tet.

    What is given counts the user's points, and so do messages; `renumbered` (points,) turns them
    into vertices of the mesh, in the same order, -1 where no tet has one.
    """
    rows = index_rows(given, 3, len(renumbered), f"facet of surface {name!r}", "point")
    why = "is no face of a tet; a surface is made of tets' faces"
    members(numbers(renumbered[rows], faces), rows, name, "surface", why)
    return frozen(renumbered[rows])


def edges_given(name: str, given: npt.ArrayLike, renumbered: Ints, edges: Int32s) -> Ints:
    """The mesh edges (e, 2) of an edge place, ascending; each must be an edge of a tet."""
    rows = index_rows(given, 2, len(renumbered), f"edge of {name!r}", "point")
    found = numbers(renumbered[rows], edges)
    members(found, rows, name, "edge place", "is no edge of a tet")
    return frozen(renumbered[rows])


def vertices_given(name: str, given: npt.ArrayLike, renumbered: Ints) -> Ints:
    """The vertices (k,) of a vertex place, ascending; each must belong to a tet."""
    array = np.asarray(given)
    if array.ndim != 1:
        raise MeshError(f"vertices of {name!r} have the shape {array.shape}; (k,) is needed")
    rows = np.sort(index_array(array, len(renumbered), f"vertices of {name!r}", "point"))
    members(renumbered[rows], rows[:, None], name, "vertex place", "is a point that no tet uses")
    return frozen(renumbered[rows])


def facets_where(
    inside: Callable[[Floats], Bools], points: Floats, boundary: Ints, name: str
) -> Ints:
    """The boundary facets (f, 3) whose three corners all satisfy `inside(points (p, 3))`."""
    found = np.asarray(inside(points[boundary].reshape(-1, 3)))
    if found.shape != (3 * len(boundary),) or found.dtype != np.bool_:
        raise MeshError(
            f"the rule for surface {name!r} gave the shape {found.shape} and type {found.dtype}; "
            f"for points of the shape ({3 * len(boundary)}, 3) it must give that many True or "
            "False, such as lambda x: x[:, 2] > 0"
        )
    rows = boundary[found.reshape(-1, 3).all(axis=1)]
    if not len(rows):
        raise MeshError(
            f"no boundary facet satisfies the rule for surface {name!r}: of {len(points)} "
            f"vertices between {points.min(axis=0).tolist()} and {points.max(axis=0).tolist()} mm "
            "it needs all three corners of a facet; widen the rule"
        )
    return rows


def edges_along(line: Floats, points: Floats, edges: Int32s, name: str) -> Ints:
    """The mesh edges (e, 2) that make up a polyline through points (k, 3) in mm."""
    if line.ndim != 2 or line.shape[1] != 3 or len(line) < 2 or not np.isfinite(line).all():
        raise MeshError(
            f"the line of {name!r} has the shape {line.shape}; two or more points (k, 3) in mm "
            "are needed, or mesh edges as integer vertex numbers (e, 2)"
        )
    parts = [_edges_between(a, b, points, edges, name) for a, b in pairwise(line)]
    return np.asarray(np.unique(np.concatenate(parts), axis=0))


def _edges_between(a: Floats, b: Floats, points: Floats, edges: Int32s, name: str) -> Ints:
    near, length = NEAR * _extent(points), float(np.linalg.norm(b - a))
    if length <= near:
        raise MeshError(f"the line of {name!r} stands still at {a.tolist()}; remove the repetition")
    along = (points - a) @ (b - a) / length
    off = np.linalg.norm(points - a - np.outer(along / length, b - a), axis=1)
    on = (off <= near) & (along >= -near) & (along <= length + near)
    rows: Ints = edges[on[edges].all(axis=1)].astype(np.int64)
    covered = float(np.abs(np.diff(along[rows], axis=1)).sum())
    if covered < length - 2 * near:
        raise MeshError(
            f"the mesh has no edges along the whole line of {name!r} from {a.tolist()} to "
            f"{b.tolist()} mm: {covered:.4g} of {length:.4g} mm are covered; a line must follow "
            "edges of the mesh from vertex to vertex"
        )
    return rows


def vertices_at(places: Floats, points: Floats, name: str) -> Ints:
    """The vertices (k,) that lie at the given points (k, 3) in mm."""
    if places.ndim != 2 or places.shape[1] != 3 or not np.isfinite(places).all():
        raise MeshError(
            f"the points of {name!r} have the shape {places.shape}; (k, 3) finite numbers in mm "
            "are needed, or integer vertex numbers (k,)"
        )
    near, found = NEAR * _extent(points), []
    for place in places:
        distance = np.linalg.norm(points - place, axis=1)
        vertex = int(distance.argmin())
        if distance[vertex] > near:
            raise MeshError(
                f"no vertex lies at {place.tolist()} mm for {name!r}; the nearest is vertex "
                f"{vertex} at {points[vertex].tolist()}, {distance[vertex]:.3g} mm away"
            )
        found.append(vertex)
    return np.array(found, np.int64)


def face_numbers(facets: npt.ArrayLike, faces: Int32s, count: int) -> Ints:
    """The number (f,) of each facet among the faces of the mesh."""
    rows = index_rows(facets, 3, count, "facet", "vertex")
    found = numbers(rows, faces)
    wrong = np.flatnonzero(found < 0)
    if len(wrong):
        raise MeshError(
            f"facet {listed(wrong)} (first: {rows[wrong[0]].tolist()}) is no face of a tet of "
            "this mesh; take facets from `surfaces`, `boundary` or `all_faces`"
        )
    return found


def _extent(points: Floats) -> float:
    return float(np.ptp(points, axis=0).max())
