# SPDX-License-Identifier: BSD-3-Clause
"""What laws and load steps refuse, and what is said where no equilibrium is found."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import bezsoma as bz
from bezsoma.arrays import Floats
from bezsoma.equations.boundary import prescribed
from bezsoma.equations.ellipticity import lost_ellipticity
from bezsoma.equations.nonlinear import nonlinear_equations
from bezsoma.equations.pointwise import Pointwise
from bezsoma.mesh.control_net import ControlNet
from bezsoma.solvers import memory
from bezsoma.solvers.load_steps import loaded
from bezsoma.solvers.newton import Balance, Breakdown, Correction, Rule, System
from bezsoma.solvers.nonlinear import form_of


def spring_of_volume(H: Floats) -> Floats:
    """A gas: nothing resists shear."""
    return np.asarray(3 * np.trace(H, axis1=-2, axis2=-1)[..., None, None] * np.eye(3))


REFUSED: list[tuple[Callable[[], Any], str]] = [
    (lambda: bz.Stiffening(0, 0.3, 5), "E of Stiffening = 0 MPa: it must be positive"),
    (lambda: bz.Stiffening(1, 0.51, 5), "Poisson's ratio lies above -1"),
    (lambda: bz.Stiffening(1, -1, 5), "Poisson's ratio lies above -1"),
    (lambda: bz.Stiffening(1, 0.3, -1), "A of Stiffening = -1"),
    (lambda: bz.Stiffening(1, 0.3, np.nan), "finite"),
    (lambda: bz.Stiffening(1, 0.3, 5, measure="frobenious"), "did you mean 'frobenius'"),
    (lambda: bz.Stiffening(1, 0.3, 5, shears="voigt"), "no shears 'voigt'"),
    (lambda: bz.Stiffening(1, 0.3, 5, "energy", "engineering"), "go with 'frobenius'"),
    (lambda: bz.StVenantKirchhoff(-1, 0.3), "E of StVenantKirchhoff"),
    (lambda: bz.StVenantKirchhoff(1, 0.5), "has no incompressible form"),
    (lambda: bz.NeoHooke("soft", 0.3), "which is text"),  # type: ignore[arg-type]
    (lambda: bz.NeoHooke(1, 0.7), "Poisson's ratio lies above -1"),
    (lambda: bz.MooneyRivlin(-1, 2, 5), "c1 of MooneyRivlin"),
    (lambda: bz.MooneyRivlin(0, 0, 5), "no shear modulus"),
    (lambda: bz.MooneyRivlin(1, 1, 0), "kappa of MooneyRivlin"),
    (lambda: bz.Ogden([1.0, 2.0], [2.0], 5), "as many of the one as of the other"),
    (lambda: bz.Ogden([1.0], [-2.0], 5), "mu * alpha must be positive"),
    (lambda: bz.Ogden("1", [2.0], 5), "must be a list"),
    (lambda: bz.VerondaWestmann(1, 0, 5), "c2 of VerondaWestmann"),
    (lambda: bz.Guccione(1, 8, 2, -4, 5, (1, 0, 0)), "bfs of Guccione"),
    (lambda: bz.Guccione(1, 8, 2, 4, 5, (0, 0, 0)), "must point somewhere"),
    (lambda: bz.FunctionLaw(3), "takes functions"),  # type: ignore[arg-type]
    (lambda: bz.FunctionLaw(lambda H: H[..., 0]), "one 3 x 3 stress for each H"),
    (lambda: bz.FunctionLaw(lambda H: H, derivative="exact"), "is not known"),
    (lambda: bz.FunctionLaw(lambda H: 0 * H), "zero or not finite"),
    (lambda: bz.FunctionLaw(lambda H: -H), "its modulus there is -1 MPa, the largest of all 1,"),
    (lambda: bz.FunctionLaw(spring_of_volume), "MPa, the largest of all 9"),
    (
        lambda: bz.FunctionLaw(lambda H: -H, finite=False, kappa=5.0),
        "every small change of shape, apart from kappa",
    ),
    (
        lambda: bz.FunctionLaw(lambda H: 2 * H, energy=lambda H: (H**2).sum((-2, -1)) / 2),
        "and the stress does 0.06; mend one of them, or leave energy= out",
    ),
    (
        lambda: bz.FunctionLaw(lambda H: H + H**3, energy=lambda H: (H**2).sum((-2, -1)) / 2),
        "is not the derivative of its energy",
    ),
    (lambda: bz.FunctionLaw(lambda H: H, derivative=lambda H, dH: dH[0]), "change of stress"),
    (
        lambda: bz.FunctionLaw(lambda H: H, derivative=lambda H, dH: 2 * dH),
        "not that of its stress",
    ),
    (lambda: bz.FunctionLaw(lambda H: H * (1 + abs(H))), "a complex step is right without abs"),
    (lambda: bz.FunctionLaw(lambda H: H, energy=lambda H: np.zeros(())), "one number for each H"),
    (lambda: bz.FunctionLaw(lambda H: H, kappa=-1.0), "kappa of FunctionLaw"),
    (lambda: bz.FunctionLaw(lambda H: H, finite="no"), "it must be True or False"),  # type: ignore[arg-type]
    (lambda: bz.VerondaWestmann(-1, 1, 5), "c1 of VerondaWestmann"),
    (lambda: bz.Guccione(0, 8, 2, 4, 5, (1, 0, 0)), "C of Guccione"),
    (lambda: bz.Guccione(1, 8, 2, 4, 5, (np.nan, 0, 0)), "fibre of Guccione"),
    (lambda: bz.Ogden(np.array(1.0), [0.0], 5), "mu * alpha must be positive"),  # type: ignore[arg-type]
    (lambda: bz.Pressure("top", value=1.0, following="yes"), "must be True or False"),  # type: ignore[arg-type]
]


@pytest.mark.parametrize(("made", "said"), REFUSED, ids=[said for _, said in REFUSED])
def test_parameters_out_of_range_are_refused(made: Callable[[], Any], said: str) -> None:
    with pytest.raises(bz.InputError) as refusal:
        made()
    assert said in str(refusal.value)


def body(law: Any = None, shift: Any = (0, 0, 0.1), **more: Any) -> bz.Body:
    """A block whose top is moved."""
    law = law or bz.NeoHooke(1.0, 0.3)
    supports = [bz.Fixed("bottom"), bz.Moved("top", translation=shift)]
    return bz.Body(bz.block(), 2, law, supports, **more)


@pytest.mark.parametrize(
    ("how", "said"),
    [
        ({"steps": 0}, "in one step or more"),
        ({"steps": -3}, "in one step or more"),
        ({"steps": 10**9}, "in one step or more, up to 10000"),
        ({"steps": ["0.5", "1"]}, "give how many"),
        ({"steps": [True]}, "give how many"),
        ({"steps": 0.5}, "give how many"),
        ({"steps": [0.5, 0.9]}, "ending with 1"),
        ({"steps": [0.5, 0.2, 1]}, "ascending"),
        ({"steps": [float("nan"), 1]}, "ascending"),
        ({"steps": []}, "ascending"),
        ({"steps": "many"}, "give how many"),
        ({"steps": True}, "give how many"),
        ({"method": "picard"}, "no method 'picard'"),
        ({"method": ["newton"]}, "no method ['newton']"),
        ({"exactness": 99}, "whole number from 0 to 40"),
        ({"exactness": 1}, "at degree 2: points so few do not feel every strain"),
        ({"solver": "cg"}, "serves linear bodies only"),
        ({"method": "secant"}, "has no secant"),
    ],
)
def test_ways_to_solve_that_are_none(how: Any, said: str) -> None:
    with pytest.raises(bz.InputError) as refusal:
        bz.solve(body(), **how)
    assert said in str(refusal.value)


def test_incompressible_law_needs_a_pressure() -> None:
    for law in (bz.NeoHooke(1.0, 0.5), bz.MooneyRivlin(1.0, 0.0, np.inf)):
        with pytest.raises(bz.InputError, match="pressure"):
            body(law)


@pytest.mark.parametrize(
    "law", [bz.StVenantKirchhoff(1.0, 0.3), bz.Stiffening(1.0, 0.3, 5.0, "energy")]
)
def test_law_that_does_not_split_cannot_stand_beside_a_pressure(law: Any) -> None:
    with pytest.raises(bz.InputError, match="does not split"):
        body(law, incompressible=True)


def test_motion_that_turns_tets_inside_out() -> None:
    """The top is pushed through the bottom: told where, at which fraction, what was reached."""
    with pytest.raises(bz.NotConverged) as failure:
        bz.solve(body(shift=(0, 0, -1.2)))
    error = failure.value
    assert "% of the load no equilibrium was found" in str(error)
    assert "region 'tissue'" in str(error) and "J = " in str(error)
    assert 0.3 < error.fraction < 1
    reached = error.last.displacement.at(np.array([[0.5, 0.5, 1.0]]))[0, 2]
    assert abs(reached + 1.2 * error.fraction) < 1e-12
    assert error.last.residual <= 1e-10
    assert error.path and error.history


def test_given_steps_are_not_cut() -> None:
    with pytest.raises(bz.NotConverged) as failure:
        bz.solve(body(shift=(0, 0, -1.2)), steps=2)
    assert failure.value.fraction in (0.0, 0.5)


def test_exponent_that_overflows() -> None:
    """Strained by 500 %: exp(A s^2) with A s^2 of some thousand has no number."""
    with pytest.raises(bz.NotConverged) as failure:
        bz.solve(body(bz.Stiffening(1.0, 0.3, 50.0), (0, 0, 5.0)))
    assert failure.value.fraction < 1
    assert "exponent = " in str(failure.value) and "region 'tissue'" in str(failure.value)


@pytest.mark.parametrize("solver", ["direct", "multigrid"])
@pytest.mark.parametrize(
    "law",
    [bz.Guccione(1.0, 50.0, 20.0, 30.0, 5.0, (1, 0, 0)), bz.Stiffening(1.0, 0.3, 50.0)],
)
def test_tangent_that_overflows(law: Any, solver: str) -> None:
    """Forces still have numbers there; the tangent, or squares of it, have none."""
    with pytest.raises(bz.NotConverged) as failure:
        bz.solve(body(law, (0, 0, 5.0)), solver=solver)
    assert 0 < failure.value.fraction < 1 and failure.value.last.residual <= 1e-10
    assert "exponent = " in str(failure.value) and "region 'tissue'" in str(failure.value)


@pytest.mark.parametrize("solver", ["direct", "multigrid"])
def test_given_step_that_fails_says_what_was_refused_and_where(solver: str) -> None:
    """Whatever ends it, a residual that does not fall, a state refused or a linear solve: once."""
    with pytest.raises(bz.NotConverged) as failure:
        bz.solve(body(bz.Stiffening(1.0, 0.3, 50.0), (0, 0, 5.0)), solver=solver, steps=1)
    said = str(failure.value)
    assert said.count("exponent = ") == 1 and "region 'tissue', tet" in said
    ends = ("exponent = ", "the residual does not fall along the correction; refused was exponent")
    assert any(f"the last is at 0 %: {end}" in said for end in ends)


@pytest.mark.parametrize("solver", ["direct", "multigrid"])
@pytest.mark.parametrize("more", [{}, {"incompressible": True}])
@pytest.mark.parametrize(
    ("law", "what"),
    [
        (bz.Ogden([1e300], [1e-300], 5.0), ("energy is no finite number in balance",) * 2),
        (
            bz.VerondaWestmann(1e300, 1e300, 5.0),
            ("stress is no finite number at rest", "shear modulus is no finite number at rest"),
        ),
    ],
)
def test_law_without_numbers_is_refused(
    law: Any, what: tuple[str, str], more: Any, solver: str
) -> None:
    """mu/alpha and c1 c2 leave float64: nobody is told that a smaller step may help."""
    with pytest.raises(bz.InputError) as refusal:
        bz.solve(body(law, **more), solver=solver)
    assert f"region 'tissue' is {law!r}, whose {what[bool(more)]}" in str(refusal.value)
    assert "may get past it" not in str(refusal.value)


@pytest.mark.parametrize("more", [{}, {"incompressible": True}])
def test_tangent_without_numbers_is_no_lost_ellipticity(more: Any) -> None:
    """Its acoustic tensors have no eigenvalues."""
    law = bz.Guccione(1e200, 1e200, 1.0, 1.0, 5.0, (1, 0, 0))
    with pytest.raises(bz.NotConverged, match="range of numbers") as failure:
        bz.solve(body(law, **more))
    assert "ellipticity" not in str(failure.value)


def test_more_exact_than_rounding() -> None:
    with pytest.raises(bz.NotConverged, match="only rounding is left of the residual"):
        bz.solve(body(), rtol=1e-30)


def test_overflow_on_the_first_try_is_met_by_a_smaller_step() -> None:
    """Whole, the linear law's first guess overflows; the load is borne all the same."""
    load = bz.Traction("top", value=(0, 0, 30.0))
    law = bz.Stiffening(1.0, 0.3, 5.0)
    found = bz.solve(bz.Body(bz.block(), 1, law, [bz.Fixed("bottom")], [load]))
    assert found.residual <= 1e-10
    assert min(each.factor for each in found.path) < 1
    assert abs(found.reactions["bottom"].force[2] + 30.0) < 1e-7


def test_user_law_that_gives_no_numbers_is_told_where() -> None:
    law = bz.FunctionLaw(lambda H: H + np.where(abs(H.real) > 0.05, np.nan, 0.0))
    with pytest.raises(bz.NotConverged, match="no finite number in tet"):
        bz.solve(body(law, (0, 0, 0.4)))


SIDES = ("left", "right", "front", "back", "bottom", "top")


def enclosed(law: Any, value: Any) -> bz.Solution:
    """A block of incompressible tissue whose whole boundary is prescribed."""
    held = [bz.Prescribed(*SIDES, value=bz.Polynomial.parse(value))]
    return bz.solve(bz.Body(bz.block(cells=2), 2, law, held, incompressible=True))


@pytest.mark.parametrize(
    ("law", "said"),
    [(bz.NeoHooke(1.0, 0.5), "by 0.2 mm3"), (bz.Stiffening(1.0, 0.5, 5.0), "by 0.2 mm3")],
)
def test_enclosed_tissue_whose_volume_would_change(law: Any, said: str) -> None:
    with pytest.raises(bz.InputError, match="whole boundary has prescribed") as refusal:
        enclosed(law, ["0.2*x", 0, 0])
    assert said in str(refusal.value)


def test_enclosed_tissue_may_keep_its_volume_in_its_own_sense() -> None:
    """1.25 * 0.8 = 1 at finite strain, 0.25 - 0.25 = 0 at small."""
    finite, small = bz.NeoHooke(1.0, 0.5), bz.Stiffening(1.0, 0.5, 5.0)
    exact, linear = ["0.25*x", "-0.2*y", 0], ["0.25*x", "-0.25*y", 0]
    assert enclosed(finite, exact).residual <= 1e-10
    assert enclosed(small, linear).residual <= 1e-10
    with pytest.raises(bz.InputError, match=r"by -0\.0625 mm3"):
        enclosed(finite, linear)
    with pytest.raises(bz.InputError, match=r"by 0\.05 mm3"):
        enclosed(small, exact)


@pytest.mark.parametrize("solver", ["auto", "direct", "multigrid"])
def test_what_does_not_fit_is_refused(solver: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(memory, "available", lambda: 1000)
    for more in ({}, {"incompressible": True}):
        with pytest.raises(bz.InputError, match="are free; take a lower degree"):
            bz.solve(body(**more), solver=solver)


class Slope:
    """The tangent of x = t, which fails beyond some t."""

    def __init__(self, fails: bool) -> None:
        self.fails = fails

    def product(self, dx: Any) -> Any:
        return dx

    def solve(self, b: Any, rtol: float) -> Correction:
        if self.fails:
            raise Breakdown("no correction")
        return Correction(b, 1)


@pytest.mark.parametrize("doubt", ["", "the law has lost strong ellipticity"])
def test_halving_ends_early_where_ellipticity_is_lost(doubt: str) -> None:
    """Beyond 0.6 the tangent fails: found to a thousandth, or only to an eighth."""
    system = System(
        np.zeros(1, bool),
        (slice(0, 1),),
        (1.0,),
        lambda t: np.zeros(1),
        lambda x, t: Balance(t - x, (t,), 1.0),
        lambda x, t: Slope(t > 0.6),
        lambda x: doubt,
    )
    reached = loaded(system, np.zeros(1), None, Rule(1e-10), lambda each: None)
    assert reached.fraction == reached.x[0]
    assert doubt in reached.why and "no correction" in reached.why
    assert 0.6 - (0.25 if doubt else 0.002) < reached.fraction <= 0.6
    assert (len(reached.path) < 4) == bool(doubt)


@pytest.mark.parametrize("chosen", ["direct", "multigrid"])
def test_lost_ellipticity_is_told_beside_a_pressure(chosen: str) -> None:
    """Veronda-Westmann's law drawn out to 1.8 two ways; to 1.2 it is sound."""
    soft = body(bz.VerondaWestmann(1.0, 0.05, np.inf), incompressible=True)
    net = ControlNet(soft.mesh, soft.degree)
    equations = nonlinear_equations(soft, net, prescribed(soft, net))
    system = form_of(soft, equations, 6, chosen, "newton", 1).system
    for stretch, said in (
        (1.0, ""),
        (1.2, ""),
        (1.8, "has lost strong ellipticity in 6 of 6 tets"),
    ):
        x = np.zeros(len(system.held))
        stretched = net.points * (np.array([stretch, stretch, stretch**-2]) - 1)
        x[: stretched.size] = stretched.ravel()
        doubt = system.doubt(x)
        assert said in doubt and bool(said) == bool(doubt)


def test_what_went_otherwise_is_in_the_path() -> None:
    """The first guess turns tets inside out; the path says where, and what was made of it."""
    with pytest.raises(bz.NotConverged) as failure:
        bz.solve(body(shift=(0, 0, -1.2)))
    said = " ".join(event for each in failure.value.path for event in each.events)
    assert "of the correction refused: J = " in said
    assert "100 % of the load was tried in vain" in said


def test_tangent_that_is_not_positive_is_told() -> None:
    """A column squeezed beyond where it buckles: straight it stays, its tangent is not."""
    mesh = bz.block(size=(1.0, 1.0, 12.0), cells=(1, 1, 8))
    squeezed = bz.Moved("top", translation=(0, 0, -1.2))
    law = bz.NeoHooke(1.0, 0.3)
    found = bz.solve(
        bz.Body(mesh, 2, law, [bz.Fixed("bottom"), squeezed]), solver="multigrid", steps=1
    )
    said = [event for each in found.path for event in each.events]
    assert any("direction without positive energy" in event for event in said)
    assert found.residual <= 1e-10


def fails_above(what: Any) -> Any:
    """A law's function that is sound near rest and answers otherwise beyond."""
    return lambda H: H if np.abs(H.real).max() < 0.05 else what(H)


def test_user_law_that_raises_is_told_with_its_reason() -> None:
    def broken(H: Any) -> Any:
        raise ZeroDivisionError("of my own")

    with pytest.raises(bz.InputError, match=r"stress of FunctionLaw raises ZeroDivisionError \(of"):
        bz.FunctionLaw(broken)
    with pytest.raises(bz.InputError, match=r"raises ZeroDivisionError \(of my own\) for H"):
        bz.solve(body(bz.FunctionLaw(fails_above(broken)), (0, 0, 0.4)))


ANSWERS: list[tuple[Any, str]] = [
    (lambda H: H * (1 + 1j), "numbers of type complex128 for H of type float64"),
    (lambda H: np.full(H.shape, "stiff"), "numbers of type <U5"),
    (lambda H: np.full(H.shape, None), "numbers of type object"),
]


@pytest.mark.parametrize(("answer", "said"), ANSWERS, ids=[said for _, said in ANSWERS])
def test_user_law_that_answers_with_no_real_numbers(answer: Any, said: str) -> None:
    with pytest.raises(bz.InputError, match=said):
        bz.FunctionLaw(answer, derivative="differences")
    with pytest.raises(bz.InputError, match=said):
        bz.solve(body(bz.FunctionLaw(fails_above(answer), derivative="differences"), (0, 0, 0.4)))


def test_user_law_that_writes_into_its_argument_is_refused() -> None:
    """Its energy would else be that of other strains than the solver's."""

    def writes(H: Any) -> Any:
        H *= 1.1
        return H

    with pytest.raises(bz.InputError, match=r"read-only.*leave H as it is"):
        bz.FunctionLaw(writes)


def test_user_law_may_answer_with_lists() -> None:
    law = bz.FunctionLaw(lambda H: (2.0 * H).tolist(), energy=lambda H: (H**2).sum((-2, -1)))
    assert abs(bz.solve(body(law)).energy - 0.01) < 1e-12


@pytest.mark.parametrize("solver", ["direct", "multigrid"])
def test_user_law_whose_derivative_gives_no_numbers(solver: str) -> None:
    def twice(H: Any) -> Any:
        return H + np.swapaxes(H, -1, -2)

    def slope(H: Any, dH: Any) -> Any:
        return twice(dH) * np.where(np.abs(twice(H)) > 0.05, np.nan, 1 + 3 * twice(H) ** 2)

    law = bz.FunctionLaw(lambda H: twice(H) + twice(H) ** 3, derivative=slope, finite=False)
    with pytest.raises(bz.NotConverged, match="range of numbers"):
        bz.solve(body(law, (0.4, 0, 0.0)), solver=solver)


def test_user_law_that_answers_with_another_shape_at_large_strain() -> None:
    with pytest.raises(bz.InputError, match=r"answers with shape \(\d+, \d+, 3\) for H of shape"):
        bz.solve(body(bz.FunctionLaw(fails_above(lambda H: H[..., 0])), (0, 0, 0.4)))


def test_tissue_that_folds_between_the_points_of_the_quadrature_is_told() -> None:
    """One cell whose top is pushed far below its bottom: all points asked have J > 0."""
    supports = [bz.Fixed("bottom"), bz.Moved("top", translation=(0, 0, -1.5))]
    folded = bz.solve(bz.Body(bz.block(cells=1), 2, bz.NeoHooke(1.0, 0.3), supports))
    (said,) = folded.path[-1].events
    assert (
        "turned inside out at corners of 6 of 6 tets (100 % of the volume)" in said
        and "region 'tissue'" in said
    )
    assert folded.advice == said == folded.summary()["advice"] and said in repr(folded)
    supports[1] = bz.Moved("top", translation=(0, 0, -0.2))
    sound = bz.solve(bz.Body(bz.block(cells=1), 2, bz.NeoHooke(1.0, 0.3), supports))
    assert not sound.path[-1].events and not sound.advice and "advice" not in repr(sound)


def test_folded_tissue_has_no_stress_and_the_rest_has() -> None:
    """A law at finite strain says nothing where J <= 0: neither a stress nor how it resists."""
    mesh = bz.block(size=(2, 1, 1), cells=(2, 1, 1))
    supports = [bz.Fixed("left"), bz.Moved("right", translation=(-1.88, 0, 0))]
    folded = bz.solve(bz.Body(mesh, 2, bz.NeoHooke(1.0, 0.3), supports))
    lost = np.isnan(folded.stress.controls).any(axis=(1, 2, 3))
    assert f"at corners of {lost.sum()} of 12 tets" in folded.advice and 0 < lost.sum() < 12
    sound = np.isfinite(folded.stress.controls[~lost])
    assert sound.all()
    with pytest.raises(bz.InputError, match=r"NaN or infinite at \d+ of \d+ .* inside out"):
        bz.picture(None, mesh, folded.von_mises)
    net = ControlNet(bz.block(), 2)
    through = Pointwise(net, [bz.NeoHooke(1.0, 0.3)], 6)
    assert lost_ellipticity(through, net.points * [-1.2, 0, 0]) == ""


def test_advice_on_a_body_with_a_pressure_is_in_its_summary() -> None:
    found = bz.solve(body(bz.NeoHooke(1.0, 0.5), incompressible=True))
    assert "advice" not in found.summary()
    assert replace(found, advice="beware").summary()["advice"] == "beware"
