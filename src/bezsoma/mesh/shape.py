# SPDX-License-Identifier: BSD-3-Clause
"""Whether a tet is flat and which way round it is, decided without rounding errors.

Floating-point numbers decide nearly all tets, in the core: their determinant is larger than its
error bound. The few that are near zero are looked at again here, in fractions where need be, so a
needle is not mistaken for a flat tet, nor its orientation guessed.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import numpy.typing as npt

from bezsoma import _core
from bezsoma.arrays import Bools, Floats, Ints
from bezsoma.mesh.topology import EDGES, FACES, cross, determinants

FLAT = 1e-10
"""A tet is flat where its least height is below this part of its longest edge (no unit)."""
LARGEST = 1e70
"""Lengths above this or below its inverse (mm) over- or underflow in the fourth power."""
Signs = npt.NDArray[np.int8]
_EPS = float(np.finfo(float).eps)
_CHUNK = 1 << 15


def heights_and_lengths(corners: Floats) -> tuple[Floats, Floats]:
    """The least height and the longest edge (t,) in mm of tets with corners (t, 4, 3).

    height = 6 V / (2 A) over the largest face. The unit tet: 1/sqrt(3) and sqrt(2).

    >>> unit = np.array([[[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]])
    >>> height, length = heights_and_lengths(unit)
    >>> bool(abs(3 * height[0] ** 2 - 1) < 1e-15), bool(abs(length[0] ** 2 - 2) < 1e-15)
    (True, True)
    """
    length, area = _lengths_and_areas(corners)
    return np.abs(determinants(corners)) / np.where(area > 0, area, 1.0), length


def flat_tets(points: Floats, tets: Ints) -> tuple[Signs, Bools]:
    """The orientation (t,), +1 or -1, of tets (t, 4), and which of them are flat (t,).

    Flat: the least height is below `FLAT` of the longest edge, or within the rounding of the
    coordinates themselves (4 ulp of the largest: 1e-12 mm for a scanner's 1000 mm). Both scale
    with the mesh, so its unit does not matter.

    >>> thin = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1e-8]])
    >>> flat_tets(thin, np.array([[0, 1, 2, 3], [0, 2, 1, 3]]))
    (array([ 1, -1], dtype=int8), array([False, False]))
    >>> flat_tets(1e-6 * thin * [1, 1, 1e-3], np.array([[0, 1, 2, 3]]))[1]
    array([ True])
    """
    sign = _core.orientations(points, tets, FLAT, LARGEST)
    flat = np.zeros(len(tets), bool)
    doubtful = np.flatnonzero(sign == 0)
    for start in range(0, len(doubtful), _CHUNK):
        part = doubtful[start : start + _CHUNK]
        sign[part], flat[part] = _signs(points[tets[part]])
    return sign, flat


def _signs(corners: Floats) -> tuple[Signs, Bools]:
    det, bound = _bounded(corners)
    length, area = _lengths_and_areas(corners)
    least = np.maximum(FLAT * length, 4 * _EPS * np.abs(corners).max(axis=(1, 2))) * area
    flat = (np.abs(det) + bound <= least) | (length * LARGEST < 1)
    sign = np.sign(det).astype(np.int8)
    for tet in np.flatnonzero(~flat & (np.abs(det) <= least + bound)):
        exact = _exact(corners[tet])
        flat[tet] = abs(exact) <= Fraction(least[tet])
        sign[tet] = (exact > 0) - (exact < 0)
    return sign, flat


def _bounded(corners: Floats) -> tuple[Floats, Floats]:
    """The determinants (t,) and bounds (t,) of their rounding errors.

    Three subtractions, two products and five sums enter each of the six terms: 8 rounding errors
    of half an eps, taken four times as large here.
    """
    a, b, c = (np.abs(corners[:, i] - corners[:, 0]).T for i in (1, 2, 3))
    permanent = sum(
        a[i] * (b[(i + 1) % 3] * c[(i + 2) % 3] + b[(i + 2) % 3] * c[(i + 1) % 3]) for i in range(3)
    )
    return determinants(corners), 16 * _EPS * np.asarray(permanent)


def _lengths_and_areas(corners: Floats) -> tuple[Floats, Floats]:
    """The longest edge (t,) in mm and twice the largest face (t,) in mm2."""
    length = np.zeros(len(corners))
    for i, j in EDGES:
        edge = corners[:, j] - corners[:, i]
        np.maximum(length, np.einsum("td,td->t", edge, edge), out=length)
    area = np.zeros(len(corners))
    for i, j, k in FACES:
        normal = cross(corners[:, j] - corners[:, i], corners[:, k] - corners[:, i])
        np.maximum(area, np.einsum("td,td->t", normal, normal), out=area)
    return np.sqrt(length), np.sqrt(area)


def _exact(corners: Floats) -> Fraction:
    p = [[Fraction(x) for x in corner] for corner in corners.tolist()]
    a, b, c = ([x - y for x, y in zip(p[i], p[0], strict=True)] for i in (1, 2, 3))
    terms = (
        a[i] * (b[(i + 1) % 3] * c[(i + 2) % 3] - b[(i + 2) % 3] * c[(i + 1) % 3]) for i in range(3)
    )
    return sum(terms, Fraction(0))
