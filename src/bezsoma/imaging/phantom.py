# SPDX-License-Identifier: BSD-3-Clause
"""A head made by formula: soft tissue between skin and skull, and a lower jaw of its own.

No file of data is needed and no person is shown. Lengths are mm, the frame is LPS: x to the
patient's left, y to posterior, z to superior; the origin lies in the median plane, at the height of
the closed lips. The tables are in `anatomy`, the formulas in `sheets`.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import combinations
from types import MappingProxyType
from typing import Literal

import numpy as np
from scipy.interpolate import PchipInterpolator

from bezsoma.arrays import Bools, Floats, Ints, frozen
from bezsoma.errors import InputError, unknown
from bezsoma.imaging.anatomy import AZIMUTHS, ROWS
from bezsoma.imaging.sheets import BONE, SKIN
from bezsoma.mesh import TetMesh
from bezsoma.mesh.lattices import mirrored, prisms

Size = Literal["small", "medium", "large"]

SIZES: Mapping[str, tuple[int, int]] = MappingProxyType(
    {"small": (1, 1), "medium": (2, 1), "large": (4, 2)}
)
"""Into how many parts the columns and rows of the tables are cut, and how many layers there are."""
SPLIT = 8
"""The column where the jaw is split: in front of it the segment, behind it the rami."""
_LANDMARKS = {
    "chin": (0, "Pg'"),
    "fold": (0, "B'"),
    "lower lip": (0, "Li"),
    "upper lip": (0, "Ls"),
    "subnasale": (0, "Sn"),
    "nose tip": (0, "Prn"),
    "left cheek": (7, "Ls"),
    "right cheek": (-7, "Ls"),
}


def head_phantom(size: Size = "small") -> TetMesh:
    """A head as a TetMesh in mm, LPS, of 2772 (small), 11088 (medium) or 88704 (large) tets.

    It reaches from the upper neck to the forehead and 98 degrees to either side, between the
    skin and a deep surface. All sizes sample the same formulas: a vertex of a smaller one is a
    vertex of the larger ones. Left and right are mirror images to the last bit, tets included.
    Surfaces, which tile the boundary:

    - skin: free.
    - skull: bone that stays (with the firm frame of the nose, sinuses and orbits filled).
    - jaw: the tooth-bearing part of the mandible and the chin, the segment that is moved.
    - rami: the mandible behind the split, up to the cheekbone's arch; it stays.
    - mucosa: where the lips and cheeks lie on the teeth, free. It parts jaw and skull by 10 mm
      and more, so they share no vertex.
    - neck: its deep side below the throat, towards hyoid bone and spine; holding it keeps the
      neck from following the chin as a whole.
    - cut: where the region ends (forehead, sides, neck, and the floor of the mouth between the
      jaw's border and the throat), free.

    The jaw touches the rami along the two lines of the split and no other surface that holds:
    if skull, rami and neck are held and the jaw alone moves, one join is needed, such as
    `Graded(over="rami", to="jaw", band=10)`.

    >>> mesh = head_phantom("small")
    >>> len(mesh.tets), tuple(mesh.surfaces)
    (2772, ('skin', 'skull', 'jaw', 'rami', 'mucosa', 'neck', 'cut'))
    >>> shared = np.intersect1d(mesh.vertices_of("jaw"), mesh.vertices_of("skull"))
    >>> len(shared), sum(map(len, mesh.surfaces.values())) == len(mesh.boundary)
    (0, True)
    """
    if size not in SIZES:
        raise InputError(unknown("size", str(size), SIZES, "the head phantom"))
    parts, layers = SIZES[size]
    column, row = _grid(parts)
    deep, skin = _surfaces(column, row)
    deep[0, :, 0] = skin[0, :, 0] = 0.0  # on the mirror
    order = np.argsort(skin[..., 1].ravel().round(1), kind="stable")
    number = np.empty(column.shape, np.int64)
    number.ravel()[order] = np.arange(len(order))
    height = np.arange(layers + 1)[:, None, None] / layers
    ends = (deep.reshape(-1, 3)[order], skin.reshape(-1, 3)[order])
    points = ((1 - height) * ends[0] + height * ends[1]).reshape(-1, 3)
    placed, tets, origin = mirrored(points, _tets(points, number, layers), 1)
    mesh = TetMesh(placed, tets)
    layer, place = np.divmod(origin[mesh.boundary], len(order))
    facets = _names(
        (layer == 0).all(axis=1),
        (layer == layers).all(axis=1),
        column.ravel()[order][place].mean(axis=1),
        row.ravel()[order][place].mean(axis=1),
    )
    for name, on in facets.items():
        mesh = mesh.with_surface(name, mesh.boundary[on])
    return mesh


def landmarks() -> Mapping[str, Floats]:
    """Points (3,) in mm on the phantom's skin by name, for tables and for looking at an answer.

    They stand on the grid that all sizes share, so each is a vertex of the mesh:

    >>> mesh = head_phantom("small")
    >>> skin = mesh.points[mesh.vertices_of("skin")]
    >>> bool(max(np.abs(skin - p).max(axis=1).min() for p in landmarks().values()) < 1e-12)
    True
    """
    return {name: _on_skin(column, ROWS.index(row)) for name, (column, row) in _LANDMARKS.items()}


def _on_skin(column: int, row: int) -> Floats:
    """A point (3,) of the skin; a negative column lies on the right side."""
    _, skin = _surfaces(np.array([abs(column)], float), np.array([row], float))
    return frozen(skin[0] * [np.sign(column), 1, 1])


def _grid(parts: int) -> tuple[Floats, Floats]:
    """Columns and rows (i, j) of the left half, in the numbering of the tables."""
    columns = np.arange((len(AZIMUTHS) - 1) * parts + 1) / parts
    rows = np.arange((len(ROWS) - 1) * parts + 1) / parts
    column, row = np.meshgrid(columns, rows, indexing="ij")
    return np.asarray(column), np.asarray(row)


def _surfaces(column: Floats, row: Floats) -> tuple[Floats, Floats]:
    """Points (i, j, 3) of the deep surface and of the skin, in mm.

    Neck and forehead need no close columns in the middle, so there they spread evenly. Under the
    nose the deep columns draw together, so that the tets stand more upright on its steep sides.
    """
    last = len(AZIMUTHS) - 1
    close = np.asarray(PchipInterpolator(np.arange(last + 1), AZIMUTHS)(column))
    even = np.interp(row, [0, 1, 3, 19, 21], [1.0, 0.8, 0, 0, 0.7])
    azimuth = close + even * (AZIMUTHS[-1] * column / last - close)
    nose = np.interp(row, [9, 11, 15, 18], [0.0, 0.2, 0.2, 0])
    drawn = azimuth * (1 - nose * np.exp(-((azimuth / 20) ** 2)))
    return BONE.points(drawn, row), SKIN.points(azimuth, row)


def _tets(points: Floats, number: Ints, layers: int) -> Ints:
    """Three tets (t, 4) in each prism; of a cell's two diagonals the one with the better angles.

    A prism is cut upwards along ascending vertex numbers, so those that lie further forward come
    first: that suits the slopes of nose and lips.
    """
    a, b = number[:-1, :-1].ravel(), number[1:, :-1].ravel()
    d, c = number[:-1, 1:].ravel(), number[1:, 1:].ravel()
    ways = [
        np.stack([np.stack(first, axis=1), np.stack(second, axis=1)], axis=1)
        for first, second in (((a, b, c), (a, c, d)), ((a, b, d), (b, c, d)))
    ]
    count = number.size
    angles = [
        least_angles(points[prisms(way.reshape(-1, 3), count, layers)])
        .reshape(-1, len(a), 2)
        .min(axis=(0, 2))
        for way in ways
    ]
    better = angles[0] > angles[1] + 1e-9
    chosen = np.where(better[:, None, None], ways[0], ways[1])
    return prisms(chosen.reshape(-1, 3), count, layers)


def least_angles(corners: Floats) -> Floats:
    """The smallest dihedral angle (t,) in degrees of tets with corners (t, 4, 3).

    >>> corner = np.concatenate([np.zeros((1, 3)), np.eye(3)])
    >>> bool(abs(np.cos(np.deg2rad(least_angles(corner[None])[0])) - 3**-0.5) < 1e-15)
    True
    """
    normals = []
    for i in range(4):
        p, q, r, apex = (corners[:, (i + k) % 4] for k in (1, 2, 3, 0))
        normal = np.cross(q - p, r - p)
        inward = np.sign(np.einsum("td,td->t", normal, apex - p))
        normals.append(normal * (inward / np.linalg.norm(normal, axis=1))[:, None])
    cosines = [-np.einsum("td,td->t", m, n) for m, n in combinations(normals, 2)]
    return np.asarray(np.rad2deg(np.arccos(np.clip(np.max(cosines, axis=0), -1, 1))))


def _names(deep: Bools, skin: Bools, column: Floats, row: Floats) -> Mapping[str, Bools]:
    """Which facets (f,) belong to which surface; column and row (f,) are those of their middles.

    The lines between surfaces are rows and columns of the tables, so every size has the same.
    """
    lines = ("throat", "Me'", "Li", "Ls", "Prn")
    throat, border, lower, upper, arch = (float(ROWS.index(name)) for name in lines)
    front = deep & (column < SPLIT)
    back = deep & (column > SPLIT)
    return {
        "skin": skin,
        "skull": front & (row > upper) | back & (row > arch),
        "jaw": front & (row > border) & (row < lower),
        "rami": back & (row > border) & (row < arch),
        "mucosa": front & (row > lower) & (row < upper),
        "neck": deep & (row < throat),
        "cut": ~deep & ~skin | deep & (row > throat) & (row < border),
    }
