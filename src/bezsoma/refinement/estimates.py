# SPDX-License-Identifier: BSD-3-Clause
"""How far a solution is from the truth: in energy, and in what the user wants to know, in mm."""

from __future__ import annotations

import math
from dataclasses import dataclass
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
    rate = _rate(richer, degree)
    of_tet = richer.squares(richer.correction) / share(rate, degree, 2)
    total, energy = float(of_tet.sum()), _stored(richer)
    relative = math.sqrt(total / energy) if energy > 0 else (math.inf if total > 0 else 0.0)
    return EnergyEstimate(
        frozen(of_tet), total, relative, singularities(solution), perf_counter() - start
    )


def _rate(richer: Raised, degree: int) -> float:
    """How fast the energy of the error falls, from what one and two more degrees see of it."""
    return decay(richer.between.gain / richer.gain, degree) if richer.gain > 0 else math.inf


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
    goal, degree = goal_checked(goal, solution.body.mesh), solution.body.degree
    value = mean(goal, solution.displacement)
    richer = raised(solution, threads=threads) if richer is None else richer
    first, second = _duals(goal, richer)
    rate = _rate(richer, degree)
    product = math.sqrt(richer.gain * richer.square(second.sharper)) / share(rate, degree, 2)
    return GoalEstimate(
        goal,
        value,
        limit(first.change, second.change, rate, degree),
        frozen(richer.product(richer.correction, second.sharper)),
        2 * product,
        singularities(solution),
        perf_counter() - start,
    )


@dataclass(frozen=True, eq=False)
class _Degree:
    """What a degree says of a goal: how it changes [mm], and what is added to its dual (n,)."""

    change: float
    sharper: Floats


def _duals(goal: Goal, richer: Raised) -> tuple[_Degree, _Degree]:
    """What one and two degrees more say, the second starting from the first."""
    base, between = richer.base, richer.between
    own = base.dual(_load(goal, base))
    first = _of_degree(goal, between, between.elevated(own, base), np.zeros_like(between.start))
    guess = richer.elevated(first.sharper, between)
    return first, _of_degree(goal, richer, richer.elevated(own, base), guess)


def _of_degree(goal: Goal, of: Raised, coarse: Floats, guess: Floats) -> _Degree:
    """What a degree says of a goal.

    Were the correction exact, its mean would be the change of the goal; what the loose solve
    left of the residual counts by the dual, and only the product of both errors is lost.
    """
    load = _load(goal, of)
    sharper = of.sharpened(load, coarse, guess)
    change = np.einsum("i,i->", load, of.correction)
    change += np.einsum("i,i->", coarse + sharper, of.left)
    return _Degree(float(change), sharper)


def _load(goal: Goal, of: Raised) -> Floats:
    """The weights of the mean (n,), none of the pressure."""
    pressures = 0 if of.pressures is None else of.pressures.count
    return np.concatenate([weights(goal, of.net).ravel(), np.zeros(pressures)])
