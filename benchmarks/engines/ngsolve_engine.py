# SPDX-License-Identifier: BSD-3-Clause
"""NGSolve, in the configurations that its own documentation recommends for elasticity.

`multigrid` solves the part of degree 1 directly and smooths the rest with blocks; `bddc` couples
elements by vertices, or by vertices and edges. Both on statically condensed matrices from degree 4
on. At degree 1 `multigrid` is a direct solver, so there we also give it PyAMG.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import netgen.meshing as netgen
import ngsolve as ng
import numpy as np
import problem
import scipy.sparse as sp

from engines import Answer
from engines.clock import Clock

CONDENSED_FROM = 4
DIRECT_UP_TO = 120_000
MOST_ITERATIONS = 2000

ng.ngsglobals.msg_level = 0


def configurations(degree: int, unknowns: int) -> list[str]:
    """What is worth a try."""
    small = ["direct"] if unknowns <= DIRECT_UP_TO else []
    if degree == 1:
        return ["pyamg", *small] if unknowns <= DIRECT_UP_TO else ["pyamg", "multigrid"]
    if degree > 2:  # h1amg meets singular blocks there
        return ["multigrid", "bddc vertices", "bddc", *small]
    return ["multigrid", "bddc vertices", "bddc vertices h1amg", *small]


def prepared(tets: problem.Tets, degree: int) -> ng.Mesh:
    """The same tets with the boundaries bottom, patch and rest."""
    mesh = netgen.Mesh(dim=3)
    mesh.AddPoints(np.ascontiguousarray(tets.points))
    bottom, patch = (_keys(facets) for facets in (tets.bottom, tets.patch))
    every = _outer(tets.tets)
    keys = _keys(every)
    rest = every[~np.isin(keys, np.concatenate([bottom, patch]))]
    parts = {"bottom": tets.bottom, "patch": tets.patch, "rest": rest}
    for number, (name, facets) in enumerate(parts.items(), start=1):
        mesh.Add(netgen.FaceDescriptor(bc=number, domin=1, surfnr=number))
        mesh.SetBCName(number - 1, name)
        mesh.AddElements(dim=2, index=number, data=facets.astype(np.int32), base=0)
    mesh.AddElements(dim=3, index=1, data=_turned(tets).astype(np.int32), base=0)
    return ng.Mesh(mesh)


def solved(
    mesh: ng.Mesh, degree: int, configuration: str, threads: int, tolerance: float
) -> Answer:
    """One solve, with the true residual formed without a matrix when the clock has stopped."""
    ng.SetNumThreads(threads)
    with ng.TaskManager():
        clock = Clock()
        system = _system(mesh, degree, configuration)
        solve = SOLVERS[configuration.split()[0]](system, configuration, tolerance)
        setting_up = clock.wall()
        iterations = solve()
        both, processor = clock.wall(), clock.processor()
        residual = _residual(system)
    energy = ng.InnerProduct(system.u.vec, system.f.vec) / 2
    return Answer(
        system.space.ndof * system.space.dim,
        setting_up,
        both - setting_up,
        processor,
        iterations,
        residual,
        energy,
    )


@dataclass(frozen=True, eq=False)
class _System:
    space: Any
    a: Any
    f: Any
    u: Any
    condensed: bool
    integrand: Any


def _system(mesh: ng.Mesh, degree: int, configuration: str) -> _System:
    scalar = configuration.startswith(("bddc", "pyamg"))
    if scalar:
        edges = {"wb_withedges": "vertices" not in configuration}
        space = ng.VectorH1(mesh, order=degree, dirichlet="bottom", **edges)
    else:
        space = ng.H1(mesh, order=degree, dim=3, dirichlet="bottom")
    u, v = space.TnT()
    lam = problem.E * problem.NU / (1 + problem.NU) / (1 - 2 * problem.NU)
    mu = problem.E / 2 / (1 + problem.NU)
    strain, test = (0.5 * (ng.Grad(w) + ng.Grad(w).trans) for w in (u, v))
    integrand = 2 * mu * ng.InnerProduct(strain, test)
    integrand += lam * ng.Trace(ng.Grad(u)) * ng.Trace(ng.Grad(v))
    condensed = degree >= CONDENSED_FROM or configuration.startswith("bddc")
    symmetric = configuration != "pyamg"  # where it stores one half only
    a = ng.BilinearForm(space, symmetric=symmetric, condense=condensed)
    a += integrand * ng.dx
    f = ng.LinearForm(space)
    f += ng.CoefficientFunction(problem.TRACTION) * v * ng.ds("patch")
    return _System(space, a, f, ng.GridFunction(space), condensed, integrand)


def _preconditioned(s: _System, configuration: str, tolerance: float) -> Callable[[], int]:
    options = {"coarsetype": "h1amg"} if "h1amg" in configuration else {"inverse": "pardiso"}
    kind = configuration.split()[0]
    preconditioner = ng.Preconditioner(s.a, kind, **options)
    s.a.Assemble()
    s.f.Assemble()

    def solve() -> int:
        inverse = ng.CGSolver(
            s.a.mat,
            preconditioner.mat,
            maxiter=MOST_ITERATIONS,
            tol=tolerance,
            printrates=False,
        )
        _extended(s, inverse)
        return int(inverse.GetSteps())

    return solve


def _direct(s: _System, configuration: str, tolerance: float) -> Callable[[], int]:
    s.a.Assemble()
    s.f.Assemble()
    inverse = s.a.mat.Inverse(s.space.FreeDofs(s.condensed), inverse="pardiso")

    def solve() -> int:
        _extended(s, inverse)
        return 1

    return solve


def _extended(s: _System, inverse: Any) -> None:
    """u from the (condensed) matrix, then inside the elements."""
    r = s.f.vec.CreateVector()
    r.data = s.f.vec
    if s.condensed:
        r.data += s.a.harmonic_extension_trans * r
    s.u.vec.data = inverse * r
    if s.condensed:
        s.u.vec.data += s.a.harmonic_extension * s.u.vec
        s.u.vec.data += s.a.inner_solve * r


def _algebraic(s: _System, configuration: str, tolerance: float) -> Callable[[], int]:
    """Degree 1 with PyAMG: NGSolve's matrix, components of a vertex beside each other."""
    from engines import rigid

    s.a.Assemble()
    s.f.Assemble()
    values, columns, starts = s.a.mat.CSR()
    matrix = sp.csr_matrix((np.array(values), np.array(columns), np.array(starts)))
    vertices = s.space.ndof // 3
    order = np.arange(3 * vertices).reshape(3, vertices).T.ravel()
    order = order[np.array(s.space.FreeDofs())[order]]
    places = np.array([point.point for point in s.space.mesh.vertices])
    free = np.unique(order % vertices)
    hierarchy = rigid.multigrid(matrix[order][:, order], places[free])
    b = s.f.vec.FV().NumPy()[order]

    def solve() -> int:
        x, iterations = rigid.conjugate_gradients(hierarchy, b, tolerance)
        s.u.vec.FV().NumPy()[order] = x
        return iterations

    return solve


SOLVERS = {
    "multigrid": _preconditioned,
    "bddc": _preconditioned,
    "direct": _direct,
    "pyamg": _algebraic,
}


def _residual(s: _System) -> float:
    """|f - K u| / |f| over the free unknowns of the whole, not the condensed system."""
    whole = ng.BilinearForm(s.space, nonassemble=True)
    whole += s.integrand * ng.dx
    free = ng.Projector(s.space.FreeDofs(), True)
    left, given = s.f.vec.CreateVector(), s.f.vec.CreateVector()
    left.data = s.f.vec - whole.mat * s.u.vec
    left.data, given.data = (free * left).Evaluate(), (free * s.f.vec).Evaluate()
    return float(left.Norm() / given.Norm())


def _outer(tets: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """The facets of one tet only (f, 3), ascending."""
    corners = ((1, 2, 3), (0, 2, 3), (0, 1, 3), (0, 1, 2))
    facets = np.sort(np.concatenate([tets[:, list(c)] for c in corners]), axis=1)
    _, first, count = np.unique(_keys(facets), return_index=True, return_counts=True)
    return np.asarray(facets[first[count == 1]])


def _keys(facets: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """One number for each facet (f, 3) of fewer than 2^21 vertices."""
    a, b, c = np.sort(facets, axis=1).astype(np.int64).T
    return np.asarray((a << 42) | (b << 21) | c)


def _turned(tets: problem.Tets) -> np.ndarray[Any, Any]:
    """The tets with vertices in the order that Netgen wants."""
    edges = tets.points[tets.tets[:, 1:]] - tets.points[tets.tets[:, :1]]
    mirrored = np.linalg.det(edges) > 0
    return np.where(mirrored[:, None], tets.tets[:, [0, 1, 3, 2]], tets.tets)
