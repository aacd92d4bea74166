# SPDX-License-Identifier: BSD-3-Clause
"""The parts of a mesh that move as one: tets joined face to face."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from bezsoma.arrays import Floats, Ints
from bezsoma.mesh.tets import TetMesh

FREE = 1e-8
"""A motion is free when it is resisted less than this part of what is resisted most."""


@dataclass(frozen=True, eq=False)
class Parts:
    """The face-connected parts of a mesh, p of them: centre (p, 3) and radius (p,) mm, tets (p,).

    label (t,) is the part of each tet; vertex (k,) and part (k,) are all pairs of a vertex and a
    part that has it, ordered by part.
    """

    mesh: TetMesh
    label: Ints
    tets: Ints
    centre: Floats
    radius: Floats
    vertex: Ints
    part: Ints

    @property
    def count(self) -> int:
        """The number p of parts."""
        return len(self.radius)

    def hinged(self, some: Iterable[int]) -> bool:
        """Whether any of some parts shares a vertex with another."""
        shared = np.bincount(self.vertex)[self.vertex] > 1
        return bool(np.isin(self.part[shared], list(some)).any())

    def tolerance(self, parts: Ints) -> float:
        """`FREE`, or more where rounding of coordinates far from the origin asks for it."""
        away = np.abs(self.centre[parts]).max() + self.radius[parts].max()
        rounding = float(np.finfo(float).eps * away / self.radius[parts].min())
        return max(FREE, 100 * rounding)


def parts_of(mesh: TetMesh) -> Parts:
    """The face-connected parts of a mesh."""
    label = mesh.components()
    count = int(label.max()) + 1
    keys = np.arange(len(mesh.points))  # every vertex has a tet: what one part has
    if count > 1:
        keys = np.unique(np.repeat(label, 4) * len(mesh.points) + mesh.tets.ravel())
    part, vertex = np.divmod(keys, len(mesh.points))
    number = np.bincount(part, minlength=count)
    points = mesh.points[vertex]
    centre = np.stack([np.bincount(part, x, count) for x in points.T], axis=1) / number[:, None]
    radius = np.zeros(count)
    np.maximum.at(radius, part, np.linalg.norm(points - centre[part], axis=1))
    return Parts(mesh, label, np.bincount(label), centre, radius, vertex, part)
