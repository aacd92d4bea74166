# SPDX-License-Identifier: BSD-3-Clause
"""From the domain of a head to tets with named surfaces, and how good they are."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from math import exp, floor, log, log2
from typing import Any

import numpy as np

from bezsoma.arrays import Bools, Floats, Ints
from bezsoma.errors import InputError
from bezsoma.imaging.domain import SURFACES, Domain
from bezsoma.mesh import TetMesh
from bezsoma.mesh.bettered import bettered
from bezsoma.mesh.graded import ROUNDED, Octree, lattice
from bezsoma.mesh.pinches import pinched, unpinched
from bezsoma.mesh.quality import dihedral_angles, mean_ratios
from bezsoma.mesh.stuffing import Level, Stuffed, stuffed

CUT = "cut"
HELD = ("skull", "mandible")
SMALLEST, LARGEST = 0.2, 50.0
"""mm: cells that can be asked for."""
MOST_LEVELS = 3
"""The largest cells are at most 2**3 times as long as the smallest."""
TRIALS, CLOSE = 8, 0.03
"""How often lengths are scaled for a number of tets, and how close to it is close enough."""
FIRST, POWER = 1.6, 2.4
"""Where scaling begins, and how the number of tets falls with lengths: most lie at surfaces."""
MOST_CELLS = 60_000_000
"""Finest cells in the box; more would not fit into memory."""


@dataclass(frozen=True)
class Sizes:
    """How long the cells are in which tets are made; mm. Edges of tets are 0.87 and 1 of them.

    The size wanted is the least of `segment`, `skin` and `bone`, each grown by `growth` of the
    distance from there, and of `largest`; where two surfaces lie close, `layer` of the thickness
    between them, down to half of `segment`, so that no layer is pierced. Cells halve in length, so
    what is made is between 0.7 and 1.4 of it.
    """

    segment: float = 3.0
    """At the moved bone."""
    skin: float = 5.0
    bone: float = 4.0
    """At every other surface."""
    largest: float = 12.0
    growth: float = 0.5
    layer: float = 0.5

    def __post_init__(self) -> None:
        for name in ("segment", "skin", "bone", "largest"):
            if not SMALLEST <= getattr(self, name) <= LARGEST:
                raise InputError(
                    f"{name}={getattr(self, name)}: {SMALLEST:g} to {LARGEST:g} mm can be made"
                )
        for name in ("growth", "layer"):
            if not 0 < getattr(self, name) <= 2:
                raise InputError(f"{name}={getattr(self, name)}: more than 0, at most 2, is needed")

    def scaled(self, factor: float) -> Sizes:
        """All lengths times a factor, none beyond what can be asked for.

        >>> Sizes().scaled(2).segment
        6.0
        """
        lengths = ("segment", "skin", "bone", "largest")
        return replace(
            self, **{name: min(LARGEST, factor * getattr(self, name)) for name in lengths}
        )

    def wanted(self, domain: Domain, points: Floats) -> Floats:
        """Sizes (p,) at points (p, 3) of a domain."""
        depth = np.abs(domain.at(domain.level, points))
        sizes = np.full(len(points), float(self.largest))
        for least, away in (
            (self.segment, domain.at(domain.to_segment, points)),
            (self.skin, domain.at(domain.to_skin, points)),
            (self.bone, depth),
        ):
            np.minimum(sizes, least + self.growth * away, out=sizes)
        thin = self.layer * domain.at(domain.thickness, points)
        return np.asarray(np.minimum(sizes, np.maximum(thin, self.finest)))

    @property
    def finest(self) -> float:
        """mm: the smallest cells."""
        return self.segment / 2

    def stated(self) -> dict[str, float]:
        """Name and value of every setting, for reports."""
        return {field.name: getattr(self, field.name) for field in fields(self)}


@dataclass(frozen=True, eq=False)
class FaceMesh:
    """Tets of a face with surfaces skin, skull, mandible, cut, gap, mucosa: those there are."""

    mesh: TetMesh
    report: Mapping[str, object]
    """Sizes and quality in numbers; lengths mm, angles degrees."""


def face_mesh(domain: Domain, sizes: Sizes | None = None) -> FaceMesh:
    """The domain as tets; the same input gives the same bits."""
    sizes = Sizes() if sizes is None else sizes
    level = _level(domain, sizes)
    filled, facets, names = _whole(domain, sizes, level)
    filled = bettered(filled, level)
    mesh = TetMesh(filled.points, filled.tets)
    for name in (*SURFACES, CUT):
        if (names == name).any():
            mesh = mesh.with_surface(name, facets[names == name])
    return FaceMesh(mesh, _report(domain, mesh))


def sizes_for(domain: Domain, tets: int, sizes: Sizes | None = None) -> Sizes:
    """Sizes scaled alike until the domain has so many tets: what of eight trials came nearest.

    Tets are counted as they are made, before their vertices are moved for better angles.
    """
    sizes = Sizes() if sizes is None else sizes
    tried: dict[float, float] = {}
    factor = FIRST
    for _ in range(TRIALS):
        scaled = sizes.scaled(factor)
        filled, _, _ = _whole(domain, scaled, _level(domain, scaled))
        tried[factor] = log(len(filled.tets) / tets)
        if abs(tried[factor]) < CLOSE:
            break
        factor = _next_factor(tried)
    return sizes.scaled(min(tried, key=lambda factor: abs(tried[factor])))


def _next_factor(tried: Mapping[float, float]) -> float:
    """What to scale lengths by next; `tried` has the logarithm of tets over those wanted by factor.

    By the power that most tets follow, and between two factors that enclose what is wanted:

    >>> round(_next_factor({1.0: 2.4 * log(2)}), 9), round(_next_factor({1.0: 0.1, 16.0: -0.3}), 9)
    (2.0, 2.0)
    """
    small = max((f for f, over in tried.items() if over > 0), default=None)
    large = min((f for f, over in tried.items() if over <= 0), default=None)
    if small is None or large is None or small >= large:
        nearest = min(tried, key=lambda factor: abs(tried[factor]))
        return nearest * min(3.0, max(1 / 3, exp(tried[nearest] / POWER)))
    part = tried[small] / (tried[small] - tried[large])
    return float(small * (large / small) ** min(0.8, max(0.2, part)))


def _whole(domain: Domain, sizes: Sizes, level: Level) -> tuple[Stuffed, Ints, Any]:
    """Tets of one piece, none of them held at all corners; the facets and names of its boundary."""
    filled = _one_piece(_filled(domain, sizes, level))
    facets, names = _named(domain, filled)
    held = np.zeros(len(filled.points), np.bool_)
    held[facets[np.isin(names, HELD)]] = True
    return filled.split(np.flatnonzero(held[filled.tets].all(axis=1))), facets, names


def _filled(domain: Domain, sizes: Sizes, level: Level) -> Stuffed:
    """The lattice, fine where it has to be, and what of it lies in tissue."""
    levels = _levels(domain, sizes)
    origin, step, counts = _grid(domain, sizes.finest, 2**levels)
    cells = np.moveaxis(np.indices(counts), 0, -1).reshape(-1, 3) + 0.5
    centres = origin + cells * step
    inside = domain.at(domain.level, centres) <= sizes.finest * 2**levels
    wanted = np.full(len(centres), np.inf)
    wanted[inside] = sizes.wanted(domain, centres[inside])
    octree = Octree.of(wanted.reshape(counts), sizes.finest, levels)
    vertices, tets = lattice(octree)
    ends = np.stack([vertices == 0, vertices == 2 * np.array(counts)])
    on_side: Bools = np.asarray((ends & ~domain.open[:, None]).any(axis=0))
    points = origin + vertices * (step / 2)
    return stuffed(points, tets, on_side, level)


def _levels(domain: Domain, sizes: Sizes) -> int:
    """How often the largest cells that are wanted anywhere can be halved.

    No more: the box is filled with whole largest cells, and the fewer these are, the more all cells
    are stretched for it.
    """
    tissue = np.argwhere(domain.level[::3, ::3, ::3] < 0)[:, ::-1] * 3
    largest = float(sizes.wanted(domain, domain.frame.points(tissue)).max(initial=sizes.finest))
    return min(MOST_LEVELS, max(0, floor(log2(largest / sizes.finest / ROUNDED))))


def _grid(domain: Domain, finest: float, coarse: int) -> tuple[Floats, Floats, tuple[int, ...]]:
    """Origin (3,), step (3,) and number of finest cells along each axis.

    Between two cuts the cells are stretched to fit; a side in air moves out instead.
    """
    extent = domain.high - domain.low
    free = domain.open.any(axis=0)
    whole = extent / (finest * coarse)
    blocks = np.where(free, np.ceil(whole), np.maximum(1, np.rint(whole))).astype(int)
    counts = blocks * coarse
    step = np.where(free, finest, extent / counts)
    origin = np.where(domain.open[0], domain.high - counts * step, domain.low)
    if np.prod(counts, dtype=float) > MOST_CELLS:
        raise InputError(
            f"cells of {finest:g} mm would fill the domain of {extent.round().tolist()} mm with "
            f"{np.prod(counts, dtype=float):.2g}; take larger ones, or a smaller domain"
        )
    return origin, step, tuple(counts.tolist())


def _level(domain: Domain, sizes: Sizes) -> Level:
    """The level of the tissue; within half a cell of a cut it does not change across the cut.

    There the surface stands upright on the cut, so that a vertex on the cut can be moved onto the
    surface without leaving the cut, and no tet is squeezed between a cut and a surface along it.
    """
    near = 0.5 * max(sizes.skin, sizes.bone)
    low = np.where(domain.open[0], -np.inf, domain.low + near)
    high = np.where(domain.open[1], np.inf, domain.high - near)

    def level(points: Floats) -> Floats:
        return domain.at(domain.level, np.clip(points, low, high))

    return level


def _one_piece(filled: Stuffed) -> Stuffed:
    """The largest part that hangs together by faces, its boundary nowhere meeting itself."""
    if not len(filled.tets):
        raise InputError("the cells are too large for the tissue in the domain: take smaller ones")
    filled = filled.of(unpinched(filled.points, filled.tets))
    part = TetMesh(filled.points, filled.tets).components()
    return filled.of(part == np.bincount(part).argmax())


def _named(domain: Domain, filled: Stuffed) -> tuple[Ints, Any]:
    """The facets (b, 3) of the boundary, and what each is."""
    facets = TetMesh(filled.points, filled.tets).boundary
    corners = filled.points[facets]
    flat = filled.on_side[facets].all(axis=1) & (np.ptp(corners, axis=1) == 0)
    border = domain.at(domain.border, corners.mean(axis=1), order=0).astype(int)
    return facets, np.where(flat.any(axis=1), CUT, np.array(SURFACES)[border])


def _report(domain: Domain, mesh: TetMesh) -> dict[str, object]:
    """Counts, angles, and how far the surfaces lie from where the voxels have them."""
    angles = dihedral_angles(mesh)
    held = np.zeros(len(mesh.points), np.bool_)
    off: dict[str, float] = {}
    voxel = float(domain.frame.spacing.mean())
    for name in (name for name in mesh.surfaces if name != CUT):
        facets = mesh.surfaces[name]
        held[facets] |= name in HELD
        samples = np.concatenate([mesh.points[facets].mean(axis=1), mesh.points[np.unique(facets)]])
        off[name] = float(np.abs(domain.at(domain.exact, samples)).mean() / voxel)
    return {
        "tets": len(mesh.tets),
        "vertices": len(mesh.points),
        "least_dihedral": float(angles.min()),
        "largest_dihedral": float(angles.max()),
        "mean_ratio_least": float(mean_ratios(mesh).min()),
        "mean_ratio_mean": float(mean_ratios(mesh).mean()),
        "held_tets": int(held[mesh.tets].all(axis=1).sum()),
        "pinched_edges": len(pinched(mesh.boundary)),
        "volume": float(mesh.volumes.sum()),
        "volume_of_voxels": domain.volume(),
        "off_voxels": off,
        "areas": {name: float(mesh.areas(f).sum()) for name, f in mesh.surfaces.items()},
    }
