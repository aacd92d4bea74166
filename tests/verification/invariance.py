# SPDX-License-Identifier: BSD-3-Clause
"""Laws that need no reference: frames, units, order, superposition, reciprocity, balance."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

import bezsoma as bz
from bezsoma.mesh import block
from laws.test_invariance import WAYS, answer, plain_answer
from tolerances import INVARIANCE
from verification.problem import LAW, Family, Value

FAMILY = Family("invariance", "What holds for every answer, whatever it is.")
MECHANICS = "linear elasticity"
E, NU = 0.5, 0.3


def written(way: str) -> Iterator[Value]:
    for degree in (1, 2):
        one, other = plain_answer("body", degree), answer("body", WAYS[way], degree)
        for each in ("displacement", "stress", "force"):
            a, b = getattr(one, each), getattr(other, each)
            if WAYS[way].hand < 0 and each == "force":
                b = np.asarray(b)
            off = float(np.abs(a - b).max() / np.abs(a).max())
            yield Value(
                f"{each}, largest difference", f"degree {degree}", off, 0.0, 10 * INVARIANCE
            )


def body(load: float, weight: float, moved: float, E: float = E) -> bz.Body:
    """A block with three things that act on it."""
    mesh = block(cells=2, irregular=0.2)
    held = [bz.Fixed("left"), bz.Moved("right", translation=(moved, 0, 0))]
    loads = [bz.Traction("top", value=(0, 0, load)), bz.BodyForce((0, weight, 0))]
    return bz.Body(mesh, 2, bz.LinearElastic(E, NU), held, loads)


def solved(*given: float) -> bz.Solution:
    return bz.solve(body(*given), solver="direct")


def superposed() -> Iterator[Value]:
    parts = [(0.01, 0, 0), (0, 0.02, 0), (0, 0, 0.03)]
    total = sum(solved(*part).displacement.controls for part in parts)
    whole = solved(0.01, 0.02, 0.03).displacement.controls
    off = float(np.abs(total - whole).max() / np.abs(whole).max())
    yield Value("largest difference", "degree 2, 48 tets", off, 0.0, 1e-10)


def proportional() -> Iterator[Value]:
    one, ten = solved(0.01, 0, 0), solved(0.1, 0, 0)
    yield Value(
        "energy of ten times the load", "degree 2, 48 tets", ten.energy, 100 * one.energy, 1e-10
    )
    stiff = solved(0.01, 0, 0, 10 * E)
    yield Value(
        "energy of ten times the stiffness",
        "degree 2, 48 tets",
        stiff.energy,
        one.energy / 10,
        1e-10,
    )


def reciprocal() -> Iterator[Value]:
    from bezsoma.equations.forces import forces

    one, other = solved(0.01, 0, 0), solved(0, 0.02, 0)
    f, g = (forces(each.body, each.net) for each in (one, other))
    a = float((f * other.displacement.controls).sum())
    b = float((g * one.displacement.controls).sum())
    yield Value("work of one load on the other's displacement", "degree 2, 48 tets", a, b, 1e-9)


def worked() -> Iterator[Value]:
    from bezsoma.equations.forces import forces

    for degree in (1, 2, 3):
        mesh = block(cells=2, irregular=0.2)
        load = [bz.Traction("top", value=bz.Polynomial.parse(["0.01*x", 0, "0.02*y"]))]
        found = bz.solve(
            bz.Body(mesh, degree, bz.LinearElastic(E, NU), [bz.Fixed("bottom")], load),
            solver="direct",
        )
        work = float((forces(found.body, found.net) * found.displacement.controls).sum())
        yield Value("work of the load, N mm", f"degree {degree}", work, 2 * found.energy, 1e-10)


def balanced() -> Iterator[Value]:
    found = solved(0.01, 0.02, 0.03)
    push = sum(r.force for r in found.reactions.values()) + np.array([0.0, 0.02, 0.01])
    yield Value("forces left over, N", "degree 2, 48 tets", float(np.abs(push).max()), 0.0, 1e-12)
    turn = sum(r.moment for r in found.reactions.values())
    turn = turn + np.cross([0.5, 0.5, 1.0], [0, 0, 0.01]) + np.cross([0.5, 0.5, 0.5], [0, 0.02, 0])
    yield Value(
        "moments left over, N mm", "degree 2, 48 tets", float(np.abs(turn).max()), 0.0, 1e-12
    )


def rigid(axis: int) -> Iterator[Value]:
    for degree in (1, 2, 4):
        spin = np.cross(np.eye(3), np.eye(3)[axis]) * 0.1
        held = [bz.Prescribed("left", value=bz.Polynomial.affine(spin, (0.1, 0.2, 0.3)))]
        found = bz.solve(
            bz.Body(block(cells=2, irregular=0.2), degree, bz.LinearElastic(E, NU), held),
            solver="direct",
        )
        low, high = found.stress.bounds()
        most = float(max(np.abs(low).max(), np.abs(high).max()))
        yield Value("largest stress, MPa", f"degree {degree}", most, 0.0, 1e-11)
        yield Value("energy, N mm", f"degree {degree}", found.energy, 0.0, 1e-15)


def solvers() -> Iterator[Value]:
    direct = solved(0.01, 0.02, 0.03)
    for name in ("cg", "multigrid"):
        found = bz.solve(body(0.01, 0.02, 0.03), solver=name, rtol=1e-12)
        off = np.abs(found.displacement.controls - direct.displacement.controls).max()
        size = np.abs(direct.displacement.controls).max()
        yield Value(
            f"{name}, largest difference", "degree 2, 48 tets", float(off / size), 0.0, 1e-9
        )


def threads() -> Iterator[Value]:
    one, two = (bz.solve(body(0.01, 0, 0), solver="multigrid", threads=n) for n in (1, 3))
    same = np.array_equal(one.displacement.controls, two.displacement.controls)
    yield Value("bits differ", "1 and 3 threads", float(not same), 0.0, 0.0)


def nested() -> Iterator[Value]:
    """A solution written in a higher degree is the same function, of the same energy."""
    found = solved(0.01, 0.02, 0.03)
    higher = found.displacement.elevated(5)
    away = np.abs(higher.at(POINTS) - found.displacement.at(POINTS)).max()
    yield Value("largest difference, mm", "degree 2 to 5", float(away), 0.0, 1e-13)
    yield Value("norm", "degree 2 to 5", higher.l2_norm(), found.displacement.l2_norm(), 1e-12)


POINTS = np.random.default_rng(3).uniform(0.05, 0.95, (20, 3))
for way in WAYS:
    FAMILY.add(
        f"Written down otherwise: {way}",
        LAW,
        "the answer belongs to the body",
        "the same",
        "rounding, which grows far from the origin",
        written,
        way,
    )
for name, source, answer_, function in (
    ("Superposition", MECHANICS, "the sum of the answers", superposed),
    ("Proportion", MECHANICS, "energy as load^2 / E", proportional),
    ("Reciprocity", "E. Betti (1872)", "f . v = g . u", reciprocal),
    ("Work and energy", "B. P. E. Clapeyron (1833)", "work = twice the energy", worked),
    ("Balance of forces and moments", "Newton", "0", balanced),
    ("Three ways to solve", MECHANICS, "the same", solvers),
    ("Any number of threads", "fixed order of sums", "the same bits", threads),
    ("Written in a higher degree", "degree elevation", "the same function", nested),
):
    FAMILY.add(name, LAW, source, answer_, "rounding", function)
for axis in range(3):
    FAMILY.add(
        f"Turn about {'xyz'[axis]} and shift", LAW, MECHANICS, "no stress", "rounding", rigid, axis
    )
