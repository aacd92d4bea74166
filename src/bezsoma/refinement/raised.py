# SPDX-License-Identifier: BSD-3-Clause
"""The equations of a solution on its own tets, some degrees up, linearised at the solution."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from bezsoma import _core, bernstein
from bezsoma.arrays import Bools, Floats
from bezsoma.equations.boundary import prescribed
from bezsoma.equations.displacement import Equations
from bezsoma.equations.element import lame_constants
from bezsoma.equations.forces import forces
from bezsoma.equations.level import undetermined
from bezsoma.equations.matrix_free import MatrixFree
from bezsoma.equations.mixed import mixed_moduli
from bezsoma.equations.mixed_free import MixedFree
from bezsoma.equations.nonlinear import nonlinear_equations
from bezsoma.errors import InputError, NotConverged, counted
from bezsoma.mechanics.body import HIGHEST_DEGREE, Body
from bezsoma.mesh.control_net import ControlNet
from bezsoma.mesh.torn import pressure_net
from bezsoma.refinement.products import (
    Product,
    displacement_product,
    linear_product,
    tangent_product,
)
from bezsoma.solvers.memory import refuse_what_does_not_fit
from bezsoma.solvers.multigrid import iterated, preconditioner
from bezsoma.solvers.newton import Correction, Linearised
from bezsoma.solvers.nonlinear import Loading, choice, form_of, is_linear
from bezsoma.solvers.saddle import saddle
from bezsoma.solvers.solution import Solution
from bezsoma.solvers.solve import threads_asked
from bezsoma.solvers.tangents import Factored

LOOSE = 0.05
"""What a residual comes down to where what is left is an error of the error: about 2 % of it."""

TIGHT = 1e-8
"""What it comes down to where an error of the degree itself has to be seen."""


def up(degree: int) -> int:
    """How many degrees above the solution its error is looked for: two, and one above degree 1.

    Two above degree 1 have 27 times its unknowns, and see hardly more.
    """
    return 1 if degree == 1 else 2


@dataclass(frozen=True, eq=False)
class Raised:
    """The linearised equations of a solution in a higher degree: K (x - start) = residual.

    x (n,) holds the controls of the displacement (3c,) [mm] and then those of the pressure [MPa]
    where there is one. `written` is the solution itself, `start` the same with the prescribed
    values taken anew: a displacement that is no polynomial is met better by more controls.
    `residual` (n,) [N, mm3] is what `start` leaves out of balance, zero where held.
    """

    solution: Solution
    body: Body
    net: ControlNet
    pressures: ControlNet | None
    written: Floats
    start: Floats
    held: Bools
    residual: Floats
    tangent: Linearised
    product: Product
    symmetric: bool
    threads: int

    @property
    def by(self) -> int:
        """How many degrees above the solution."""
        return self.body.degree - self.solution.body.degree

    @property
    def split(self) -> int:
        """Where the pressures begin."""
        return 3 * self.net.count

    @cached_property
    def base(self) -> Raised:
        """The same in the degree of the solution itself."""
        return raised(self.solution, 0, self.threads)

    @cached_property
    def between(self) -> Raised:
        """The same one degree above the solution."""
        return raised(self.solution, 1, self.threads)

    @cached_property
    def step(self) -> Floats:
        """The free part of the correction (n,): K step = residual, loosely."""
        start = np.zeros_like(self.residual)
        if self.by > 1:
            lower = self.between
            start = np.where(self.held, 0.0, self.elevated(lower.step, lower))
        return start + self._solved(self.tangent, self.residual, start)

    @cached_property
    def correction(self) -> Floats:
        """What the higher degree adds to the solution (n,), about the error."""
        return self.start - self.written + self.step

    @cached_property
    def left(self) -> Floats:
        """What is still out of balance after the correction (n,)."""
        return np.where(self.held, 0.0, self.residual - self.tangent.product(self.step))

    def squares(self, x: Floats) -> Floats:
        """The energy (t,) N mm of a change x in each tet: what is measured by.

        int tau(x) : eps(x) / 2, with a pressure int G eps' : eps' + p^2 / (2 kappa); of a law that
        is not linear, the same by its tangent at the solution.
        """
        return np.abs(self.product(x, self._mirrored(x))) / 2

    def square(self, x: Floats) -> float:
        """The energy N mm of a change x in all: at the cost of one product with K."""
        return abs(float(np.einsum("i,i->", self._mirrored(x), self.tangent.product(x)))) / 2

    def _mirrored(self, x: Floats) -> Floats:
        """A change x with its pressure turned round: K is then positive."""
        if self.pressures is None:
            return x
        return np.concatenate([x[: self.split], -x[self.split :]])

    @cached_property
    def gain(self) -> float:
        """The energy of the correction, N mm, had it been solved for exactly: `told`.

        What is prescribed has its part in the correction where it is no polynomial; there a part
        of first order in what was left stays, a thousandth where it was looked for.
        """
        return self.told(self.square(self.correction), self.step, self.left)

    def told(self, energy: float, x: Floats, left: Floats) -> float:
        """The energy N mm of what x (n,) would be if it left nothing, from that of x as it is.

        With K (x + e) = b and b - K x = left, the energy is that of x, left . x and that of e: the
        last alone is not known. Where K is not positive or not symmetric the energy stays as it is.
        """
        if self.pressures is not None or not self.symmetric:
            return energy
        return max(energy + float(np.einsum("i,i->", left, x)), 0.0)

    @cached_property
    def adjoint(self) -> Linearised:
        """The transpose of the tangent.

        Beware: where a law has no energy and its tangent is too large to be factored, the tangent
        itself takes its place; see `goal_estimate`, the error of which does not depend on it.
        """
        if isinstance(self.tangent, Factored) and not self.symmetric:
            return replace(self.tangent, matrix=self.tangent.matrix.T.tocsr())
        return self.tangent

    def dual(self, load: Floats) -> Floats:
        """z (n,) with K^T z = load where free, zero where held; not loosely."""
        return self.adjoint.solve(np.where(self.held, 0.0, load), TIGHT).dx

    def sharpened(self, load: Floats, coarse: Floats, guess: Floats) -> tuple[Floats, float]:
        """What a dual of a lower degree lacks of the one of this degree, loosely; its energy.

        (n,) from a guess, and N mm as if solved for exactly.
        """
        lacking = np.where(self.held, 0.0, load - self.adjoint.product(coarse))
        lacks = guess + self._solved(self.adjoint, lacking, guess)
        forces = self.adjoint.product(lacks)
        energy = abs(float(np.einsum("i,i->", self._mirrored(lacks), forces))) / 2
        return lacks, self.told(energy, lacks, np.where(self.held, 0.0, lacking - forces))

    def _solved(self, tangent: Linearised, b: Floats, guess: Floats) -> Floats:
        """What a guess (n,) lacks of the answer to b (n,), until `LOOSE` of b is left."""
        out = np.where(self.held, 0.0, b - tangent.product(guess)) if guess.any() else b
        size = float(np.linalg.norm(out))
        rtol = LOOSE * float(np.linalg.norm(b)) / size if size else 1.0
        return tangent.solve(out, rtol).dx if rtol < 1 else np.zeros_like(out)

    def elevated(self, x: Floats, lower: Raised) -> Floats:
        """A change x of the same problem in a lower degree, written in this one (n,)."""
        u = self.net.elevated(x[: lower.split].reshape(-1, 3), lower.net).ravel()
        if self.pressures is None or lower.pressures is None:
            return u
        p = x[lower.split :][lower.pressures.of_tet]
        return np.concatenate([u, _pressure(p, lower.pressures.degree, self.pressures)])


def raised(solution: Solution, by: int | None = None, threads: int | None = None) -> Raised:
    """The equations of a solution `by` degrees up; None: as many as its estimates take, `up`.

    At the solution they are in balance as far as its own degree can tell; what is left is the
    residual that the higher degree sees:

    >>> from bezsoma.mechanics import Fixed, LinearElastic, Traction
    >>> from bezsoma.mesh.solids import block
    >>> from bezsoma.solvers.solve import solve
    >>> load = Traction("top", value=(0.1, 0, 0))
    >>> body = Body(block(cells=2), 1, LinearElastic(1.0, 0.3), [Fixed("bottom")], [load])
    >>> solution = solve(body)
    >>> [round(float(abs(raised(solution, by).residual).max()), 3) for by in (0, 2)]
    [0.0, 0.009]
    """
    body = _body(solution.body, up(solution.body.degree) if by is None else by)
    threads = threads_asked(threads)
    if not is_linear(body):
        return _nonlinear(solution, body, threads)
    return (_mixed if body.mixed else _displacement)(solution, body, threads)


def _body(body: Body, by: int) -> Body:
    degree = body.degree + by
    if degree > HIGHEST_DEGREE:
        raise InputError(
            f"the error of degree {body.degree} is looked for in degree {degree}, and degrees up "
            f"to {HIGHEST_DEGREE} are built; take a degree of {HIGHEST_DEGREE - by} or less, on a "
            "finer mesh"
        )
    pressure = None if body.pressure_degree is None else body.pressure_degree + by
    return replace(body, degree=degree, pressure_degree=pressure)


@dataclass(frozen=True, eq=False)
class _Applied:
    """The stiffness of a linear body, and the preconditioner of its conjugate gradients."""

    operator: MatrixFree
    held: Bools
    blocks: _core.Multigrid

    def product(self, dx: Floats) -> Floats:
        """K dx (n,)."""
        return np.asarray(self.operator @ dx.reshape(-1, 3)).ravel()

    def solve(self, b: Floats, rtol: float) -> Correction:
        """The free dx (n,)."""
        right = np.where(self.held, 0.0, b.reshape(-1, 3))
        size = float(np.abs(right).max())
        if size == 0:
            return Correction(np.zeros_like(b), 0)
        try:
            x, history = iterated(self.blocks, right / size, rtol, _silent)
        except NotConverged as stopped:
            helps = "Body(..., incompressible=True) where nu is close to 1/2, "
            raise _unfound(stopped, self.operator.net.degree, helps) from stopped
        return Correction(x.ravel() * size, len(history) - 1)


@dataclass(frozen=True, eq=False)
class _AppliedSaddle:
    """The two equations of the mixed form, solved by BiCGStab."""

    operator: MixedFree
    held: Bools
    modes: Floats

    @property
    def split(self) -> int:
        """Where the pressures begin."""
        return 3 * self.operator.net.count

    def product(self, dx: Floats) -> Floats:
        """K dx (n,)."""
        f, g = self.operator.apply(dx[: self.split].reshape(-1, 3), dx[self.split :])
        return np.concatenate([f.ravel(), g])

    def solve(self, b: Floats, rtol: float) -> Correction:
        """The free dx (n,)."""
        size = float(np.abs(b).max())
        if size == 0:
            return Correction(np.zeros_like(b), 0)
        f, g = b[: self.split].reshape(-1, 3) / size, b[self.split :] / size
        f = np.where(self.held, 0.0, f)
        try:
            u, p, history = saddle(self.operator, self.held, f, g, self.modes, rtol, _silent)
        except NotConverged as stopped:
            raise _unfound(stopped, self.operator.net.degree) from stopped
        return Correction(np.concatenate([u.ravel(), p]) * size, len(history) - 1)


def _unfound(stopped: NotConverged, degree: int, helps: str = "") -> NotConverged:
    """Errors are iterated for, whatever solved the solution: another solver is no advice here."""
    return NotConverged(
        f"the error of a solution is looked for by iterations, in degree {degree} here, and "
        f"{counted(len(stopped.history) - 1, 'iteration')} left {stopped.history[-1]:.3g} of the "
        f"residual. What helps: {helps}tets that are less flat (bezsoma mesh info), a lower "
        "degree, materials that differ less",
        stopped.history,
    )


def _silent(iteration: int, residual: float) -> None:
    """The report of those who do not watch."""


def _displacement(solution: Solution, body: Body, threads: int) -> Raised:
    refuse_what_does_not_fit(body, "multigrid")
    net = ControlNet(body.mesh, body.degree)
    known = prescribed(body, net)
    lame = lame_constants(body)
    operator = MatrixFree(net, lame, threads)
    equations = Equations(
        net, operator, forces(body, net), known.mask, known.values, known.of_support
    )
    written = net.elevated(solution.displacement.controls, solution.net)
    start = np.where(known.mask, known.values, written)
    residual = np.where(known.mask, 0.0, equations.residual(start))
    tangent = _Applied(operator, known.mask, preconditioner(operator, known.mask))
    product = displacement_product(net, lame, threads)
    flat = (written.ravel(), start.ravel(), known.mask.ravel(), residual.ravel())
    return Raised(solution, body, net, None, *flat, tangent, product, True, threads)


def _mixed(solution: Solution, body: Body, threads: int) -> Raised:
    refuse_what_does_not_fit(body, "multigrid")
    net, pressures = ControlNet(body.mesh, body.degree), _pressures(body)
    known, moduli = prescribed(body, net), mixed_moduli(body)
    operator = MixedFree(net, pressures, moduli, threads)
    soft = moduli[body.mesh.region, 1] > 0
    modes = undetermined(net, pressures, known.mask, soft)
    written, start = _states(solution, net, pressures, known.mask, known.values)
    f, g = operator.apply(start[: 3 * net.count].reshape(-1, 3), start[3 * net.count :])
    out = np.where(known.mask, 0.0, forces(body, net) - f)
    held = np.concatenate([known.mask.ravel(), np.zeros(pressures.count, dtype=bool)])
    residual = np.concatenate([out.ravel(), -g])
    G, softness = moduli.T
    product = linear_product(net, pressures, np.column_stack([-2 / 3 * G, G, softness]))
    tangent = _AppliedSaddle(operator, known.mask, modes)
    flat = (written, start, held, residual)
    return Raised(solution, body, net, pressures, *flat, tangent, product, True, threads)


def _nonlinear(solution: Solution, body: Body, threads: int) -> Raised:
    net = ControlNet(body.mesh, body.degree)
    known = prescribed(body, net)
    chosen = choice(int(known.mask.size - known.mask.sum()), "auto")
    refuse_what_does_not_fit(body, chosen, linear=False)
    equations = nonlinear_equations(body, net, known)
    exactness = Loading().exactness_for(body.degree)
    form = form_of(body, equations, exactness, chosen, "newton", threads)
    pressures = _pressures(body) if body.mixed else None
    written, start = _states(solution, net, pressures, known.mask, known.values)
    held = form.system.held
    residual = np.where(held, 0.0, form.system.balance(start, 1.0).r)
    tangent = form.system.tangent(start, 1.0)
    product, symmetric = tangent_product(body, net, pressures, exactness, start)
    symmetric = symmetric and not equations.following
    flat = (written, start, held, residual)
    return Raised(solution, body, net, pressures, *flat, tangent, product, symmetric, threads)


def _pressures(body: Body) -> ControlNet:
    assert body.pressure_degree is not None
    return pressure_net(body.mesh, body.pressure_degree, body.pressure_breaks)


def _states(
    solution: Solution, net: ControlNet, pressures: ControlNet | None, held: Bools, given: Floats
) -> tuple[Floats, Floats]:
    """The solution written in a net (n,), and the same with the prescribed values taken anew."""
    u = net.elevated(solution.displacement.controls, solution.net)
    p = np.zeros(0)
    if pressures is not None and solution.pressure is not None:
        p = _pressure(solution.pressure.of_tet, solution.pressure.degree, pressures)
    both = [np.concatenate([each.ravel(), p]) for each in (u, np.where(held, given, u))]
    return both[0], both[1]


def _pressure(of_tet: Floats, degree: int, pressures: ControlNet) -> Floats:
    """The controls (cp,) of a pressure given tet by tet (t, m) in a lower degree."""
    p = np.empty(pressures.count)
    p[pressures.of_tet] = of_tet @ bernstein.elevation(degree, 3, pressures.degree - degree).T
    return p
