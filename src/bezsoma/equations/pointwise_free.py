# SPDX-License-Identifier: BSD-3-Clause
"""Forces and tangents of any law of the core, without a matrix: by quadrature, compiled."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bezsoma import _core, bernstein
from bezsoma.arrays import Floats
from bezsoma.equations.matrix_free import MatrixFree
from bezsoma.errors import Inadmissible
from bezsoma.mesh.control_net import ControlNet

OVERFLOW = 700.0
"""exp of 709.8 is the last that float64 holds; more than this is refused."""


@dataclass(frozen=True, eq=False)
class PointwiseFree:
    """What a body of given laws answers to displacements (c, 3) mm: forces (c, 3) N, tangents.

    `laws` has one law a region of the mesh. `points` (q, 4) barycentric and `weights` (q,) with sum
    1 are a quadrature rule (bernstein.quadrature.simplex). With H = grad u and P the law's stress,

        f_a = V sum_q w_q P(H(x_q)) grad B_a(x_q)

    (Roth et al. 1998, eq. 45). The answer has the same bits for any number of `threads` (0: all
    cores). A state that a law cannot bear raises `Inadmissible`, which says where.
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
        return _core.Pointwise(
            MatrixFree(self.net, np.zeros((len(self.net.mesh.regions), 2))).walk(),
            list(self.laws),
            bernstein.values(self.net.degree - 1, self.points),
            self.weights,
            self.threads,
            self.instructions,
        )

    @property
    def symmetric(self) -> bool:
        """Whether every law has an energy: then tangents are symmetric forms."""
        return all(law.has_energy for law in self.laws)

    def forces(self, u: Floats) -> Floats:
        """The internal forces (c, 3) N at u (c, 3) mm."""
        f = np.empty((self.net.count, 3))
        self.kernel.forces(np.ascontiguousarray(u, dtype=np.float64), f)
        self._refuse_inadmissible(f)
        return f

    def tangent(self, u: Floats) -> Tangent:
        """The derivative of the forces at u, as what it does to a change of u."""
        return Tangent(self, np.array(u, dtype=np.float64, order="C"))

    def energy(self, u: Floats) -> float:
        """The stored energy [N mm]; every law has to have one."""
        return self.kernel.energy(np.ascontiguousarray(u, dtype=np.float64))

    def least_jacobian(self, u: Floats) -> tuple[float, int, int]:
        """The least J = det(I + H) of all points, with its tet and point; inf at small strain."""
        self.kernel.forces(np.ascontiguousarray(u, dtype=np.float64), np.empty((self.net.count, 3)))
        return self.kernel.least_jacobian

    def _refuse_inadmissible(self, f: Floats) -> None:
        J, tet, point = self.kernel.least_jacobian
        if not J > 0:
            raise self._inadmissible("J", J, tet, point, "the tissue is turned inside out")
        exponent, tet, point = self.kernel.greatest_exponent
        if not exponent <= OVERFLOW:
            raise self._inadmissible(
                "exponent", exponent, tet, point, "its exponential leaves the range of numbers"
            )
        if not np.isfinite(f).all():
            raise self._inadmissible("number", np.nan, 0, 0, "forces are not finite")

    def _inadmissible(
        self, what: str, value: float, tet: int, point: int, why: str
    ) -> Inadmissible:
        mesh = self.net.mesh
        at = self.points[point] @ mesh.points[mesh.tets[tet]]
        region = mesh.regions[mesh.region[tet]]
        return Inadmissible(
            f"{what} = {value:.4g} in region {region!r}, tet {tet} at {np.round(at, 3)} mm: {why}; "
            "take a smaller step of the load",
            what,
            value,
            tet,
            region,
            (float(at[0]), float(at[1]), float(at[2])),
        )


@dataclass(frozen=True, eq=False)
class Tangent:
    """The derivative of the forces at a state u (c, 3): df = tangent.apply(du)."""

    operator: PointwiseFree
    u: Floats

    @property
    def symmetric(self) -> bool:
        """Whether it is a symmetric form."""
        return self.operator.symmetric

    def apply(self, du: Floats) -> Floats:
        """The change of the forces (c, 3) N for a change du (c, 3) mm."""
        df = np.empty_like(self.u)
        self.operator.kernel.tangent(self.u, np.ascontiguousarray(du, dtype=np.float64), df)
        return df
