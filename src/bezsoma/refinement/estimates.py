# SPDX-License-Identifier: BSD-3-Clause
"""How far a solution is from the truth: in energy, and in what the user wants to know, in mm."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from time import perf_counter

import numpy as np

from bezsoma.arrays import Floats, frozen
from bezsoma.refinement.goals import Goal, goal_checked
from bezsoma.refinement.means import mean, weights
from bezsoma.refinement.raised import Raised, raised
from bezsoma.refinement.saturation import FIRST, decay, limit, share
from bezsoma.refinement.singular import singularities
from bezsoma.solvers.nonlinear import is_linear
from bezsoma.solvers.solution import Solution

LEAST = 0.01
"""The part of the product of two energy errors below which a goal's error cannot be told."""


@dataclass(frozen=True, eq=False)
class EnergyEstimate:
    """The energy of the error, N mm: `of_tet` (t,), not negative, and their sum `total`.

    `relative` is sqrt(total / energy of the solution), the error in the energy norm as a part of
    the solution [-]. `warnings` say what makes the number meaningless, where anything does;
    `seconds` is what it took.
    """

    of_tet: Floats
    total: float
    relative: float
    warnings: tuple[str, ...]
    seconds: float


@dataclass(frozen=True, eq=False)
class GoalEstimate:
    """A mean displacement `value` [mm] and its estimated error [mm]: the truth is near their sum.

    `error` has a sign: true value minus `value`. `of_tet` (t,) mm is the part that each tet has in
    it, with signs, as far as the higher degree sees it; abs(of_tet) says where to refine. `product`
    [mm] is the product of the errors of the displacement and of the dual in the energy norm, beyond
    which the error cannot be. `warnings` and `seconds` are those of `EnergyEstimate`.
    """

    goal: Goal
    value: float
    error: float
    of_tet: Floats
    product: float
    warnings: tuple[str, ...]
    seconds: float

    @property
    def size(self) -> float:
        """What may be claimed of the error, mm: abs(error), and no less than 1 % of the product.

        Where the error happens to pass through zero its estimate says nothing.
        """
        return max(abs(self.error), LEAST * self.product)


@dataclass(frozen=True, eq=False)
class VectorEstimate:
    """A mean displacement `value` (3,) [mm] and its estimated error (3,) [mm], all components.

    `along` is the estimate in the direction of that error, with the product of energies.
    """

    value: Floats
    error: Floats
    along: GoalEstimate

    @property
    def size(self) -> float:
        """What may be claimed of the error's length, mm; no less than 1 % of the product."""
        return max(float(np.linalg.norm(self.error)), self.along.size)


def energy_estimate(
    solution: Solution, *, richer: Raised | None = None, threads: int | None = None
) -> EnergyEstimate:
    """The energy of the error of a solution, tet by tet: see `EnergyEstimate`.

    Args:
        solution: what `solve` gave; degrees up to 8.
        richer: `raised(solution)`, where it is at hand; several estimates may share it.
        threads: as in `solve`.

    Raises:
        NotConverged: where iterations do not find the error, as next to nu = 1/2.
    """
    start = perf_counter()
    richer = raised(solution, threads=threads) if richer is None else richer
    parts, total = richer.squares(richer.correction), richer.gain / _seen(_rate(richer), richer)
    of_tet = parts * (total / parts.sum()) if total > 0 else parts
    energy = _stored(richer)
    relative = math.sqrt(total / energy) if energy > 0 else (math.inf if total > 0 else 0.0)
    return EnergyEstimate(
        frozen(of_tet), total, relative, singularities(solution), perf_counter() - start
    )


def _rate(richer: Raised) -> float:
    """How fast the energy of the error falls with the degree."""
    return FIRST if richer.by == 1 else _fall(richer.between.gain, richer.gain, richer)


def _fall(one: float, two: float, richer: Raised) -> float:
    """How fast the energy of an error falls, from what one and two more degrees see of it."""
    return decay(one / two, richer.solution.body.degree) if two > 0 else math.inf


def _seen(rate: float, richer: Raised) -> float:
    """The part of an energy that the richer degree sees [-]."""
    return share(rate, richer.solution.body.degree, richer.by)


def _limit(changes: Sequence[float], rate: float, richer: Raised) -> float:
    """Where a change ends that the richer degrees, one or two, make so large [mm]."""
    if richer.by == 1:
        return changes[0] / _seen(rate, richer)
    return limit(changes[0], changes[1], rate, richer.solution.body.degree)


def _degrees(richer: Raised) -> tuple[Raised, ...]:
    """Those above the solution that tell its error, ascending."""
    return (richer,) if richer.by == 1 else (richer.between, richer)


def _stored(richer: Raised) -> float:
    """The energy of the solution in the measure of its error, N mm."""
    if is_linear(richer.body):
        return richer.solution.energy
    return float(richer.squares(richer.written).sum())


def goal_estimate(
    solution: Solution, goal: Goal, *, richer: Raised | None = None, threads: int | None = None
) -> GoalEstimate:
    """A mean of the displacement and its error, by a dual solve: see `GoalEstimate`.

    Args:
        solution: what `solve` gave; degrees up to 8.
        goal: the mean that is wanted; a point is refused, saying why.
        richer: `raised(solution)`, where it is at hand; several estimates may share it.
        threads: as in `solve`.

    Raises:
        NotConverged: where iterations do not find the error, as next to nu = 1/2.
    """
    start = perf_counter()
    goal = goal_checked(goal, solution.body.mesh)
    richer = raised(solution, threads=threads) if richer is None else richer
    own = richer.base.dual(_load(goal, richer.base))
    return _judged(goal, richer, own, start)[0]


def vector_estimate(
    solution: Solution, place: Goal, *, richer: Raised | None = None, threads: int | None = None
) -> VectorEstimate:
    """The mean of the displacement over a place, all three components, and its error, mm.

    Three duals in the degree of the solution tell what its components lack, each within 1 % of the
    product; one of the higher degree, in the direction of that, tells the product. That takes
    about 1.3 times as long as one goal.

    Args:
        solution: what `solve` gave; degrees up to 8.
        place: a goal, the direction of which does not matter.
        richer: `raised(solution)`, where it is at hand; several estimates may share it.
        threads: as in `solve`.

    Raises:
        NotConverged: where iterations do not find the error, as next to nu = 1/2.
    """
    start = perf_counter()
    place = goal_checked(place, solution.body.mesh)
    richer = raised(solution, threads=threads) if richer is None else richer
    goals, above = _axes(place), _degrees(richer)
    value = np.array([mean(goal, solution.displacement) for goal in goals])
    owns = [richer.base.dual(_load(goal, richer.base)) for goal in goals]
    changes = np.array(
        [
            [_change(_load(goal, of), of, of.elevated(own, richer.base)) for of in above]
            for goal, own in zip(goals, owns, strict=True)
        ]
    )
    ways = (changes[:, -1], value, np.array([0.0, 0.0, 1.0]))
    along = replace(place, direction=next(way for way in ways if way.any()))
    judged, rate = _judged(along, richer, np.einsum("an,a->n", owns, along.direction), start)
    error = np.array([_limit(each, rate, richer) for each in changes])
    return VectorEstimate(frozen(value), frozen(error), judged)


def _axes(place: Goal) -> tuple[Goal, Goal, Goal]:
    x, y, z = (replace(place, direction=axis) for axis in np.eye(3))
    return x, y, z


def _judged(goal: Goal, richer: Raised, own: Floats, start: float) -> tuple[GoalEstimate, float]:
    """The estimate of a goal whose dual in the degree of the solution is known (n,), and its rate.

    An error is the product of two, and falls as fast as the two together: like a power of the
    degree that is the mean of theirs. A dual of a patch smaller than the tets is slower to come.
    """
    solution, duals = richer.solution, _duals(goal, richer, own)
    last = duals[-1]
    slope = FIRST if richer.by == 1 else _fall(duals[0].energy, last.energy, richer)
    rates = (_rate(richer), slope)
    energies = [
        gain / _seen(rate, richer)
        for gain, rate in zip((richer.gain, last.energy), rates, strict=True)
    ]
    rate = sum(rates) / 2
    found = GoalEstimate(
        goal,
        mean(goal, solution.displacement),
        _limit([each.change for each in duals], rate, richer),
        frozen(richer.product(richer.correction, last.sharper)),
        2 * math.sqrt(math.prod(energies)),
        singularities(solution),
        perf_counter() - start,
    )
    return found, rate


@dataclass(frozen=True, eq=False)
class _Degree:
    """What a degree says of a goal: how it changes [mm], what is added to its dual (n,), N mm."""

    change: float
    sharper: Floats
    energy: float


def _duals(goal: Goal, richer: Raised, own: Floats) -> list[_Degree]:
    """What the degrees above say, each starting from the one before."""
    found: list[_Degree] = []
    for of in _degrees(richer):
        guess = of.elevated(found[-1].sharper, richer.between) if found else np.zeros_like(of.start)
        found.append(_of_degree(goal, of, of.elevated(own, richer.base), guess))
    return found


def _of_degree(goal: Goal, of: Raised, coarse: Floats, guess: Floats) -> _Degree:
    """What a degree says of a goal."""
    load = _load(goal, of)
    sharper, energy = of.sharpened(load, coarse, guess)
    return _Degree(_change(load, of, coarse + sharper), sharper, energy)


def _change(load: Floats, of: Raised, dual: Floats) -> float:
    """What a degree adds to a goal, mm.

    Were the correction exact, its mean would be the change of the goal; what the loose solve
    left of the residual counts by the dual, and only the product of both errors is lost.
    """
    change = np.einsum("i,i->", load, of.correction) + np.einsum("i,i->", dual, of.left)
    return float(change)


def _load(goal: Goal, of: Raised) -> Floats:
    """The weights of the mean (n,), none of the pressure."""
    pressures = 0 if of.pressures is None else of.pressures.count
    return np.concatenate([weights(goal, of.net).ravel(), np.zeros(pressures)])
