# SPDX-License-Identifier: BSD-3-Clause
"""The moment equations of a fully symmetric rule on a simplex, for many guesses at once.

A rule that does not change when vertices are renumbered is a set of orbits: all the points that
arise from one by permuting its barycentric coordinates.  A symmetric rule is exact for degree p as
soon as it is exact for the *symmetric* polynomials of degree p (the mean over all permutations of
any other is one of them, and neither integral nor rule sees the difference).  These are polynomials
in the elementary symmetric functions e_2 .. e_{d+1} of L (e_1 = 1), so a tet needs 15 equations
for degree 8, not 165.

An orbit's kind says which coordinates agree: (3, 1) stands for (a, a, a, b) with 3 a + b = 1, four
points.  Unknowns are the shares m of the whole that the parts of a kind take (m = 3 a and b), as a
softmax of free numbers, and logarithms of weights: any guess lies inside and has positive weights.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property
from itertools import product
from math import comb, factorial, prod

import numpy as np

from bezsoma.arrays import Bools, Floats, Ints
from bezsoma.bernstein.quadrature import conical

Kind = tuple[int, ...]


def kinds(dim: int) -> list[Kind]:
    """The kinds of orbits, fewest points first: partitions of d + 1.

    >>> [(kind, size(kind)) for kind in kinds(2)]
    [((3,), 1), ((2, 1), 3), ((1, 1, 1), 6)]
    """

    def partitions(whole: int, largest: int) -> list[Kind]:
        if whole == 0:
            return [()]
        return [
            (first, *rest)
            for first in range(min(whole, largest), 0, -1)
            for rest in partitions(whole - first, first)
        ]

    return sorted(partitions(dim + 1, dim + 1), key=size)


def size(kind: Kind) -> int:
    """How many points an orbit of a kind has."""
    return factorial(sum(kind)) // prod(map(factorial, kind))


def exponents(exactness: int, dim: int) -> Ints:
    """The symmetric polynomials: exponents (m, d) of e_2 .. e_{d+1}, by degree.

    >>> [len(exponents(p, 3)) for p in (2, 4, 8, 14)]
    [2, 5, 15, 47]
    """
    degrees = range(2, dim + 2)
    found = [
        powers
        for powers in product(*(range(exactness // k + 1) for k in degrees))
        if np.dot(powers, degrees) <= exactness
    ]
    return np.array(sorted(found, key=lambda powers: (np.dot(powers, degrees), powers)))


def elementary(bary: Floats) -> tuple[Floats, Floats]:
    """e_2 .. e_{d+1} (..., d) of points (..., d+1), and their slopes (..., d, d+1).

    The slope of e_k in L_i is e_{k-1} of the other coordinates: e_{k-1} - L_i times the one before.
    """
    corners = bary.shape[-1]
    e = np.zeros((*bary.shape[:-1], corners + 1))
    e[..., 0] = 1
    for i in range(corners):
        e[..., 1:] = e[..., 1:] + bary[..., i, None] * e[..., :-1]
    slope = np.ones((*bary.shape[:-1], corners + 1, corners))
    for k in range(2, corners + 1):
        slope[..., k, :] = e[..., k - 1, None] - bary * slope[..., k - 1, :]
    return e[..., 2:], slope[..., 2:, :]


@dataclass(frozen=True)
class Equations:
    """The rule made of the given orbits has to be exact: m equations for n unknowns."""

    orbits: tuple[Kind, ...]
    exactness: int

    @property
    def dim(self) -> int:
        """Of the simplex."""
        return sum(self.orbits[0]) - 1

    @cached_property
    def sizes(self) -> Ints:
        """Points of each orbit (o,)."""
        return np.array([size(kind) for kind in self.orbits])

    @cached_property
    def powers(self) -> Ints:
        """Of the symmetric polynomials, (m, d)."""
        return exponents(self.exactness, self.dim)

    @cached_property
    def shares(self) -> Ints:
        """(orbit, part) of each unknown that says where points lie; then come the weights."""
        free = [(o, h) for o, kind in enumerate(self.orbits) for h in range(len(kind) - 1)]
        return np.array(free, dtype=np.int64).reshape(-1, 2)

    @cached_property
    def belongs(self) -> Bools:
        """Whether coordinate i of an orbit's first point is in part h: (o, h, i)."""
        part = np.full((len(self.orbits), self.dim + 1), -1)
        for row, kind in zip(part, self.orbits, strict=True):
            row[:] = np.repeat(np.arange(len(kind)), kind)
        return part[:, None, :] == np.arange(self.dim + 1)[:, None]

    @property
    def unknowns(self) -> int:
        """How many."""
        return len(self.shares) + len(self.orbits)

    @cached_property
    def basis(self) -> Floats:
        """Combinations (m, m) of the products of Chebyshev polynomials that are orthonormal."""
        return orthonormal(self.exactness, self.dim)

    def points(self, z: Floats) -> tuple[Floats, Floats, Floats]:
        """From unknowns (b, n): first points (b, o, d+1), shares (b, o, h), weights (b, o)."""
        orbits, parts = self.shares.T
        free = np.where(self.belongs.any(axis=2), 0.0, -np.inf)
        free = np.broadcast_to(free, (len(z), *free.shape)).copy()
        free[:, orbits, parts] = z[:, : len(self.shares)]
        share = np.exp(free - free.max(axis=2, keepdims=True))
        share /= share.sum(axis=2, keepdims=True)
        many = np.maximum(self.belongs.sum(axis=2), 1)
        bary = np.einsum("boh,ohi->boi", share / many, self.belongs)
        return bary, share, np.exp(z[:, len(self.shares) :])

    def defects(self, z: Floats) -> tuple[Floats, Floats]:
        """Errors of the rules (b, m), and their slopes in the unknowns (b, m, n).

        With s_h = sum of L_i de/dL_i over a part, de/dt_h = s_h - m_h sum_h s_h.
        """
        bary, share, weights = self.points(z)
        e, de = elementary(bary)
        values, slopes = products(e, self.powers)
        each = np.einsum("boki,ohi->bokh", de * bary[:, :, None], self.belongs)
        along = each - share[:, :, None] * each.sum(axis=3, keepdims=True)
        orbits, parts = self.shares.T
        weighted = (self.sizes * weights)[..., None]
        moved = np.einsum(
            "bsk,bskm->bsm",
            along[:, orbits, :, parts].swapaxes(0, 1),
            (slopes * weighted[..., None])[:, orbits],
        )
        slope = np.concatenate([moved, values * weighted], axis=1) @ self.basis
        defect = (values * weighted).sum(axis=1) @ self.basis
        defect[:, 0] -= 1
        return defect, slope.swapaxes(1, 2)


@cache
def orthonormal(exactness: int, dim: int) -> Floats:
    """Combinations (m, m) of `products` whose mean products with each other are 1 or 0."""
    bary, weights = conical(2 * exactness, dim)
    rows = products(elementary(bary)[0], exponents(exactness, dim))[0]
    combination = np.eye(rows.shape[1])
    for _ in range(2):  # the second pass clears the rounding of the first
        upper = np.linalg.qr(rows @ combination * np.sqrt(weights)[:, None])[1]
        combination = np.linalg.solve(upper.T, combination.T).T
    return combination * np.sign(combination[0, 0])  # the first is 1, not -1


def products(e: Floats, powers: Ints) -> tuple[Floats, Floats]:
    """Chebyshev products at e (..., d): values (..., m), slopes in e (..., d, m)."""
    dim = powers.shape[1]
    values, slopes = [], []
    for k in range(dim):
        largest = comb(dim + 1, k + 2) / (dim + 1) ** (k + 2)
        t, dt = chebyshev(2 * e[..., k] / largest - 1, int(powers[:, k].max()))
        values.append(t[..., powers[:, k]])
        slopes.append(dt[..., powers[:, k]] * (2 / largest))
    slope = [prod((slopes if k == j else values)[j] for j in range(dim)) for k in range(dim)]
    return np.asarray(prod(values)), np.stack(slope, axis=-2)


def chebyshev(x: Floats, degree: int) -> tuple[Floats, Floats]:
    """T_0 .. T_n at x and their slopes, each (..., n+1)."""
    t, dt = np.zeros((degree + 2, *x.shape)), np.zeros((degree + 2, *x.shape))
    t[0], t[1], dt[1] = 1, x, 1
    for j in range(1, degree):
        t[j + 1] = 2 * x * t[j] - t[j - 1]
        dt[j + 1] = 2 * t[j] + 2 * x * dt[j] - dt[j - 1]
    return np.moveaxis(t[: degree + 1], 0, -1), np.moveaxis(dt[: degree + 1], 0, -1)
