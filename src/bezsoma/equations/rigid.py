# SPDX-License-Identifier: BSD-3-Clause
"""Rigid motions that supports leave, found before anything is solved, and named.

Tets that are joined face to face move as one: where no tet of such a *part* is strained, the part
moves rigidly (a strain-free displacement of a tet is affine and skew, and two of them that agree
on a face are equal). So a body has six unknowns a part and no more, whatever its degree:

    u(x) = t + w x (x - c) / r,   with the centre c and the radius r of the part.

Each prescribed component of a control is one equation, at its domain point (linear precision);
each vertex that two parts share is three. The solutions are what the stiffness matrix cannot
resist. Parts that meet in an edge or a vertex only are hinged there, and nothing else holds them.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from bezsoma.arrays import Bools, Floats, Ints
from bezsoma.equations.motions import SMALL, Motions, sentence, unwelded
from bezsoma.equations.parts import Parts, parts_of
from bezsoma.errors import InputError
from bezsoma.mesh.control_net import ControlNet
from bezsoma.mesh.topology import slices

MOST_COUPLED = 200
"""Parts that hang together by edges and vertices and are looked at as one dense problem."""


def refuse_rigid_motions(net: ControlNet, held: Bools) -> None:
    """Raise an InputError that names what can still move rigidly; held (c, 3) is prescribed.

    >>> from bezsoma.mesh.solids import block
    >>> net = ControlNet(block(), 1)
    >>> held = np.zeros((net.count, 3), bool)
    >>> held[net.of_place("bottom")] = True
    >>> refuse_rigid_motions(net, held)
    >>> held[:, :2] = False
    >>> try:
    ...     refuse_rigid_motions(net, held)
    ... except InputError as refused:
    ...     print(str(refused).split(": ")[1].split(". ")[0])
    the body can still translate in every direction across z, and rotate about the axis through \
(0.5, 0.5, 0.5) mm along z
    """
    parts = parts_of(net.mesh)
    left = rigid_motions(net, held, parts)
    if left:
        message = unwelded(parts.mesh, parts.label, left)
        raise InputError(
            message or sentence(left, parts.count, parts.hinged(motions.part for motions in left))
        )


def rigid_motions(net: ControlNet, held: Bools, parts: Parts) -> list[Motions]:
    """The motions that are left, for each part that has any.

    First each part by itself. One that its supports hold is ground for its neighbours: the
    vertices it shares are held, which may hold further parts in turn. What then remains is
    looked at together, group by group.
    """
    joints = _Joints.of(parts)
    resisted = _resisted(net, held, parts)
    loose = _held_in_turn(parts, joints, resisted)
    left = []
    for number, group in enumerate(_groups(parts, joints, loose)):
        left += _group_motions(parts, joints, resisted, group, number)
    return left


@dataclass(frozen=True, eq=False)
class _Joints:
    """Vertices shared by parts: vertex (k,) and part (k,), of each such vertex all its parts."""

    vertex: Ints
    part: Ints

    @classmethod
    def of(cls, parts: Parts) -> _Joints:
        shared = np.bincount(parts.vertex)[parts.vertex] > 1
        order = np.argsort(parts.vertex[shared], kind="stable")
        return cls(parts.vertex[shared][order], parts.part[shared][order])

    def on(self, chosen: Iterable[int]) -> Ints:
        """The vertices of these parts that are shared with any other."""
        return np.unique(self.vertex[np.isin(self.part, list(chosen))])


Resisted = dict[int, Floats]
"""For each part with any equation: a matrix (k, 6) of few rows with the same null space."""


def _resisted(net: ControlNet, held: Bools, parts: Parts) -> Resisted:
    """The equations of the prescribed components, part by part."""
    any_held: Bools = np.asarray(held.any(axis=1))
    keys = [np.zeros(0, np.int64)]
    for tets in slices(len(parts.label)):
        of_tet = net.closure(3, tets)
        tet, local = np.nonzero(any_held[of_tet])
        keys.append(np.unique(parts.label[tets][tet] * net.count + of_tet[tet, local]))
    part, control = np.divmod(np.unique(np.concatenate(keys)), net.count)
    found: Resisted = {}
    for rows in np.split(np.arange(len(part)), np.flatnonzero(np.diff(part)) + 1):
        if len(rows):
            own = control[rows]
            equations = _equations(parts, part[rows[0]], net.points[own])
            found[int(part[rows[0]])] = _fewer(equations[held[own]])
    return found


def _equations(parts: Parts, part: int, points: Floats) -> Floats:
    """The rows (q, 3, 6) that take (t, w) of a part to u at points (q, 3), mm for unit motions."""
    x, y, z = ((points - parts.centre[part]) / parts.radius[part]).T
    zero = np.zeros_like(x)
    turn = np.array([[zero, z, -y], [-z, zero, x], [y, -x, zero]])  # w -> w x (x, y, z)
    rows = np.empty((len(points), 3, 6))
    rows[:, :, :3] = np.eye(3)
    rows[:, :, 3:] = np.moveaxis(turn, 2, 0)
    return rows


def _fewer(rows: Floats) -> Floats:
    """At most as many rows as columns, with the same lengths of images.

    In pieces: a tall matrix at once wakes the threads of BLAS, which wait for more to do without
    sleeping, for a tenth of a second, on cores that the solver's threads are about to use.
    """
    columns = rows.shape[1]
    while len(rows) > columns:
        piece = min(len(rows), max(256, 2 * columns))
        whole = np.zeros((-(-len(rows) // piece), piece, columns))
        whole.reshape(-1, columns)[: len(rows)] = rows
        rows = np.asarray(np.linalg.qr(whole, mode="r")).reshape(-1, columns)
    return rows


def _null_space(rows: Floats, tolerance: float) -> Floats:
    """An orthonormal basis (columns, q) of what the rows take to almost nothing."""
    _, sizes, right = np.linalg.svd(rows, full_matrices=True)
    rank = int((sizes > tolerance * sizes.max(initial=0.0)).sum())
    return np.asarray(right[rank:].T)


def _held_in_turn(parts: Parts, joints: _Joints, resisted: Resisted) -> Bools:
    """Which parts are not held (p,); joints with held ones are added to what is resisted."""
    loose = np.ones(parts.count, dtype=bool)
    ground = np.zeros(len(parts.mesh.points), dtype=bool)
    asked: Iterable[int] = list(resisted)
    while True:
        firm = [p for p in asked if loose[p] and _is_held(parts, p, resisted[p])]
        if not firm:
            return loose
        loose[firm] = False
        new = joints.on(firm)
        new = new[~ground[new]]
        ground[new] = True
        touched = loose[joints.part] & np.isin(joints.vertex, new)
        asked = np.unique(joints.part[touched]).tolist()
        for p in asked:
            here = joints.vertex[touched & (joints.part == p)]
            rows = _equations(parts, p, parts.mesh.points[here]).reshape(-1, 6)
            resisted[p] = _fewer(np.concatenate([resisted.get(p, rows[:0]), rows]))


def _is_held(parts: Parts, part: int, rows: Floats) -> bool:
    return not _null_space(rows, parts.tolerance(np.array([part]))).size


def _groups(parts: Parts, joints: _Joints, loose: Bools) -> list[Ints]:
    """The loose parts, those that share vertices in one group."""
    between = loose[joints.part]
    graph = coo_array(
        (
            np.ones(int(between.sum()), dtype=bool),
            (joints.part[between], joints.vertex[between] + parts.count),
        ),
        (parts.count + len(parts.mesh.points),) * 2,
    )
    group = connected_components(graph, directed=False)[1][: parts.count]
    chosen = np.flatnonzero(loose)
    chosen = chosen[np.argsort(group[chosen], kind="stable")]
    return np.split(chosen, np.flatnonzero(np.diff(group[chosen])) + 1) if len(chosen) else []


def _group_motions(
    parts: Parts, joints: _Joints, resisted: Resisted, group: Ints, number: int
) -> list[Motions]:
    """The motions of the parts of one group, which all of its equations leave."""
    if len(group) > MOST_COUPLED:
        raise InputError(
            f"{len(group)} parts of the mesh hang together by single vertices or edges, the first "
            f"around {parts.centre[group[0]].round(3).tolist()} mm; whether so many hinges hold "
            f"each other is not looked into beyond {MOST_COUPLED} parts: join them by faces, or "
            "support each of them"
        )
    null = _coupled(parts, joints, resisted, group)
    return [
        Motions(int(p), number, int(parts.tets[p]), parts.centre[p], float(parts.radius[p]), basis)
        for p, basis in zip(group, null.reshape(len(group), 6, -1), strict=True)
        if (np.abs(basis) > SMALL).any()
    ]


def _coupled(parts: Parts, joints: _Joints, resisted: Resisted, group: Ints) -> Floats:
    """A basis (6 g, q) of the joint motions of a group of g parts."""
    if len(group) == 1 and int(group[0]) not in resisted:
        return np.eye(6)
    rows = [np.zeros((0, 6 * len(group)))]
    for i, part in enumerate(group.tolist()):
        if part in resisted:
            rows.append(_placed(resisted[part], i, len(group)))
    rows += _joint_rows(parts, joints, group)
    return _null_space(np.concatenate(rows), parts.tolerance(group))


def _joint_rows(parts: Parts, joints: _Joints, group: Ints) -> list[Floats]:
    """For each vertex that parts of the group share: their displacements there are equal."""
    inside = np.isin(joints.part, group)
    vertex, part = joints.vertex[inside], np.searchsorted(group, joints.part[inside])
    rows = []
    for k in np.flatnonzero(vertex[1:] == vertex[:-1]):
        point = parts.mesh.points[vertex[k : k + 1]]
        one, other = (
            _placed(_equations(parts, group[part[k + j]], point)[0], part[k + j], len(group))
            for j in (0, 1)
        )
        rows.append(one - other)
    return rows


def _placed(rows: Floats, at: int, count: int) -> Floats:
    """Rows (k, 6) of one part among the columns (k, 6 count) of all."""
    wide = np.zeros((len(rows), count, 6))
    wide[:, at] = rows
    return wide.reshape(len(rows), -1)
