# SPDX-License-Identifier: BSD-3-Clause
"""Some tets of a mesh cut in four, the others left as they are."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from bezsoma.arrays import Ints
from bezsoma.mesh import checks
from bezsoma.mesh.tets import TetMesh
from bezsoma.mesh.topology import FACES


def split(mesh: TetMesh, tets: npt.ArrayLike) -> TetMesh:
    """The mesh with these tets (q,) each cut in four at its barycentre.

    Faces stay whole, so no neighbour has to follow, and every place keeps its facets, edges and
    vertices. New vertices come last, new tets after the old ones. Beware: the four are flatter
    than the one was (a quarter of its height), so cut only where a vertex inside is what is
    missing.

    >>> from bezsoma.mesh.solids import block
    >>> fine = split(block(), [0, 2])
    >>> len(fine.points), len(fine.tets), bool(abs(fine.volumes.sum() - 1) < 1e-15)
    (10, 12, True)
    """
    chosen = np.unique(checks.index_array(tets, len(mesh.tets), "tets to split", "tet"))
    corners = mesh.tets[chosen]
    points = np.concatenate([mesh.points, mesh.points[corners].mean(axis=1)])
    centre = len(mesh.points) + np.arange(len(chosen))
    children = np.concatenate([_with(corners[:, list(face)], centre) for face in FACES])
    rest = np.setdiff1d(np.arange(len(mesh.tets)), chosen)
    return TetMesh(
        points,
        np.concatenate([mesh.tets[rest], children]),
        np.concatenate([mesh.region[rest], np.tile(mesh.region[chosen], 4)]),
        mesh.regions,
        dict(mesh.surfaces),
        dict(mesh.edges),
        dict(mesh.vertices),
    )


def _with(faces: Ints, centre: Ints) -> Ints:
    return np.concatenate([faces, centre[:, None]], axis=1)
