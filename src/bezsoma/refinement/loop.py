# SPDX-License-Identifier: BSD-3-Clause
"""Solve, estimate, refine where it matters, and again, until the error is small enough."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import comb, log, sqrt
from time import perf_counter
from typing import Any

import numpy as np

from bezsoma.arrays import Floats
from bezsoma.errors import InputError, NotConverged
from bezsoma.mechanics.body import Body
from bezsoma.mechanics.checks import number
from bezsoma.refinement.bisection import Cuts, bisected
from bezsoma.refinement.estimates import (
    EnergyEstimate,
    GoalEstimate,
    energy_estimate,
    goal_estimate,
)
from bezsoma.refinement.goals import Goal
from bezsoma.refinement.levels import At, Level, Refined
from bezsoma.refinement.marking import bulk
from bezsoma.refinement.raised import raised
from bezsoma.refinement.targets import Target, targets
from bezsoma.solvers.solution import Solution
from bezsoma.solvers.solve import solve
from bezsoma.solvers.start import Begun
from bezsoma.solvers.watch import Progress

WAYS = ("mesh", "degree", "both")
BULK = 0.6
"""The part of the error that the tets to refine carry."""
TIMES = 2
"""How often they are cut in two. Once gives the best meshes and the most levels, three times halves
every edge; two cost least in all (studies/l_block.py)."""
HIGHEST = 8
"""The highest degree of a level: the estimates take two more, and ten is the highest there is."""
MOST_UNKNOWNS = 500_000

Estimates = tuple[EnergyEstimate, list[GoalEstimate]]


@dataclass(frozen=True, eq=False)
class _Wish:
    """What is asked for, checked."""

    tolerance: float | None
    energy: float | None
    targets: tuple[Target, ...]
    by: str
    most_unknowns: int
    most_seconds: float | None

    @property
    def goals(self) -> list[Goal]:
        return [goal for target in self.targets for goal in target.goals]


def refined(
    body: Body,
    *,
    tolerance: float | None = None,
    at: Any = (),
    energy: float | None = None,
    by: str = "mesh",
    most_unknowns: int = MOST_UNKNOWNS,
    most_seconds: float | None = None,
    progress: Progress | None = None,
    **how: Any,
) -> Refined:
    """The solution of a body on meshes refined, or by degrees raised, until its error is small.

    Each level is solved, its error estimated, and the tets that carry most of it are cut; the
    solution of a level starts the next. A level that would be too large or take too long is not
    begun: then `reached` is False, and `why` says what stopped it.

    Args:
        body: what is to be solved, on a mesh that is coarse but has the shape: curved surfaces
            stay as the first mesh has them.
        tolerance: the largest error allowed of any displacement in `at`, mm.
        at: where: names of surfaces (the mean of the displacement over each, all components),
            goals (see `PatchMean`, `SurfaceMean`, `InnerMean`), or a dict from a name to goals,
            whose errors together are taken for a vector.
        energy: the largest error allowed in the energy norm, as a part of the whole [-].
        by: "mesh" (smaller tets where the error is), "degree" (one more everywhere, up to 8), or
            "both": of these, what paid better when it was last taken.
        most_unknowns: no level has more.
        most_seconds: no level is begun that would end later, as far as one can tell.
        progress: as for `solve`.
        how: what else `solve` takes: solver, rtol, threads, steps, method, exactness, start.

    Raises:
        InputError: a tolerance that is not positive, no place for one, a degree above 8, whose
            error cannot be estimated, and what `solve` refuses.
        NotConverged: the first level did, or its estimate; then `last` is its solution. Where a
            later one fails, the levels end before it.
    """
    wish = _wish(body, tolerance, at, energy, by, most_unknowns, most_seconds)
    if unknowns(body) > wish.most_unknowns:
        raise InputError(
            f"the first level has {unknowns(body)} unknowns already, and most_unknowns = "
            f"{wish.most_unknowns}; begin with a coarser mesh or a lower degree, or allow more"
        )
    if body.degree > HIGHEST:
        raise InputError(
            f"degree {body.degree} was given, and {HIGHEST} is the highest whose error is "
            "estimated; take that or less, or solve() without an estimate"
        )
    run = _Run(wish, how, progress or (lambda stage, done, note: None))
    return run.levels(body)


def _wish(
    body: Body, tolerance: Any, at: Any, energy: Any, by: Any, unknowns: Any, seconds: Any
) -> _Wish:
    if not isinstance(body, Body):
        raise InputError(f"refined() was given {body!r}; it refines a Body")
    if by not in WAYS:
        raise InputError(f"by={by!r}: a level is refined by 'mesh', by 'degree', or by 'both'")
    found = targets(at, body.mesh)
    if tolerance is not None and not found:
        raise InputError(
            f"tolerance = {tolerance!r} mm, of what? Name where: at='skin' (the mean over a "
            "surface), or at=PatchMean('skin', at=(x, y, z), radius=3, direction='y')"
        )
    return _Wish(
        _positive(tolerance, "tolerance (mm)"),
        _positive(energy, "energy, the relative error in the energy norm"),
        found,
        by,
        int(_positive(unknowns, "most_unknowns") or MOST_UNKNOWNS),
        _positive(seconds, "most_seconds"),
    )


def _positive(given: Any, what: str) -> float | None:
    if given is None:
        return None
    value = number(given, what)
    if value <= 0:
        raise InputError(f"{what}: {given!r} was given, and nothing is below it; give more than 0")
    return value


@dataclass(frozen=True, eq=False)
class _Next:
    """A body to solve, how its mesh is cut next, where to start, and what led to it."""

    body: Body
    cuts: Cuts | None
    start: Any
    by: str


class _Run:
    """The levels under way: what has come out so far, and since when."""

    def __init__(self, wish: _Wish, how: dict[str, Any], progress: Progress) -> None:
        self.wish, self.how, self.progress = wish, dict(how), progress
        self.began = perf_counter()
        self.done: list[Level] = []
        self.under_way = "solved"
        """What is done with the level under way."""

    def levels(self, body: Body) -> Refined:
        """All of them."""
        begun = self.began
        now = _Next(body, None, self.how.pop("start", None), "start")
        solution, estimates = self._solved(now)
        while True:
            self.done.append(_level(now, solution, estimates, self.wish, perf_counter() - begun))
            begun = perf_counter()
            why, reached = self._enough()
            if not why:
                now = self._finer(now, solution, estimates)
                why = self._too_much(now)
            if not why:
                try:
                    solution, estimates = self._solved(now)
                except (NotConverged, InputError) as failure:
                    why = f"level {len(self.done)} could not be {self.under_way}: {failure}"
                    reached = False
            if why:
                return self._ended(solution, estimates, reached, why)

    def _solved(self, now: _Next) -> tuple[Solution, Estimates]:
        self.under_way = "solved"
        solution = solve(now.body, start=now.start, progress=self._told, **self.how)
        self._told("estimating", None, f"{len(self.wish.goals)} goals")
        self.under_way = "estimated"
        try:
            return solution, estimated(solution, self.wish.goals, self.how.get("threads"))
        except NotConverged as failure:
            raise NotConverged(
                f"it was solved, but not its error: {failure}",
                failure.history,
                last=solution,
                fraction=1.0,
            ) from failure

    def _told(self, stage: str, done: float | None, note: str) -> None:
        self.progress(stage, done, f"level {len(self.done)}: {note}")

    def _enough(self) -> tuple[str, bool]:
        """Why to stop after the last level, if it is good enough; whether all asked for is had."""
        wish, last = self.wish, self.done[-1]
        if wish.tolerance is None and wish.energy is None:
            return "", True
        near = wish.tolerance is None or last.error <= wish.tolerance
        if near and (wish.energy is None or last.energy_error <= wish.energy):
            return f"the estimated error is below the tolerance: {_came(last, wish)}", True
        return "", False

    def _finer(self, now: _Next, solution: Solution, estimates: Estimates) -> _Next:
        shares = _shares(estimates, self.done[-1], self.wish)
        chosen = bulk(shares, BULK)
        if next_way(self.wish.by, self.done) == "degree":
            return _Next(_of_degree(now.body, 1), now.cuts, solution, "degree")
        self._told("refining", None, f"{len(chosen)} of {len(shares)} tets")
        finer = bisected(now.body.mesh, chosen, now.cuts, TIMES)
        pressure = solution.pressure and solution.pressure.subdivided(finer.into)
        start = Begun(solution.displacement.subdivided(finer.into), pressure)
        return _Next(replace(now.body, mesh=finer.mesh), finer.cuts, start, "mesh")

    def _too_much(self, now: _Next) -> str:
        """Why not to solve this next level; nothing where it may be."""
        last, wish, body = self.done[-1], self.wish, now.body
        if body.degree > HIGHEST:
            return f"degree {HIGHEST} is the highest whose error is estimated; {_came(last, wish)}"
        if len(body.mesh.tets) == last.tets and now.by == "mesh":
            return f"the estimate finds nothing to refine; {_came(last, wish)}"
        more = unknowns(body)
        if more > wish.most_unknowns:
            return (
                f"the next level would have {more} unknowns, and most_unknowns = "
                f"{wish.most_unknowns}; {_came(last, wish)}"
            )
        ends = perf_counter() - self.began + last.seconds * more / last.unknowns
        if wish.most_seconds is not None and ends > wish.most_seconds:
            return (
                f"the next level would end after about {ends:.3g} s, and most_seconds = "
                f"{wish.most_seconds:g}; {_came(last, wish)}"
            )
        return ""

    def _ended(self, solution: Solution, estimates: Estimates, reached: bool, why: str) -> Refined:
        energy, goals = estimates
        told = [energy.warnings, *(goal.warnings for goal in goals)]
        words = dict.fromkeys(word for warnings in told for word in warnings)
        return Refined(solution, tuple(self.done), reached, why, tuple(words))


def estimated(solution: Solution, goals: Sequence[Goal], threads: int | None = None) -> Estimates:
    """The estimates of the energy and of the goals, from one and the same richer solution."""
    richer = raised(solution, threads=threads)
    energy = energy_estimate(solution, richer=richer, threads=threads)
    return energy, [goal_estimate(solution, each, richer=richer, threads=threads) for each in goals]


def unknowns(body: Body) -> int:
    """How many numbers a body asks for, held ones included: three a control, one a pressure.

    >>> from bezsoma.mechanics import LinearElastic
    >>> from bezsoma.mesh.solids import block
    >>> unknowns(Body(block(), 2, LinearElastic(1.0, 0.3), [], pressure_degree=1))
    89
    """
    pressures = _controls(body, body.pressure_degree) if body.pressure_degree else 0
    return 3 * _controls(body, body.degree) + pressures


def _controls(body: Body, degree: int) -> int:
    mesh = body.mesh
    parts = (len(mesh.points), len(mesh.all_edges), len(mesh.all_faces), len(mesh.tets))
    return sum(part * comb(degree - 1, dim) for dim, part in enumerate(parts))


def next_way(by: str, levels: Sequence[Level]) -> str:
    """How to refine next: as asked for, or, of both ways, the one that paid better when last taken.

        pay = log(error before / after) / log(unknowns after / before)

    Each way is tried once. A singularity soon makes the degree pay no more than any uniform
    refinement; where the solution is smooth it pays more each time.
    """
    if by != "both":
        return by
    if levels[-1].degree == HIGHEST or levels[-1].energy_error == 0:
        return "mesh"
    paid = {}
    for before, after in pairwise(levels):
        fallen = log(before.energy_error / after.energy_error)
        paid[after.by] = fallen / log(after.unknowns / before.unknowns)
    untried = [way for way in ("degree", "mesh") if way not in paid]
    return untried[0] if untried else max(paid, key=lambda way: paid[way])


def _of_degree(body: Body, more: int) -> Body:
    """The body with a higher degree, of its pressure too."""
    pressure = None if body.pressure_degree is None else body.pressure_degree + more
    return replace(body, degree=body.degree + more, pressure_degree=pressure)


def _shares(estimates: Estimates, last: Level, wish: _Wish) -> Floats:
    """What each tet (t,) has a part in what is still to be reached, each criterion adding to 1."""
    energy, goals = estimates
    shares = np.zeros(len(energy.of_tet))
    if wish.tolerance is not None and last.error > wish.tolerance:
        of_goals = iter(goals)
        for target, at in zip(wish.targets, last.at, strict=True):
            part = [np.abs(next(of_goals).of_tet) for _ in target.goals]
            if at.error > wish.tolerance:
                shares += _whole(np.sqrt(np.sum(np.square(part), axis=0)))
    if not shares.any() or (wish.energy is not None and last.energy_error > wish.energy):
        shares += _whole(energy.of_tet)
    return shares


def _whole(parts: Floats) -> Floats:
    return parts / (parts.sum() or 1.0)


def _level(
    now: _Next, solution: Solution, estimates: Estimates, wish: _Wish, seconds: float
) -> Level:
    energy, goals = estimates
    of_goals = iter(goals)
    at = [_at(target.name, [next(of_goals) for _ in target.goals]) for target in wish.targets]
    return Level(
        now.by,
        now.body.degree,
        len(now.body.mesh.tets),
        unknowns(now.body),
        solution.energy,
        energy.relative,
        tuple(at),
        solution.iterations,
        seconds,
    )


def _at(name: str, goals: list[GoalEstimate]) -> At:
    return At(
        name,
        tuple(goal.value for goal in goals),
        sqrt(sum(goal.size**2 for goal in goals)),
        sqrt(sum(goal.product**2 for goal in goals)),
    )


def _came(last: Level, wish: _Wish) -> str:
    """What the last level came to, against what was asked for."""
    words = []
    if wish.targets:
        asked = "" if wish.tolerance is None else f" (asked for: {wish.tolerance:g} mm)"
        worst = max(last.at, key=lambda each: each.error)
        words.append(f"{worst.error:.2g} mm at {worst.name!r}{asked}")
    asked = "" if wish.energy is None else f" (asked for: {100 * wish.energy:.3g} %)"
    words.append(f"{100 * last.energy_error:.3g} % in the energy norm{asked}")
    return ", ".join(words)
