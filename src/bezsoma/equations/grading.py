# SPDX-License-Identifier: BSD-3-Clause
"""Distances to a line of mesh edges, and the smooth step that grades a jump over a band."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import combinations

import numpy as np
from scipy.spatial import KDTree

from bezsoma.arrays import Floats, Ints
from bezsoma.errors import InputError
from bezsoma.mechanics.body import Body
from bezsoma.mechanics.joins import Graded
from bezsoma.mechanics.meeting import meeting, own_simplices
from bezsoma.mechanics.supports import Support, prescribes
from bezsoma.mesh.control_net import ControlNet

Function = Callable[[Floats], Floats]

_AT_ONCE = 1 << 20


def smooth_step(s: Floats) -> Floats:
    """w(s) = 1 - 3 s^2 + 2 s^3 on [0, 1]: 1 at 0, 0 at 1 and beyond, both ends with slope 0.

    >>> smooth_step(np.array([0, 0.5, 1, 7])).tolist()
    [1.0, 0.5, 0.0, 0.0]
    """
    s = np.clip(s, 0.0, 1.0)
    return (1 - s) ** 2 * (1 + 2 * s)


def distances(points: Floats, segments: Floats, upto: float = np.inf) -> Floats:
    """Distances (p,) mm of points (p, 3) to the nearest of segments (s, 2, 3), exact.

    Points farther than `upto` may be given as infinitely far. A segment may be one point twice.

    >>> line = np.array([[[0.0, 0, 0], [2, 0, 0]], [[5, 0, 0], [5, 0, 0]]])
    >>> distances(np.array([[1.0, 3, 0], [-3, 4, 0], [5, 0, 0.5]]), line).tolist()
    [3.0, 5.0, 0.5]
    """
    reach = float(np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1).max()) / 2
    near, _ = KDTree(segments.mean(axis=1)).query(points)
    far = np.full(len(points), np.inf)
    candidates = np.flatnonzero(near <= (upto + reach) * (1 + 1e-12))
    size = max(1, _AT_ONCE // len(segments))
    for start in range(0, len(candidates), size):
        chunk = candidates[start : start + size]
        far[chunk] = _nearest(points[chunk], segments)
    return far


def _nearest(points: Floats, segments: Floats) -> Floats:
    along = segments[:, 1] - segments[:, 0]
    lengths = np.einsum("sx,sx->s", along, along)
    offset = points[:, None] - segments[None, :, 0]
    foot = np.einsum("psx,sx->ps", offset, along) / np.where(lengths > 0, lengths, 1)
    offset -= np.clip(foot, 0, 1)[..., None] * along
    nearest: Floats = np.sqrt(np.einsum("psx,psx->ps", offset, offset).min(axis=1))
    return nearest


def graded_displacement(support: Support, place: str, body: Body) -> Function:
    """The displacement that a support prescribes on a place, with its bands graded."""
    function: Function = support.displacement
    for join in body.joins:
        if isinstance(join, Graded) and join.over == place:
            function = _graded(function, support, join, body)
    return function


def _graded(base: Function, support: Support, join: Graded, body: Body) -> Function:
    segments = body.mesh.points[meeting(body.mesh, join.over, join.to)]
    targets = {
        axis: graded_displacement(other, join.to, body)
        for other in reversed(body.supports)
        if join.to in other.places
        for axis in np.flatnonzero(prescribes(other) & prescribes(support))
    }

    def graded(points: Floats) -> Floats:
        values = base(points).copy()
        weight = smooth_step(distances(points, segments, join.band) / join.band)
        inside = np.flatnonzero(weight > 0)
        for axis, target in targets.items():
            jump = target(points[inside])[:, axis] - values[inside, axis]
            values[inside, axis] += weight[inside] * jump
        return values

    return graded


def bands_checked(joins: Sequence[Graded], net: ControlNet) -> None:
    """Check the bands on one place: long enough for the controls there, and clear of each other."""
    for join in joins:
        _long_enough(join, net)
    for one, other in combinations(joins, 2):
        _bands_apart(one, other, net)


def _long_enough(join: Graded, net: ControlNet) -> None:
    """Refuse a band that ends before the first control off the line: it would grade nothing."""
    mesh = net.mesh
    line = meeting(mesh, join.over, join.to)
    points = net.points[net.of_place(join.over)]
    away = distances(points, mesh.points[line])
    off = away[away > 1e-9 * join.band]
    if not (off < join.band).any():
        nearest = f"the nearest is {off.min():.3g} mm away" if len(off) else "there is none"
        raise InputError(
            f"{join}: no control of {join.over!r} lies off the line within the band of "
            f"{join.band:g} mm, {nearest} (mesh edges there are "
            f"{_edge_length(net, join, line):.3g} mm long, degree {net.degree}), so the jump "
            "would stay one element wide; give a longer band, a finer mesh or a higher degree, or "
            "state Precedence"
        )


def _bands_apart(one: Graded, other: Graded, net: ControlNet) -> None:
    """Refuse two bands on a place that overlap: the later would undo the earlier on its line."""
    points = net.points[net.of_place(one.over)]
    inside = [
        distances(points, net.mesh.points[meeting(net.mesh, *join.places)], join.band) < join.band
        for join in (one, other)
    ]
    both = np.flatnonzero(inside[0] & inside[1])
    if len(both):
        x, y, z = points[both[0]]
        raise InputError(
            f"{one} and {other} overlap at {len(both)} controls of {one.over!r}, first at "
            f"({x:.6g}, {y:.6g}, {z:.6g}) mm, so neither line would get its value; give shorter "
            "bands, or make one of the joins a Gap or a Precedence"
        )


def _edge_length(net: ControlNet, join: Graded, line: Ints) -> float:
    """The mean length [mm] of the edges of `over` that leave the line."""
    rows = own_simplices(net.mesh, join.over)
    rows = rows[np.isin(rows, line).any(axis=1)]
    ends = [net.mesh.points[rows[:, i]] for i in range(rows.shape[1])]
    lengths = [np.linalg.norm(a - b, axis=1) for a, b in combinations(ends, 2)]
    return float(np.mean(lengths)) if lengths else 0.0
