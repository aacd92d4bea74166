# SPDX-License-Identifier: BSD-3-Clause
"""Fields on facets: the controls of a face are controls of the tet, so nothing is computed."""

from __future__ import annotations

import numpy as np

from bezsoma.arrays import Floats, Ints, Numbers
from bezsoma.bernstein import trace, values
from bezsoma.errors import InputError, unknown
from bezsoma.mesh import BrokenField, Field, TetMesh

AnyField = Field | BrokenField


def degree_of(field: AnyField) -> int:
    """The polynomial degree of a field, continuous or broken."""
    return field.net.degree if isinstance(field, Field) else field.degree


def on_same_mesh(mesh: TetMesh, field: AnyField, name: str) -> None:
    """Refuses a field that lives on another mesh: its controls would be read as this one's."""
    other = field.net.mesh if isinstance(field, Field) else field.mesh
    same = other is mesh or (
        other.points.shape == mesh.points.shape
        and other.tets.shape == mesh.tets.shape
        and np.array_equal(other.tets, mesh.tets)
        and np.array_equal(other.points, mesh.points)
    )
    if not same:
        raise InputError(
            f"field {name!r} lives on another mesh ({len(other.tets)} tets, {len(other.points)} "
            f"points) than the one to be drawn ({len(mesh.tets)} tets, {len(mesh.points)} points);"
            " give the mesh that the field was computed on"
        )


def facets_named(mesh: TetMesh, surface: str | tuple[str, ...] | None) -> Ints:
    """Facets (f, 3) of one named surface, of several, or with None of the whole boundary."""
    if surface is None:
        return mesh.boundary
    names = (surface,) if isinstance(surface, str) else surface
    for name in names:
        if name not in mesh.surfaces:
            raise InputError(unknown("surface", name, mesh.surfaces, "this mesh"))
    if not names:
        raise InputError("no surface was named; name one, or give None for the whole boundary")
    return np.unique(np.concatenate([mesh.facets_of(name) for name in names]), axis=0)


def controls_on(mesh: TetMesh, field: AnyField, facets: Ints) -> Floats:
    """Controls (f, m2, k...) of the field restricted to facets (f, 3) with ascending vertices.

    The restriction of a Bernstein polynomial to a face keeps the controls of that face. A broken
    field has a value from either side of an inner facet; that of the lower-numbered tet counts.
    """
    if isinstance(field, Field):
        controls = np.asarray(field.controls)
        return np.asarray(controls[field.net.of_facets(facets)])
    tets = mesh.tets_of_facets(facets)
    every = np.asarray(field.controls)
    local = (mesh.tets[tets][:, None, :] == facets[:, :, None]).argmax(axis=2)
    found = np.empty((len(facets), (field.degree + 1) * (field.degree + 2) // 2, *every.shape[2:]))
    for corners in {tuple(row) for row in local.tolist()}:
        mine = (local == corners).all(axis=1)
        place = trace(field.degree, 3, corners)
        found[mine] = every[tets[mine]][:, place]
    return found


def values_at(degree: int, controls: Numbers, bary: Floats) -> Floats:
    """Values (e, q, k) at barycentric points (q, d + 1) of elements with controls (e, m, ...).

    The components of each control are laid out in one row of k. One product with a constant
    matrix does all elements: here x y over a triangle, whose only control is that of the edge.

    >>> controls = np.array([[0, 0.5, 0, 0, 0, 0]])
    >>> values_at(2, controls, np.array([[0.25, 0.75, 0.0], [0.5, 0.25, 0.25]])).ravel().tolist()
    [0.1875, 0.125]
    """
    flat = np.asarray(controls, float).reshape(len(controls), controls.shape[1], -1)
    return np.asarray(values(degree, bary) @ flat)
