# SPDX-License-Identifier: BSD-3-Clause
"""The steps in which a load is put on: one, many, given, or as they come."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from bezsoma.arrays import Floats
from bezsoma.errors import Inadmissible, InputError
from bezsoma.solvers.newton import Iteration, Rule, StepFailed, System, TangentFailed, equilibrium

SHORTEST = 2.0**-10
"""A load step of less than a thousandth of the load is given up."""
DOUBTED = 2.0**-3
"""A step shorter than this is given up if the law has lost its ellipticity and the tangent no
longer gives a correction."""
MOST = 10_000
"""More load steps than anyone waits for; as many fractions are kept."""
FEW = 6
"""A step that took no more iterations than this lets the next one be twice as long."""

Told = Callable[[Iteration], None]


@dataclass(frozen=True, eq=False)
class Reached:
    """The last state x (n,) in balance, its fraction of the load, and every iteration.

    Where the fraction is below 1, `tried` is the fraction that failed in the end, and `why`.
    """

    x: Floats
    fraction: float
    path: tuple[Iteration, ...]
    tried: float = 1.0
    why: str = ""


def steps_checked(steps: Any) -> tuple[float, ...] | None:
    """The fractions of the load, ending with 1; None for "auto".

    >>> steps_checked(4), steps_checked([0.1, 1]), steps_checked("auto")
    ((0.25, 0.5, 0.75, 1.0), (0.1, 1.0), None)
    """
    if isinstance(steps, str) and steps == "auto":
        return None
    if isinstance(steps, int | np.integer) and not isinstance(steps, bool):
        if not 1 <= steps <= MOST:
            raise InputError(
                f"steps = {steps}: a load is put on in one step or more, up to {MOST}; "
                "steps='auto' finds how many"
            )
        return tuple((i + 1) / int(steps) for i in range(int(steps)))
    fractions = _fractions(steps)
    if not fractions or fractions[-1] != 1 or not all(a < b for a, b in _pairs(fractions)):
        raise InputError(
            f"steps = {steps!r}: give how many, or the fractions of the load in ascending order, "
            "above 0 and ending with 1, as [0.1, 0.4, 1]; 'auto' finds them"
        )
    return fractions


def _fractions(steps: Any) -> tuple[float, ...]:
    given = () if isinstance(steps, str) or not hasattr(steps, "__iter__") else tuple(steps)
    good = all(isinstance(t, int | float | np.number) and not isinstance(t, bool) for t in given)
    return tuple(map(float, given)) if good else ()


def _pairs(fractions: Sequence[float]) -> zip[tuple[float, float]]:
    return zip((0.0, *fractions), fractions, strict=False)


def loaded(
    system: System,
    x: Floats,
    steps: tuple[float, ...] | None,
    rule: Rule,
    tell: Told,
    start: Floats | None = None,
) -> Reached:
    """The state under the whole load, from x (n,) at rest, or the last that could be reached.

    Given steps are taken as they are. Without them the whole load is tried first; a step that
    fails is halved, and one that took few iterations lets the next be twice as long. Halving ends
    early where the law has lost its ellipticity and its tangent fails: there it leads nowhere.

    Where there is a `start` (n,), a state near that under the whole load, the whole is first tried
    from there, whatever the steps; if that fails, the next iteration says so. So it does where
    the first step fails from what `system.near` gives, and rest is begun from.
    """
    path: list[Iteration] = []
    failed: list[str] = []

    def record(iteration: Iteration) -> None:
        if failed:
            iteration = replace(iteration, events=(failed.pop(), *iteration.events))
        path.append(iteration)
        tell(iteration)

    if start is not None:
        try:
            begin = np.where(system.held, system.given(1.0), start)
            return Reached(equilibrium(system, begin, 1.0, 1, rule, record), 1.0, tuple(path))
        except (StepFailed, Inadmissible) as failure:
            failed[:] = [f"the earlier solution was no start, so from rest: {failure}"]

    def found(target: float) -> Floats:
        near = system.near(target) if fraction == 0 else None
        if near is not None:
            try:
                return equilibrium(system, x, target, number, rule, record, near)
            except StepFailed as failure:
                failed[:] = [f"the answer of degree 1 was no start, so from rest: {failure}"]
        return equilibrium(system, x, target, number, rule, record)

    fraction, length, number, refused = 0.0, 1.0, 1, ""
    while fraction < 1:
        target = _next(fraction, length, steps)
        before = len(path)
        try:
            x = found(target)
        except StepFailed as failure:
            length /= 2
            refused = failure.refused or refused
            failed[:] = [f"{100 * target:.4g} % of the load was tried in vain: {failure}"]
            last = steps is not None or length < SHORTEST
            tired = length < DOUBTED and isinstance(failure, TangentFailed)
            doubt = system.doubt(x) if last or tired else ""
            if last or doubt:
                return Reached(x, fraction, tuple(path), target, _why(str(failure), refused, doubt))
        else:
            fraction = target
            number += 1
            if len(path) - before <= FEW:
                length *= 2
    return Reached(x, 1.0, tuple(path))


def _why(failure: str, refused: str, doubt: str) -> str:
    """What failed at last, the last state that could not be, and what the law has lost."""
    new = refused if refused not in failure else ""
    return "; ".join(part for part in (failure, new and f"refused was {new}", doubt) if part)


def _next(fraction: float, length: float, steps: tuple[float, ...] | None) -> float:
    if steps is None:
        return 1.0 if fraction + length > 1 - SHORTEST / 2 else fraction + length
    return next(each for each in steps if each > fraction)
