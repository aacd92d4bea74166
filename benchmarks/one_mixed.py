# SPDX-License-Identifier: BSD-3-Clause
"""One incompressible solve by one engine in this process: started by mixed.py, not by hand.

Taylor-Hood, degree k beside k - 1, 2 G eps' : eps' and nu = 1/2, on the problem of problem.py.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import isolated
import numpy as np
import problem
from engines.clock import Clock

G = problem.E / 3
"""At nu = 1/2, MPa."""
TIGHTENED = 5
Answer = dict[str, Any]


def solve(request: dict[str, Any]) -> Answer:
    """A warm-up on a few cells, then the solve; tightened until the true residual holds."""
    way: Callable[..., Answer] = WAYS[request["engine"]]
    degree, threads, name = request["degree"], request["threads"], request["configuration"]
    way(problem.tets(3 * (3 * degree + 1) ** 3, degree), degree, name, threads, 1e-4)
    tets = problem.read_tets(Path(request["tets"]))
    before = isolated.resident()
    tolerance = problem.RTOL
    for _ in range(TIGHTENED):
        isolated.forget_peak()
        answer = way(tets, degree, name, threads, tolerance)
        if answer["residual"] <= problem.RTOL:
            return answer | {"memory": isolated.peak() - before}
        tolerance *= 0.5 * problem.RTOL / answer["residual"]
    return {"failed": f"residual {answer['residual']:.1e} after {answer['iterations']} iterations"}


def ours(
    tets: problem.Tets, degree: int, configuration: str, threads: int, tolerance: float
) -> Answer:
    """Net, operator, supports, loads, preconditioner and solve; the mesh is not counted."""
    import bezsoma as bz
    from bezsoma.equations.boundary import prescribed
    from bezsoma.equations.forces import forces
    from bezsoma.equations.mixed_free import MixedFree
    from bezsoma.mesh import ControlNet
    from bezsoma.solvers.saddle import saddle

    surfaces = {"bottom": tets.bottom, "patch": tets.patch}
    body = problem.body(bz.TetMesh(tets.points, tets.tets, surfaces=surfaces), degree)
    clock = Clock()
    net, pressures = ControlNet(body.mesh, degree), ControlNet(body.mesh, degree - 1)
    held = prescribed(body, net).mask
    load = np.where(held, 0.0, forces(body, net))
    form = MixedFree(net, pressures, np.array([[G, 0.0]]), threads)
    zero, none = np.zeros(pressures.count), np.zeros((0, pressures.count))
    u, p, history = saddle(form, held, load, zero, none, tolerance, lambda *_: None)
    seconds, processor = clock.wall(), clock.processor()
    f, g = form.apply(u, p)
    left = np.hypot(np.linalg.norm(np.where(held, 0.0, load - f)), np.linalg.norm(g))
    return {
        "unknowns": u.size + p.size,
        "seconds": seconds,
        "processor": processor,
        "iterations": len(history) - 1,
        "residual": float(left / np.linalg.norm(load)),
        "energy": form.energy(u, p),
    }


def ngsolve(
    tets: problem.Tets, degree: int, configuration: str, threads: int, tolerance: float
) -> Answer:
    """PARDISO on the whole, or MINRES with a preconditioner of NGSolve's for 2 G eps : eps."""
    import ngsolve as ng
    from engines import ngsolve_engine

    mesh = ngsolve_engine.prepared(tets, degree)
    ng.SetNumThreads(threads)
    way = _ngsolve_direct if configuration == "direct" else _ngsolve_minres
    with ng.TaskManager():
        return way(mesh, degree, configuration, tolerance)


def _forms(u: Any, v: Any) -> tuple[Any, Any]:
    """2 G eps : eps, and the same of the deviators."""
    import ngsolve as ng

    strain, test = (0.5 * (ng.Grad(w) + ng.Grad(w).trans) for w in (u, v))
    whole = 2 * G * ng.InnerProduct(strain, test)
    return whole, whole - 2 * G / 3 * ng.Trace(ng.Grad(u)) * ng.Trace(ng.Grad(v))


def _ngsolve_direct(mesh: Any, degree: int, configuration: str, tolerance: float) -> Answer:
    import ngsolve as ng

    clock = Clock()
    both = ng.VectorH1(mesh, order=degree, dirichlet="bottom") * ng.H1(mesh, order=degree - 1)
    (u, p), (v, q) = both.TnT()
    _, deviatoric = _forms(u, v)
    a = ng.BilinearForm(both, symmetric=True)
    a += (deviatoric - p * ng.div(v) - q * ng.div(u)) * ng.dx
    a.Assemble()
    load = ng.LinearForm(ng.CoefficientFunction(problem.TRACTION) * v * ng.ds("patch")).Assemble()
    found = ng.GridFunction(both)
    found.vec.data = a.mat.Inverse(both.FreeDofs(), inverse="pardiso") * load.vec
    seconds, processor = clock.wall(), clock.processor()
    free = ng.Projector(both.FreeDofs(), True)
    left, given = load.vec.CreateVector(), load.vec.CreateVector()
    left.data, given.data = free * (load.vec - a.mat * found.vec), free * load.vec
    return {
        "unknowns": both.ndof,
        "seconds": seconds,
        "processor": processor,
        "iterations": 1,
        "residual": float(left.Norm() / given.Norm()),
        "energy": ng.InnerProduct(found.vec, load.vec) / 2,
    }


def _ngsolve_minres(mesh: Any, degree: int, configuration: str, tolerance: float) -> Answer:
    import ngsolve as ng
    from ngsolve.krylovspace import MinResSolver

    clock = Clock()
    edges = configuration == "bddc"
    V = ng.VectorH1(mesh, order=degree, dirichlet="bottom", wb_withedges=edges)
    Q = ng.H1(mesh, order=degree - 1)
    (u, v), (p, q) = V.TnT(), Q.TnT()
    whole, deviatoric = _forms(u, v)
    f = ng.LinearForm(ng.CoefficientFunction(problem.TRACTION) * v * ng.ds("patch")).Assemble()
    a = ng.BilinearForm(deviatoric * ng.dx).Assemble()
    b = ng.BilinearForm(-ng.Trace(ng.Grad(u)) * q * ng.dx).Assemble()
    full = ng.BilinearForm(whole * ng.dx)
    pre = ng.Preconditioner(full, "bddc", inverse="sparsecholesky")
    full.Assemble()
    mass = ng.BilinearForm(p * q / (2 * G) * ng.dx, symmetric=True)
    inverse = ng.Preconditioner(mass, "bddc" if degree > 2 else "local")
    mass.Assemble()
    transposed = b.mat.CreateTranspose()
    free = ng.Projector(V.FreeDofs(), True)
    K = ng.BlockMatrix([[a.mat, transposed], [b.mat, None]])
    C = ng.BlockMatrix([[pre.mat, None], [None, inverse.mat]])
    uh, ph = ng.GridFunction(V), ng.GridFunction(Q)
    right = ng.BlockVector([f.vec, ph.vec.CreateVector()])
    right[1][:] = 0
    residuals: list[float] = []
    MinResSolver(
        mat=K,
        pre=C,
        tol=tolerance,
        maxiter=3000,
        printrates=False,
        callback=lambda _, r: residuals.append(r),
    ).Solve(rhs=right, sol=ng.BlockVector([uh.vec, ph.vec]))
    seconds, processor = clock.wall(), clock.processor()
    left, given = f.vec.CreateVector(), f.vec.CreateVector()
    left.data = f.vec - a.mat * uh.vec - transposed * ph.vec
    left.data, given.data = (free * left).Evaluate(), free * f.vec
    wrong = ph.vec.CreateVector()
    wrong.data = b.mat * uh.vec
    return {
        "unknowns": V.ndof + Q.ndof,
        "seconds": seconds,
        "processor": processor,
        "iterations": len(residuals),
        "residual": float(np.hypot(left.Norm(), wrong.Norm()) / given.Norm()),
        "energy": ng.InnerProduct(uh.vec, f.vec) / 2,
    }


def pardiso(
    tets: problem.Tets, degree: int, configuration: str, threads: int, tolerance: float
) -> Answer:
    """scikit-fem's P2/P1 matrix, factored by MKL PARDISO as symmetric and indefinite."""
    import scipy.sparse as sp
    import skfem
    from engines import skfem_engine
    from pypardiso import PyPardisoSolver
    from skfem.helpers import ddot, div, sym_grad

    mesh = skfem_engine.prepared(tets, degree)
    clock = Clock()
    basis = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementTetP2()), intorder=3)
    other = basis.with_element(skfem.ElementTetP1())
    form = skfem.BilinearForm(
        lambda u, v, w: 2 * G * (ddot(sym_grad(u), sym_grad(v)) - div(u) * div(v) / 3)
    )
    A = skfem.asm(form, basis)
    B = skfem.asm(skfem.BilinearForm(lambda u, q, w: -div(u) * q), basis, other)
    traction = skfem.LinearForm(lambda v, w: sum(t * v[k] for k, t in enumerate(problem.TRACTION)))
    load = np.concatenate([skfem.asm(traction, basis.boundary("patch")), np.zeros(other.N)])
    K = sp.bmat([[A, B.T], [B, None]], format="csr")
    free = np.setdiff1d(np.arange(K.shape[0]), basis.get_dofs("bottom").all())
    K, b = K[free][:, free].tocsr(), load[free]
    upper = sp.triu(K).tocoo()
    diagonal = np.arange(len(b))
    upper = sp.csr_matrix(
        (
            np.concatenate([upper.data, np.zeros(len(b))]),
            (np.concatenate([upper.row, diagonal]), np.concatenate([upper.col, diagonal])),
        ),
        shape=K.shape,
    )
    solver = PyPardisoSolver(mtype=-2)
    solver.factorize(upper)
    x = solver.solve(upper, b)
    seconds, processor = clock.wall(), clock.processor()
    return {
        "unknowns": len(load),
        "seconds": seconds,
        "processor": processor,
        "iterations": 1,
        "residual": float(np.linalg.norm(b - K @ x) / np.linalg.norm(b)),
        "energy": float(b @ x / 2),
    }


WAYS = {"bezsoma": ours, "ngsolve": ngsolve, "pardiso": pardiso}

if __name__ == "__main__":
    isolated.serve(solve)
