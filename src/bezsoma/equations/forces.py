# SPDX-License-Identifier: BSD-3-Clause
"""From loads to forces on controls: the work of a load on each Bernstein polynomial.

The paper, eq. 35, has body forces only; surgery and every test need tractions and pressures too.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from bezsoma import bernstein
from bezsoma.arrays import Floats, Ints, frozen
from bezsoma.mechanics.body import Body
from bezsoma.mechanics.loads import BodyForce, PointForce, Pressure, Traction, vertex_of
from bezsoma.mesh.control_net import ControlNet

Spread = Traction | Pressure | BodyForce

_AT_ONCE = 1 << 21


def forces(body: Body, net: ControlNet) -> Floats:
    """The forces (c, 3) N of all dead loads on the controls: int B_a t dS + int B_a f dV + P.

    A pressure that follows the deformation is no dead load: see `following`.

    Constants and polynomials are integrated in closed form, functions by quadrature of their
    stated exactness. The Bernstein polynomials sum to one, so the forces sum to the whole load:

    >>> from bezsoma.mechanics import Body, Fixed, LinearElastic, Traction
    >>> from bezsoma.mesh.solids import block
    >>> loads = [Traction("top", value=(0, 0, -2))]
    >>> body = Body(block(), 3, LinearElastic(1.0, 0.3), [Fixed("bottom")], loads)
    >>> bool(np.allclose(forces(body, ControlNet(body.mesh, 3)).sum(axis=0), [0, 0, -2]))
    True
    """
    total = np.zeros((net.count, 3))
    for load in body.loads:
        if isinstance(load, PointForce):
            total[net.of_vertices(np.array([vertex_of(load, net.mesh)]))] += load.force
        elif isinstance(load, BodyForce):
            _add_volume(total, load, net)
        elif not (isinstance(load, Pressure) and load.following):
            for name in load.surfaces:
                _add_surface(total, load, name, net)
    return total


def _add_volume(total: Floats, load: BodyForce, net: ControlNet) -> None:
    mesh = net.mesh
    tets = np.arange(len(mesh.tets))
    if load.regions:
        wanted = [mesh.regions.index(name) for name in load.regions]
        tets = np.flatnonzero(np.isin(mesh.region, wanted))
    for part in _runs(len(tets), load, net.degree, 3):
        run = tets[part]
        work = integrals(load, mesh.points[mesh.tets[run]], mesh.volumes[run], net.degree)
        _add(total, net.of_tet[run], work)


def _add_surface(total: Floats, load: Traction | Pressure, name: str, net: ControlNet) -> None:
    mesh = net.mesh
    facets = mesh.facets_of(name)
    for part in _runs(len(facets), load, net.degree, 2):
        run = facets[part]
        work = integrals(load, mesh.points[run], mesh.areas(run), net.degree)
        if isinstance(load, Pressure):
            work = -work * mesh.normals(run)[:, None, :]
        _add(total, net.of_facets(run), work)


def _add(total: Floats, numbers: Ints, work: Floats) -> None:
    for axis in range(3):
        total[:, axis] += np.bincount(
            numbers.ravel(), work[..., axis].ravel(), minlength=len(total)
        )


def _runs(count: int, load: Spread, degree: int, dim: int) -> list[slice]:
    """Slices of so many simplices that neither samples nor integrals take much memory."""
    points, weights = _rule(degree, dim, load.value.degree, load.exactness)
    step = max(1, _AT_ONCE // max(len(points), len(weights)))
    return [slice(start, start + step) for start in range(0, count, step)]


def integrals(load: Spread, corners: Floats, measures: Floats, degree: int) -> Floats:
    """Int B_a g over each simplex (s, m, k), from its corners (s, d + 1, 3) and measure (s,).

    >>> corners = np.array([[[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]])
    >>> load = Traction("top", value=(0, 0, 6))
    >>> integrals(load, corners, np.array([0.5]), 1)[0, :, 2].tolist()
    [1.0, 1.0, 1.0]
    """
    value = load.value
    bary, weights = _rule(degree, corners.shape[1] - 1, value.degree, load.exactness)
    points = bary @ corners
    values = value(points.reshape(-1, 3)).reshape(*points.shape[:2], value.size)
    return np.asarray(measures[:, None, None] * (weights @ values))


@lru_cache(maxsize=64)
def _rule(
    degree: int, dim: int, value_degree: int | None, exactness: int | None
) -> tuple[Floats, Floats]:
    """Points (q, d + 1) and weights (m, q), so that int B_a g = measure * weights @ g(points).

    For a polynomial g of degree q the points are its domain points and the weights turn values
    into controls and these into integrals, mass(n, q) @ interpolation(q): exact, no quadrature.
    """
    if value_degree is not None:
        points = bernstein.domain_points(value_degree, dim)
        closed = bernstein.mass(degree, value_degree, dim)
        return points, frozen(closed @ bernstein.interpolation(value_degree, dim))
    points, weights = bernstein.simplex(2 * degree + 2 if exactness is None else exactness, dim)
    return points, frozen((bernstein.values(degree, points) * weights[:, None]).T.copy())
