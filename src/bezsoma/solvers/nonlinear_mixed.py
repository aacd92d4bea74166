# SPDX-License-Identifier: BSD-3-Clause
"""A body of any law with a pressure of its own: the same iteration, with u and p as unknowns."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.sparse import block_diag, csc_array, csr_array

from bezsoma import bernstein
from bezsoma.arrays import Bools, Floats, frozen
from bezsoma.equations.ellipticity import lost_beside_pressure
from bezsoma.equations.enclosed import refuse_changed_volume
from bezsoma.equations.internal import core_law
from bezsoma.equations.level import undetermined, without_mean
from bezsoma.equations.locked import refuse_undetermined
from bezsoma.equations.matrix_free import MatrixFree, met
from bezsoma.equations.mixed import pressure_mass
from bezsoma.equations.mixed_pointwise import MixedPointwise
from bezsoma.equations.mixed_pointwise_free import PointwiseMixed
from bezsoma.equations.nonlinear import NonlinearEquations
from bezsoma.errors import InputError, NotConverged
from bezsoma.mechanics.body import Body
from bezsoma.mechanics.laws import FunctionLaw, MixedLaw, shear_at_rest
from bezsoma.mechanics.materials import LinearElastic
from bezsoma.mesh.torn import pressure_net
from bezsoma.solvers.factors import Waiting, factored
from bezsoma.solvers.gmres import minimal_residual
from bezsoma.solvers.multigrid import preconditioned
from bezsoma.solvers.newton import Balance, Breakdown, Correction, Linearised, System, extent
from bezsoma.solvers.start import State, first_displacement, first_pressure
from bezsoma.solvers.tangents import Factored

MOST_PRODUCTS = 600


@dataclass(frozen=True, eq=False)
class MixedProblem:
    """The equations, what works out internal forces, and the pressures that nothing determines.

    x (3c + cp,) holds the displacement and then the pressure. `modes` are constants that do no
    work; one control of each is held at zero, and the mean taken off in the end.
    """

    equations: NonlinearEquations
    internal: MixedPointwise
    fast: MixedPointwise | PointwiseMixed
    """The same, compiled where the core has all the laws."""
    modes: Floats
    stiffness: Floats
    """The shear modulus of each region near rest, MPa."""

    @property
    def split(self) -> int:
        """Where the pressures begin."""
        return 3 * self.equations.net.count

    @property
    def held(self) -> Bools:
        """What is not unknown (3c + cp,)."""
        pinned = np.zeros(self.internal.pressure_net.count, dtype=bool)
        for mode in self.modes:
            pinned[np.flatnonzero(mode)[0]] = True
        return np.concatenate([self.equations.held.ravel(), pinned])

    @property
    def weight(self) -> float:
        """Takes a volume that is out of balance, mm3, to a force: G over the size of a tet."""
        mesh = self.equations.net.mesh
        return float(met(self.stiffness, mesh.region).mean()) / mesh.mean_size

    def parted(self, x: Floats) -> tuple[Floats, Floats]:
        """U (c, 3) and p (cp,)."""
        return x[: self.split].reshape(-1, 3), x[self.split :]

    def balance(self, x: Floats, fraction: float) -> Balance:
        """What is out of balance: forces against forces, volumes against the volume there is."""
        u, p = self.parted(x)
        f, g = self.fast.forces(u, p)
        F, R = f.ravel(), self.equations.applied(u, fraction).ravel()
        work = max(abs(float(np.einsum("i,i->", force, u.ravel()))) for force in (F, R))
        net = self.internal.pressure_net
        m = net.of_tet.shape[1]
        own = np.repeat(net.mesh.volumes / m, m)
        volumes = np.bincount(net.of_tet.ravel(), own, net.count).astype(np.float64)
        references = (max(extent(F), extent(R)), extent(volumes))
        return Balance(np.concatenate([R - F, -g]), references, work)

    def given(self, fraction: float) -> Floats:
        """What is prescribed (3c + cp,)."""
        u = self.equations.given(fraction).ravel()
        return np.concatenate([u, np.zeros(self.internal.pressure_net.count)])

    def begun(self, start: State) -> Floats:
        """An earlier solution as x (3c + cp,); where a level is held at zero, with that level."""
        net = self.internal.pressure_net
        p = first_pressure(start, net, self.equations.net.mesh)
        for mode in self.modes:
            pinned = np.flatnonzero(mode)[0]
            p = p - mode * (p[pinned] / mode[pinned])
        u = first_displacement(start, self.equations.net)
        return np.concatenate([u.ravel(), p])

    def system(self, tangent: Callable[[Floats, float], Linearised]) -> System:
        """What Newton has to know."""
        parts = (slice(0, self.split), slice(self.split, None))
        return System(
            self.held,
            parts,
            (1.0, self.weight),
            self.given,
            self.balance,
            tangent,
            lambda x: lost_beside_pressure(self.internal, *self.parted(x)),
        )


def mixed_problem(
    body: Body, equations: NonlinearEquations, exactness: int, threads: int
) -> MixedProblem:
    """The problem of a body with a pressure."""
    assert body.pressure_degree is not None
    laws = tuple(beside_pressure(law) for law in body.material_of_region)
    net = equations.net
    pressures = pressure_net(body.mesh, body.pressure_degree, body.pressure_breaks)
    soft = np.array([np.isfinite(kappa_of(law)) for law in body.material_of_region])
    soft = soft[body.mesh.region]
    modes = undetermined(net, pressures, equations.held, soft)
    refuse_undetermined(net, pressures, equations.held, soft, modes)
    refuse_changed_volume(net, pressures, modes, laws, equations.known.values)
    stiffness = frozen(np.array([shear_at_rest(law) for law in laws]))
    _refuse_unfit(body, stiffness)
    internal = MixedPointwise(net, pressures, laws, exactness)
    fast = _fast(internal, body, threads)
    return MixedProblem(equations, internal, fast, modes, stiffness)


def _refuse_unfit(body: Body, stiffness: Floats) -> None:
    """Refuse a law whose shear modulus, MPa, has left the range of numbers."""
    for region, law, G in zip(body.mesh.regions, body.material_of_region, stiffness, strict=True):
        if not np.isfinite(G):
            raise InputError(
                f"region {region!r} is {law!r}, whose shear modulus is no finite number at rest: "
                "its parameters leave the range of numbers; give others"
            )


def _fast(internal: MixedPointwise, body: Body, threads: int) -> MixedPointwise | PointwiseMixed:
    laws = [core_law(law, mixed=True) for law in body.material_of_region]
    known = tuple(law for law in laws if law is not None)
    if len(known) < len(laws):
        return internal
    rule = bernstein.simplex(internal.exactness, 3)
    return PointwiseMixed(internal.net, internal.pressure_net, known, *rule, threads)


def beside_pressure(law: object) -> MixedLaw:
    """The law as it stands beside a pressure: linear elasticity without its volume part."""
    if isinstance(law, LinearElastic):
        return FunctionLaw(
            law.deviatoric_stress,
            derivative=lambda H, dH: law.deviatoric_stress(dH),
            energy=lambda H: np.einsum("...ij,...ij->...", law.deviatoric_stress(H), H) / 2,
            finite=False,
            kappa=law.kappa,
        )
    if not isinstance(law, MixedLaw):
        raise InputError(
            f"{law!r} does not split into a shape and a volume, so it cannot stand beside a "
            "pressure; leave pressure_degree out, or give FunctionLaw a kappa"
        )
    return law


def kappa_of(law: object) -> float:
    """The bulk modulus, MPa; infinite for an incompressible law."""
    if getattr(law, "nu", 0.0) == 0.5:
        return np.inf
    kappa = getattr(law, "kappa", None)
    return 1.0 if kappa is None else float(kappa)


def factored_mixed(
    problem: MixedProblem, waiting: Waiting | None
) -> Callable[[Floats, float], Linearised]:
    """What gives the tangent at x and a fraction of the load, as a matrix."""
    free, weight = np.flatnonzero(~problem.held), problem.weight
    cp = problem.internal.pressure_net.count
    scale = np.concatenate([np.ones(problem.split), np.full(cp, weight)])

    def at(x: Floats, fraction: float) -> Linearised:
        with np.errstate(over="ignore", invalid="ignore"):  # `Factored` says so
            matrix = problem.internal.matrix(*problem.parted(x))
        follow = problem.equations.follow(problem.parted(x)[0], fraction)
        if follow is not None:
            matrix = csr_array(matrix - block_diag([follow, csr_array((cp, cp))]))
        return Factored(matrix, free, scale, waiting)

    return at


@dataclass(frozen=True, eq=False)
class AppliedMixed:
    """A tangent that is only applied; preconditioned by blocks of the linear law.

    z_p = - M^-1 r_p, z_u = A^-1 (r_u - B^T z_p): M is the pressure's mass over G, which the Schur
    complement is like, A the linear law's multigrid.
    """

    problem: MixedProblem
    x: Floats
    follow: csr_array | None
    blocks: Callable[[Floats], Floats]
    mass: Callable[[Floats], Floats]

    def product(self, dx: Floats) -> Floats:
        """K dx (n,)."""
        tangent = self.problem.fast.tangent(*self.problem.parted(self.x))
        f, g = tangent.apply(*self.problem.parted(dx))
        f = f.ravel()
        if self.follow is not None:
            f = f - self.follow @ dx[: self.problem.split]
        return np.concatenate([f, g])

    def solve(self, b: Floats, rtol: float) -> Correction:
        """The free dx (n,), by GMRES."""
        held, weight, split = self.problem.held, self.problem.weight, self.problem.split
        scale = np.concatenate([np.ones(split), np.full(len(b) - split, weight)])

        def apply(x: Floats) -> Floats:
            return np.where(held, 0.0, scale * self.product(scale * x))

        def precondition(r: Floats) -> Floats:
            p = -self.mass(r[split:] / weight) / weight
            up = np.where(held, 0.0, np.concatenate([np.zeros(split), p]))
            left = r[:split] - np.where(held[:split], 0.0, self.product(scale * up)[:split])
            u = self.blocks(left.reshape(-1, 3)).ravel()
            return np.where(held, 0.0, np.concatenate([u, p]))

        try:
            y, count = minimal_residual(apply, precondition, scale * b, rtol, MOST_PRODUCTS)
        except NotConverged as failure:
            raise Breakdown(str(failure)) from failure
        except MemoryError as full:
            raise _mass_too_large(len(b) - split) from full
        return Correction(scale * y, count)


def applied(
    problem: MixedProblem, threads: int, waiting: Waiting | None
) -> Callable[[Floats, float], Linearised]:
    """What gives the tangent at x and a fraction of the load, without a matrix."""
    net, pressures = problem.equations.net, problem.internal.pressure_net
    G = problem.stiffness
    operator = MatrixFree(net, frozen(np.stack([G, G], axis=1)), threads)
    blocks = preconditioned(operator, problem.equations.held)
    whole = csc_array(pressure_mass(pressures, 1 / G[net.mesh.region]))
    try:
        mass = factored(whole, waiting)
    except MemoryError as full:
        raise _mass_too_large(pressures.count) from full

    def at(x: Floats, fraction: float) -> Linearised:
        follow = problem.equations.follow(problem.parted(x)[0], fraction)
        return AppliedMixed(problem, x, follow, blocks, mass)

    return at


def _mass_too_large(pressures: int) -> InputError:
    return InputError(
        f"the mass of {pressures} pressures is more than can be factored, held or counted; take a "
        "lower degree or a coarser mesh"
    )


def level(problem: MixedProblem, p: Floats) -> Floats:
    """The pressure (cp,) with mean zero where its level is not determined."""
    return without_mean(p, problem.modes, problem.internal.pressure_net)
