# SPDX-License-Identifier: BSD-3-Clause
"""Where polynomials on simplices are zero: segments in triangles, triangles in tets.

Each simplex is cut into a lattice of small ones (parts**dim of them); where a small one has
corners on both sides, the places where its edges meet the level become the corners of a segment,
a triangle or two. Those places are roots of the polynomial itself, not of a chord, so they lie
on the level to rounding; what is flat between them strays from it by no more than `straying`.
Lattice points that neighbours share have one number and one value, so there are no cracks.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np

from bezsoma import bernstein
from bezsoma.arrays import Floats, Ints, frozen
from bezsoma.mesh.evaluation import portions
from bezsoma.mesh.topology import packed

_EDGES = {
    (2, 1): (((0, 1), (0, 2)),),
    (2, 2): (((0, 2), (1, 2)),),
    (3, 1): (((0, 1), (0, 2), (0, 3)),),
    (3, 2): (((0, 2), (0, 3), (1, 3)), ((0, 2), (1, 3), (1, 2))),
    (3, 3): (((0, 3), (1, 3), (2, 3)),),
}
"""Dimension and how many corners lie inside -> the edges that are cut, inner corners first."""
_NOTHING = 1e-13
"""A value this small, relative to the largest control, is zero."""
_MOST_STEPS = 60


class Marched(NamedTuple):
    """Flat pieces of a level: r segments (dim 2) or triangles (dim 3)."""

    owner: Ints
    """(r,) the simplex each lies in."""
    bary: Floats
    """(r, dim, dim + 1) its corners in that simplex."""
    vertex: Ints
    """(r, dim) one number for corners that neighbours share."""


@cache
def small_simplices(parts: int, dim: int) -> Ints:
    """The parts**dim small simplices of a triangle or tet whose edges are cut in equal parts.

    Rows are positions among `indices(parts, dim)`. Their volumes are equal and fill the whole:

    >>> for dim in (2, 3):
    ...     corners = bernstein.indices(4, dim)[small_simplices(4, dim)] / 4
    ...     sizes = abs(np.linalg.det(corners))
    ...     len(sizes) == 4**dim, bool(np.allclose(sizes, 4.0**-dim))
    (True, True)
    (True, True)
    """
    unit = np.eye(dim + 1, dtype=np.int64)
    pieces = [bernstein.indices(parts - 1, dim)[:, None] + unit]
    if parts >= dim:
        pieces.append(bernstein.indices(parts - dim, dim)[:, None] + (1 - unit))
    if dim == 3 and parts >= 2:
        middle = bernstein.indices(parts - 2, 3)[:, None]
        axis, ring = [(0, 1), (2, 3)], [(0, 2), (1, 2), (1, 3), (0, 3)]
        for k in range(4):
            four = [*axis, ring[k], ring[(k + 1) % 4]]
            pieces.append(middle + np.array([unit[i] + unit[j] for i, j in four]))
    return frozen(np.asarray(bernstein.position(np.concatenate(pieces))))


def lattice_numbers(simplices: Ints, parts: int) -> Ints:
    """Numbers (q, l) of lattice points of ascending simplices (q, d + 1), shared where they meet.

    A point on a face is known by the vertices of that face and its weights there. Two tets that
    share a face, in halves, have 10 points each, of which they share 6:

    >>> numbers = lattice_numbers(np.array([[0, 1, 2, 3], [1, 2, 3, 7]]), 2)
    >>> len(np.unique(numbers)), len(np.intersect1d(*numbers))
    (14, 6)
    """
    dim = simplices.shape[1] - 1
    weights = bernstein.indices(parts, dim)
    order = np.argsort(weights > 0, axis=1, kind="stable")  # those without weight come first
    rim = np.flatnonzero((weights == 0).any(axis=1))
    weight = np.take_along_axis(weights, order, axis=1)[rim, 1:]
    vertex = np.where(weight > 0, simplices[:, order[rim, 1:]] + 1, 0)
    code = np.broadcast_to(
        bernstein.position(np.c_[parts - weight.sum(axis=1), weight]), vertex.shape[:2]
    )
    rows = np.concatenate([vertex, code[..., None]], axis=2).reshape(-1, dim + 1)
    distinct, shared = np.unique(packed(rows, int(rows.max(initial=0)) + 1), return_inverse=True)
    own = len(weights) - len(rim)
    numbers = np.empty((len(simplices), len(weights)), np.int64)
    inner = np.setdiff1d(np.arange(len(weights)), rim)
    numbers[:, inner] = len(distinct) + np.arange(len(simplices) * own).reshape(len(simplices), own)
    numbers[:, rim] = shared.reshape(len(simplices), len(rim))
    return numbers


def straying(degree: int, dim: int, controls: Floats, parts: int) -> Floats:
    """How far (q,) the polynomials with controls (q, m) stray from being linear on small simplices.

    Between places of one small simplex, of barycentric coordinates that differ by at most
    1/parts, a polynomial strays from the line, triangle or tet through its values there by at most

        n (n - 1) / (8 parts**2)  sum_kl max |second difference along k and l|

    k and l being directions from corner 0. For one dimension this is the h**2/8 max |f''| of every
    textbook; in general the error is half the mean of D2 f(d, d) over the corners, d the way from
    the point to a corner, and numbers with mean 0 in an interval of length h have a mean square of
    at most h**2/4 (Popoviciu). For a square it is attained, halfway:

    >>> straying(2, 2, np.array([[0.0, 0, 0, 1, 0, 0]]), 1).tolist()  # L_1**2
    [0.25]
    """
    if degree < 2:
        return np.zeros(len(controls))
    up = bernstein.shifts(degree, dim)
    first = [controls[:, up[:, k]] - controls[:, up[:, 0]] for k in range(1, dim + 1)]
    up = bernstein.shifts(degree - 1, dim)
    total = np.zeros(len(controls))
    for one in first:
        for k in range(1, dim + 1):
            total += np.abs(one[:, up[:, k]] - one[:, up[:, 0]]).max(axis=1)
    return np.asarray(degree * (degree - 1) * total / (8 * parts**2))


def marched(degree: int, dim: int, controls: Floats, numbers: Ints, parts: int) -> Marched:
    """The pieces on which polynomials with controls (q, m) are zero, to rounding at their corners.

    `numbers` (q, l) say which of the lattice points of degree `parts` are shared. A point where a
    polynomial is just zero counts as inside, with those where it is positive. A circle:

    >>> controls = np.array([[-0.25, -0.25, -0.25, 0.75, -0.25, 0.75]])  # x**2 + y**2 - 1/4
    >>> found = marched(2, 2, controls, np.arange(45)[None], 8)
    >>> bool(np.allclose(np.hypot(*found.bary[..., 1:].reshape(-1, 2).T), 0.5, atol=1e-14))
    True
    """
    bary = bernstein.domain_points(parts, dim)
    scale = float(np.abs(controls).max(initial=0.0))
    values = _shared(controls @ bernstein.values(degree, bary).T, numbers)
    values[np.abs(values) <= _NOTHING * scale] = 0.0
    owner, inner, outer = _crossings(values, parts, dim)
    rows = owner[:, None]
    outer = np.where(values[rows, inner] == 0.0, inner, outer)  # a corner of many edges is one
    between = np.sort(np.stack([numbers[rows, inner], numbers[rows, outer]], axis=-1), axis=-1)
    key = packed(between.reshape(-1, 2), int(numbers.max(initial=0)) + 1)
    _, first, vertex = np.unique(key, return_index=True, return_inverse=True)
    vertex = vertex.reshape(inner.shape)
    whole = np.ones(len(owner), bool)
    for i in range(dim):
        whole &= vertex[:, i] != vertex[:, i - 1]
    inside, outside = inner.ravel()[first], outer.ravel()[first]
    shares = _roots(degree, controls[owner[first // dim]], bary[inside], bary[outside], scale)
    share = shares[vertex][..., None]
    places = (1 - share) * bary[inner] + share * bary[outer]
    return Marched(owner[whole], places[whole], vertex[whole])


def _shared(values: Floats, numbers: Ints) -> Floats:
    """The values (q, l), those with one number made equal to the last bit."""
    _, first, inverse = np.unique(numbers, return_index=True, return_inverse=True)
    return np.asarray(values.ravel()[first][inverse.reshape(numbers.shape)])


def _crossings(values: Floats, parts: int, dim: int) -> tuple[Ints, Ints, Ints]:
    """The simplex (r,) of each piece; the inner and outer lattice points (r, dim) of its edges."""
    corners = small_simplices(parts, dim)
    none = np.empty((0, dim), np.int64)
    owners, inner, outer = [none[:, 0]], [none], [none]
    for part in portions(len(values), corners.size):
        inside = values[part][:, corners] >= 0.0
        number = inside.sum(axis=2)
        for (of_dim, count), pieces in _EDGES.items():
            if of_dim != dim:
                continue
            owner, small = np.nonzero(number == count)
            order = np.argsort(~inside[owner, small], axis=1, kind="stable")
            row = np.take_along_axis(corners[small], order, axis=1)
            for edges in pieces:
                ends = row[:, np.array(edges)]
                owners.append(owner + part.start)
                inner.append(ends[..., 0])
                outer.append(ends[..., 1])
    return np.concatenate(owners), np.concatenate(inner), np.concatenate(outer)


def _roots(degree: int, controls: Floats, inside: Floats, outside: Floats, scale: float) -> Floats:
    """How far (p,) from inside to outside (p, d + 1) the polynomials of controls (p, m) are zero.

    False position, the side that stays twice being halved (Illinois): it brackets, and gains
    more than half the digits anew at each step. A line takes one step.
    """
    low, high = np.zeros(len(controls)), np.ones(len(controls))
    at_low, at_high = (_values(degree, controls, place) for place in (inside, outside))
    at_low, at_high = (
        np.maximum(at_low, 0),
        np.where(at_high < 0, at_high, -1),
    )  # where they are one
    found, last = low, np.zeros(len(controls))
    for _ in range(_MOST_STEPS):
        found = low + (high - low) * at_low / (at_low - at_high)
        here = _values(degree, controls, inside + found[:, None] * (outside - inside))
        if (np.abs(here) <= _NOTHING * scale).all():
            break
        up = here >= 0
        at_high = np.where(up, np.where(last > 0, at_high / 2, at_high), here)
        at_low = np.where(up, here, np.where(last < 0, at_low / 2, at_low))
        low, high = np.where(up, found, low), np.where(up, high, found)
        last = np.where(up, 1.0, -1.0)
    return np.asarray(found)


def _values(degree: int, controls: Floats, bary: Floats) -> Floats:
    """The value (p,) of each polynomial (p, m) at a point (p, d + 1) of its own."""
    return np.asarray(np.einsum("pm,pm->p", bernstein.values(degree, bary), controls))
