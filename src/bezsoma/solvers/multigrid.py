# SPDX-License-Identifier: BSD-3-Clause
"""The fast way: conjugate gradients without a matrix, blocks of entities and multigrid."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from bezsoma import _core
from bezsoma.arrays import Bools, Floats, Int32s, Numbers
from bezsoma.equations.displacement import Equations
from bezsoma.equations.matrix_free import MatrixFree
from bezsoma.equations.threads import thread_count
from bezsoma.errors import NotConverged, counted
from bezsoma.mesh.control_net import ControlNet
from bezsoma.solvers.krylov import Report, larger_rtol, length

MOST_ITERATIONS = 5000


def preconditioner(operator: MatrixFree, held: Bools) -> _core.Multigrid:
    """The inverses of the blocks of vertices, edges, faces and interiors, and of degree 1.

        z = sum_e R_e^T K_ee^-1 R_e r + P B_1 P^T r

    R_e picks the free controls inside entity e, but of a vertex takes moments with the function
    that reaches from it along edges (docs/theory/fast.md); P elevates from degree 1 to n; B_1 is a
    V-cycle of smoothed aggregation on the matrix of degree 1, at that degree all there is. The
    blocks damp what is rough within a tet, degree 1 carries what is smooth across many (additive
    methods of this kind: L. Pavarino, Numer. Math. 66, 1994). Everything is float32 on a residual
    scaled to one, which costs no iteration; held (c, 3) says which components are prescribed.
    """
    stiff, parts = _parts(operator, held)
    return _core.Multigrid(operator.kernel, operator.walk(stiff), *parts)


def preconditioned(operator: MatrixFree, held: Bools) -> Callable[[Numbers], Numbers]:
    """What takes r (c, 3) to z (c, 3) for another operator, a tangent: as `preconditioner`.

    Nothing of the linear law is kept but the blocks, its product least of all; r is of norm one or
    so, in float64 or float32.
    """
    stiff, parts = _parts(operator, held)
    threads = thread_count(operator.threads)
    inverse = _core.Inverse(operator.walk(stiff), *parts, threads, operator.instructions)

    def z_of(r: Numbers) -> Numbers:
        r = np.ascontiguousarray(r)
        z = np.empty_like(r)
        if r.dtype == np.float32:
            inverse.apply_single(r, z)
        else:
            inverse.apply(r, z)
        return z

    return z_of


def _parts(
    operator: MatrixFree, held: Bools
) -> tuple[float, tuple[Int32s | None, Floats, Bools, Bools]]:
    """A stiffness that counts as one, and what says where degree 1 is and what is held."""
    # Conjugate gradients do not feel a factor of the preconditioner; float32 does: of order one.
    stiff = operator.stiffest * operator.net.mesh.mean_size
    corners, places, held_vertices = degree_one(operator.net, held)
    return stiff, (corners, places, held, held_vertices)


def degree_one(net: ControlNet, held: Bools) -> tuple[Int32s | None, Floats, Bools]:
    """What the problem of degree 1 on the same tets is made from.

    The rows of each tet's vertices (t, 4), tets in the order of the walk, None where the walk of
    the net itself has them; the places of the rows (v, 3) mm; and which of their components are
    held (v, 3).
    """
    vertices = net if net.degree == 1 else ControlNet(net.mesh, 1)
    held_vertices = np.empty((vertices.count, 3), dtype=bool)
    held_vertices[vertices.starts[0]] = held[net.starts[0]]
    places = np.empty((vertices.count, 3))
    places[vertices.starts[0]] = net.mesh.points
    corners = vertices.walked() if net.degree > 1 else None
    return corners, places, held_vertices


def multigrid(
    equations: Equations,
    operator: MatrixFree,
    b: Floats,
    rtol: float,
    report: Report,
    start: Floats | None = None,
    most: int = MOST_ITERATIONS,
) -> tuple[Floats, list[float]]:
    """x (c, 3), zero where held, with |b - K x| <= rtol |b| to a millionth, and the residuals.

    From `start`, zero where held, or from zero; |b| is the residual at zero in either case.
    The last residual is formed anew from the equations. Same bits for any number of threads.
    """
    return iterated(preconditioner(operator, equations.held), b, rtol, report, start, most)


def iterated(
    blocks: _core.Multigrid,
    b: Floats,
    rtol: float,
    report: Report,
    start: Floats | None = None,
    most: int = MOST_ITERATIONS,
) -> tuple[Floats, list[float]]:
    """What `multigrid` gives, by a preconditioner that was built before."""
    x = np.zeros(b.shape) if start is None else np.array(start, np.float64, order="C")
    history, residual, converged, indefinite, rounded = blocks.solve(
        b, x, length(b), rtol, most, report
    )
    history[-1] = residual
    if converged:
        return x, history
    how = "stand still, since rounding lets them come no further," if rounded else "are not done"
    cause = "slow them down"
    if indefinite:
        how = "met a direction without positive energy, by rounding,"
        cause = "let rounding have the upper hand"
    raise NotConverged(
        f"conjugate gradients {how} after {counted(len(history) - 1, 'iteration')}, at "
        f"{residual:.3g} of the residual at zero free displacement; rtol = {rtol:g} was asked for. "
        f"Very flat tets, thin shells, regions of very unequal stiffness or nu close to 1/2 {cause}"
        ": look at the mesh (bezsoma mesh info), take a lower degree, incompressible=True close to "
        f"1/2, or solver='direct' on a small problem{larger_rtol(residual)}",
        history,
    )
