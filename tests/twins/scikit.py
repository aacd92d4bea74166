# SPDX-License-Identifier: BSD-3-Clause
"""The same body by scikit-fem: its elements, its assembly, its quadrature, SciPy's solver.

Nothing of BezSoma is imported here. The elements are Lagrange's of degree 1 and 2, of which the
unknowns are values at points; the space of functions is the same, so the answer has to be.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import numpy.typing as npt
from scipy.sparse import csc_matrix, csr_matrix
from scipy.sparse.linalg import splu
from skfem import (
    Basis,
    BilinearForm,
    ElementTetP1,
    ElementTetP2,
    ElementVector,
    FacetBasis,
    Functional,
    LinearForm,
    MeshTet,
)

Floats = npt.NDArray[np.float64]
Where = Callable[[Floats], npt.NDArray[np.bool_]]
"""Which of points (p, 3) lie on a place."""
Push = Callable[[Floats, Floats], Floats]
"""Force on an area or a volume (p, 3) at points (p, 3) with outward normals (p, 3)."""

EXACTNESS = 8
"""What scikit-fem's rules integrate exactly here: loads have degree 3 and less, elements 2."""


@dataclass(frozen=True)
class Held:
    """A support: the values (p, 3) of components on facets, or on the line or points `where`."""

    place: str
    where: Where
    value: Callable[[Floats], Floats]
    components: str = "xyz"
    facets: bool = True


@dataclass(frozen=True)
class Surface:
    """A load on the facets whose corners lie `where`; on the boundary, or between tets."""

    where: Where
    push: Push
    boundary: bool = True


@dataclass(frozen=True)
class Volume:
    """A load on the tets of one region, or of all."""

    push: Push
    region: int | None = None


@dataclass(frozen=True)
class Point:
    """A force at the vertex that lies at a point."""

    at: tuple[float, float, float]
    force: tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class Twin:
    """Linear elasticity on points (v, 3) and tets (t, 4); region (t,) counts the `moduli`, (E, nu).

    All that is compared follows from `displacement`, one number for each unknown.
    """

    points: Floats
    tets: npt.NDArray[np.int64]
    region: npt.NDArray[np.int64]
    degree: int
    moduli: Sequence[tuple[float, float]]
    supports: Sequence[Held]
    loads: Sequence[Surface | Volume | Point] = ()
    held_by: dict[str, npt.NDArray[np.int64]] = field(default_factory=dict)

    @cached_property
    def mesh(self) -> MeshTet:
        """The mesh, every tet turned the way that scikit-fem draws its own."""
        corners = self.points[self.tets]
        turned = np.linalg.det(corners[:, 1:] - corners[:, :1]) < 0
        tets = np.where(turned[:, None], self.tets[:, [1, 0, 2, 3]], self.tets)
        return MeshTet(self.points.T.copy(), tets.T.copy())

    @cached_property
    def basis(self) -> Basis:
        """Vector Lagrange elements."""
        return Basis(self.mesh, self.element, intorder=EXACTNESS)

    @property
    def element(self) -> ElementVector:
        """The element, of degree 1 or 2."""
        return ElementVector(ElementTetP1() if self.degree == 1 else ElementTetP2())

    @cached_property
    def lame(self) -> tuple[Floats, Floats]:
        """Lambda and mu (t, 1), from E and nu by the textbook."""
        E, nu = np.array(self.moduli, dtype=float)[self.region].T[:, :, None]
        return E * nu / (1 + nu) / (1 - 2 * nu), E / 2 / (1 + nu)

    @cached_property
    def stiffness(self) -> csr_matrix:
        """K from lambda div u div v + 2 mu eps(u) : eps(v)."""
        lam, mu = (np.repeat(m, self.basis.dx.shape[1], axis=1) for m in self.lame)

        @BilinearForm
        def work(u, v, w):  # type: ignore[no-untyped-def]
            eps = (u.grad + np.swapaxes(u.grad, 0, 1)) / 2
            return w.lam * np.trace(u.grad) * np.trace(v.grad) + 2 * w.mu * np.einsum(
                "ijtq,ijtq->tq", eps, v.grad
            )

        return work.assemble(self.basis, lam=lam, mu=mu).tocsr()

    @cached_property
    def forces(self) -> Floats:
        """The forces of all loads on the unknowns."""
        return sum((self._forces(load) for load in self.loads), np.zeros(self.basis.N))

    def _forces(self, load: Surface | Volume | Point) -> Floats:
        if isinstance(load, Point):
            at = np.isclose(self.basis.doflocs.T, load.at, rtol=0, atol=1e-12).all(axis=1)
            found = np.zeros(self.basis.N)
            found[at] = load.force
            return found
        if isinstance(load, Volume):
            where = None if load.region is None else np.flatnonzero(self.region == load.region)
            basis = Basis(self.mesh, self.element, intorder=EXACTNESS, elements=where)
        else:
            facets = self.facets(load.where, load.boundary)
            basis = FacetBasis(self.mesh, self.element, intorder=EXACTNESS, facets=facets)

        @LinearForm
        def work(v, w):  # type: ignore[no-untyped-def]
            x = np.moveaxis(w.x, 0, -1)
            n = np.moveaxis(w.n, 0, -1) if isinstance(load, Surface) else x
            pushed = load.push(x.reshape(-1, 3), n.reshape(-1, 3)).reshape(x.shape)
            return np.einsum("itq,tqi->tq", v, pushed)

        return work.assemble(basis)

    def facets(self, where: Where, boundary: bool = True) -> npt.NDArray[np.int64]:
        """The facets with all corners on a place."""
        on = where(self.points)[self.mesh.facets].all(axis=0)
        of_boundary = np.isin(np.arange(len(on)), self.mesh.boundary_facets())
        return np.flatnonzero(on & (of_boundary == boundary))

    @cached_property
    def displacement(self) -> Floats:
        """The unknowns; those that a support holds are its values where they lie."""
        x = np.zeros(self.basis.N)
        free = np.ones(self.basis.N, dtype=bool)
        for held in self.supports:
            for axis in held.components:
                numbers = self._unknowns(held, "xyz".index(axis))
                new = numbers[free[numbers]]
                values = held.value(self.basis.doflocs.T[new])
                x[new] = values[:, "xyz".index(axis)]
                free[new] = False
                before = self.held_by.get(held.place, np.zeros(0, np.int64))
                self.held_by[held.place] = np.concatenate([before, new])
        factors = splu(csc_matrix(self.stiffness[free][:, free]))
        for _ in range(3):  # the first solves, the others take rounding away
            x[free] += factors.solve((self.forces - self.stiffness @ x)[free])
        return x

    def _unknowns(self, held: Held, axis: int) -> npt.NDArray[np.int64]:
        if held.facets:
            dofs = self.basis.get_dofs(self.facets(held.where))
            return np.asarray(dofs.all(f"u^{axis + 1}"))
        on = np.flatnonzero(held.where(self.basis.doflocs.T))
        return np.intersect1d(on, self.basis.get_dofs(elements=True).all(f"u^{axis + 1}"))

    # What is compared ------------------------------------------------------------------------

    @cached_property
    def probe(self) -> Basis:
        """The basis at the centroid and near the corners of each tet, never on a face.

        On a face a stress has two values; many a rule of quadrature has points there.
        """
        X = np.vstack([np.full(3, 0.25), 0.7 * np.eye(4, 3) + 0.1 - 0.02 * np.arange(3)]).T
        return Basis(self.mesh, self.element, quadrature=(X, np.full(5, 1 / 30)))

    @property
    def samples(self) -> Floats:
        """Points (t, q, 3) inside every tet."""
        return np.moveaxis(np.asarray(self.probe.global_coordinates()), 0, -1)

    @property
    def sampled(self) -> Floats:
        """The displacement (t, q, 3) there."""
        return np.moveaxis(np.asarray(self.probe.interpolate(self.displacement)), 0, -1)

    @property
    def gradient(self) -> Floats:
        """Its gradient (t, q, 3, 3) there, H_kl = du_k/dx_l."""
        return np.moveaxis(self.probe.interpolate(self.displacement).grad, (0, 1), (-2, -1))

    @property
    def stress(self) -> Floats:
        """The stress (t, q, 3, 3) there."""
        eps = (self.gradient + np.swapaxes(self.gradient, -1, -2)) / 2
        lam, mu = (modulus[:, :, None, None] for modulus in self.lame)
        return lam * np.trace(eps, axis1=2, axis2=3)[..., None, None] * np.eye(3) + 2 * mu * eps

    @property
    def energy(self) -> float:
        """The stored energy, u.K u / 2."""
        return float(self.displacement @ (self.stiffness @ self.displacement)) / 2

    @property
    def volume_change(self) -> float:
        """Int div u."""
        divergence = Functional(lambda w: np.trace(w["u"].grad))
        return float(divergence.assemble(self.basis, u=self.displacement))

    def reaction(self, *places: str) -> tuple[Floats, Floats]:
        """Force (3,) and moment (3,) about the origin of supports, all of them unless named."""
        pull = self.stiffness @ self.displacement - self.forces
        x, f = np.zeros((2, self.basis.N, 3))
        for place in places or self.held_by:
            on = self.held_by[place]
            x[on] = self.basis.doflocs.T[on]
            f[on, self.axis[on]] = pull[on]
        return f.sum(axis=0), np.cross(x, f).sum(axis=0)

    @cached_property
    def axis(self) -> npt.NDArray[np.int64]:
        """Which component each unknown is."""
        axis = np.zeros(self.basis.N, dtype=np.int64)
        for k in range(3):
            axis[self.basis.get_dofs(elements=True).all(f"u^{k + 1}")] = k
        return axis
