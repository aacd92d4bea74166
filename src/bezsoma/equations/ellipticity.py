# SPDX-License-Identifier: BSD-3-Clause
"""Where in a body a law has lost its strong ellipticity."""

from __future__ import annotations

import numpy as np

from bezsoma import bernstein
from bezsoma.arrays import Floats
from bezsoma.equations.pointwise import Pointwise
from bezsoma.mechanics.ellipticity import least_resistance

EXACTNESS = 2
"""Four points a tet: what is lost is lost in whole tets."""


def lost_ellipticity(pointwise: Pointwise, u: Floats) -> str:
    """A sentence on where it is lost most at u (c, 3) mm, empty where it is nowhere.

    >>> from bezsoma.mechanics.stiffening import Stiffening
    >>> from bezsoma.mesh.control_net import ControlNet
    >>> from bezsoma.mesh.solids import block
    >>> net = ControlNet(block(), 2)
    >>> pointwise = Pointwise(net, [Stiffening(1.0, 0.45, 5.0)], 6)
    >>> lost_ellipticity(pointwise, 0.1 * net.points)
    ''
    >>> lost_ellipticity(pointwise, net.points @ np.diag([0.9, 0.0, -0.2]))[:47]
    'the law has lost strong ellipticity in 6 of 6 t'
    """
    points = Pointwise(pointwise.net, pointwise.laws, EXACTNESS, once=True)
    mesh, lost = pointwise.net.mesh, 0
    least, tet, at = 0.0, -1, 0
    for law, tets in points.runs():
        if law.linear:
            continue
        with np.errstate(all="ignore"):
            found = np.nan_to_num(least_resistance(law, points.gradients(u, tets)), nan=0.0)
        lost += int((found.min(axis=1) < 0).sum())
        if found.min() < least:
            t, at = map(int, np.unravel_index(found.argmin(), found.shape))
            least, tet = float(found[t, at]), int(tets[t])
    if tet < 0:
        return ""
    x = bernstein.simplex(EXACTNESS, 3)[0][at] @ mesh.points[mesh.tets[tet]]
    place = ", ".join(f"{component:.4g}" for component in x)
    return (
        f"the law has lost strong ellipticity in {lost} of {len(mesh.tets)} tets, most in tet {tet}"
        f" of region {mesh.regions[mesh.region[tet]]!r} at ({place}) mm: a thin layer there gives "
        f"way by {least:.3g} MPa, and strain gathers in it"
    )
