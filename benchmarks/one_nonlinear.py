# SPDX-License-Identifier: BSD-3-Clause
"""One solve of a nonlinear law by one engine in this process: started by nonlinear.py.

A block of 1 mm clamped below, its top moved up by `STRAIN` and held, in one step of the load.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import isolated
import numpy as np
import problem
from engines.clock import Clock

A, STRAIN = 5.0, 0.38
RTOL = 1e-10
"""What is out of balance over the free unknowns, relative to the internal forces."""
MOST = 30
Answer = dict[str, Any]


def solve(request: dict[str, Any]) -> Answer:
    """A warm-up on a few cells, then the solve."""
    way: Callable[..., Answer] = WAYS[request["engine"]]
    degree, how = request["degree"], (request["law"], request["configuration"], request["threads"])
    way(tets(3 * (3 * degree + 1) ** 3, degree), degree, *how)
    given = problem.read_tets(Path(request["tets"]))
    before = isolated.resident()
    isolated.forget_peak()
    return way(given, degree, *how) | {"memory": isolated.peak() - before}


def tets(unknowns: int, degree: int) -> problem.Tets:
    """The block with about so many unknowns; its whole top stands where the patch would."""
    mesh = problem.block(unknowns, degree)
    return problem.Tets(mesh.points, mesh.tets, mesh.facets_of("bottom"), mesh.facets_of("top"))


def ours(given: problem.Tets, degree: int, law: str, configuration: str, threads: int) -> Answer:
    """All of `solve`: net, supports, operators, preconditioner, Newton, reactions, energy."""
    import bezsoma as bz

    mesh = bz.TetMesh(
        given.points, given.tets, surfaces={"bottom": given.bottom, "top": given.patch}
    )
    E, nu = problem.E, problem.NU
    laws = {"linear": bz.LinearElastic(E, nu), "stiffening": bz.Stiffening(E, nu, A)}
    material = laws.get(law) or bz.NeoHooke(E, nu)
    supports = [bz.Fixed("bottom"), bz.Moved("top", translation=(0, 0, STRAIN))]
    clock = Clock()
    body = bz.Body(mesh, degree, material, supports)
    found = bz.solve(body, solver="multigrid", rtol=RTOL, steps=1, threads=threads)
    return {
        "unknowns": 3 * found.net.count,
        "seconds": clock.wall(),
        "processor": clock.processor(),
        "iterations": found.iterations,
        "linear": sum(each.linear for each in found.path),
        "residual": found.residual,
        "reaction": float(found.reactions["top"].force[2]),
    }


def ngsolve(given: problem.Tets, degree: int, law: str, configuration: str, threads: int) -> Answer:
    """Newton on the tangent at each state, from the linear answer; factored, or by GMRES."""
    import ngsolve as ng
    from engines import ngsolve_engine

    mesh = ngsolve_engine.prepared(given, degree)
    ng.SetNumThreads(threads)
    with ng.TaskManager():
        clock = Clock()
        space: dict[str, Any] = {"order": degree, "dirichlet": "bottom|patch"}
        if configuration == "multigrid":
            V = ng.H1(mesh, dim=3, **space)
        else:
            V = ng.VectorH1(mesh, wb_withedges=False, **space)
        moved = ng.GridFunction(V)
        moved.Set(ng.CoefficientFunction((0, 0, STRAIN)), definedon=mesh.Boundaries("patch"))
        a = _form(V, law, degree)
        kind = "direct" if configuration in ("pardiso", "sparsecholesky") else "gmres"
        pre = None
        if kind == "gmres":
            pre = ng.Preconditioner(a, configuration, inverse="pardiso")
        free = V.FreeDofs()
        project = ng.Projector(free, True)
        u, r, dx = ng.GridFunction(V), moved.vec.CreateVector(), moved.vec.CreateVector()
        u.vec[:] = 0
        steps = linear = 0
        size = np.inf
        while steps < MOST:
            if steps:
                a.Apply(u.vec, r)
                whole = r.Norm()
                size = _free(project, r) / whole
                if size <= RTOL:
                    break
            a.AssembleLinearization(u.vec)
            if not steps:  # the supports move: K dx = - K (what is prescribed)
                r.data = a.mat * moved.vec
                u.vec.data += moved.vec
                _free(project, r)
            dx[:] = 0
            if kind == "direct":
                dx.data = a.mat.Inverse(free, inverse=configuration) * r
                linear += 1
            else:
                tolerance = min(1e-2, 0.1 * size) if steps else 1e-3
                linear += _gmres(ng, a.mat, pre.mat, r, dx, project, max(tolerance, 1e-8))
            _searched(a, u, r, dx, project, bool(steps))
            steps += 1
        a.Apply(u.vec, r)
        one = ng.GridFunction(V)
        one.Set(ng.CoefficientFunction((0, 0, 1)), definedon=mesh.Boundaries("patch"))
        reaction = float(ng.InnerProduct(r, one.vec))
        seconds, processor = clock.wall(), clock.processor()
    return {
        "unknowns": V.ndof * V.dim,
        "seconds": seconds,
        "processor": processor,
        "iterations": steps,
        "linear": linear,
        "residual": float(size),
        "reaction": reaction,
    }


def _form(V: Any, law: str, degree: int) -> Any:
    """The internal forces, by the same exactness of quadrature as ours."""
    import ngsolve as ng

    E, nu = problem.E, problem.NU
    mu, lam = E / 2 / (1 + nu), E * nu / (1 + nu) / (1 - 2 * nu)
    u, v = V.TnT()
    a = ng.BilinearForm(V, symmetric=law == "neo-Hooke" and V.dim == 1)
    dx = ng.dx(bonus_intorder=max(2 * degree + 2, 6) - 2 * (degree - 1))
    identity = ng.Id(3)
    if law == "stiffening":
        eps, test = (0.5 * (ng.Grad(w) + ng.Grad(w).trans) for w in (u, v))
        tau = 2 * mu * eps + lam * ng.Trace(eps) * identity
        factor = ng.exp(A * ng.InnerProduct(eps, eps))
        a += (factor * ng.InnerProduct(tau, test)).Compile() * dx
    else:
        F = identity + ng.Grad(u)
        J, C = ng.Det(F), F.trans * F
        W = mu / 2 * (ng.Trace(C) - 3) - mu * ng.log(J) + lam / 2 * ng.log(J) ** 2
        a += ng.Variation(W.Compile() * dx)
    return a


def _free(project: Any, r: Any) -> float:
    """Leaves the free part of r, and gives its length."""
    r.data = (project * r).Evaluate()
    return float(r.Norm())


def _gmres(ng: Any, matrix: Any, pre: Any, r: Any, dx: Any, project: Any, rtol: float) -> int:
    """How many iterations; NGSolve's own GMRES."""
    from ngsolve.krylovspace import GMResSolver

    solver = GMResSolver(mat=matrix, pre=pre, tol=rtol, maxiter=500, printrates=False)
    dx.data = solver.Solve(rhs=r, initialize=True)
    return int(solver.iterations)


def _searched(a: Any, u: Any, r: Any, dx: Any, project: Any, halve: bool) -> None:
    """Takes the largest of 1, 1/2, 1/4, ... of dx off u with which the residual falls."""
    start, factor = r.Norm(), 1.0
    new = r.CreateVector()
    for _ in range(12):
        u.vec.data -= factor * dx
        a.Apply(u.vec, new)
        if not halve or _free(project, new) < start:
            return
        u.vec.data += factor * dx
        factor /= 2
    raise RuntimeError("Newton stands still")


WAYS = {"bezsoma": ours, "ngsolve": ngsolve}

if __name__ == "__main__":
    isolated.serve(solve)
