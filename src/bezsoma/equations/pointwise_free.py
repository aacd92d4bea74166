# SPDX-License-Identifier: BSD-3-Clause
"""Forces and tangents of any law of the core, without a matrix: by quadrature, compiled."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bezsoma import _core, bernstein
from bezsoma.arrays import Floats, Singles, plain
from bezsoma.equations.inadmissible import refuse_inadmissible
from bezsoma.equations.matrix_free import walk
from bezsoma.equations.threads import thread_count
from bezsoma.mesh.control_net import ControlNet

ROUGH = 1e-3
"""What float32 may err by, of the largest force; it errs by some 1e-6 unless it overflows."""
LEAST = 1e-12
"""Forces [N] for a change of 1 mm from this on to its inverse are in reach of float32, with what is
a millionth of them and its square."""


def pointwise_kernel(
    net: ControlNet,
    laws: tuple[_core.Law, ...],
    rule: tuple[Floats, Floats],
    threads: int,
    instructions: str,
    single: bool = False,
    pressures: ControlNet | None = None,
) -> _core.Pointwise:
    """The core's side of laws on a net by a rule of points and weights, also beside a pressure."""
    points, weights = rule
    return _core.Pointwise(
        walk(net, np.zeros((len(net.mesh.regions), 2))),
        list(laws),
        points,
        weights,
        bernstein.values(net.degree - 1, points),
        thread_count(threads),
        instructions,
        single,
        pressures.degree if pressures else 0,
        pressures.walked() if pressures else None,
    )


@dataclass(frozen=True, eq=False)
class PointwiseFree:
    """What a body of given laws answers to displacements (c, 3) mm: forces (c, 3) N, tangents.

    `laws` has one law a region of the mesh. `points` (q, 4) barycentric and `weights` (q,) with sum
    1 are a quadrature rule (`bernstein.simplex`). With H = grad u and P the law's stress,

        f_a = V sum_q w_q P(H(x_q)) grad B_a(x_q)

    (Roth et al. 1998, eq. 45; doi:10.1111/1467-8659.00289). See docs/theory/laws.md. The answer has
    the same bits for any number of `threads` (0: all cores). A state that a law cannot bear raises
    `Inadmissible`, which says where.

    For the linear law any rule of exactness 2 (degree - 1) gives what needs no quadrature:

    >>> from bezsoma.equations.matrix_free import MatrixFree
    >>> from bezsoma.mesh.solids import block
    >>> net = ControlNet(block(cells=2), 3)
    >>> kappa, mu = 2.0, 0.6
    >>> law = _core.Law("linear", [kappa, mu])
    >>> u = np.sin(7 * net.points)
    >>> f = PointwiseFree(net, (law,), *bernstein.simplex(4, 3)).forces(u)
    >>> K = MatrixFree(net, np.array([[kappa - 2 * mu / 3, mu]]))
    >>> bool(abs(f - K @ u).max() < 1e-13 * abs(f).max())
    True
    """

    net: ControlNet
    laws: tuple[_core.Law, ...]
    points: Floats
    weights: Floats
    threads: int = 0
    instructions: str = ""

    @cached_property
    def kernel(self) -> _core.Pointwise:
        """The core's side of it."""
        return self._kernel(single=False)

    @cached_property
    def single(self) -> _core.Pointwise:
        """The same in float32: tangents alone."""
        return self._kernel(single=True)

    def _kernel(self, single: bool) -> _core.Pointwise:
        rule = self.points, self.weights
        return pointwise_kernel(self.net, self.laws, rule, self.threads, self.instructions, single)

    @property
    def symmetric(self) -> bool:
        """Whether every law has an energy: then tangents are symmetric forms."""
        return all(law.has_energy for law in self.laws)

    def forces(self, u: Floats) -> Floats:
        """The internal forces (c, 3) N at u (c, 3) mm."""
        f = np.empty((self.net.count, 3))
        self.kernel.forces(plain(u), f)
        refuse_inadmissible(self.kernel, self.net.mesh, self.points, f)
        return f

    def tangent(self, u: Floats) -> Tangent:
        """The derivative of the forces at u, as what it does to a change of u."""
        return Tangent(self, np.array(u, dtype=np.float64, order="C"))

    def energy(self, u: Floats) -> float:
        """The stored energy [N mm]; every law has to have one."""
        energy = self.kernel.energy(plain(u))
        refuse_inadmissible(self.kernel, self.net.mesh, self.points, np.array(energy))
        return energy

    def least_jacobian(self, u: Floats) -> tuple[float, int, int]:
        """The least J = det(I + H) of all points, with its tet and point; inf at small strain."""
        f = np.empty((self.net.count, 3))
        self.kernel.forces(plain(u), f)
        return self.kernel.least_jacobian


@dataclass(frozen=True, eq=False)
class Tangent:
    """The derivative of the forces at a state u (c, 3) mm: df = tangent.apply(du)."""

    operator: PointwiseFree
    u: Floats

    @property
    def symmetric(self) -> bool:
        """Whether it is a symmetric form."""
        return self.operator.symmetric

    def apply(self, du: Floats) -> Floats:
        """The change of the forces (c, 3) N for a change du (c, 3) mm."""
        df = np.empty_like(self.u)
        self.operator.kernel.tangent(self.u, plain(du), df)
        return df

    @property
    def rough(self) -> Callable[[Singles], Singles] | None:
        """The same in float32 throughout, twice as quick: for directions that need no more.

        None at a state that float32 does not hold, as with exp(100).
        """
        return self._in_single if self._holds else None

    def _in_single(self, du: Singles) -> Singles:
        df = np.empty_like(du)
        self.operator.single.tangent_single(self._single, du, df)
        return df

    @cached_property
    def _holds(self) -> bool:
        """Whether float32 gives what float64 does at this state, tried in one direction.

        Not where squares of forces leave its range: the sums of an iteration need them.
        """
        du = np.cos(np.arange(self.u.size, dtype=np.float64)).reshape(self.u.shape)
        df = self.apply(du)
        size = np.abs(df).max()
        if not LEAST < size < 1 / LEAST:
            return False
        df -= self._in_single(du.astype(np.float32))
        return bool(np.abs(df).max() <= ROUGH * size)

    @cached_property
    def _single(self) -> Singles:
        return self.u.astype(np.float32)
