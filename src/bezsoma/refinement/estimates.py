# SPDX-License-Identifier: BSD-3-Clause
"""How far a solution is from the truth: in energy, and in what the user wants to know, in mm."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from time import perf_counter

import numpy as np

from bezsoma.arrays import Floats, frozen
from bezsoma.refinement.goals import Goal, goal_checked
from bezsoma.refinement.means import mean, weights
from bezsoma.refinement.raised import Raised, raised
from bezsoma.refinement.saturation import decay, limit, share
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
    it, with signs, as far as two degrees more see it; abs(of_tet) says where to refine. `product`
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
    """
    start = perf_counter()
    richer = raised(solution, threads=threads) if richer is None else richer
    degree = solution.body.degree
    rate = _rate(richer.between.gain, richer.gain, degree)
    of_tet = richer.squares(richer.correction) / share(rate, degree, 2)
    total, energy = float(of_tet.sum()), _stored(richer)
    relative = math.sqrt(total / energy) if energy > 0 else (math.inf if total > 0 else 0.0)
    return EnergyEstimate(
        frozen(of_tet), total, relative, singularities(solution), perf_counter() - start
    )


def _rate(one: float, two: float, degree: int) -> float:
    """How fast the energy of an error falls, from what one and two more degrees see of it."""
    return decay(one / two, degree) if two > 0 else math.inf


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
    product; one of two degrees more, in the direction of that, tells the product itself. That takes
    about 1.3 times as long as one goal.

    Args:
        solution: what `solve` gave; degrees up to 8.
        place: a goal, the direction of which does not matter.
        richer: `raised(solution)`, where it is at hand; several estimates may share it.
        threads: as in `solve`.
    """
    start = perf_counter()
    place = goal_checked(place, solution.body.mesh)
    richer = raised(solution, threads=threads) if richer is None else richer
    goals, both = _axes(place), (richer.between, richer)
    value = np.array([mean(goal, solution.displacement) for goal in goals])
    owns = [richer.base.dual(_load(goal, richer.base)) for goal in goals]
    changes = np.array(
        [
            [_change(_load(goal, of), of, of.elevated(own, richer.base)) for of in both]
            for goal, own in zip(goals, owns, strict=True)
        ]
    )
    ways = (changes[:, 1], value, np.array([0.0, 0.0, 1.0]))
    along = replace(place, direction=next(way for way in ways if way.any()))
    judged, rate = _judged(along, richer, np.einsum("an,a->n", owns, along.direction), start)
    degree = solution.body.degree
    error = np.array([limit(first, second, rate, degree) for first, second in changes])
    return VectorEstimate(frozen(value), frozen(error), judged)


def _axes(place: Goal) -> tuple[Goal, Goal, Goal]:
    x, y, z = (replace(place, direction=axis) for axis in np.eye(3))
    return x, y, z


def _judged(goal: Goal, richer: Raised, own: Floats, start: float) -> tuple[GoalEstimate, float]:
    """The estimate of a goal whose dual in the degree of the solution is known (n,), and its rate.

    An error is the product of two, and falls as fast as the two together: like a power of the
    degree that is the mean of theirs. A dual of a patch smaller than the tets is slower to come.
    """
    solution, degree = richer.solution, richer.solution.body.degree
    first, second = _duals(goal, richer, own)
    dual = richer.square(second.sharper)
    rates = (
        _rate(richer.between.gain, richer.gain, degree),
        _rate(richer.between.square(first.sharper), dual, degree),
    )
    energies = [
        gain / share(rate, degree, 2) for gain, rate in zip((richer.gain, dual), rates, strict=True)
    ]
    rate = sum(rates) / 2
    found = GoalEstimate(
        goal,
        mean(goal, solution.displacement),
        limit(first.change, second.change, rate, degree),
        frozen(richer.product(richer.correction, second.sharper)),
        2 * math.sqrt(math.prod(energies)),
        singularities(solution),
        perf_counter() - start,
    )
    return found, rate


@dataclass(frozen=True, eq=False)
class _Degree:
    """What a degree says of a goal: how it changes [mm], and what is added to its dual (n,)."""

    change: float
    sharper: Floats


def _duals(goal: Goal, richer: Raised, own: Floats) -> tuple[_Degree, _Degree]:
    """What one and two degrees more say, the second starting from the first."""
    base, between = richer.base, richer.between
    first = _of_degree(goal, between, between.elevated(own, base), np.zeros_like(between.start))
    guess = richer.elevated(first.sharper, between)
    return first, _of_degree(goal, richer, richer.elevated(own, base), guess)


def _of_degree(goal: Goal, of: Raised, coarse: Floats, guess: Floats) -> _Degree:
    """What a degree says of a goal."""
    load = _load(goal, of)
    sharper = of.sharpened(load, coarse, guess)
    return _Degree(_change(load, of, coarse + sharper), sharper)


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
