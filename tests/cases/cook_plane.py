# SPDX-License-Identifier: BSD-3-Clause
"""Cook's membrane as the plane problem that it is, by scikit-fem: where the reference comes from.

`PYTHONPATH=tests python -m cases.cook_plane` prints the values that the cases expect.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import skfem
from skfem.helpers import ddot, dot, eye, sym_grad, trace

from bezsoma.arrays import Floats


@dataclass(frozen=True)
class Plane:
    """What the membrane of 1 mm thickness does under 1 N: mm at the two points, N mm."""

    corner: float
    middle: float
    energy: float
    unknowns: int


def cook_in_plane_strain(lam: float, mu: float, layers: int) -> Plane:
    """Triangles of degree 4, `layers` times halved towards the corners; lam and mu in MPa."""
    mesh = graded(layers).with_boundaries(
        {"clamped": lambda x: x[0] < 1e-12, "loaded": lambda x: x[0] > 48 - 1e-9}
    )
    element = skfem.ElementVector(skfem.ElementTriP4())
    basis = skfem.Basis(mesh, element, intorder=6)
    side = skfem.FacetBasis(mesh, element, facets="loaded", intorder=8)

    @skfem.BilinearForm
    def work(u, v, _):  # type: ignore[no-untyped-def]
        strain = sym_grad(u)
        stress = lam * eye(trace(strain), 2) + 2 * mu * strain
        return ddot(stress, sym_grad(v))

    @skfem.LinearForm
    def load(v, _):  # type: ignore[no-untyped-def]
        return dot(np.array([0.0, 1 / 16])[:, None, None] * np.ones_like(v), v)

    K, f = work.assemble(basis), load.assemble(side)
    u = skfem.solve(*skfem.condense(K, f, D=basis.get_dofs("clamped")))
    corner, middle = (_vertical(basis, u, point) for point in ((48, 60), (48, 52)))
    return Plane(corner, middle, float(f @ u) / 2, len(u))


def graded(layers: int) -> skfem.MeshTri:
    """The membrane's triangles, a product mesh whose cells are halved towards all four sides."""
    quarter = np.concatenate([[0.0], 0.5 ** np.arange(layers - 1, -1, -1)]) / 2
    fine = np.concatenate([quarter, 1 - quarter[::-1]])
    line = np.unique(np.round(np.concatenate([fine, np.linspace(0.25, 0.75, 5)]), 14))
    mesh = skfem.MeshTri.init_tensor(line, line)
    u, v = mesh.p
    return skfem.MeshTri(np.vstack([48 * u, 44 * (u + v) - 28 * u * v]), mesh.t)


def _vertical(basis: skfem.Basis, u: Floats, point: tuple[float, float]) -> float:
    """The vertical displacement at a vertex of the mesh: the second unknown that lies there."""
    away = np.hypot(*(basis.doflocs - np.array(point)[:, None]))
    _, vertical = np.flatnonzero(away < 1e-9)
    return float(u[vertical])


if __name__ == "__main__":
    for name, lam, mu in (("1/3", 0.75, 0.375), ("0.4999", 0.4999 / 1.4999 / 0.0002, 0.5 / 1.4999)):
        for layers in (8, 12, 16):
            print(f"nu = {name}, {layers} layers:", cook_in_plane_strain(lam, mu, layers))
