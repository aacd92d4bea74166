# SPDX-License-Identifier: BSD-3-Clause
"""Displacement and pressure of any law by quadrature, over arrays.

    int P(H, p) : grad v = loads on v,    int c(H, p) q = 0

c = - (J - 1) - p / kappa at finite strain, - tr eps - p / kappa at small strain; 1/kappa = 0 where
the law is incompressible. p is positive in compression, continuous, of a degree below that of u.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy.sparse import block_array, coo_array, csr_array

from bezsoma import bernstein
from bezsoma.arrays import Floats, Ints
from bezsoma.equations.pointwise import Pointwise
from bezsoma.mechanics.laws import MixedLaw
from bezsoma.mesh.control_net import ControlNet


@dataclass(frozen=True, eq=False)
class MixedPointwise:
    """What laws (one a region) answer to u (c, 3) mm and p (cp,) MPa: f (c, 3) N, g (cp,) mm3.

    With the linear law it is the mixed form of linear elasticity:

    >>> from bezsoma.equations.mixed import mixed_matrix
    >>> from bezsoma.mechanics.laws import FunctionLaw
    >>> from bezsoma.mesh.solids import block
    >>> def shape(H):
    ...     eps = (H + np.swapaxes(H, -1, -2)) / 2
    ...     mean = np.trace(eps, axis1=-2, axis2=-1)[..., None, None] / 3
    ...     return 2 * 0.4 * (eps - mean * np.eye(3))
    >>> net, pressures = (ControlNet(block(), n) for n in (3, 2))
    >>> law = FunctionLaw(shape, finite=False, kappa=2.0)
    >>> u, p = np.sin(7 * net.points), np.cos(5 * pressures.points[:, 0])
    >>> f, g = MixedPointwise(net, pressures, (law,), 6).forces(u, p)
    >>> other = mixed_matrix(net, pressures, np.array([[0.4, 1 / 2.0]])).apply(u, p)
    >>> bool(np.allclose(f, other[0], rtol=1e-12) and np.allclose(g, other[1], atol=1e-14))
    True
    """

    net: ControlNet
    pressure_net: ControlNet
    laws: Sequence[MixedLaw]
    exactness: int

    @property
    def symmetric(self) -> bool:
        """Whether all tangents are symmetric forms."""
        return all(law.symmetric for law in self.laws)

    @cached_property
    def shape(self) -> Pointwise:
        """The points, gradients and forces of the displacement."""
        return Pointwise(self.net, self.laws, self.exactness)

    @cached_property
    def _values(self) -> Floats:
        """The pressure's Bernstein polynomials at the points (q, m)."""
        return bernstein.values(self.pressure_net.degree, bernstein.simplex(self.exactness, 3)[0])

    def forces(self, u: Floats, p: Floats) -> tuple[Floats, Floats]:
        """The internal forces and the volumes out of balance; raises Inadmissible."""
        f, g = np.zeros_like(u), np.zeros_like(p)
        for law, tets, H, pressure in self.points(u, p):
            if law.finite:
                self.shape.right_side_out(H, tets)
            with np.errstate(all="ignore"):
                P, c = law.mixed_stress(H, pressure)
            self.shape.all_finite(P, tets)
            self.shape.add(f, tets, P)
            self._add(g, tets, c)
        return f, g

    def tangent(self, u: Floats, p: Floats) -> MixedArrayTangent:
        """The derivative of the forces at u and p."""
        return MixedArrayTangent(self, u, p)

    def energy(self, u: Floats, p: Floats) -> float:
        """The stored energy at u and p, N mm."""
        weights, total = self.shape.rule[1], 0.0
        for law, tets, H, pressure in self.points(u, p):
            with np.errstate(all="ignore"):
                W = law.mixed_energy(H, pressure)
            self.shape.all_finite(W, tets, "an energy")
            total += float(np.einsum("tq,q,t->", W, weights, self.net.mesh.volumes[tets]))
        return total

    def matrix(self, u: Floats, p: Floats) -> csr_array[Any]:
        """The tangent (3c + cp, 3c + cp) at u and p as a sparse matrix."""
        K: list[list[Any]] = [[[], []], [[], []]]
        wide, cp = 3 * self.net.count, self.pressure_net.count
        for law, tets, H, pressure in self.points(u, p, 24):
            of_u = (3 * self.net.of_tet[tets][:, :, None] + np.arange(3)).reshape(len(tets), -1)
            of_p = self.pressure_net.of_tet[tets]
            for i, j, block in self._blocks(law, tets, H, pressure):
                rows, columns = (of_u, of_p)[i], (of_u, of_p)[j]
                at = np.broadcast_arrays(rows[:, :, None], columns[:, None, :])
                shape = ((wide, cp)[i], (wide, cp)[j])
                flat = (at[0].ravel(), at[1].ravel())
                K[i][j].append(csr_array(coo_array((block.ravel(), flat), shape=shape)))
        return csr_array(
            block_array([[sum(K[i][j][1:], K[i][j][0]) for j in (0, 1)] for i in (0, 1)])
        )

    def _blocks(
        self, law: MixedLaw, tets: Ints, H: Floats, p: Floats
    ) -> Iterator[tuple[int, int, Floats]]:
        """The four blocks of the tangents of some tets."""
        partials, weights = self.shape.rule
        G = partials @ self.net.mesh.gradients[tets][:, None]
        N = self._values
        t, q, m, _ = G.shape
        scale = weights * self.net.mesh.volumes[tets][:, None]
        K, B = np.zeros((t, m, 3, m, 3)), np.zeros((t, N.shape[1], m, 3))
        for k in range(3):
            for along in range(3):
                unit = np.zeros((3, 3))
                unit[k, along] = 1
                dP, dc = law.mixed_derivative(H, p, np.broadcast_to(unit, H.shape), 0 * p)
                dP = dP * scale[..., None, None]
                left = (G @ np.swapaxes(dP, 2, 3)).reshape(t, q, 3 * m)
                K[..., k] += (np.swapaxes(left, 1, 2) @ G[..., along]).reshape(t, m, 3, m)
                B[..., k] += (N.T * (dc * scale)[:, None]) @ G[..., along]
        dP, dc = law.mixed_derivative(H, p, np.zeros_like(H), np.ones_like(p))
        left = (G @ np.swapaxes(dP * scale[..., None, None], 2, 3)).reshape(t, q, 3 * m)
        yield 0, 0, K.reshape(t, 3 * m, 3 * m)
        yield 0, 1, np.swapaxes(left, 1, 2) @ N
        yield 1, 0, B.reshape(t, -1, 3 * m)
        yield 1, 1, (N.T * (dc * scale)[:, None]) @ N

    def points(
        self, u: Floats, p: Floats, part: int = 1
    ) -> Iterator[tuple[MixedLaw, Ints, Floats, Floats]]:
        """The laws, some tets of their regions, H (t, q, 3, 3) and p (t, q) at their points."""
        for law, run in self.shape.runs():
            assert isinstance(law, MixedLaw)
            step = max(1, len(run) // part)
            for start in range(0, len(run), step):
                tets = run[start : start + step]
                at = p[self.pressure_net.of_tet[tets]] @ self._values.T
                yield law, tets, self.shape.gradients(u, tets), at

    def _add(self, g: Floats, tets: Ints, c: Floats) -> None:
        weighted = c * self.shape.rule[1] * self.net.mesh.volumes[tets][:, None]
        numbers = self.pressure_net.of_tet[tets].ravel()
        g += np.bincount(numbers, (weighted @ self._values).ravel(), minlength=len(g))


@dataclass(frozen=True, eq=False)
class MixedArrayTangent:
    """The tangent at u and p: nothing is kept but these."""

    of: MixedPointwise
    u: Floats
    p: Floats

    @property
    def symmetric(self) -> bool:
        """Whether it is a symmetric form."""
        return self.of.symmetric

    def apply(self, du: Floats, dp: Floats) -> tuple[Floats, Floats]:
        """The changes (c, 3) N and (cp,) mm3 for changes du (c, 3) mm and dp (cp,) MPa."""
        f, g = np.zeros_like(du), np.zeros_like(dp)
        at, by = self.of.points(self.u, self.p), self.of.points(du, dp)
        for (law, tets, H, p), (_, _, dH, d) in zip(at, by, strict=True):
            dP, dc = law.mixed_derivative(H, p, dH, d)
            self.of.shape.add(f, tets, dP)
            self.of._add(g, tets, dc)
        return f, g
