# SPDX-License-Identifier: BSD-3-Clause
"""What can be drawn: surfaces cut into triangles, whole or clipped by a plane."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt

from bezsoma.arrays import Bools, Floats, Ints, T
from bezsoma.view.lattice import corners_of, lattice_points, small_triangles
from bezsoma.view.surfaces import on_edges


class Drawn(Protocol):
    """Samples, in rows of any kind (..), and how small triangles stand between them."""

    @property
    def points(self) -> Floats:
        """(.., 3) mm."""

    @property
    def normals(self) -> Floats:
        """(.., 3) outward, length 1."""

    @property
    def vertex(self) -> Ints:
        """(..) one number for samples that share point and normal."""

    @property
    def rims(self) -> Bools:
        """(r, 3) whether the edge opposite each triangle's corner is one of the mesh."""

    def corners(self, samples: npt.NDArray[T]) -> npt.NDArray[T]:
        """Values (r, 3, ...) at the corners of the small triangles, from those at samples."""


@dataclass(frozen=True, eq=False)
class Pieces:
    """Triangles on their own, (r, 3, ...) at their corners."""

    points: Floats
    normals: Floats
    vertex: Ints
    rims: Bools

    def corners(self, samples: npt.NDArray[T]) -> npt.NDArray[T]:
        """The same values: a sample is a corner."""
        return samples


def apart(surface: Drawn) -> Pieces:
    """The triangles of a surface, each on its own."""
    at = surface.corners
    return Pieces(at(surface.points), at(surface.normals), at(surface.vertex), surface.rims)


def clipped(surface: Drawn, heights: Floats) -> Pieces:
    """The part of a surface whose samples have heights (..) below zero.

    The triangles that a picture shows are cut, with straight cuts; where they were fine enough
    for the picture, so are these.

    >>> flat = Pieces(
    ...     np.array([[[0, 0, 0], [2, 0, 0], [0, 2, 0.0]]]),
    ...     np.broadcast_to([0, 0, 1.0], (1, 3, 3)), np.arange(3)[None], np.ones((1, 3), bool))
    >>> part = clipped(flat, flat.points[..., 0] - 1)
    >>> a, b, c = np.moveaxis(part.points, 1, 0)
    >>> float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)
    1.5
    """
    whole, above = apart(surface), surface.corners(heights)
    below = above < 0
    number = below.sum(axis=1)
    parts = [(np.flatnonzero(number == 3), np.eye(3)[None], whole.rims[number == 3])]
    for count in (1, 2):
        parts += _cut(np.flatnonzero(number == count), above, below, whole.rims, count)
    rows = np.concatenate([row for row, *_ in parts])
    bary = np.concatenate([np.broadcast_to(b, (len(row), 3, 3)) for row, b, _ in parts])
    mixed = [
        np.einsum("rij,rj...->ri...", bary, each[rows]) for each in (whole.points, whole.normals)
    ]
    length = np.linalg.norm(mixed[1], axis=2, keepdims=True)
    return Pieces(
        mixed[0],
        mixed[1] / np.where(length > 0, length, 1.0),
        _vertices(whole.vertex[rows], bary),
        np.concatenate([rim for *_, rim in parts]),
    )


def _cut(
    rows: Ints, above: Floats, below: Bools, rims: Bools, count: int
) -> list[tuple[Ints, Floats, Bools]]:
    """What is left of triangles with so many corners below: their rows, corners and rims."""
    order = np.argsort(~below[rows], axis=1, kind="stable")
    height = np.take_along_axis(above[rows], order, axis=1)
    rim = np.take_along_axis(rims[rows], order, axis=1)
    unit = np.eye(3)[order]  # (r, 3, 3): those below come first

    def between(i: int, j: int) -> Floats:
        share = (height[:, i] / (height[:, i] - height[:, j]))[:, None]
        return np.asarray((1 - share) * unit[:, i] + share * unit[:, j])

    never = np.zeros(len(rows), bool)
    if count == 1:
        corners = np.stack([unit[:, 0], between(0, 1), between(0, 2)], axis=1)
        return [(rows, corners, np.stack([never, rim[:, 1], rim[:, 2]], axis=1))]
    first = np.stack([unit[:, 0], unit[:, 1], between(1, 2)], axis=1)
    second = np.stack([unit[:, 0], between(1, 2), between(0, 2)], axis=1)
    return [
        (rows, first, np.stack([rim[:, 0], never, rim[:, 2]], axis=1)),
        (rows, second, np.stack([never, rim[:, 1], never], axis=1)),
    ]


def _vertices(vertex: Ints, bary: Floats) -> Ints:
    """One number (r, 3) for corners that lie on the same edge or vertex of the triangles."""
    most = int(vertex.max(initial=0)) + 1
    on = bary > 0
    low = np.where(on, vertex[:, None], most).min(axis=2)
    high = np.where(on, vertex[:, None], -1).max(axis=2)
    return np.unique(low * most + high, return_inverse=True)[1].reshape(low.shape)


def refined(points: Floats, normals: Floats, rims: Bools, parts: int) -> Pieces:
    """Triangles from patches of samples (f, m, 3); edge j of a patch is drawn where rims (f, 3)."""
    vertex = np.arange(points.shape[0] * points.shape[1]).reshape(points.shape[:2])
    points, normals, vertex = (corners_of(each, parts) for each in (points, normals, vertex))
    on = on_edges(lattice_points(parts) / parts, small_triangles(parts))
    mine = np.einsum("tkj,fj->ftk", on, rims).reshape(-1, 3)
    return Pieces(points, normals, vertex, mine)
