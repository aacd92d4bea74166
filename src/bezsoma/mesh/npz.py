# SPDX-License-Identifier: BSD-3-Clause
"""Meshes as NumPy archives: the plain form that tags facets, and our own, which loses nothing.

Plain: `points` (v, 3), `tets` (t, 4), and optionally `facets` (f, 3) with `facet_tags` (f,) and
`facet_tet` (f,) (the tet that has each facet), and `tet_tags` (t,). Other arrays of numbers or
text are ignored.

Ours: `bezsoma_mesh` (the version, 1), `points`, `tets`, `region`, `regions`, and for each kind of
place that there is, surface, edge and vertex, `KIND_names` (k,), `KIND_sizes` (k,) and `KIND_rows`,
the rows of all places one after the other.
"""

from __future__ import annotations

import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import BinaryIO

import numpy as np
import numpy.typing as npt

from bezsoma.arrays import Ints, Numbers
from bezsoma.errors import InputError, MeshError, counted
from bezsoma.mesh.checks import index_rows, listed, point_array, tet_array
from bezsoma.mesh.tagged import NO_FACETS, Cells, Listing, mesh_of
from bezsoma.mesh.tets import TetMesh

VERSION = 1
LARGEST = 2**34
"""Bytes that an archive may unpack to: some 200 million tets."""
WIDTHS = {"surface": 3, "edge": 2, "vertex": 1}


def read_npz(
    path: Path, surfaces: Mapping[str, int] | None, regions: Mapping[str, int] | None
) -> TetMesh:
    """The mesh in an archive of either form; pickled objects in it are never loaded."""
    arrays = _arrays(path)
    if "bezsoma_mesh" not in arrays:
        return mesh_of(_plain(arrays), surfaces, regions)
    if surfaces or regions:
        raise InputError("this file names its surfaces and regions itself: leave the names out")
    if arrays["bezsoma_mesh"].ravel().tolist() != [VERSION]:
        raise MeshError(
            f"the file has version {arrays['bezsoma_mesh'].tolist()} of the form; this BezSoma "
            f"reads version {VERSION}: use a newer BezSoma"
        )
    places = {kind: _places(arrays, kind) for kind in WIDTHS}
    return TetMesh(
        _array(arrays, "points"),
        _array(arrays, "tets"),
        _array(arrays, "region"),
        _names(arrays, "regions"),
        places["surface"],
        places["edge"],
        {name: rows[:, 0] for name, rows in places["vertex"].items()},
    )


def write_npz(file: BinaryIO, mesh: TetMesh) -> None:
    """Our own form of a mesh; the same mesh gives the same bytes.

    Not compressed: that took longer than a solve, for coordinates that hardly shrink.
    """
    arrays: dict[str, npt.ArrayLike] = {
        "bezsoma_mesh": VERSION,
        "points": mesh.points,
        "tets": mesh.tets.astype(np.int32),
        "region": mesh.region.astype(np.min_scalar_type(len(mesh.regions))),
        "regions": np.array(mesh.regions),
    }
    kinds = {"surface": mesh.surfaces, "edge": mesh.edges, "vertex": mesh.vertices}
    for kind, places in kinds.items():
        if not places:
            continue
        rows = [rows.reshape(-1, WIDTHS[kind]) for rows in places.values()]
        arrays[f"{kind}_names"] = np.array(list(places))
        arrays[f"{kind}_sizes"] = np.array([len(part) for part in rows])
        arrays[f"{kind}_rows"] = np.concatenate(rows)
    np.savez(file, **arrays)  # type: ignore[arg-type]


def _arrays(path: Path) -> dict[str, Numbers]:
    """Every array of the archive by name, or an error that says what is wrong with it."""
    try:
        with zipfile.ZipFile(path) as archive:
            parts = archive.infolist()
            size = sum(part.file_size for part in parts)
            if size > LARGEST:
                raise MeshError(
                    f"the archive would unpack to {size / 2**30:.3g} GiB; {LARGEST / 2**30:.3g} "
                    "GiB are allowed: this is hardly a mesh"
                )
            return {
                part.filename.removesuffix(".npy"): _unpacked(archive, part)
                for part in parts
                if part.filename.endswith(".npy")
            }
    except InputError:
        raise
    except Exception as error:  # zip, zlib and NumPy each have their own ways to fail
        raise MeshError(
            f"it is no sound NumPy archive of plain arrays ({error}); it may be damaged or cut "
            "short: write it again with numpy.savez or bezsoma.write_mesh"
        ) from error


def _unpacked(archive: zipfile.ZipFile, part: zipfile.ZipInfo) -> Numbers:
    with archive.open(part) as file:
        return np.asarray(np.lib.format.read_array(file, allow_pickle=False))


def _array(arrays: Mapping[str, Numbers], name: str) -> Numbers:
    if name not in arrays:
        raise MeshError(
            f"it has no array {name!r}, only {sorted(arrays)}; a mesh needs 'points' (v, 3) and "
            "'tets' (t, 4), and may have 'facets', 'facet_tags', 'facet_tet' and 'tet_tags'"
        )
    return arrays[name]


def _plain(arrays: Mapping[str, Numbers]) -> Listing:
    points = point_array(_array(arrays, "points"))
    rows = tet_array(_array(arrays, "tets"), len(points))
    tags = _tags(arrays, "tet_tags", "tet", len(rows)) if "tet_tags" in arrays else None
    return Listing(points, Cells(rows, tags), _facets(arrays, rows, len(points)))


def _facets(arrays: Mapping[str, Numbers], tets: Ints, count: int) -> Cells:
    if "facets" not in arrays and "facet_tags" not in arrays:
        return NO_FACETS
    facets = index_rows(_array(arrays, "facets"), 3, count, "facet", "point")
    if "facet_tags" not in arrays:
        return NO_FACETS
    if "facet_tet" in arrays:
        _owned(facets, tets, arrays["facet_tet"])
    return Cells(facets, _tags(arrays, "facet_tags", "facet", len(facets)))


def _owned(facets: Ints, tets: Ints, owner: Numbers) -> None:
    """A stale `facet_tet` betrays that facets and tets come from two meshes."""
    if owner.shape != (len(facets),) or owner.dtype.kind not in "iu":
        raise MeshError(
            f"facet_tet has the shape {owner.shape} and type {owner.dtype}; one whole number a "
            f"facet is needed: the shape ({len(facets)},)"
        )
    inside = (owner >= 0) & (owner < len(tets))
    of_tet = tets[np.where(inside, owner, 0)]
    inside &= (facets[:, :, None] == of_tet[:, None, :]).any(axis=2).all(axis=1)
    wrong = np.flatnonzero(~inside)
    if len(wrong):
        raise MeshError(
            f"facet {listed(wrong)} is not a face of the tet that facet_tet names (facet "
            f"{wrong[0]}: tet {owner[wrong[0]]}); facets and tets belong to two meshes, or the "
            "tets were put in another order: write the file again, or leave facet_tet out"
        )


def _tags(arrays: Mapping[str, Numbers], name: str, of: str, count: int) -> Ints:
    tags = arrays[name]
    if tags.shape != (count,) or tags.dtype.kind not in "iu":
        raise MeshError(
            f"{name} has the shape {tags.shape} and type {tags.dtype}; for "
            f"{counted(count, of)} whole numbers of the shape ({count},) are needed"
        )
    return tags.astype(np.int64)


def _names(arrays: Mapping[str, Numbers], name: str) -> tuple[str, ...]:
    array = _array(arrays, name)
    if array.ndim != 1 or array.dtype.kind != "U":
        raise MeshError(f"{name} has the shape {array.shape} and type {array.dtype}, not names")
    return tuple(str(text) for text in array)


def _places(arrays: Mapping[str, Numbers], kind: str) -> dict[str, Numbers]:
    if not any(f"{kind}_{what}" in arrays for what in ("names", "sizes", "rows")):
        return {}
    names, sizes = _names(arrays, f"{kind}_names"), _array(arrays, f"{kind}_sizes")
    rows = _array(arrays, f"{kind}_rows")
    fits = sizes.shape == (len(names),) and sizes.dtype.kind in "iu" and (sizes >= 0).all()
    if not fits or rows.shape != (int(sizes.sum()), WIDTHS[kind]):
        raise MeshError(
            f"{kind}_names, {kind}_sizes and {kind}_rows do not fit together: {len(names)} names, "
            f"sizes {sizes.tolist()}, rows of the shape {rows.shape}; write the file again"
        )
    ends = np.cumsum(sizes)
    return {
        name: rows[end - size : end] for name, size, end in zip(names, sizes, ends, strict=True)
    }
