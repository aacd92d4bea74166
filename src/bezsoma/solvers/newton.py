# SPDX-License-Identifier: BSD-3-Clause
"""Newton's iteration, its two cheaper cousins, and the steps in which a load is put on.

Written over flat unknowns x (n,), so that a displacement alone and a displacement with a pressure
are the same to it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple, Protocol

import numpy as np

from bezsoma.arrays import Bools, Floats
from bezsoma.errors import BezSomaError, Inadmissible

HALVINGS = 12
"""A correction shorter than 2^-12 of itself leads nowhere."""
SUFFICIENT = 1e-4
"""The part of the promised decrease of the residual that a step has to bring (Armijo)."""
LOOSEST = 0.02
"""Linear solves stop at this part of the residual at the latest (S. C. Eisenstat and H. F. Walker,
SIAM J. Sci. Comput. 17, 1996, doi:10.1137/0917003, choice 2 with gamma = 0.9, alpha = 2)."""
TIGHTEST = 1e-12
FIRST = 1e-5
"""How exactly the way of the free part is found when supports move: what is left of their jump
strains one layer of tets, and costs more iterations than it saves."""
NEAR = 100.0
"""Where the next solve comes so near to the goal anyway, and the square of the residual beyond it,
it goes all the way: cheaper than one more iteration."""
SHORT = 0.25
LEAVE = 6
GROWTH = 1e6
"""No whole step may let the residual grow by more."""
FLOOR = 1e-3
"""Where a body is carried along unstrained all forces are rounding: the residual is then measured
by this part of what it was when the supports had moved and nothing else."""


class Breakdown(BezSomaError):
    """A linear solve failed: the message says how."""


class StepFailed(BezSomaError):
    """Equilibrium was not found at a fraction of the load: the message says why.

    `refused` says why and where the last state that could not be was refused, if any was.
    """

    refused: str = ""


class TangentFailed(StepFailed):
    """It was not, because no correction could be found."""


@dataclass(frozen=True, eq=False)
class Balance:
    """Applied minus internal forces r (n,), and what they are measured by.

    The paper's eq. 53 measures the last correction in their place, which does not test balance.

    `references` has for each part of the unknowns max(|F|, |R|); `work` is max(|F . x|, |R . x|).
    """

    r: Floats
    references: tuple[float, ...]
    work: float


class Correction(NamedTuple):
    """The free dx (n,) of a linear solve, its iterations, and what was out of the ordinary."""

    dx: Floats
    linear: int
    event: str = ""


class Linearised(Protocol):
    """The tangent at a state."""

    def product(self, dx: Floats) -> Floats:
        """K dx (n,)."""
        ...

    def solve(self, b: Floats, rtol: float) -> Correction:
        """Free dx (n,) with |b - K dx| <= rtol |b|; raises Breakdown."""
        ...


@dataclass(frozen=True, eq=False)
class System:
    """What Newton has to know: F(x) = t R(x) where free, x = g(t) where held.

    `parts` are the slices of x whose residuals are judged each by itself, u and p; `weights` what
    each counts in the sum that the line search brings down.
    """

    held: Bools
    parts: tuple[slice, ...]
    weights: tuple[float, ...]
    given: Callable[[float], Floats]
    balance: Callable[[Floats, float], Balance]
    tangent: Callable[[Floats, float], Linearised]
    doubt: Callable[[Floats], str] = lambda x: ""
    """What the material has lost at x, and where; nothing where it is sound."""
    near: Callable[[float], Floats | None] = lambda fraction: None
    """A state near the one in balance at a fraction of the load, if one is at hand."""


@dataclass(frozen=True)
class Iteration:
    """One iteration: the load step and its fraction of the load, and how far it came.

    `residual` is max over u and p of |R - F| / max(|F|, |R|) after it, over the free components;
    `energy` |(R - F) . dx| relative to the work of the forces; `factor` the part of the correction
    that was taken; `linear` how many iterations the linear solve took (1: direct). `events` are
    what went otherwise than it should: a longer step of the load that failed, states that a law
    could not bear, a tangent that is not positive.
    """

    step: int
    fraction: float
    residual: float
    energy: float
    factor: float
    linear: int
    events: tuple[str, ...] = ()


@dataclass
class _Watchdog:
    """Leave to go uphill for a while.

    Where a thin body bends, full corrections stretch it first and put that right in the next
    iteration: a residual that has to fall each time would creep. After two short steps the next
    `LEAVE` are taken whole; what has not come below where it began by then is taken back, and
    that was the last time (R. M. Chamberlain et al., Math. Program. Study 16, 1982,
    doi:10.1007/BFb0120945).
    """

    short: int = 0
    left: int = 0
    bites: bool = False
    x: Floats = field(default_factory=lambda: np.zeros(0))
    balance: Balance | None = None
    size: float = np.inf

    @property
    def free(self) -> bool:
        """Whether the residual may grow now."""
        return self.left > 0

    def seen(
        self, factor: float, x: Floats, balance: Balance, size: float
    ) -> tuple[Floats, Balance]:
        """Where to go on after a step of that factor."""
        if not self.free:
            self.short = self.short + 1 if factor <= SHORT else 0
            if self.short == 2 and not self.bites:
                self.left, self.x, self.balance, self.size = LEAVE, x, balance, size
            return x, balance
        self.left -= 1
        if size < self.size:
            self.left = self.short = 0
        elif not self.left:
            return self.back()
        return x, balance

    def back(self) -> tuple[Floats, Balance]:
        """Where the leave began."""
        assert self.balance is not None
        self.left, self.bites = 0, True
        return self.x, self.balance


Record = Callable[[Iteration], None]


@dataclass(frozen=True)
class Rule:
    """How to iterate: `renew` the tangent in each iteration or keep it for the step."""

    rtol: float
    renew: bool = True
    most: int = 40


@dataclass
class _Step:
    """One load step under way."""

    system: System
    fraction: float
    number: int
    rule: Rule
    record: Record
    floor: tuple[float, ...] = ()
    idle: float = 0.0
    """What work is measured by where none is done: the least force over the way of the supports."""
    refused: str = ""
    """Why the last state that could not be was refused."""
    events: list[str] = field(default_factory=list)

    def told(self) -> tuple[str, ...]:
        """What happened since it was last told."""
        told, self.events = tuple(self.events), []
        return told

    def free(self, r: Floats) -> Floats:
        return np.where(self.system.held, 0.0, r)

    def pushed(self, tangent: Linearised, jump: Floats, balance: Balance) -> Floats:
        """What is out of balance when the supports have moved and nothing else."""
        b = self.free(balance.r - tangent.product(jump))
        self.floor = tuple(FLOOR * extent(b[part]) for part in self.system.parts)
        self.idle = self.floor[0] * extent(jump)
        return b

    def merit(self, r: Floats) -> float:
        """The weighted length of a residual over what is free."""
        free = self.free(r)
        parts = zip(self.system.parts, self.system.weights, strict=True)
        return extent(np.array([w * extent(free[part]) for part, w in parts]))

    def relative(self, balance: Balance) -> float:
        """The largest of the relative residuals of the parts."""
        free, worst = self.free(balance.r), 0.0
        floor = self.floor or (0.0,) * len(self.system.parts)
        for part, size, least in zip(self.system.parts, balance.references, floor, strict=True):
            length = extent(free[part])
            if length > 0:
                worst = max(worst, length / max(size, least, np.finfo(float).tiny))
        return worst


def extent(x: Floats) -> float:
    """The Euclidean norm of x (n,), also where squares would overflow; no BLAS, see `krylov.dot`.

    >>> float(round(extent(np.array([3e200, 4e200])) / 1e200, 12))
    5.0
    """
    size = float(np.abs(x).max(initial=0.0))
    if size == 0 or not np.isfinite(size):
        return size
    scaled = x / size
    return float(size * np.sqrt(np.einsum("i,i->", scaled, scaled)))


def equilibrium(
    system: System,
    x: Floats,
    fraction: float,
    number: int,
    rule: Rule,
    record: Record,
    near: Floats | None = None,
) -> Floats:
    """The state (n,) in balance at a fraction of the load, from one in balance at less.

    It begins at `near`, if that is given and a state that can be, in place of moving the supports
    from x by a linear solve; there no tangent may be other than it should, as one that is not
    positive where the way from x may lead to another state.

    Paper, eqs. 21 and 43, by eqs. 49, 50 and 52 as corrected: each iteration solves
    K dx = R - F for the free components, with what is still to be moved of the supports on the
    right, and takes the largest of 1, 1/2, 1/4, ... of dx with which no law
    fails and the residual falls. It ends when residual and energy are at most `rule.rtol`.
    Raises StepFailed, with the reason and what was refused last.
    """
    step = _Step(system, fraction, number, rule, record)
    try:
        return _iterated(step, x, near)
    except StepFailed as failure:
        failure.refused = step.refused
        raise


def _iterated(step: _Step, x: Floats, near: Floats | None) -> Floats:
    """The state (n,) in balance, by Newton's iteration from x or from `near`."""
    system, fraction, number, rule = step.system, step.fraction, step.number, step.rule
    goal = system.given(fraction)
    balance = system.balance(x, fraction)
    led = False
    if near is not None:
        there, balance = _begun(step, x, balance, goal, near)
        x, led = there, there is not x
    energy, tangent, before = 0.0, None, np.inf
    watchdog = _Watchdog()
    for count in range(rule.most + 1):
        jump = np.where(system.held, goal - x, 0.0)
        moving = bool(jump.any())
        residual = step.relative(balance)
        if not moving and residual <= rule.rtol and energy <= rule.rtol:
            if count == 0 and residual > 0:  # an earlier solution that needs nothing
                step.record(Iteration(number, fraction, residual, energy, 0.0, 0, step.told()))
            return x
        if count == rule.most:
            break
        if tangent is None or rule.renew:
            tangent = system.tangent(x, fraction)
        b = step.pushed(tangent, jump, balance) if moving else step.free(balance.r)
        eta = FIRST if moving else _forcing(step, b, balance, before)
        before = step.merit(b)
        dx, linear, event = _solved(tangent, b, eta)
        if led and event:  # another branch, it may be, than that which x leads to
            raise TangentFailed(event)
        dx += jump
        step.events += [event] if event else []
        try:
            factor, x, balance = _searched(step, x, dx, b, moving, watchdog.free)
        except StepFailed:
            if not watchdog.free:
                raise
            x, balance = watchdog.back()
            continue
        energy = _energy(step, balance, dx)
        size, events = step.relative(balance), step.told()
        step.record(Iteration(number, fraction, size, energy, factor, linear, events))
        if not moving:
            x, balance = watchdog.seen(factor, x, balance, step.merit(balance.r))
    raise StepFailed(
        f"{rule.most} iterations leave a residual of {residual:.3g} and an energy of {energy:.3g}, "
        f"{rule.rtol:g} were asked for"
    )


def _begun(
    step: _Step, x: Floats, balance: Balance, goal: Floats, near: Floats
) -> tuple[Floats, Balance]:
    """The state `near` with its supports at their goal, or x where that cannot be."""
    there = np.where(step.system.held, goal, near)
    try:
        found = step.system.balance(there, step.fraction)
    except Inadmissible:
        return x, balance
    jump = np.where(step.system.held, goal - x, 0.0)
    if jump.any():
        step.pushed(step.system.tangent(x, step.fraction), jump, balance)
    return there, found


def _solved(tangent: Linearised, b: Floats, eta: float) -> Correction:
    """A correction as exact as asked for, or as `LOOSEST`: Newton's residual decides what for."""
    try:
        return tangent.solve(b, eta)
    except Breakdown as failure:
        if eta >= LOOSEST:
            raise TangentFailed(str(failure)) from failure
        first = failure
    try:
        dx, linear, _ = tangent.solve(b, LOOSEST)
    except Breakdown:
        raise TangentFailed(str(first)) from first
    return Correction(dx, linear, f"solved to {100 * LOOSEST:g} % only: {first}")


def _forcing(step: _Step, b: Floats, balance: Balance, before: float) -> float:
    """How exactly to solve: as the residual has fallen, and no better than is asked for."""
    now = step.merit(b)
    target = (
        0.2
        * step.rule.rtol
        * min(
            w * max(size, least)
            for w, size, least in zip(
                step.system.weights,
                balance.references,
                step.floor or (0.0,) * len(balance.references),
                strict=True,
            )
        )
    )
    fallen = 0.9 * (now / before) ** 2 if np.isfinite(before) and before > 0 else LOOSEST
    enough = target / now if now > 0 else LOOSEST
    last = fallen < NEAR * enough and step.relative(balance) ** 2 < 0.1 * step.rule.rtol
    wanted = enough if last else fallen
    return float(min(LOOSEST, max(wanted, TIGHTEST)))


def _energy(step: _Step, balance: Balance, dx: Floats) -> float:
    product = abs(float(np.einsum("i,i->", step.free(balance.r), dx)))
    return product / max(balance.work, step.idle, np.finfo(float).tiny) if product else 0.0


def _searched(
    step: _Step, x: Floats, dx: Floats, b: Floats, moving: bool, free: bool
) -> tuple[float, Floats, Balance]:
    """The part of dx that is taken, the state there and its balance."""
    start, factor = step.merit(b), 1.0
    rounding = 1e-14 * max(start, 1e-300)
    why = "the residual does not fall along the correction"
    for _ in range(HALVINGS):
        there = x + factor * dx
        if moving and factor == 1:
            there = np.where(step.system.held, step.system.given(step.fraction), there)
        try:
            balance = step.system.balance(there, step.fraction)
        except Inadmissible as failure:
            why = step.refused = str(failure)
            step.events.append(f"{100 * factor:.3g} % of the correction refused: {failure}")
        else:
            size = step.merit(balance.r)
            allowed = 1.0 if moving else GROWTH if free else 1 - SUFFICIENT * factor
            falls = size <= allowed * start + rounding
            if falls or step.relative(balance) <= step.rule.rtol:
                return factor, there, balance
            why = "the residual does not fall along the correction"
        factor /= 2
    raise StepFailed(why)
