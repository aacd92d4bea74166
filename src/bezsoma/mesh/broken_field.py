# SPDX-License-Identifier: BSD-3-Clause
"""Fields that jump between tets: strains, stresses, broken pressures."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from bezsoma import bernstein
from bezsoma.arrays import Floats, Ints, frozen
from bezsoma.errors import InputError
from bezsoma.mesh import evaluation
from bezsoma.mesh.control_net import ControlNet
from bezsoma.mesh.evaluation import Outside
from bezsoma.mesh.functions import Function
from bezsoma.mesh.subdivision import Subdivision, subdivision
from bezsoma.mesh.tets import TetMesh

if TYPE_CHECKING:
    from bezsoma.mesh.field import Field


@dataclass(frozen=True, eq=False)
class BrokenField:
    """A polynomial of one degree on every tet, each with controls of its own (t, m, ...).

    The gradient of a continuous field is one: on a face it has two values, and which of them a
    point on the face is given is settled (the tet of the lowest number), not meaningful.

    >>> from bezsoma.mesh.solids import block
    >>> mesh = block(cells=(2, 1, 1))
    >>> number = BrokenField(mesh, 0, np.arange(len(mesh.tets))[:, None])
    >>> bool((number.at(mesh.points[mesh.tets].mean(axis=1)) == np.arange(12)).all())
    True
    """

    mesh: TetMesh
    degree: int
    controls: Floats

    def __post_init__(self) -> None:
        controls = np.asarray(self.controls, dtype=np.float64)
        expected = (len(self.mesh.tets), bernstein.count(self.degree, 3))
        if controls.shape[:2] != expected:
            raise InputError(
                f"controls of shape {controls.shape} were given; a broken field of degree "
                f"{self.degree} on this mesh has {expected} and then the shape of a value"
            )
        object.__setattr__(self, "controls", frozen(controls.view()))

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of a value: () for a scalar, (3,) for a vector, (3, 3) for a stress."""
        return self.controls.shape[2:]

    @property
    def of_tet(self) -> Floats:
        """The controls tet by tet (t, m, ...)."""
        return self.controls

    def on_tets(self, tets: Ints | slice) -> Floats:
        """The controls of some tets (q, m, ...)."""
        return self.controls[tets]

    def at(self, points: Floats, outside: Outside = "raise") -> Floats:
        """The values (p, ...) at points (p, 3) in mm; `outside` as in `Field.at`."""
        return evaluation.at(self, points, outside)

    def gradient(self, points: Floats, outside: Outside = "raise") -> Floats:
        """The gradients (p, ..., 3) at points (p, 3) in mm, a value a mm."""
        return evaluation.at(self, points, outside, gradient=True)

    def at_bary(self, tets: Ints, bary: Floats) -> Floats:
        """The values (p, ...) at one barycentric point (p, 4) in each of the tets (p,)."""
        return evaluation.values(self, np.asarray(tets), np.asarray(bary))

    def gradient_bary(self, tets: Ints, bary: Floats) -> Floats:
        """The gradients (p, ..., 3) at one barycentric point (p, 4) in each of the tets (p,)."""
        return evaluation.gradients(self, np.asarray(tets), np.asarray(bary))

    def tabulated(self, bary: Floats, tets: Ints | slice = slice(None)) -> Floats:
        """The values (t, b, ...) at the same barycentric points (b, 4) in every tet."""
        return evaluation.tabulated(self, np.asarray(bary), tets)

    def elevated(self, degree: int) -> BrokenField:
        """The same polynomials, written in a higher degree."""
        if degree < self.degree:
            raise InputError(
                f"degree {self.degree} cannot be lowered to {degree} without loss; give "
                f"{self.degree} or more"
            )
        matrix = bernstein.elevation(self.degree, 3, degree - self.degree)
        raised = np.moveaxis(np.tensordot(matrix, self.controls, (1, 1)), 0, 1)
        return BrokenField(self.mesh, degree, raised)

    def subdivided(self, into: Subdivision | None = None) -> BrokenField:
        """The same polynomials on a finer mesh; see `Field.subdivided`."""
        into = subdivision(self.mesh) if into is None else into
        return BrokenField(into.fine, self.degree, into.nets(self))

    def averaged(self, net: ControlNet | None = None) -> Field:
        """The continuous field of the same degree from means over the tets at each control.

            b_c = sum_t V_t b_{t,c} / sum_t V_t   over the tets t that share control c

        A field that is continuous already comes back.  It smooths a stress for a picture or a
        probe; across regions it mixes what truly jumps.  Degree 0 is written in degree 1 first,
        as no continuous field but a constant has degree 0.

        Args:
            net: a net of this mesh and degree, where one is at hand.
        """
        from bezsoma.mesh.field import Field  # the two kinds of field turn into each other

        if self.degree == 0:
            return self.elevated(1).averaged(net)
        net = ControlNet(self.mesh, self.degree) if net is None else net
        if net.mesh is not self.mesh or net.degree != self.degree:
            raise InputError(
                f"a net of degree {net.degree}{'' if net.mesh is self.mesh else ', other mesh,'} "
                f"was given; one of the field's own mesh and degree {self.degree} is needed"
            )
        owner = net.of_tet.ravel()
        weights = np.broadcast_to(self.mesh.volumes[:, None], net.of_tet.shape).ravel()
        total = np.bincount(owner, weights, net.count)
        local = self.controls.reshape(len(owner), -1)
        means = [np.bincount(owner, weights * column, net.count) / total for column in local.T]
        return Field(net, np.stack(means, axis=1).reshape(net.count, *self.shape))

    def bounds(self, tolerance: float | None = None) -> tuple[Floats, Floats]:
        """A lower and an upper bound (...) of the values, component by component.

        `tolerance` as in `Field.bounds`.
        """
        return evaluation.bounds(self, tolerance)

    def bounds_of_tets(self, tolerance: float | None = None) -> tuple[Floats, Floats]:
        """A lower and an upper bound (t, ...) on every tet; see `Field.bounds_of_tets`."""
        return evaluation.bounds_of_tets(self, tolerance)

    def largest(self) -> tuple[float, Floats]:
        """The largest magnitude in the domain points of all tets, and where it is, (3,) in mm.

        The magnitude is the root of the sum of squares of a value's components.
        """
        bary = bernstein.domain_points(max(self.degree, 1), 3)
        best, where = -1.0, np.zeros(3)
        for part in evaluation.tet_portions(self, len(bary)):
            found = self.tabulated(bary, part)
            squares = (found**2).reshape(*found.shape[:2], -1).sum(axis=2)
            tet, point = np.unravel_index(squares.argmax(), squares.shape)
            if squares[tet, point] > best:
                best = float(squares[tet, point])
                where = bary[point] @ self.mesh.points[self.mesh.tets[part][tet]]
        return float(np.sqrt(best)), where

    def integral(self) -> Floats:
        """The integral over the mesh (...), value times mm3, in closed form."""
        return evaluation.integral(self)

    def l2_norm(self) -> float:
        """sqrt(int |u|^2 dV) over all components, in closed form."""
        return evaluation.l2_norm(self)

    def l2_error(self, function: Function, exactness: int | None = None) -> float:
        """sqrt(int |u - f|^2 dV) by quadrature; see `evaluation.l2_error`."""
        return evaluation.l2_error(self, function, exactness)
