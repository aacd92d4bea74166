# SPDX-License-Identifier: BSD-3-Clause
"""VTU files of meshes, surfaces and fields of their own degree; `grid` says what stands in them.

Lengths are mm, the frame is LPS; the file says so itself.
"""

from __future__ import annotations

import json
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
    """The XML file: version 1.0, little-endian, its arrays appended as they are in memory.

    Neither compressed nor as text: the digits of coordinates and displacements hardly shrink, and
    either took longer than all else.
    """
    text = json.dumps(grid.metadata, ensure_ascii=True, sort_keys=True)
    arrays = _Appended()
    lines = [
        '<?xml version="1.0"?>',
        f"<!-- {text.replace('--', '- -')} -->",
        '<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian"'
        ' header_type="UInt64">',
        "<UnstructuredGrid>",
        "<FieldData>",
        arrays.element("metadata", np.frombuffer(text.encode(), np.uint8), tuples=True),
        "</FieldData>",
        f'<Piece NumberOfPoints="{len(grid.points)}" NumberOfCells="{len(grid.cells)}">',
        "<Points>",
        arrays.element("Points", grid.points),
        "</Points>",
        "<Cells>",
        arrays.element("connectivity", grid.cells.ravel()),
        arrays.element("offsets", grid.offsets[1:]),
        arrays.element("types", grid.types),
        "</Cells>",
        "<PointData>",
        *(arrays.element(name, array) for name, array in grid.point_data.items()),
        "</PointData>",
        "<CellData>",
        *(arrays.element(name, array) for name, array in grid.cell_data.items()),
        "</CellData>",
        "</Piece>",
        "</UnstructuredGrid>",
        '<AppendedData encoding="raw">',
        "_",
    ]
    end = b"\n</AppendedData>\n</VTKFile>\n"
    return b"".join(["\n".join(lines).encode(), *arrays.blocks, end])


class _Appended:
    """The arrays of a file one after the other, each behind its number of bytes (UInt64)."""

    def __init__(self) -> None:
        self.blocks: list[bytes | memoryview] = []
        self.size = 0

    def element(self, name: str, array: Numbers, tuples: bool = False) -> str:
        """The DataArray element of one more array; `tuples` states their number, for field data."""
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
        offset = self.size
        raw = content.reshape(-1).view(np.uint8).data
        self.blocks += [len(raw).to_bytes(8, "little"), raw]
        self.size += 8 + len(raw)
        return (
            f'<DataArray type="{_TYPES[kind]}" Name={quoteattr(name)}{parts}{labels}{number}'
            f' format="appended" offset="{offset}"/>'
        )
