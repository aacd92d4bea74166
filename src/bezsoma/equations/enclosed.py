# SPDX-License-Identifier: BSD-3-Clause
"""Incompressible tissue that is held all around, at small or finite strain."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from bezsoma.arrays import Floats
from bezsoma.equations.level import FLUX, changed_volume
from bezsoma.equations.pointwise import Pointwise
from bezsoma.mechanics.laws import Law
from bezsoma.mesh.control_net import ControlNet


def volume_changes(net: ControlNet, laws: Sequence[Law], u: Floats) -> tuple[Floats, Floats]:
    """By how much u (c, 3) mm changes the volume of each tet (t,), and its size to round by, mm3.

    int det F - 1 for laws at finite strain, int div u for others. Summed over a part of the body
    both are decided by its boundary alone (Gauss; det F is a null Lagrangian, J. M. Ball 1977,
    doi:10.1007/BF00279992), so that controls inside may be anything, here zero.

    >>> from bezsoma.mechanics.hyperelastic import NeoHooke
    >>> from bezsoma.mesh.solids import block
    >>> net = ControlNet(block(cells=2), 3)
    >>> u = net.points @ np.diag([1.0, 0.5, 0.0])
    >>> inside = np.ones(net.count, bool)
    >>> inside[net.of_facets(net.mesh.boundary)] = False
    >>> u[inside] = 0.0
    >>> float(volume_changes(net, [NeoHooke(1.0, 0.5)], u)[0].sum().round(12))
    2.0
    """
    points = Pointwise(net, laws, 3 * (net.degree - 1))
    weights = points.rule[1]
    change, size = np.zeros((2, len(net.mesh.tets)))
    for law, tets in points.runs():
        H = points.gradients(u, tets)
        J = np.linalg.det(np.eye(3) + H) - 1 if law.finite else np.trace(H, axis1=2, axis2=3)
        change[tets] = net.mesh.volumes[tets] * (J @ weights)
        size[tets] = net.mesh.volumes[tets] * ((abs(J) + law.finite) @ weights)
    return change, size


def refuse_changed_volume(
    net: ControlNet, pressure_net: ControlNet, modes: Floats, laws: Sequence[Law], given: Floats
) -> None:
    """Raise an InputError if what is prescribed (c, 3) mm changes a volume that cannot change.

    `modes` (j, cp) are the pressures that no free displacement feels.
    """
    if not len(modes):
        return
    change, size = volume_changes(net, laws, given)
    for mode in modes:
        of_tet = mode[pressure_net.of_tet]
        inside = (of_tet != 0).all(axis=1)
        sign = of_tet[:, 0] * inside
        flux = float(sign @ change)
        if abs(flux) > FLUX * float(abs(sign) @ size):
            raise changed_volume(flux, float(net.mesh.volumes[inside].sum()))
