# SPDX-License-Identifier: BSD-3-Clause
"""What `bezsoma mesh info` says of a mesh: sizes, places, and how good its tets are."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

import numpy as np

from bezsoma.arrays import Floats
from bezsoma.mesh.tets import TetMesh

PERCENTILES = (0, 1, 50, 100)


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


def mesh_report(mesh: TetMesh) -> Iterator[str]:
    """The lines of the report; lengths mm."""
    low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
    pieces = len(np.unique(mesh.components()))
    yield f"{len(mesh.points)} vertices, {len(mesh.tets)} tets, {len(mesh.boundary)} outer facets"
    yield f"{pieces} piece{'s' if pieces != 1 else ''}, volume {mesh.volumes.sum():.6g} mm3"
    if mesh.dropped:
        yield f"{mesh.dropped} unused points were dropped"
    yield f"from {_point(low)} to {_point(high)} mm"
    yield from _places(mesh)
    angles, ratios = dihedral_angles(mesh), mean_ratios(mesh)
    yield f"quality:            {'least':>8} {'1 %':>8} {'median':>8} {'largest':>8}"
    yield f"  dihedral, degrees {_spread(angles)}"
    yield f"  mean ratio (best 1) {_spread(ratios)[2:]}   mean {ratios.mean():.2f}"
    count = np.bincount(np.minimum((ratios * 10).astype(int), 9), minlength=10)
    for decile in np.flatnonzero(count):
        share = count[decile] / len(ratios)
        yield f"    {decile / 10:.1f} to {(decile + 1) / 10:.1f} {100 * share:6.1f} % {_bar(share)}"


def _places(mesh: TetMesh) -> Iterator[str]:
    """Regions with volumes, surfaces with areas, edges and vertices with their number."""
    for number, name in enumerate(mesh.regions):
        inside = mesh.region == number
        volume = mesh.volumes[inside].sum()
        yield f"region  {name:<12} {int(inside.sum()):>8} tets     {volume:12.6g} mm3"
    for name, facets in mesh.surfaces.items():
        area = mesh.areas(facets).sum()
        yield f"surface {name:<12} {len(facets):>8} facets   {area:12.6g} mm2"
    for name, edges in mesh.edges.items():
        yield f"edges   {name:<12} {len(edges):>8}"
    for name, vertices in mesh.vertices.items():
        yield f"vertex  {name:<12} {len(vertices):>8}"


def _spread(numbers: Floats) -> str:
    return " ".join(f"{value:8.2f}" for value in np.percentile(numbers, PERCENTILES))


def _point(point: Floats) -> str:
    return "(" + ", ".join(f"{value:.6g}" for value in point) + ")"


def _bar(share: float) -> str:
    return "#" * round(40 * share)
