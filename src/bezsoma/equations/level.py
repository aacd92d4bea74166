# SPDX-License-Identifier: BSD-3-Clause
"""The level of the pressure: what determines it, and what is done where nothing does.

The paper says that the pressure must be defined at some point. It must not, as long as some of the
boundary can move along its normal: the level is then as much a part of the answer as the rest, and
fixing it changes the answer. It is undetermined on an incompressible part of the body whose whole
boundary has prescribed normal displacements: a constant pressure there works on nothing,

    int_part div v = int_boundary v . n = 0   for all free v,

and such a part can only be solved if what is prescribed keeps its volume.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import null_space, qr
from scipy.sparse import coo_array, csc_array
from scipy.sparse.csgraph import connected_components

from bezsoma.arrays import Bools, Floats, Ints
from bezsoma.errors import InputError
from bezsoma.mesh.control_net import ControlNet

FLUX = 1e-12
"""The net flux that counts as none, relative to what goes in and out."""
NOTHING = 1e-10
"""The flux of a part's constant pressure through free controls that counts as none, relative."""
SINGULAR = 1e-12
"""An eigenvalue of the squares of these fluxes that counts as none, relative."""
MOST_PARTS = 2000


@dataclass(frozen=True, eq=False)
class _Parts:
    """Where an incompressible pressure is continuous: controls (cp, k), flux (3c, k), mm2."""

    controls: Floats
    flux: csc_array


def undetermined(net: ControlNet, pressure_net: ControlNet, held: Bools, soft: Bools) -> Floats:
    """The constant pressures (j, cp) that no free displacement feels; soft (t,) has kappa < inf.

    A cube held all around has one, and none as soon as one of its faces can move inwards:

    >>> from bezsoma.mesh.solids import block
    >>> net, pressures = (ControlNet(block(cells=2), n) for n in (2, 1))
    >>> held = np.zeros((net.count, 3), bool)
    >>> held[net.of_facets(net.mesh.boundary)] = True
    >>> rigid = np.zeros(len(net.mesh.tets), bool)
    >>> undetermined(net, pressures, held, rigid).tolist() == [[1.0] * pressures.count]
    True
    >>> held[net.of_place("top"), 2] = False
    >>> len(undetermined(net, pressures, held, rigid))
    0
    """
    parts = _parts(net, pressure_net, soft)
    if parts is None:
        return np.zeros((0, pressure_net.count))
    size = np.asarray(abs(parts.flux).sum(axis=0)).ravel()
    out = parts.flux[np.flatnonzero(~held.ravel())] / size
    out.data[np.abs(out.data) < NOTHING / net.count] = 0.0
    modes = null_space((out.T @ out).toarray(), rcond=SINGULAR) if out.nnz else np.eye(len(size))
    return np.asarray((parts.controls @ _plain(modes / size[:, None])).T)


def refuse_flux(
    net: ControlNet, pressure_net: ControlNet, modes: Floats, soft: Bools, given: Floats
) -> None:
    """Raise an InputError if what is prescribed, (c, 3) mm, changes a volume that cannot change."""
    parts = _parts(net, pressure_net, soft)
    if parts is None or not len(modes):
        return
    through = parts.flux * given.reshape(-1, 1)
    for mode in modes:
        of_part = np.array([mode[own > 0].max() for own in parts.controls.T])
        flux = float(np.asarray(through.sum(axis=0)).ravel() @ of_part)
        whole = float(np.asarray(abs(through).sum(axis=0)).ravel() @ np.abs(of_part))
        if abs(flux) > FLUX * whole:
            inside = pressure_net.mesh.volumes[(mode[pressure_net.of_tet] != 0).all(axis=1)]
            raise changed_volume(
                flux, inside.sum(), f", {abs(flux) / whole:.2g} of what goes in and out"
            )


def changed_volume(flux: float, inside: float, more: str = "") -> InputError:
    """What is said of prescribed displacements that change a volume that cannot change, mm3."""
    return InputError(
        "nu = 1/2 and the whole boundary has prescribed displacements, which change the volume "
        f"inside by {flux:.6g} mm3 ({abs(flux) / inside:.2g} of it{more}): that cannot be. Leave "
        "some of the boundary free along its normal, prescribe displacements whose net flux is "
        "zero, or take nu below 1/2"
    )


def without_mean(p: Floats, modes: Floats, net: ControlNet) -> Floats:
    """The pressure p (cp,) with mean zero over each part whose level is not determined."""
    weights = _integrals(net)
    for mode in modes:
        p = p - mode * ((weights * mode) @ p) / ((weights * mode) @ mode)
    return p


def _integrals(net: ControlNet) -> Floats:
    """The integral of each Bernstein polynomial (cp,), mm3."""
    m = net.of_tet.shape[1]
    means = np.repeat(net.mesh.volumes / m, m)
    return np.asarray(np.bincount(net.of_tet.ravel(), means, net.count), np.float64)


def _parts(net: ControlNet, pressure_net: ControlNet, soft: Bools) -> _Parts | None:
    """The parts of the mesh on which a pressure is continuous and nu = 1/2 throughout."""
    label = _vertex_parts(pressure_net)
    rigid = np.setdiff1d(label, label[soft])
    if not len(rigid):
        return None
    if len(rigid) > MOST_PARTS:
        raise InputError(
            f"{len(rigid)} parts of the mesh hang together by nothing; the level of the pressure "
            f"is looked into for {MOST_PARTS} at most: take only those that matter"
        )
    number = np.searchsorted(rigid, label)
    number[~np.isin(label, rigid)] = -1
    controls = np.zeros((pressure_net.count, len(rigid)))
    for part in range(len(rigid)):
        controls[pressure_net.of_tet[number == part], part] = 1.0
    return _Parts(controls, _flux(net, pressure_net, number, len(rigid)))


def _vertex_parts(net: ControlNet) -> Ints:
    """The part (t,) of each tet; a continuous pressure has one value where two share a vertex."""
    tets, vertices = net.mesh.tets, len(net.mesh.points)
    rows = np.repeat(np.arange(len(tets)) + vertices, 4)
    graph = coo_array((np.ones(rows.size, bool), (rows, tets.ravel())), (vertices + len(tets),) * 2)
    return np.asarray(connected_components(graph, directed=False)[1][vertices:], np.int64)


def _flux(net: ControlNet, pressure_net: ControlNet, number: Ints, count: int) -> csc_array:
    """What a unit of each component of each control carries out of each part, (3c, k) mm2.

    The mean of a Bernstein polynomial of a facet is one over their number.
    """
    mesh = pressure_net.mesh
    faces = np.flatnonzero(mesh.tets_of_face[:, 1] < 0)
    tet = mesh.tets_of_face[faces, 0]
    faces, tet = faces[number[tet] >= 0], tet[number[tet] >= 0]
    local = (mesh.faces_of_tet[tet] == faces[:, None]).argmax(axis=1)
    controls = net.closure(2, net.mesh.faces_of_tet[tet, local])
    facets = mesh.all_faces[faces]
    each = (mesh.areas(facets) / controls.shape[1])[:, None] * mesh.normals(facets)
    rows = 3 * controls[:, :, None] + np.arange(3)
    data, columns = (
        np.broadcast_to(x, rows.shape) for x in (each[:, None], number[tet][:, None, None])
    )
    flat = (data.ravel(), (rows.ravel(), columns.ravel()))
    return csc_array(coo_array(flat, shape=(3 * net.count, count)))


def _plain(modes: Floats) -> Floats:
    """The same span by columns of few entries, each with a one where the others have zeros."""
    if not modes.shape[1]:
        return modes
    _, _, pivots = qr(modes.T, mode="economic", pivoting=True)
    square = modes[np.sort(pivots[: modes.shape[1]])]
    return np.round(np.linalg.solve(square.T, modes.T).T, 9)
