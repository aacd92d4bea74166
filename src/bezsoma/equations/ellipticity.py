# SPDX-License-Identifier: BSD-3-Clause
"""Where in a body a law has lost its strong ellipticity."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from bezsoma import bernstein
from bezsoma.arrays import Floats, Ints
from bezsoma.equations.mixed_pointwise import MixedPointwise
from bezsoma.equations.pointwise import Pointwise
from bezsoma.mechanics.ellipticity import least_resistance, least_resistance_beside
from bezsoma.mechanics.laws import Law, folds
from bezsoma.mesh.tets import TetMesh

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
    laws = ((law, tets) for law, tets in points.runs() if not law.linear)
    states = ((law, tets, points.gradients(u, tets)) for law, tets in laws)
    found = ((tets, _sound(law, H, least_resistance(law, H))) for law, tets, H in states)
    with np.errstate(all="ignore"):
        return _told(pointwise.net.mesh, found)


def lost_beside_pressure(internal: MixedPointwise, u: Floats, p: Floats) -> str:
    """The same at u (c, 3) mm and p (cp,) MPa, for laws beside a pressure."""
    points = replace(internal, exactness=EXACTNESS).points(u, p)
    found = (
        (tets, _sound(law, H, least_resistance_beside(law, H, at))) for law, tets, H, at in points
    )
    with np.errstate(all="ignore"):
        return _told(internal.net.mesh, found)


def _sound(law: Law, H: Floats, resistance: Floats) -> Floats:
    """The resistance where the law says anything: not where tissue is turned inside out."""
    return np.where(folds(law, H), np.inf, resistance)


def _told(mesh: TetMesh, resistances: Iterable[tuple[Ints, Floats]]) -> str:
    """Where the least of the resistances (t, q) of some tets is, if it is negative."""
    lost, least, tet, at = 0, 0.0, -1, 0
    for tets, found in resistances:
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
