# SPDX-License-Identifier: BSD-3-Clause
"""The tetrahedral mesh: points, tets, named regions and named places."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType
from typing import Any

import numpy as np
import numpy.typing as npt

from bezsoma import _core
from bezsoma.arrays import Bools, Floats, Int32s, Ints, frozen
from bezsoma.errors import InputError, MeshError, unknown
from bezsoma.mesh import checks, places
from bezsoma.mesh.morton import morton_order
from bezsoma.mesh.topology import (
    EDGES,
    FACES,
    cross,
    determinants,
    simplices,
    slices,
)

_NONE: Mapping[str, npt.ArrayLike] = MappingProxyType({})


@dataclass(frozen=True, eq=False, init=False, repr=False)
class TetMesh:
    """A mesh of straight tets: points (v, 3) in mm, tets (t, 4), named regions and places.

    Every row of vertex numbers is ascending. Two neighbours therefore name a shared edge or face
    by the same row, and no code below has to turn or mirror anything; a tet may be given either
    way round. A *place* is a named surface (facets), edge (mesh edges) or vertex: what supports
    and loads act on. Coordinates are LPS: x to the patient's left, y to posterior, z to superior.

    Beware: points that no tet uses are dropped (`dropped` counts them) and the rest renumbered,
    keeping their order. Arrays are copies and read-only. What is refused and why: `checks`.

    The volume is the flux of x/3 through the boundary (Gauss), whatever the frame:

    >>> mesh = TetMesh(np.eye(4, 3) + 1000.0, [[3, 1, 0, 2]])
    >>> skin = mesh.boundary
    >>> corner = mesh.points[skin[:, 0]] - 1000.0
    >>> flux = np.einsum("fd,fd,f->", corner, mesh.normals(skin), mesh.areas(skin))
    >>> bool(abs(flux / 3 - mesh.volumes.sum()) < 1e-15), bool(mesh.volumes[0] == 1 / 6)
    (True, True)
    """

    points: Floats
    """(v, 3) mm, LPS."""
    tets: Ints
    """(t, 4) vertex numbers, every row ascending."""
    region: Ints
    """(t,) an index into `regions`."""
    regions: tuple[str, ...]
    surfaces: Mapping[str, Ints]
    """Facets (f, 3) of each named surface, rows ascending; usually on the boundary."""
    edges: Mapping[str, Ints]
    """Mesh edges (e, 2) of each named edge place, rows ascending."""
    vertices: Mapping[str, Ints]
    """Vertex numbers (k,) of each named vertex place, ascending."""
    left_handed: Bools
    """Whether det[p1 - p0, p2 - p0, p3 - p0] < 0, (t,), decided without rounding errors."""
    dropped: int
    """How many of the points given belonged to no tet."""
    face_count: int
    """How many faces there are; `all_faces` finds them."""
    _part: Int32s

    def __init__(
        self,
        points: npt.ArrayLike,
        tets: npt.ArrayLike,
        region: npt.ArrayLike | None = None,
        regions: Sequence[str] = ("tissue",),
        surfaces: Mapping[str, npt.ArrayLike] = _NONE,
        edges: Mapping[str, npt.ArrayLike] = _NONE,
        vertices: Mapping[str, npt.ArrayLike] = _NONE,
    ) -> None:
        given = checks.point_array(points)
        rows = checks.tet_array(tets, len(given))
        names = checks.region_names(regions)
        numbers = checks.region_array(region, len(rows), names)
        signs = checks.shape(given, rows)
        used = np.zeros(len(given), bool)
        used[rows] = True
        renumbered = np.cumsum(used) - 1
        self._hold(
            points=frozen(given if used.all() else given[used]),
            tets=frozen(rows if used.all() else renumbered[rows]),
            region=frozen(numbers),
            regions=names,
            left_handed=frozen(signs < 0),
            dropped=int((~used).sum()),
        )
        self._hold(face_count=len(self.all_faces))
        pairs, sound = _core.neighbours(self.faces_of_tet, len(self.all_faces), signs)
        self._hold(tets_of_face=frozen(pairs), _part=_core.components(pairs, len(rows)))
        if not sound:
            faces = checks.Faces(self.tets, self.all_faces, self.faces_of_tet)
            checks.topology(faces, signs, np.flatnonzero(used))
        checks.one_namespace(surface=surfaces, edge=edges, vertex=vertices)
        self._hold_places(surfaces, edges, vertices, np.where(used, renumbered, -1))
        for found_again in ("_faces", "tets_of_face"):  # quickly; held, they are much of the memory
            del self.__dict__[found_again]

    def _hold(self, **values: Any) -> None:
        for name, value in values.items():
            object.__setattr__(self, name, value)

    def _hold_places(
        self,
        surfaces: Mapping[str, npt.ArrayLike],
        edges: Mapping[str, npt.ArrayLike],
        vertices: Mapping[str, npt.ArrayLike],
        renumbered: Ints,
    ) -> None:
        """Places come in the given numbering, where messages speak; they are kept in ours."""
        of_faces, of_edges, of_vertices = {}, {}, {}
        for name, given in surfaces.items():
            of_faces[name] = places.facets_given(name, given, renumbered, self.all_faces)
        for name, given in edges.items():
            of_edges[name] = places.edges_given(name, given, renumbered, self.all_edges)
        for name, given in vertices.items():
            of_vertices[name] = places.vertices_given(name, given, renumbered)
        self._hold(
            surfaces=MappingProxyType(of_faces),
            edges=MappingProxyType(of_edges),
            vertices=MappingProxyType(of_vertices),
        )

    def __repr__(self) -> str:
        named = f", places {list(self.places)}" if self.places else ""
        dropped = f", {self.dropped} unused points dropped" if self.dropped else ""
        return (
            f"TetMesh({len(self.points)} vertices, {len(self.tets)} tets, "
            f"regions {list(self.regions)}{named}{dropped})"
        )

    def __reduce__(self) -> tuple[Any, ...]:
        kinds = (dict(self.surfaces), dict(self.edges), dict(self.vertices))
        return TetMesh, (self.points, self.tets, self.region, self.regions, *kinds)

    # Shape ----------------------------------------------------------------------------------

    @cached_property
    def volumes(self) -> Floats:
        """The volume (t,) of each tet in mm3, positive."""
        return frozen(self._volumes())

    def _volumes(self) -> Floats:
        """The same, not kept."""
        found = np.empty(len(self.tets))
        for part in slices(len(self.tets)):
            found[part] = np.abs(determinants(self.points[self.tets[part]])) / 6.0
        return found

    @property
    def mean_size(self) -> float:
        """The edge, mm, of the cube that is as large as a tet on the average; volumes not kept."""
        # Not by way of the cache: another thread may use, or just then fill, what is kept there.
        kept = self.__dict__.get("volumes")
        return float(np.cbrt((self._volumes() if kept is None else kept).mean()))

    @cached_property
    def gradients(self) -> Floats:
        """The gradients (t, 4, 3) of the barycentric coordinates L_i in 1/mm.

        grad L_1 = (p2 - p0) x (p3 - p0) / det and cyclic, grad L_0 = -(the sum of the others),
        so that the four add up to nothing and a translation strains nothing. They do the
        work of the inverse Jacobian (paper, eq. 56) and are the dual basis of the edges:

        >>> mesh = TetMesh([[0, 0, 0], [2, 0, 0], [1, 3, 0], [1, 1, 4.0]], [[0, 1, 2, 3]])
        >>> edges = mesh.points[1:] - mesh.points[0]
        >>> bool(np.abs(edges @ mesh.gradients[0, 1:].T - np.eye(3)).max() < 1e-15)
        True
        """
        return frozen(self.gradients_of(slice(None)))

    def gradients_of(self, tets: Ints | slice) -> Floats:
        """The same of some tets (q, 4, 3), not kept."""
        if "gradients" in self.__dict__:
            return self.gradients[tets]
        corners = self.points[self.tets[tets]]
        a, b, c = (corners[:, i] - corners[:, 0] for i in (1, 2, 3))
        found = np.empty((len(corners), 4, 3))
        found[:, 1], found[:, 2], found[:, 3] = cross(b, c), cross(c, a), cross(a, b)
        found[:, 1:] /= np.einsum("td,td->t", a, found[:, 1])[:, None, None]
        found[:, 0] = -found[:, 1:].sum(axis=1)
        return found

    @cached_property
    def morton(self) -> Ints:
        """The numbers of the tets in the Morton order of their centroids, (t,)."""
        centroids = np.empty((len(self.tets), 3))
        for part in slices(len(self.tets)):
            centroids[part] = self.points[self.tets[part]].mean(axis=1)
        return frozen(morton_order(centroids))

    @property
    def oriented_tets(self) -> Ints:
        """The tets (t, 4) turned so that det[p1 - p0, p2 - p0, p3 - p0] > 0, for other programs.

        >>> mesh = TetMesh(np.eye(4, 3), [[0, 1, 2, 3]])
        >>> mesh.oriented_tets.tolist()
        [[0, 1, 3, 2]]
        """
        return np.where(self.left_handed[:, None], self.tets[:, [0, 1, 3, 2]], self.tets)

    @property
    def box(self) -> Floats:
        """The least and the largest coordinates (2, 3) in mm."""
        return np.stack([self.points.min(axis=0), self.points.max(axis=0)])

    def areas(self, facets: npt.ArrayLike) -> Floats:
        """The areas (f,) in mm2 of facets (f, 3)."""
        a, b, c = self._corners(facets)
        return np.asarray(np.linalg.norm(cross(b - a, c - a), axis=1) / 2.0)

    def normals(self, facets: npt.ArrayLike) -> Floats:
        """The outward unit normals (f, 3) of facets (f, 3) on the boundary.

        A facet between two tets has no outward side and is refused.
        """
        faces = self._face_numbers(facets)
        inner = np.flatnonzero(self.tets_of_face[faces, 1] >= 0)
        if len(inner):
            raise MeshError(
                f"facet {checks.listed(inner)} lies between two tets and has no outward side; "
                "normals are known for facets of `boundary` only"
            )
        return self._normals(faces)

    def outward(self, facets: npt.ArrayLike) -> Ints:
        """Facets (f, 3) turned so that (b - a) x (c - a) points out of the mesh.

        One between two tets is turned out of the tet with the lower number.
        """
        faces = self._face_numbers(facets)
        rows = self.all_faces[faces].astype(np.int64)
        a, b, c = (self.points[rows[:, i]] for i in range(3))
        inward = np.einsum("fd,fd->f", cross(b - a, c - a), self._normals(faces)) < 0
        return np.where(inward[:, None], rows[:, [0, 2, 1]], rows)

    def _normals(self, faces: Ints) -> Floats:
        """Unit normals (f, 3) of faces by number, out of the first tet of each."""
        rows, tets = self.all_faces[faces], self.tets[self.tets_of_face[faces, 0]]
        a, b, c = (self.points[rows[:, i]] for i in range(3))
        normal = cross(b - a, c - a)
        normal /= np.linalg.norm(normal, axis=1)[:, None]
        opposite = self.points[tets.sum(axis=1) - rows.sum(axis=1)]
        inward = np.einsum("fd,fd->f", normal, opposite - a) > 0
        return np.where(inward[:, None], -normal, normal)

    def _corners(self, facets: npt.ArrayLike) -> tuple[Floats, Floats, Floats]:
        rows = checks.index_rows(facets, 3, len(self.points), "facet", "vertex")
        return self.points[rows[:, 0]], self.points[rows[:, 1]], self.points[rows[:, 2]]

    # Topology -------------------------------------------------------------------------------

    # 32 bits: at degree 1 these arrays are a good part of what a problem takes.

    @cached_property
    def _edges(self) -> tuple[Int32s, Int32s]:
        return simplices(self.tets, EDGES, len(self.points))

    @cached_property
    def _faces(self) -> tuple[Int32s, Int32s]:
        return simplices(self.tets, FACES, len(self.points))

    @property
    def all_edges(self) -> Int32s:
        """Every edge (e, 2) once, rows ascending, in lexicographic order."""
        return self._edges[0]

    @property
    def all_faces(self) -> Int32s:
        """Every face (f, 3) once, rows ascending, in lexicographic order."""
        return self._faces[0]

    @property
    def edges_of_tet(self) -> Int32s:
        """The edges (t, 6) of each tet, numbers into `all_edges`: 01, 02, 03, 12, 13, 23."""
        return self._edges[1]

    @property
    def faces_of_tet(self) -> Int32s:
        """The faces (t, 4) of each tet, numbers into `all_faces`: face i is opposite vertex i."""
        return self._faces[1]

    @cached_property
    def tets_of_face(self) -> Int32s:
        """The tets (f, 2) at each face, the lower number first, -1 where there is no second."""
        signs = np.ones(len(self.tets), np.int8)  # the mesh was checked
        return frozen(_core.neighbours(self.faces_of_tet, len(self.all_faces), signs)[0])

    @cached_property
    def boundary(self) -> Ints:
        """The facets (b, 3) that only one tet has, in lexicographic order."""
        return frozen(self.all_faces[self.tets_of_face[:, 1] < 0].astype(np.int64))

    def components(self) -> Ints:
        """The part (t,) that each tet belongs to, 0, 1, ...; parts hang together by faces.

        Tets that share only a vertex or an edge are hinges, not one part.
        """
        return self._part.astype(np.int64)

    def tets_of_facets(self, facets: npt.ArrayLike) -> Ints:
        """The tet (f,) that has each facet (f, 3); of two, the one with the lower number."""
        return np.asarray(self.tets_of_face[self._face_numbers(facets), 0], np.int64)

    def _face_numbers(self, facets: npt.ArrayLike) -> Ints:
        return places.face_numbers(facets, self.all_faces, len(self.points))

    # Places ---------------------------------------------------------------------------------

    @property
    def places(self) -> tuple[str, ...]:
        """All names: surfaces, then edges, then vertices."""
        return (*self.surfaces, *self.edges, *self.vertices)

    def place_kind(self, name: str) -> str:
        """What a name stands for: "surface", "edge" or "vertex"."""
        for kind, named in self._kinds.items():
            if name in named:
                return kind
        raise InputError(unknown("place", name, self.places, "this mesh"))

    @property
    def _kinds(self) -> Mapping[str, Mapping[str, Ints]]:
        return {"surface": self.surfaces, "edge": self.edges, "vertex": self.vertices}

    def facets_of(self, name: str) -> Ints:
        """The facets (f, 3) of a surface."""
        if name not in self.surfaces:
            raise InputError(unknown("surface", name, self.surfaces, "this mesh"))
        return self.surfaces[name]

    def vertices_of(self, name: str) -> Ints:
        """The vertices (k,) of any place, ascending: those of its facets or edges included."""
        return np.asarray(np.unique(self._kinds[self.place_kind(name)][name]))

    def with_surface(self, name: str, facets: npt.ArrayLike | Callable[[Floats], Bools]) -> TetMesh:
        """This mesh with one more surface: facets (f, 3), or a rule for the boundary's.

        A rule takes points (p, 3) in mm and gives p times True or False; a facet is taken where
        all three corners give True.

        >>> cube = TetMesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]], [[0, 1, 2, 3]])
        >>> cube.with_surface("floor", lambda x: x[:, 2] == 0).surfaces["floor"].tolist()
        [[0, 1, 2]]
        """
        if callable(facets):
            facets = places.facets_where(facets, self.points, self.boundary, name)
        rows = places.facets_given(name, facets, np.arange(len(self.points)), self.all_faces)
        return self._with("surface", name, rows)

    def with_edges(self, name: str, line: npt.ArrayLike) -> TetMesh:
        """This mesh with one more edge place: a polyline through points (k, 3) in mm.

        Integers (e, 2) are taken as mesh edges by their vertex numbers.
        """
        given = np.asarray(line)
        if given.dtype.kind in "iu" and given.shape[1:] == (2,):
            rows = given
        else:
            rows = places.edges_along(given.astype(float), self.points, self.all_edges, name)
        rows = places.edges_given(name, rows, np.arange(len(self.points)), self.all_edges)
        return self._with("edge", name, rows)

    def with_vertices(
        self, name: str, points: npt.ArrayLike = (), *, numbers: npt.ArrayLike = ()
    ) -> TetMesh:
        """This mesh with one more vertex place: the vertices at points (k, 3) in mm.

        `numbers` (k,) takes vertices by their numbers instead, or as well.
        """
        places_given = np.atleast_2d(np.asarray(points, dtype=float))
        found = np.zeros(0, np.int64)
        if places_given.size:
            found = places.vertices_at(places_given, self.points, name)
        known = checks.index_array(numbers, len(self.points), f"vertices of {name!r}", "vertex")
        chosen = np.concatenate([found, known.reshape(-1)])
        rows = places.vertices_given(name, chosen, np.arange(len(self.points)))
        return self._with("vertex", name, rows)

    def _with(self, kind: str, name: str, rows: Ints) -> TetMesh:
        """A copy that shares all else, cached topology included: nothing is checked twice."""
        if checks.place_name(name, kind) in self.places:
            raise MeshError(f"this mesh has a place {name!r} already; take another name")
        other = object.__new__(TetMesh)
        other.__dict__.update(self.__dict__)
        field = {"surface": "surfaces", "edge": "edges", "vertex": "vertices"}[kind]
        other._hold(**{field: MappingProxyType({**self._kinds[kind], name: frozen(rows)})})
        return other

    def moved(
        self, matrix: npt.ArrayLike = ((1, 0, 0), (0, 1, 0), (0, 0, 1)), shift: npt.ArrayLike = 0.0
    ) -> TetMesh:
        """This mesh with every point x at `matrix` x + `shift` (mm); places stay as they are.

        The matrix (3, 3) may turn, mirror, scale or shear; one that flattens is refused.
        """
        turn, step = np.asarray(matrix, float), np.asarray(shift, float)
        if turn.shape != (3, 3) or step.shape not in ((), (3,)):
            raise InputError(
                f"a matrix of the shape {turn.shape} and a shift of the shape {step.shape} were "
                "given; (3, 3) and (3,) are needed"
            )
        _, (_, *rest) = self.__reduce__()
        return TetMesh(self.points @ turn.T + step, *rest)
