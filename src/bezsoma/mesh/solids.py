# SPDX-License-Identifier: BSD-3-Clause
"""Simple solids by formula, with named surfaces: for tests, cases and first steps. Lengths mm.

Kuhn tets (see `lattices`) fill blocks; those with a >= b >= c at every corner cut one tet into
n**3, which fills an octant of a ball. Stacks of prisms give bars and hollow spheres.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from bezsoma.arrays import Bools, Floats, Ints
from bezsoma.errors import InputError, MeshError
from bezsoma.mesh.lattices import kuhn, mirrored, prisms, radii, triangle
from bezsoma.mesh.tets import TetMesh

Triple = tuple[float, float, float]
SIDES = (("left", "right"), ("front", "back"), ("bottom", "top"))
"""Surfaces of a block: low and high side along x, y and z."""


def block(
    size: Triple = (1.0, 1.0, 1.0),
    cells: int | tuple[int, int, int] = 1,
    origin: Triple = (0.0, 0.0, 0.0),
    irregular: float = 0.0,
    seed: int = 0,
) -> TetMesh:
    """A block of `size` mm from `origin` mm: six Kuhn tets in each of its cells.

    Surfaces: left, right (x), front, back (y), bottom, top (z). `irregular` moves every vertex,
    within the face or edge of the block it lies on, by at most half that part of a cell in each
    coordinate; up to 1/3 no tet can turn over.

    >>> mesh = block(size=(2, 3, 4), cells=(3, 2, 2), irregular=0.3)
    >>> len(mesh.tets), bool(abs(mesh.volumes.sum() - 24) < 1e-13)
    (72, True)
    >>> [round(float(mesh.areas(mesh.surfaces[name]).sum()), 9) for name in ("left", "top")]
    [12.0, 6.0]
    """
    _positive(size=size)
    counts = _counts(cells, 3, "cells")
    if not 0 <= irregular <= 1:
        raise InputError(f"irregular is {irregular}; a number from 0 to 1 is needed (say 0.3)")
    lattice, tets = kuhn(counts)
    free = (lattice > 0) & (lattice < counts)
    shift = np.random.default_rng(seed).uniform(-0.5, 0.5, lattice.shape)
    points = np.array(origin) + (lattice + irregular * free * shift) / counts * np.array(size)
    sides = {
        name: lattice[:, axis] == value
        for axis, names in enumerate(SIDES)
        for name, value in zip(names, (0, counts[axis]), strict=True)
    }
    try:
        return _named(points, tets, sides)
    except MeshError as error:
        if irregular <= 1 / 3:
            raise
        raise InputError(
            f"irregular={irregular} folds this block; 1/3 or less never does"
        ) from error


def square_bar(
    width: float = 1.0, length: float = 5.0, cells: int = 4, layers: int = 10
) -> TetMesh:
    """A bar of square section about the z axis, `width` mm wide, z from 0 to `length` mm.

    Surfaces: those of `block`, of which bottom and top are its ends.
    """
    half = -width / 2
    return block((width, width, length), (cells, cells, layers), origin=(half, half, 0.0))


def round_bar(
    radius: float = 1.0, length: float = 5.0, cells: int = 3, layers: int = 10
) -> TetMesh:
    """A bar of round section about the z axis, `radius` mm, z from 0 to `length` mm.

    Surfaces: side, bottom and top. `cells` triangles lie along the radius; the side has 4 `cells`
    facets around, its corners on the circle, so the section is a polygon (a little small):

    >>> import math
    >>> volume = round_bar(radius=2, length=3, cells=5).volumes.sum()
    >>> bool(abs(volume / 3 - 10 * 2**2 * math.sin(math.tau / 20)) < 1e-12)
    True
    """
    _positive(radius=radius, length=length)
    counts = _counts((cells, layers), 2, "cells and layers")
    corners, triangles = triangle(int(counts[0]))
    level = corners.sum(axis=1)
    angle = corners / np.maximum(level, 1)[:, None] * np.pi / 2
    quarter = np.where(corners > 0, np.sin(angle), 0.0) * level[:, None] * radius / counts[0]
    disc = np.column_stack([quarter, np.zeros(len(quarter))])
    disc, triangles, origin = mirrored(disc, triangles, 2)
    rim, count = level[origin] == counts[0], len(disc)
    points = np.tile(disc, (counts[1] + 1, 1))
    points[:, 2] = np.repeat(np.arange(counts[1] + 1) * length / counts[1], count)
    layer = np.repeat(np.arange(counts[1] + 1), count)
    tets = prisms(triangles, count, int(counts[1]))
    return _named(
        points,
        tets,
        {"bottom": layer == 0, "top": layer == counts[1], "side": np.tile(rim, counts[1] + 1)},
    )


def ball(radius: float = 1.0, cells: int = 4, octant: bool = False) -> TetMesh:
    """A ball of `radius` mm about the origin, `cells` tets along the radius; or its octant >= 0.

    Surfaces: outer; the octant also x0, y0, z0, on the planes of symmetry. Vertices of `outer`
    lie on the sphere; the facets are flat, so the volume is a little small, by order 1/cells**2.
    """
    _positive(radius=radius)
    count = int(_counts((cells,), 1, "cells")[0])
    lattice, tets = kuhn(np.array([count] * 3))
    inside = (lattice[:, 0] >= lattice[:, 1]) & (lattice[:, 1] >= lattice[:, 2])
    a, b, c = lattice.T
    corner = np.column_stack([a - b, b - c, c]).astype(float)
    points = corner * (radius * a / count / radii(corner))[:, None]
    keep = np.cumsum(inside) - 1
    tets = keep[tets[inside[tets].all(axis=1)]]
    return _octants(points[inside], tets, {"outer": a[inside] == count}, octant)


def shell(
    inner: float = 1.0,
    outer: float = 2.0,
    cells: int = 4,
    layers: int | None = None,
    octant: bool = True,
) -> TetMesh:
    """A hollow sphere about the origin, radii `inner` and `outer` mm; its octant >= 0, or whole.

    Surfaces: inner, outer; the octant also x0, y0, z0, on the planes of symmetry. An octant has
    cells**2 triangles; the radii of the layers grow geometrically, so tets keep their shape, and
    without `layers` there are as many as make them about as thick as wide.
    """
    _positive(inner=inner, outer=outer)
    if inner >= outer:
        raise InputError(f"a shell from {inner} to {outer} mm is empty; inner must be the smaller")
    count = int(_counts((cells,), 1, "cells")[0])
    if layers is None:
        layers = max(1, round(2 * count / np.pi * float(np.log(outer / inner)) * 1.2))
    layers = int(_counts((layers,), 1, "layers")[0])
    plane, triangles = triangle(count)
    corner = np.column_stack([plane, count - plane.sum(axis=1)]).astype(float)
    corner /= radii(corner)[:, None]
    distance = inner * (outer / inner) ** (np.arange(layers + 1) / layers)
    distance[-1] = outer
    points = (distance[:, None, None] * corner).reshape(-1, 3)
    layer = np.repeat(np.arange(layers + 1), len(corner))
    tets = prisms(triangles, len(corner), layers)
    return _octants(points, tets, {"inner": layer == 0, "outer": layer == layers}, octant)


def cook(cells: int | tuple[int, int, int] = (8, 8, 1), thickness: float = 1.0) -> TetMesh:
    """Cook's membrane as a slab: 48 mm long, 44 mm high where clamped, 16 mm where loaded.

    Corners (0, 0), (48, 44), (48, 60), (0, 44) in x and y; z from 0 to `thickness` mm. Surfaces:
    clamped (x = 0), loaded (x = 48), lower, upper, front and back (z = 0 and `thickness`).

    >>> volume = cook(cells=(4, 3, 1), thickness=2.0).volumes.sum()
    >>> round(float(volume), 9) == 2 * 48 * (44 + 16) / 2
    True
    """
    _positive(thickness=thickness)
    counts = _counts(cells, 3, "cells")
    lattice, tets = kuhn(counts)
    u, v, w = (lattice / counts).T
    points = np.column_stack([48 * u, 44 * (u + v) - 28 * u * v, thickness * w])
    names = (("clamped", "loaded"), ("lower", "upper"), ("front", "back"))
    sides = {
        name: lattice[:, axis] == value
        for axis, pair in enumerate(names)
        for name, value in zip(pair, (0, counts[axis]), strict=True)
    }
    return _named(points, tets, sides)


def l_block(arm: float = 1.0, thickness: float = 1.0, cells: int = 2, layers: int = 1) -> TetMesh:
    """An L of three squares of `arm` mm, `thickness` mm high, its inner corner on the z axis.

    x and y from -arm to arm, without the quarter x > 0 > y. Surfaces: left, right, front, back,
    bottom, top, and notch (the two sides that meet at the inner corner); edge place: corner (the
    line x = y = 0, where stress is singular). `cells` and `layers` are counted along an arm.
    """
    _positive(arm=arm, thickness=thickness)
    n, m = _counts((cells, layers), 2, "cells and layers")
    lattice, tets = kuhn(np.array([2 * n, 2 * n, m]))
    x, y, z = (lattice - np.array([n, n, 0])).T
    filled = (x[tets].max(axis=1) <= 0) | (y[tets].min(axis=1) >= 0)
    used = np.unique(tets[filled])
    x, y, z = x[used], y[used], z[used]
    points = np.column_stack([x, y, z]) * np.array([arm / n, arm / n, thickness / m])
    planes = {"left": x == -n, "right": x == n, "front": y == -n, "back": y == n}
    low = {"bottom": z == 0, "top": z == m}
    mesh = _named(points, np.searchsorted(used, tets[filled]), {**planes, **low})
    sides = [(x == 0) & (y <= 0), (y == 0) & (x >= 0)]
    notch = [_facets(mesh.boundary, side) for side in sides]
    mesh = mesh.with_surface("notch", np.concatenate(notch))
    return mesh.with_edges("corner", [(0.0, 0.0, 0.0), (0.0, 0.0, thickness)])


def _octants(points: Floats, tets: Ints, rounds: Mapping[str, Bools], octant: bool) -> TetMesh:
    """The octant with its planes of symmetry named, or the eight of them."""
    if octant:
        planes = {f"{axis}0": points[:, i] == 0 for i, axis in enumerate("xyz")}
        return _named(points, tets, {**rounds, **planes})
    whole, tets, origin = mirrored(points, tets, 3)
    return _named(whole, tets, {name: on[origin] for name, on in rounds.items()})


def _named(points: Floats, tets: Ints, places: Mapping[str, Bools]) -> TetMesh:
    """The mesh, with a surface for every mask of vertices: the boundary facets within it."""
    mesh = TetMesh(points, tets)
    for name, on in places.items():
        mesh = mesh.with_surface(name, _facets(mesh.boundary, on))
    return mesh


def _facets(boundary: Ints, on: Bools) -> Ints:
    return np.asarray(boundary[on[boundary].all(axis=1)])


def _positive(**lengths: float | Triple) -> None:
    for name, length in lengths.items():
        if not (np.isfinite(length).all() and (np.asarray(length) > 0).all()):
            raise InputError(f"{name} is {length} mm; lengths must be positive and finite")


def _counts(given: int | tuple[int, ...], count: int, name: str) -> Ints:
    numbers = np.broadcast_to(np.asarray(given), (count,)) if np.ndim(given) == 0 else given
    array = np.asarray(numbers)
    if array.shape != (count,) or array.dtype.kind not in "iu" or (array < 1).any():
        raise InputError(f"{name} is {given}; {count} whole number(s) from 1 up are needed")
    return array.astype(np.int64)
