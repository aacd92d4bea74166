# SPDX-License-Identifier: BSD-3-Clause
"""VTU files of meshes, surfaces and fields of their own degree; `grid` says what stands in them.

Lengths are mm, the frame is LPS; the file says so itself.
"""

from __future__ import annotations

import base64
import json
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np

from bezsoma.arrays import Numbers
from bezsoma.mesh import TetMesh
from bezsoma.view.grid import Cells, Fields, Grid, mesh_grid, surface_grid
from bezsoma.view.written import written

_TYPES = {
    "f8": "Float64", "i4": "Int32", "i8": "Int64",
    "u1": "UInt8", "u2": "UInt16", "u4": "UInt32",
}  # fmt: skip
_BLOCK = 1 << 20
_SAMPLE = 1 << 15
_SHRINKS = 0.8
"""Blocks of whose beginning more than this part is left are stored as they are: the digits of most
coordinates and displacements hardly shrink, and took longer than all else."""
_COMPONENTS = {1: ("",), 3: ("X", "Y", "Z"), 9: tuple(a + b for a in "XYZ" for b in "XYZ")}


def write_vtu(
    path: str | Path,
    mesh: TetMesh,
    fields: Fields = None,
    degree: int | None = None,
    *,
    cells: Cells = "lagrange",
    overwrite: bool = False,
    metadata: Mapping[str, Any] | None = None,
) -> Path:
    """Writes the mesh and fields on it as a VTU file of cells of their degree; gives the path.

    `fields` are named: {"displacement": u, "stress": s}. A field alone is taken too: a `Field` of
    three components is called "displacement", any other "field"; with None there is only the mesh.
    The degree is the largest of the fields' unless stated; a smaller one than a field's means
    that the field is interpolated. Continuous fields share their points. As soon as one field is
    broken (stress), every tet gets points of its own, so that both sides of a jump are kept. A
    scalar has 1 component, a vector 3 (X, Y, Z), a tensor 9 (XX, XY, XZ, YX, ...). The cell data
    `region` numbers the regions; their names, units and versions stand as JSON in the field data
    `metadata` and in the comment at the head of the file.

    `cells` are "lagrange", whose data are values at points, or "bezier", whose data are the
    controls themselves. Both hold the field exactly. Beware of Bezier cells: VTK shows them right,
    but its slices, clips, contours, probes and volumes of them are wrong, and other readers do
    not know them.
    """
    call = "write_vtu(path, mesh, fields)"
    grid = mesh_grid(call, path, mesh, fields, degree, cells, metadata)
    return written(path, _document(grid), overwrite)


def write_surface_vtu(
    path: str | Path,
    mesh: TetMesh,
    fields: Fields = None,
    surface: str | tuple[str, ...] | None = None,
    degree: int | None = None,
    *,
    cells: Cells = "lagrange",
    overwrite: bool = False,
    metadata: Mapping[str, Any] | None = None,
) -> Path:
    """Writes a surface and fields on it as a VTU file of triangles of their degree.

    The surface is one name, several names or, with None, the whole boundary; its triangles are
    oriented outwards. The rest is as in `write_vtu`; there is no cell data.
    """
    call = "write_surface_vtu(path, mesh, fields)"
    grid = surface_grid(call, path, mesh, fields, surface, degree, cells, metadata)
    return written(path, _document(grid), overwrite)


def _document(grid: Grid) -> bytes:
    """The XML file: version 1.0, little-endian, arrays as base64 of zlib blocks."""
    text = json.dumps(grid.metadata, ensure_ascii=True, sort_keys=True)
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
        _array("offsets", grid.offsets[1:]),
        _array("types", grid.types),
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
    kind = "f8" if array.dtype.kind == "f" else array.dtype.str[1:]
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
        f"{_encoded(content.reshape(-1).view(np.uint8).data)}</DataArray>"
    )


def _encoded(raw: bytes | memoryview) -> str:
    """VTK's inline form: base64 of [blocks, block size, last size, sizes], then of the blocks.

    >>> text = _encoded(b"abc")
    >>> np.frombuffer(base64.b64decode(text[:44]), "<u8").tolist(), text[44:48]
    ([1, 1048576, 3, 14], 'eAEB')
    >>> zlib.decompress(base64.b64decode(text[44:]))
    b'abc'
    """
    blocks = [raw[i : i + _BLOCK] for i in range(0, len(raw), _BLOCK)]
    packed = [_packed(block) for block in blocks]
    last = len(raw) % _BLOCK
    header = np.array([len(blocks), _BLOCK, last, *map(len, packed)], "<u8")
    return (base64.b64encode(header.tobytes()) + base64.b64encode(b"".join(packed))).decode()


def _packed(block: bytes | memoryview) -> bytes:
    """A block as zlib has it; stored where it would hardly shrink.

    >>> digits = np.random.default_rng(1).random(10_000).tobytes()
    >>> len(_packed(digits)) > 80_000 > 400 > len(_packed(bytes(80_000)))
    True
    """
    sample = block[:_SAMPLE]
    shrinks = len(zlib.compress(sample, 1)) <= _SHRINKS * len(sample)
    return zlib.compress(block, 1 if shrinks else 0)
