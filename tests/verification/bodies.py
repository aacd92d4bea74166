# SPDX-License-Identifier: BSD-3-Clause
"""Bodies that several families share: polynomial fields that have to come back, prisms, tubes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np

import bezsoma as bz
from bezsoma import bernstein
from bezsoma.arrays import Floats
from convergence.polynomials import PolynomialField
from convergence.test_exact import apart, body
from verification.problem import Value

HOOKE = bz.LinearElastic(E=0.5, nu=0.3)
TG = "S. P. Timoshenko and J. N. Goodier, Theory of Elasticity, 3rd ed. 1970"


def field(u: Sequence[str], law: bz.LinearElastic = HOOKE) -> PolynomialField:
    """A polynomial displacement (mm) from three formulas, with the stress of a law."""
    parts = bz.Polynomial.parse(list(u)).components
    terms = tuple({powers: float(c) for powers, c in part} for part in parts)
    lam = law.E * law.nu / ((1 + law.nu) * (1 - 2 * law.nu))
    return PolynomialField(terms, lam, law.E / (2 + 2 * law.nu))  # type: ignore[arg-type]


def coming_back(
    exact: PolynomialField,
    law: bz.LinearElastic,
    mesh: bz.TetMesh,
    degrees: Sequence[int],
    weight: float | None = None,
) -> Iterator[Value]:
    """Displacement, stress and energy of the field: every fourth facet held, loads elsewhere.

    `weight` is the force on the volume [N/mm3] that the field needs, where a source says so.
    """
    if weight is not None:
        needed = max((abs(c) for part in exact.body_force for c in part.values()), default=0.0)
        yield Value("force on the volume, N/mm3", "by differentiation", needed, weight, 1e-12)
    for degree in degrees:
        found = bz.solve(body(mesh, exact, degree, law), solver="direct")
        bary, weights = bernstein.simplex(2 * degree, 3)
        points = (bary @ mesh.points[mesh.tets]).reshape(-1, 3)
        where = f"degree {degree}, {len(mesh.tets)} tets"
        u = apart(found.displacement.tabulated(bary), exact.at(points))
        s = apart(found.stress.tabulated(bary), exact.stress_at(points))
        density = np.einsum("pkl,pkl->p", exact.stress_at(points), exact.gradient_at(points)) / 2
        energy = float((mesh.volumes[:, None] * weights).ravel() @ density)
        yield Value("largest error of u", where, u, 0.0, 1e-10)
        yield Value("largest error of the stress", where, s, 0.0, 1e-9)
        yield Value("energy, N mm", where, found.energy, energy, 1e-10)


def mapped(mesh: bz.TetMesh, to: Callable[[Floats], Floats]) -> bz.TetMesh:
    """The mesh with its points moved by a function; places stay."""
    return bz.TetMesh(to(mesh.points), mesh.tets, mesh.region, mesh.regions, mesh.surfaces)


def tube(inner: float, outer: float, cells: tuple[int, int, int], height: float) -> bz.TetMesh:
    """A quarter of a tube: inner, outer, x0 and y0 (planes of symmetry), bottom, top."""
    flat = bz.block((1.0, 1.0, height), cells)

    def bent(p: Floats) -> Floats:
        r, angle = inner + (outer - inner) * p[:, 0], np.pi / 2 * p[:, 1]
        return np.stack([r * np.cos(angle), r * np.sin(angle), p[:, 2]], axis=1)

    names = {"left": "inner", "right": "outer", "front": "y0", "back": "x0"}
    round_ = mapped(flat, bent)
    surfaces = {names.get(name, name): facets for name, facets in round_.surfaces.items()}
    return bz.TetMesh(round_.points, round_.tets, surfaces=surfaces)


def prism(cells: int, layers: int, height: float, to: Callable[[Floats], Floats]) -> bz.TetMesh:
    """Half of a block of Kuhn tets, x >= y: a triangular prism, moved by a function."""
    whole = bz.block((1.0, 1.0, height), (cells, cells, layers))
    centre = whole.points[whole.tets].mean(axis=1)
    half = bz.TetMesh(whole.points, whole.tets[centre[:, 0] > centre[:, 1]])
    half = half.with_surface("bottom", lambda x: x[:, 2] == 0)
    half = half.with_surface("top", lambda x: x[:, 2] == height)
    return mapped(half, to)
