# SPDX-License-Identifier: BSD-3-Clause
"""Tets all four vertices of which are prescribed: too few displacements for their pressures.

The theory of stable pairs wants a free vertex in every tet. Where there is none the pressure of
the tet is badly determined and its volume constraint stiffens what little can move there; with
three facets on a support nothing of low degree is left to move at all, and some of its pressures
are not determined. A vertex in the middle cures both: `unlocked`.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bezsoma import bernstein
from bezsoma.arrays import Bools, Floats, Ints
from bezsoma.equations.boundary import prescribed
from bezsoma.errors import InputError
from bezsoma.mechanics.body import Body
from bezsoma.mesh.control_net import ControlNet
from bezsoma.mesh.split import split

NOTHING = 1e-12
"""A singular value that counts as none, relative to the largest."""


def held_tets(net: ControlNet, held: Bools) -> Ints:
    """The tets (q,) with all components of all four vertices prescribed; held (c, 3)."""
    whole: Bools = np.asarray(held.all(axis=1))
    return np.flatnonzero(whole[net.of_vertices(net.mesh.tets)].all(axis=1))


def unlocked(body: Body) -> Body:
    """The body with every tet whose four vertices are prescribed cut in four at its barycentre.

    A corner tet of a cube that is held all around has three facets on the boundary and no free
    vertex; afterwards none is left:

    >>> from bezsoma.mechanics import Fixed, LinearElastic
    >>> from bezsoma.mesh.solids import block
    >>> sides = ("left", "right", "front", "back", "bottom", "top")
    >>> body = Body(block(cells=2), 2, LinearElastic(1.0, 0.5), [Fixed(*sides)], pressure_degree=1)
    >>> len(unlocked(body).mesh.tets) > len(body.mesh.tets)
    True
    >>> unlocked(unlocked(body)).mesh.tets.shape == unlocked(body).mesh.tets.shape
    True
    """
    net = ControlNet(body.mesh, 1)
    tets = held_tets(net, prescribed(body, net).mask)
    return replace(body, mesh=split(body.mesh, tets)) if len(tets) else body


def refuse_undetermined(net: ControlNet, pressure_net: ControlNet, held: Bools, soft: Bools) -> int:
    """How many tets are held at all four vertices; refuse those with undetermined pressures.

    A pressure control that only one tet has works on the free displacements of that tet and on
    nothing else. Where these are fewer in rank, some pressure of it is free to take any value.
    """
    tets = held_tets(net, held)
    own = np.bincount(pressure_net.of_tet.ravel(), minlength=pressure_net.count) == 1
    bad = [t for t in tets[~soft[tets]] if _is_short(net, pressure_net, held, own, int(t))]
    if bad:
        centre = net.mesh.points[net.mesh.tets[bad[0]]].mean(axis=0).round(3).tolist()
        raise InputError(
            f"{len(bad)} tets have so much of their boundary prescribed that nothing is left to "
            f"determine their pressure at nu = 1/2, the first around {centre} mm; cut them in four "
            "first: solve(unlocked(body)), or on a mesh split(mesh, tets)"
        )
    return len(tets)


def _is_short(net: ControlNet, pressures: ControlNet, held: Bools, own: Bools, tet: int) -> bool:
    """Whether a pressure of this tet alone, not the constant, works on no free displacement."""
    mine = np.flatnonzero(own[pressures.of_tet[tet]])
    if not len(mine):
        return False
    work = _work(net, pressures, tet)[mine][:, ~held[net.of_tet[tet]].ravel()]
    if len(mine) == pressures.of_tet.shape[1]:
        work = np.concatenate([work, np.ones((len(mine), 1))], axis=1)
    sizes = np.linalg.svd(work, compute_uv=False)
    whole = float(np.abs(_work(net, pressures, tet)).max())
    return bool((sizes > NOTHING * whole).sum() < len(mine))


def _work(net: ControlNet, pressures: ControlNet, tet: int) -> Floats:
    """The means of q dv_k/dx_k on one tet (mq, 3m)."""
    means = bernstein.gradient_moments(net.degree, pressures.degree, 3)
    work = np.einsum("iab,ik->bak", means, net.mesh.gradients[tet])
    return np.asarray(work.reshape(len(work), -1))
