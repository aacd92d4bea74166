# SPDX-License-Identifier: BSD-3-Clause
"""What VTK is told of a mesh and its fields: cells of the fields' own degree, nothing linearised.

A control is not a value at a point. VTK's Lagrange cells want values, so a field is evaluated at
the lattice points of the written degree; its Bezier cells want controls, so a field is elevated
to that degree. Neither loses anything as long as the degree is not below the field's.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, Literal

import numpy as np

from bezsoma import __version__
from bezsoma.arrays import Bools, Floats, Ints, Numbers
from bezsoma.bernstein import domain_points, elevation, interpolation, values
from bezsoma.errors import InputError, unknown
from bezsoma.mesh import BrokenField, ControlNet, Field, TetMesh
from bezsoma.mesh.nouns import described, field_given, mesh_given, path_given
from bezsoma.mesh.topology import slices
from bezsoma.view.lagrange import vtk_order
from bezsoma.view.lattice import shared_points
from bezsoma.view.restriction import (
    AnyField,
    controls_on,
    degree_of,
    facets_named,
    on_same_mesh,
)

Cells = Literal["lagrange", "bezier"]
Fields = Mapping[str, AnyField] | AnyField | None
_CELL_TYPES = {"lagrange": {2: 69, 3: 71}, "bezier": {2: 76, 3: 78}}
"""VTK's numbers of the triangle and the tetrahedron of each kind."""
_PLAIN = {2: 5, 3: 10}
"""Those of degree 1, which every program knows."""
_Points = tuple[Floats, dict[str, Numbers], Callable[[slice], Ints]]
"""Points (c, 3) in mm, what they bear by name, and the numbers (q, m) of some elements' points."""
_NOTICE = "Research software, not a medical device."


@dataclass(frozen=True, eq=False)
class Grid:
    """An unstructured grid of cells of one type: points in mm, and data by name."""

    points: Floats
    cells: Numbers
    """(e, m) point numbers in VTK's order, whole numbers."""
    cell_type: int
    point_data: Mapping[str, Numbers]
    cell_data: Mapping[str, Numbers]
    metadata: Mapping[str, Any]

    @property
    def offsets(self) -> Numbers:
        """Where each cell begins (e + 1,) in the list of all cells' points, and where it ends."""
        size = self.cells.shape[1]
        kind = np.int32 if self.cells.size < 2**31 else np.int64
        return np.arange(0, (len(self.cells) + 1) * size, size, dtype=kind)

    @property
    def types(self) -> Numbers:
        """The type (e,) of each cell."""
        return np.full(len(self.cells), self.cell_type, np.uint8)


def mesh_grid(
    call: str,
    path: Any,
    mesh: TetMesh,
    given: Fields,
    degree: int | None,
    kind: Cells,
    metadata: Mapping[str, Any] | None,
) -> Grid:
    """The grid of a mesh and fields on it; `call` is what the user wrote, for messages."""
    fields = _checked(call, path, mesh, given, kind)
    chosen = _degree(mesh, fields, degree)
    continuous = {name: field for name, field in fields.items() if isinstance(field, Field)}
    if len(continuous) == len(fields):
        points, data, of_tet = _shared(kind, mesh, continuous, chosen)
    else:
        points, data, of_tet = _tet_by_tet(kind, mesh, fields, chosen)
    return Grid(
        points,
        _cells(of_tet, len(points), chosen, 3, mesh.left_handed),
        _PLAIN[3] if chosen == 1 else _CELL_TYPES[kind][3],
        data,
        {"region": mesh.region.astype(np.min_scalar_type(len(mesh.regions)))},
        _metadata(kind, chosen, metadata, regions=list(mesh.regions)),
    )


def _shared(kind: Cells, mesh: TetMesh, fields: Mapping[str, Field], chosen: int) -> _Points:
    """Points that neighbours share, one a control: each is evaluated once."""
    nets = [field.net for field in fields.values() if field.degree == chosen]
    net = nets[0] if nets else ControlNet(mesh, chosen)
    data = {
        name: net.formed(
            partial(written_form, kind, field.degree, chosen),
            field.controls.reshape(len(field.controls), -1),
            field.net,
        )
        for name, field in fields.items()
    }
    return net.points, data, lambda part: net.closure(3, part)


def _tet_by_tet(kind: Cells, mesh: TetMesh, fields: Mapping[str, AnyField], chosen: int) -> _Points:
    """Points of each tet's own."""
    lattice = domain_points(chosen, 3)
    of_tet = np.arange(len(mesh.tets) * len(lattice)).reshape(-1, len(lattice))
    controls = {name: field.of_tet for name, field in fields.items()}
    data = _data(kind, fields, controls, chosen, 3, of_tet)
    points = _gathered(lattice @ mesh.points[mesh.tets], of_tet)
    return points, data, lambda part: of_tet[part]


def surface_grid(
    call: str,
    path: Any,
    mesh: TetMesh,
    given: Fields,
    surface: str | tuple[str, ...] | None,
    degree: int | None,
    kind: Cells,
    metadata: Mapping[str, Any] | None,
) -> Grid:
    """The grid of a surface and fields on it; there is no cell data."""
    fields = _checked(call, path, mesh, given, kind)
    facets = facets_named(mesh, surface)
    chosen = _degree(mesh, fields, degree)
    of_facet, _ = shared_points(facets, chosen)
    if any(not isinstance(field, Field) for field in fields.values()):
        of_facet = np.arange(of_facet.size).reshape(of_facet.shape)
    a, b = (mesh.points[facets[:, i]] - mesh.points[facets[:, 0]] for i in (1, 2))
    mirrored = np.einsum("fd,fd->f", np.cross(a, b), mesh.normals(facets)) < 0
    controls = {name: controls_on(mesh, field, facets) for name, field in fields.items()}
    return Grid(
        _gathered(domain_points(chosen, 2) @ mesh.points[facets], of_facet),
        _cells(lambda part: of_facet[part], of_facet.size, chosen, 2, mirrored),
        _PLAIN[2] if chosen == 1 else _CELL_TYPES[kind][2],
        _data(kind, fields, controls, chosen, 2, of_facet),
        {},
        _metadata(kind, chosen, metadata, surface=surface if surface is not None else "boundary"),
    )


def written_form(kind: Cells, degree: int, chosen: int, dim: int) -> Floats:
    """The matrix (m', m) from a field's controls to what a cell of the chosen degree holds.

    Values at lattice points, or controls: those of the elevated field, or where the chosen degree
    is lower, of the field that takes its values at the lattice points.

    >>> square = np.array([0.0, 0, 1])                                # t^2 on an edge
    >>> (written_form("lagrange", 2, 2, 1) @ square).tolist()
    [0.0, 0.25, 1.0]
    >>> (written_form("bezier", 2, 3, 1) @ square * 3).tolist()
    [0.0, 0.0, 1.0, 3.0]
    """
    if kind == "bezier" and chosen >= degree:
        return np.asarray(elevation(degree, dim, chosen - degree))
    at_points = values(degree, domain_points(chosen, dim))
    return np.asarray(at_points if kind == "lagrange" else interpolation(chosen, dim) @ at_points)


def _data(
    kind: Cells,
    fields: Mapping[str, AnyField],
    controls: Mapping[str, Floats],
    chosen: int,
    dim: int,
    numbers: Ints,
) -> dict[str, Numbers]:
    """What each point bears, by the name of the field; components in one row."""
    found: dict[str, Numbers] = {}
    for name, field in fields.items():
        own = controls[name]
        form = written_form(kind, degree_of(field), chosen, dim)
        found[name] = _gathered(form @ own.reshape(*own.shape[:2], -1), numbers)
    return found


def _checked(call: str, path: Any, mesh: Any, fields: Any, kind: Any) -> dict[str, AnyField]:
    """The fields by name, once path, mesh, fields and kind are seen to be what they are called."""
    path_given(path, call)
    mesh_given(mesh, call)
    if kind not in _CELL_TYPES:
        raise InputError(unknown("kind of cells", kind, _CELL_TYPES, "VTK"))
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


def _cells(
    of_element: Callable[[slice], Ints], points: int, degree: int, dim: int, mirrored: Bools
) -> Numbers:
    """Point numbers (e, m) in VTK's order, every cell right-handed (a surface: outwards)."""
    plain, other = (vtk_order(degree, dim, flip) for flip in (False, True))
    kind = np.int32 if points < 2**31 else np.int64
    cells = np.empty((len(mirrored), len(plain)), kind)
    for part in slices(len(cells)):
        numbers, turned = of_element(part), mirrored[part]
        cells[part] = numbers[:, plain]
        cells[part][turned] = numbers[turned][:, other]
    return cells


def _metadata(
    kind: Cells, degree: int, given: Mapping[str, Any] | None, **own: Any
) -> dict[str, Any]:
    """What a reader of the file must know; `given` adds to it and cannot replace it."""
    return {
        **(given or {}),
        "software": f"bezsoma {__version__}",
        "notice": _NOTICE,
        "length unit": "mm",
        "frame": "LPS (x to the patient's left, y to posterior, z to superior)",
        "degree": degree,
        "point data": "controls" if kind == "bezier" else "values",
        **own,
    }
