# SPDX-License-Identifier: BSD-3-Clause
"""Where an answer is turned inside out between the points at which its law was asked."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from bezsoma import bernstein
from bezsoma.arrays import Floats
from bezsoma.equations.pointwise import Pointwise
from bezsoma.mesh.control_net import ControlNet


def inside_out(net: ControlNet, laws: Sequence[Any], u: Floats) -> str:
    """A sentence on the corners of tets with J = det(I + grad u) <= 0, empty where there are none.

    Laws at finite strain refuse J <= 0 at the points of the quadrature; between them a coarse mesh
    can still fold, as it does where a motion forces it. Corners are where J is least, mostly.

    >>> from bezsoma.mechanics.hyperelastic import NeoHooke
    >>> from bezsoma.mesh.solids import block
    >>> net = ControlNet(block(), 2)
    >>> inside_out(net, [NeoHooke(1.0, 0.3)], 0.5 * net.points)
    ''
    >>> inside_out(net, [NeoHooke(1.0, 0.3)], net.points * [0, 0, -1.5])[:60]
    'the tissue is turned inside out at corners of 6 of 6 tets (1'
    """
    corners = bernstein.derivatives(net.degree, np.eye(4))
    mesh, bad, worst = net.mesh, [], (np.inf, -1, 0)
    points = Pointwise(net, laws, 1, once=True)
    for law, tets in points.runs():
        if not getattr(law, "finite", False):
            continue
        J = np.linalg.det(np.eye(3) + points.gradients(u, tets, corners))
        bad.append(tets[(J <= 0).any(axis=1)])
        t, corner = np.unravel_index(J.argmin(), J.shape)
        worst = min(worst, (float(J[t, corner]), int(tets[t]), int(corner)))
    J_least, tet, corner = worst
    if not J_least <= 0:
        return ""
    touched = np.concatenate(bad)
    part = mesh.volumes[touched].sum() / mesh.volumes.sum()
    place = ", ".join(f"{x:.4g}" for x in mesh.points[mesh.tets[tet, corner]])
    return (
        f"the tissue is turned inside out at corners of {len(touched)} of {len(mesh.tets)} tets "
        f"({100 * part:.3g} % of the volume), J = {J_least:.3g} in tet {tet} of "
        f"region {mesh.regions[mesh.region[tet]]!r} at ({place}) mm: the points of the quadrature "
        "did not see it, and the answer cannot be trusted there; take a finer mesh, a higher "
        "exactness or a smaller motion"
    )
