# SPDX-License-Identifier: BSD-3-Clause
"""Internal forces and tangents of any law by quadrature, over arrays.

The plain way, for laws that are functions in Python, and the twin of the compiled kernels.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

from bezsoma import bernstein
from bezsoma.arrays import Bools, Floats, Ints, Singles
from bezsoma.errors import Inadmissible
from bezsoma.mechanics.laws import Law
from bezsoma.mesh.control_net import ControlNet

AT_ONCE = 1 << 19
"""Numbers in the largest scratch array."""
FEWEST = 16
"""Where there are fewer points than this the largest array is another: as if there were so many."""


class Tangent(Protocol):
    """The derivative of the internal forces at a displacement."""

    @property
    def symmetric(self) -> bool:
        """Whether it is a symmetric form."""
        ...

    def apply(self, du: Floats) -> Floats:
        """Its product (c, 3) N with a change du (c, 3) mm."""
        ...

    @property
    def rough(self) -> Callable[[Singles], Singles] | None:
        """The same in float32 throughout, for directions that need no more; None if it cannot."""
        ...


class Internal(Protocol):
    """The internal forces of a net, whatever works them out."""

    @property
    def net(self) -> ControlNet:
        """The control net."""
        ...

    @property
    def symmetric(self) -> bool:
        """Whether all tangents are symmetric forms."""
        ...

    def forces(self, u: Floats) -> Floats:
        """The internal forces (c, 3) N at u (c, 3) mm: int P : grad B (paper, eq. 45)."""
        ...

    def tangent(self, u: Floats) -> Tangent:
        """Their derivative at u (paper, eqs. 46 to 48, corrected)."""
        ...

    def energy(self, u: Floats) -> float:
        """The stored energy, or int tau : eps where there is none, N mm."""
        ...

    def least_jacobian(self, u: Floats) -> tuple[float, int, int]:
        """The least det(I + grad u) over the points of finite laws: J, tet, point."""
        ...


@dataclass(frozen=True, eq=False)
class Pointwise:
    """The internal forces of laws (one a region) by quadrature of a stated exactness.

        f_a = sum_q w_q V P(H_q) grad B_a,    K du = sum_q w_q V (dP/dH : dH_q) grad B_a

    P is the first Piola-Kirchhoff stress or the stress at small strain, H = grad u.

    With the linear law it is the stiffness matrix, when the rule is exact to 2(n - 1):

    >>> from bezsoma.equations.assembled import assembled
    >>> from bezsoma.mechanics.materials import LinearElastic
    >>> from bezsoma.mesh.solids import block
    >>> net, law = ControlNet(block(cells=2), 3), LinearElastic(E=2.5, nu=0.25)
    >>> u = np.sin(7 * net.points)
    >>> f = Pointwise(net, (law,), 4).forces(u)
    >>> bool(abs(f - assembled(net, np.ones(48), np.ones(48)) @ u).max() < 1e-13 * abs(f).max())
    True
    """

    net: ControlNet
    laws: Sequence[Law]
    exactness: int
    once: bool = False
    """For one pass over the tets: what it takes of the mesh and the net is not kept."""

    @property
    def symmetric(self) -> bool:
        """Whether all tangents are."""
        return all(law.symmetric for law in self.laws)

    @cached_property
    def rule(self) -> tuple[Floats, Floats]:
        """The partials (q, m, 4) of the Bernstein polynomials by L_i, and the weights (q,)."""
        bary, weights = bernstein.simplex(self.exactness, 3)
        return bernstein.derivatives(self.net.degree, bary), weights

    def forces(self, u: Floats) -> Floats:
        """The internal forces (c, 3) N at u (c, 3) mm; raises Inadmissible where a law fails."""
        f = np.zeros_like(u)
        for law, tets in self.runs():
            H = self.gradients(u, tets)
            if law.finite:
                self.right_side_out(H, tets)
            with np.errstate(all="ignore"):
                P = law.stress(H)
            self.all_finite(P, tets)
            self.add(f, tets, P)
        return f

    def tangent(self, u: Floats) -> ArrayTangent:
        """The derivative of the internal forces at u, which the linearised step has (eq. 25)."""
        return ArrayTangent(self, u)

    def energy(self, u: Floats) -> float:
        """The stored energy, or int tau : eps where there is none, N mm."""
        return self.integral(u, lambda law, H: law.energy(H))

    def least_jacobian(self, u: Floats) -> tuple[float, int, int]:
        """The least det(I + grad u) over the points of finite laws: J, tet, point."""
        least = (np.inf, -1, -1)
        for law, tets in self.runs():
            if law.finite:
                J = np.linalg.det(np.eye(3) + self.gradients(u, tets))
                if J.min() < least[0]:
                    t, q = np.unravel_index(J.argmin(), J.shape)
                    least = (float(J.min()), int(tets[t]), int(q))
        return least

    def right_side_out(self, H: Floats, tets: Ints) -> None:
        """Raises Inadmissible where J <= 0."""
        J = np.linalg.det(np.eye(3) + H)
        bad = np.asarray(~(J > 0))
        if bad.any():
            raise self._failure("J", J, bad, tets)

    def all_finite(self, P: Floats, tets: Ints, of: str = "a stress") -> None:
        """Raises Inadmissible where a stress (t, q, 3, 3) or energy (t, q) is no finite number."""
        bad = np.asarray(~np.isfinite(P).all(axis=tuple(range(2, P.ndim))))
        if bad.any():
            raise self._failure("number", np.where(bad, np.inf, 0.0), bad, tets, of)

    def _failure(
        self, what: str, values: Floats, bad: Bools, tets: Ints, of: str = ""
    ) -> Inadmissible:
        t, q = np.unravel_index(int(np.argmax(bad)), bad.shape)
        mesh, tet = self.net.mesh, int(tets[t])
        bary, _ = bernstein.simplex(self.exactness, 3)
        x, y, z = map(float, bary[q] @ mesh.points[mesh.tets[tet]])
        region, value = mesh.regions[mesh.region[tet]], float(values[t, q])
        said = f"J = det F = {value:.3g}" if what == "J" else f"{of} that is no finite number"
        return Inadmissible(
            f"{said} in tet {tet} of region {region!r} at ({x:.4g}, {y:.4g}, {z:.4g}) mm",
            what,
            value,
            tet,
            region,
            (x, y, z),
        )

    def integral(self, u: Floats, density: Callable[[Law, Floats], Floats]) -> float:
        """The integral over the undeformed body of density(law, H) (t, q)."""
        weights = self.rule[1]
        total = 0.0
        for law, tets in self.runs():
            W = density(law, self.gradients(u, tets))
            self.all_finite(W, tets, "an energy")
            total += float(np.einsum("tq,q,t->", W, weights, self.net.mesh.volumes[tets]))
        return total

    def gradients(self, u: Floats, tets: Ints, partials: Floats | None = None) -> Floats:
        """H (t, q, 3, 3) at the points of some tets; zero, not nearly so, for a translation.

        `partials` (q, m, 4) are those of other points than the rule's.
        """
        partials = self.rule[0] if partials is None else partials
        mesh = self.net.mesh
        local = u[self.net.closure(3, tets) if self.once else self.net.of_tet[tets]]
        local = np.swapaxes(local - local[:, :1], 1, 2)[:, None]
        steps = local @ partials
        slopes = mesh.gradients_of(tets) if self.once else mesh.gradients[tets]
        return np.asarray(steps @ slopes[:, None])

    def runs(self) -> Iterator[tuple[Law, Ints]]:
        """The laws and the tets of their regions, so few at a time that scratch stays small."""
        size = max(1, AT_ONCE // (max(len(self.rule[1]), FEWEST) * 4 * 9))
        for number, law in enumerate(self.laws):
            tets = np.flatnonzero(self.net.mesh.region == number)
            for start in range(0, len(tets), size):
                yield law, tets[start : start + size]

    def add(self, f: Floats, tets: Ints, P: Floats) -> None:
        """Add the forces of stresses P (t, q, 3, 3) at the points of some tets to f (c, 3)."""
        partials, weights = self.rule
        mesh = self.net.mesh
        scaled = P * (weights[:, None, None] * mesh.volumes[tets, None, None, None])
        moments = np.swapaxes(scaled @ np.swapaxes(mesh.gradients[tets], 1, 2)[:, None], 2, 3)
        work = np.einsum("qmi,tqik->tmk", partials, moments, optimize=True)
        numbers = self.net.of_tet[tets].ravel()
        for k in range(3):
            f[:, k] += np.bincount(numbers, work[..., k].ravel(), minlength=len(f))


@dataclass(frozen=True, eq=False)
class ArrayTangent:
    """The tangent at u: nothing is kept but u."""

    of: Pointwise
    u: Floats

    @property
    def symmetric(self) -> bool:
        """Whether it is a symmetric form."""
        return self.of.symmetric

    def apply(self, du: Floats) -> Floats:
        """Its product (c, 3) N with du (c, 3) mm: the increment of the forces (paper, eq. 46)."""
        f = np.zeros_like(du)
        for law, tets in self.of.runs():
            H, dH = self.of.gradients(self.u, tets), self.of.gradients(du, tets)
            self.of.add(f, tets, law.derivative(H, dH))
        return f

    @property
    def rough(self) -> None:
        """None: functions in Python are asked in float64."""
        return None
