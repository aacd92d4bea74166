# SPDX-License-Identifier: BSD-3-Clause
"""scikit-fem, degrees 1 and 2, with MKL PARDISO (Cholesky) or PyAMG with the rigid-body modes."""

from __future__ import annotations

from typing import Any

import numpy as np
import problem
import scipy.sparse as sp
import skfem
from pypardiso import PyPardisoSolver
from skfem.models.elasticity import lame_parameters, linear_elasticity

from engines import Answer, rigid
from engines.clock import Clock

SYMMETRIC_POSITIVE = 2  # PARDISO's mtype
DIRECT_UP_TO = 120_000


def configurations(degree: int, unknowns: int) -> list[str]:
    """What is worth a try."""
    if degree > 2:
        return []
    return ["pyamg", "pardiso"] if unknowns <= DIRECT_UP_TO else ["pyamg"]


def prepared(tets: problem.Tets, degree: int) -> Any:
    """The same tets; boundaries by facet number."""
    mesh = skfem.MeshTet1(tets.points.T.copy(), tets.tets.T.copy())
    found = {
        name: _facets(mesh, facets)
        for name, facets in (("bottom", tets.bottom), ("patch", tets.patch))
    }
    return mesh.with_boundaries(found)


def solved(mesh: Any, degree: int, configuration: str, threads: int, tolerance: float) -> Answer:
    """One solve."""
    clock = Clock()
    element = skfem.ElementVector(skfem.ElementTetP1() if degree == 1 else skfem.ElementTetP2())
    basis = skfem.Basis(mesh, element, intorder=2 * degree - 2)
    matrix = skfem.asm(linear_elasticity(*lame_parameters(problem.E, problem.NU)), basis)
    traction = skfem.LinearForm(lambda v, w: sum(t * v[k] for k, t in enumerate(problem.TRACTION)))
    f = skfem.asm(traction, basis.boundary("patch", intorder=degree))
    free = basis.complement_dofs(basis.get_dofs("bottom"))
    matrix, b = matrix[free][:, free].tocsr(), f[free]
    if configuration == "pyamg":  # components of a point follow each other, as PyAMG wants them
        hierarchy = rigid.multigrid(matrix, basis.doflocs[:, free[::3]].T)
        setting_up = clock.wall()
        x, iterations = rigid.conjugate_gradients(hierarchy, b, tolerance)
    else:
        solver = PyPardisoSolver(mtype=SYMMETRIC_POSITIVE)
        upper = sp.triu(matrix, format="csr")
        solver.factorize(upper)
        setting_up = clock.wall()
        x, iterations = solver.solve(upper, b), 1
    both, processor = clock.wall(), clock.processor()
    residual = float(np.linalg.norm(b - matrix @ x) / np.linalg.norm(b))
    return Answer(
        int(basis.N),
        setting_up,
        both - setting_up,
        processor,
        iterations,
        residual,
        float(b @ x / 2),
    )


def _facets(mesh: Any, facets: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """Their numbers in the mesh."""
    keys = (mesh.facets * np.array([[1 << 42], [1 << 21], [1]])).sum(axis=0)
    order = np.argsort(keys)
    wanted = (np.sort(facets, axis=1) * np.array([1 << 42, 1 << 21, 1])).sum(axis=1)
    return np.asarray(order[np.searchsorted(keys, wanted, sorter=order)])
