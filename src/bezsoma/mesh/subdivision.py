# SPDX-License-Identifier: BSD-3-Clause
"""A finer mesh whose every tet lies in one of a coarser mesh, and polynomials carried over."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bezsoma.arrays import Bools, Floats, Ints, frozen
from bezsoma.bernstein.subdivision import (
    DIAGONALS,
    refinement_points,
    restricted,
    uniform_corners,
)
from bezsoma.errors import InputError
from bezsoma.mesh.evaluation import TetPolynomials, portions, size
from bezsoma.mesh.tets import TetMesh
from bezsoma.mesh.topology import numbers, slices

_SIDES = ((0, 1), (0, 2), (1, 2))
_ROUNDING = 1e-9
"""How far the stated corners of a tet may be from its vertices, relative to the mesh."""


@dataclass(frozen=True, eq=False)
class Subdivision:
    """A mesh and a finer one in it, however it was made: uniformly, by bisection, by splitting.

    `field.subdivided(subdivision)` is the same polynomial on the finer mesh.
    """

    coarse: TetMesh
    fine: TetMesh
    parent: Ints
    """(t',) the tet of `coarse` that each tet of `fine` lies in."""
    corners: Floats
    """(t', 4, 4) barycentric coordinates there of the fine tet's vertices, in ascending order."""

    def __post_init__(self) -> None:
        """Refuses corners that are not where the finer mesh has its vertices."""
        scale = float(np.abs(self.coarse.points).max())
        for part in slices(len(self.parent)):
            stated = np.matmul(
                self.corners[part], self.coarse.points[self.coarse.tets[self.parent[part]]]
            )
            off = np.abs(stated - self.fine.points[self.fine.tets[part]]).max(axis=(1, 2))
            if (off > _ROUNDING * scale).any():
                tet = int(off.argmax()) + part.start
                raise InputError(
                    f"tet {tet} of the finer mesh is not where its corners in tet "
                    f"{self.parent[tet]} of the coarser one say: {off.max():.3g} mm off; corners "
                    "are listed in the order of the finer tet's vertices"
                )

    def nets(self, field: TetPolynomials) -> Floats:
        """The controls (t', m, ...) on every fine tet of a field on the coarse mesh."""
        if not (
            np.array_equal(field.mesh.tets, self.coarse.tets)
            and np.array_equal(field.mesh.points, self.coarse.points)
        ):
            raise InputError(
                "the field lives on another mesh than the one that is subdivided; "
                "subdivide field.mesh"
            )
        one = field.on_tets(slice(0, 1))
        found = np.empty((len(self.parent), *one.shape[1:]))
        for part in portions(len(found), one.shape[1] * size(field)):
            local = field.on_tets(self.parent[part])
            found[part] = restricted(local, field.degree, self.corners[part])
        return found


def subdivision(mesh: TetMesh) -> Subdivision:
    """Every tet cut in eight at the middles of its edges, around its shortest inner diagonal.

    Neighbours cut a common face alike, in four, whatever their diagonals are.  Regions and places
    are kept: a facet becomes four, a mesh edge two.  Vertices keep their numbers; the middle of
    edge e becomes vertex v + e.  The children of tet t are 8 t to 8 t + 7.  Of the three diagonals
    of the octahedron left in the middle the shortest gives the roundest children (Bey 1995,
    doi:10.1007/BF02238487, bounds their shapes over all generations).

    >>> from bezsoma.mesh.solids import block
    >>> finer = subdivision(block(cells=(2, 1, 1)))
    >>> len(finer.fine.tets), bool(np.ptp(finer.fine.volumes) < 1e-16)
    (96, True)
    >>> len(finer.fine.surfaces["top"]), finer.parent[:9].tolist()
    (16, [0, 0, 0, 0, 0, 0, 0, 0, 1])
    """
    diagonal = shortest_diagonals(mesh)
    patterns = np.stack([uniform_corners(3, k) for k in range(3)])
    points, tets = _middles(mesh), np.empty((len(mesh.tets), 8, 4), np.int64)
    for part in slices(len(tets)):
        rows = [mesh.tets[part], len(mesh.points) + mesh.edges_of_tet[part].astype(np.int64)]
        local = patterns[diagonal[part]].reshape(-1, 32)
        tets[part] = np.take_along_axis(np.concatenate(rows, axis=1), local, 1).reshape(-1, 8, 4)
    fine = TetMesh(
        np.concatenate([mesh.points, points]),
        tets.reshape(-1, 4),
        np.repeat(mesh.region, 8),
        mesh.regions,
        {name: _quartered(mesh, facets) for name, facets in mesh.surfaces.items()},
        {name: _halved(mesh, edges) for name, edges in mesh.edges.items()},
        dict(mesh.vertices),
    )
    corners = refinement_points(3)[patterns][diagonal].reshape(-1, 4, 4)
    parent = np.repeat(np.arange(len(mesh.tets)), 8)
    return Subdivision(mesh, fine, frozen(parent), frozen(corners))


def shortest_diagonals(mesh: TetMesh) -> Ints:
    """Which inner diagonal is the shortest (t,): 01-23, 02-13 or 03-12; of equals the first."""
    lengths = np.empty((len(mesh.tets), 3))
    for part in slices(len(lengths)):
        middle = refinement_points(3) @ mesh.points[mesh.tets[part]]
        for k, (one, other) in enumerate(DIAGONALS):
            lengths[part, k] = ((middle[:, one] - middle[:, other]) ** 2).sum(axis=1)
    return np.asarray(_nearly_least(lengths).argmax(axis=1))


def _nearly_least(lengths: Floats) -> Bools:
    """Those equal to the least up to rounding, so that a shift of the mesh decides nothing."""
    return np.asarray(lengths <= lengths.min(axis=1, keepdims=True) * (1 + 1e-9))


def _middles(mesh: TetMesh) -> Floats:
    edges = mesh.all_edges
    return (mesh.points[edges[:, 0]] + mesh.points[edges[:, 1]]) / 2


def _middle_of(mesh: TetMesh, edges: Ints) -> Ints:
    """The new vertex (e,) in the middle of each edge (e, 2)."""
    return len(mesh.points) + numbers(edges, mesh.all_edges)


def _quartered(mesh: TetMesh, facets: Ints) -> Ints:
    middles = [_middle_of(mesh, facets[:, list(side)]) for side in _SIDES]
    rows = np.concatenate([facets, np.stack(middles, axis=1)], axis=1)
    return rows[:, uniform_corners(2)].reshape(-1, 3)


def _halved(mesh: TetMesh, edges: Ints) -> Ints:
    rows = np.concatenate([edges, _middle_of(mesh, edges)[:, None]], axis=1)
    return rows[:, uniform_corners(1)].reshape(-1, 2)
