# SPDX-License-Identifier: BSD-3-Clause
"""Between a mesh and what meshio holds: cells by type, arrays of numbers, sets. Imports none of it.

Formats differ in how they group cells: one number a cell (Gmsh, Medit), or any number of arrays
(VTK), where a name becomes an array of 0 and 1 called "surface:skin".
"""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any
from urllib.parse import quote, unquote

import numpy as np

from bezsoma.arrays import Bools, Ints
from bezsoma.errors import InputError, MeshError
from bezsoma.mesh.checks import region_names
from bezsoma.mesh.tagged import Cells, Listing
from bezsoma.mesh.tets import TetMesh
from bezsoma.mesh.topology import numbers

TAGS = ("gmsh:physical", "medit:ref", "netgen:index", "su2:tag", "nastran:ref", "avsucd:material")
"""Numbers of cells that a format defines to be tags."""
OWN_TAGS = "region"
"""Numbers of tets in files of BezSoma's, whose metadata name them."""
MOST_TAGS = 256
"""An array of whole numbers with more different values than this numbers cells; it tags none."""
KINDS = {"tetra": "region", "triangle": "surface", "line": "edge", "vertex": "vertex"}
"""The cells that are read, by meshio's name, and what a group of them becomes."""


def listing_of(foreign: Any, given: str | None, wanted: bool) -> Listing:
    """What meshio read, by kinds of cells; `wanted` says that the user means to name tags."""
    own = _own_regions(foreign)
    tags = _tag_array(foreign, OWN_TAGS if own and given is None else given, wanted)
    kinds = {block.type for block in foreign.cells if len(block.data)}
    straight(kinds)
    cells = {
        cell: _cells(foreign, cell, kind, tags, width)
        for (cell, kind), width in zip(KINDS.items(), (4, 3, 2, 1), strict=True)
    }
    if own and tags == OWN_TAGS:
        named = dict(enumerate(own))
        cells["tetra"] = replace(cells["tetra"], names=named, kept=np.arange(len(own)))
    single = cells["vertex"]
    if foreign.point_sets:
        corners = np.unique(cells["tetra"].rows)
        sets = {
            str(name): np.flatnonzero(np.isin(corners, np.asarray(members, dtype=np.int64)))
            for name, members in foreign.point_sets.items()
        }
        single = Cells(corners[:, None], sets=sets)
    return Listing(foreign.points, cells["tetra"], cells["triangle"], cells["line"], single)


def _own_regions(foreign: Any) -> tuple[str, ...]:
    """The names of regions 0, 1, ... in a VTU file that `write_vtu` wrote.

    None where its words are damaged, or do not fit its numbers: these are then tags as any.
    """
    text = np.asarray(foreign.field_data.get("metadata", ()))
    regions = foreign.cell_data.get(OWN_TAGS, [])
    if text.dtype != np.uint8 or not regions or not _whole(regions):
        return ()
    try:
        words = json.loads(text.tobytes())
        if not (words["software"].startswith("bezsoma") and isinstance(words["regions"], list)):
            return ()
        names = region_names(words["regions"])
    except (ValueError, LookupError, TypeError, AttributeError, RecursionError):
        return ()
    numbered = np.concatenate(regions)
    return names if ((numbered >= 0) & (numbered < len(names))).all() else ()


def straight(kinds: set[str]) -> None:
    """Refuse other cells than those that are read."""
    other = sorted(kinds - KINDS.keys())
    if other:
        curved = [kind for kind in other if kind.rstrip("0123456789") in KINDS]
        if any(kind.startswith(("VTK_LAGRANGE", "VTK_BEZIER")) for kind in other):
            advice = (
                "these are curved; where BezSoma wrote the file (displacement.vtu), read mesh.npz "
                "beside it"
            )
        elif len(curved) == len(other):
            advice = "save the mesh with straight cells (order 1)"
        else:
            advice = "split them into tets where the mesh is made"
        raise MeshError(f"it has cells of the kinds {other}; straight tets are read: {advice}")
    if "tetra" not in kinds:
        raise MeshError(
            f"it has no tets (cells: {sorted(kinds) or 'none'}); a volume mesh of tets is needed, "
            "a surface alone has to be filled with tets first"
        )


def _cells(foreign: Any, cell: str, kind: str, tags: str | None, width: int) -> Cells:
    """All cells of one type, with their tags, the names of these, and their sets."""
    blocks = [i for i, block in enumerate(foreign.cells) if block.type == cell]
    none = np.zeros((0, width), np.int64)
    rows = np.concatenate([none, *(np.asarray(foreign.cells[i].data) for i in blocks)])
    values = [np.asarray(foreign.cell_data[tags][i]) for i in blocks] if tags else []
    marks = np.concatenate([np.zeros(0, np.int64), *values]).astype(np.int64) if values else None
    groups = foreign.field_data if tags == "gmsh:physical" else {}  # of VTK's files it is anything
    names = {
        int(number): str(name)
        for name, (number, dimension) in groups.items()
        if dimension == width - 1
    }
    return Cells(rows, marks, names, _sets(foreign, blocks, kind, len(rows)))


def _sets(foreign: Any, blocks: list[int], kind: str, count: int) -> dict[str, Ints]:
    """Sets of a format that has them, and our own arrays of 0 and 1, such as "surface:skin"."""
    found: dict[str, Ints] = {}
    starts = np.cumsum([0, *(len(foreign.cells[i].data) for i in blocks)])
    for name, members in foreign.cell_sets.items():
        if not str(name).startswith("gmsh:"):
            parts = [np.asarray(members[i], dtype=np.int64) for i in blocks]
            shifted = [part + start for part, start in zip(parts, starts, strict=False)]
            found[str(name)] = np.unique(np.concatenate([np.zeros(0, np.int64), *shifted]))
    for name, values in foreign.cell_data.items():
        if name.startswith(f"{kind}:") and name not in TAGS:
            mask = np.concatenate([np.zeros(0), *(np.ravel(values[i]) for i in blocks)])
            if len(mask) == count:
                found[unquote(name.removeprefix(f"{kind}:"))] = np.flatnonzero(mask)
    return {name: members for name, members in found.items() if len(members)}


def _tag_array(foreign: Any, given: str | None, wanted: bool) -> str | None:
    """The name of the cell array that holds the tags, if there is one."""
    whole = [name for name, values in foreign.cell_data.items() if _whole(values)]
    ours = tuple(f"{kind}:" for kind in KINDS.values())
    if given is not None:
        if given not in whole:
            raise InputError(f"no cell array {given!r} of whole numbers; the file has {whole}")
        return given
    for name in TAGS:
        if name in whole:
            return name
    free = [
        name
        for name in whole
        if not name.startswith(ours)
        and name != "gmsh:geometrical"
        and len(np.unique(np.concatenate(foreign.cell_data[name]))) <= MOST_TAGS
    ]
    if len(free) > 1 and wanted:
        raise InputError(f"several cell arrays may hold the tags: say tags=, one of {free}")
    return free[0] if len(free) == 1 else None


def _whole(values: list[Any]) -> bool:
    """Whether every block holds one whole number a cell; some formats store them as floats."""
    arrays = [np.asarray(part) for part in values]
    return all(a.ndim == 1 and a.dtype.kind in "iuf" for a in arrays) and all(
        a.dtype.kind in "iu" or bool((np.isfinite(a) & (a == np.floor(a))).all()) for a in arrays
    )


def masked(mesh: TetMesh) -> dict[str, Any]:
    """For VTK: every cell once, and one array of 0 and 1 for each name, in meshio's words."""
    kinds = {"triangle": mesh.surfaces, "line": mesh.edges, "vertex": mesh.vertices}
    rows = {"tetra": mesh.tets} | {
        cell: np.unique(np.concatenate([_wide(x) for x in named.values()]), axis=0)
        for cell, named in kinds.items()
        if named
    }
    data = {
        f"region:{quote(name)}": {"tetra": mesh.region == index}
        for index, name in enumerate(mesh.regions)
    } | {
        f"{KINDS[cell]}:{quote(name)}": {cell: _among(rows[cell], x, len(mesh.points))}
        for cell, named in kinds.items()
        for name, x in named.items()
    }
    arrays = {
        name: [mask.get(cell, np.zeros(len(rows[cell]), bool)).astype(np.uint8) for cell in rows]
        for name, mask in data.items()
    }
    cells = [(cell, _turned(mesh, cell, x)) for cell, x in rows.items()]
    return {"points": mesh.points.copy(), "cells": cells, "cell_data": arrays}


def _wide(rows: Ints) -> Ints:
    return rows.reshape(len(rows), -1)


def _among(rows: Ints, members: Ints, count: int) -> Bools:
    return numbers(rows, np.unique(_wide(members), axis=0)) >= 0


def _turned(mesh: TetMesh, kind: str, rows: Ints) -> Ints:
    """Tets positive and facets outward, as other programs expect them."""
    if kind == "tetra":
        return mesh.oriented_tets
    return mesh.outward(rows) if kind == "triangle" else rows


def grouped(mesh: TetMesh, suffix: str) -> dict[str, Any]:
    """For Gmsh and Medit, in meshio's words: one number a cell.

    A facet in two surfaces is therefore written twice; tets are listed region by region.
    """
    kinds = {"triangle": mesh.surfaces, "line": mesh.edges, "vertex": mesh.vertices}
    parts = [("tetra", mesh.oriented_tets[mesh.region == i], i) for i in range(len(mesh.regions))]
    for cell, named in kinds.items():
        rows = enumerate(named.values())
        parts += [(cell, _turned(mesh, cell, _wide(x)), i) for i, x in rows]
    parts = [part for part in parts if len(part[1])]
    tags = [np.full(len(rows), i + 1, np.int32) for _, rows, i in parts]
    cells = [(cell, rows) for cell, rows, _ in parts]
    given = {"points": mesh.points.copy(), "cells": cells}
    if suffix == ".msh":
        both = {"gmsh:physical": tags, "gmsh:geometrical": tags}
        return {**given, "cell_data": both, "field_data": _physical(mesh)}
    if mesh.vertices:
        raise InputError(f"{suffix} has no named vertices; write .npz, .vtu, .msh or .inp")
    return {**given, "cell_data": {"medit:ref": tags}}


def _physical(mesh: TetMesh) -> dict[str, Ints]:
    """Gmsh's physical names: number and dimension. One name for two groups would lose one."""
    names = [*mesh.regions, *mesh.places]
    bad = sorted({name for name in names if names.count(name) > 1 or '"' in name})
    if bad:
        raise InputError(
            f"Gmsh cannot hold the name {bad[0]!r} (used for a region and a place, or with a "
            "quotation mark): rename one, or write .npz"
        )
    dimensions = ((3, mesh.regions), (2, mesh.surfaces), (1, mesh.edges), (0, mesh.vertices))
    return {
        name: np.array([i + 1, dimension])
        for dimension, named in dimensions
        for i, name in enumerate(named)
    }
