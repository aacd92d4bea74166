# SPDX-License-Identifier: BSD-3-Clause
"""Where two places meet, the mesh edges and vertices that both hold, and checks of the joins."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.spatial import KDTree

from bezsoma.arrays import Ints
from bezsoma.errors import InputError, unknown
from bezsoma.mechanics.joins import Join, Precedence
from bezsoma.mechanics.supports import Support
from bezsoma.mesh.tets import TetMesh


def meeting(mesh: TetMesh, first: str, second: str) -> Ints:
    """The line on which two places meet, vertex numbers (s, 2) of its segments.

    Shared mesh edges, and as (v, v) shared vertices that are on none of them. Places that do not
    meet are refused, and so are such that share facets: they overlap and meet on no line.

    >>> from bezsoma.mesh.solids import block
    >>> meeting(block(cells=(1, 1, 2)), "left", "bottom").shape
    (1, 2)
    """
    if len(_shared(simplices_of(mesh, first, 2), simplices_of(mesh, second, 2))):
        raise InputError(
            f"{first!r} and {second!r} share facets, so they overlap and meet on no line; only "
            "Precedence can say what holds there"
        )
    edges = _shared(simplices_of(mesh, first, 1), simplices_of(mesh, second, 1))
    vertices = _shared(simplices_of(mesh, first, 0), simplices_of(mesh, second, 0))
    alone = np.setdiff1d(vertices, edges)
    line = np.concatenate([edges.reshape(-1, 2), np.stack([alone, alone], axis=1)])
    if not len(line):
        raise InputError(_apart(mesh, first, second))
    return line


def touch(mesh: TetMesh, first: str, second: str) -> None:
    """Check that two places share a vertex at least."""
    vertices = _shared(simplices_of(mesh, first, 0), simplices_of(mesh, second, 0))
    if not len(vertices):
        raise InputError(_apart(mesh, first, second))


def simplices_of(mesh: TetMesh, name: str, dim: int) -> Ints:
    """The vertices, edges or facets (k, dim + 1) in the closure of a place, rows ascending."""
    rows = own_simplices(mesh, name)
    if rows.shape[1] <= dim:
        return np.empty((0, dim + 1), dtype=np.int64)
    if rows.shape[1] == dim + 1:
        return rows
    pairs = np.array([(i,) for i in range(rows.shape[1])])
    if dim == 1:
        pairs = np.array([(0, 1), (0, 2), (1, 2)])
    return np.unique(rows[:, pairs].reshape(-1, dim + 1), axis=0)


def own_simplices(mesh: TetMesh, name: str) -> Ints:
    """What a place is made of: facets (f, 3), mesh edges (e, 2) or vertices (k, 1)."""
    if name in mesh.surfaces:
        return mesh.surfaces[name]
    return mesh.edges[name] if name in mesh.edges else mesh.vertices[name].reshape(-1, 1)


def _shared(a: Ints, b: Ints) -> Ints:
    """The rows that both have (each has a row once)."""
    rows, counts = np.unique(np.concatenate([a, b]), axis=0, return_counts=True)
    return rows[counts > 1]


def _apart(mesh: TetMesh, first: str, second: str) -> str:
    a, b = (mesh.points[np.unique(own_simplices(mesh, name))] for name in (first, second))
    gap = float(np.min(KDTree(a).query(b)[0]))
    return (
        f"{first!r} and {second!r} do not meet: they share no vertex, the nearest two are "
        f"{gap:.3g} mm apart; a join belongs to two places that touch, leave it out"
    )


def joins_checked(joins: Sequence[Join], supports: Sequence[Support], mesh: TetMesh) -> None:
    """Check that joins name supported places that meet, no pair twice, and run in no circle."""
    seen: dict[frozenset[str], Join] = {}
    for join in joins:
        _supported(join, supports, mesh)
        (touch if isinstance(join, Precedence) else meeting)(mesh, *join.places)
        other = seen.get(frozenset(join.places))
        if other is not None:
            raise InputError(
                f"{join} and {other} both say what holds where the same places meet; keep one"
            )
        seen[frozenset(join.places)] = join
    circle = _circle([join.places for join in joins])
    if circle:
        raise InputError(
            f"joins: precedence runs in a circle, {' over '.join(map(repr, circle))}; where these "
            "meet none could hold: leave one of the joins out or turn it round"
        )


def _supported(join: Join, supports: Sequence[Support], mesh: TetMesh) -> None:
    places = {place for support in supports for place in support.places}
    for place in join.places:
        if place not in mesh.places:
            raise InputError(f"{join}: {unknown('place', place, mesh.places, 'this mesh')}")
        if place not in places:
            raise InputError(f"{join}: {unknown('supported place', place, places, 'this body')}")
    first, second = (
        {letter for support in supports if place in support.places for letter in support.components}
        for place in join.places
    )
    if not first & second:
        raise InputError(
            f"{join}: {join.places[0]!r} prescribes {''.join(sorted(first))} and "
            f"{join.places[1]!r} {''.join(sorted(second))}, no component in common, so nothing can "
            "jump where they meet; leave the join out"
        )


def _circle(pairs: list[tuple[str, str]]) -> list[str]:
    """A circle of precedences, its first place repeated at the end; empty if there is none."""
    below: dict[str, list[str]] = {}
    for first, second in pairs:
        below.setdefault(first, []).append(second)
    paths = [[place] for place in below]
    while paths:
        path = paths.pop(0)
        for place in below.get(path[-1], []):
            if place == path[0]:
                return [*path, place]
            if place not in path:
                paths.append([*path, place])
    return []
