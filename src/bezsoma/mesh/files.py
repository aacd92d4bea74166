# SPDX-License-Identifier: BSD-3-Clause
"""Meshes in files. The only place that imports meshio.

Coordinates are read as they stand: mm in LPS is what the rest of BezSoma takes them for. A file
in other units or another frame has to be brought there with `TetMesh.moved`.
"""

from __future__ import annotations

import contextlib
import difflib
import io
import os
import warnings
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np

from bezsoma.errors import InputError, MeshError
from bezsoma.mesh.abaqus import read_abaqus, write_abaqus
from bezsoma.mesh.foreign import grouped, listing_of, masked, straight
from bezsoma.mesh.nouns import mesh_given, path_given
from bezsoma.mesh.npz import read_npz, write_npz
from bezsoma.mesh.tagged import Listing, mesh_of
from bezsoma.mesh.tets import TetMesh
from bezsoma.mesh.whole import write_whole

FORMATS = {
    ".vtu": "vtu",
    ".vtk": "vtk",
    ".msh": "gmsh",
    ".mesh": "medit",
    ".meshb": "medit",
    ".vol": "netgen",
    ".su2": "su2",
    ".bdf": "nastran",
    ".nas": "nastran",
    ".avs": "avsucd",
    ".f3grid": "flac3d",
}
"""Endings that meshio reads for us, and what it calls them."""
READ = (".npz", ".inp", *FORMATS)
WRITTEN = (".npz", ".inp", ".vtu", ".vtk", ".msh", ".mesh", ".meshb")


def read_mesh(
    path: str | os.PathLike[str],
    surfaces: Mapping[str, int] | None = None,
    regions: Mapping[str, int] | None = None,
    *,
    tags: str | None = None,
) -> TetMesh:
    """The mesh in a file, its coordinates taken as mm in LPS; the ending tells the format.

    Read: .npz, .inp (Abaqus), .vtu, .vtk, .msh (Gmsh 2.2 and 4.1), .mesh and .meshb (Medit), .vol
    (Netgen), .su2, .bdf and .nas (Nastran), .avs and .f3grid.

    `surfaces` and `regions` name tags: {"skin": 1} calls the facets with tag 1 skin. Names in the
    file (Gmsh's physical groups, Abaqus sets, the regions of a VTU by `write_vtu`) are kept where
    they are not named here. Tags that nobody names become "surface 7", "region 7", "edge 7" or
    "vertex 7"; tag 0 means none, and tets without a region are "tissue". `tags` says which of a
    file's cell arrays holds the tags, where it is not the one that the format itself defines nor
    the only array of whole numbers.

    Triangles, lines and points without a tag or a set are left out; cells other than those and
    straight tets are refused. Points of no tet are dropped (`TetMesh.dropped` counts them).
    """
    place = _existing(path_given(path, "read_mesh(path)"))
    try:
        if place.suffix.lower() == ".npz":
            return read_npz(place, surfaces, regions)
        return mesh_of(_listing(place, tags, bool(surfaces or regions)), surfaces, regions)
    except InputError as error:
        raise type(error)(f"{path}: {error}") from error


def write_mesh(path: str | os.PathLike[str], mesh: TetMesh, *, overwrite: bool = False) -> None:
    """Write a mesh (mm, LPS) to a file; the ending tells the format.

    .npz keeps everything to the last bit. .vtu and .vtk keep names too, as cell arrays of 0 and 1
    called "surface:skin"; .msh (Gmsh 2.2) as physical groups and .inp (Abaqus) as sets. .mesh and
    .meshb (Medit) have no names: regions, surfaces, edges and vertices become the references 1,
    2, ... in their order, each kind for itself.

    The file appears whole or not at all. One that is there is refused unless `overwrite`.
    """
    call = "write_mesh(path, mesh)"
    place, mesh = path_given(path, call), mesh_given(mesh, call)
    suffix = place.suffix.lower()
    if suffix not in WRITTEN:
        raise InputError(
            f"{path}: the ending {suffix!r} is none that can be written; these are: "
            f"{', '.join(WRITTEN)} (.npz keeps everything)"
        )
    if place.exists() and not overwrite:
        raise InputError(f"{path} is there already; take another name, or say overwrite=True")
    if not place.parent.is_dir():
        raise InputError(f"{path}: there is no folder {place.parent}; make it first")
    try:
        write_whole(place, lambda part: _write(part, suffix, mesh))
    except OSError as error:
        raise InputError(f"{path} could not be written: {error.strerror or error}") from error


def _write(part: Path, suffix: str, mesh: TetMesh) -> None:
    if suffix == ".npz":
        with part.open("wb") as archive:
            write_npz(archive, mesh)
    elif suffix == ".inp":
        with part.open("w", encoding="utf-8") as deck:
            write_abaqus(deck, mesh)
    else:
        import meshio  # here, since our own files need not wait for it

        given = masked(mesh) if suffix in (".vtu", ".vtk") else grouped(mesh, suffix)
        kind = {".msh": "gmsh22", ".mesh": "medit"}.get(suffix, FORMATS[suffix])
        with _quiet():
            meshio.write(part, meshio.Mesh(**given), file_format=kind)


def _existing(path: str | os.PathLike[str]) -> Path:
    """The path, if it is a file with an ending that is known and something in it."""
    place = Path(path)
    suffix = place.suffix.lower()
    if not place.exists():
        near = _neighbours(place)
        raise InputError(f"no file {str(path)!r}{near}; a path is relative to the working folder")
    if place.is_dir():
        raise InputError(f"{path} is a folder; a mesh file is needed")
    if suffix not in READ:
        raise InputError(
            f"{path}: the ending {suffix!r} is none that is read; meshes of tets are read from "
            f"{', '.join(READ)}"
        )
    try:
        with place.open("rb") as file:
            start = file.read(64)
    except OSError as error:
        raise InputError(f"{path} cannot be opened: {error.strerror or error}") from error
    if not start:
        raise MeshError(f"{path} is empty (0 bytes); write it again, or copy it again")
    if start.startswith(b"MFEM"):
        raise InputError(f"{path} is a mesh of MFEM, which is not read; save it as VTU or Gmsh")
    return place


def _neighbours(place: Path) -> str:
    if not place.parent.is_dir():
        return f" (there is no folder {str(place.parent)!r})"
    names = [other.name for other in place.parent.iterdir()]
    near = difflib.get_close_matches(place.name, names, n=1)
    return f" (did you mean {near[0]!r}?)" if near else ""


def _listing(place: Path, tags: str | None, wanted: bool) -> Listing:
    """What a file of another program lists; whatever its reader trips over becomes our error."""
    suffix = place.suffix.lower()
    said = io.StringIO()
    try:
        if suffix == ".inp":
            with place.open(encoding="utf-8", errors="replace") as deck:
                return read_abaqus(deck)
        import meshio

        with _quiet(said):
            foreign = meshio.read(place, file_format=FORMATS[suffix])
    except InputError:
        raise
    except (Exception, SystemExit) as error:
        # Of Bezier cells meshio knows the name alone, and trips over it.
        name = str(error).strip("'")
        if isinstance(error, KeyError) and name.startswith("VTK_BEZIER"):
            straight({name})
        reason = " ".join(said.getvalue().split()) or f"{type(error).__name__}: {error}"
        raise MeshError(
            f"it cannot be read as {suffix} ({reason[:300]}); it may be damaged, cut short, or of "
            f"another format than its ending says. Meshes of tets are read from {', '.join(READ)}"
        ) from error
    return listing_of(foreign, tags, wanted)


@contextlib.contextmanager
def _quiet(said: io.StringIO | None = None) -> Iterator[None]:
    """Keep meshio's messages off the console; a text that ends too early is an error."""
    said = said if said is not None else io.StringIO()
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        warnings.filterwarnings("error", message="string or file could not be read to its end")
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            yield
