# SPDX-License-Identifier: BSD-3-Clause
"""A displaced surface as triangles, no farther from its polynomials than stated, and no cracks.

The corners of the triangles lie on the exact patches (paper, eq. 58). How often an edge is cut
follows from the controls of that edge alone, so all facets around it agree, even those of another
surface that is cut separately; the points on it are evaluated once. Inside, each facet is cut as
finely as its own controls ask for (`chords`, `cuts`). Only where no lattice inside would do, an
edge is cut more often, and all facets of the surface around it follow.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from bezsoma.arrays import Bools, Floats, Ints, T, frozen
from bezsoma.bernstein import trace
from bezsoma.errors import InputError
from bezsoma.mesh import SurfaceField
from bezsoma.mesh.surface_field import patch_normals
from bezsoma.mesh.topology import packed
from bezsoma.view.chords import bends
from bezsoma.view.cuts import STEPS, Cut, cut, inside_edge
from bezsoma.view.fineness import edge_parts, insides, kinds, refuse_too_fine
from bezsoma.view.lattice import SIDES
from bezsoma.view.restriction import values_at


@dataclass(frozen=True, eq=False)
class Alike:
    """Facets that are cut alike."""

    cut: Cut
    facets: Ints
    """(g,) rows of the surface."""
    points: Ints
    """(g, s) the point that each sample is."""


@dataclass(frozen=True, eq=False)
class Tessellation:
    """Triangles no farther from a displaced surface than the tolerance; see `tessellation`."""

    surface: SurfaceField
    scale: float
    tolerance: float
    points: Floats
    """(p, 3) mm, each once: triangles that touch share them."""
    triangles: Ints
    """(r, 3) points, counterclockwise seen from outside."""
    groups: tuple[Alike, ...]

    @cached_property
    def facet(self) -> Ints:
        """The facet (r,) that each triangle lies on, a row of `surface.facets`."""
        return np.concatenate(
            [np.repeat(group.facets, len(group.cut.triangles)) for group in self.groups]
        )

    @cached_property
    def bary(self) -> Floats:
        """Where on their facet the corners of the triangles lie (r, 3, 3), barycentric."""
        return self._corners(
            [
                np.broadcast_to(group.cut.bary, (len(group.facets), *group.cut.bary.shape))
                for group in self.groups
            ]
        )

    @cached_property
    def normals(self) -> Floats:
        """The exact unit normals (r, 3, 3) of the patches at the corners of the triangles, outward.

        Beware: at a point where facets meet each has its own, as the surface is continuous and
        no smoother.
        """
        net = self.surface.net(self.scale)
        turned = self.surface.turns[:, None, None]
        return self._corners(
            [
                patch_normals(self.surface.degree, net[group.facets], group.cut.bary)
                * turned[group.facets]
                for group in self.groups
            ]
        )

    def values(self, field: SurfaceField) -> Floats:
        """The exact values (r, 3, k) at the corners of the triangles of a field on these facets."""
        if field.facets.shape != self.surface.facets.shape or (
            field.facets is not self.surface.facets
            and not np.array_equal(field.facets, self.surface.facets)
        ):
            raise InputError("the field lives on other facets; take it on the same surface")
        return self._corners(
            [
                values_at(field.degree, field.controls[group.facets], group.cut.bary)
                for group in self.groups
            ]
        )

    def _corners(self, samples: list[Floats]) -> Floats:
        """What is known at the samples of each group (g, s, k), at corners (r, 3, k)."""
        found = np.empty((len(self.triangles), 3, samples[0].shape[2]))
        start = 0
        for group, known in zip(self.groups, samples, strict=True):
            end = start + len(group.facets) * len(group.cut.triangles)
            turns = self.surface.turns[group.facets]
            found[start:end] = _turned(known[:, group.cut.triangles], turns)
            start = end
        return found


def tessellation(
    surface: SurfaceField,
    tolerance: float = 0.05,
    scale: float = 1.0,
    longest: float = np.inf,
) -> Tessellation:
    """The surface moved by its displacement, as triangles no farther than `tolerance` mm from it.

    The distance is from each point of a triangle to the point of the patch with the same
    coordinates, so it bounds the distance in space. It is known beforehand, from the controls:
    nothing is sampled. Where the displacement is nearly affine, a facet stays whole.

    >>> from bezsoma.mesh import ControlNet, Field, block
    >>> mesh = block((10.0, 10.0, 10.0), cells=2)
    >>> bent = Field.interpolating(ControlNet(mesh, 2), lambda x: np.stack(
    ...     [0 * x[:, 0], 0 * x[:, 0], 0.02 * x[:, 0] ** 2], axis=1))
    >>> found = tessellation(bent.on_surface("top"), tolerance=0.01)
    >>> x, _, z = found.points.T
    >>> bool(np.abs(z - 10 - 0.02 * x**2).max() < 1e-14), len(found.triangles)
    (True, 168)

    Args:
        surface: a displacement on facets, such as `solution.displacement.on_surface("skin")`.
        tolerance: mm.
        scale: how many times the displacement is applied.
        longest: how long, in mm, the sides of triangles may be before they move, as far as the
            most parts of an edge allow it: for what is linear between corners, a shade or a colour.
    """
    if not (tolerance > 0 and np.isfinite(tolerance) and np.isfinite(scale)):
        raise InputError(
            f"a tolerance of {tolerance} mm and a scale of {scale} were given; the first has to "
            "be positive, and both finite"
        )
    if not longest > 0:
        raise InputError(f"triangles cannot have sides of at most {longest} mm; give more than 0")
    if not np.isfinite(surface.displacement).all():
        raise InputError("the displacement holds NaN or infinite controls; it has no surface")
    bent = bends(scale * surface.displacement, surface.degree)
    least = _parts_of_length(surface.corners, longest)
    rims = _Rims.of(surface.facets, np.maximum(edge_parts(bent, tolerance), least))
    within = least.max(axis=1, initial=1)
    inside, nipped = insides(bent, rims.of_facet, tolerance, within)
    while (inside == 0).any():
        rims = rims.with_more(np.flatnonzero(inside == 0), tolerance)
        inside, nipped = insides(bent, rims.of_facet, tolerance, within)
    groups, count = _groups(rims, inside, nipped)
    points = np.empty((count, 3))
    _fill_rims(points, surface, scale, rims)
    for group in groups:
        inner = group.cut.bary[group.cut.rim :]
        points[group.points[:, group.cut.rim :]] = _moved(
            surface.degree,
            surface.corners[group.facets],
            scale * surface.controls[group.facets],
            inner,
        )
    triangles = np.concatenate(
        [
            _turned(group.points[:, group.cut.triangles], surface.turns[group.facets])
            for group in groups
        ]
    )
    return Tessellation(surface, scale, tolerance, frozen(points), frozen(triangles), groups)


def _parts_of_length(corners: Floats, longest: float) -> Ints:
    """Into how many parts (f, 3) edges are cut for none to be longer; as many as there may be."""
    ends = corners[:, np.array(SIDES)]
    wanted = np.linalg.norm(ends[:, :, 1] - ends[:, :, 0], axis=2) / longest
    return np.asarray(np.array(STEPS)[np.searchsorted(STEPS[:-1], wanted * (1 - 1e-12))])


@dataclass(frozen=True, eq=False)
class _Rims:
    """The vertices and edges of a surface, and which points are on them: those come first."""

    vertices: Ints
    """(v,) a corner, 3 f + i, at which each vertex is found."""
    edges: Ints
    """(e,) a side, 3 f + s, at which each edge is found."""
    parts: Ints
    """(e,) into how many parts each edge is cut."""
    of_corner: Ints
    """(f, 3) the vertices of each facet."""
    of_side: Ints
    """(f, 3) the edges of each facet."""

    @classmethod
    def of(cls, facets: Ints, parts: Ints) -> _Rims:
        """The rims of facets (f, 3) whose sides are cut in so many parts (f, 3)."""
        _, vertices, of_corner = np.unique(facets, return_index=True, return_inverse=True)
        rows = facets[:, np.array(SIDES)].reshape(-1, 2)
        keys = packed(rows, int(facets.max(initial=0)) + 1)
        _, edges, of_side = np.unique(keys, return_index=True, return_inverse=True)
        shape = facets.shape
        sides = of_side.reshape(shape)
        return cls(vertices, edges, parts.ravel()[edges], of_corner.reshape(shape), sides)

    @property
    def of_facet(self) -> Ints:
        """Into how many parts the sides (f, 3) of each facet are cut."""
        return np.asarray(self.parts[self.of_side])

    @property
    def starts(self) -> Ints:
        """The first point (e + 1,) inside each edge, and the first that is on none."""
        inside = np.concatenate([[0], np.cumsum(self.parts - 1)])
        return np.asarray(len(self.vertices) + inside)

    def with_more(self, facets: Ints, tolerance: float) -> _Rims:
        """The edges of these facets (g,) cut once more, for all facets around them alike."""
        sides = np.unique(self.of_side[facets])
        parts = self.parts.copy()
        refuse_too_fine(2.0 * float(parts[sides].max()), tolerance)
        parts[sides] = np.array(STEPS)[np.searchsorted(STEPS, parts[sides]) + 1]
        return replace(self, parts=parts)


def _groups(rims: _Rims, inside: Ints, nipped: Bools) -> tuple[tuple[Alike, ...], int]:
    """The facets by how they are cut, with the numbers of their points; and how many there are."""
    starts, groups = rims.starts, []
    count = int(starts[-1])
    for row, facets in kinds(np.column_stack([rims.of_facet, inside, nipped])):
        a, b, c, lattice, *corners = row
        pattern = cut((a, b, c), lattice, (bool(corners[0]), bool(corners[1]), bool(corners[2])))
        inner = len(pattern.bary) - pattern.rim
        numbers = [rims.of_corner[facets]]
        for side, cut_in in enumerate((a, b, c)):
            first = starts[rims.of_side[facets, side]]
            numbers.append(first[:, None] + np.arange(cut_in - 1))
        numbers.append(count + np.arange(len(facets) * inner).reshape(len(facets), inner))
        count += len(facets) * inner
        groups.append(Alike(pattern, facets, np.concatenate(numbers, axis=1)))
    return tuple(groups), count


def _fill_rims(points: Floats, surface: SurfaceField, scale: float, rims: _Rims) -> None:
    """Writes the points on vertices and edges, each once."""
    degree, controls = surface.degree, surface.controls
    facet, corner = np.divmod(rims.vertices, 3)
    at = np.array([trace(degree, 2, (i,))[0] for i in range(3)])[corner]
    points[: len(facet)] = surface.corners[facet, corner] + scale * controls[facet, at]
    starts, along = rims.starts, np.stack([trace(degree, 2, side) for side in SIDES])
    for count in np.unique(rims.parts[rims.parts > 1]).tolist():
        mine = np.flatnonzero(rims.parts == count)
        facet, side = np.divmod(rims.edges[mine], 3)
        ends = surface.corners[facet[:, None], np.array(SIDES)[side]]
        own = scale * controls[facet[:, None], along[side]]
        numbers = starts[mine, None] + np.arange(count - 1)
        points[numbers] = _moved(degree, ends, own, inside_edge(count))


def _moved(degree: int, corners: Floats, displacement: Floats, bary: Floats) -> Floats:
    """Places (q, b, 3) mm: straight corners (q, d+1, 3) moved by displacements (q, m, 3)."""
    return np.asarray(np.matmul(bary, corners) + values_at(degree, displacement, bary))


def _turned(corners: npt.NDArray[T], turns: Floats) -> npt.NDArray[T]:
    """Rows (g q, 3, ..) of the corners (g, q, 3, ..) of triangles, mirrored where the facet is."""
    found = corners.copy()
    found[turns < 0] = corners[turns < 0][:, :, [0, 2, 1]]
    return found.reshape(-1, *corners.shape[2:])
