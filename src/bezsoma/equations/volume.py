# SPDX-License-Identifier: BSD-3-Clause
"""Two measures of how volume changes, which agree for small strains only.

div u is what the equations speak of: the mixed form makes it vanish *against every pressure* at
nu = 1/2, int q div u = 0, not at every point. det(I + grad u) - 1 is the change of the volume that
a small piece takes up when each of its points x is moved to x + u(x); the paper looked at it. An
answer of the small-strain equations does not make it vanish, however exactly they are solved: a
pure turn R - I has div u = 2 cos(angle) - 2 and determinant 1, a shear of gamma = 0.1 made of
symmetric strain has div u = 0 and a determinant of 1 - 0.0025.
"""

from __future__ import annotations

import numpy as np

from bezsoma import bernstein
from bezsoma.arrays import Floats
from bezsoma.mesh.broken_field import BrokenField
from bezsoma.mesh.evaluation import gradient_controls, tet_portions
from bezsoma.mesh.field import Field

MOST = 9
"""The highest degree in which the determinant is written."""


def divergence(displacement: Field) -> BrokenField:
    """The volumetric strain div u [-], tr eps (paper, eqs. 12 and 36), of degree n - 1.

    >>> from bezsoma.mesh import ControlNet
    >>> from bezsoma.mesh.solids import block
    >>> swelling = Field.interpolating(ControlNet(block(), 2), lambda x: 0.01 * x**2)
    >>> points = np.array([[0.5, 0.25, 0.125]])
    >>> bool(abs(divergence(swelling).at(points)[0] - 0.02 * 0.875) < 1e-15)
    True
    """
    H = gradient_controls(displacement, slice(None))
    controls = H[..., 0, 0] + H[..., 1, 1] + H[..., 2, 2]
    return BrokenField(displacement.mesh, displacement.degree - 1, controls)


def change_of_volume(H: Floats) -> Floats:
    """det(I + H) - 1 (...) of gradients (..., 3, 3), without the loss of digits of that formula.

    The sum of the principal invariants of H, tr H + (tr^2 H - tr H^2) / 2 + det H:

    >>> H = np.array([[0.1, 0.2, 0], [0, -0.3, 0.1], [0.4, 0, 0.2]])
    >>> bool(abs(change_of_volume(H) - (np.linalg.det(np.eye(3) + H) - 1)) < 1e-15)
    True
    """
    trace = np.trace(H, axis1=-2, axis2=-1)
    square = np.einsum("...ij,...ji->...", H, H)
    cubic = np.einsum("...i,...i->...", H[..., 0, :], np.cross(H[..., 1, :], H[..., 2, :]))
    return np.asarray(trace + (trace**2 - square) / 2 + cubic)


def determinant(displacement: Field) -> BrokenField:
    """det(I + grad u) - 1 [-], *interpolated* in the domain points of degree 3 (n - 1).

    That is its own degree, so that nothing is lost up to n = 4; beyond, degree `MOST` is taken.

    >>> from bezsoma.mesh import ControlNet
    >>> from bezsoma.mesh.solids import block
    >>> stretched = Field.interpolating(ControlNet(block(), 1), lambda x: x * [0.1, 0, -0.1])
    >>> bool(abs(determinant(stretched).controls + 0.01).max() < 1e-15)
    True
    """
    degree = min(3 * (displacement.degree - 1), MOST)
    bary = bernstein.domain_points(degree, 3)
    weights = bernstein.values(displacement.degree - 1, bary)
    conversion = bernstein.interpolation(degree, 3)
    controls = np.empty((len(displacement.mesh.tets), len(bary)))
    for part in tet_portions(displacement, 3 * len(bary)):
        H = np.einsum("bm,tmkl->tbkl", weights, gradient_controls(displacement, part))
        controls[part] = np.einsum("ab,tb->ta", conversion, change_of_volume(H))
    return BrokenField(displacement.mesh, degree, controls)
