# SPDX-License-Identifier: BSD-3-Clause
"""Means of a displacement as weights of its controls: the loads of dual problems."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from bezsoma import bernstein
from bezsoma.arrays import Bools, Floats, Ints
from bezsoma.errors import InputError
from bezsoma.mesh.control_net import ControlNet
from bezsoma.mesh.evaluation import located, portions
from bezsoma.mesh.field import Field
from bezsoma.mesh.locator import Locator
from bezsoma.mesh.tets import TetMesh
from bezsoma.refinement.goals import Goal, PatchMean, SurfaceMean

FINE = 0.25
"""Pieces that the rim of a mean cuts are bisected until their edges are this part of its radius.

With 0.5 the sums over tets of two meshes differed by as much as a solution of degree 4 erred."""


def weights(goal: Goal, net: ControlNet) -> Floats:
    """The weights j (c, 3) [-] with J(u) = sum j u for a displacement of controls u (c, 3) mm.

    The weights of the direction add up to one, so that a body that is only shifted has the mean of
    the shift:

    >>> from bezsoma.mesh.solids import block
    >>> from bezsoma.refinement.goals import InnerMean
    >>> net = ControlNet(block(cells=2), 2)
    >>> top = PatchMean("top", at=(0.3, 0.4, 1.0), radius=0.2, direction="z")
    >>> [bool(abs(weights(goal, net).sum(axis=0) - [0, 0, 1]).max() < 1e-14) for goal in (
    ...     top, SurfaceMean("top", direction="z"), InnerMean(at=(0.5, 0.5, 0.5), radius=0.2,
    ...     direction="z"))]
    [True, True, True]

    and the mean of a linear field over a disc is its value in the middle:

    >>> bool(abs((weights(top, net)[:, 2] * net.points[:, 0]).sum() - 0.3) < 1e-5)
    True
    """
    mesh = net.mesh
    if isinstance(goal, SurfaceMean):
        facets = mesh.facets_of(goal.surface)
        numbers = net.of_facets(facets)
        shares = np.repeat(mesh.areas(facets) / numbers.shape[1], numbers.shape[1])
        along = np.bincount(numbers.ravel(), shares, net.count).astype(np.float64)
    elif isinstance(goal, PatchMean):
        facets, centre = _patch(goal, mesh)
        along = _summed(net, mesh.points[facets], net.of_facets(facets), centre, goal.radius)
    else:
        located(mesh, goal.at[None], "raise")
        tets = np.flatnonzero(_touched(mesh.points[mesh.tets], goal.at, goal.radius))
        along = _summed(net, mesh.points[mesh.tets[tets]], net.of_tet[tets], goal.at, goal.radius)
    return np.asarray(along[:, None] / along.sum() * goal.direction)


def mean(goal: Goal, displacement: Field) -> float:
    """The mean itself, mm."""
    along = weights(goal, displacement.net)
    return float(np.einsum("ck,ck->", along, displacement.controls))


def _patch(goal: PatchMean, mesh: TetMesh) -> tuple[Ints, Floats]:
    """The facets (f, 3) that are connected within the radius of the middle, and the middle."""
    facets = mesh.facets_of(goal.surface)
    near = Locator(mesh).nearest(goal.at[None], goal.surface)
    if near.distance[0] > goal.radius:
        raise InputError(
            f"PatchMean: the surface {goal.surface!r} is {near.distance[0]:.3g} mm away from "
            f"{goal.at.tolist()}, farther than the radius of {goal.radius:g} mm; give a point on "
            "the surface, or a larger radius"
        )
    own = int(near.facet[0])
    centre = near.bary[0] @ mesh.points[facets[own]]
    touched = _touched(mesh.points[facets], centre, goal.radius)
    touched[own] = True
    inside = np.flatnonzero(touched)
    rows = facets[inside]
    ones = np.ones(rows.size, dtype=np.int8)
    at = (np.repeat(np.arange(len(rows)), 3), rows.ravel())
    meets = coo_array((ones, at), shape=(len(rows), len(mesh.points))).tocsr()
    _, part = connected_components(meets @ meets.T, directed=False)
    return rows[part == part[np.flatnonzero(inside == own)[0]]], centre


def _touched(corners: Floats, centre: Floats, radius: float) -> Bools:
    """Whether simplices (s, d + 1, 3) may have a point within the radius of the centre."""
    middles = corners.mean(axis=1)
    reach = np.linalg.norm(corners - middles[:, None], axis=2).max(axis=1)
    return np.asarray(np.linalg.norm(middles - centre, axis=1) < radius + reach)


@dataclass(frozen=True, eq=False)
class _Pieces:
    """Parts of simplices: whose (p,), their corners (p, d + 1, d + 1), their share of it (p,)."""

    owner: Ints
    bary: Floats
    share: Floats


def _pieces(corners: Floats, centre: Floats, radius: float) -> _Pieces:
    """The simplices (s, d + 1, 3) bisected where the rim cuts them; far parts left out."""
    count, size = corners.shape[:2]
    pairs = np.array(list(combinations(range(size), 2)))
    left = _Pieces(np.arange(count), np.tile(np.eye(size), (count, 1, 1)), np.ones(count))
    done: list[_Pieces] = []
    while len(left.owner):
        at = left.bary @ corners[left.owner]
        lengths = np.linalg.norm(at[:, pairs[:, 0]] - at[:, pairs[:, 1]], axis=2)
        near = _touched(at, centre, radius)
        inside = (np.linalg.norm(at - centre, axis=2) <= radius).all(axis=1)
        fine = inside | (lengths.max(axis=1) <= FINE * radius)
        done.append(_some(left, near & fine))
        left = _halved(_some(left, near & ~fine), pairs[lengths.argmax(axis=1)[near & ~fine]])
    return _Pieces(
        np.concatenate([each.owner for each in done]),
        np.concatenate([each.bary for each in done]),
        np.concatenate([each.share for each in done]),
    )


def _some(pieces: _Pieces, which: Bools) -> _Pieces:
    return _Pieces(pieces.owner[which], pieces.bary[which], pieces.share[which])


def _halved(pieces: _Pieces, edges: Ints) -> _Pieces:
    """Each piece cut in two at the middle of an edge (p, 2) of its corners."""
    rows = np.arange(len(edges))
    middles = (pieces.bary[rows, edges[:, 0]] + pieces.bary[rows, edges[:, 1]]) / 2
    halves = [pieces.bary.copy(), pieces.bary.copy()]
    for side, half in enumerate(halves):
        half[rows, edges[:, side]] = middles
    owner, share = np.tile(pieces.owner, 2), np.tile(pieces.share / 2, 2)
    return _Pieces(owner, np.concatenate(halves), share)


def _summed(
    net: ControlNet, corners: Floats, numbers: Ints, centre: Floats, radius: float
) -> Floats:
    """The integrals (c,) of w(r) B_a over simplices (s, d + 1, 3) with the controls (s, m).

    w is a polynomial of degree 4 inside the ball, so that the rule is exact on pieces that lie in
    it; on those that its surface cuts, w and its slope vanish there.
    """
    pieces = _pieces(corners, centre, radius)
    sides = corners[:, 1:] - corners[:, :1]
    measures = np.sqrt(np.linalg.det(sides @ np.swapaxes(sides, 1, 2)))
    bary, shares = bernstein.simplex(net.degree + 4, corners.shape[1] - 1)
    total = np.zeros(net.count)
    for part in portions(len(pieces.owner), len(shares) * numbers.shape[1]):
        owner = pieces.owner[part]
        points = bary @ pieces.bary[part]
        r2 = ((points @ corners[owner] - centre) ** 2).sum(axis=2) / radius**2
        w = np.maximum(1 - r2, 0) ** 2 * shares * (measures[owner] * pieces.share[part])[:, None]
        values = bernstein.values(net.degree, points.reshape(-1, points.shape[2]))
        work = np.einsum("pq,pqm->pm", w, values.reshape(*w.shape, -1))
        total += np.bincount(numbers[owner].ravel(), work.ravel(), net.count)
    return total
