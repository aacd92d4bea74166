# SPDX-License-Identifier: BSD-3-Clause
"""Spheres and cylinders: Lame's, under their weight, turning, and with a hole."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

import bezsoma as bz
from bezsoma.arrays import Floats
from bezsoma.mesh import ball, shell
from cases.exact import Exact, ThickSphere, across
from convergence.test_exact import MESHES
from verification.bodies import HOOKE, TG, coming_back, field, tube
from verification.problem import ANALYTICAL, EXACT, Family, Value

FAMILY = Family(
    "spheres", "Spheres and cylinders; flat facets carry the stress times their normals."
)
PLANES = [bz.Fixed(f"{axis}0", components=axis) for axis in "xyz"]


def thick(exact: ThickSphere, degree: int) -> bz.Solution:
    """An eighth of a thick sphere under pressure."""
    mesh = shell(inner=exact.a, outer=exact.b, cells=4, layers=2)
    loads = exact.exact.traction(mesh, "inner", "outer", exactness=2 * degree + 6)
    body = bz.Body(mesh, degree, exact.exact.material, PLANES, loads)
    return bz.solve(body, solver="direct")


def sphere(
    outer: float, nu: float, degrees: tuple[int, ...], within: dict[int, float]
) -> Iterator[Value]:
    exact = ThickSphere(E=1.0, nu=nu, p=1.0, a=1.0, b=outer)
    for degree in degrees:
        found = thick(exact, degree)
        where = f"degree {degree}, {len(found.body.mesh.tets)} tets"
        for r in (1.0, (1 + outer) / 2, outer):
            x = np.array([[0.0, 0.0, r]])
            u = float(found.displacement.at(x, outside="nearest")[0, 2])
            yield Value(
                f"u_r({r:g}), mm", where, u, float(exact.radial(np.array([r]))[0]), within[degree]
            )


@dataclass(frozen=True)
class Tube:
    """Lame's tube in plane strain, radii 1 and b, pressure p from inside (T&G art. 28)."""

    b: float
    nu: float = 0.3
    E: float = 1.0
    p: float = 1.0

    @property
    def constants(self) -> tuple[float, float, float]:
        """A, B of s_rr = A - B / r^2, and the shear modulus."""
        A = self.p / (self.b**2 - 1)
        return A, A * self.b**2, self.E / (2 + 2 * self.nu)

    def radial(self, r: Floats) -> Floats:
        """U_r (p,): ((1 - 2 nu) A r + B / r) / (2 G)."""
        A, B, G = self.constants
        return ((1 - 2 * self.nu) * A * r + B / r) / (2 * G)

    def displacement(self, x: Floats) -> Floats:
        """U (p, 3)."""
        r = np.hypot(x[:, 0], x[:, 1])
        u = (self.radial(r) / r)[:, None] * x
        u[:, 2] = 0.0
        return u

    def stress(self, x: Floats) -> Floats:
        """(p, 3, 3)."""
        A, B, _ = self.constants
        r2 = x[:, 0] ** 2 + x[:, 1] ** 2
        e = x[:, :2] / np.sqrt(r2)[:, None]
        s = np.zeros((len(x), 3, 3))
        along = np.einsum("pi,pj->pij", e, e)
        s[:, :2, :2] = (A + B / r2)[:, None, None] * np.eye(2) - (2 * B / r2)[:, None, None] * along
        s[:, 2, 2] = 2 * self.nu * A
        return s

    @property
    def exact(self) -> Exact:
        """The same as an `Exact`."""
        return Exact(bz.LinearElastic(self.E, self.nu), self.displacement, self.stress)


SLICE = [
    bz.Fixed("x0", components="x"),
    bz.Fixed("y0", components="y"),
    bz.Fixed("bottom", "top", components="z"),
]
"""A quarter of a tube in plane strain."""


def pressed_tube(exact: Tube, mixed: bool, degree: int) -> bz.Solution:
    """A quarter of a thick tube under pressure."""
    mesh = tube(1.0, exact.b, (2, 3, 1), 0.5)
    loads = [
        bz.Traction(name, value=across(mesh, name, exact.stress), exactness=2 * degree + 6)
        for name in ("inner", "outer")
    ]
    law = bz.LinearElastic(exact.E, exact.nu)
    return bz.solve(bz.Body(mesh, degree, law, SLICE, loads, incompressible=mixed), solver="direct")


def lame_tube(b: float, nu: float, mixed: bool) -> Iterator[Value]:
    exact = Tube(b, nu)
    for degree, within in ((2, 4e-2), (3, 4e-3), (4, 6e-4)):
        found = pressed_tube(exact, mixed, degree)
        where = f"degree {degree}, {len(found.body.mesh.tets)} tets"
        for r in (1.0, b):
            u = float(found.displacement.at(np.array([[r, 0.0, 0.25]]), outside="nearest")[0, 0])
            yield Value(f"u_r({r:g}), mm", where, u, float(exact.radial(np.array([r]))[0]), within)


def solid(
    u: tuple[str, str, str], mesh: str, degrees: tuple[int, ...], weight: float | None
) -> Iterator[Value]:
    yield from coming_back(field(u), HOOKE, MESHES[mesh](), degrees, weight)


def heavy_ball() -> Iterator[Value]:
    """The pull on a ball that grows with the radius: its surface, by formula (Love 1927, art. 98).

    u_r = - g r / (10 (lam + 2 mu)) ((5 lam + 6 mu)/(3 lam + 2 mu) - r^2), force g r per volume.
    """
    lam, mu, g = HOOKE.lam, HOOKE.mu, 0.01
    stiff = lam + 2 * mu
    ratio = (5 * lam + 6 * mu) / (3 * lam + 2 * mu)

    def u(x: Floats) -> Floats:
        r2 = (x**2).sum(axis=1)
        return -g / (10 * stiff) * (ratio - r2)[:, None] * x

    def stress(x: Floats) -> Floats:
        r2 = (x**2).sum(axis=1)[:, None, None]
        along = np.einsum("pi,pj->pij", x, x)
        H = -g / (10 * stiff) * ((ratio - r2) * np.eye(3) - 2 * along)
        return lam * np.trace(H, axis1=1, axis2=2)[:, None, None] * np.eye(3) + 2 * mu * H

    mesh = ball(1.0, cells=2, octant=True)
    force = bz.BodyForce(bz.Polynomial.parse([f"-{g}*{c}" for c in "xyz"]))
    loads = [force, bz.Traction("outer", value=across(mesh, "outer", stress), exactness=8)]
    for degree in (3, 4):
        found = bz.solve(bz.Body(mesh, degree, HOOKE, PLANES, loads), solver="direct")
        where = f"degree {degree}, {len(mesh.tets)} tets"
        end = float(found.displacement.at(np.array([[1.0, 0.0, 0.0]]))[0, 0])
        yield Value("u_r(1), mm", where, end, float(u(np.array([[1.0, 0, 0]]))[0, 0]), 1e-10)
        error = found.displacement.l2_error(u) / found.displacement.l2_norm()
        yield Value("error of u in L2", where, error, 0.0, 1e-10)


def around_a_hole(x: Floats) -> Floats:
    """Kirsch's stress (p, 3, 3) about a hole of radius 1 in a plate drawn along x by 1 MPa."""
    r2 = x[:, 0] ** 2 + x[:, 1] ** 2
    t = np.arctan2(x[:, 1], x[:, 0])
    a, c2, c4 = 1 / r2, np.cos(2 * t), np.cos(4 * t)
    s2, s4 = np.sin(2 * t), np.sin(4 * t)
    s = np.zeros((len(x), 3, 3))
    s[:, 0, 0] = 1 - a * (1.5 * c2 + c4) + 1.5 * a**2 * c4
    s[:, 1, 1] = -a * (0.5 * c2 - c4) - 1.5 * a**2 * c4
    s[:, 0, 1] = s[:, 1, 0] = -a * (0.5 * s2 + s4) + 1.5 * a**2 * s4
    s[:, 2, 2] = 0.3 * (s[:, 0, 0] + s[:, 1, 1])
    return s


def holed(degree: int) -> bz.Solution:
    """A quarter of the plate about its hole."""
    mesh = tube(1.0, 3.0, (4, 6, 1), 0.5)
    loads = [
        bz.Traction(name, value=across(mesh, name, around_a_hole), exactness=2 * degree + 8)
        for name in ("inner", "outer")
    ]
    body = bz.Body(mesh, degree, bz.LinearElastic(1.0, 0.3), SLICE, loads)
    return bz.solve(body, solver="direct")


def kirsch() -> Iterator[Value]:
    """The hoop stress is 3 at the top of the hole, -1 at its side."""
    for degree, within in ((3, 0.04), (4, 0.01)):
        found = holed(degree)
        mean = found.stress.averaged()
        where = f"degree {degree}, {len(found.body.mesh.tets)} tets"
        top = mean.at(np.array([[0.0, 1.0, 0.25]]), outside="nearest").reshape(3, 3)
        side = mean.at(np.array([[1.0, 0.0, 0.25]]), outside="nearest").reshape(3, 3)
        yield Value("s_xx at the top", where, float(top[0, 0]), 3.0, within)
        yield Value("s_yy at the side", where, float(side[1, 1]), -1.0, 2 * within)


RADIAL = "u_r = p a^3 / (E (b^3 - a^3)) ((1 - 2 nu) r + (1 + nu) b^3 / (2 r^2))"
CURVED = "1/r^2 is no polynomial; measured, and less with every degree"
for outer, nu in ((1.5, 0.3), (2.0, 0.3), (1.5, 0.0), (1.5, 0.45)):
    slack = {2: 3e-2, 3: 6e-3, 4: 2e-3}
    FAMILY.add(
        f"Thick sphere, b/a = {outer:g}, nu = {nu:g}", ANALYTICAL, f"{TG}, art. 136", RADIAL,
        CURVED, sphere, outer, nu, (2, 3, 4), slack,
    )  # fmt: skip
for b, nu, mixed in ((1.5, 0.3, False), (2.0, 0.3, False), (1.5, 0.5, True), (2.0, 0.5, True)):
    form = "with a pressure" if mixed else "displacement form"
    FAMILY.add(
        f"Thick tube, b/a = {b:g}, nu = {nu:g}, {form}", ANALYTICAL, f"{TG}, art. 28",
        "u_r = ((1 - 2 nu) A r + B / r) / (2 G), A = p / (b^2 - 1), B = A b^2", CURVED,
        lame_tube, b, nu, mixed,
    )  # fmt: skip
FAMILY.add(
    "Ball under its own pull", ANALYTICAL, "A. E. H. Love, Theory of Elasticity, art. 98",
    "u_r = -g r / (10 (lam + 2 mu)) ((5 lam + 6 mu)/(3 lam + 2 mu) - r^2)", EXACT, heavy_ball,
)  # fmt: skip
FAMILY.add(
    "Hole in a plate that is drawn out (Kirsch)", ANALYTICAL, f"{TG}, art. 35",
    "3 p at the top of the hole, -p at its side", "stress at a facet's corner; measured", kirsch,
)  # fmt: skip
SQUEEZED = ("-0.01*x", "-0.01*y", "-0.01*z")
TURNING = ("0.01*x*(1 - x**2 - y**2)", "0.01*y*(1 - x**2 - y**2)", "0")
FAMILY.add(
    "Ball squeezed from all sides",
    ANALYTICAL,
    "Hooke's law",
    "u = -p x / (3 kappa)",
    EXACT,
    solid,
    SQUEEZED,
    "ball",
    (1, 2, 3),
    0.0,
)
FAMILY.add(
    "Turning cylinder, its field",
    ANALYTICAL,
    f"{TG}, art. 32",
    "u_r = C r - D r^3",
    EXACT,
    solid,
    TURNING,
    "ball",
    (3, 4),
    None,
)
