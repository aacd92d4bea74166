# SPDX-License-Identifier: BSD-3-Clause
"""VTU files of meshes and fields: Lagrange cells of the fields' own degree, nothing linearised.

A control is not a value at a point, and VTK's Lagrange cells want values: a field is evaluated
at the lattice points of the written degree, which loses nothing as long as that degree is not
below the field's. Lengths are mm, the frame is LPS; the file says so itself.
"""

from __future__ import annotations

import base64
import json
import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np

from bezsoma import __version__
from bezsoma.arrays import Floats, Ints, Numbers
from bezsoma.bernstein import domain_points
from bezsoma.errors import InputError
from bezsoma.mesh import BrokenField, ControlNet, Field, TetMesh
from bezsoma.mesh.nouns import described, field_given, mesh_given, path_given
from bezsoma.view.lagrange import vtk_order
from bezsoma.view.lattice import shared_points
from bezsoma.view.restriction import (
    AnyField,
    controls_on,
    degree_of,
    facets_named,
    on_same_mesh,
    values_at,
)
from bezsoma.view.written import written

_TYPES = {"f8": "Float64", "i8": "Int64", "u1": "UInt8"}
_TETS = {1: 10}
"""VTK's cell type by degree where it is not the Lagrange one: the plain tetrahedron."""
_TRIANGLES = {1: 5}
_LAGRANGE_TETRAHEDRON, _LAGRANGE_TRIANGLE = 71, 69
_BLOCK = 1 << 20
_NOTICE = "Research software, not a medical device."
_COMPONENTS = {1: ("",), 3: ("X", "Y", "Z"), 9: tuple(a + b for a in "XYZ" for b in "XYZ")}


@dataclass(frozen=True, eq=False)
class _Grid:
    """What a VTU file holds: points in mm, cells of one type, and data by name."""

    points: Floats
    cells: Ints
    cell_type: int
    point_data: Mapping[str, Numbers]
    cell_data: Mapping[str, Numbers]
    metadata: Mapping[str, Any]


def write_vtu(
    path: str | Path,
    mesh: TetMesh,
    fields: Mapping[str, AnyField] | AnyField | None = None,
    degree: int | None = None,
    *,
    overwrite: bool = False,
    metadata: Mapping[str, Any] | None = None,
) -> Path:
    """Writes the mesh and fields on it as a VTU file of Lagrange tetrahedra; gives the path.

    `fields` are named: {"displacement": u, "stress": s}. A field alone is taken too: a `Field` of
    three components is called "displacement", any other "field"; with None there is only the mesh.
    The degree is the largest of the fields' unless stated; a smaller one than a field's means
    that the field is interpolated. Continuous fields share their points. As soon as one field is
    broken (stress), every tet gets points of its own, so that both sides of a jump are kept. A
    scalar has 1 component, a vector 3 (X, Y, Z), a tensor 9 (XX, XY, XZ, YX, ...). The cell data
    `region` numbers the regions; their names, units and versions stand as JSON in the field data
    `metadata` and in the comment at the head of the file.
    """
    fields = _checked("write_vtu(path, mesh, fields)", path, mesh, fields)
    chosen = _degree(mesh, fields, degree)
    broken = any(not isinstance(field, Field) for field in fields.values())
    bary = domain_points(chosen, 3)
    positions = bary @ mesh.points[mesh.tets]
    sampled = {
        name: values_at(degree_of(field), field.of_tet, bary) for name, field in fields.items()
    }
    if broken:
        of_tet = np.arange(positions.shape[0] * len(bary)).reshape(-1, len(bary))
    else:
        of_tet = ControlNet(mesh, chosen).of_tet
    a, b, c = (mesh.points[mesh.tets[:, i]] - mesh.points[mesh.tets[:, 0]] for i in (1, 2, 3))
    mirrored = np.einsum("td,td->t", a, np.cross(b, c)) < 0
    grid = _Grid(
        _gathered(positions, of_tet),
        _cells(of_tet, chosen, 3, mirrored),
        _TETS.get(chosen, _LAGRANGE_TETRAHEDRON),
        {name: _gathered(value, of_tet) for name, value in sampled.items()},
        {"region": mesh.region},
        _metadata(chosen, metadata, regions=list(mesh.regions)),
    )
    return written(path, _document(grid), overwrite)


def write_surface_vtu(
    path: str | Path,
    mesh: TetMesh,
    fields: Mapping[str, AnyField] | AnyField | None = None,
    surface: str | tuple[str, ...] | None = None,
    degree: int | None = None,
    *,
    overwrite: bool = False,
    metadata: Mapping[str, Any] | None = None,
) -> Path:
    """Writes a surface and fields on it as a VTU file of Lagrange triangles; gives the path.

    The surface is one name, several names or, with None, the whole boundary; its triangles are
    oriented outwards. The rest is as in `write_vtu`; there is no cell data.
    """
    fields = _checked("write_surface_vtu(path, mesh, fields)", path, mesh, fields)
    facets = facets_named(mesh, surface)
    chosen = _degree(mesh, fields, degree)
    broken = any(not isinstance(field, Field) for field in fields.values())
    bary = domain_points(chosen, 2)
    positions = bary @ mesh.points[facets]
    of_facet, _ = shared_points(facets, chosen)
    if broken:
        of_facet = np.arange(of_facet.size).reshape(of_facet.shape)
    a, b = (mesh.points[facets[:, i]] - mesh.points[facets[:, 0]] for i in (1, 2))
    mirrored = np.einsum("fd,fd->f", np.cross(a, b), mesh.normals(facets)) < 0
    grid = _Grid(
        _gathered(positions, of_facet),
        _cells(of_facet, chosen, 2, mirrored),
        _TRIANGLES.get(chosen, _LAGRANGE_TRIANGLE),
        {
            name: _gathered(
                values_at(degree_of(field), controls_on(mesh, field, facets), bary), of_facet
            )
            for name, field in fields.items()
        },
        {},
        _metadata(chosen, metadata, surface=surface if surface is not None else "boundary"),
    )
    return written(path, _document(grid), overwrite)


def _checked(call: str, path: Any, mesh: Any, fields: Any) -> dict[str, AnyField]:
    """The fields by name, once path, mesh and fields are seen to be what they are called."""
    path_given(path, call)
    mesh_given(mesh, call)
    if fields is None:
        return {}
    if isinstance(fields, Field | BrokenField):
        vector = isinstance(fields, Field) and fields.shape == (3,)
        return {"displacement" if vector else "field": fields}
    if not isinstance(fields, Mapping):
        return {"field": field_given(fields, call, 'the fields, as {"u": field} can')}
    for name in fields:
        if not isinstance(name, str):
            raise InputError(f"{call}: {described(name)} cannot name a field; give text")
    return {name: field_given(each, call, f"field {name!r}") for name, each in fields.items()}


def _degree(mesh: TetMesh, fields: Mapping[str, AnyField], degree: int | None) -> int:
    """The degree to write, and the checks that the fields can be written at all."""
    for name, field in fields.items():
        on_same_mesh(mesh, field, name)
    chosen = max([1, *map(degree_of, fields.values())]) if degree is None else degree
    if isinstance(chosen, bool) or not isinstance(chosen, int) or not 1 <= chosen <= 10:
        raise InputError(f"degree {degree!r} cannot be written; VTU cells have degree 1 to 10")
    return chosen


def _gathered(of_element: Floats, numbers: Ints) -> Floats:
    """Values (c, k) at points from those of every element (e, q, k); neighbours agree."""
    found = np.empty((int(numbers.max(initial=-1)) + 1, of_element.shape[2]))
    found[numbers] = of_element
    return found


def _cells(numbers: Ints, degree: int, dim: int, mirrored: np.ndarray[Any, Any]) -> Ints:
    """Point numbers (e, m) in VTK's order, every cell right-handed (a surface: outwards)."""
    plain, other = (numbers[:, vtk_order(degree, dim, flip)] for flip in (False, True))
    return np.where(mirrored[:, None], other, plain)


def _metadata(degree: int, given: Mapping[str, Any] | None, **own: Any) -> dict[str, Any]:
    """What a reader of the file must know; `given` adds to it and cannot replace it."""
    return {
        **(given or {}),
        "software": f"bezsoma {__version__}",
        "notice": _NOTICE,
        "length unit": "mm",
        "frame": "LPS (x to the patient's left, y to posterior, z to superior)",
        "degree": degree,
        **own,
    }


def _document(grid: _Grid) -> bytes:
    """The XML file: version 1.0, little-endian, arrays as base64 of zlib blocks."""
    text = json.dumps(grid.metadata, ensure_ascii=True, sort_keys=True)
    size = grid.cells.shape[1]
    offsets = np.arange(1, len(grid.cells) + 1) * size
    types = np.full(len(grid.cells), grid.cell_type, np.uint8)
    lines = [
        '<?xml version="1.0"?>',
        f"<!-- {text.replace('--', '- -')} -->",
        '<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian"'
        ' header_type="UInt64" compressor="vtkZLibDataCompressor">',
        "<UnstructuredGrid>",
        "<FieldData>",
        _array("metadata", np.frombuffer(text.encode(), np.uint8), tuples=True),
        "</FieldData>",
        f'<Piece NumberOfPoints="{len(grid.points)}" NumberOfCells="{len(grid.cells)}">',
        "<Points>",
        _array("Points", grid.points),
        "</Points>",
        "<Cells>",
        _array("connectivity", grid.cells.ravel()),
        _array("offsets", offsets),
        _array("types", types),
        "</Cells>",
        "<PointData>",
        *(_array(name, array) for name, array in grid.point_data.items()),
        "</PointData>",
        "<CellData>",
        *(_array(name, array) for name, array in grid.cell_data.items()),
        "</CellData>",
        "</Piece>",
        "</UnstructuredGrid>",
        "</VTKFile>",
        "",
    ]
    return "\n".join(lines).encode()


def _array(name: str, array: Numbers, tuples: bool = False) -> str:
    """One DataArray element; `tuples` states their number, which field data needs."""
    kind = {"f": "f8", "i": "i8", "u": "u1"}[array.dtype.kind]
    content = np.ascontiguousarray(array, dtype=f"<{kind}")
    components = content.shape[1] if content.ndim == 2 else 1
    labels = "".join(
        f' ComponentName{i}="{label}"'
        for i, label in enumerate(_COMPONENTS.get(components, ()))
        if label
    )
    parts = f' NumberOfComponents="{components}"' if components > 1 else ""
    number = f' NumberOfTuples="{len(content)}"' if tuples else ""
    return (
        f'<DataArray type="{_TYPES[kind]}" Name={quoteattr(name)}{parts}{labels}{number}'
        f' format="binary">'
        f"{_encoded(content.tobytes())}</DataArray>"
    )


def _encoded(raw: bytes) -> str:
    """VTK's inline form: base64 of [blocks, block size, last size, sizes], then of the blocks.

    >>> text = _encoded(b"abc")
    >>> np.frombuffer(base64.b64decode(text[:44]), "<u8").tolist(), text[44:48]
    ([1, 1048576, 3, 11], 'eAFL')
    >>> zlib.decompress(base64.b64decode(text[44:]))
    b'abc'
    """
    blocks = [raw[i : i + _BLOCK] for i in range(0, len(raw), _BLOCK)]
    packed = [zlib.compress(block, 1) for block in blocks]
    last = len(raw) % _BLOCK
    header = np.array([len(blocks), _BLOCK, last, *map(len, packed)], "<u8")
    return (base64.b64encode(header.tobytes()) + base64.b64encode(b"".join(packed))).decode()
