# SPDX-License-Identifier: BSD-3-Clause
"""What a tangent gives for two changes, tet by tet: the parts that add up to a . K b."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from bezsoma import _core, bernstein
from bezsoma.arrays import Floats, Ints
from bezsoma.equations.mixed_pointwise import MixedPointwise
from bezsoma.equations.pointwise import Pointwise
from bezsoma.equations.threads import thread_count
from bezsoma.mechanics.body import Body
from bezsoma.mechanics.laws import Law, MixedLaw
from bezsoma.mesh.control_net import ControlNet
from bezsoma.mesh.evaluation import gradient_controls, portions
from bezsoma.mesh.field import Field
from bezsoma.mesh.parts import owners
from bezsoma.solvers.nonlinear_mixed import beside_pressure

Product = Callable[[Floats, Floats], Floats]
"""a, b (n,) -> (t,) N mm, adding up to b . K a; see `Raised` for what n counts."""


def displacement_product(net: ControlNet, lame: Floats, threads: int = 0) -> Product:
    """Of a linear body without pressures; lame (regions, 2): lambda and mu.

        int T(a) : grad b,  T = lam tr(H) I + mu (H + H^T)

    The operator does it, on tets that share no control: what it gives then are the forces of each
    tet alone. Their work is that of the whole:

    >>> from bezsoma.equations.matrix_free import MatrixFree
    >>> from bezsoma.mesh.solids import block
    >>> net = ControlNet(block(cells=2), 3)
    >>> a, b = np.sin(7 * net.points), np.cos(5 * net.points)
    >>> work = displacement_product(net, np.array([[0.6, 0.4]]))(a.ravel(), b.ravel())
    >>> whole = float((b * (MatrixFree(net, np.array([[0.6, 0.4]])) @ a)).sum())
    >>> bool(abs(work.sum() - whole) < 1e-13 * abs(whole))
    True
    """
    mesh, columns, runs = net.mesh, *_by_entity(net)
    size, number = len(columns), thread_count(threads)

    def forces(local: Floats, tets: slice) -> Floats:
        """Those of each tet alone (t, m, 3), the controls entity by entity as `local`'s."""
        count = len(local)
        first = (runs + size * np.arange(count)[:, None]).astype(np.int32)
        corners, region = mesh.tets[tets], mesh.region[tets]
        walk = _core.Walk(net.degree, first, np.arange(count), mesh.points, corners, region, moduli)
        out = np.empty((count * size, 3, 1))
        _core.MatrixFree(walk, number, "").apply(local.reshape(-1, 3, 1), out)
        return out.reshape(local.shape)

    moduli = np.ascontiguousarray(lame, dtype=np.float64)

    def product(a: Floats, b: Floats) -> Floats:
        out = np.empty(len(mesh.tets))
        for tets in portions(len(out), 6 * size):
            numbers = np.take(net.of_tet[tets], columns, axis=1)
            local = np.take(a.reshape(-1, 3), numbers, axis=0)
            other = local if b is a else np.take(b.reshape(-1, 3), numbers, axis=0)
            out[tets] = np.einsum("tmk,tmk->t", forces(local, tets), other)
        return out

    return product


def _by_entity(net: ControlNet) -> tuple[Ints, Ints]:
    """A tet's controls in the order of its entities (m,), and where each entity's begin (e,)."""
    part, rank = owners(net.degree, 3)
    columns = np.lexsort((rank, part))
    return columns, np.flatnonzero(rank[columns] == 0)


def linear_product(net: ControlNet, pressures: ControlNet, moduli: Floats) -> Product:
    """Of a linear body with pressures, from gradients; moduli (regions, 3): lambda, mu, 1/kappa.

    int T(a) : grad b - p_a div b - p_b div a - p_a p_b / kappa,  T = lam tr(H) I + mu (H + H^T)
    """
    mesh, degree = net.mesh, net.degree - 1
    mass = bernstein.mass(degree, degree, 3)

    def parts(x: Floats, tets: slice) -> tuple[Floats, Floats]:
        """grad u (t, m, 3, 3) and p (t, m), both of degree n - 1."""
        H = gradient_controls(Field(net, x[: 3 * net.count].reshape(-1, 3)), tets)
        p = x[3 * net.count :][pressures.of_tet[tets]]
        up = bernstein.elevation(pressures.degree, 3, degree - pressures.degree)
        return H, p @ up.T

    def product(a: Floats, b: Floats) -> Floats:
        out = np.empty(len(mesh.tets))
        for tets in portions(len(out), 40 * len(mass)):
            lam, mu, soft = (each[:, None] for each in moduli[mesh.region[tets]].T)
            (H, p), (G, q) = parts(a, tets), parts(b, tets)
            T = mu[..., None, None] * (H + np.swapaxes(H, 2, 3))
            trace = np.einsum("tmii->tm", H)
            T += (lam * trace - p)[..., None, None] * np.eye(3)
            T, flat = T.reshape(*p.shape, 9), G.reshape(*p.shape, 9)
            work = np.einsum("tmk,tmk->t", mass @ T, flat, optimize=True)
            work -= np.einsum("tm,tm->t", q @ mass, trace + soft * p)
            out[tets] = mesh.volumes[tets] * work
        return out

    return product


def tangent_product(
    body: Body, net: ControlNet, pressures: ControlNet | None, exactness: int, x: Floats
) -> tuple[Product, bool]:
    """Of a body of any laws at the state x, by quadrature; and whether it is symmetric."""
    laws = body.material_of_region
    if pressures is None:
        pointwise = Pointwise(net, [law for law in laws if isinstance(law, Law)], exactness)
        return _plain(pointwise, x), pointwise.symmetric
    internal = MixedPointwise(net, pressures, [beside_pressure(law) for law in laws], exactness)
    return _beside(internal, x), internal.symmetric


def _plain(pointwise: Pointwise, x: Floats) -> Product:
    volumes, weights = pointwise.net.mesh.volumes, pointwise.rule[1]
    state = x.reshape(-1, 3)

    def product(a: Floats, b: Floats) -> Floats:
        out = np.empty(len(volumes))
        for law, tets in pointwise.runs():
            H, A, B = (pointwise.gradients(each.reshape(-1, 3), tets) for each in (state, a, b))
            work = np.einsum("tqij,tqij,q->t", law.derivative(H, A), B, weights)
            out[tets] = volumes[tets] * work
        return out

    return product


def _beside(internal: MixedPointwise, x: Floats) -> Product:
    volumes, weights = internal.net.mesh.volumes, internal.shape.rule[1]
    split = 3 * internal.net.count

    def points(y: Floats) -> Iterator[tuple[MixedLaw, Ints, Floats, Floats]]:
        return internal.points(y[:split].reshape(-1, 3), y[split:])

    def product(a: Floats, b: Floats) -> Floats:
        out = np.empty(len(volumes))
        for (law, tets, H, p), (*_, A, dp), (*_, B, q) in zip(
            points(x), points(a), points(b), strict=True
        ):
            P, c = law.mixed_derivative(H, p, A, dp)
            work = np.einsum("tqij,tqij,q->t", P, B, weights) + np.einsum(
                "tq,tq,q->t", c, q, weights
            )
            out[tets] = volumes[tets] * work
        return out

    return product
