# SPDX-License-Identifier: BSD-3-Clause
"""Known problems of elasticity across degrees: what a case file has no words for.

Where a body is faceted the exact solution's own tractions act on its flat facets, so that its
displacement is the exact one: polynomials come back to rounding, others at the full rate.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from itertools import pairwise

import numpy as np
import pytest

import bezsoma as bz
import tolerances
from bezsoma.arrays import Floats
from bezsoma.mechanics.supports import Support
from bezsoma.mesh.solids import cook, round_bar, shell, square_bar
from cases.cook_plane import cook_in_plane_strain
from cases.exact import (
    Exact,
    ThickSphere,
    bending,
    elliptic_torsion,
    flexure,
    square_torsion_constant,
)

SPHERE = ThickSphere(b=1.5)
PLANES = [bz.Fixed(f"{axis}0", components=axis) for axis in "xyz"]


@cache
def sphere(degree: int, cells: int) -> bz.Solution:
    """Lame's sphere; exact displacement on the outer facets, exact tractions on the inner ones."""
    mesh, exact = shell(inner=1, outer=1.5, cells=cells, layers=cells // 2), SPHERE.exact
    held: list[Support] = [*PLANES, bz.Prescribed("outer", value=exact.displacement)]
    loads = exact.traction(mesh, "inner", exactness=2 * degree + 6)
    return bz.solve(bz.Body(mesh, degree, exact.material, held, loads), solver="direct")


def rate(errors: Floats, finer: float) -> float:
    """The power of h by which an error fell when h did by a factor."""
    return float(np.log(errors[0] / errors[1]) / np.log(finer))


@pytest.mark.parametrize(("degree", "cells"), [(1, 8), (2, 4), (3, 4), (4, 4)])
def test_the_sphere_converges_at_full_rate_on_flat_facets(degree: int, cells: int) -> None:
    fields = [sphere(degree, count).displacement for count in (cells, 2 * cells)]
    exactness = 2 * degree + 6
    value = np.array([field.l2_error(SPHERE.displacement, exactness) for field in fields])
    slope = np.array([field.h1_error(SPHERE.gradient, exactness) for field in fields])
    assert rate(value, 2) > degree + 1 - tolerances.RATE_SLACK
    assert rate(slope, 2) > degree - tolerances.RATE_SLACK


def test_pressure_on_flat_facets_stops_the_rate_at_two() -> None:
    """Why the exact tractions are needed: the shape itself errs by h**2, whatever the degree."""
    errors = []
    for cells in (4, 8):
        mesh = shell(inner=1, outer=1.5, cells=cells, layers=cells // 2)
        body = bz.Body(mesh, 3, SPHERE.exact.material, PLANES, [bz.Pressure("inner", value=1)])
        errors.append(bz.solve(body, solver="direct").displacement.l2_error(SPHERE.displacement))
    assert 1.7 < rate(np.array(errors), 2) < 2.3


def test_the_sphere_at_points() -> None:
    """Displacement and stress on rays that are no axes of the mesh."""
    r = np.linspace(1.05, 1.45, 9)
    ray = np.array([2.0, 3.0, 6.0]) / 7
    solution, points = sphere(4, 8), r[:, None] * ray
    u = solution.displacement.at(points)
    assert np.abs(u - SPHERE.radial(r)[:, None] * ray).max() < 2e-5
    stress = solution.stress.averaged().at(points).reshape(-1, 3, 3)
    radial, hoop = SPHERE.stresses(r)
    across = np.array([3.0, -2.0, 0.0]) / np.sqrt(13)
    for direction, expected in ((ray, radial), (across, hoop)):
        found = np.einsum("pij,i,j->p", stress, direction, direction)
        assert np.abs(found - expected).max() < 5e-3
    assert np.abs(np.einsum("pij,i,j->p", stress, ray, across)).max() < 5e-3


@dataclass(frozen=True)
class Bar:
    """A bar with its exact solution, and the least degree that has it."""

    exact: Exact
    half_axes: tuple[float, float]
    degree: int


SOFT, ODD = bz.LinearElastic(E=0.015, nu=0.45), bz.LinearElastic(E=3, nu=0.2)
LENGTH = 4.0
BARS = {
    "bending": Bar(bending(0.02, SOFT), (1, 1), 2),
    "bending, elliptic": Bar(bending(0.02, ODD), (1.5, 0.5), 2),
    "torsion, round": Bar(elliptic_torsion(1, 1, 0.01, SOFT), (1, 1), 2),
    "torsion, elliptic": Bar(elliptic_torsion(1.5, 0.5, 0.01, ODD), (1.5, 0.5), 2),
    "flexure": Bar(flexure(0.001, LENGTH, SOFT), (1, 1), 3),
    "flexure, other nu": Bar(flexure(0.001, LENGTH, ODD), (1, 1), 3),
}


def solved(bar: Bar, degree: int) -> bz.Solution:
    """Exact displacement at the bottom, exact tractions on the flat facets of top and side."""
    a, b = bar.half_axes
    mesh = round_bar(radius=1, length=LENGTH, cells=2, layers=4).moved(np.diag([a, b, 1.0]))
    loads = bar.exact.traction(mesh, "side", "top", exactness=degree + 3)
    held = [bz.Prescribed("bottom", value=bar.exact.displacement)]
    return bz.solve(bz.Body(mesh, degree, bar.exact.material, held, loads), solver="direct")


def largest_error(solution: bz.Solution, exact: Exact) -> tuple[float, float]:
    """Of displacement and stress at points all over the mesh, relative to the largest value."""
    mesh = solution.body.mesh
    points = np.einsum(
        "pi,tid->tpd", np.random.default_rng(3).dirichlet(np.ones(4), 3), mesh.points[mesh.tets]
    ).reshape(-1, 3)
    u, s = exact.displacement(points), exact.stress(points)
    wrong = np.abs(solution.displacement.at(points) - u).max()
    tense = np.abs(solution.stress.at(points) - s).max()
    return float(wrong / np.abs(u).max()), float(tense / np.abs(s).max())


@pytest.mark.parametrize("more", [0, 1])
@pytest.mark.parametrize("name", BARS)
def test_a_faceted_bar_gives_back_a_polynomial_solution(name: str, more: int) -> None:
    bar = BARS[name]
    displacement, stress = largest_error(solved(bar, bar.degree + more), bar.exact)
    assert displacement < 1e-11  # a slender bar at nu = 0.45: rounding grows with the condition
    assert stress < 1e-10


@pytest.mark.parametrize("name", BARS)
def test_a_degree_too_low_is_seen(name: str) -> None:
    bar = BARS[name]
    displacement, _ = largest_error(solved(bar, bar.degree - 1), bar.exact)
    assert 1e-4 < displacement < 1


@pytest.mark.parametrize("name", ["torsion, round", "torsion, elliptic"])
def test_the_moment_of_a_twisted_bar_is_that_of_its_polygon(name: str) -> None:
    """And comes to G t pi a**3 b**3 / (a**2 + b**2) as the polygon comes to the ellipse."""
    bar = BARS[name]
    solution = solved(bar, 2)
    a, b = bar.half_axes
    mesh = solution.body.mesh
    x, y = np.moveaxis(mesh.points[mesh.facets_of("bottom")][:, :, :2], 2, 0)
    areas = mesh.areas(mesh.facets_of("bottom"))
    xx, yy = (areas @ ((w.sum(1) ** 2 + (w**2).sum(1)) / 12) for w in (x, y))
    factor = 2 * bar.exact.material.mu * 0.01 / (a**2 + b**2)
    moment = solution.reactions["bottom"].moment
    assert moment[2] == pytest.approx(-factor * (b**2 * xx + a**2 * yy), rel=1e-11)
    smooth = factor * np.pi * a**3 * b**3 / 2
    assert -moment[2] == pytest.approx(smooth, rel=0.2)  # eight sides: 1 - sin(a)(2 + cos(a))/3a


@cache
def twisted_square(degree: int, cells: int) -> float:
    """J / a**4 of a bar of side 1 and G = 1, twisted by 1 rad/mm with its ends free to warp."""
    mesh = square_bar(width=1, length=0.5, cells=cells, layers=1)
    turn = bz.Polynomial.parse(["-0.5*y", "0.5*x", 0])
    held: list[Support] = [
        bz.Fixed("bottom", components="xy"),
        bz.Prescribed("top", value=turn, components="xy"),
        bz.Fixed("centre", components="z"),
    ]
    mesh = mesh.with_vertices("centre", [(0.0, 0.0, 0.0)])
    body = bz.Body(mesh, degree, bz.LinearElastic(E=2.5, nu=0.25), held)
    return float(bz.solve(body, solver="direct").reactions["top"].moment[2])


@pytest.mark.parametrize(
    ("degree", "error"), [(1, 0.9), (2, 4e-3), (3, 2e-4), (4, 2e-5), (5, 3e-6), (6, 1e-6)]
)
def test_the_torsion_constant_of_a_square_is_met_from_above(degree: int, error: float) -> None:
    exact = square_torsion_constant()
    assert exact == pytest.approx(0.1406, abs=3e-5)
    assert 0 < twisted_square(degree, 4) / exact - 1 < error


def test_the_torsion_constant_improves_with_the_mesh() -> None:
    exact = square_torsion_constant()
    errors = [twisted_square(2, cells) / exact - 1 for cells in (2, 4, 8)]
    assert rate(np.array(errors[1:]), 2) > 3.5  # energies converge at 2 k = 4


@cache
def slab(degree: int, cells: int, nu: float) -> bz.Solution:
    """Cook's membrane, 1 mm thick, loaded by 1 N, E = 1 MPa."""
    mesh = cook(cells=(cells, cells, 1), thickness=48 / cells)
    return bz.solve(
        bz.Body(
            mesh,
            degree,
            bz.LinearElastic(E=1, nu=nu),
            [bz.Fixed("clamped"), bz.Fixed("front", "back", components="z")],
            [bz.Traction("loaded", value=(0, 1 / 16, 0))],
        ),
        solver="direct",
    )


def energy(degree: int, cells: int, nu: float) -> float:
    """Of one mm of thickness, N mm."""
    return slab(degree, cells, nu).energy * cells / 48


def test_the_reference_of_cooks_membrane_is_what_another_code_gives() -> None:
    """With eight layers to the corners; sixteen give the 22.6105 mm that the case expects."""
    plane = cook_in_plane_strain(lam=0.75, mu=0.375, layers=8)
    assert plane.corner == pytest.approx(22.6105, rel=2e-4)
    assert plane.middle == pytest.approx(21.5246, rel=5e-5)
    assert plane.energy == pytest.approx(10.79511, rel=5e-5)


@pytest.mark.parametrize(("nu", "exact"), [(1 / 3, 10.79511), (0.4999, 9.28361)])
def test_cooks_membrane_is_stiffer_than_it_is_and_less_so_with_every_degree(
    nu: float, exact: float
) -> None:
    lacking = [1 - energy(degree, 8, nu) / exact for degree in (1, 2, 3, 4)]
    assert all(0 < finer < coarser for coarser, finer in pairwise(lacking))
    assert lacking[-1] < 0.01


def test_high_degrees_do_not_lock() -> None:
    """At nu = 0.4999 linear tets lack three quarters of the energy, quartic ones a hundredth."""
    assert 1 - energy(1, 8, 0.4999) / 9.28361 > 0.7
    assert 1 - energy(4, 8, 0.4999) / 9.28361 < 0.01


def test_the_slab_is_plane() -> None:
    """With u_z = 0 on both sides nothing moves across, in the limit."""
    part = []
    for degree in (2, 3, 4):
        u = slab(degree, 8, 1 / 3).displacement
        part.append(bz.Field(u.net, u.controls[:, 2]).l2_norm() / u.l2_norm())
    assert part[2] < part[1] < part[0] < 1e-4
