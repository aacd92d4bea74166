# SPDX-License-Identifier: BSD-3-Clause
"""Bodies whose displacement and stress are known in closed form; lengths mm, moduli MPa.

The formulas are those of S. P. Timoshenko and J. N. Goodier, Theory of Elasticity, 3rd ed. 1970
(article numbers below). Displacement and stress are written down separately: that they belong
together is checked wherever one is prescribed on one part of a boundary and the other elsewhere.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from bezsoma import LinearElastic, TetMesh
from bezsoma.arrays import Floats
from bezsoma.mechanics.loads import Traction
from bezsoma.mesh.locator import Locator

Function = Callable[[Floats], Floats]


@dataclass(frozen=True)
class Exact:
    """Displacement (p, 3) and stress (p, 3, 3) at points (p, 3), of a material."""

    material: LinearElastic
    displacement: Function
    stress: Function

    def traction(self, mesh: TetMesh, *surfaces: str, exactness: int = 14) -> list[Traction]:
        """The stress times the normal of the very facet a point lies on, for each surface.

        So a body of flat facets carries what the exact solution carries across these facets, and
        its exact solution is the same: flat facets do not limit how fast answers converge.
        """
        return [
            Traction(name, value=across(mesh, name, self.stress), exactness=exactness)
            for name in surfaces
        ]


def across(mesh: TetMesh, surface: str, stress: Function) -> Function:
    """The traction (p, 3) of a stress on the flat facets of a surface."""
    normals = mesh.normals(mesh.facets_of(surface))
    locator = Locator(mesh)

    def value(points: Floats) -> Floats:
        facet = locator.nearest(points, surface).facet
        tractions: Floats = np.einsum("pij,pj->pi", stress(points), normals[facet])
        return tractions

    return value


@dataclass(frozen=True)
class ThickSphere:
    """Lame's sphere, radii 1 and 2, under pressure p from inside (art. 136)."""

    E: float = 1.0
    nu: float = 0.3
    p: float = 1.0
    a: float = 1.0
    b: float = 2.0

    @property
    def _scale(self) -> float:
        return self.p * self.a**3 / (self.b**3 - self.a**3)

    def radial(self, r: Floats) -> Floats:
        """u_r (p,) mm."""
        shear = (1 + self.nu) * self.b**3 / (2 * r**2)
        return self._scale / self.E * ((1 - 2 * self.nu) * r + shear)

    def stresses(self, r: Floats) -> tuple[Floats, Floats]:
        """The radial and the hoop stress (p,) MPa."""
        cube = (self.b / r) ** 3
        return self._scale * (1 - cube), self._scale * (1 + cube / 2)

    def displacement(self, x: Floats) -> Floats:
        """U_r along the radius."""
        r = np.linalg.norm(x, axis=1)
        u: Floats = x * (self.radial(r) / r)[:, None]
        return u

    def gradient(self, x: Floats) -> Floats:
        """The gradient (p, 3, 3): u_r / r across the radius, du_r/dr along it."""
        r = np.linalg.norm(x, axis=1)
        along = np.einsum("pi,pj->pij", x, x) / (r**2)[:, None, None]
        hoop = self.radial(r) / r
        slope = self._scale / self.E * ((1 - 2 * self.nu) - (1 + self.nu) * self.b**3 / r**3)
        H: Floats = hoop[:, None, None] * (np.eye(3) - along) + slope[:, None, None] * along
        return H

    def stress(self, x: Floats) -> Floats:
        """Radial and hoop stress turned to x, y, z."""
        r = np.linalg.norm(x, axis=1)
        along = np.einsum("pi,pj->pij", x, x) / (r**2)[:, None, None]
        radial, hoop = (each[:, None, None] for each in self.stresses(r))
        stress: Floats = hoop * (np.eye(3) - along) + radial * along
        return stress

    @property
    def exact(self) -> Exact:
        """The same as an `Exact`."""
        return Exact(LinearElastic(self.E, self.nu), self.displacement, self.stress)


def symmetric(entries: dict[str, Floats], count: int) -> Floats:
    """The tensors (p, 3, 3) with these entries, zero elsewhere."""
    stress = np.zeros((count, 3, 3))
    for name, value in entries.items():
        i, j = ("xyz".index(axis) for axis in name)
        stress[:, i, j] = stress[:, j, i] = value
    return stress


def elliptic_torsion(a: float, b: float, twist: float, material: LinearElastic) -> Exact:
    """A bar about z with half axes a and b along x and y, twisted by `twist` rad/mm (art. 105)."""
    G, square = material.mu, a**2 + b**2

    def displacement(points: Floats) -> Floats:
        x, y, z = points.T
        return twist * np.stack([-y * z, x * z, -(a**2 - b**2) / square * x * y], axis=1)

    def stress(points: Floats) -> Floats:
        x, y, _ = points.T
        factor = 2 * G * twist / square
        return symmetric({"xz": -factor * a**2 * y, "yz": factor * b**2 * x}, len(points))

    return Exact(material, displacement, stress)


def flexure(c: float, length: float, material: LinearElastic) -> Exact:
    """A round bar of radius 1 about z, bent by a force along x at its end (art. 122).

    c = P/(E I). In-plane and axial displacements follow from s_zz = -E c (L - z) x alone; the
    warping w(x, y), with Laplace w = -2 c x, makes the side of the round bar free of traction.
    """
    E, nu, G, L = material.E, material.nu, material.mu, length

    def displacement(points: Floats) -> Floats:
        x, y, z = points.T
        warping = (3 / 4 + nu / 2) * x - (x**3 + x * y**2) / 4
        u = nu * (L - z) * (x**2 - y**2) / 2 + L * z**2 / 2 - z**3 / 6
        return c * np.stack([u, nu * (L - z) * x * y, warping - (L * z - z**2 / 2) * x], axis=1)

    def stress(points: Floats) -> Floats:
        x, y, z = points.T
        entries = {
            "zz": -E * c * (L - z) * x,
            "xz": G * c / 4 * ((3 + 2 * nu) * (1 - x**2) - (1 - 2 * nu) * y**2),
            "yz": -G * c * (nu + 1 / 2) * x * y,
        }
        return symmetric(entries, len(points))

    return Exact(material, displacement, stress)


def bending(c: float, material: LinearElastic) -> Exact:
    """A bar along z of any section, bent to the radius 1/c in the x-z plane (art. 102)."""
    E, nu = material.E, material.nu

    def displacement(points: Floats) -> Floats:
        x, y, z = points.T
        return c * np.stack([-(z**2 + nu * (x**2 - y**2)) / 2, -nu * x * y, x * z], axis=1)

    def stress(points: Floats) -> Floats:
        return symmetric({"zz": E * c * points[:, 0]}, len(points))

    return Exact(material, displacement, stress)


def square_torsion_constant() -> float:
    """J / a**4 of a square of side a, 0.1406 (art. 109).

    J = (1 - 192 / pi**5 sum over odd n of tanh(n pi / 2) / n**5) a**4 / 3
    """
    n = np.arange(1, 200, 2)
    return float((1 - 192 / np.pi**5 * (np.tanh(n * np.pi / 2) / n**5).sum()) / 3)
