# SPDX-License-Identifier: BSD-3-Clause
"""A neo-Hookean bar bent by half its length: scikit-fem's Newton on the same tets and points."""

from __future__ import annotations

import numpy as np
import pytest
import skfem as fem
from scipy.sparse.linalg import spsolve

import bezsoma as bz
from bezsoma import bernstein
from twins.neo_hooke import forms

MU, LAM = 0.4, 0.9
SAME = 1e-8
"""Two Newton iterations with the same quadrature points, each to a residual of 1e-11."""


def body(degree: int) -> bz.Body:
    """One end held, the other moved across."""
    mesh = bz.block(size=(2.0, 1.0, 1.0), cells=(2, 1, 1))
    E, nu = MU * (3 * LAM + 2 * MU) / (LAM + MU), LAM / 2 / (LAM + MU)
    moved = bz.Moved("right", translation=(0.2, 0, 0.9))
    return bz.Body(mesh, degree, bz.NeoHooke(E, nu), [bz.Fixed("left"), moved])


tangent, internal = forms(MU, LAM)


@pytest.mark.parametrize("degree", [1, 2])
def test_neo_hooke_is_that_of_scikit_fem(degree: int) -> None:
    told = body(degree)
    ours = bz.solve(told, solver="direct", rtol=1e-12, exactness=8)
    mesh = fem.MeshTet(told.mesh.points.T.copy(), told.mesh.tets.T.copy())
    kind = {1: fem.ElementTetP1, 2: fem.ElementTetP2}[degree]()
    bary, weights = bernstein.simplex(8, 3)
    basis = fem.Basis(mesh, fem.ElementVector(kind), quadrature=(bary[:, 1:].T, weights / 6))
    x = np.zeros(basis.N)
    at = basis.doflocs
    held = np.flatnonzero((at[0] < 1e-9) | (at[0] > 2 - 1e-9))
    right = at[0] > 2 - 1e-9
    steps = 2
    free = np.setdiff1d(np.arange(basis.N), held)
    component = np.zeros(basis.N, dtype=int)
    for axis in range(3):
        component[basis.get_dofs(elements=True).all(f"u^{axis + 1}")] = axis
    shift = np.array([0.2, 0, 0.9])[component]
    for step in range(1, steps + 1):
        jump = np.where(right, step / steps * shift, 0.0)
        for _ in range(8):
            u = basis.interpolate(x)
            K, f = tangent.assemble(basis, u=u), internal.assemble(basis, u=u)
            dx = np.zeros(basis.N)
            dx[held] = (jump - x)[held]
            dx[free] = spsolve(K[free][:, free].tocsc(), -(f + K @ dx)[free])
            x = x + dx
    theirs = basis.interpolator(x)(np.array([[1.1], [0.4], [0.6]]))
    here = ours.displacement.at(np.array([[1.1, 0.4, 0.6]]))[0]
    assert np.abs(here - np.asarray(theirs).ravel()).max() < SAME
