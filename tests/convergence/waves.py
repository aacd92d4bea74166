# SPDX-License-Identifier: BSD-3-Clause
"""A displacement that is no polynomial, its exact loads, and families of meshes to meet it on."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import permutations
from typing import Protocol

import numpy as np
import numpy.typing as npt

import bezsoma as bz
from bezsoma.mesh import TetMesh, block

Floats = npt.NDArray[np.float64]

SIZE = np.array([1.0, -0.7, 0.8])
WAVE = np.array([[2.0, 1.0, -1.5], [-1.0, 2.5, 1.0], [1.5, -1.0, 2.0]])
PHASE = np.array([0.3, -0.4, 0.9])


@dataclass(frozen=True)
class Waves:
    """u_i = a_i sin(k_i . x + p_i): three plane waves, none of them along an axis.

    H_ij = a_i k_ij cos(...), and minus the divergence of the stress (lam + mu) grad div u +
    mu Laplace u is f_j = (lam + mu) sum_i u_i k_ii k_ij + mu u_j |k_j|^2.
    """

    E: float
    nu: float

    @property
    def lam(self) -> float:
        """Lame's first parameter, MPa."""
        return self.E * self.nu / (1 + self.nu) / (1 - 2 * self.nu)

    @property
    def mu(self) -> float:
        """The shear modulus, MPa."""
        return self.E / 2 / (1 + self.nu)

    def displacement(self, x: Floats) -> Floats:
        """U (p, 3)."""
        return SIZE * np.sin(times(x, WAVE.T) + PHASE)

    def gradient(self, x: Floats) -> Floats:
        """H (p, 3, 3)."""
        return (SIZE * np.cos(times(x, WAVE.T) + PHASE))[:, :, None] * WAVE

    def stress(self, x: Floats) -> Floats:
        """The stress (p, 3, 3)."""
        H = self.gradient(x)
        trace = np.trace(H, axis1=1, axis2=2)[:, None, None]
        return self.lam * trace * np.eye(3) + self.mu * (H + np.swapaxes(H, 1, 2))

    def body_force(self, x: Floats) -> Floats:
        """- div stress (p, 3)."""
        s = self.displacement(x)
        volumetric = (self.lam + self.mu) * times(s * WAVE.diagonal(), WAVE)
        return volumetric + self.mu * s * (WAVE**2).sum(axis=1)


def times(x: Floats, A: Floats) -> Floats:
    """X @ A for points (p, 3) and a matrix (3, 3), without the threads of a BLAS.

    They stall on a machine that is busy with other tests, for products as thin as these.
    """
    return x[:, :1] * A[0] + x[:, 1:2] * A[1] + x[:, 2:] * A[2]


def with_planes(mesh: TetMesh, normals: Floats) -> TetMesh:
    """The mesh with a surface "plane 0", "plane 1", ... for every outward normal (k, 3)."""
    own = mesh.normals(mesh.boundary) @ normals.T > 1 - 1e-9
    for number, on in enumerate(own.T):
        mesh = mesh.with_surface(f"plane {number}", mesh.boundary[on])
    return mesh


def regular(cells: int) -> tuple[TetMesh, Floats]:
    """A unit cube of Kuhn tets, and the normals of its planes."""
    normals = np.concatenate([np.eye(3), -np.eye(3)])
    return with_planes(block(cells=cells), normals), normals


def irregular(level: int) -> tuple[TetMesh, Floats]:
    """Four irregular tets around an edge, each cut in eight `level` times; and its normals.

    The cut is that of J. Bey, Computing 55 (1995), doi:10.1007/BF02238487: however often it is
    done there are three shapes of tets for each first one, so constants do not drift with h.
    """
    rng = np.random.default_rng(1)
    around = [[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0]]
    points = np.array([[0, 0, -1], [0, 0, 1], *around]) / 2 + rng.uniform(-0.1, 0.1, (6, 3))
    tets = np.array([shortest(points, [0, 1, 2 + i, 2 + (i + 1) % 4]) for i in range(4)])
    coarse = TetMesh(points, tets)
    normals = coarse.normals(coarse.boundary)
    for _ in range(level):
        points, tets = cut_in_eight(points, tets)
    return with_planes(TetMesh(points, tets), normals), normals


def shortest(points: Floats, tet: list[int]) -> tuple[int, ...]:
    """The order of a tet's vertices that cuts its inner octahedron along the shortest diagonal."""

    def diagonal(order: tuple[int, ...]) -> float:
        a, b, c, d = points[list(order)]
        return float(np.linalg.norm(a + c - b - d))

    return min(permutations(tet), key=diagonal)


def cut_in_eight(points: Floats, tets: npt.NDArray[np.int64]) -> tuple[Floats, Floats]:
    """The points with the midpoints of all edges, and eight tets for each."""
    pairs = [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)]
    ends = np.sort(np.concatenate([tets[:, pair] for pair in pairs]), axis=1)
    edges, number = np.unique(ends, axis=0, return_inverse=True)
    ab, ac, ad, bc, bd, cd = number.reshape(6, -1) + len(points)
    a, b, c, d = tets.T
    corners = [(a, ab, ac, ad), (ab, b, bc, bd), (ac, bc, c, cd), (ad, bd, cd, d)]
    inner = [(ab, ac, ad, bd), (ab, ac, bc, bd), (ac, ad, bd, cd), (ac, bc, bd, cd)]
    children = np.concatenate([np.stack(child, axis=1) for child in corners + inner])
    return np.concatenate([points, points[edges].mean(axis=1)]), children


class Motion(Protocol):
    """A displacement and what a body needs to bear it."""

    def displacement(self, x: Floats) -> Floats:
        """U (p, 3) mm."""

    def stress(self, x: Floats) -> Floats:
        """What a traction on a plane is made from (p, 3, 3), MPa."""

    def body_force(self, x: Floats) -> Floats:
        """Minus the divergence of it (p, 3), N/mm3."""


def held_and_loaded(
    move: Motion, normals: Floats, fine: int
) -> tuple[list[bz.Prescribed], list[bz.Traction | bz.BodyForce]]:
    """Every other plane held, exact tractions on the others and the body force, by quadrature."""
    held = [f"plane {i}" for i in range(0, len(normals), 2)]
    tractions = [
        bz.Traction(f"plane {i}", value=lambda x, n=normals[i]: move.stress(x) @ n, exactness=fine)
        for i in range(1, len(normals), 2)
    ]
    force = bz.BodyForce(move.body_force, exactness=fine)
    return [bz.Prescribed(*held, value=move.displacement)], [*tractions, force]


def errors(mesh: TetMesh, normals: Floats, degree: int, waves: Waves) -> Floats:
    """The L2 and H1 errors of the answer: every other plane held, exact tractions elsewhere.

    Loads are functions and so integrated by quadrature, here of exactness 2 k + 4: its error is of
    higher order than what is measured, and so is that of the solver, stopped at 1e-11.
    """
    fine = 2 * degree + 4
    supports, loads = held_and_loaded(waves, normals, fine)
    law = bz.LinearElastic(waves.E, waves.nu)
    body = bz.Body(mesh, degree, law, supports, loads)
    u = bz.solve(body, solver="cg", rtol=1e-11).displacement
    return np.array([u.l2_error(waves.displacement, fine), u.h1_error(waves.gradient, fine)])
