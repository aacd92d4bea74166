# SPDX-License-Identifier: BSD-3-Clause
"""Eigenvalues: of mass matrices in closed form, of rigid motions, of waves in a box."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from math import comb, factorial

import numpy as np
from scipy.linalg import eigh

import bezsoma as bz
from bezsoma import bernstein
from bezsoma.equations.assembled import assembled
from bezsoma.mesh import ControlNet, TetMesh, block
from verification.bodies import HOOKE
from verification.problem import ANALYTICAL, Family, Value

FAMILY = Family("spectral", "Eigenvalues of matrices and of bodies.")


def of_mass(dim: int) -> Iterator[Value]:
    """lambda_i = d! n!^2 / ((n - i)! (n + i + d)!), C(i + d - 1, d - 1) times."""
    for n in (1, 2, 4):
        found = np.sort(np.linalg.eigvalsh(bernstein.mass(n, n, dim)))[::-1]
        wanted = [
            factorial(dim) * factorial(n) ** 2 / (factorial(n - i) * factorial(n + i + dim))
            for i in range(n + 1)
            for _ in range(comb(i + dim - 1, dim - 1))
        ]
        off = float(np.abs(found / np.array(wanted) - 1).max())
        yield Value("worst eigenvalue", f"degree {n}, {dim} D", off, 0.0, 1e-10)


def rigid(degree: int) -> Iterator[Value]:
    """Six motions without energy, no seventh: one tet, and a block."""
    one = TetMesh(np.eye(4, 3), [[0, 1, 2, 3]])
    for mesh in (one, block()):
        net = ControlNet(mesh, degree)
        K = stiffness(net, HOOKE)
        values = np.sort(np.linalg.eigvalsh(K))
        zero = int((values < 1e-10 * values[-1]).sum())
        yield Value(
            "motions without energy",
            f"degree {degree}, {len(mesh.tets)} tets",
            float(zero),
            6.0,
            0.0,
        )


def stiffness(net: ControlNet, law: bz.LinearElastic) -> np.ndarray:
    """Dense."""
    tets = len(net.mesh.tets)
    K = assembled(net, np.full(tets, law.lam), np.full(tets, law.mu)).scipy().toarray()
    return np.asarray(K)


def mass(net: ControlNet) -> np.ndarray:
    """Of density 1, dense."""
    M = np.zeros((net.count, net.count))
    local = bernstein.mass(net.degree, net.degree, 3)
    for controls, volume in zip(net.of_tet, net.mesh.volumes, strict=True):
        M[np.ix_(controls, controls)] += volume * local
    return np.asarray(np.kron(M, np.eye(3)))


def box(nu: float) -> Iterator[Value]:
    """A cube between smooth walls: omega^2 = pi^2 |k|^2 mu (twice each) or (lam + 2 mu)."""
    law = bz.LinearElastic(1.0, nu)
    wanted = sorted(
        np.pi**2 * (k @ k) * speed
        for k in map(np.array, product(range(4), repeat=3))
        for speed in modes(k, law)
    )[:8]
    for degree, cells, within in ((2, 3, 0.08), (3, 2, 0.02), (4, 1, 0.08)):
        net = ControlNet(block(cells=cells), degree)
        K, M = stiffness(net, law), mass(net)
        free = np.ones((net.count, 3), bool)
        for axis, walls in enumerate((("left", "right"), ("front", "back"), ("bottom", "top"))):
            for wall in walls:
                free[net.of_place(wall), axis] = False
        on = np.flatnonzero(free.ravel())
        found = eigh(
            K[np.ix_(on, on)], M[np.ix_(on, on)], eigvals_only=True, subset_by_index=(0, 7)
        )
        off = found / np.array(wanted) - 1
        where = f"degree {degree}, {len(net.mesh.tets)} tets"
        yield Value("worst of eight, omega^2", where, float(np.abs(off).max()), 0.0, within)
        yield Value("lowest omega^2", where, float(found[0]), wanted[0], within)


def modes(k: np.ndarray, law: bz.LinearElastic) -> list[float]:
    """u_i = a_i sin(k_i x_i) cos cos: along k one wave of pressure, across it those of shear."""
    nonzero = int((k > 0).sum())
    if nonzero == 0:
        return []
    return [law.lam + 2 * law.mu] + [law.mu] * (nonzero - 1)


def conditioned() -> Iterator[Value]:
    """The condition of the mass matrix of one tet: C(2n + 3, n)."""
    for n in (1, 2, 3, 5):
        values = np.linalg.eigvalsh(bernstein.mass(n, n, 3))
        yield Value(
            "condition",
            f"degree {n}",
            float(values[-1] / values[0]),
            float(comb(2 * n + 3, n)),
            1e-8,
        )


KIRBY = "R. C. Kirby and K. T. Thinh, Numer. Math. 121 (2012), doi:10.1007/s00211-011-0431-y"
for dim in (1, 2, 3):
    FAMILY.add(
        f"Mass matrix in {dim} D",
        ANALYTICAL,
        KIRBY,
        "d! n!^2 / ((n - i)! (n + i + d)!)",
        "rounding times the condition",
        of_mass,
        dim,
    )
FAMILY.add(
    "Condition of the mass matrix",
    ANALYTICAL,
    KIRBY,
    "C(2n + 3, n)",
    "rounding times the condition",
    conditioned,
)
for degree in (1, 2, 3, 4):
    FAMILY.add(
        f"Motions without energy, degree {degree}",
        ANALYTICAL,
        "rigid motions",
        "6",
        "a count",
        rigid,
        degree,
    )
for nu in (0.0, 0.3, 0.45):
    FAMILY.add(
        f"A box that rings, nu = {nu}",
        ANALYTICAL,
        "plane waves between smooth walls; density 1",
        "omega^2 = pi^2 |k|^2 mu or pi^2 |k|^2 (lam + 2 mu)",
        "eigenvalues come from above as h^2k; measured",
        box,
        nu,
    )
