# SPDX-License-Identifier: BSD-3-Clause
"""The equations of the mixed form: displacement and pressure, up to nu = 1/2.

    int 2 G eps'(u) : eps'(v) - int p div v = loads on v         for all v
    - int q div u - int q p / kappa = 0                          for all q

Paper, eqs. 17, 20, 39 and 40. What is carried is 1/kappa = 3 (1 - 2 nu) / E, which is zero where
nu = 1/2; p is positive in compression.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from scipy.sparse import coo_array, csr_array

from bezsoma import bernstein
from bezsoma.arrays import Bools, Floats, Ints, frozen
from bezsoma.equations.assembled import BlockMatrix, assembled
from bezsoma.mechanics.body import Body
from bezsoma.mechanics.materials import LinearElastic
from bezsoma.mesh.control_net import ControlNet


class MixedOperator(Protocol):
    """What the two equations do to a displacement and a pressure."""

    def apply(self, u: Floats, p: Floats) -> tuple[Floats, Floats]:
        """Forces f (c, 3) N and volumes g (cp,) mm3 for u (c, 3) mm and p (cp,) MPa."""
        ...


@dataclass(frozen=True, eq=False)
class MixedMatrix:
    """The system of the paper's eqs. 39 and 40 as matrices: the oracle, and for small problems.

    `shear` is K_uu, of the deviatoric strain alone (eqs. 18, 36 and 42); `coupling` (cp, 3c)
    is K_pu, -int q div v (eqs. 37, 38 and 41), and its transpose K_up; `softness` (cp, cp) is
    -K_pp, int q q' / kappa.

    A body that swells under a uniform pressure p = -kappa div u balances both equations. Here is
    one with G = 3, kappa = 2, u = x, p = -6; forces are left on its boundary only:

    >>> from bezsoma.mesh.solids import block
    >>> net, pressures = (ControlNet(block(cells=2), n) for n in (2, 1))
    >>> operator = mixed_matrix(net, pressures, np.array([[3.0, 1 / 2]]))
    >>> f, g = operator.apply(net.points, np.full(pressures.count, -6.0))
    >>> inside = (abs(net.points - 0.5) < 0.49).all(axis=1)
    >>> bool(abs(f[inside]).max() < 1e-14 and abs(g).max() < 1e-15)
    True
    """

    shear: BlockMatrix
    coupling: csr_array[Any]
    softness: csr_array[Any]

    def apply(self, u: Floats, p: Floats) -> tuple[Floats, Floats]:
        """Forces f (c, 3) N and volumes g (cp,) mm3, see `MixedOperator`."""
        f = self.shear @ u
        f += (self.coupling.T @ p).reshape(-1, 3)
        return f, self.coupling @ u.ravel() - self.softness @ p


@dataclass(frozen=True, eq=False)
class MixedEquations:
    """The two equations, what is prescribed, and the pressures whose level nothing determines.

    forces, held, given and of_support are those of `Equations`. modes (j, cp) are pressures that
    do no work on any free displacement: constants on parts whose whole boundary is prescribed.
    """

    net: ControlNet
    pressure_net: ControlNet
    operator: MixedOperator
    forces: Floats
    held: Bools
    given: Floats
    of_support: Mapping[str, tuple[Ints, Bools]]
    modes: Floats

    @property
    def free(self) -> int:
        """How many numbers are unknown: components of the displacement, and pressures."""
        return int(self.held.size - self.held.sum()) + self.pressure_net.count

    def residuals(self, u: Floats, p: Floats) -> tuple[Floats, Floats]:
        """What is out of balance (c, 3) N, minus the reactions where held; and in volume (cp,).

        With prescribed displacements the second equation has a right-hand side too, -K_pu u_D:
        the paper's eq. 39 has zero there.
        """
        f, g = self.operator.apply(u, p)
        return self.forces - f, -g


def mixed_moduli(body: Body) -> Floats:
    """G [MPa] and 1/kappa [1/MPa] of each region (regions, 2).

    >>> from bezsoma.mesh.solids import block
    >>> water = LinearElastic(E=3.0, nu=0.5)
    >>> mixed_moduli(Body(block(), 2, water, [], pressure_degree=1)).tolist()
    [[1.0, 0.0]]
    """
    laws = body.material_of_region
    pairs = [(law.mu, law.compressibility) for law in laws if isinstance(law, LinearElastic)]
    assert len(pairs) == len(laws)  # Body refuses other laws beside a pressure
    return frozen(np.array(pairs))


def deviatoric_lame(moduli: Floats) -> Floats:
    """Lame's constants (regions, 2) of the deviatoric part, -2/3 G and G: without bulk modulus.

    2 G eps' : eps' = 2 G eps : eps - 2/3 G tr^2, so that diag(2G, 2G, 2G, G, G, G) of the
    corrected eq. 42 on the strains of eq. 19 is elasticity with lambda = -2/3 G.
    """
    G = moduli[:, 0]
    return frozen(np.stack([-2 / 3 * G, G], axis=1))


def mixed_matrix(
    net: ControlNet, pressure_net: ControlNet, moduli: Floats, threads: int = 0
) -> MixedMatrix:
    """The matrices for G and 1/kappa (regions, 2) of the regions, in closed form."""
    region = net.mesh.region
    lam, mu = (np.ascontiguousarray(column) for column in deviatoric_lame(moduli)[region].T)
    softness = pressure_mass(pressure_net, moduli[region, 1])
    return MixedMatrix(assembled(net, lam, mu, threads), coupling(net, pressure_net), softness)


def coupling(
    net: ControlNet, pressure_net: ControlNet, tets: Ints | slice = slice(None)
) -> csr_array[Any]:
    """The matrix (cp, 3c) of -int q div v [mm3 a mm], column 3a + k for component k of control a.

    Over all tets, or those given. On a tet it is -V sum_i g_ik times the mean of q dB_a/dL_i, a
    quotient of binomials (the divergence is the sum of the paper's six-entry row of eq. 41 over the
    normal strains).
    """
    mesh = net.mesh
    means = bernstein.gradient_moments(net.degree, pressure_net.degree, 3)
    weights = -mesh.volumes[tets, None, None] * mesh.gradients[tets]
    blocks = np.einsum("iab,tik->tbak", means, weights)
    columns = 3 * net.of_tet[tets][:, None, :, None] + np.arange(3)
    rows = pressure_net.of_tet[tets][:, :, None, None]
    return _summed(rows, columns, blocks, (pressure_net.count, 3 * net.count))


def pressure_mass(net: ControlNet, weights: Floats) -> csr_array[Any]:
    """The matrix (cp, cp) of int w q q' for one weight w (t,) a tet."""
    one = bernstein.mass(net.degree, net.degree, 3)
    blocks = (net.mesh.volumes * weights)[:, None, None] * one
    return _summed(net.of_tet[:, :, None], net.of_tet[:, None, :], blocks, (net.count, net.count))


def _summed(rows: Ints, columns: Ints, blocks: Floats, shape: tuple[int, int]) -> csr_array[Any]:
    rows, columns = (np.broadcast_to(each, blocks.shape).ravel() for each in (rows, columns))
    return csr_array(coo_array((blocks.ravel(), (rows, columns)), shape=shape))
