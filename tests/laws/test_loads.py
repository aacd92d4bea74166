# SPDX-License-Identifier: BSD-3-Clause
"""From loads to forces on controls (eq. 35): sums, moments, work, against exact fractions."""

from __future__ import annotations

from fractions import Fraction
from math import factorial

import numpy as np
import pytest

from bezsoma.equations.forces import forces
from bezsoma.mechanics import (
    Body,
    BodyForce,
    LinearElastic,
    PointForce,
    Polynomial,
    Pressure,
    Traction,
)
from bezsoma.mechanics.formulas import Terms, formula
from bezsoma.mesh.control_net import ControlNet
from bezsoma.mesh.solids import block
from bezsoma.mesh.tets import TetMesh
from tolerances import CLOSED_FORM, ROUNDING

TISSUE = LinearElastic(E=0.015, nu=0.45)
SKEW = np.array([[1.0, 0.25, 0], [0, 1.5, -0.5], [0.5, 0, 0.75]])


def skewed(cells: tuple[int, int, int] = (2, 1, 1)) -> TetMesh:
    """An irregular block that no coordinate plane bounds."""
    return block(size=(2, 1, 1), cells=cells, irregular=0.4, seed=3).moved(SKEW, (3, -1, 2))


def loaded(mesh: TetMesh, degree: int, *loads: object) -> tuple[np.ndarray, ControlNet]:
    net = ControlNet(mesh, degree)
    return forces(Body(mesh, degree, TISSUE, [], loads), net), net


# An integral over a simplex in fractions, sharing no line with what is tested ---------------

Sum = dict[tuple[int, ...], Fraction]


def times(a: Sum, b: Sum) -> Sum:
    result: Sum = {}
    for p, c in a.items():
        for q, d in b.items():
            powers = tuple(i + j for i, j in zip(p, q, strict=True))
            result[powers] = result.get(powers, Fraction(0)) + c * d
    return result


def mean_over(terms: Terms, corners: np.ndarray) -> Fraction:
    """The mean of a polynomial over the simplex with these corners (d + 1, 3).

    Each coordinate is sum_i L_i corner_i; the mean of L^a is d! a! / (|a| + d)!.
    """
    dim = len(corners) - 1
    unit = [tuple(int(i == j) for j in range(dim + 1)) for i in range(dim + 1)]
    coordinate = [
        {unit[i]: Fraction(float(corners[i, axis])) for i in range(dim + 1)} for axis in range(3)
    ]
    mean = Fraction(0)
    for powers, coefficient in terms:
        form: Sum = {(0,) * (dim + 1): Fraction(1)}
        for axis, power in enumerate(powers):
            for _ in range(power):
                form = times(form, coordinate[axis])
        for a, value in form.items():
            top = factorial(dim) * np.prod([factorial(i) for i in a], dtype=object)
            mean += coefficient * value * Fraction(int(top), factorial(sum(a) + dim))
    return mean


def work_of(
    force: list[str], motion: list[str], corners: np.ndarray, measures: np.ndarray
) -> float:
    """int force . motion, exact but for the measures of the simplices."""
    product = formula(" + ".join(f"({f})*({m})" for f, m in zip(force, motion, strict=True)))
    means = [float(mean_over(product, each)) for each in corners]
    return float(np.dot(means, measures))


FORCE = ["x*y - 0.5*z", "2 - x^2", "0.1*(x + y)*z^2"]
MOTION = {
    1: ["x - z", "0.5*y", "1"],
    2: ["x*z", "y^2 - x", "x*y"],
    4: ["x^4 - y^2*z", "x*y*z", "0.2*(x - y)^4"],
}


@pytest.mark.parametrize("degree", [1, 2, 4, 5])
def test_a_polynomial_traction_does_the_exact_work(degree: int) -> None:
    mesh, motion = skewed(), MOTION[min(degree, 4)]
    load = Traction("right", "top", value=Polynomial.parse(FORCE))
    work, net = loaded(mesh, degree, load)
    facets = np.concatenate([mesh.facets_of("right"), mesh.facets_of("top")])
    exact = work_of(FORCE, motion, mesh.points[facets], mesh.areas(facets))
    mine = np.sum(work * net.interpolated(Polynomial.parse(motion)))
    assert mine == pytest.approx(exact, rel=CLOSED_FORM)


@pytest.mark.parametrize("degree", [1, 2, 4, 5])
def test_a_polynomial_body_force_does_the_exact_work(degree: int) -> None:
    mesh, motion = skewed(), MOTION[min(degree, 4)]
    work, net = loaded(mesh, degree, BodyForce(Polynomial.parse(FORCE)))
    exact = work_of(FORCE, motion, mesh.points[mesh.tets], mesh.volumes)
    mine = np.sum(work * net.interpolated(Polynomial.parse(motion)))
    assert mine == pytest.approx(exact, rel=CLOSED_FORM)


@pytest.mark.parametrize("degree", range(1, 11))
def test_a_traction_of_high_degree_is_exact_at_every_degree(degree: int) -> None:
    mesh = skewed((1, 1, 1))
    power = 10 - degree
    load = Traction("front", value=Polynomial.parse([f"(x - 3)^{power}", 0, f"(y + 1)^{power}"]))
    work, net = loaded(mesh, degree, load)
    motion = [f"(z - 2)^{degree}", "0", f"(x - 3)^{degree}"]
    facets = mesh.facets_of("front")
    force = [f"(x - 3)^{power}", "0", f"(y + 1)^{power}"]
    exact = work_of(force, motion, mesh.points[facets], mesh.areas(facets))
    mine = np.sum(work * net.interpolated(Polynomial.parse(motion)))
    assert mine == pytest.approx(exact, rel=1e-11)  # controls of degree 10 cancel by 1e2 and more


@pytest.mark.parametrize("degree", [1, 3, 6])
def test_the_forces_sum_to_area_times_traction_and_volume_times_body_force(degree: int) -> None:
    mesh = skewed((2, 2, 2))
    work, _ = loaded(mesh, degree, Traction("top", value=(1, -2, 3)), BodyForce((0, 0, -4)))
    area, volume = mesh.areas(mesh.facets_of("top")).sum(), mesh.volumes.sum()
    expected = area * np.array([1, -2, 3]) + volume * np.array([0, 0, -4])
    assert np.allclose(work.sum(axis=0), expected, rtol=ROUNDING * 10)


def test_the_moment_of_a_linear_traction_is_exact() -> None:
    """t_z = y on the unit square z = 1: the moment about x is int y^2 = 1/3, about y -1/4."""
    work, net = loaded(
        block(cells=(2, 3, 1)), 2, Traction("top", value=Polynomial.parse([0, 0, "y"]))
    )
    moment = np.cross(net.points, work).sum(axis=0)
    assert np.allclose(moment, [1 / 3, -1 / 4, 0], atol=1e-14)
    assert work.sum(axis=0)[2] == pytest.approx(1 / 2, rel=1e-14)


@pytest.mark.parametrize("degree", [1, 3])
def test_an_even_pressure_on_a_closed_surface_has_no_resultant(degree: int) -> None:
    mesh = skewed((2, 2, 2))
    mesh = mesh.with_surface("skin", mesh.boundary)
    work, net = loaded(mesh, degree, Pressure("skin", value=2.5))
    scale = 2.5 * mesh.areas(mesh.boundary).sum()
    assert np.abs(work.sum(axis=0)).max() < ROUNDING * scale
    assert np.abs(np.cross(net.points, work).sum(axis=0)).max() < ROUNDING * 10 * scale


def test_pressure_pushes_inward() -> None:
    work, _ = loaded(block(), 2, Pressure("top", value=2.0))
    assert np.allclose(work.sum(axis=0), [0, 0, -2.0], atol=1e-14)


def test_a_hydrostatic_pressure_lifts_by_the_weight_of_the_volume() -> None:
    """Archimedes: p = g (h - z) on all of the boundary gives -int grad p = g V upward."""
    mesh = skewed((2, 2, 2))
    mesh = mesh.with_surface("skin", mesh.boundary)
    work, _ = loaded(mesh, 2, Pressure("skin", value=Polynomial.parse("0.3*(7 - z)")))
    assert np.allclose(work.sum(axis=0), [0, 0, 0.3 * mesh.volumes.sum()], atol=1e-12)


def test_a_function_is_integrated_as_exactly_as_asked() -> None:
    mesh = skewed((2, 2, 2))
    field = Polynomial.parse(FORCE)
    for load in (Traction, BodyForce):
        place = ("top",) if load is Traction else ()
        exact, _ = loaded(mesh, 3, load(*place, value=field))
        sampled, _ = loaded(mesh, 3, load(*place, value=lambda x: field(x)))
        rough, _ = loaded(mesh, 3, load(*place, value=lambda x: field(x), exactness=2))
        assert np.abs(sampled - exact).max() < ROUNDING * 10 * np.abs(exact).max()
        assert np.abs(rough - exact).max() > 1e-6 * np.abs(exact).max()
    even, _ = loaded(mesh, 3, Pressure("top", value=1))
    same, _ = loaded(mesh, 3, Pressure("top", value=lambda x: np.ones(len(x))))
    assert np.allclose(even, same, atol=1e-15)


def test_a_smooth_function_converges_with_the_exactness() -> None:
    def wind(x: np.ndarray) -> np.ndarray:
        return np.stack([np.exp(x[:, 0]), 0 * x[:, 0], np.cos(3 * x[:, 1])], axis=1)

    results = [
        loaded(block(), 2, Traction("top", value=wind, exactness=e))[0].sum(axis=0)
        for e in (4, 8, 12)
    ]
    exact = np.array([np.e - 1, 0, np.sin(3) / 3])
    errors = [float(np.abs(each - exact).max()) for each in results]
    assert errors[0] > errors[1] > errors[2]
    assert errors[2] < 1e-9


def test_a_body_force_acts_on_its_regions_only() -> None:
    plain = block(size=(2, 1, 1), cells=(2, 1, 1))
    side = (plain.points[plain.tets].mean(axis=1)[:, 0] > 1).astype(int)
    mesh = TetMesh(plain.points, plain.tets, region=side, regions=("fat", "muscle"))
    work, net = loaded(mesh, 2, BodyForce((0, 0, -3), regions=["muscle"]))
    assert np.allclose(work.sum(axis=0), [0, 0, -3], atol=1e-14)
    assert not work[net.points[:, 0] < 1].any()
    both, _ = loaded(mesh, 2, BodyForce((0, 0, -3), regions=["fat", "muscle"]))
    assert np.allclose(both.sum(axis=0), [0, 0, -6], atol=1e-14)


@pytest.mark.parametrize("at", ["tip", (1.0, 1.0, 1.0), np.array([1, 1, 1 + 1e-12])])
def test_a_point_force_acts_on_the_control_of_its_vertex(at: object) -> None:
    mesh = block().with_vertices("tip", np.array([[1.0, 1, 1]]))
    work, net = loaded(mesh, 4, PointForce(at, (1, 2, 3)), PointForce("tip", (0, 0, 1)))
    hit = np.flatnonzero(work.any(axis=1))
    assert net.points[hit].tolist() == [[1.0, 1.0, 1.0]]
    assert work[hit].tolist() == [[1.0, 2.0, 4.0]]


def test_loads_add_up_and_none_is_none() -> None:
    mesh = skewed()
    one, two = Traction("top", value=(1, 0, 0)), Pressure("top", "left", value=0.5)
    together, _ = loaded(mesh, 3, one, two)
    apart = loaded(mesh, 3, one)[0] + loaded(mesh, 3, two)[0]
    assert np.allclose(together, apart, atol=1e-15)
    assert not loaded(mesh, 3)[0].any()


def test_many_simplices_are_taken_in_runs_without_a_seam(monkeypatch: pytest.MonkeyPatch) -> None:
    mesh = skewed((3, 3, 3))
    loads = (BodyForce(Polynomial.parse(FORCE)), Pressure("top", value=1))
    whole, _ = loaded(mesh, 2, *loads)
    monkeypatch.setattr("bezsoma.equations.forces._AT_ONCE", 50)
    assert np.allclose(loaded(mesh, 2, *loads)[0], whole, rtol=0, atol=1e-14)
