# SPDX-License-Identifier: BSD-3-Clause
"""The fast way for the mixed form: BiCGStab without a matrix, block triangular."""

from __future__ import annotations

import numpy as np

from bezsoma import _core
from bezsoma.arrays import Bools, Floats, plain
from bezsoma.equations.matrix_free import walk
from bezsoma.equations.mixed_free import MixedFree
from bezsoma.errors import NotConverged
from bezsoma.solvers.krylov import Report, larger_rtol
from bezsoma.solvers.multigrid import degree_one

MOST_ITERATIONS = 5000


def preconditioner(operator: MixedFree, held: Bools, levels: Floats) -> _core.Saddle:
    """About the inverse of [A B^T; 0 -S], with A of the displacement and S of the pressure.

    A: the blocks of entities and multigrid of `bezsoma.solvers.multigrid`, for lambda = 0 and
    mu = G. Not of the deviatoric stress itself, which hardly resists where tets swell or shrink
    alike: that is the pressure's to forbid. S = int (1/(2G) + 1/kappa) p q, inverted tet by tet
    with the ladder of the inverse mass matrix, averaged where tets meet, and Chebyshev steps.
    """
    G, compressibility = operator.moduli.T
    corners, places, held_vertices = degree_one(operator.net, held)
    return _core.Saddle(
        operator.kernel,
        walk(operator.net, np.column_stack([0 * G, G]) / _unit(operator)),
        corners,
        places,
        held,
        held_vertices,
        1 / (2 * G) + compressibility,
        plain(levels),
    )


def saddle(
    operator: MixedFree,
    held: Bools,
    f: Floats,
    g: Floats,
    levels: Floats,
    rtol: float,
    report: Report,
    most: int = MOST_ITERATIONS,
    against: tuple[Floats, Floats] | None = None,
) -> tuple[Floats, Floats, list[float]]:
    """u (c, 3) mm, zero where held, and p (cp,) MPa with `operator` (u, p) = (f, g) where free.

    `levels` (j, cp) are pressures that no displacement feels (the constants of a part whose whole
    boundary is held, at nu = 1/2): they are taken out of g, and of p so that int level p = 0.

    Forces [N] and changes of volume [mm3] are compared by w = 2 G / h, N/mm3, with the largest G
    and the mean width h of a tet: converged means |r_u| <= rtol r and w |r_p| <= rtol r with
    r^2 = |f|^2 + w^2 |g|^2, on the residual formed anew at the end; `against` has other f and g
    for r, where these are what an earlier solution leaves. The history has the larger of
    both relative to r, one a step; a step applies the form twice. Same bits for any number of
    threads.
    """
    G, unit = operator.stiffest, _unit(operator)
    weight = 2 * G**2 / unit
    f, u, p = np.where(held, 0.0, f), np.zeros(f.shape), np.zeros(g.shape)
    part = 1.0 if against is None else _size(f, g, weight) / _size(*against, weight)
    if part <= rtol:
        return u, p, [part]
    levels = _orthogonal(levels)
    solver = preconditioner(operator, held, levels)

    def told(step: int, residual: float) -> None:
        report(step, part * residual)

    found, residual, converged, broken, rounded = solver.solve(
        f, plain(g), u, p, unit, weight, rtol / part, most, told
    )
    history = [part * each for each in found[:-1]] + [part * residual]
    residual = history[-1]
    if converged:
        return u, _without(operator, levels, p), history
    how = "stand still, since rounding lets them come no further," if rounded else "are not done"
    if broken:
        how = "broke down"
    raise NotConverged(
        f"the iterations for displacement and pressure {how} after {len(history) - 1} steps, at "
        f"{residual:.3g} of the residual at the start at best; rtol = {rtol:g} was asked for. What "
        "slows them down is flat tets (a thin layer), stiffnesses that differ 1e4 times and more "
        "between neighbours, and tets with all four vertices held: look at the mesh (bezsoma mesh "
        "info), take a lower degree, or solver='direct' on a small problem"
        f"{larger_rtol(residual)}",
        history,
    )


def _size(f: Floats, g: Floats, weight: float) -> float:
    """sqrt(|f|^2 + w^2 |g|^2), N."""
    return float(np.sqrt(np.einsum("ck,ck->", f, f) + weight**2 * np.einsum("p,p->", g, g)))


def _unit(operator: MixedFree) -> float:
    """G h, N/mm: by which the displacement's preconditioner is scaled to order one, for float32."""
    return operator.stiffest * operator.net.mesh.mean_size


def _orthogonal(levels: Floats) -> Floats:
    """The same span by rows that are orthogonal; not by a BLAS, see `krylov.dot`."""
    rows: list[Floats] = []
    for level in levels:
        for row in rows:
            level = level - float(np.einsum("i,i", row, level)) * row
        rows.append(level / np.sqrt(float(np.einsum("i,i", level, level))))
    return np.array(rows).reshape(levels.shape)


def _without(operator: MixedFree, levels: Floats, p: Floats) -> Floats:
    """p minus what levels there are in it: int level p = 0 for all of them."""
    if len(levels) == 0:
        return p
    weighted = np.array([operator.mass(np.ones(len(operator.moduli)), level) for level in levels])
    gram, right = np.einsum("ip,jp->ij", weighted, levels), np.einsum("ip,p->i", weighted, p)
    part = np.linalg.solve(gram, right)
    taken: Floats = np.einsum("j,jp->p", part, levels)
    return p - taken
