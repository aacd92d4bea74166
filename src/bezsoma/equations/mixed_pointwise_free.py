# SPDX-License-Identifier: BSD-3-Clause
"""Laws in displacement and pressure without a matrix: up to nu = 1/2."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bezsoma import _core
from bezsoma.arrays import Floats, plain
from bezsoma.equations.inadmissible import refuse_inadmissible
from bezsoma.equations.pointwise_free import pointwise_kernel
from bezsoma.mesh.control_net import ControlNet


@dataclass(frozen=True, eq=False)
class PointwiseMixed:
    """What laws answer to displacements u (c, 3) mm and pressures p (cp,) MPa: (f, g).

    As `PointwiseFree`, with a second net of degree 1 to k - 1 for the pressure, positive in
    compression:

        f_a = V sum_q w_q P(H, p) grad B_a         g_b = V sum_q w_q c(H, p) B_b
        small strain:  P = tau' - p I              c = -tr eps - p / kappa
        finite strain: P = P' - p cof F            c = -(J - 1) - p / kappa

    A law that stiffens in volume too has kappa exp(A s^2) there, so that both forms are one model.
    kappa may be infinite. Every law has to split (`law.splits`). The tangent of laws with an energy
    is symmetric and has directions of negative energy.

    The linear law does what needs no quadrature:

    >>> from bezsoma import bernstein
    >>> from bezsoma.equations.mixed_free import MixedFree
    >>> from bezsoma.mesh.solids import block
    >>> mesh = block(cells=2, irregular=0.3)
    >>> net, pressures = ControlNet(mesh, 3), ControlNet(mesh, 1)
    >>> u, p = np.sin(7 * net.points), np.cos(pressures.points[:, 0])
    >>> law = _core.Law("linear", [np.inf, 0.4])
    >>> f, g = PointwiseMixed(net, pressures, (law,), *bernstein.simplex(4, 3)).forces(u, p)
    >>> F, G = MixedFree(net, pressures, np.array([[0.4, 0.0]])).apply(u, p)
    >>> bool(abs(f - F).max() < 1e-13 * abs(F).max() and abs(g - G).max() < 1e-13 * abs(G).max())
    True
    """

    net: ControlNet
    pressures: ControlNet
    laws: tuple[_core.Law, ...]
    points: Floats
    weights: Floats
    threads: int = 0
    instructions: str = ""

    @cached_property
    def kernel(self) -> _core.Pointwise:
        """The core's side of it."""
        rule, net = (self.points, self.weights), self.pressures
        return pointwise_kernel(
            self.net, self.laws, rule, self.threads, self.instructions, pressures=net
        )

    @property
    def symmetric(self) -> bool:
        """Whether every law has an energy: then tangents are symmetric forms."""
        return all(law.has_energy for law in self.laws)

    def forces(self, u: Floats, p: Floats) -> tuple[Floats, Floats]:
        """The internal forces f (c, 3) N and changes of volume g (cp,) mm3."""
        f, g = np.empty((self.net.count, 3)), np.empty(self.pressures.count)
        self.kernel.mixed_forces(plain(u), plain(p), f, g)
        refuse_inadmissible(self.kernel, self.net.mesh, self.points, f)
        return f, g

    def tangent(self, u: Floats, p: Floats) -> MixedTangent:
        """The derivative of both at (u, p), as what it does to a change of them."""
        return MixedTangent(self, plain(u).copy(), plain(p).copy())

    def energy(self, u: Floats, p: Floats) -> float:
        """Int W' - p (J - 1) - p^2 / (2 kappa) [N mm], whose derivatives are f and g."""
        energy = self.kernel.mixed_energy(plain(u), plain(p))
        refuse_inadmissible(self.kernel, self.net.mesh, self.points, np.array(energy))
        return energy

    def least_jacobian(self, u: Floats) -> tuple[float, int, int]:
        """The least J = det(I + H) of all points, with its tet and point; inf at small strain."""
        f, p = np.empty((self.net.count, 3)), np.zeros(self.pressures.count)
        self.kernel.mixed_forces(plain(u), p, f, np.empty_like(p))
        return self.kernel.least_jacobian


@dataclass(frozen=True, eq=False)
class MixedTangent:
    """The derivative at a state (u, p): (df, dg) = tangent.apply(du, dp)."""

    operator: PointwiseMixed
    u: Floats
    p: Floats

    @property
    def symmetric(self) -> bool:
        """Whether it is a symmetric form."""
        return self.operator.symmetric

    def apply(self, du: Floats, dp: Floats) -> tuple[Floats, Floats]:
        """The changes of f (c, 3) N and g (cp,) mm3."""
        df, dg = np.empty_like(self.u), np.empty_like(self.p)
        self.operator.kernel.mixed_tangent(self.u, self.p, plain(du), plain(dp), df, dg)
        return df, dg
