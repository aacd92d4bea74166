# SPDX-License-Identifier: BSD-3-Clause
"""From what a file lists (cells with tags, names and sets) to a mesh with regions and places."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np

from bezsoma.arrays import Floats, Ints
from bezsoma.errors import InputError
from bezsoma.mesh.checks import listed
from bezsoma.mesh.tets import TetMesh

UNNAMED = "tissue"
"""The region of tets that a file says nothing about."""


@dataclass(frozen=True, eq=False)
class Cells:
    """The cells of one kind in a file, and what the file says about them."""

    rows: Ints
    """(n, k) point numbers: k = 4 tets, 3 facets, 2 edges, 1 vertices."""
    tags: Ints | None = None
    """(n,) one number a cell; 0 means none."""
    names: Mapping[int, str] = field(default_factory=dict)
    """What the file calls a tag."""
    sets: Mapping[str, Ints] = field(default_factory=dict)
    """Named lists of positions in `rows`; a cell may be in several."""
    kept: Ints = field(default_factory=lambda: np.zeros(0, np.int64))
    """Tags of tets that are regions even where no tet bears them."""


NO_FACETS = Cells(np.zeros((0, 3), np.int64))
NO_EDGES = Cells(np.zeros((0, 2), np.int64))
NO_VERTICES = Cells(np.zeros((0, 1), np.int64))


@dataclass(frozen=True, eq=False)
class Listing:
    """All that a file lists: points (v, 3) in mm, and cells of every kind."""

    points: Floats
    tets: Cells
    facets: Cells = NO_FACETS
    edges: Cells = NO_EDGES
    vertices: Cells = NO_VERTICES


def mesh_of(
    listing: Listing, surfaces: Mapping[str, int] | None, regions: Mapping[str, int] | None
) -> TetMesh:
    """The mesh; `surfaces` and `regions` name tags, and win over the names in the file."""
    region, region_names = _regions(listing.tets, regions)
    named = {name: listing.facets.rows[at] for name, at in _places(listing.facets, surfaces)}
    lines = {name: listing.edges.rows[at] for name, at in _places(listing.edges)}
    single = {name: listing.vertices.rows[at, 0] for name, at in _places(listing.vertices)}
    lines = {name: rows for name, rows in lines.items() if name not in named}
    single = {name: at for name, at in single.items() if name not in {**named, **lines}}
    return TetMesh(listing.points, listing.tets.rows, region, region_names, named, lines, single)


def _places(cells: Cells, given: Mapping[str, int] | None = None) -> Iterable[tuple[str, Ints]]:
    """The sets of a file, then its tags: named by the user, by the file, or by number."""
    chosen = _named_tags(cells, given, "surface", "facet")
    renamed = {cells.names.get(tag) for tag in chosen}
    taken = {name: at for name, at in cells.sets.items() if name not in renamed}
    kind = {3: "surface", 2: "edge", 1: "vertex"}[cells.rows.shape[1]]
    for tag in [] if cells.tags is None else np.unique(cells.tags).tolist():
        name = chosen.get(tag, cells.names.get(tag, f"{kind} {tag}"))
        if (tag != 0 or tag in chosen) and name not in taken:
            taken[name] = np.flatnonzero(cells.tags == tag)
    return [(name, at) for name, at in taken.items() if len(at)]


def _regions(cells: Cells, given: Mapping[str, int] | None) -> tuple[Ints, tuple[str, ...]]:
    """The region of each tet: by tags where the user names them or no set does."""
    chosen = _named_tags(cells, given, "region", "tet")
    if cells.tags is None or (cells.sets and not chosen):
        return _regions_of_sets(cells)
    both = np.concatenate([cells.tags, cells.kept])
    tags, region = np.unique(both, return_inverse=True)
    names = [
        chosen.get(tag, cells.names.get(tag, f"region {tag}" if tag else UNNAMED))
        for tag in tags.tolist()
    ]
    return region.reshape(-1)[: len(cells.rows)], tuple(names)


def _regions_of_sets(cells: Cells) -> tuple[Ints, tuple[str, ...]]:
    """A partition by sets; a set of all tets says nothing where there are others."""
    count = len(cells.rows)
    sets = {name: at for name, at in cells.sets.items() if 0 < len(at)}
    partial = {name: at for name, at in sets.items() if len(at) < count}
    region = np.full(count, -1, np.int64)
    names: list[str] = []
    for name, at in (partial or dict(list(sets.items())[:1])).items():
        both = at[region[at] >= 0]
        if len(both):
            raise InputError(
                f"tets {listed(both)} are in two sets, {names[region[both[0]]]!r} and {name!r}; "
                "a tet has one region: make the sets of tets disjoint where the file was written"
            )
        region[at] = len(names)
        names.append(name)
    if (region < 0).any():
        region[region < 0] = len(names)
        names.append(UNNAMED)
    return region, tuple(names)


def _named_tags(
    cells: Cells, given: Mapping[str, int] | None, kind: str, of: str
) -> dict[int, str]:
    """Tag to name, as the user gives them; every tag must be there and have one name."""
    if not given:
        return {}
    known = [] if cells.tags is None else np.unique(cells.tags).tolist()
    chosen: dict[int, str] = {}
    for name, tag in given.items():
        if isinstance(tag, bool) or not isinstance(tag, int | np.integer):
            raise InputError(f"{kind} {name!r} is given the tag {tag!r}; a tag is a whole number")
        if tag not in known:
            there = f"its {of}s bear the tags {known}" if known else f"its {of}s bear no tags"
            raise InputError(f"{kind} {name!r} is to be tag {tag}, but the file has none: {there}")
        if int(tag) in chosen:
            raise InputError(
                f"tag {tag} is given two names, {chosen[int(tag)]!r} and {name!r}; one is needed"
            )
        chosen[int(tag)] = name
    return chosen
