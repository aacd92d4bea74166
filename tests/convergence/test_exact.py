# SPDX-License-Identifier: BSD-3-Clause
"""A polynomial displacement of degree k comes back from a body of degree k, whatever holds it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pytest

import bezsoma as bz
from bezsoma import bernstein
from bezsoma.mesh import TetMesh, ball, block
from convergence.polynomials import Floats, PolynomialField, formula, values
from tolerances import patch

NUS = (0.0, 0.3, 0.45, -0.3)


def few(seed: int = 1) -> TetMesh:
    """Four irregular tets around an edge: small enough for degree 10."""
    rng = np.random.default_rng(seed)
    ring = [[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0]]
    points = np.array([[0, 0, -1], [0, 0, 1], *ring]) + rng.uniform(-0.2, 0.2, (6, 3))
    return TetMesh(points, [[0, 1, 2 + i, 2 + (i + 1) % 4] for i in range(4)])


def brick() -> TetMesh:
    """Irregular tets in two regions."""
    mesh = block(size=(1.5, 1, 1), cells=(2, 2, 1), origin=(-0.7, -0.5, -0.5), irregular=0.3)
    return TetMesh(mesh.points, mesh.tets, np.arange(len(mesh.tets)) % 2, ("one", "other"))


MESHES = {"few": few, "brick": brick, "ball": lambda: ball(cells=1)}


def in_pieces(mesh: TetMesh) -> TetMesh:
    """The mesh with every facet of its boundary a surface of its own, named by its number."""
    for number, facet in enumerate(mesh.boundary):
        mesh = mesh.with_surface(f"facet {number}", facet[None])
    return mesh


def body(mesh: TetMesh, field: PolynomialField, degree: int, law: bz.LinearElastic) -> bz.Body:
    """Of four facets one prescribed, one in its z component only; exact tractions elsewhere.

    On a facet with its z component prescribed the traction acts in all components: what it does
    to z goes into the reaction and must not show.
    """
    mesh = in_pieces(mesh)
    held, slid = list(range(0, len(mesh.boundary), 4)), list(range(1, len(mesh.boundary), 4))
    u = formula(*field.u)
    supports = [bz.Prescribed(*(f"facet {i}" for i in held), value=u)]
    supports += [bz.Prescribed(*(f"facet {i}" for i in slid), value=u, components="z")]
    normals = mesh.normals(mesh.boundary)
    loads = [
        bz.Traction(f"facet {i}", value=formula(*field.traction(normals[i])))
        for i in range(len(mesh.boundary))
        if i not in held
    ]
    loads += [bz.BodyForce(formula(*field.body_force))]
    laws = dict.fromkeys(mesh.regions, law)
    return bz.Body(mesh, degree, laws, supports, loads)


@dataclass(frozen=True, eq=False)
class Case:
    """A field, the body that it should come back from, and what did."""

    field: PolynomialField
    solution: bz.Solution

    @cached_property
    def bary(self) -> Floats:
        """Points (b, 4) inside every tet."""
        return bernstein.simplex(7, 3)[0]

    @cached_property
    def points(self) -> Floats:
        """Where they lie (t b, 3)."""
        mesh = self.solution.body.mesh
        return (self.bary @ mesh.points[mesh.tets]).reshape(-1, 3)

    def flux(self, facets: Floats, of: Callable[[Floats, Floats], Floats]) -> Floats:
        """The integral over facets (f, 3) of a function of points and unit outward normals."""
        mesh = self.solution.body.mesh
        bary, weights = bernstein.simplex(2 * self.solution.net.degree, 2)
        points = (bary @ mesh.points[facets]).reshape(-1, 3)
        normals = np.repeat(mesh.normals(facets), len(bary), axis=0)
        measure = (mesh.areas(facets)[:, None] * weights).ravel()
        return np.tensordot(measure, of(points, normals), (0, 0))


def apart(found: Floats, wanted: Floats) -> float:
    """The largest difference, relative to the largest that is wanted."""
    return float(np.abs(found.reshape(wanted.shape) - wanted).max() / np.abs(wanted).max())


CASES = [
    *(("few", k, nu) for k in range(1, 9) for nu in NUS),
    *(("few", 9, 0.45), *(("few", 10, nu) for nu in NUS)),
    *(("ball", k, nu) for k in range(1, 7) for nu in (0.0, 0.45)),
    ("ball", 8, 0.45),
    *(("brick", k, -0.3) for k in range(1, 6)),
]


@pytest.fixture(scope="module", params=CASES, ids=lambda case: "{}, degree {}, nu {}".format(*case))
def case(request: pytest.FixtureRequest) -> Case:
    name, degree, nu = request.param
    law = bz.LinearElastic(E=0.02, nu=nu)
    field = PolynomialField.random(degree, law)
    given = body(MESHES[name](), field, degree, law)
    return Case(field, bz.solve(given, solver="direct"))


def test_displacement_comes_back(case: Case) -> None:
    found = case.solution.displacement
    assert apart(found.tabulated(case.bary), case.field.at(case.points)) < patch(found.degree)


def test_stress_comes_back(case: Case) -> None:
    found = case.solution.stress
    assert apart(found.tabulated(case.bary), case.field.stress_at(case.points)) < patch(
        found.degree + 1
    )


def test_stress_is_in_equilibrium(case: Case) -> None:
    """div stress + f = 0 inside every tet. Two derivatives cost another factor of degree^2."""
    degree = case.solution.net.degree
    if degree == 1:
        assert case.solution.stress.degree == 0  # constant: nothing to be in equilibrium with
        return
    tets = np.repeat(np.arange(len(case.solution.body.mesh.tets)), len(case.bary))
    bary = np.tile(case.bary, (len(case.points) // len(case.bary), 1))
    gradient = case.solution.stress.gradient_bary(tets, bary)
    wanted = values(case.field.body_force, case.points)
    assert apart(-np.trace(gradient, axis1=2, axis2=3), wanted) < 10 * patch(degree)


def test_energy_is_that_of_the_field(case: Case) -> None:
    """int stress : grad u / 2, by quadrature of the exact field."""
    mesh, degree = case.solution.body.mesh, case.solution.net.degree
    bary, weights = bernstein.simplex(2 * degree, 3)
    points = (bary @ mesh.points[mesh.tets]).reshape(-1, 3)
    H = case.field.gradient_at(points)
    density = np.einsum("pkl,pkl->p", case.field.stress_at(points), H) / 2
    wanted = (mesh.volumes[:, None] * weights).ravel() @ density
    assert case.solution.energy == pytest.approx(wanted, rel=patch(degree))


def test_volume_change_is_the_flux_through_the_boundary(case: Case) -> None:
    """int div u dV = int u . n dS (Gauss), the right side from the exact field."""
    mesh = case.solution.body.mesh
    flux = case.flux(mesh.boundary, lambda x, n: (case.field.at(x) * n).sum(axis=1))
    size = np.abs(case.field.at(mesh.points)).max() * mesh.areas(mesh.boundary).sum()
    assert abs(case.solution.volume_change - flux) < patch(case.solution.net.degree) * size


def test_reactions_are_the_stress_where_no_load_acts(case: Case) -> None:
    """All reactions together are int stress n dS over the held facets, and so is the moment.

    On the facets with z held the traction is applied as a load too, and nothing is left of it.
    """
    mesh = case.solution.body.mesh
    held = mesh.boundary[::4]

    def pull(x: Floats, n: Floats) -> Floats:
        t = np.einsum("pkl,pl->pk", case.field.stress_at(x), n)
        return np.stack([t, np.cross(x, t)], axis=1)

    wanted = case.flux(held, pull)
    parts = case.solution.reactions.values()
    found = np.array([sum(r.force for r in parts), sum(r.moment for r in parts)])
    size = np.abs(case.field.stress_at(mesh.points)).max() * mesh.areas(held).sum()
    assert np.abs(found - wanted).max() < patch(case.solution.net.degree) * size
