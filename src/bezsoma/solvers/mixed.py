# SPDX-License-Identifier: BSD-3-Clause
"""From a body with a pressure of its own to displacement and pressure."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bezsoma.arrays import Floats, frozen
from bezsoma.equations.boundary import prescribed
from bezsoma.equations.forces import forces
from bezsoma.equations.level import refuse_flux, undetermined, without_mean
from bezsoma.equations.locked import refuse_undetermined
from bezsoma.equations.mixed import (
    MixedEquations,
    MixedMatrix,
    MixedOperator,
    mixed_matrix,
    mixed_moduli,
)
from bezsoma.equations.mixed_free import MixedFree
from bezsoma.equations.rigid import refuse_rigid_motions
from bezsoma.equations.stress import volume_change
from bezsoma.errors import InputError, NotConverged
from bezsoma.mechanics.body import Body
from bezsoma.mechanics.materials import LinearElastic
from bezsoma.mesh.broken_field import BrokenField
from bezsoma.mesh.control_net import ControlNet
from bezsoma.mesh.field import Field
from bezsoma.mesh.torn import pressure_net
from bezsoma.solvers.direct import (
    before_factoring,
    why_factored,
    why_iterated,
)
from bezsoma.solvers.krylov import Report, larger_rtol
from bezsoma.solvers.memory import refuse_what_does_not_fit
from bezsoma.solvers.saddle import MOST_ITERATIONS, saddle
from bezsoma.solvers.saddle_direct import direct_saddle
from bezsoma.solvers.solution import Solution, resultants
from bezsoma.solvers.start import State, first_displacement, first_pressure
from bezsoma.solvers.watch import Watch, in_range

MIXED_SOLVERS = ("auto", "direct", "saddle")
LOCKED_FROM = 0.45
"""Poisson's ratio from which linear tets miss a tenth of the work of a load and more."""
CHEAPER_FROM = {2: 0.45, 3: 0.49, 4: 0.499, 5: 0.499, 6: 0.499}
"""Poisson's ratio, of those measured, from which the mixed form is the cheaper one, by degree."""


def mixed_solution(
    body: Body, solver: str, rtol: float, threads: int, watch: Watch, start: State | None = None
) -> Solution:
    """Displacement and pressure of a body that has one: see `solve`."""
    chosen = "saddle" if solver == "auto" else solver
    equations, locked = _equations(body, chosen, threads, watch)
    begin = None if start is None or chosen == "direct" else _begin(start, equations)
    few = before_factoring(solver, equations.free, body.degree)
    try:
        found = _solved(
            equations, begin, chosen, why_iterated(solver), rtol, watch, few or MOST_ITERATIONS
        )
    except NotConverged as stopped:
        if few is None:
            raise
        why = why_factored(stopped, few, equations.free)
        K = _operator(body, equations.net, equations.pressure_net, "direct", threads, watch)
        found = _solved(replace(equations, operator=K), None, "direct", why, rtol, watch)
    u, p, method, history = found
    with watch.stage("reactions", "and energy"), np.errstate(over="ignore", invalid="ignore"):
        displacement = Field(equations.net, frozen(u))
        pressure = _pressure(body, equations.pressure_net, frozen(p))
        energy = _without_matrix(equations, body, threads).energy(u, p)
        swelling = volume_change(displacement)
        pull = -equations.residuals(u, p)[0]
        supports = resultants(equations.net, equations.of_support, pull)
    in_range(np.array([energy, swelling]), "the energy and the change of volume")
    return Solution(
        body,
        displacement,
        reactions=supports,
        energy=energy,
        volume_change=swelling,
        method=method,
        history=tuple(history),
        iterations=max(len(history) - 1, 0),
        residual=history[-1] if history else 0.0,
        free=equations.free,
        timings=watch.timings,
        pressure=pressure,
        level=_level(len(equations.modes)),
        held_tets=locked,
    )


def _level(modes: int) -> str:
    """What determines the level of the pressure, for the summary."""
    if not modes:
        return "determined: some of the boundary is free along its normal, or nu is below 1/2"
    where = "the body" if modes == 1 else f"each of {modes} parts"
    return (
        f"not determined, since the whole boundary of {where} is prescribed and nu = 1/2: the mean "
        "of the pressure is set to zero"
    )


def _equations(body: Body, chosen: str, threads: int, watch: Watch) -> tuple[MixedEquations, int]:
    assert body.pressure_degree is not None
    with watch.stage("numbering", f"{len(body.mesh.tets)} tets, degree {body.degree}"):
        _solver_checked(chosen)
        refuse_what_does_not_fit(body, chosen)
        net = ControlNet(body.mesh, body.degree)
        pressures = pressure_net(body.mesh, body.pressure_degree, body.pressure_breaks)
        soft = mixed_moduli(body)[body.mesh.region, 1] > 0
    with watch.stage("supports", f"{3 * net.count} displacements, {pressures.count} pressures"):
        known = prescribed(body, net)
        refuse_rigid_motions(net, known.mask)
        modes = undetermined(net, pressures, known.mask, soft)
        locked = refuse_undetermined(net, pressures, known.mask, soft, modes)
        refuse_flux(net, pressures, modes, soft, known.values)
    with watch.stage("loads", f"{len(body.loads)} given"):
        loads = forces(body, net)
    operator = _operator(body, net, pressures, chosen, threads, watch)
    supports = (known.mask, known.values, known.of_support)
    return MixedEquations(net, pressures, operator, loads, *supports, modes), locked


def _operator(
    body: Body, net: ControlNet, pressures: ControlNet, chosen: str, threads: int, watch: Watch
) -> MixedOperator:
    """The matrices for "direct", what they do for "saddle"."""
    with watch.stage("stiffness", f"{3 * net.count} displacements, {pressures.count} pressures"):
        given = (net, pressures, mixed_moduli(body), threads)
        return mixed_matrix(*given) if chosen == "direct" else MixedFree(*given)


def _begin(start: State, equations: MixedEquations) -> tuple[Floats, Floats]:
    """The first u (c, 3), with what is prescribed, and the first p (cp,)."""
    u = first_displacement(start, equations.net)
    p = first_pressure(start, equations.pressure_net, equations.net.mesh)
    return np.where(equations.held, equations.given, u), p


def _without_matrix(equations: MixedEquations, body: Body, threads: int) -> MixedFree:
    """The operator that takes the energy from gradients."""
    if isinstance(equations.operator, MixedFree):
        return equations.operator
    return MixedFree(equations.net, equations.pressure_net, mixed_moduli(body), threads)


def _solved(
    equations: MixedEquations,
    begin: tuple[Floats, Floats] | None,
    chosen: str,
    why: str,
    rtol: float,
    watch: Watch,
    most: int = MOST_ITERATIONS,
) -> tuple[Floats, Floats, str, list[float]]:
    with watch.stage("solving", f"{chosen}: {why}"):
        zero = np.zeros(equations.pressure_net.count)
        f, g = equations.residuals(equations.given, zero)
        in_range(f, "the forces at zero free displacement")
        f[equations.held] = 0.0
        if not (f.any() or g.any()):
            reason = "nothing to solve: no free component is out of balance"
            return equations.given.copy(), zero, reason, []
        report = watch.iterations(rtol)
        if isinstance(equations.operator, MixedMatrix):
            u, p, history = direct_saddle(
                equations, equations.operator, report, watch.factorisation
            )
            if not history[-1] <= rtol:
                raise NotConverged(_stopped(history[-1], rtol), history)
            return u, p, f"direct (SuperLU of both equations, scaled and refined), {why}", history
        begin = begin or (equations.given, zero)
        return _iterated(equations, f, g, begin, why, rtol, report, most)


def _iterated(
    equations: MixedEquations,
    f: Floats,
    g: Floats,
    begin: tuple[Floats, Floats],
    why: str,
    rtol: float,
    report: Report,
    most: int,
) -> tuple[Floats, Floats, str, list[float]]:
    """From a first u and p: what is left there is solved for, and judged by f and g as ever."""
    assert isinstance(equations.operator, MixedFree)
    held, modes = equations.held, equations.modes
    left_f, left_g = equations.residuals(*begin)
    left_f[held] = 0.0
    size = max(float(np.abs(f).max()), float(np.abs(g).max()))
    u, p, history = saddle(
        equations.operator,
        held,
        left_f / size,
        left_g / size,
        modes,
        rtol,
        report,
        most,
        against=(f / size, g / size),
    )
    u = u * size + begin[0]
    p = without_mean(p * size + begin[1], modes, equations.pressure_net)
    return u, p, f"BiCGStab of both equations without a matrix, {why}", history


def _stopped(left: float, rtol: float) -> str:
    return (
        f"the direct solver is left with {left:.3g} of the residual at zero free displacement, and "
        f"rtol = {rtol:g} was asked for: rounding stops it there. Look for tets that are "
        "almost flat, pressures that hardly anything determines (tets all four vertices of which "
        f"are prescribed: solve(unlocked(body))), and very unequal materials{larger_rtol(left)}"
    )


def _pressure(body: Body, net: ControlNet, p: Floats) -> Field | BrokenField:
    if net.mesh is body.mesh:
        return Field(net, p)
    return BrokenField(body.mesh, net.degree, frozen(p[net.of_tet]))


def advice(body: Body) -> str:
    """What to do better with a displacement form close to nu = 1/2; nothing where it is as good.

    The numbers are those of `bezsoma experiment locking`: from there on the mixed form of the same
    degree takes less time for the same error.
    """
    nus = [law.nu for law in body.material_of_region if isinstance(law, LinearElastic)]
    worst = max(nus, default=0.0)
    if body.degree == 1 and worst >= LOCKED_FROM:
        return (
            f"nu = {worst} at degree 1: linear tets lock, and the answer is much too stiff; take "
            "degree 2 or more, best with a pressure of its own, Body(..., incompressible=True)"
        )
    if body.degree in CHEAPER_FROM and worst >= CHEAPER_FROM[body.degree]:
        return (
            f"nu = {worst} at degree {body.degree}: from nu = {CHEAPER_FROM[body.degree]:g} on "
            "the mixed form takes less time for the same error; Body(..., incompressible=True)"
        )
    return ""


def _solver_checked(solver: str) -> None:
    if solver not in MIXED_SOLVERS:
        raise InputError(
            f"solver = {solver!r} solves for a displacement alone, and this body has a pressure of "
            "its own; take 'direct' or 'saddle', or 'auto', which chooses between them"
        )
