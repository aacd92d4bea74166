# SPDX-License-Identifier: BSD-3-Clause
"""Nets and patches as line drawings: seen from one side, the nearer over the farther."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from bezsoma import bernstein
from bezsoma.arrays import Floats, Ints
from bezsoma.view.graph import Line, Tiles
from bezsoma.view.lattice import small_triangles

PARTS = 14
"""Into how many triangles an edge of a patch is cut to be drawn."""
PALE = np.array([0.93, 0.80, 0.72])
FACES = tuple(combinations(range(4), 3))


def axes(turn: float = -0.55, lift: float = 0.3) -> Floats:
    """Rows (3, 3): to the viewer's right, up, towards the viewer; angles in rad.

    >>> bool(np.allclose(axes() @ axes().T, np.eye(3)))
    True
    """
    c, s, a, b = np.cos(turn), np.sin(turn), np.cos(lift), np.sin(lift)
    return np.array([[c, s, 0.0], [-s * b, c * b, a], [s * a, -c * a, b]])


def seen(points: Floats) -> Floats:
    """Points (.., 2 or 3) as they are drawn (.., 2): flat ones as they lie."""
    return points if points.shape[-1] == 2 else np.asarray(points @ axes()[:2].T)


def neighbours(degree: int, dim: int) -> Ints:
    """The pairs (e, 2) of controls that a net joins: those that differ by e_i - e_j.

    A cubic triangle has 18 of them, as a lattice of nine triangles has edges:

    >>> len(neighbours(3, 2)), len(neighbours(2, 3))
    (18, 24)
    """
    every = bernstein.indices(degree, dim)
    apart = np.abs(every[:, None] - every[None]).sum(axis=2)
    return np.argwhere(np.triu(apart == 2))


def net_lines(
    controls: Floats, degree: int, dim: int, colour: str, label: str = "", width: float = 1.3
) -> list[Line]:
    """A net as lines between neighbours and dots at controls (m, 2 or 3)."""
    flat = seen(controls)
    joined = np.full((3 * len(neighbours(degree, dim)) or 1, 2), np.nan) if degree else flat
    if degree:
        joined[0::3], joined[1::3] = (flat[ends] for ends in neighbours(degree, dim).T)
    return [
        Line(joined, "", colour, "-", "", width),
        Line(flat, label, colour, "", "o", above=3),
    ]


def surface(points: Floats, colour: Floats = PALE, opacity: float = 0.85) -> Tiles:
    """Triangles over samples (k, m, 3) of k patches, shaded by their slope, farther ones first."""
    corners = points[:, small_triangles(PARTS)].reshape(-1, 3, 3)
    towards = axes()[2]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.linalg.norm(normal, axis=1)[:, None] + 1e-300
    light = np.array([0.35, -0.5, 0.8]) @ normal.T / np.linalg.norm([0.35, -0.5, 0.8])
    order = np.argsort(corners.mean(axis=1) @ towards)
    shade = (0.62 + 0.38 * np.abs(light))[:, None] * colour
    opaque = np.full((len(corners), 1), opacity)
    return Tiles(seen(corners)[order], np.hstack([shade, opaque])[order])


def faces_of(controls: Floats, degree: int) -> Floats:
    """Samples (4, m, 3) of the four faces of a Bezier tet with controls (m, 3)."""
    bary = bernstein.domain_points(PARTS, 2)
    return np.array(
        [
            bernstein.values(degree, bary) @ controls[bernstein.trace(degree, 3, face)]
            for face in FACES
        ]
    )
