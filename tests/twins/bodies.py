# SPDX-License-Identifier: BSD-3-Clause
"""Bodies told twice, line by line: in BezSoma's words, and as plain functions of points.

A line of `Told` holds both. BezSoma is given names of places and formulas, scikit-fem what lies
on x = 0 and a NumPy function, so that a name, a sign of a normal or a formula that one of them
takes wrongly shows.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.spatial.transform import Rotation

import bezsoma as bz
from bezsoma.mesh import TetMesh, ball, block
from twins.scikit import Floats, Held, Point, Surface, Twin, Volume, Where

SIZE = (1.2, 1.0, 0.8)
MODULI = ((0.015, 0.45), (1.5, 0.3), (0.2, -0.3))
"""E [MPa] and nu of three regions: fat, something a hundred times as stiff, a foam."""
LOAD = 0.01
"""MPa and N/mm3: strains of some percent, a size like any other since all is linear."""


def plane(axis: int, value: float) -> Where:
    """Where one coordinate has a value."""
    return lambda x: np.isclose(x[:, axis], value, rtol=0, atol=1e-12)


LEFT, RIGHT, FRONT, BACK, BOTTOM, TOP = (
    plane(axis, value) for axis in range(3) for value in (0.0, SIZE[axis])
)
SEAM = plane(0, 0.4)


@dataclass(frozen=True, eq=False)
class Told:
    """A body in both languages: pairs of a BezSoma object and the same for scikit-fem."""

    mesh: TetMesh
    supports: tuple[tuple[bz.Fixed | bz.Moved | bz.Prescribed, tuple[Held, ...]], ...]
    loads: tuple[tuple[object, Surface | Volume | Point], ...] = ()
    joins: tuple[bz.Precedence, ...] = ()

    def twin(self, degree: int) -> Twin:
        """The answer of scikit-fem."""
        mesh = self.mesh
        held = [each for _, several in self.supports for each in several]
        loads = [load for _, load in self.loads]
        return Twin(mesh.points, mesh.tets, mesh.region, degree, self.moduli, held, loads)

    def solution(self, degree: int) -> bz.Solution:
        """The answer of BezSoma."""
        laws = {
            name: bz.LinearElastic(*pair)
            for name, pair in zip(self.mesh.regions, self.moduli, strict=True)
        }
        supports, loads = [ours for ours, _ in self.supports], [ours for ours, _ in self.loads]
        body = bz.Body(self.mesh, degree, laws, supports, loads, self.joins)
        return bz.solve(body, solver="direct", rtol=1e-12)

    @cached_property
    def moduli(self) -> tuple[tuple[float, float], ...]:
        """E and nu of the regions there are."""
        return MODULI[: len(self.mesh.regions)]


def zero(x: Floats) -> Floats:
    return np.zeros_like(x)


def slab(irregular: float) -> TetMesh:
    """A block of three regions, regular or not; a surface between two of them is named too."""
    plain = block(SIZE, cells=(3, 2, 2), irregular=irregular, seed=5)
    if irregular:  # the plane between the regions stays one
        lattice = block(SIZE, cells=(3, 2, 2)).points
        points = plain.points.copy()
        points[:, 0] = np.where(SEAM(lattice), 0.4, points[:, 0])
        plain = TetMesh(points, plain.tets, surfaces=plain.surfaces)
    middle = plain.points[plain.tets].mean(axis=1)
    region = np.where(middle[:, 0] < 0.4, 0, np.where(middle[:, 1] < 0.5, 1, 2))
    seam = plain.all_faces[SEAM(plain.points)[plain.all_faces].all(axis=1)]
    tip, rim = [1.2, 1.0, 0.8], [[0, 0, 0], [0, 0.5, 0], [0, 1.0, 0]]
    named = TetMesh(plain.points, plain.tets, region, ("fat", "gland", "foam"), plain.surfaces)
    if irregular:
        rim[1] = plain.points[np.flatnonzero(LEFT(plain.points) & BOTTOM(plain.points))[1]].tolist()
    named = named.with_surface("seam", seam).with_edges("rim", rim)
    return named.with_vertices("tip", [tip]).with_vertices("heel", [[1.2, 0, 0]])


def jaw(irregular: float) -> Told:
    """One side held, the other moved as a bone is; every kind of load, all of them polynomials."""
    turn = Rotation.from_rotvec(0.3 * np.array([1, 2, 2]) / 3)
    about, step = np.array([1.2, 0.5, 0.4]), np.array([0.05, -0.1, 0.02])
    moved = bz.Moved("right", translation=step, axis=(1, 2, 2), angle=0.3, about=about)
    t = bz.Polynomial.parse(["0.01*(x*y - z)", "0.02*z**2", "0.01*(1 - x**3)"])
    p = bz.Polynomial.parse("0.01*(1 + y - x*z)")
    f = bz.Polynomial.parse(["0.01*y*z", "-0.02", "0.03*x**2"])
    return Told(
        slab(irregular),
        (
            (bz.Fixed("left"), (Held("left", LEFT, zero),)),
            (moved, (Held("right", RIGHT, lambda x: turn.apply(x - about) + about + step - x),)),
        ),
        (
            (bz.Traction("top", value=t), Surface(TOP, traction)),
            (bz.Pressure("front", value=p), Surface(FRONT, pressure)),
            (bz.Pressure("bottom", value=LOAD), Surface(BOTTOM, lambda x, n: -LOAD * n)),
            (
                bz.Traction("seam", value=(0, LOAD, 0)),
                Surface(SEAM, lambda x, n: np.tile([0, LOAD, 0], (len(x), 1)), boundary=False),
            ),
            (bz.BodyForce(f, regions=["gland"]), Volume(weight, region=1)),
            (
                bz.BodyForce((0, 0, -LOAD)),
                Volume(lambda x, n: np.tile([0, 0, -LOAD], (len(x), 1))),
            ),
            (
                bz.PointForce((0.4, 0.0, 0.8), (0, 0.01, 0.003)),
                Point((0.4, 0.0, 0.8), (0, 0.01, 0.003)),
            ),
        ),
    )


def traction(x: Floats, n: Floats) -> Floats:
    x, y, z = x.T
    return 0.01 * np.stack([x * y - z, 2 * z**2, 1 - x**3], axis=1)


def pressure(x: Floats, n: Floats) -> Floats:
    x, y, z = x.T
    return -0.01 * (1 + y - x * z)[:, None] * n


def weight(x: Floats, n: Floats) -> Floats:
    x, y, z = x.T
    return np.stack([0.01 * y * z, -0.02 + 0 * x, 0.03 * x**2], axis=1)


def planes(irregular: float) -> Told:
    """Three planes held in one component each, a fourth drawn: components share their edges."""
    drawn = bz.Polynomial.parse(["0.1 + 0.2*y - 0.1*z", 0, 0])
    return Told(
        slab(irregular),
        (
            (bz.Fixed("left", components="x"), (Held("left", LEFT, zero, "x"),)),
            (bz.Fixed("front", components="y"), (Held("front", FRONT, zero, "y"),)),
            (bz.Fixed("bottom", components="z"), (Held("bottom", BOTTOM, zero, "z"),)),
            (
                bz.Prescribed("right", value=drawn, components="x"),
                (
                    Held(
                        "right",
                        RIGHT,
                        lambda x: (0.1 + 0.2 * x[:, 1:2] - 0.1 * x[:, 2:]) * [1, 0, 0],
                        "x",
                    ),
                ),
            ),
        ),
        ((bz.Traction("back", "top", value=(0, LOAD, LOAD)), Surface(either, upward)),),
    )


def either(x: Floats) -> np.ndarray:
    """Back and top: no facet has corners on both without lying in one of them."""
    return BACK(x) | TOP(x)


def upward(x: Floats, n: Floats) -> Floats:
    return np.tile([0, LOAD, LOAD], (len(x), 1))


def bent(irregular: float) -> Told:
    """An affine and a quadratic displacement prescribed, and a load given as a function."""
    affine = bz.Polynomial.affine([[0.1, 0.2, 0], [0, -0.1, 0.1], [0.05, 0, 0]], (0, 0.1, 0))
    quadratic = bz.Polynomial.parse(["0.1*y**2", "0.2*y*z - 0.1*z^2", "0.1*(y - z)"])
    return Told(
        slab(irregular),
        (
            (
                bz.Prescribed("left", value=affine),
                (Held("left", LEFT, lambda x: x @ sheared + [0, 0.1, 0]),),
            ),
            (bz.Prescribed("right", value=quadratic), (Held("right", RIGHT, parabola),)),
        ),
        (
            (
                bz.BodyForce(lambda x: weight(x, x), exactness=6),
                Volume(weight),
            ),
            (bz.Pressure("top", value=lambda x: x[:, 0] * x[:, 1]), Surface(TOP, saddle)),
        ),
    )


sheared = np.array([[0.1, 0.2, 0], [0, -0.1, 0.1], [0.05, 0, 0]]).T


def parabola(x: Floats) -> Floats:
    _, y, z = x.T
    return np.stack([0.1 * y**2, 0.2 * y * z - 0.1 * z**2, 0.1 * (y - z)], axis=1)


def saddle(x: Floats, n: Floats) -> Floats:
    return -(x[:, 0] * x[:, 1])[:, None] * n


def hung(irregular: float) -> Told:
    """Held along a mesh edge and at two vertices only, one of them in two components."""
    rim = Held("rim", lambda x: LEFT(x) & BOTTOM(x), zero, facets=False)
    tip = Held("tip", at(SIZE), lambda x: np.tile([0, 0.02, 0.01], (len(x), 1)), "yz", facets=False)
    heel = Held("heel", at((1.2, 0, 0)), zero, "z", facets=False)
    return Told(
        slab(irregular),
        (
            (bz.Fixed("rim"), (rim,)),
            (bz.Moved("tip", translation=(9, 0.02, 0.01), components="yz"), (tip,)),
            (bz.Fixed("heel", components="z"), (heel,)),
        ),
        ((bz.Traction("back", value=(LOAD, 0, LOAD)), Surface(BACK, slanted)),),
    )


def at(point: tuple[float, float, float]) -> Where:
    """Where points are this one."""
    return lambda x: np.isclose(x, point, rtol=0, atol=1e-12).all(axis=1)


def slanted(x: Floats, n: Floats) -> Floats:
    return np.tile([LOAD, 0, LOAD], (len(x), 1))


def torn(irregular: float) -> Told:
    """A held floor and a moved side that meet: the side has precedence on their line.

    Precedence is between controls: on the floor the displacement then falls as L^2, L = 1 on the
    line, to nothing one tet further. Values at midpoints say the same if they are a quarter.
    """
    mesh = slab(irregular)
    ends = mesh.points[mesh.all_edges]
    one_end = (RIGHT(mesh.points) & BOTTOM(mesh.points))[mesh.all_edges].sum(axis=1) == 1
    near = ends[one_end].mean(axis=1)

    def floor(x: Floats) -> Floats:
        is_near = (np.abs(x[:, None] - near).max(axis=2) < 1e-12).any(axis=1)
        return is_near[:, None] * np.array([0, 0.1 / 4, 0])

    moved = bz.Moved("right", translation=(0, 0.1, 0))
    side = Held("right", RIGHT, lambda x: np.tile([0, 0.1, 0], (len(x), 1)))
    return Told(
        mesh,
        ((moved, (side,)), (bz.Fixed("bottom"), (Held("bottom", BOTTOM, floor),))),
        ((bz.Traction("top", value=(0, 0, LOAD)), Surface(TOP, lambda x, n: LOAD * n)),),
        (bz.Precedence("right", over="bottom"),),
    )


def pressed_ball(irregular: float) -> Told:
    """A ball (its facets lean every way), its southern cap held, pressed by a polynomial."""
    mesh = ball(1.0, cells=2)
    if irregular:
        shake = np.random.default_rng(2).uniform(-0.1, 0.1, mesh.points.shape)
        mesh = TetMesh(mesh.points + irregular * shake, mesh.tets, surfaces=mesh.surfaces)
    mesh = mesh.with_surface("cap", lambda x: x[:, 2] < -0.6)
    mesh = mesh.with_surface("crown", lambda x: x[:, 2] > -0.2)
    p = bz.Polynomial.parse("0.01*(2 + x - y*z)")
    return Told(
        mesh,
        ((bz.Fixed("cap"), (Held("cap", lambda x: x[:, 2] < -0.6, zero),)),),
        ((bz.Pressure("crown", value=p), Surface(lambda x: x[:, 2] > -0.2, squeeze)),),
    )


def squeeze(x: Floats, n: Floats) -> Floats:
    return -0.01 * (2 + x[:, 0] - x[:, 1] * x[:, 2])[:, None] * n


BODIES = {told.__name__: told for told in (jaw, planes, bent, hung, torn, pressed_ball)}
