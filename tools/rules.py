# SPDX-License-Identifier: BSD-3-Clause
"""Finds the symmetric quadrature rules of `src/bezsoma/bernstein/rules.txt`, and polishes them.

    ./dev python tools/rules.py search 3 8 40 50     a tet, exactness 8, with 40 to 50 points
    ./dev python tools/rules.py polish               the table again from its own digits

The search tries the ways to have so many points as orbits, fewest first, each from many random
starts (seeded by what is searched), by the method of Levenberg and Marquardt on the moment
equations (`moments.py`).  What it finds is polished to 40 digits by Newton's method in decimal
arithmetic.  A search that rounds differently may find another rule of a family, and replaces one
only by one of fewer points; polishing the table gives the same bytes anywhere.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from decimal import Decimal, localcontext
from fractions import Fraction
from itertools import groupby, product
from math import factorial, prod
from pathlib import Path

import numpy as np
from moments import Equations, Kind, exponents, kinds, size
from scipy.linalg import qr

from bezsoma.arrays import Floats, Ints, Numbers

TABLE = Path(__file__).parents[1] / "src/bezsoma/bernstein/rules.txt"
HEAD = """\
# SPDX-License-Identifier: BSD-3-Clause
# Fully symmetric quadrature rules on triangles and tets, made by tools/rules.py.
# A line is an orbit: dimension, exactness, barycentric coordinates of one point, weight of each.
"""
Key = tuple[int, int]
Orbit = tuple[str, ...]
"""Coordinates of one point, then the weight: 20 digits each."""

GUESSES, ROUNDS, STEPS, SPARE = 128, 8, 400, 5
"""Starts at a time, how often, steps each; unknowns there may be beyond the equations."""
CONVERGED = 1e-25
"""Of the sum of squared defects."""
INSIDE, WEIGHT = 1e-3, 2e-3
"""A point must be so far inside (barycentric), a weight have so much of the mean weight."""


# --- The search -----------------------------------------------------------------------------------


def candidates(dim: int, exactness: int, points: int) -> Iterator[Equations]:
    """Orbits with so many points and enough unknowns, most unknowns first."""
    need, every, found = len(exponents(exactness, dim)), kinds(dim), []
    sizes, lengths = [size(kind) for kind in every], [len(kind) for kind in every]
    ranges = [range(2), *(range(points // many + 1) for many in sizes[1:])]
    for counts in product(*ranges):
        spare = np.dot(counts, lengths) - need
        if np.dot(counts, sizes) == points and 0 <= spare <= SPARE:
            orbits = (kind for kind, many in zip(every, counts, strict=True) for _ in range(many))
            found.append(Equations(tuple(orbits), exactness))
    yield from sorted(filter(is_flexible, found), key=lambda equations: -equations.unknowns)


def is_flexible(equations: Equations) -> bool:
    """Whether the unknowns move all moments, as they do not with too many points on the axes."""
    slopes = equations.defects(guesses(equations, np.random.default_rng(0), 3))[1]
    ranks = np.linalg.matrix_rank(slopes / np.linalg.norm(slopes, axis=1, keepdims=True), 1e-8)
    return int(np.max(ranks)) == slopes.shape[1]


def guesses(equations: Equations, random: np.random.Generator, many: int) -> Floats:
    """Unknowns (b, n): points anywhere, weights near the mean; the best quarter of a draw."""
    many *= 4
    columns = []
    for kind in equations.orbits:
        share = np.maximum(random.dirichlet(kind, size=many), 0.02)
        columns += list(np.log(share[:, :-1] / share[:, -1:]).T)
    noise = random.normal(scale=0.4, size=(len(equations.orbits), many))
    drawn = np.stack([*columns, *(noise - np.log(equations.sizes.sum()))], axis=1)
    defects = np.linalg.norm(equations.defects(drawn)[0], axis=1)
    return np.asarray(drawn[np.argsort(defects)[: many // 4]])


def solutions(equations: Equations, z: Floats) -> Floats:
    """Where Levenberg-Marquardt leads from each guess (b, n); those that lead nowhere drop out.

    Every 15 steps the squared defect must have halved.
    """
    damping, before, found = np.full(len(z), 1e-3), np.full(len(z), np.inf), [z[:0]]
    defect, slope = equations.defects(z)
    cost = np.sum(defect**2, axis=1)
    for turn in range(1, STEPS):
        ahead = np.clip(z + step(defect, slope, damping), -30, 30)
        there, inclined = equations.defects(ahead)
        better = np.sum(there**2, axis=1) < cost
        z, defect = pick(better, ahead, z), pick(better, there, defect)
        slope = pick(better, inclined, slope)
        damping = np.clip(np.where(better, damping / 5, damping * 2), 1e-14, 1e8)
        cost = np.sum(defect**2, axis=1)
        found.append(z[cost < CONVERGED])
        stays = cost >= CONVERGED
        if turn % 15 == 0:
            stays &= (cost < before / 2) | (cost < 1e-14)
            before = cost.copy()
        z, defect, slope, damping, cost, before = (
            array[stays] for array in (z, defect, slope, damping, cost, before)
        )
        if not len(z):
            break
    return np.concatenate(found)


def pick(which: Numbers, yes: Floats, no: Floats) -> Floats:
    """Rows of one array or the other."""
    return np.where(which.reshape(-1, *[1] * (yes.ndim - 1)), yes, no)


def step(defect: Floats, slope: Floats, damping: Floats) -> Floats:
    """The damped Gauss-Newton step (b, n), no longer than 2 in any unknown."""
    normal = slope.swapaxes(1, 2) @ slope
    diagonal = np.einsum("bii->bi", normal)
    scale = diagonal + 1e-3 * diagonal.max(axis=1, keepdims=True)
    np.einsum("bii->bi", normal)[:] += damping[:, None] * scale + 1e-15
    down = np.einsum("bmn,bm->bn", slope, defect)
    moved = -np.linalg.solve(normal, down[..., None])[..., 0]
    return np.asarray(moved * np.minimum(1, 2 / np.abs(moved).max(axis=1, keepdims=True)))


def best(equations: Equations, found: Floats) -> Floats | None:
    """Of rules that are well inside, the one that errs least one degree higher."""
    bary, _, weights = equations.points(found)
    light = weights.min(axis=1) * equations.sizes.sum() < WEIGHT
    inside = found[(bary.min(axis=(1, 2)) > INSIDE) & ~light]
    if not len(inside):
        return None
    higher = Equations(equations.orbits, equations.exactness + 1).defects(inside)[0]
    return np.asarray(inside[np.argmin(np.linalg.norm(higher, axis=1))])


def rule(dim: int, exactness: int, points: range, rounds: int) -> list[Orbit]:
    """The first rule found, polished; empty where there is none."""
    for equations in (e for q in points for e in candidates(dim, exactness, q)):
        counts = [equations.orbits.count(kind) for kind in kinds(dim)]
        random = np.random.default_rng([dim, exactness, *counts])
        for _ in range(rounds):
            found = solutions(equations, guesses(equations, random, GUESSES))
            z = best(equations, found)
            if z is not None:
                print(f"{equations.sizes.sum()} points {counts}", flush=True)
                bary, _, weights = equations.points(z[None])
                return polished(equations, np.column_stack([bary[0], weights[0]]))
        print(f"{equations.sizes.sum()} points {counts}: none found", flush=True)
    return []


# --- Polishing ------------------------------------------------------------------------------------


def polished(equations: Equations, rows: Numbers) -> list[Orbit]:
    """20 digits of the rule near coordinates and weights (o, d+2)."""
    with localcontext() as context:
        context.prec = 60
        rows = np.array([[Decimal(f"{Decimal(x):.20f}") for x in row] for row in rows])
        for row, kind in zip(rows, equations.orbits, strict=True):
            row[-1 - kind[-1] : -1] = Decimal(0)
            row[-1 - kind[-1] : -1] = (1 - row[:-1].sum()) / kind[-1]
        for _ in range(8):
            moved = correction(equations, rows)
            rows = rows + moved
        if abs(moved).max() > Decimal("1e-40"):
            raise ArithmeticError(f"Newton's last step was {abs(moved).max():.1e}")
        return sorted(tuple(f"{x:.20f}" for x in row) for row in rows)


def correction(equations: Equations, rows: Numbers) -> Numbers:
    """Newton's step for coordinates and weights.

    Where there are more unknowns than equations, those that matter least stay as they are.
    """
    e, de = exactly_elementary(rows[:, :-1])
    values = prod(e[:, k, None] ** equations.powers[:, k] for k in range(equations.dim))
    weighted = values * (equations.sizes * rows[:, -1])[:, None]
    defect = weighted.sum(axis=0) - means(equations.exactness, equations.dim)
    moves = list(directions(equations))
    slope = []
    for o, move in moves:
        if move[-1]:
            slope.append(values[o] * equations.sizes[o])
        else:
            slope.append(weighted[o] * (equations.powers @ ((de[o] @ move[:-1]) / e[o])))
    J = np.array(slope).T
    which = qr(J.astype(float), mode="r", pivoting=True)[1][: len(J)]
    found = np.zeros_like(rows)
    for j, length in zip(which, solved(J[:, which], -defect), strict=True):
        found[moves[j][0]] += moves[j][1] * length
    return found


def directions(equations: Equations) -> Iterator[tuple[int, Numbers]]:
    """How a row (d+2) may change: a part against the last part of its kind, or the weight."""
    for o, kind in enumerate(equations.orbits):
        for h in range(len(kind) - 1):
            move = np.zeros(equations.dim + 2, dtype=object) + Decimal(0)
            move[:-1][equations.belongs[o, h]] = Decimal(1)
            move[:-1][equations.belongs[o, len(kind) - 1]] = -Decimal(kind[h]) / kind[-1]
            yield o, move
        weight = np.zeros(equations.dim + 2, dtype=object) + Decimal(0)
        weight[-1] = Decimal(1)
        yield o, weight


def exactly_elementary(bary: Numbers) -> tuple[Numbers, Numbers]:
    """`moments.elementary` in any arithmetic: (o, d) and (o, d, d+1)."""
    many, corners = bary.shape
    e = [np.full(many, Decimal(1))] + [np.full(many, Decimal(0))] * corners
    for i in range(corners):
        e = [e[0]] + [e[k] + bary[:, i] * e[k - 1] for k in range(1, corners + 1)]
    slope = [np.full((many, corners), Decimal(1))]
    for k in range(2, corners + 1):
        slope.append(e[k - 1][:, None] - bary * slope[-1])
    return np.stack(e[2:], axis=1), np.stack(slope[1:], axis=1)


def solved(A: Numbers, b: Numbers) -> Numbers:
    """Of A x = b, by elimination with pivots, in any arithmetic."""
    rows = np.column_stack([A, b])
    for k in range(len(rows)):
        pivot = k + int(np.argmax(np.abs(rows[k:, k])))
        rows[[k, pivot]] = rows[[pivot, k]]
        rows[k] = rows[k] / rows[k, k]
        others = np.arange(len(rows)) != k
        rows[others] = rows[others] - rows[others, k, None] * rows[k]
    return rows[:, -1]


def means(exactness: int, dim: int) -> Numbers:
    """Of the symmetric polynomials over the simplex (m,): exact, then 60 digits."""
    return np.array([fraction(*mean(p, dim)) for p in exponents(exactness, dim)])


def fraction(above: int, below: int) -> Decimal:
    """A quotient in the precision that is set."""
    return Decimal(above) / Decimal(below)


def mean(powers: Ints, dim: int) -> tuple[int, int]:
    """Of one product of e_2 .. e_{d+1}, as a fraction: multiplied out, <L^a> = a! d! / (|a|+d)!."""
    terms = {(0,) * (dim + 1): 1}
    for k, many in enumerate(powers, 2):
        factors = [f for f in product(range(2), repeat=dim + 1) if sum(f) == k]
        for _ in range(many):
            longer: dict[tuple[int, ...], int] = {}
            for (alpha, c), f in product(terms.items(), factors):
                key = tuple(a + b for a, b in zip(alpha, f, strict=True))
                longer[key] = longer.get(key, 0) + c
            terms = longer
    total = sum(
        Fraction(c * prod(map(factorial, alpha)) * factorial(dim), factorial(sum(alpha) + dim))
        for alpha, c in terms.items()
    )
    return Fraction(total).as_integer_ratio()


# --- The table ------------------------------------------------------------------------------------


def read() -> dict[Key, list[Orbit]]:
    """The table, by dimension and exactness."""
    text = TABLE.read_text(encoding="utf-8") if TABLE.exists() else ""
    lines = [line.split() for line in text.splitlines() if line[0] != "#"]
    return {
        (int(dim), int(exactness)): [tuple(line[2:]) for line in group]
        for (dim, exactness), group in groupby(lines, key=lambda line: tuple(line[:2]))
    }


def write(table: dict[Key, list[Orbit]]) -> None:
    """The table, as text."""
    lines = [" ".join([*map(str, key), *orbit]) for key in sorted(table) for orbit in table[key]]
    TABLE.write_text(HEAD + "\n".join(lines) + "\n", encoding="utf-8")


def kind_of(orbit: Orbit) -> Kind:
    """The kind of an orbit of the table."""
    return tuple(len(list(same)) for _, same in groupby(orbit[:-1]))


def again(key: Key, orbits: list[Orbit]) -> list[Orbit]:
    """A rule of the table, polished."""
    return polished(Equations(tuple(map(kind_of, orbits)), key[1]), np.array(orbits))


def points_of(orbits: list[Orbit]) -> int:
    """How many points a rule has."""
    return sum(size(kind_of(orbit)) for orbit in orbits)


def main() -> None:
    """The two commands."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    commands = parser.add_subparsers(dest="command", required=True)
    commands.add_parser("polish")
    search = commands.add_parser("search")
    for name in ("dim", "exactness", "first", "last"):
        search.add_argument(name, type=int)
    search.add_argument("--rounds", type=int, default=ROUNDS)
    given = parser.parse_args()
    table = read()
    if given.command == "polish":
        write({key: again(key, orbits) for key, orbits in table.items()})
        return
    key = (given.dim, given.exactness)
    found = rule(*key, range(given.first, given.last + 1), given.rounds)
    if not found:
        sys.exit(f"no rule of exactness {given.exactness} with so many points was found")
    known = table.get(key)
    if known is None or points_of(found) < points_of(known):
        write(read() | {key: found})


if __name__ == "__main__":
    main()
