# SPDX-License-Identifier: BSD-3-Clause
"""A mesh cut open between its regions: what a field lives on that may jump there."""

from __future__ import annotations

import numpy as np

from bezsoma.mesh.control_net import ControlNet
from bezsoma.mesh.tets import TetMesh


def torn(mesh: TetMesh) -> TetMesh:
    """The same tets in the same order, with vertices of their own in every region.

    The copies of a vertex are numbered one after the other, so that the rows of the tets stay
    ascending. Places are left out: it carries fields, not supports. Two regions that share a face
    then share none:

    >>> from bezsoma.mesh.solids import block
    >>> mesh = block(cells=(2, 1, 1))
    >>> middle = mesh.points[mesh.tets].mean(axis=1)[:, 0]
    >>> two = TetMesh(mesh.points, mesh.tets, np.where(middle < 0.5, 0, 1), ("a", "b"))
    >>> len(torn(two).points) - len(two.points), len(torn(two).boundary) - len(two.boundary)
    (4, 4)
    """
    if len(mesh.regions) == 1:
        return mesh
    keys = mesh.tets * len(mesh.regions) + mesh.region[:, None]
    own, tets = np.unique(keys, return_inverse=True)
    points = mesh.points[own // len(mesh.regions)]
    return TetMesh(points, tets.reshape(-1, 4), mesh.region, mesh.regions)


def pressure_net(mesh: TetMesh, degree: int, breaks: bool) -> ControlNet:
    """The control net of a pressure: continuous on the mesh, or within each region only."""
    return ControlNet(torn(mesh) if breaks else mesh, degree)
