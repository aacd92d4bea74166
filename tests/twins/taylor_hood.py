# SPDX-License-Identifier: BSD-3-Clause
"""The mixed form by scikit-fem: Taylor and Hood's elements P2/P1, its assembly, SciPy's LU.

Nothing of BezSoma is imported here.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import block_array, coo_array, csc_array
from scipy.sparse.linalg import splu
from skfem import Basis, BilinearForm, ElementTetP1, LinearForm

from twins.scikit import EXACTNESS, Floats, Twin


@dataclass(frozen=True, eq=False)
class TaylorHood(Twin):
    """`Twin` with a continuous linear pressure: 2 G eps' : eps' - p div v, div u + p / kappa = 0.

    `enclosed` says that the whole boundary is prescribed: the mean of the pressure is then zero,
    by a border of the matrix.
    """

    enclosed: bool = False

    @cached_property
    def pressures(self) -> Basis:
        """Linear elements on the same points of quadrature."""
        return Basis(self.mesh, ElementTetP1(), intorder=EXACTNESS)

    @cached_property
    def shear(self) -> Floats:
        """G (t, 1)."""
        E, nu = np.array(self.moduli, dtype=float)[self.region].T[:, :, None]
        return E / 2 / (1 + nu)

    @cached_property
    def softness(self) -> Floats:
        """1/kappa (t, 1), by E = 3 kappa (1 - 2 nu)."""
        E, nu = np.array(self.moduli, dtype=float)[self.region].T[:, :, None]
        return 3 * (1 - 2 * nu) / E

    @cached_property
    def blocks(self) -> tuple[csc_array, csc_array, csc_array]:
        """K (n, n), B (m, n) and M/kappa (m, m)."""
        shape = self.basis.dx.shape
        mu, soft = (np.broadcast_to(m, shape) for m in (self.shear, self.softness))

        @BilinearForm
        def work(u, v, w):  # type: ignore[no-untyped-def]
            eps = (u.grad + np.swapaxes(u.grad, 0, 1)) / 2
            third = np.trace(u.grad) * np.trace(v.grad) / 3
            return 2 * w.mu * (np.einsum("ijtq,ijtq->tq", eps, v.grad) - third)

        @BilinearForm
        def pushed(u, q, w):  # type: ignore[no-untyped-def]
            return -q * np.trace(u.grad)

        @BilinearForm
        def squeezed(p, q, w):  # type: ignore[no-untyped-def]
            return w.soft * p * q

        return (
            csc_array(work.assemble(self.basis, mu=mu)),
            csc_array(pushed.assemble(self.basis, self.pressures)),
            csc_array(squeezed.assemble(self.pressures, soft=soft)),
        )

    @cached_property
    def both(self) -> tuple[Floats, Floats]:
        """Displacement (n,) and pressure (m,)."""
        K, B, M = self.blocks
        x, free = self._prescribed()
        border = np.zeros((0, self.pressures.N))
        if self.enclosed:
            border = LinearForm(lambda q, w: q).assemble(self.pressures)[None]
        rows = [[K[free][:, free], B.T[free]], [B[:, free], -M]]
        if self.enclosed:
            Z = coo_array(border)
            rows = [[*rows[0], None], [*rows[1], Z.T], [None, Z, None]]
        whole = csc_array(block_array(rows))
        factors, p, n = splu(whole), np.zeros(self.pressures.N), int(free.sum())
        level = np.zeros(len(border))
        for _ in range(4):  # the first solves, the others take rounding away
            f = (self.forces - K @ x - B.T @ p)[free]
            g = M @ p - B @ x - border.T @ level
            step = factors.solve(np.concatenate([f, g, -border @ p]))
            x[free] += step[:n]
            p += step[n : n + len(p)]
            level += step[n + len(p) :]
        return x, p

    def _prescribed(self) -> tuple[Floats, np.ndarray]:
        """The unknowns with what supports hold, and which of them are free."""
        x, free = np.zeros(self.basis.N), np.ones(self.basis.N, dtype=bool)
        for held in self.supports:
            for axis in held.components:
                numbers = self._unknowns(held, "xyz".index(axis))
                new = numbers[free[numbers]]
                x[new] = held.value(self.basis.doflocs.T[new])[:, "xyz".index(axis)]
                free[new] = False
        return x, free

    @property
    def displacement(self) -> Floats:  # type: ignore[override]
        """The displacement (n,)."""
        return self.both[0]

    @property
    def sampled_pressure(self) -> Floats:
        """The pressure (t, q) at `samples`."""
        probe = Basis(self.mesh, ElementTetP1(), quadrature=self.probe.quadrature)
        return np.asarray(probe.interpolate(self.both[1]))

    @property
    def energy(self) -> float:
        """The stored energy, (u.K u + p.M p / kappa) / 2."""
        (K, _, M), (x, p) = self.blocks, self.both
        return float(x @ (K @ x) + p @ (M @ p)) / 2
