# SPDX-License-Identifier: BSD-3-Clause
"""The displacement-pressure form without a matrix and without quadrature."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bezsoma import _core
from bezsoma.arrays import Floats, plain
from bezsoma.equations.matrix_free import met, walk
from bezsoma.equations.threads import thread_count
from bezsoma.mesh.control_net import ControlNet


@dataclass(frozen=True, eq=False)
class MixedFree:
    """The mixed form of a net and a pressure net as what it does: (u, p) -> (f, g).

    Forces f (c, 3) N and changes of volume g (cp,) mm3, for displacements u (c, 3) mm and
    pressures p (cp,) MPa, positive in compression (the paper's second form, with the
    corrections of docs/theory/errata.md):

        f_a = int 2 G eps'(u) : eps'(B_a) - p div B_a      eps' = eps - tr(eps) I / 3
        g_b = - int B_b (div u + p / kappa)

    At nu = 1/2, where 1/kappa = 0, nothing is infinite. The matrix is symmetric and has
    directions of negative energy, so conjugate gradients cannot solve with it: see
    `bezsoma.solvers.saddle`.

    Per tet it works as `MatrixFree` does: the pressure is elevated to the degree k - 1 of the
    stress, where it is one more part of it, and the trace of the strain climbs the ladder as a
    seventh component. See docs/theory/mixed_solver.md. `moduli` (regions, 2) holds G in MPa and
    1/kappa in 1/MPa of the regions of the mesh. The pressure net has the degree m, 1 <= m < k,
    and the same tets in the same order; its vertices may be others (a pressure that breaks between
    regions). Same bits for any number of threads.

    What the deviatoric stress and a pressure do is what lambda = -2/3 G and mu = G do, and a
    pressure that is no unknown:

    >>> from bezsoma.equations.matrix_free import MatrixFree
    >>> from bezsoma.mesh.solids import block
    >>> mesh = block(cells=2, irregular=0.3)
    >>> net, pressures = ControlNet(mesh, 3), ControlNet(mesh, 2)
    >>> u, G, kappa = np.sin(7 * net.points), 0.4, 5.0
    >>> mixed = MixedFree(net, pressures, np.array([[G, 1 / kappa]]))
    >>> f, g = mixed.apply(u, np.zeros(pressures.count))
    >>> K = MatrixFree(net, np.array([[-2 / 3 * G, G]]))
    >>> bool(abs(f - K @ u).max() < 1e-13 * abs(f).max())
    True

    and where p = -kappa div u is a polynomial that the pressure net has, g vanishes, and f is that
    of the compressible body:

    >>> u = net.interpolated(lambda x: np.stack([x[:, 0] ** 2, x[:, 1], x[:, 0] * x[:, 2]], axis=1))
    >>> p = pressures.interpolated(lambda x: -kappa * (3 * x[:, 0] + 1))
    >>> f, g = mixed.apply(u, p)
    >>> K = MatrixFree(net, np.array([[kappa - 2 / 3 * G, G]]))
    >>> bool(abs(f - K @ u).max() < 1e-12 * abs(f).max() and abs(g).max() < 1e-13)
    True
    >>> bool(np.isclose(mixed.energy(u, p), K.energy(u), rtol=1e-13))
    True
    """

    net: ControlNet
    pressure_net: ControlNet
    moduli: Floats
    threads: int = 0
    instructions: str = ""

    @cached_property
    def kernel(self) -> _core.MixedFree:
        """The core's side of it."""
        return _core.MixedFree(
            walk(self.net, self.moduli),
            self.pressure_net.degree,
            self.pressure_net.walked(),
            thread_count(self.threads),
            self.instructions,
        )

    @property
    def stiffest(self) -> float:
        """The largest G that a tet has [MPa]."""
        return float(met(self.moduli, self.net.mesh.region)[:, 0].max())

    def apply(self, u: Floats, p: Floats) -> tuple[Floats, Floats]:
        """Forces (c, 3) N and changes of volume (cp,) mm3."""
        f, g = np.empty((len(u), 3)), np.empty(len(p))
        self.kernel.apply(plain(u), plain(p), f, g)
        return f, g

    def energy(self, u: Floats, p: Floats) -> float:
        """The stored energy int G eps' : eps' + p^2 / (2 kappa) [N mm].

        From gradients, as that of `MatrixFree`. For a p that is not -kappa div u it is neither
        convex nor concave in both.
        """
        return self.kernel.work(plain(u), plain(p)) / 2

    def mass(self, weight: Floats, p: Floats) -> Floats:
        """int weight p B_b (cp,), with one weight a region (regions,)."""
        g = np.empty(len(p))
        self.kernel.mass(plain(weight), plain(p), g)
        return g
