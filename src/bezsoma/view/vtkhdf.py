# SPDX-License-Identifier: BSD-3-Clause
"""VTKHDF files: the same grids as VTU files in HDF5, which is quicker to read. The extra `hdf`."""

from __future__ import annotations

import io
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from bezsoma.arrays import Numbers
from bezsoma.errors import InputError, MissingExtra
from bezsoma.mesh import TetMesh
from bezsoma.view.grid import Cells, Fields, Grid, mesh_grid
from bezsoma.view.written import written

_VERSION = (2, 2)
"""The layout of VTKHDF that is written; VTK reads it from 9.4 on."""


def write_vtkhdf(
    path: str | Path,
    mesh: TetMesh,
    fields: Fields = None,
    degree: int | None = None,
    *,
    cells: Cells = "lagrange",
    overwrite: bool = False,
    metadata: Mapping[str, Any] | None = None,
) -> Path:
    """Writes the mesh and fields on it as a VTKHDF file; gives the path.

    What is written is that of `write_vtu`, in HDF5: binary, packed array by array, and open to
    every program that reads HDF5. Needs `pip install 'bezsoma[hdf]'`.
    """
    call = "write_vtkhdf(path, mesh, fields)"
    grid = mesh_grid(call, path, mesh, fields, degree, cells, metadata)
    return written(path, _document(grid), overwrite)


def _document(grid: Grid) -> bytes:
    """The HDF5 file of an unstructured grid in one piece."""
    try:
        import h5py
    except ImportError as error:
        raise MissingExtra(
            "VTKHDF files need h5py; run: pip install 'bezsoma[hdf]', or write VTU files"
        ) from error
    text = json.dumps(grid.metadata, ensure_ascii=True, sort_keys=True).encode()
    counts = {
        "NumberOfPoints": len(grid.points),
        "NumberOfCells": len(grid.cells),
        "NumberOfConnectivityIds": grid.cells.size,
    }
    content = io.BytesIO()
    with h5py.File(content, "w") as file:
        root = file.create_group("VTKHDF")
        root.attrs["Version"] = np.array(_VERSION)
        root.attrs.create("Type", np.bytes_("UnstructuredGrid"))
        for name, count in counts.items():
            root[name] = np.array([count])
        _write(root, "Points", grid.points)
        _write(root, "Connectivity", grid.cells.ravel())
        _write(root, "Offsets", grid.offsets)
        _write(root, "Types", grid.types)
        for name, data in (("PointData", grid.point_data), ("CellData", grid.cell_data)):
            group = root.create_group(name)
            for each, array in data.items():
                _write(group, each, array)
        root.create_group("FieldData")["metadata"] = np.frombuffer(text, np.uint8)
    return content.getvalue()


def _write(group: Any, name: str, array: Numbers) -> None:
    """One dataset, packed; a field of one component is a plain list."""
    if "/" in name:
        raise InputError(
            f"a field cannot be called {name!r} in HDF5, where / stands between folders; "
            "give it a name without one"
        )
    flat = array[:, 0] if array.ndim == 2 and array.shape[1] == 1 else array
    group.create_dataset(name, data=flat, compression="gzip", compression_opts=1)
