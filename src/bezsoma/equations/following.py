# SPDX-License-Identifier: BSD-3-Clause
"""Pressure that follows the surface as it deforms: forces, and how they change with it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy.sparse import coo_array, csr_array

from bezsoma import bernstein
from bezsoma.arrays import Floats, Ints
from bezsoma.mechanics.loads import Pressure
from bezsoma.mesh.control_net import ControlNet


@dataclass(frozen=True, eq=False)
class FollowingPressure:
    """The forces of p on the deformed facets of one surface, x = X + u of degree n.

        f_a = -int p B_a (x_s x x_t) ds dt,    df_a = -int p B_a (du_s x x_t + x_s x du_t) ds dt

    s, t are barycentric coordinates such that x_s x x_t points out. The integrand is a polynomial
    of degree 3 n - 2, times p: the quadrature is exact where p is one (J. Bonet and R. D. Wood,
    Nonlinear Continuum Mechanics, 2nd ed., 2008, section 8.5). The change is no symmetric form
    unless the pressed surface is closed or its rim is held.

    On a surface that does not move it is a dead pressure:

    >>> from bezsoma.equations.forces import forces
    >>> from bezsoma.mechanics import Body, Fixed, LinearElastic
    >>> from bezsoma.mesh.solids import block
    >>> mesh, load = block(cells=2), Pressure("top", value=0.5)
    >>> net = ControlNet(mesh, 3)
    >>> dead = forces(Body(mesh, 3, LinearElastic(1.0, 0.3), [Fixed("bottom")], [load]), net)
    >>> f = FollowingPressure(net, load, "top").forces(np.zeros_like(dead))
    >>> bool(np.allclose(f, dead, atol=1e-16))
    True
    """

    net: ControlNet
    load: Pressure
    surface: str

    @cached_property
    def _controls(self) -> Ints:
        return self.net.of_facets(self._facets)

    @cached_property
    def _facets(self) -> Ints:
        return self.net.mesh.facets_of(self.surface)

    @cached_property
    def _places(self) -> Floats:
        """The undeformed domain points of the facets (f, m, 3)."""
        corners = self.net.mesh.points[self._facets]
        return np.asarray(bernstein.domain_points(self.net.degree, 2) @ corners)

    @cached_property
    def _rule(self) -> tuple[Floats, Floats, Floats, Floats]:
        """Values (q, m), slopes by s and t (q, m) each, and signed p times weights (f, q)."""
        n, load = self.net.degree, self.load
        exactness = 3 * n - 2 + (n + 2 if load.value.degree is None else load.value.degree)
        bary, weights = bernstein.simplex(max(exactness, load.exactness or 0), 2)
        partials = bernstein.derivatives(n, bary)
        slopes = partials[..., 1:] - partials[..., :1]
        points = bary @ self.net.mesh.points[self._facets]
        p = load.value(points.reshape(-1, 3)).reshape(points.shape[:2])
        turned = (self.net.mesh.outward(self._facets) != self._facets).any(axis=1)
        sign = np.where(turned, -1.0, 1.0)[:, None]
        return bernstein.values(n, bary), slopes[..., 0], slopes[..., 1], p * weights * sign / 2

    def forces(self, u: Floats) -> Floats:
        """The forces (c, 3) N on the controls at u (c, 3) mm."""
        values, by_s, by_t, p = self._rule
        x = self._places + u[self._controls]
        normals = np.cross(by_s @ x, by_t @ x)
        work = -np.einsum("qm,fq,fqk->fmk", values, p, normals, optimize=True)
        f = np.zeros_like(u)
        for k in range(3):
            f[:, k] = np.bincount(self._controls.ravel(), work[..., k].ravel(), len(u))
        return f

    def matrix(self, u: Floats) -> csr_array[Any]:
        """The change of the forces by the controls (3c, 3c) N/mm at u (c, 3), index 3c + k."""
        values, by_s, by_t, p = self._rule
        x = self._places + u[self._controls]
        # -(du_s x x_t + x_s x du_t) = ([x_t] B_s - [x_s] B_t) du, [a] b = a x b.
        spin_s, spin_t = _spin(by_s @ x), _spin(by_t @ x)
        sides = ((spin_t, by_s, 1.0), (spin_s, by_t, -1.0))
        blocks = sum(
            sign * np.einsum("qa,fq,fqij,qb->faibj", values, p, spin, slope, optimize=True)
            for spin, slope, sign in sides
        )
        rows = (3 * self._controls[:, :, None] + np.arange(3)).reshape(len(x), -1)
        size, wide = 3 * len(u), rows.shape[1]
        at = (np.repeat(rows, wide, axis=1).ravel(), np.tile(rows, (1, wide)).ravel())
        return csr_array(coo_array((np.asarray(blocks).ravel(), at), shape=(size, size)))


def _spin(a: Floats) -> Floats:
    """The matrices (..., 3, 3) of a x, for a (..., 3)."""
    S = np.zeros((*a.shape, 3))
    S[..., 0, 1], S[..., 0, 2], S[..., 1, 2] = -a[..., 2], a[..., 1], -a[..., 0]
    return S - np.swapaxes(S, -1, -2)
