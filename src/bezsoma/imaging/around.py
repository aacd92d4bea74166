# SPDX-License-Identifier: BSD-3-Clause
"""The skin of the head around a domain, coarse, to show a predicted part in its place."""

from __future__ import annotations

import numpy as np
from scipy import ndimage

from bezsoma.arrays import Floats
from bezsoma.imaging.domain import Domain
from bezsoma.imaging.labelling import Labels
from bezsoma.imaging.meaning import AIR
from bezsoma.imaging.volume import Frame
from bezsoma.mesh import TetMesh
from bezsoma.mesh.graded import Octree, lattice
from bezsoma.mesh.stuffing import stuffed

CELL = 5.0
"""mm: the cells at the skin of the head around; those inside are larger, up to four times."""
OVERLAP = 2.0
"""mm of skin kept inside the domain, so that no line is open where the two parts meet."""
VOXEL = 2.0
"""mm: about how finely its labels are looked at."""


def head_around(labels: Labels, domain: Domain) -> TetMesh:
    """The whole head as tets with a surface `head`: its skin outside the domain, to look at."""
    step = np.maximum(1, np.rint(VOXEL / labels.frame.spacing)).astype(int)
    x, y, z = step
    frame = Frame(labels.frame.spacing * step, labels.frame.origin, labels.frame.axes)
    head = np.pad(labels.values[::z, ::y, ::x] != AIR, 2)
    head = ndimage.binary_fill_holes(head)
    frame = Frame(frame.spacing, frame.points(np.array([-2, -2, -2])), frame.axes)
    spacing = frame.spacing[::-1]
    inner, outer = (ndimage.distance_transform_edt(m, sampling=spacing) for m in (head, ~head))
    level = ndimage.gaussian_filter((outer - inner).astype(np.float32), 0.7)
    local = Frame(frame.spacing, np.zeros(3), np.eye(3))  # along the axes of the picture

    def at(points: Floats) -> Floats:
        where = local.indices(points).T[::-1]
        found = ndimage.map_coordinates(level, where, order=1, mode="nearest", output=np.float64)
        return np.asarray(found)

    extent = (np.array(level.shape[::-1]) - 1) * frame.spacing
    counts = tuple((4 * np.ceil(extent / (4 * CELL)).astype(int)).tolist())
    centres = CELL * (np.moveaxis(np.indices(counts), 0, -1).reshape(-1, 3) + 0.5)
    sizes = (CELL + 0.5 * np.abs(at(centres))).reshape(counts)
    vertices, tets = lattice(Octree.of(sizes, CELL, 2))
    points: Floats = np.asarray(vertices * (CELL / 2), np.float64)
    body = stuffed(points, tets, np.zeros(points.shape, np.bool_), at)
    mesh = TetMesh(body.points @ frame.axes.T + frame.origin, body.tets)
    centres = mesh.points[mesh.boundary].mean(axis=1)
    within = ((centres > domain.low + OVERLAP) & (centres < domain.high - OVERLAP)).all(axis=1)
    return mesh.with_surface("head", mesh.boundary[~within])
