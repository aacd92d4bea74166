# SPDX-License-Identifier: BSD-3-Clause
"""The inf-sup constant of a pair on a mesh, by dense eigenvalues."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
from scipy.linalg import eigh
from scipy.sparse import csc_array
from scipy.sparse.linalg import splu

from bezsoma.equations.assembled import assembled
from bezsoma.equations.mixed import coupling, pressure_mass
from bezsoma.mesh import ControlNet, TetMesh


def constants(mesh: TetMesh) -> Any:
    """What stands for a net of pressures that are constant on each tet."""
    tets = len(mesh.tets)
    return SimpleNamespace(mesh=mesh, degree=0, count=tets, of_tet=np.arange(tets)[:, None])


def inf_sup(mesh: TetMesh, degree: int, lower: int, place: str) -> float:
    """The least over q of the largest over v of int q div v / (|q| |eps(v)|), v = 0 on a place.

    Its square is the least eigenvalue of B K^-1 B^T against the mass matrix of the pressures, with
    K from int eps : eps (D. Malkus, Int. J. Eng. Sci. 19, 1981, doi:10.1016/0020-7225(81)90013-6).
    """
    net = ControlNet(mesh, degree)
    pressures = ControlNet(mesh, lower) if lower else constants(mesh)
    held = np.zeros((net.count, 3), bool)
    held[net.of_place(place)] = True
    free = np.flatnonzero(~held.ravel())
    tets = len(mesh.tets)
    K = csc_array(assembled(net, np.zeros(tets), np.full(tets, 0.5)).scipy().tocsr()[free][:, free])
    B = coupling(net, pressures)[:, free]
    schur = B @ splu(K).solve(B.T.toarray())
    mass = pressure_mass(pressures, np.ones(tets)).toarray()
    least = eigh(schur, mass, eigvals_only=True, subset_by_index=[0, 0])[0]
    return float(np.sqrt(max(least, 0.0)))
