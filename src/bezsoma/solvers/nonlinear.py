# SPDX-License-Identifier: BSD-3-Clause
"""A body whose law or load is not linear, from its statement to its solution."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from bezsoma.arrays import Floats, frozen
from bezsoma.equations.boundary import prescribed
from bezsoma.equations.ellipticity import lost_ellipticity
from bezsoma.equations.inside_out import inside_out
from bezsoma.equations.internal import internal_forces
from bezsoma.equations.matrix_free import MatrixFree
from bezsoma.equations.moduli import moduli_at
from bezsoma.equations.nonlinear import NonlinearEquations, nonlinear_equations
from bezsoma.equations.pointwise import Internal, Pointwise
from bezsoma.equations.rigid import refuse_rigid_motions
from bezsoma.equations.stress import swelling
from bezsoma.errors import Inadmissible, InputError, NotConverged, unknown
from bezsoma.mechanics.body import Body
from bezsoma.mechanics.laws import Law, Secant, at_rest
from bezsoma.mechanics.loads import Pressure, exactness_checked
from bezsoma.mechanics.path import body_at
from bezsoma.mesh.broken_field import BrokenField
from bezsoma.mesh.control_net import ControlNet
from bezsoma.mesh.field import Field
from bezsoma.solvers.direct import DIRECT_UP_TO
from bezsoma.solvers.factors import Waiting
from bezsoma.solvers.kept import Kept, Precondition
from bezsoma.solvers.load_steps import Reached, loaded, steps_checked
from bezsoma.solvers.memory import refuse_what_does_not_fit
from bezsoma.solvers.multigrid import preconditioned
from bezsoma.solvers.newton import (
    Balance,
    Iteration,
    Rule,
    StepFailed,
    System,
    equilibrium,
    extent,
)
from bezsoma.solvers.nonlinear_mixed import applied, factored_mixed, level, mixed_problem
from bezsoma.solvers.solution import Solution, resultants
from bezsoma.solvers.start import State, first_displacement
from bezsoma.solvers.tangents import applied_tangents, factored_tangents
from bezsoma.solvers.watch import Watch

METHODS = {"newton": (True, 40), "modified": (False, 200), "secant": (True, 500)}
"""Whether the tangent is formed anew in each iteration, and how many there may be."""
SOLVERS = ("auto", "direct", "multigrid")
ROUNDING = 1e-13
"""A residual that no iteration need bring down further."""
NEARLY = 1e-2
"""How near to balance the state of degree 1 is from which a higher degree begins."""


@dataclass(frozen=True)
class Loading:
    """How a load is put on, checked: see `solve`."""

    steps: Any = "auto"
    method: str = "newton"
    exactness: int | None = None

    def __post_init__(self) -> None:
        steps_checked(self.steps)
        if self.method not in tuple(METHODS):
            raise InputError(unknown("method", self.method, METHODS, "solve()"))
        exactness_checked(self.exactness, "solve()")

    def exactness_for(self, degree: int) -> int:
        """The exactness of the quadrature of laws: as given, or 2 n + 2.

        At degree 1 strains are the same throughout a tet: one point is exact for any law. Less
        than 2 n - 2 is refused.

        >>> Loading().exactness_for(1), Loading().exactness_for(3), Loading(exactness=9).exactness
        (0, 8, 9)
        """
        if self.exactness is None:
            return 2 * degree + 2 if degree > 1 else 0
        if self.exactness < 2 * degree - 2:
            raise InputError(
                f"exactness={self.exactness} of solve() at degree {degree}: points so few do not "
                "feel every strain, and the body gives way between them; it must be at least "
                f"{2 * degree - 2}, which is exact for the linear law, and is {2 * degree + 2} "
                "where it is not given"
            )
        return self.exactness


def is_linear(body: Body) -> bool:
    """Whether all laws are linear and no load follows: then one linear solve is the answer."""
    follows = any(isinstance(load, Pressure) and load.following for load in body.loads)
    return not follows and all(law.linear for law in body.material_of_region)


def nonlinear_solution(
    body: Body,
    solver: str,
    rtol: float,
    threads: int,
    loading: Loading,
    watch: Watch,
    start: State | None = None,
) -> Solution:
    """The displacement of a body of any laws, and what follows from it: see `solve`."""
    exactness = loading.exactness_for(body.degree)
    rule, steps = Rule(rtol, *METHODS[loading.method]), steps_checked(loading.steps)
    if body.mixed and loading.method == "secant":
        raise InputError("method='secant' is for a displacement alone; take 'newton'")
    with watch.stage("numbering", f"{len(body.mesh.tets)} tets, degree {body.degree}"):
        _solver_checked(solver)
        refuse_what_does_not_fit(body, solver, linear=False)
        net = ControlNet(body.mesh, body.degree)
    with watch.stage("supports", f"{3 * net.count} unknowns"):
        known = prescribed(body, net)
        refuse_rigid_motions(net, known.mask)
    free = int(known.mask.size - known.mask.sum())
    chosen = choice(free, solver)
    with watch.stage("equations", f"{len(body.loads)} loads, {chosen}"):
        equations = nonlinear_equations(body, net, known)
        method, waiting = loading.method, watch.factorisation
        form = form_of(body, equations, exactness, chosen, method, threads, waiting)
    with watch.stage("solving", f"{loading.method}, {chosen}"):
        rest = np.zeros(len(form.system.held))
        begin = None if start is None else form.begin(start)
        try:
            reached = loaded(form.system, rest, steps, rule, _teller(watch), begin)
        except Inadmissible as failure:  # at rest: all other states are met by a smaller step
            raise _unfit(body, failure, "stress is no finite number at rest") from failure
    how = f"{_NAMES[loading.method]}, {_SOLVES[chosen]}, {_why(free, solver)}"
    with watch.stage("reactions", "and energy"):
        try:
            solution = _solution(equations, form, reached, how, dict(watch.timings))
        except Inadmissible as failure:  # the forces were in balance, so that it is the energy
            raise _unfit(body, failure, "energy is no finite number in balance") from failure
    if reached.fraction < 1:
        raise _unreached(reached, solution)
    return solution


@dataclass(frozen=True, eq=False)
class Form:
    """One form of the equations: what Newton iterates on, and what its answer means."""

    system: System
    pull: Callable[[Floats], Floats]
    energy: Callable[[Floats], float]
    pressure: Callable[[Floats], Field | BrokenField | None]
    begin: Callable[[State], Floats]


def form_of(
    body: Body,
    equations: NonlinearEquations,
    exactness: int,
    chosen: str,
    method: str,
    threads: int,
    waiting: Waiting | None = None,
) -> Form:
    """The form that a body asks for: of the displacement alone, or beside a pressure."""
    form = _mixed if body.mixed else _plain
    return form(body, equations, exactness, chosen, method, threads, waiting)


def _plain(
    body: Body,
    equations: NonlinearEquations,
    exactness: int,
    chosen: str,
    method: str,
    threads: int,
    waiting: Waiting | None,
) -> Form:
    laws = _laws(body)
    internal = internal_forces(equations.net, laws, exactness, threads)
    seldom = chosen == "multigrid" and method != "secant"  # then it is asked for the energy alone
    pointwise = Pointwise(equations.net, laws, exactness, once=seldom)
    system = _system(equations, internal, pointwise, chosen, method, threads, waiting)
    if chosen == "multigrid" and body.degree > 1:
        system = replace(system, near=lambda t: _of_degree_one(equations, t, method, threads))
    return Form(
        system,
        lambda x: internal.forces(x.reshape(-1, 3)),
        lambda x: (internal if internal.symmetric else pointwise).energy(x.reshape(-1, 3)),
        lambda x: None,
        lambda start: first_displacement(start, equations.net).ravel(),
    )


def _of_degree_one(
    equations: NonlinearEquations, fraction: float, method: str, threads: int
) -> Floats | None:
    """The state (n,) of degree 1 near balance at a fraction of the load, elevated.

    Where Newton begins: strains of tens of percent are then nearly right everywhere, so that it
    need not come down from those of the linear law, which an exponential takes for far too large a
    stress. Degree 1 has an eighth of the unknowns of degree 2, and its strains need one point a
    tet. None where no balance is found: then it begins at rest.
    """
    body = replace(equations.body, degree=1)
    net = ControlNet(body.mesh, 1)
    known = prescribed(body, net)
    if known.mask.all():
        return None
    coarse = nonlinear_equations(body, net, known)
    form = _plain(body, coarse, 0, "multigrid", method, threads, None)
    rule = Rule(NEARLY, *METHODS[method])
    try:
        x = equilibrium(form.system, np.zeros(3 * net.count), fraction, 1, rule, lambda each: None)
    except StepFailed:
        return None
    return equations.net.elevated(x.reshape(-1, 3), net).ravel()


def _mixed(
    body: Body,
    equations: NonlinearEquations,
    exactness: int,
    chosen: str,
    method: str,
    threads: int,
    waiting: Waiting | None,
) -> Form:
    problem = mixed_problem(body, equations, exactness, threads)
    if chosen == "direct":
        tangent = factored_mixed(problem, waiting)
    else:
        tangent = applied(problem, threads, waiting)

    def pressure(x: Floats) -> Field | BrokenField:
        p, net = frozen(level(problem, problem.parted(x)[1])), problem.internal.pressure_net
        if net.mesh is body.mesh:
            return Field(net, p)
        return BrokenField(body.mesh, net.degree, frozen(p[net.of_tet]))

    return Form(
        problem.system(tangent),
        lambda x: problem.fast.forces(*problem.parted(x))[0],
        lambda x: problem.internal.energy(*problem.parted(x)),
        pressure,
        problem.begun,
    )


_NAMES = {
    "newton": "Newton with line search",
    "modified": "modified Newton with line search",
    "secant": "the secant iteration (paper, eq. 51) with line search",
}
_SOLVES = {
    "direct": "tangents factored (SuperLU)",
    "multigrid": "tangents applied, preconditioned by the linear law's blocks and multigrid",
}


def _solver_checked(solver: str) -> None:
    if solver not in SOLVERS:
        raise InputError(
            f"solver={solver!r} serves linear bodies only; for other laws and for pressures that "
            "follow take 'direct', 'multigrid' or 'auto'"
        )


def choice(free: int, solver: str) -> str:
    """The solver of the linear systems of Newton for so many unknowns."""
    if solver != "auto":
        return solver
    return "direct" if free <= DIRECT_UP_TO else "multigrid"


def _why(free: int, solver: str) -> str:
    """Why they are solved so, for the summary."""
    if solver != "auto":
        return "as asked for"
    which = "not more" if free <= DIRECT_UP_TO else "more"
    return f"since {free} unknowns are {which} than {DIRECT_UP_TO}"


def _laws(body: Body) -> tuple[Law, ...]:
    for region, law in zip(body.mesh.regions, body.material_of_region, strict=True):
        if not isinstance(law, Law):
            raise InputError(
                f"region {region!r} is {law!r}, which has no derivative and energy as a law needs "
                "(see FunctionLaw)"
            )
    return tuple(law for law in body.material_of_region if isinstance(law, Law))


def _system(
    equations: NonlinearEquations,
    internal: Internal,
    pointwise: Pointwise,
    chosen: str,
    method: str,
    threads: int,
    waiting: Waiting | None,
) -> System:
    if method == "secant":
        pointwise = replace(pointwise, laws=tuple(Secant(law) for law in pointwise.laws))
    held = equations.held.ravel()
    if chosen == "direct":
        tangent = factored_tangents(equations, pointwise, waiting)
    else:
        at_u = _preconditioner(equations, pointwise, threads)
        tangents: Internal = pointwise if method == "secant" else internal
        symmetric = tangents.symmetric and not equations.following
        tangent = applied_tangents(equations, tangents.tangent, at_u, symmetric)
    return System(
        held,
        (slice(0, len(held)),),
        (1.0,),
        lambda fraction: equations.given(fraction).ravel(),
        lambda x, fraction: _balance(equations, internal, x, fraction),
        tangent,
        lambda x: lost_ellipticity(pointwise, x.reshape(-1, 3)),
    )


def _preconditioner(equations: NonlinearEquations, pointwise: Pointwise, threads: int) -> Kept:
    """The preconditioner of the linear laws that the laws are near, at rest and then as it pays."""
    net = equations.net

    def built(x: Floats | None) -> Precondition:
        if x is None:
            lame = frozen(np.array([at_rest(law) for law in pointwise.laws]))
            return preconditioned(MatrixFree(net, lame, threads), equations.held)
        lame = frozen(moduli_at(pointwise, x.reshape(-1, 3)))
        operator = MatrixFree(net, lame, threads, region=np.arange(len(lame)))
        return preconditioned(operator, equations.held)

    return Kept(built)


def _balance(
    equations: NonlinearEquations, internal: Internal, x: Floats, fraction: float
) -> Balance:
    u = x.reshape(-1, 3)
    F, R = internal.forces(u).ravel(), equations.applied(u, fraction).ravel()
    lengths = (extent(F), extent(R))
    work = max(abs(float(np.einsum("i,i->", force, x))) for force in (F, R))
    return Balance(R - F, (max(lengths),), work)


def _teller(watch: Watch) -> Callable[[Iteration], None]:
    def tell(iteration: Iteration) -> None:
        note = (
            f"step {iteration.step}, {100 * iteration.fraction:.3g} % of the load, residual "
            f"{iteration.residual:.1e}"
        )
        watch.tell("solving", None, note)

    return tell


def _solution(
    equations: NonlinearEquations,
    form: Form,
    reached: Reached,
    how: str,
    timings: dict[str, float],
) -> Solution:
    x, net = reached.x, equations.net
    displacement = Field(net, frozen(x[: 3 * net.count].reshape(-1, 3).copy()))
    u = displacement.controls
    pull = form.pull(x) - equations.applied(u, reached.fraction)
    in_balance = [each for each in reached.path if each.fraction <= reached.fraction]
    history = tuple(iteration.residual for iteration in reached.path)
    folded = inside_out(net, equations.body.material_of_region, u)
    return Solution(
        body_at(equations.body, reached.fraction),
        displacement,
        reactions=resultants(net, equations.of_support, pull),
        energy=form.energy(x),
        volume_change=swelling(equations.body, displacement),
        method=how,
        history=history,
        iterations=len(history),
        residual=in_balance[-1].residual if in_balance else 0.0,
        free=int(len(form.system.held) - form.system.held.sum()),
        timings=timings,
        pressure=form.pressure(x),
        advice=folded,
        path=_with_event(reached.path, folded),
    )


def _with_event(path: tuple[Iteration, ...], said: str) -> tuple[Iteration, ...]:
    """The path, its last iteration with one event more, if there is something to say."""
    if not said or not path:
        return path
    return (*path[:-1], replace(path[-1], events=(*path[-1].events, said)))


def _unfit(body: Body, failure: Inadmissible, what: str) -> InputError:
    """The refusal of a law that has no number where any law has to have one."""
    law = body.material_of_region[body.mesh.regions.index(failure.region)]
    return InputError(
        f"region {failure.region!r} is {law!r}, whose {what} (tet {failure.tet}): its parameters "
        "leave the range of numbers, which no smaller step of the load can help; give others"
    )


def _unreached(reached: Reached, last: Solution) -> NotConverged:
    history = [iteration.residual for iteration in reached.path]
    exact = " a larger rtol, for only rounding is left of the residual;"
    helps = exact if min(history, default=1.0) < ROUNDING and reached.fraction == 0 else ""
    error = NotConverged(
        f"at {100 * reached.tried:.4g} % of the load no equilibrium was found, the last is at "
        f"{100 * reached.fraction:.4g} %: {reached.why}. What helps:{helps} a smaller load or "
        "motion, smaller steps (steps='auto' halves them as far as 1/1024), a finer mesh where it "
        "is strained most, a softer law",
        history,
        last=last,
        fraction=reached.fraction,
        path=reached.path,
    )
    if reached.fraction > 0:
        error.add_note("the last state in balance is `last` of this error")
    return error
