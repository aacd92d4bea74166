# SPDX-License-Identifier: BSD-3-Clause
"""What `bezsoma mesh info` says of a mesh: sizes, places, and how good its tets are."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from bezsoma.arrays import Floats
from bezsoma.mesh.quality import dihedral_angles, mean_ratios
from bezsoma.mesh.tets import TetMesh

PERCENTILES = (0, 1, 50, 100)


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
