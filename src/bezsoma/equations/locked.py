# SPDX-License-Identifier: BSD-3-Clause
"""Tets all four vertices of which are prescribed: too few displacements for their pressures.

The theory of stable pairs wants a free vertex in every tet. Where there is none the pressure of
the tet is badly determined and its volume constraint stiffens what little can move there; with
three facets on a support nothing of low degree is left to move at all, and some of its pressures
are not determined. A vertex in the middle cures both: `unlocked`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from scipy.sparse import coo_array, csc_array, csr_array, diags_array
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import eigsh

from bezsoma.arrays import Bools, Floats, Ints
from bezsoma.equations.boundary import prescribed
from bezsoma.equations.mixed import coupling
from bezsoma.errors import InputError, counted
from bezsoma.mechanics.body import Body
from bezsoma.mesh.control_net import ControlNet
from bezsoma.mesh.split import split

NOTHING = 1e-12
"""An eigenvalue that counts as none, of the products of rows of length one."""
SHIFT = 1e-9
DENSE = 800
"""Numbers of the pressure up to which all eigenvalues are looked at; beyond, only the least."""


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


def refuse_undetermined(
    net: ControlNet, pressure_net: ControlNet, held: Bools, soft: Bools, modes: Floats
) -> int:
    """How many tets are held at all four vertices; refuse those with undetermined pressures.

    A pressure control all of whose tets are held works on the free displacements of these tets and
    on nothing else. Where its group of tets has fewer of these in rank than such controls, some
    pressure is free to take any value. Expected are the `modes` (j, cp) of `level.undetermined`,
    whose mean is set to zero; soft (t,) has kappa < inf.
    """
    tets = held_tets(net, held)
    for group, own in _groups(net, pressure_net, held, tets[~soft[tets]]):
        free = np.setdiff1d(_components(net, group), np.flatnonzero(held))
        work = coupling(net, pressure_net, group)[own][:, free]
        elsewhere = np.ones(pressure_net.count, bool)
        elsewhere[own] = False
        expected = int((modes[:, elsewhere] == 0).all(axis=1).sum())
        if _is_short(work, expected):
            centre = net.mesh.points[net.mesh.tets[group]].mean(axis=(0, 1)).round(3).tolist()
            raise InputError(
                f"so much of the boundary of {counted(len(group), 'tet')} is prescribed that "
                "nothing is left to determine the pressure there at nu = 1/2, around "
                f"{centre} mm; cut in four there first: solve(unlocked(body)), or on a mesh "
                "split(mesh, tets), or in a case file split_held_tets = true"
            )
    return len(tets)


def _groups(
    net: ControlNet, pressures: ControlNet, held: Bools, tets: Ints
) -> Iterator[tuple[Ints, Ints]]:
    """Tets that share a free control or a pressure of theirs alone, and those pressures."""
    if not len(tets):
        return
    shares = np.bincount(pressures.of_tet.ravel(), minlength=pressures.count)
    mine = np.bincount(pressures.of_tet[tets].ravel(), minlength=pressures.count)
    own = mine == shares
    free: Bools = np.asarray(~held.all(axis=1))
    links = np.concatenate([free[net.of_tet[tets]], own[pressures.of_tet[tets]]], axis=1)
    ends = np.concatenate([net.of_tet[tets], net.count + pressures.of_tet[tets]], axis=1)
    rows, columns = links.nonzero()
    whole = len(tets) + net.count + pressures.count
    edges = (np.ones(len(rows), bool), (rows, len(tets) + ends[rows, columns]))
    label = connected_components(coo_array(edges, shape=(whole, whole)), directed=False)[1]
    for number in np.unique(label[: len(tets)]):
        group = tets[label[: len(tets)] == number]
        controls = np.unique(pressures.of_tet[group])
        if own[controls].any():
            yield group, controls[own[controls]]


def _components(net: ControlNet, tets: Ints) -> Ints:
    """The components of the displacement on these tets, 3 a control, in ascending order."""
    return np.asarray((3 * np.unique(net.of_tet[tets])[:, None] + np.arange(3)).ravel())


def _is_short(work: csr_array[Any], expected: int) -> bool:
    """Whether more than the expected combinations of the rows (n, m) vanish; rows at any size."""
    size = np.sqrt(np.asarray(work.multiply(work).sum(axis=1)).ravel())
    if not size.all():
        return int((size == 0).sum()) > expected or _is_short(work[size > 0], expected)
    rows = diags_array(1 / size) @ work
    products = csc_array(rows @ rows.T)
    if len(size) <= DENSE:
        least = np.linalg.eigvalsh(products.toarray())[: expected + 1]
    else:
        start = np.random.default_rng(0).standard_normal(len(size))
        least = eigsh(products, expected + 1, sigma=-SHIFT, v0=start, return_eigenvectors=False)
    return bool((least < NOTHING).sum() > expected)
