# SPDX-License-Identifier: BSD-3-Clause
"""Which control belongs to which tet: the numbering of the Bernstein coefficients of a mesh.

A polynomial of degree n on a tet has a control b_alpha for each multi-index |alpha| = n, at the
domain point sum_i (alpha_i / n) v_i.  The indices that are zero say where it belongs: to a
vertex, an edge, a face or the interior.  Two tets that share a face share its controls, and that
is all there is to continuity.  Because the vertices of every tet ascend, two tets see a shared
edge or face in the same order, and no orientation has to be kept anywhere.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from math import comb

import numpy as np

from bezsoma import _core, bernstein
from bezsoma.arrays import Floats, Int32s, Ints, frozen
from bezsoma.errors import InputError
from bezsoma.mesh.functions import Function, sampled
from bezsoma.mesh.parts import inside, interpolation_inside, owners, rows_applied
from bezsoma.mesh.tets import TetMesh
from bezsoma.mesh.topology import numbers as numbers_among
from bezsoma.mesh.topology import slices

LARGEST_DEGREE = 10
MOST_CONTROLS = 2**31 - 1
EDGES_OF_FACES = np.array([(3, 4, 5), (1, 2, 5), (0, 2, 4), (0, 1, 3)])
"""The local edges (01), (02), (12) of each local face of a tet."""
CHUNK = 1 << 16
"""Entities handled at a time, so that scratch arrays stay small beside the answer."""


@dataclass(frozen=True, eq=False)
class ControlNet:
    """The controls of all polynomials of one degree (1 to 10) that are continuous on a mesh.

    Controls are numbered entity by entity (vertex, edge, face, interior), each entity in one run;
    the entities in the order in which a walk over the tets in Morton order first touches them.
    So a tet's controls lie in few, near runs of memory, which is what an operator that gathers
    tet by tet wants, and a block of a preconditioner is a range.  Beware: vertex v of the mesh is
    *not* control v, not even at degree 1; ask `of_vertices`.

    >>> from bezsoma.mesh.solids import block
    >>> mesh = block(cells=(2, 2, 2))
    >>> v, e, f, t = (len(x) for x in (mesh.points, mesh.all_edges, mesh.all_faces, mesh.tets))
    >>> all(ControlNet(mesh, n).count == v + e * (n - 1) + f * (n - 1) * (n - 2) // 2
    ...     + t * (n - 1) * (n - 2) * (n - 3) // 6 for n in range(1, 11))
    True
    """

    mesh: TetMesh
    degree: int

    def __post_init__(self) -> None:
        whole = isinstance(self.degree, int | np.integer) and not isinstance(self.degree, bool)
        if not whole or not 1 <= self.degree <= LARGEST_DEGREE:
            raise InputError(
                f"degree {self.degree!r} cannot be used; give a whole number 1 to {LARGEST_DEGREE}"
            )
        object.__setattr__(self, "degree", int(self.degree))

    @property
    def sizes(self) -> tuple[int, int, int, int]:
        """The controls inside one vertex, edge, face and tet: C(n-1, d) for d = 0 to 3."""
        inner = self.degree - 1
        return comb(inner, 0), comb(inner, 1), comb(inner, 2), comb(inner, 3)

    @cached_property
    def count(self) -> int:
        """The number c of controls."""
        return sum(len(starts) * self.sizes[dim] for dim, starts in enumerate(self.starts))

    @property
    def morton(self) -> Ints:
        """The numbers of the tets in the Morton order of their centroids, (t,)."""
        return self.mesh.morton

    @cached_property
    def starts(self) -> tuple[Ints, ...]:
        """The first control of each vertex (v,), edge (e,), face (f,) and tet (t,).

        The run of entity i of dimension d is starts[d][i] + 0, 1, ..., sizes[d] - 1.  Dimensions
        whose entities hold no control inside (edges at degree 1, ...) are left out.
        """
        mesh, dims = self.mesh, self._dims(3)
        counts = [self._entities(dim) if dim in dims else 0 for dim in range(4)]
        edges = mesh.edges_of_tet if 1 in dims else None
        faces = mesh.faces_of_tet if 2 in dims else None
        starts = _core.first_controls(self.morton, mesh.tets, edges, faces, counts, self.sizes)
        return tuple(frozen(part) for part in np.split(starts, np.cumsum(counts)[: len(dims) - 1]))

    def walked(self) -> Int32s:
        """The first control of each vertex, edge, face and interior of each tet (t, e).

        Only of the kinds that hold controls inside, as in `starts`; tets in the order `morton`.
        """
        if self.count > MOST_CONTROLS:
            raise InputError(
                f"{self.count} controls of degree {self.degree} are more than the {MOST_CONTROLS} "
                "that are counted in 32 bits; take a lower degree or a coarser mesh"
            )
        parts = sum((4, 6, 4, 1)[: len(self._dims(3))])
        first = np.empty((len(self.mesh.tets), parts), np.int32)
        for part in slices(len(first)):
            runs = self._starts_of(3, self.morton[part])
            np.concatenate(runs, axis=1, out=first[part], casting="same_kind")
        return first

    @cached_property
    def of_tet(self) -> Ints:
        """The controls of each tet (t, m), in the order of the tet's multi-indices."""
        return frozen(self.closure(3))

    @property
    def points(self) -> Floats:
        """The domain point of each control (c, 3) in mm; formed anew at each call, not kept."""
        points = np.empty((self.count, 3))
        for dim, numbers, own in self._runs():
            rows = bernstein.domain_points(self.degree, dim)[inside(self.degree, dim)]
            points[own] = rows_applied(rows, self.mesh.points, self._parts(dim, 0, numbers))
        return frozen(points)

    def closure(self, dim: int, numbers: Ints | slice = slice(None)) -> Ints:
        """All controls on the entities of dimension dim with these numbers (q, m_dim).

        The numbers count vertices, `mesh.all_edges`, `mesh.all_faces` or tets; the columns follow
        the entity's own multi-indices, so they hold its vertices, edges and so on as well.
        """
        part, rank = owners(self.degree, dim)
        controls = np.concatenate(self._starts_of(dim, numbers), axis=1)[:, part]
        controls += rank
        return controls

    def of_vertices(self, vertices: Ints) -> Ints:
        """The control of each vertex, of the shape of the vertices."""
        return self.starts[0][vertices]

    def of_edges(self, edges: Ints) -> Ints:
        """The controls of each edge (e, n + 1), for edges (e, 2) with ascending vertices."""
        return self.closure(1, self.edge_numbers(edges))

    def of_facets(self, facets: Ints) -> Ints:
        """The controls of each facet (f, m2), for facets (f, 3) with ascending vertices.

        Those of degree 1 are its vertices' own, so that nothing is looked up.
        """
        if self.degree == 1:
            return self.of_vertices(facets)
        return self.closure(2, self.face_numbers(facets))

    def edge_numbers(self, edges: Ints) -> Ints:
        """The number of each edge (e, 2) in `mesh.all_edges`, (e,)."""
        return self._found("edge", edges, self.mesh.all_edges)

    def face_numbers(self, facets: Ints) -> Ints:
        """The number of each facet (f, 3) in `mesh.all_faces`, (f,)."""
        return self._found("facet", facets, self.mesh.all_faces)

    def edges_of_faces(self, faces: Ints | slice) -> Int32s:
        """The numbers of the edges (01), (02), (12) of faces with these numbers (f, 3)."""
        mesh = self.mesh
        tet = mesh.tets_of_face[faces, 0]
        numbers = np.arange(len(mesh.all_faces))[faces]
        local = (mesh.faces_of_tet[tet] == numbers[:, None]).argmax(axis=1)
        return np.asarray(mesh.edges_of_tet[tet[:, None], EDGES_OF_FACES[local]])

    def of_place(self, name: str) -> Ints:
        """The controls on the closure of a named place, ascending (q,).

        The closure of a surface holds the controls of its facets, their edges and vertices.
        """
        entities = self.entities_of_place(name)
        top = max(entities)
        return np.unique(self.closure(top, entities[top]))

    def entities_of_place(self, name: str) -> Mapping[int, Ints]:
        """Dimension -> the numbers, ascending, of the vertices, edges and faces of a place.

        At degree 1 the vertices alone: no other control is there.
        """
        kind, vertices = self.mesh.place_kind(name), self.mesh.vertices_of(name)
        if kind == "vertex" or self.degree == 1:
            return {0: vertices}
        if kind == "edge":
            return {0: vertices, 1: np.unique(self.edge_numbers(self.mesh.edges[name]))}
        faces = np.unique(self.face_numbers(self.mesh.surfaces[name]))
        return {0: vertices, 1: np.unique(self.edges_of_faces(faces)), 2: faces}

    def interpolated(self, function: Function | Floats) -> Floats:
        """The controls (c, ...) of the field that takes the given values in all domain points.

        A control is no value at a point: values are turned into controls.  This is done for each
        vertex, edge, face and interior from the values on the closure of that entity alone, so
        that neighbours agree to the last bit; a polynomial of degree n or less comes back.

        Args:
            function: a function of points (p, 3) in mm that gives (p,) or (p, k), or its values
                in `points`, (c,) or (c, k).
        """
        values = sampled(function, self.points)
        controls = np.empty_like(values)
        for dim, numbers, own in self._runs():
            rows = interpolation_inside(self.degree, dim)
            controls[own] = rows_applied(rows, values, self.closure(dim, numbers))
        return controls

    def interpolated_on(self, name: str, function: Function) -> tuple[Ints, Floats]:
        """The controls of a place, ascending (q,), and their values (q, ...) for a function.

        The same conversion as `interpolated`, with the function evaluated only on the place.
        Beware: the two agree up to the rounding of a sum, not bit for bit.
        """
        entities = self.entities_of_place(name)
        on = self.of_place(name)
        values = sampled(function, self.points[on])
        within = np.empty(self.count, dtype=np.int64)
        within[on] = np.arange(len(on))
        controls = np.empty_like(values)
        for dim, numbers, own in self._runs(entities):
            rows = interpolation_inside(self.degree, dim)
            closure = within[self.closure(dim, numbers)]
            controls[within[own]] = rows_applied(rows, values, closure)
        return on, controls

    def elevated(self, controls: Floats, source: ControlNet) -> Floats:
        """The controls here (c, ...) of the field that has the given ones on a lower net."""
        by = self.degree - source.degree
        return self.formed(
            lambda dim: bernstein.elevation(source.degree, dim, by), controls, source
        )

    def formed(self, form: Callable[[int], Floats], controls: Floats, source: ControlNet) -> Floats:
        """What matrices make of controls on another net of the mesh (c, ...), each row once.

        form(dim) (m, m') takes the source's controls on a simplex of that dimension to what stands
        there in place of ours; of its rows those inside the simplex are used.
        """
        made = np.empty((self.count, *controls.shape[1:]))
        for dim, numbers, own in self._runs():
            rows = form(dim)[inside(self.degree, dim)]
            made[own] = rows_applied(rows, controls, source.closure(dim, numbers))
        return made

    def _dims(self, dim: int) -> range:
        """The dimensions up to dim whose entities hold controls inside."""
        return range(min(dim, self.degree - 1) + 1)

    def _entities(self, dim: int) -> int:
        if dim in (0, 3):
            return len(self.mesh.tets if dim else self.mesh.points)
        return len(self.mesh.all_edges if dim == 1 else self.mesh.all_faces)

    def _starts_of(self, dim: int, numbers: Ints | slice) -> list[Ints]:
        """The first controls (q, r) of the parts of some entities, a list over `_dims(dim)`."""
        return [self.starts[d][self._parts(dim, d, numbers)] for d in self._dims(dim)]

    def _parts(self, dim: int, part: int, numbers: Ints | slice) -> Ints | Int32s:
        """The numbers (q, r) of the parts of dimension `part` of some entities of a dimension."""
        mesh = self.mesh
        if dim == part:
            return np.arange(self._entities(dim))[numbers, None]
        if part == 2:
            return mesh.faces_of_tet[numbers]
        if part == 1:
            return mesh.edges_of_tet[numbers] if dim == 3 else self.edges_of_faces(numbers)
        rows = mesh.tets if dim == 3 else mesh.all_faces if dim == 2 else mesh.all_edges
        return rows[numbers]

    def _runs(self, entities: Mapping[int, Ints] | None = None) -> Iterator[tuple[int, Ints, Ints]]:
        """Chunks of entities: dimension, numbers (q,), the controls inside them (size, q)."""
        for dim in self._dims(3):
            if entities is not None and dim not in entities:
                continue
            chosen = np.arange(self._entities(dim)) if entities is None else entities[dim]
            for begin in range(0, len(chosen), CHUNK):
                numbers = chosen[begin : begin + CHUNK]
                yield dim, numbers, self.starts[dim][numbers] + np.arange(self.sizes[dim])[:, None]

    def _found(self, what: str, rows: Ints, among: Int32s) -> Ints:
        found = numbers_among(np.asarray(rows), among)
        missing = np.flatnonzero(found < 0)
        if len(missing):
            raise InputError(
                f"{what} {np.asarray(rows)[missing[0]].tolist()} belongs to no tet of this mesh "
                f"({len(missing)} of {len(rows)} such); its vertices have to ascend"
            )
        return found
