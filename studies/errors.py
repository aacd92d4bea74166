# SPDX-License-Identifier: BSD-3-Clause
"""Whether the estimated errors are right: estimated over true error, in energy and for goals.

Four bodies (a known displacement, Cook's membrane, an L with its singular edge, a layered block of
contrast 20 that is held and moved as a face is), three meshes each, degrees 1 to 4; and 200 random
ones. The truth is known, or comes from a mesh graded towards the singular lines in degree 6. Run as

    python studies/errors.py [folder] [bodies|random|picture]

It leaves errors_bodies.csv, errors_random.csv and errors.png in the folder (docs/images where none
is given), each row as soon as it is known; docs/theory/error.md discusses them.
"""

from __future__ import annotations

import csv
import math
import sys
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, fields
from itertools import pairwise
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import bezsoma as bz
from bezsoma.arrays import Floats
from bezsoma.equations.forces import forces
from bezsoma.mesh.solids import cook, l_block
from bezsoma.refinement import (
    Goal,
    InnerMean,
    PatchMean,
    SurfaceMean,
    energy_estimate,
    goal_estimate,
)
from bezsoma.refinement.means import weights
from bezsoma.refinement.raised import raised

DEGREES = (1, 2, 3, 4)
TRUTH = 6
"""The degree of the truth, on a graded mesh."""
SHARE = 0.01
"""Below this part of the product of energies nobody can tell how large a goal's error is."""


BELOW = 0.2
"""Estimates are judged where the error in the energy norm is below this part of the solution."""
COUNT = 200
"""Random problems."""


@dataclass(frozen=True)
class Problem:
    """A body on meshes of any fineness; `graded` is the mesh of its truth."""

    name: str
    mesh: Callable[[int], bz.TetMesh]
    body: Callable[[bz.TetMesh, int], bz.Body]
    goal: Goal
    cells: tuple[int, int, int]
    graded: Callable[[], bz.TetMesh] | None = None
    exact: Callable[[Floats], Floats] | None = None


@dataclass(frozen=True)
class Row:
    """One solution: its relative error in energy, its goal [mm], and what the estimates say."""

    problem: str
    degree: int
    cells: int
    unknowns: int
    relative: float
    energy: float
    goal: float
    goal_error: float
    goal_estimated: float
    product: float


def mapped(mesh: bz.TetMesh, to: Callable[[Floats], Floats]) -> bz.TetMesh:
    """The same tets, every point moved."""
    _, (_, *rest) = mesh.__reduce__()
    return bz.TetMesh(to(mesh.points), *rest)


def towards(x: Floats, lines: tuple[float, ...], power: float = 2.5) -> Floats:
    """Coordinates from 0 to 1 moved so that they crowd at lines, which stay where they are."""
    out = x.copy()
    for low, high in pairwise(lines):
        inside = (x >= low) & (x <= high)
        s = (x[inside] - low) / (high - low)
        bent = np.where(s < 0.5, (2 * s) ** power / 2, 1 - (2 - 2 * s) ** power / 2)
        out[inside] = low + bent * (high - low)
    return out


def known(mesh: bz.TetMesh, degree: int) -> bz.Body:
    """A cube of a known displacement, all of its boundary prescribed."""
    law = bz.LinearElastic(E=1.04, nu=0.3)
    held = [bz.Prescribed(side, value=waves) for side in mesh.surfaces]
    return bz.Body(mesh, degree, law, held, [bz.BodyForce(lambda x: 0.4 * 13 * waves(x))])


def waves(x: Floats) -> Floats:
    """A displacement, mm, that changes no volume: -div stress = mu (2^2 + 3^2) u."""
    s, c = np.sin(2 * x), np.cos(3 * x)
    return np.column_stack([s[:, 1] * c[:, 2], s[:, 2] * c[:, 0], s[:, 0] * c[:, 1]])


def pulled(mesh: bz.TetMesh, degree: int) -> bz.Body:
    """Cook's membrane, clamped and sheared."""
    law = bz.LinearElastic(E=1.0, nu=1 / 3)
    held = [bz.Fixed("clamped"), bz.Fixed("front", "back", components="z")]
    return bz.Body(mesh, degree, law, held, [bz.Traction("loaded", value=(0, 1 / 16, 0))])


def cornered(mesh: bz.TetMesh, degree: int) -> bz.Body:
    """The L, held at one end on rollers and pulled at the other."""
    law = bz.LinearElastic(E=1.0, nu=0.3)
    held = [
        bz.Fixed("right", components="x"),
        bz.Fixed("front", components="y"),
        bz.Fixed("bottom", "top", components="z"),
    ]
    return bz.Body(mesh, degree, law, held, [bz.Traction("left", value=(-0.1, 0.02, 0))])


def layers(cells: int) -> bz.TetMesh:
    """20 x 10 x 12 mm of muscle, fat and skin on a bone that is held on the left third."""
    return layered(bz.block((20.0, 10.0, 12.0), (6 * cells, 2 * cells, 4 * cells)))


def layered(mesh: bz.TetMesh) -> bz.TetMesh:
    """Regions by height, and the parts of the bottom that are held and moved."""
    height = mesh.points[mesh.tets].mean(axis=1)[:, 2]
    region = np.searchsorted([3.0, 9.0], height)
    parts = (mesh.points, mesh.tets, region, ("muscle", "fat", "skin"), dict(mesh.surfaces))
    tagged = bz.TetMesh(*parts)
    near = 1e-9
    tagged = tagged.with_surface("skull", lambda x: (x[:, 2] < near) & (x[:, 0] < 20 / 3 + near))
    return tagged.with_surface("jaw", lambda x: (x[:, 2] < near) & (x[:, 0] > 40 / 3 - near))


def moved(mesh: bz.TetMesh, degree: int) -> bz.Body:
    """The layers, one bone held and the other moved; between them the bottom is free."""
    laws = {
        "muscle": bz.LinearElastic(E=0.06, nu=0.4),
        "fat": bz.LinearElastic(E=0.015, nu=0.45),
        "skin": bz.LinearElastic(E=0.3, nu=0.4),
    }
    held = [bz.Fixed("skull"), bz.Moved("jaw", translation=(0, -0.2, 0.5))]
    return bz.Body(mesh, degree, laws, held + [bz.Fixed("left", "right", components="x")])


def fine_layers() -> bz.TetMesh:
    """Graded towards the lines where bone ends, the layers' faces and the sides."""

    def to(x: Floats) -> Floats:
        return np.column_stack(
            [
                20 * towards(x[:, 0] / 20, (0, 1 / 3, 2 / 3, 1), 3.5),
                10 * towards(x[:, 1] / 10, (0, 1), 1.5),
                12 * towards(x[:, 2] / 12, (0, 1 / 4, 3 / 4, 1), 3.0),
            ]
        )

    return layered(mapped(bz.block((20.0, 10.0, 12.0), (18, 3, 12)), to))


def fine_l() -> bz.TetMesh:
    """The L graded towards its inner corner."""
    return mapped(
        l_block(cells=6, layers=1),
        lambda x: np.column_stack([np.sign(x[:, :2]) * np.abs(x[:, :2]) ** 3, x[:, 2]]),
    )


def fine_cook() -> bz.TetMesh:
    """Cook's membrane graded towards its four sides."""

    def to(x: Floats) -> Floats:
        u = x[:, 0] / 48
        v = (x[:, 1] - 44 * u) / (44 - 28 * u)
        u, v = (towards(each, (0, 1), 2.5) for each in (u, v))
        return np.column_stack([48 * u, 44 * (u + v) - 28 * u * v, x[:, 2]])

    return mapped(cook(cells=(10, 10, 1), thickness=8.0), to)


PROBLEMS = (
    Problem(
        "known",
        lambda n: bz.block(cells=n, irregular=0.3),
        known,
        InnerMean(at=(0.45, 0.5, 0.4), radius=0.3, direction="x"),
        (2, 3, 4),
        exact=waves,
    ),
    Problem(
        "Cook",
        lambda n: cook(cells=(n, n, 1), thickness=8.0),
        pulled,
        SurfaceMean("loaded", direction="y"),
        (2, 4, 8),
        fine_cook,
    ),
    Problem(
        "L",
        lambda n: l_block(cells=n),
        cornered,
        PatchMean("back", at=(0, 1, 0.5), radius=0.4, direction="x"),
        (1, 2, 4),
        fine_l,
    ),
    Problem(
        "layers",
        layers,
        moved,
        PatchMean("top", at=(13, 5, 12), radius=3, direction="z"),
        (1, 2, 3),
        fine_layers,
    ),
)
"""What is measured."""


def chance(seed: int) -> tuple[Problem, int]:
    """A random layered block, held, moved, loaded and asked for something; and a degree."""
    roll = np.random.default_rng(seed)
    size = roll.uniform(5, 15, 3)
    turn = np.eye(3) + roll.uniform(-0.25, 0.25, (3, 3))
    count = int(roll.integers(1, 4))
    laws = {
        f"layer {i}": bz.LinearElastic(E=0.015 * 20 ** roll.random(), nu=roll.uniform(0.2, 0.45))
        for i in range(count)
    }
    held: list[bz.Fixed | bz.Moved] = [bz.Fixed("bottom")]
    free = ["left", "right", "front", "back", "top"]
    if roll.random() < 0.5:
        about, axis = turn @ size / 2, roll.normal(size=3)
        how = {"axis": axis, "angle": 0.05, "about": about, "translation": roll.uniform(-1, 1, 3)}
        held.append(bz.Moved("top", **how))
        free.remove("top")
    loads = [bz.BodyForce(tuple(roll.uniform(-1e-5, 1e-5, 3)))]
    for side in roll.choice(free, 2, replace=False):
        value = [
            f"{a:.6g}+{b:.6g}*x+{c:.6g}*y" for a, b, c in roll.uniform(-1e-3, 1e-3, (3, 3)) / 5
        ]
        loads.append(bz.Traction(str(side), value=bz.Polynomial.parse(value)))

    def of(unit: bz.TetMesh) -> bz.TetMesh:
        height = unit.points[unit.tets].mean(axis=1)[:, 2]
        region = np.minimum((height * count).astype(int), count - 1)
        points = unit.points * size @ turn.T
        return bz.TetMesh(points, unit.tets, region, tuple(laws), dict(unit.surfaces))

    def fine() -> bz.TetMesh:
        levels = tuple(np.linspace(0, 1, count + 1))
        lines = ((0.0, 1.0), (0.0, 1.0), levels)
        unit = bz.block(cells=(4, 4, max(4, 2 * count)))
        return of(
            mapped(
                unit, lambda x: np.column_stack([towards(x[:, i], lines[i], 2.5) for i in range(3)])
            )
        )

    along, middle = roll.normal(size=3), turn @ (size * roll.uniform(0.2, 0.8, 3))
    kind = roll.integers(3)
    if kind == 0:
        goal: Goal = SurfaceMean(str(roll.choice(free)), direction=along)
    elif kind == 1:
        goal = InnerMean(at=middle, radius=roll.uniform(0.1, 0.3) * size.min(), direction=along)
    else:
        point = size * roll.uniform(0.2, 0.8, 3)
        side = str(roll.choice(free))
        axis_of = {"left": 0, "right": 0, "front": 1, "back": 1, "top": 2}[side]
        point[axis_of] = size[axis_of] * (side in ("right", "back", "top"))
        radius = roll.uniform(0.1, 0.4) * size.min()
        goal = PatchMean(side, at=turn @ point, radius=radius, direction=along)
    return Problem(
        f"random {seed}",
        lambda n: of(bz.block(cells=(n, n, count * max(1, round(n / count))))),
        lambda mesh, degree: bz.Body(mesh, degree, laws, held, loads),
        goal,
        (1, 2, 3),
        fine,
    ), int(roll.integers(2, 5))


def potential(solution: bz.Solution) -> float:
    """The stored energy less the work of the loads [N mm], least for the truth."""
    work = forces(solution.body, solution.net) * solution.displacement.controls
    return solution.energy - float(work.sum())


def truth(problem: Problem) -> tuple[float, float]:
    """The potential of the true solution [N mm] and its goal [mm]."""
    if problem.graded is None:
        return math.nan, exact_goal(problem)
    found = []
    for degree in (TRUTH - 1, TRUTH):
        solution = bz.solve(problem.body(problem.graded(), degree), rtol=1e-9)
        goal = (weights(problem.goal, solution.net) * solution.displacement.controls).sum()
        found.append((potential(solution), float(goal)))
    print(f"{problem.name}: truth {found}", flush=True)
    return found[-1]


def exact_goal(problem: Problem) -> float:
    """The goal of a known displacement."""
    net = bz.ControlNet(problem.mesh(4), 8)
    return float((weights(problem.goal, net) * net.interpolated(problem.exact)).sum())


def true_energy(problem: Problem, solution: bz.Solution, least: float) -> float:
    """The energy of the error, N mm."""
    if problem.exact is None:
        return potential(solution) - least
    high = raised(solution, 9 - solution.body.degree)
    return float(high.squares(high.net.interpolated(problem.exact).ravel() - high.written).sum())


def rows(problem: Problem) -> Iterator[Row]:
    """Every degree on every mesh."""
    least, value = truth(problem)
    for degree in DEGREES:
        for cells in problem.cells:
            solution = bz.solve(problem.body(problem.mesh(cells), degree), rtol=1e-10)
            yield row(problem, solution, cells, least, value)


def row(problem: Problem, solution: bz.Solution, cells: int, least: float, value: float) -> Row:
    """What the estimates say of one solution."""
    richer = raised(solution)
    energy = energy_estimate(solution, richer=richer)
    goal = goal_estimate(solution, problem.goal, richer=richer)
    true = true_energy(problem, solution, least)
    return Row(
        problem.name,
        solution.body.degree,
        cells,
        3 * solution.net.count,
        energy.relative * math.sqrt(true / energy.total),
        math.sqrt(energy.total / true),
        goal.value,
        value - goal.value,
        goal.error,
        goal.product,
    )


def effectivity(row: Row) -> float:
    """Estimated over true error of a goal, both measured against what can be told at all."""
    floor = SHARE * row.product
    return max(abs(row.goal_estimated), floor) / max(abs(row.goal_error), floor)


def random_row(seed: int) -> Row:
    """One random body, on the first mesh of which the estimated error is below 20 %."""
    problem, degree = chance(seed)
    solution = bz.solve(problem.body(problem.graded(), TRUTH - 1))
    goal = float((weights(problem.goal, solution.net) * solution.displacement.controls).sum())
    least = potential(solution)
    for cells in (1, 2, 3, 4, 6):
        solution = bz.solve(problem.body(problem.mesh(cells), degree), rtol=1e-9)
        if cells == 6 or energy_estimate(solution).relative < BELOW:
            break
    return row(problem, solution, cells, least, goal)


def written(path: Path, found: Iterator[Row]) -> None:
    """A table that grows."""
    with path.open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, [each.name for each in fields(Row)])
        table.writeheader()
        for each in found:
            table.writerow({key: shown(value) for key, value in asdict(each).items()})
            file.flush()
            print(
                f"{each.problem} degree {each.degree} cells {each.cells}: "
                f"{100 * each.relative:.3g} % in energy, effectivity {each.energy:.3f}, "
                f"goal {effectivity(each):.3f}",
                flush=True,
            )


def shown(value: object) -> object:
    """Six digits of a number."""
    return f"{value:.6g}" if isinstance(value, float) else value


def read(path: Path) -> list[Row]:
    """The rows of a table."""
    kinds = {"problem": str, "degree": int, "cells": int, "unknowns": int}
    with path.open(encoding="utf-8") as file:
        return [
            Row(**{key: kinds.get(key, float)(text) for key, text in line.items()})
            for line in csv.DictReader(file)
        ]


def drawn(folder: Path) -> None:
    """Effectivities of the bodies by their error, and how those of random problems lie."""
    figure = Figure(figsize=(9.5, 3.6), layout="constrained")
    left, right = figure.subplots(1, 2)
    bodies = read(folder / "errors_bodies.csv")
    for name, mark in zip(dict.fromkeys(each.problem for each in bodies), "osD^", strict=True):
        some = [each for each in bodies if each.problem == name and each.relative < BELOW]
        x = [100 * each.relative for each in some]
        left.plot(x, [each.energy for each in some], mark, color="#1f4e79", label=f"{name}, energy")
        left.plot(
            x,
            [effectivity(each) for each in some],
            mark,
            mfc="none",
            color="#b3312c",
            label=f"{name}, goal",
        )
    left.set(
        xscale="log",
        yscale="log",
        xlabel="error in the energy norm, %",
        ylabel="estimated / true",
        ylim=(0.3, 3),
    )
    left.set_yticks([0.5, 0.7, 1, 1.5, 2], ["0.5", "0.7", "1", "1.5", "2"])
    left.minorticks_off()
    left.legend(fontsize=7, ncols=2)
    some = [each for each in read(folder / "errors_random.csv") if each.relative < BELOW]
    bins = np.geomspace(0.25, 4, 33)
    for values, colour, label in (
        ([each.energy for each in some], "#1f4e79", "energy"),
        ([effectivity(each) for each in some], "#b3312c", "goal"),
    ):
        right.hist(np.clip(values, 0.26, 3.9), bins, histtype="step", color=colour, label=label)
    right.set(xscale="log", xlabel="estimated / true", ylabel=f"of {len(some)} random problems")
    right.set_xticks([0.3, 0.5, 1, 2], ["0.3", "0.5", "1", "2"])
    right.minorticks_off()
    right.legend()
    figure.savefig(folder / "errors.png", dpi=110)


def main(words: list[str]) -> None:
    """What the words ask for: all of it where they do not say."""
    asked = [word for word in words if word in ("bodies", "random", "picture")]
    rest = [word for word in words if word not in asked]
    folder = Path(rest[0]) if rest else Path(__file__).parent.parent / "docs" / "images"
    for what in asked or ["bodies", "random", "picture"]:
        if what == "bodies":
            written(folder / "errors_bodies.csv", (each for p in PROBLEMS for each in rows(p)))
        elif what == "random":
            written(folder / "errors_random.csv", map(random_row, range(COUNT)))
        else:
            drawn(folder)


if __name__ == "__main__":
    main(sys.argv[1:])
