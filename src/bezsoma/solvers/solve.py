# SPDX-License-Identifier: BSD-3-Clause
"""The one way to solve a body."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from bezsoma.arrays import Floats, frozen
from bezsoma.equations.assembled import BlockMatrix, assembled
from bezsoma.equations.boundary import prescribed
from bezsoma.equations.displacement import Equations
from bezsoma.equations.element import lame_constants, moduli
from bezsoma.equations.forces import forces
from bezsoma.equations.matrix_free import MatrixFree
from bezsoma.equations.rigid import refuse_rigid_motions
from bezsoma.equations.stress import volume_change
from bezsoma.equations.threads import thread_count
from bezsoma.errors import InputError, NotConverged, unknown
from bezsoma.mechanics.body import Body
from bezsoma.mesh.control_net import ControlNet
from bezsoma.mesh.field import Field
from bezsoma.solvers.direct import (
    before_factoring,
    direct,
    why_factored,
    why_iterated,
)
from bezsoma.solvers.krylov import conjugate_gradients, incomplete_cholesky, larger_rtol
from bezsoma.solvers.memory import refuse_what_does_not_fit
from bezsoma.solvers.mixed import advice, mixed_solution
from bezsoma.solvers.multigrid import MOST_ITERATIONS, multigrid
from bezsoma.solvers.nonlinear import Loading, is_linear, nonlinear_solution
from bezsoma.solvers.solution import Solution, reactions
from bezsoma.solvers.start import State, first_displacement, start_checked
from bezsoma.solvers.watch import Progress, Watch, in_range

Steps = int | str | Sequence[float]
SOLVERS = ("auto", "direct", "multigrid", "cg", "saddle")


def solve(
    body: Body,
    *,
    solver: str = "auto",
    rtol: float | None = None,
    threads: int | None = None,
    steps: Steps = "auto",
    method: str = "newton",
    exactness: int | None = None,
    start: State | None = None,
    progress: Progress | None = None,
) -> Solution:
    """The displacement of a body at rest [mm], and what follows from it: see `Solution`.

    Solves the displacement form, int tau(u) : eps(v) = loads on v for all v that are zero where
    something is prescribed (paper, eq. 7 and 33). Beware of nu close to 1/2, where this form
    stiffens; degrees of 3 and more suffer least. A body with a pressure of its own is solved in
    the mixed form, which holds up to nu = 1/2: see `bezsoma.equations.mixed`.

    A bar that is drawn out to twice a strain of 1 % carries E times that, whatever its degree:

    >>> from bezsoma.mechanics import Fixed, LinearElastic, Moved
    >>> from bezsoma.mesh.solids import block
    >>> planes = {"left": "x", "front": "y", "bottom": "z"}
    >>> held = [Fixed(place, components=axis) for place, axis in planes.items()]
    >>> drawn = Moved("top", translation=(0, 0, 0.02), components="z")
    >>> bar = Body(block(), 2, LinearElastic(E=5.0, nu=0.3), [*held, drawn])
    >>> solution = solve(bar)
    >>> bool(np.allclose(solution.reactions["top"].force, [0, 0, 0.1], atol=1e-9))
    True
    >>> bool(abs(solution.energy / (0.1 * 0.02 / 2) - 1) < 1e-8)
    True

    Args:
        body: what is to be solved.
        solver: "direct" (a sparse factorisation, to rounding; beware of more than some 10 000
            unknowns), "multigrid" (conjugate gradients without a matrix, preconditioned by blocks
            of entities and multigrid), "cg" (the paper's: with an incomplete Cholesky
            factorisation), or "auto": multigrid, and where that does not come through soon (nu next
            to 1/2, tets almost flat) direct, for a body of up to `DIRECT_UP_TO` unknowns. With a
            pressure: "direct", "saddle" (without a matrix, preconditioned), or "auto", likewise.
            For laws that are not linear, and pressures that follow, "auto" is direct up to so many.
        rtol: what the Euclidean norm of the residual over the free components has to come down
            to: for a linear body relative to that at zero free displacement, 1e-8 where not given;
            for others relative to the larger of internal and applied forces, the work of the
            residual likewise, 1e-10 where not given.
        threads: how many; None takes the environment's BEZSOMA_THREADS, or all cores that this
            process may use, as its affinity and its control groups say. The answer of every solver
            but SuperLU's own arithmetic has the same bits for any number.
        steps: for a body that is not linear, in how many steps the load is put on: a number, the
            fractions of the load ending with 1, or "auto": the whole at once, halved where no
            equilibrium is found, and longer again where it is found soon. Steps that are given
            are taken as they are: where one fails it is not halved, and NotConverged is raised.
        method: for a body that is not linear, "newton", "modified" (the tangent at the start of
            each step is kept) or "secant" (the paper's eq. 51, for the stiffening laws).
        exactness: up to which degree the quadrature of laws that are not linear is exact, at least
            2 n - 2; 2 n + 2 where not given, and one point at degree 1, where strains are constant
            in a tet.
        start: an earlier Solution, or Results, of about the same body on any mesh and of any
            degree: iterations begin there and are fewer; when they end does not depend on it. A
            load is first put on at once from there, and in steps from rest if that fails. A direct
            factorisation has no use for it.
        progress: called with a stage, how much of it is done, and a note.

    Raises:
        InputError: supports that disagree, or leave rigid motions (named), and the like.
        NotConverged: with the history of the residual, and what to try; where a load was put on
            in steps, with the last state in balance.
    """
    loading = Loading(steps, method, exactness)
    linear = not isinstance(body, Body) or is_linear(body)
    rtol = (1e-8 if linear else 1e-10) if rtol is None else rtol
    _check(body, solver, rtol, progress)
    rtol = float(rtol)
    begin = start_checked(start)
    watch = Watch(progress)
    number = threads_asked(threads)
    if not linear:
        return nonlinear_solution(body, solver, rtol, number, loading, watch, begin)
    if body.mixed:
        return mixed_solution(body, solver, rtol, number, watch, begin)
    chosen = "multigrid" if solver == "auto" else solver
    equations = _equations(body, chosen, number, watch)
    x = None
    if begin is not None and chosen != "direct":
        x = first_displacement(begin, equations.net)
    few = before_factoring(solver, equations.free, body.degree)
    try:
        found = _solved(
            equations, x, chosen, why_iterated(solver), rtol, watch, few or MOST_ITERATIONS
        )
    except NotConverged as stopped:
        if few is None:
            raise
        why = why_factored(stopped, few, equations.free)
        K = _stiffness(body, equations.net, "direct", number, watch)
        equations = replace(equations, stiffness=K)
        found = _solved(equations, None, "direct", why, rtol, watch)
    return _solution(body, equations, found, number, watch)


@dataclass(frozen=True, eq=False)
class _Found:
    x: Floats
    method: str
    history: list[float] = field(default_factory=list)


def _check(body: Body, solver: str, rtol: float, progress: Progress | None) -> None:
    if not isinstance(body, Body):
        raise InputError(f"solve() was given {body!r}; it solves a Body")
    if solver not in SOLVERS:
        raise InputError(unknown("solver", solver, SOLVERS, "solve()"))
    if solver == "saddle" and not body.mixed:
        raise InputError(
            "solver = 'saddle' is for bodies with a pressure of their own, and this one has none: "
            "give Body(..., incompressible=True), or take 'multigrid'"
        )
    if not (isinstance(rtol, int | float | np.floating) and 0 < rtol < 1):
        raise InputError(f"rtol = {rtol!r} has to be a number between 0 and 1; 1e-8 serves most")
    if progress is not None and not callable(progress):
        raise InputError(
            f"progress = {progress!r} cannot be called: give a function of a stage, how much of it "
            "is done and a note, or None"
        )


def threads_asked(asked: int | None) -> int:
    """How many threads: as asked for, else as the environment says, else 0 for all cores."""
    given = os.environ.get("BEZSOMA_THREADS") or "0" if asked is None else asked
    if asked is not None:
        return thread_count(given)
    # int() reads more than a shell's user means: 1_0, +1, digits of any script.
    digits = re.fullmatch(r"\s*0*([0-9]{1,4})\s*", str(given), re.ASCII)
    return thread_count(int(digits[1]) if digits else -1, given, "BEZSOMA_THREADS")


def _equations(body: Body, chosen: str, threads: int, watch: Watch) -> Equations:
    with watch.stage("numbering", f"{len(body.mesh.tets)} tets, degree {body.degree}"):
        refuse_what_does_not_fit(body, chosen)
        lame_constants(body)  # refuses laws that have none before work is done for them
        net = ControlNet(body.mesh, body.degree)
    with watch.stage("supports", f"{3 * net.count} unknowns"):
        known = prescribed(body, net)
        refuse_rigid_motions(net, known.mask)
    with watch.stage("loads", f"{len(body.loads)} given"):
        loads = forces(body, net)
    stiffness = _stiffness(body, net, chosen, threads, watch)
    return Equations(net, stiffness, loads, known.mask, known.values, known.of_support)


def _stiffness(
    body: Body, net: ControlNet, chosen: str, threads: int, watch: Watch
) -> BlockMatrix | MatrixFree:
    """What it does for multigrid, a matrix for others."""
    with watch.stage("stiffness", f"{3 * net.count} unknowns"):
        if chosen != "multigrid":
            return assembled(net, *moduli(body), threads)
        operator = MatrixFree(net, lame_constants(body), threads)
        watch.tell("stiffness", None, operator.runs_on)
        return operator


def _solved(
    equations: Equations,
    start: Floats | None,
    chosen: str,
    why: str,
    rtol: float,
    watch: Watch,
    most: int = MOST_ITERATIONS,
) -> _Found:
    b = equations.residual(equations.given)
    in_range(b, "the forces at zero free displacement")
    b[equations.held] = 0.0
    with watch.stage("solving", f"{chosen}: {why}"):
        if not b.any():
            why = "no free component is out of balance"
            return _Found(np.zeros_like(b), f"nothing to solve: {why}")
        size = float(np.abs(b).max())  # so that squares of tiny or huge forces stay in range
        method = _directly if isinstance(equations.stiffness, BlockMatrix) else _without_a_matrix
        if chosen == "cg":
            method = _iteratively
        b /= size
        if start is not None:
            start = np.where(equations.held, 0.0, start) / size
        found = method(equations, b, start, rtol, most, watch)
        with np.errstate(over="ignore"):  # what is too large for a float is refused as an answer
            found.x[...] *= size
        return replace(found, method=f"{found.method}, {why}")


def _directly(
    equations: Equations, b: Floats, start: Floats | None, rtol: float, most: int, watch: Watch
) -> _Found:
    """From nothing: what a factorisation gives depends neither on a start nor on `most`."""
    assert isinstance(equations.stiffness, BlockMatrix)
    report, waiting = watch.iterations(rtol), watch.factorisation
    x, history = direct(equations, equations.stiffness, b, report, waiting)
    if not history[-1] <= rtol:
        raise NotConverged(
            f"the direct solver is left with {history[-1]:.3g} of the residual at zero free "
            f"displacement, and rtol = {rtol:g} was asked for: rounding stops it there. Look for "
            "tets that are almost flat, nu very close to 1/2 (which Body(..., incompressible=True) "
            f"is for), and materials of very unequal stiffness{larger_rtol(history[-1])}",
            history,
        )
    return _Found(x, "direct (SuperLU, scaled and refined)", history)


def _without_a_matrix(
    equations: Equations, b: Floats, start: Floats | None, rtol: float, most: int, watch: Watch
) -> _Found:
    assert isinstance(equations.stiffness, MatrixFree)
    report = watch.iterations(rtol)
    x, history = multigrid(equations, equations.stiffness, b, rtol, report, start, most)
    how = equations.stiffness.runs_on
    blocks = "entity blocks and " if equations.net.degree > 1 else ""
    return _Found(x, f"conjugate gradients with {blocks}multigrid ({how})", history)


def _iteratively(
    equations: Equations, b: Floats, start: Floats | None, rtol: float, most: int, watch: Watch
) -> _Found:
    assert isinstance(equations.stiffness, BlockMatrix)
    factor = incomplete_cholesky(equations.stiffness, equations.held)
    report = watch.iterations(rtol)
    x, history = conjugate_gradients(equations.free_product, factor, b, rtol, most, report, start)
    raised = f" of the diagonal raised by {factor.shift:g} of itself" if factor.shift else ""
    return _Found(x, f"conjugate gradients with incomplete Cholesky{raised}", history)


def _solution(
    body: Body, equations: Equations, found: _Found, threads: int, watch: Watch
) -> Solution:
    with watch.stage("reactions", "and energy"), np.errstate(over="ignore", invalid="ignore"):
        found.x[...] += equations.given
        displacement = Field(equations.net, frozen(found.x))
        operator = equations.stiffness
        if not isinstance(operator, MatrixFree):
            operator = MatrixFree(equations.net, lame_constants(body), threads)
        energy, swelling = operator.energy(displacement.controls), volume_change(displacement)
        supports = reactions(equations, displacement.controls)
    in_range(np.array([energy, swelling]), "the energy and the change of volume")
    return Solution(
        body,
        displacement,
        reactions=supports,
        energy=energy,
        volume_change=swelling,
        method=found.method,
        history=tuple(found.history),
        iterations=max(len(found.history) - 1, 0),
        residual=found.history[-1] if found.history else 0.0,
        free=equations.free,
        timings=watch.timings,
        advice=advice(body),
    )
