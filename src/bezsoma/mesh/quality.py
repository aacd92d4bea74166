# SPDX-License-Identifier: BSD-3-Clause
"""How good the tets of a mesh are: angles and ratios."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from bezsoma.arrays import Floats
from bezsoma.mesh.tets import TetMesh
from bezsoma.mesh.topology import cross


def dihedral_angles(mesh: TetMesh) -> Floats:
    """The six angles between the faces of each tet (t, 6), degrees.

    The gradients of the barycentric coordinates point inward, normal to the faces, so the angle
    between the faces i and j has cos = -g_i . g_j / (|g_i| |g_j|). Small or near 180 is bad: both
    the conditioning of the matrices and the error grow. A regular tet has arccos(1/3) six times:

    >>> p = [[0, 0, 0], [1, 1, 0], [1, 0, 1], [0, 1, 1]]
    >>> bool(np.allclose(np.cos(np.radians(dihedral_angles(TetMesh(p, [[0, 1, 2, 3]])))), 1 / 3))
    True
    """
    unit = mesh.gradients / np.linalg.norm(mesh.gradients, axis=2, keepdims=True)
    pairs = [-np.einsum("td,td->t", unit[:, i], unit[:, j]) for i, j in combinations(range(4), 2)]
    angles: Floats = np.degrees(np.arccos(np.clip(np.stack(pairs, axis=1), -1, 1)))
    return angles


def mean_ratios(mesh: TetMesh) -> Floats:
    """The mean ratio of each tet (t,): 12 (3 V)^(2/3) / (sum of the squared edges); best is 1.

    Liu and Joe, Relationship between tetrahedron shape measures, BIT 34 (1994), eq. 4
    (doi:10.1007/BF01955874). It falls with every way of becoming flat, and is 1 for a regular tet:

    >>> p = [[0, 0, 0], [1, 1, 0], [1, 0, 1], [0, 1, 1]]
    >>> bool(np.isclose(mean_ratios(TetMesh(p, [[0, 1, 2, 3]]))[0], 1))
    True
    """
    corners = mesh.points[mesh.tets]
    squares = sum(
        ((corners[:, i] - corners[:, j]) ** 2).sum(axis=1) for i, j in combinations(range(4), 2)
    )
    ratios: Floats = 12 * (3 * mesh.volumes) ** (2 / 3) / squares
    return ratios


def least_sines(corners: Floats) -> Floats:
    """The least sine of the six dihedral angles (t,) of tets with corners (t, 4, 3), signed.

    With the sign of the determinant: one that has turned over is negative. For the angle at the
    edge e between faces with the normals n and m (as long as twice their areas), sin = 6 V |e| /
    (|n| |m|), V the volume. A regular tet has sin(arccos(1/3)) = sqrt(8)/3:

    >>> p = np.array([[[0.0, 0, 0], [1, 1, 0], [1, 0, 1], [0, 1, 1]]])
    >>> bool(np.isclose(abs(least_sines(p)[0]), 8**0.5 / 3)), bool(least_sines(p)[0] < 0)
    (True, True)
    """
    a, b, c, d = (corners[:, i] for i in range(4))
    normals = [cross(c - b, d - b), cross(c - a, d - a), cross(b - a, d - a), cross(b - a, c - a)]
    areas = [np.sqrt(np.einsum("td,td->t", n, n)) for n in normals]
    six = np.einsum("td,td->t", b - a, normals[1])
    least = np.full(len(corners), np.inf)
    for i, j in combinations(range(4), 2):
        k, l = (n for n in range(4) if n not in (i, j))
        edge = corners[:, l] - corners[:, k]
        length = np.sqrt(np.einsum("td,td->t", edge, edge))
        size = np.maximum(areas[i] * areas[j], 1e-300)
        np.minimum(least, np.abs(six) * length / size, out=least)
    return np.asarray(np.sign(six) * np.minimum(least, 1.0))
