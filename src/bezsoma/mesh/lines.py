# SPDX-License-Identifier: BSD-3-Clause
"""Probes along a straight line: where it runs through which tet, and what fields are there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from bezsoma import bernstein
from bezsoma.arrays import Floats, Ints
from bezsoma.errors import InputError
from bezsoma.mesh import evaluation
from bezsoma.mesh.broken_field import BrokenField
from bezsoma.mesh.field import Field
from bezsoma.mesh.locator import Locator, finite
from bezsoma.mesh.nouns import mesh_given
from bezsoma.mesh.tets import TetMesh

_NOTHING = 1e-12
"""Pieces shorter than this part of the line are left out."""


@dataclass(frozen=True, eq=False)
class Line:
    """A straight line through a body, in s pieces of one tet each; where it is outside, none.

    On each piece a field of degree n is a polynomial of degree n in the distance.
    """

    mesh: TetMesh
    tets: Ints
    """(s,) the tet of each piece; on a face between two, the one of the lower number."""
    span: Floats
    """(s, 2) where it begins and ends, in mm from the start of the line."""
    bary: Floats
    """(s, 2, 4) the same places, barycentric in the tet."""

    def at(self, field: Field | BrokenField, parts: int | None = None) -> tuple[Floats, Floats]:
        """Distances (p,) in mm and values (p, ...), `parts` steps for each piece.

        Every piece has both its ends, so that a field that jumps has two values there. Without
        `parts` there are as many as the degree, and the values determine the polynomial.
        """
        steps = max(1, field.degree) if parts is None else parts
        if steps < 1:
            raise InputError(f"pieces cannot be taken in {parts} parts; give 1 or more")
        weights = bernstein.domain_points(steps, 1)
        bary = (weights @ self.bary).reshape(-1, 4)
        values = evaluation.values(field, np.repeat(self.tets, len(weights)), bary)
        return (self.span @ weights.T).ravel(), values

    def integral(self, field: Field | BrokenField) -> Floats:
        """The integral along the line (...), value times mm, exact.

        >>> from bezsoma.mesh import ControlNet, block
        >>> net = ControlNet(block(), 3)
        >>> cube = Field.interpolating(net, lambda x: 4 * x[:, 0] ** 3)
        >>> line = line_through(net.mesh, [-1, 0.3, 0.3], [2, 0.3, 0.3])
        >>> float(np.round(line.integral(cube), 12)), len(np.unique(line.tets)) > 1
        (1.0, True)
        """
        bary, weights = bernstein.simplex(max(1, field.degree), 1)
        places = (bary @ self.bary).reshape(-1, 4)
        values = evaluation.values(field, np.repeat(self.tets, len(bary)), places)
        each = values.reshape(len(self.tets), len(bary), *field.shape)
        return np.asarray(np.einsum("s,q,sq...->...", np.diff(self.span)[:, 0], weights, each))


def line_through(mesh: TetMesh, start: npt.ArrayLike, end: npt.ArrayLike) -> Line:
    """The straight line from one point (3,) to another, in mm, through a body before it moves.

    Refused where it misses the body altogether.
    """
    mesh_given(mesh, "line_through(mesh, start, end)")
    first, last = finite(np.stack([np.asarray(start, float), np.asarray(end, float)]))
    length = float(np.linalg.norm(last - first))
    if not length > 0:
        raise InputError(
            f"a line from {first.tolist()} to the same point has no direction; give two that differ"
        )
    stops = _stops(mesh, first, last)
    tets, _ = Locator(mesh).tets_of(_between(first, last, (stops[1:] + stops[:-1]) / 2))
    held = (tets >= 0) & (np.diff(stops) > _NOTHING)
    if not held.any():
        raise InputError(
            f"the line from {first.tolist()} to {last.tolist()} mm misses the body, which reaches "
            f"from {mesh.box[0].tolist()} to {mesh.box[1].tolist()}"
        )
    along = np.stack([stops[:-1], stops[1:]], axis=1)[held]
    tets = tets[held]
    offset = _between(first, last, along) - mesh.points[mesh.tets[tets, 0]][:, None]
    bary = np.einsum("sid,sed->sei", mesh.gradients[tets], offset)
    bary[..., 0] += 1.0
    return Line(mesh, tets, length * along, bary)


def _between(start: Floats, end: Floats, shares: Floats) -> Floats:
    return start + shares[..., None] * (end - start)


def _stops(mesh: TetMesh, start: Floats, end: Floats) -> Floats:
    """The shares of the way, from 0 to 1, at which the line enters or leaves a tet, in order.

    The barycentric coordinates are linear along the line; it is in a tet while all are positive.
    """
    found = [np.array([0.0, 1.0])]
    for part in evaluation.portions(len(mesh.tets), 64):
        first = mesh.points[mesh.tets[part, 0]]
        at_start = np.einsum("tid,td->ti", mesh.gradients[part], start - first)
        at_start[:, 0] += 1.0
        slope = np.einsum("tid,d->ti", mesh.gradients[part], end - start)
        with np.errstate(divide="ignore", invalid="ignore"):
            zero = -at_start / slope
        enters = np.where(slope > 0, zero, -np.inf).max(axis=1)
        leaves = np.where(slope < 0, zero, np.inf).min(axis=1)
        crossed = (enters < leaves) & (leaves > 0) & (enters < 1)
        found += [enters[crossed], leaves[crossed]]
    return np.unique(np.clip(np.concatenate(found), 0.0, 1.0))
