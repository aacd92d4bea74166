# SPDX-License-Identifier: BSD-3-Clause
"""Continuous fields: a control net and its controls."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bezsoma.arrays import Floats, Ints, frozen
from bezsoma.errors import InputError
from bezsoma.mesh import evaluation
from bezsoma.mesh.broken_field import BrokenField
from bezsoma.mesh.control_net import ControlNet
from bezsoma.mesh.evaluation import Outside
from bezsoma.mesh.functions import Function
from bezsoma.mesh.subdivision import Subdivision, subdivision
from bezsoma.mesh.surface_field import SurfaceField
from bezsoma.mesh.tets import TetMesh

__all__ = ["BrokenField", "Field", "SurfaceField"]


@dataclass(frozen=True, eq=False)
class Field:
    """A continuous field: its controls (c,) or (c, ...) on a net.

    On a tet it is sum_a b_a B_a, the H u hat of the paper (eqs. 1, 27, 28 and 29).

    A value may be a number, a vector (3,) or of any shape; `...` below stands for it.

    >>> from bezsoma.mesh.solids import block
    >>> net = ControlNet(block(cells=(2, 2, 2)), 2)
    >>> field = Field.interpolating(net, lambda x: x[:, 0] * x[:, 1])
    >>> points = np.array([[0.25, 0.5, 0.75]])
    >>> bool(np.allclose(field.at(points), 0.125) and np.allclose(
    ...     field.gradient(points), [0.5, 0.25, 0.0]))
    True
    """

    net: ControlNet
    controls: Floats

    def __post_init__(self) -> None:
        if not isinstance(self.net, ControlNet):
            raise InputError(
                f"Field(net, controls): a {type(self.net).__name__} cannot be the net; give "
                "ControlNet(mesh, degree)"
            )
        try:
            controls = np.asarray(self.controls, dtype=np.float64)
        except (TypeError, ValueError):
            raise InputError(
                f"Field(net, controls): a {type(self.controls).__name__} that is no array of "
                "numbers cannot be the controls; Field.interpolating takes functions"
            ) from None
        if controls.shape[:1] != (self.net.count,):
            raise InputError(
                f"controls of shape {controls.shape} were given; the net of degree "
                f"{self.net.degree} has {self.net.count} controls, the length of the first axis"
            )
        object.__setattr__(self, "controls", frozen(controls.view()))

    @classmethod
    def interpolating(cls, net: ControlNet, function: Function | Floats) -> Field:
        """The field that takes a function's values in the domain points of the net.

        A polynomial of the net's degree or less is reproduced; see `ControlNet.interpolated`.
        """
        return cls(net, net.interpolated(function))

    @property
    def mesh(self) -> TetMesh:
        """The mesh."""
        return self.net.mesh

    @property
    def degree(self) -> int:
        """The degree n."""
        return self.net.degree

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of a value: () for a scalar, (3,) for a displacement."""
        return self.controls.shape[1:]

    @property
    def of_tet(self) -> Floats:
        """The controls tet by tet (t, m, ...)."""
        return self.on_tets(slice(None))

    def on_tets(self, tets: Ints | slice) -> Floats:
        """The controls of some tets (q, m, ...)."""
        return self.controls[self.net.of_tet[tets]]

    def at(self, points: Floats, outside: Outside = "raise") -> Floats:
        """The values (p, ...) at points (p, 3) in mm.

        Args:
            points: anywhere in the mesh; 1e-10 of a tet's size outside still counts as inside.
            outside: what to do with points outside: "raise" an error that names the first of
                them, take the value at the "nearest" point of the boundary, or give "nan".
        """
        return evaluation.at(self, points, outside)

    def gradient(self, points: Floats, outside: Outside = "raise") -> Floats:
        """The gradients (p, ..., 3) at points (p, 3), a value a mm; the last axis is d/dx_j.

        It jumps from tet to tet; a point on a face takes it from the tet of the lowest number.
        """
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

    def gradient_field(self) -> BrokenField:
        """The gradient in closed form: a broken field of degree n - 1, controls (t, m, ..., 3)."""
        controls = evaluation.gradient_controls(self, slice(None))
        return BrokenField(self.mesh, self.degree - 1, controls)

    def elevated(self, degree: int) -> Field:
        """The same field, written in a higher degree.

        b^{n+1}_a = sum_i a_i / (n+1) b^n_{a - e_i}, done once for each edge, face and interior.
        """
        net = ControlNet(self.mesh, degree)
        if degree < self.degree:
            raise InputError(
                f"degree {self.degree} cannot be lowered to {degree} without loss; give "
                f"{self.degree} or more"
            )
        return Field(net, net.elevated(self.controls, self.net))

    def subdivided(self, into: Subdivision | None = None) -> Field:
        """The same polynomials on a finer mesh: every tet cut in eight, or as `into` says.

        Give the same `subdivision(mesh)` for several fields that are to share the finer mesh.
        Neighbours agree about their shared controls up to rounding; one of them is kept.
        """
        into = subdivision(self.mesh) if into is None else into
        net = ControlNet(into.fine, self.degree)
        controls = np.empty((net.count, *self.shape))
        controls[net.of_tet] = into.nets(self)
        return Field(net, controls)

    def on_surface(self, place: str | Ints | None = None) -> SurfaceField:
        """The field on a named surface, on facets given as (f, 3), or on the whole boundary."""
        facets = self.mesh.boundary if place is None else place
        facets = self.mesh.facets_of(facets) if isinstance(facets, str) else np.asarray(facets)
        numbers = self.net.of_facets(facets)
        return SurfaceField(self.mesh, facets, self.degree, numbers, self.controls[numbers])

    def bounds(self, tolerance: float | None = None) -> tuple[Floats, Floats]:
        """A lower and an upper bound (...) of the values, component by component.

        Without a tolerance the least and the largest control, which enclose the field since a
        Bernstein polynomial stays within the convex hull of its controls; else `bounds_of_tets`
        brings them that close to the true extremes.
        """
        return evaluation.bounds(self, tolerance)

    def bounds_of_tets(self, tolerance: float | None = None) -> tuple[Floats, Floats]:
        """A lower and an upper bound (t, ...) of the values on every tet, component by component.

        Args:
            tolerance: how far, at most, a bound may be from the true extreme, in the value's unit;
                reached by subdividing where it matters. Without it the controls are the bounds.
        """
        return evaluation.bounds_of_tets(self, tolerance)

    def integral(self) -> Floats:
        """The integral over the mesh (...), value times mm3, in closed form."""
        return evaluation.integral(self)

    def l2_norm(self) -> float:
        """sqrt(int |u|^2 dV) over all components, in closed form."""
        return evaluation.l2_norm(self)

    def h1_seminorm(self) -> float:
        """sqrt(int |grad u|^2 dV) over all components and directions, in closed form."""
        return evaluation.h1_seminorm(self)

    def l2_error(self, function: Function, exactness: int | None = None) -> float:
        """sqrt(int |u - f|^2 dV) by quadrature; see `evaluation.l2_error`."""
        return evaluation.l2_error(self, function, exactness)

    def h1_error(self, gradient: Function, exactness: int | None = None) -> float:
        """sqrt(int |grad u - g|^2 dV) by quadrature, for g (p, ..., 3) = grad f."""
        return evaluation.h1_error(self, gradient, exactness)
