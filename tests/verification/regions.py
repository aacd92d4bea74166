# SPDX-License-Identifier: BSD-3-Clause
"""Regions of different stiffness in contact: layers, bars side by side, two metals, two shells."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

import bezsoma as bz
from bezsoma.arrays import Floats
from bezsoma.mesh import block, shell
from cases.exact import across
from verification.problem import ANALYTICAL, EXACT, Family, Value

FAMILY = Family("regions", "Regions of different stiffness that hold together.")
PLANES = [
    bz.Fixed("left", components="x"),
    bz.Fixed("front", components="y"),
    bz.Fixed("bottom", components="z"),
]
SLIPPERY = [bz.Fixed("left", "right", components="x"), bz.Fixed("front", "back", components="y")]


def layered(axis: int, cut: float = 0.5) -> bz.TetMesh:
    """A unit cube, its regions parted across an axis."""
    mesh = block(cells=(2, 2, 2))
    upper = mesh.points[mesh.tets].mean(axis=1)[:, axis] > cut
    return bz.TetMesh(mesh.points, mesh.tets, upper.astype(int), ("low", "high"), mesh.surfaces)


def laws(contrast: float, low: float = 0.3, high: float = 0.3) -> dict[str, bz.LinearElastic]:
    """Of both regions."""
    return {"low": bz.LinearElastic(1.0, low), "high": bz.LinearElastic(contrast, high)}


def confined(law: bz.LinearElastic) -> float:
    """Stiffness where the sides cannot give way."""
    return law.lam + 2 * law.mu


def series(contrast: float, high: float) -> Iterator[Value]:
    both, p = laws(contrast, 0.3, high), 0.01
    one = p / confined(both["low"]) / 2
    for degree in (1, 2, 3):
        body = bz.Body(
            layered(2),
            degree,
            both,
            [*SLIPPERY, bz.Fixed("bottom", components="z")],
            [bz.Pressure("top", value=p)],
        )
        found = bz.solve(body, solver="direct")
        at = found.displacement.at(np.array([[0.3, 0.4, 0.5], [0.3, 0.4, 1.0]]))[:, 2]
        yield Value("between the layers, mm", f"degree {degree}, 48 tets", float(at[0]), -one, 1e-9)
        yield Value(
            "top, mm",
            f"degree {degree}, 48 tets",
            float(at[1]),
            -one - p / confined(both["high"]) / 2,
            1e-9,
        )


def parallel(contrast: float) -> Iterator[Value]:
    """Bars of the same nu side by side: one strain, stresses as E."""
    both, e = laws(contrast), 0.01
    drawn = bz.Moved("top", translation=(0, 0, e), components="z")
    for degree in (1, 2):
        found = bz.solve(bz.Body(layered(0), degree, both, [*PLANES, drawn]), solver="direct")
        where = f"degree {degree}, 48 tets"
        yield Value(
            "force, N", where, float(found.reactions["top"].force[2]), e * (1 + contrast) / 2, 1e-9
        )
        side = float(found.displacement.at(np.array([[1.0, 0.5, 0.5]]))[0, 0])
        yield Value("side, mm", where, side, -0.3 * e, 1e-8)


def sheared(contrast: float) -> Iterator[Value]:
    """Layers under a shear stress: each shears by itself."""
    both, t = laws(contrast), 0.01
    held = [bz.Fixed("bottom"), bz.Fixed("left", "right", "front", "back", "top", components="yz")]
    low, high = both["low"].mu, both["high"].mu
    loads = [bz.Traction("top", value=(t, 0, 0))]
    for degree in (1, 2):
        side = [
            bz.Prescribed("left", "right", value=lambda x: profile(x, t, low, high), components="x")
        ]
        found = bz.solve(bz.Body(layered(2), degree, both, [*held, *side], loads), solver="direct")
        at = float(found.displacement.at(np.array([[0.5, 0.5, 1.0]]))[0, 0])
        yield Value("top, mm", f"degree {degree}, 48 tets", at, t / 2 * (1 / low + 1 / high), 1e-9)


def profile(x: Floats, t: float, low: float, high: float) -> Floats:
    """The exact displacement of the layers under shear."""
    z = x[:, 2]
    u = np.zeros_like(x)
    u[:, 0] = t * np.minimum(z, 0.5) / low + t * np.maximum(z - 0.5, 0) / high
    return u


LENGTH, BEND = 6.0, 0.001
"""Of the beam of two layers, mm and 1/mm."""


def neutral(contrast: float) -> float:
    """The height of its neutral axis, mm."""
    return (0.125 + 0.375 * contrast) / (0.5 + 0.5 * contrast)


def layered_beam(contrast: float, degree: int) -> bz.Body:
    """A beam of two layers of the same nu, bent by a moment."""
    axis, c = neutral(contrast), BEND
    mesh = block((LENGTH, 1.0, 1.0), (4, 1, 2), origin=(0, -0.5, 0))
    upper = mesh.points[mesh.tets].mean(axis=1)[:, 2] > 0.5
    mesh = bz.TetMesh(mesh.points, mesh.tets, upper.astype(int), ("low", "high"), mesh.surfaces)

    def pull(x: Floats) -> Floats:
        E = np.where(x[:, 2] < 0.5, 1.0, contrast)
        return np.stack([-c * E * (x[:, 2] - axis), 0 * E, 0 * E], axis=1)

    corners = {"a": (0.0, -0.5, 0.0), "b": (0.0, 0.5, 0.0), "c": (0.0, -0.5, 1.0)}
    for name, point in corners.items():
        mesh = mesh.with_vertices(name, [point])
    u = bz.Polynomial.parse(
        [
            f"-{c}*x*(z-{axis})",
            f"0.3*{c}*y*(z-{axis})",
            f"{c}*x**2/2 - 0.15*{c}*(y**2 - (z-{axis})**2)",
        ]
    )
    held = [
        bz.Prescribed(p, value=u, components=k)
        for p, k in {"a": "xyz", "b": "xz", "c": "x"}.items()
    ]
    ends = [
        bz.Traction("right", value=pull, exactness=8),
        bz.Traction("left", value=lambda x: -pull(x), exactness=8),
    ]
    return bz.Body(mesh, degree, laws(contrast), held, ends)


def two_metals(contrast: float) -> Iterator[Value]:
    """Plane sections, one neutral axis."""
    axis = neutral(contrast)
    parts = [(1.0, 0.0, 0.5), (contrast, 0.5, 1.0)]
    EI = sum(E * ((top - axis) ** 3 - (bottom - axis) ** 3) / 3 for E, bottom, top in parts)
    for degree in (2, 3):
        found = bz.solve(layered_beam(contrast, degree), solver="direct")
        end = float(found.displacement.at(np.array([[LENGTH, 0.0, axis]]))[0, 2])
        where = f"degree {degree}, {len(found.body.mesh.tets)} tets"
        yield Value("end, mm", where, end, BEND * LENGTH**2 / 2, 1e-8)
        yield Value("twice the energy, N mm", where, 2 * found.energy, EI * BEND**2 * LENGTH, 1e-8)


MIDDLE = 2**0.5
"""Radius between both shells, where the mesh has a layer of its own."""


def two_shells(contrast: float) -> Iterator[Value]:
    """Radii 1, 2^(1/2) and 2: the pressure between follows from equal displacements."""
    mesh = shell(inner=1, outer=2, cells=4, layers=4)
    outer = np.linalg.norm(mesh.points, axis=1)[mesh.tets].min(axis=1) > MIDDLE - 1e-9
    mesh = bz.TetMesh(mesh.points, mesh.tets, outer.astype(int), ("low", "high"), mesh.surfaces)
    both = laws(contrast)
    p, q = 0.01, between(both["low"], both["high"], 0.01)

    def stress(x: Floats) -> Floats:
        inside = (np.linalg.norm(x, axis=1) < MIDDLE)[:, None, None]
        s_in, s_out = sphere_stress(x, 1.0, MIDDLE, p, q), sphere_stress(x, MIDDLE, 2.0, q, 0.0)
        return np.where(inside, s_in, s_out)

    held = [bz.Fixed(f"{axis}0", components=axis) for axis in "xyz"]
    wanted = {
        1.0: sphere_u(both["low"], 1.0, 1.0, MIDDLE, p, q),
        2.0: sphere_u(both["high"], 2.0, MIDDLE, 2.0, q, 0.0),
    }
    for degree in (2, 3):
        fine = 2 * degree + 6
        loads = [
            bz.Traction(name, value=across(mesh, name, stress), exactness=fine)
            for name in ("inner", "outer")
        ]
        found = bz.solve(bz.Body(mesh, degree, both, held, loads)).displacement
        where = f"degree {degree}, {len(mesh.tets)} tets"
        for r, u_r in wanted.items():
            u = float(found.at(np.array([[r, 0.0, 0.0]]), outside="nearest")[0, 0])
            yield Value(f"u_r({r:g}), mm", where, u, u_r, 0.12)


def sphere_constants(a: float, b: float, p: float, q: float) -> tuple[float, float]:
    """A and B of s_rr = A - 2 B / r^3 with pressure p inside and q outside."""
    B = (p - q) * a**3 * b**3 / (2 * (b**3 - a**3))
    return (p * a**3 - q * b**3) / (b**3 - a**3), B


def sphere_u(law: bz.LinearElastic, r: float, a: float, b: float, p: float, q: float) -> float:
    """u_r = A r / (3 kappa) + B / (2 G r^2)."""
    A, B = sphere_constants(a, b, p, q)
    kappa = law.E / (3 * (1 - 2 * law.nu))
    return A * r / (3 * kappa) + B / (2 * law.mu * r**2)


def sphere_stress(x: Floats, a: float, b: float, p: float, q: float) -> Floats:
    """(p, 3, 3)."""
    A, B = sphere_constants(a, b, p, q)
    r = np.linalg.norm(x, axis=1)[:, None, None]
    along = np.einsum("pi,pj->pij", x, x) / r**2
    s: Floats = (A + B / r**3) * np.eye(3) - 3 * B / r**3 * along
    return s


def between(low: bz.LinearElastic, high: bz.LinearElastic, p: float) -> float:
    """The pressure between both shells: where their displacements are the same."""
    zero, one = (
        sphere_u(low, MIDDLE, 1.0, MIDDLE, p, q) - sphere_u(high, MIDDLE, MIDDLE, 2.0, q, 0.0)
        for q in (0.0, 1.0)
    )
    return zero / (zero - one)


def heavy(contrast: float) -> Iterator[Value]:
    """Two layers under their weight between slippery walls: a parabola in each."""
    both, g = laws(contrast), 0.001
    low, high = (confined(law) for law in both.values())
    top = -g * (0.375 / low + 0.125 / high)
    held = [*SLIPPERY, bz.Fixed("bottom", components="z")]
    for degree in (2, 3):
        body = bz.Body(layered(2), degree, both, held, [bz.BodyForce((0, 0, -g))])
        found = bz.solve(body, solver="direct")
        at = float(found.displacement.at(np.array([[0.3, 0.3, 1.0]]))[0, 2])
        yield Value("top, mm", f"degree {degree}, 48 tets", at, top, 1e-9)


CONTRASTS = (2.0, 10.0, 100.0, 1e4)
for contrast in CONTRASTS:
    FAMILY.add(
        f"Two layers pressed, 1 : {contrast:g}",
        ANALYTICAL,
        "Hooke's law, layer by layer",
        "sum of p h / (lam + 2 mu)",
        EXACT,
        series,
        contrast,
        0.3,
    )
    FAMILY.add(
        f"Two bars side by side, 1 : {contrast:g}",
        ANALYTICAL,
        "Hooke's law",
        "F = e (E_1 A_1 + E_2 A_2)",
        EXACT,
        parallel,
        contrast,
    )
    FAMILY.add(
        f"Two layers in shear, 1 : {contrast:g}",
        ANALYTICAL,
        "Hooke's law, layer by layer",
        "sum of t h / G",
        EXACT,
        sheared,
        contrast,
    )
FAMILY.add(
    "Two layers pressed, nu 0.3 and 0.45",
    ANALYTICAL,
    "Hooke's law, layer by layer",
    "sum of p h / (lam + 2 mu)",
    EXACT,
    series,
    5.0,
    0.45,
)
for contrast in (3.0, 20.0):
    FAMILY.add(
        f"Beam of two layers, 1 : {contrast:g}",
        ANALYTICAL,
        "plane sections; exact for one nu",
        "M = c sum E_i I_i about the common axis",
        EXACT,
        two_metals,
        contrast,
    )
    FAMILY.add(
        f"Two layers under their weight, 1 : {contrast:g}",
        ANALYTICAL,
        "by integration",
        "u = -g (3/8 / M_1 + 1/8 / M_2)",
        EXACT,
        heavy,
        contrast,
    )
for contrast in (0.1, 10.0):
    FAMILY.add(
        f"Two shells, 1 : {contrast:g}",
        ANALYTICAL,
        "Lame's sphere, twice, with one displacement between",
        "u_r = A r / (3 kappa) + B / (2 G r^2)",
        "the surface between is faceted, which is another body; measured",
        two_shells,
        contrast,
    )
