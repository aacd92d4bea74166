# SPDX-License-Identifier: BSD-3-Clause
"""How far a flat triangle strays from the polynomial patch it stands for, bounded beforehand.

A flat triangle agrees with the patch at its corners. Where the second derivative D2 of the patch
is constant, the distance at weights w is |1/2 sum_{i<j} w_i w_j D2(d_ij, d_ij)| over the sides
d_ij of the triangle, and at most half the squared radius of the circle around a triangle with
sides of the squared lengths |D2(d_ij, d_ij)| (`circle`).

Where it varies, by Taylor's theorem, |flat - patch| <= 1/2 sum_i w_i |D2(a_i, a_i)|, with a_i
from the point to corner i and D2 somewhere between. In the directions of the facet's edges
D2(a, a) = -sum_{i<j} a_i a_j D2(e_i - e_j, e_i - e_j), and the mean of |a_i a_j| is at most a
quarter of the product of the ranges of L_i and L_j over the triangle (Popoviciu 1935). In the
directions of two edges it is the bound of Filip, Magedson and Markot 1986,
doi:10.1016/0167-8396(86)90005-1. This serves for what is left when the mean of D2 is taken off,
or for all of it: each bound holds, so the least does (docs/theory/view.md).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bezsoma.arrays import Floats, Ints
from bezsoma.bernstein import indices, position
from bezsoma.mesh.topology import slices
from bezsoma.view.lattice import SIDES

PAIRS = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))
_ABOUT = ((0, 1, 2), (1, 0, 2), (2, 0, 1))
"""A corner and the other two."""


@dataclass(frozen=True, eq=False)
class Largest:
    """The largest sizes of a second derivative that varies, in mm per facet squared."""

    along: Floats
    """(f, 3) along the edges 01, 02 and 12, anywhere on the facet."""
    across: Floats
    """(f, 3) along both edges from the corners 0, 1 and 2, anywhere on the facet."""
    rim: Floats
    """(f, 3) along the edges 01, 02 and 12, on the edge itself."""

    def of(self, facets: Ints) -> Largest:
        """Those of some of the facets."""
        return Largest(self.along[facets], self.across[facets], self.rim[facets])


@dataclass(frozen=True, eq=False)
class Bends:
    """How f patches bend; see `bends`."""

    degree: int
    mean: Floats
    """(f, 6) products of the mean second derivatives along the edges 01, 02 and 12, in `PAIRS`."""
    whole: Largest
    rest: Largest
    """What is left when the mean is taken off."""

    def of(self, facets: Ints) -> Bends:
        """Those of some of the facets."""
        return Bends(self.degree, self.mean[facets], self.whole.of(facets), self.rest.of(facets))


def bends(controls: Floats, degree: int) -> Bends:
    """The second derivatives of patches with controls (f, m, k), bounded by their own controls.

    D2(e_j - e_i, e_j - e_i) has the controls n (n-1) (b_{+2j} - 2 b_{+i+j} + b_{+2i}), and stays
    within their hull. The affine part of a patch bends nothing, so the controls of a displacement
    do as well as those of the displaced patch. Of L_1 squared:

    >>> found = bends(np.array([[[0.0], [0], [0], [1], [0], [0]]]), 2)
    >>> found.whole.along.tolist(), found.whole.across.tolist(), found.mean.tolist()
    ([[2.0, 0.0, 2.0]], [[0.0, 2.0, 0.0]], [[4.0, 0.0, 4.0, 0.0, 0.0, 4.0]])
    """
    count = len(controls)
    products = np.zeros((count, 6))
    whole, rest = (Largest(*(np.zeros((count, 3)) for _ in range(3))) for _ in range(2))
    for part in slices(count if degree > 1 else 0):
        along, across = _second(controls[part], degree)
        mean = along.mean(axis=2)
        for k, (i, j) in enumerate(PAIRS):
            products[part, k] = np.einsum("fk,fk->f", mean[:, i], mean[:, j])
        _fill(whole, part, along, across, degree)
        along -= mean[:, :, None]
        across -= across.mean(axis=2, keepdims=True)
        _fill(rest, part, along, across, degree)
    return Bends(degree, products, whole, rest)


def _second(controls: Floats, degree: int) -> tuple[Floats, Floats]:
    """The controls (f, 3, m_{n-2}, k) of D2 along each edge, and across at each corner."""
    below, units = indices(degree - 2, 2), np.eye(3, dtype=np.int64)
    at = {
        (i, j): degree * (degree - 1) * controls[:, position(below + units[i] + units[j])]
        for i in range(3)
        for j in range(3)
    }
    along = [at[i, i] - 2 * at[i, j] + at[j, j] for i, j in SIDES]
    across = [at[i, j] - at[i, c] - at[j, c] + at[c, c] for c, i, j in _ABOUT]
    return np.stack(along, axis=1), np.stack(across, axis=1)


def _fill(into: Largest, part: slice, along: Floats, across: Floats, degree: int) -> None:
    """The largest sizes over all controls, and over those on each edge."""
    below = indices(degree - 2, 2)
    size = np.sqrt(np.einsum("fsmk,fsmk->fsm", along, along))
    into.along[part] = size.max(axis=2)
    for edge, (i, j) in enumerate(SIDES):
        into.rim[part, edge] = size[:, edge, below[:, 3 - i - j] == 0].max(axis=1)
    into.across[part] = np.sqrt(np.einsum("fsmk,fsmk->fsm", across, across).max(axis=2))


def circle(sides: Floats) -> Floats:
    """The largest 1/2 sum_{i<j} w_i w_j m_ij (..) over weights w, for m >= 0 (.., 3).

    Half the squared radius of the smallest circle around a triangle with sides of the squared
    lengths m: the circumcircle, or where the triangle is obtuse that on its longest side.

    >>> circle(np.array([[1.0, 1, 1], [1, 1, 2], [0, 3, 3], [0, 0, 4]])).tolist() == [
    ...     1 / 6, 1 / 4, 3 / 8, 1 / 2]
    True
    """
    total, longest = sides.sum(axis=-1), sides.max(axis=-1)
    area = total**2 - 2 * (sides**2).sum(axis=-1)  # 16 times squared
    acute = 2 * longest < total
    around = sides.prod(axis=-1) / np.where(acute, area, 1.0)
    return np.asarray(np.where(acute, around, longest / 4) / 2)


def lattice_error(bent: Bends) -> Floats:
    """The chord error (f,) in mm of each facet left whole; cut in s parts an edge, 1 / s**2 of it.

    >>> whole = lattice_error(bends(np.array([[[0.0], [0], [0], [1], [0], [0]]]), 2))
    >>> whole.tolist()                        # of L_1 squared, attained in the middle of an edge
    [0.25]
    """
    return triangles_error(bent, np.eye(3)[None])


def triangles_error(bent: Bends, corners: Floats) -> Floats:
    """The largest chord error (f,) in mm over triangles with barycentric corners (q, 3, 3)."""
    ranges = _ranges(corners)
    varying = _steady(bent.mean, corners) + _taylor(bent.rest.along, bent.rest.across, ranges)
    return np.minimum(varying, _taylor(bent.whole.along, bent.whole.across, ranges))


def _steady(products: Floats, corners: Floats) -> Floats:
    """The error (f,) that the mean second derivative causes, largest over the triangles.

    Along the side d of a triangle it is -sum_{i<j} d_i d_j D2_ij, its square a sum over `PAIRS`.
    """
    sides = corners - corners[:, [1, 2, 0]]
    d = -np.stack([sides[..., i] * sides[..., j] for i, j in SIDES])
    terms = np.stack([d[i] * d[j] * (1 if i == j else 2) for i, j in PAIRS])
    found = np.empty(len(products))
    for part in slices(len(found), 1 + (1 << 18) // len(corners)):
        square = np.maximum(products[part] @ terms.reshape(6, -1), 0.0)
        found[part] = circle(np.sqrt(square).reshape(-1, *d.shape[1:])).max(axis=1)
    return found


def strip_error(bent: Bends, edge: int, width: float, corners: Floats) -> Floats:
    """As `triangles_error`, for triangles no farther than `width` (of L) from an edge.

    There the second derivative along the edge is mostly the edge's own:

        (1 - width)^(n-2) rim + (1 - (1 - width)^(n-2)) along ,

    so that a narrow strip is fine wherever the edge is, however the facet bends inside.
    """
    own = (1 - width) ** max(bent.degree - 2, 0)
    along = bent.whole.along.copy()
    along[:, edge] += own * (bent.whole.rim[:, edge] - along[:, edge])
    near_edge = _taylor(along, bent.whole.across, _ranges(corners))
    return np.minimum(near_edge, triangles_error(bent, corners))


def _ranges(corners: Floats) -> Floats:
    """The largest products (3, 3) of the ranges of barycentric coordinates over the triangles."""
    ranges = np.ptp(corners, axis=1)
    return np.asarray((ranges[:, :, None] * ranges[:, None]).max(axis=0))


def _taylor(along: Floats, across: Floats, ranges: Floats) -> Floats:
    """The least of four bounds (f,): in the directions of all edges, or of those at a corner."""
    forms = [sum(along[:, e] * ranges[i, j] for e, (i, j) in enumerate(SIDES))]
    for c, i, j in _ABOUT:
        one, other = along[:, _side(c, i)], along[:, _side(c, j)]
        forms.append(one * ranges[i, i] + 2 * across[:, c] * ranges[i, j] + other * ranges[j, j])
    return np.asarray(np.min(np.stack(forms), axis=0) / 8)


def _side(i: int, j: int) -> int:
    return SIDES.index((min(i, j), max(i, j)))
