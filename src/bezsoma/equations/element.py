# SPDX-License-Identifier: BSD-3-Clause
"""Element matrices of linear elasticity, from the closed form."""

from __future__ import annotations

import numpy as np

from bezsoma import _core
from bezsoma.arrays import Floats, frozen
from bezsoma.errors import InputError
from bezsoma.mechanics.body import Body
from bezsoma.mechanics.materials import LinearElastic


def element_matrices(
    degree: int, gradients: Floats, volumes: Floats, lam: Floats, mu: Floats
) -> Floats:
    """The matrices K of tets (t, 3m, 3m) N/mm; row 3a + k is component k of control a.

    gradients (t, 4, 3) holds g_i = grad L_i in 1/mm, volumes (t,) mm3, lam and mu (t,) MPa. The
    gradient of a Bernstein polynomial is n times four shifted ones of a degree less, so a block
    is a sum of at most sixteen terms and needs no quadrature (paper, eq. 34 with eqs. 6 and 31;
    the integrals of products of Bernstein polynomials are exact):

        K_ab = sum_ij w_ab,ij V (lam g_i g_j^T + mu g_j g_i^T + mu g_i.g_j I)
        w_ab,ij = n^2 (1/V) int B_{a-e_i} B_{b-e_j}

    Beware: symmetric to the last bit, but without supports singular: six rigid motions cost
    nothing. A turn about z by a small angle, u = (-y, x, 0), has forces K u = 0:

    >>> corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    >>> g = np.array([[[-1.0, -1, -1], [1, 0, 0], [0, 1, 0], [0, 0, 1]]])
    >>> one = np.ones(1)
    >>> K = element_matrices(1, g, one / 6, one, one)[0]
    >>> turn = np.stack([-corners[:, 1], corners[:, 0], 0 * corners[:, 0]], axis=1)
    >>> float(abs(K @ turn.ravel()).max()) < 1e-15 and bool((K == K.T).all())
    True
    """
    return _core.element_matrices(degree, gradients, volumes, lam, mu)


def lame_constants(body: Body) -> Floats:
    """Lame's lambda and mu of each region (regions, 2) MPa.

    Beware: only for linear elasticity; another law is refused, since it has no such constants.

    >>> from bezsoma.mesh.solids import block
    >>> lame_constants(Body(block(), 1, LinearElastic(E=2.5, nu=0.25), [])).round(14).tolist()
    [[1.0, 1.0]]
    """
    laws = []
    for region, material in zip(body.mesh.regions, body.material_of_region, strict=True):
        if not isinstance(material, LinearElastic):
            raise InputError(
                f"region {region!r} is {material!r}, which has no Lame constants; where they are "
                "asked for every region needs LinearElastic(E=..., nu=...)"
            )
        laws.append((material.lam, material.mu))
    return frozen(np.array(laws))


def moduli(body: Body) -> tuple[Floats, Floats]:
    """Lame's lambda and mu of each tet, (t,) each, MPa.

    >>> from bezsoma.mesh.solids import block
    >>> [x.shape for x in moduli(Body(block(), 1, LinearElastic(E=2.5, nu=0.25), []))]
    [(6,), (6,)]
    """
    lam, mu = lame_constants(body).T[:, body.mesh.region]
    return frozen(np.ascontiguousarray(lam)), frozen(np.ascontiguousarray(mu))
