# SPDX-License-Identifier: BSD-3-Clause
"""The loop: solve, estimate, refine, until it is enough; and what it says where it is not."""

from __future__ import annotations

import re
from dataclasses import asdict, replace
from typing import Any

import numpy as np
import pytest

import bezsoma as bz
from bezsoma.errors import InputError, NotConverged
from bezsoma.mechanics import Fixed, LinearElastic, Moved, NeoHooke, Traction
from bezsoma.mechanics.body import Body
from bezsoma.mesh.solids import block
from bezsoma.refinement import loop
from bezsoma.refinement.goals import PatchMean, SurfaceMean
from bezsoma.refinement.levels import Level, Refined
from bezsoma.refinement.loop import next_way, refined, unknowns
from bezsoma.refinement.marking import bulk
from bezsoma.solvers.solve import solve
from l_block import l_body, l_mesh


def told(found: Refined) -> list[dict[str, Any]]:
    """The levels without the seconds."""
    return [{**asdict(level), "seconds": 0} for level in found.levels]


def test_a_tolerance_is_reached_and_is_true() -> None:
    found = refined(l_body(l_mesh(), 2), tolerance=0.003, at="right")
    assert found.reached
    assert found.levels[-1].error <= 0.003 < found.levels[-2].error
    assert "below the tolerance" in found.why
    mesh = found.solution.body.mesh
    assert set(mesh.surfaces) == {"left", "front", "right", "floor", "roof"}
    finer = solve(replace(found.solution.body, degree=4), start=found.solution)
    facets = mesh.surfaces["right"]
    means = [
        np.einsum("f,fd->d", mesh.areas(facets), _means(each, facets)) / mesh.areas(facets).sum()
        for each in (found.solution, finer)
    ]
    assert np.linalg.norm(means[0] - found.levels[-1].at[0].value) < 1e-9
    assert np.linalg.norm(means[1] - means[0]) < 2 * 0.003


def _means(solution: Any, facets: Any) -> Any:
    """The mean of the displacement over each facet (f, 3): that of its controls."""
    return solution.displacement.on_surface(facets).controls.mean(axis=1)


def test_tets_gather_where_the_error_is() -> None:
    found = refined(l_body(l_mesh(), 2), energy=0.03)
    mesh = found.solution.body.mesh
    assert found.reached
    assert found.levels[-1].energy_error <= 0.03
    away = np.linalg.norm(mesh.points[mesh.tets].mean(axis=1)[:, :2], axis=1)
    assert mesh.volumes[away < 0.05].max() < 0.05 * mesh.volumes[away > 0.6].mean()
    errors = [level.energy_error for level in found.levels]
    assert errors == sorted(errors, reverse=True)


def test_each_way_leads_to_the_tolerance() -> None:
    for by, kinds in (("mesh", {"mesh"}), ("degree", {"degree"}), ("both", {"mesh", "degree"})):
        found = refined(l_body(l_mesh(), 1), energy=0.08, by=by)
        assert found.reached
        assert found.levels[0].by == "start"
        assert {level.by for level in found.levels[1:]} == kinds
        assert found.solution.net.degree == found.levels[-1].degree
        assert len(found.solution.body.mesh.tets) == found.levels[-1].tets


def level(by: str, degree: int, unknowns: int, error: float) -> Level:
    return Level(by, degree, 1, unknowns, 1.0, error, (), 0, 0.0)


def test_of_both_ways_the_one_that_pays_is_taken() -> None:
    levels = [level("start", 1, 100, 1.0)]
    assert next_way("both", levels) == "degree"
    levels.append(level("degree", 2, 800, 0.5))  # a third for each factor of unknowns
    assert next_way("both", levels) == "mesh"
    assert next_way("both", [*levels, level("mesh", 2, 1600, 0.3)]) == "mesh"
    assert next_way("both", [*levels, level("mesh", 2, 1600, 0.45)]) == "degree"
    assert next_way("both", [*levels, level("mesh", 8, 1600, 0.45)]) == "mesh"
    assert next_way("degree", levels) == "degree"


@pytest.mark.parametrize(
    ("limit", "words"),
    [
        (
            {"most_unknowns": 1500},
            "the next level would have .* unknowns, and most_unknowns = 1500",
        ),
        ({"most_seconds": 1e-6}, "would end after about .* most_seconds = 1e-06"),
    ],
)
def test_what_was_not_reached_is_said(limit: dict[str, Any], words: str) -> None:
    found = refined(l_body(l_mesh(), 2), tolerance=1e-9, at="right", **limit)
    assert not found.reached
    assert found.levels[-1].unknowns == 3 * found.solution.net.count <= 1500
    assert found.levels[-1].error > 1e-9
    assert "asked for: 1e-09 mm" in found.why
    assert re.search(words, found.why)


def test_where_no_error_was_asked_for_none_is_missed() -> None:
    found = refined(l_body(l_mesh(), 1), most_unknowns=1500)
    assert found.reached
    assert len(found.levels) > 1
    assert "most_unknowns = 1500" in found.why
    assert "asked for" not in found.why


def test_the_highest_degree_is_said() -> None:
    held = [Fixed("bottom"), Moved("top", translation=(0.1, 0, 0))]
    body = Body(block(), 7, LinearElastic(1.0, 0.3), held)
    found = refined(body, energy=1e-9, by="degree")
    assert not found.reached
    assert [level.degree for level in found.levels] == [7, 8]
    assert "degree 8 is the highest" in found.why


def test_a_later_level_that_fails_ends_the_levels(monkeypatch: pytest.MonkeyPatch) -> None:
    calls = []

    def failing(*given: Any, **how: Any) -> Any:
        calls.append(how["start"])
        if len(calls) == 3:
            raise NotConverged("it did not", [1.0])
        return solve(*given, **how)

    monkeypatch.setattr(loop, "solve", failing)
    found = refined(l_body(l_mesh(), 1), energy=1e-3)
    assert not found.reached
    assert len(found.levels) == 2
    assert found.why == "level 2 could not be solved: it did not"
    assert found.solution.body.mesh is calls[1].displacement.mesh
    monkeypatch.setattr(loop, "solve", lambda *given, **how: failing(start=None) or failing())
    calls[:] = [None, None]
    with pytest.raises(NotConverged):
        refined(l_body(l_mesh(), 1), energy=1e-3)


def test_an_estimate_that_fails_leaves_its_solution(monkeypatch: pytest.MonkeyPatch) -> None:
    plain, calls = loop.estimated, []

    def failing(*given: Any) -> Any:
        calls.append(given[0])
        if len(calls) == 3:
            raise NotConverged("it did not", [1.0])
        return plain(*given)

    monkeypatch.setattr(loop, "estimated", failing)
    found = refined(l_body(l_mesh(), 1), energy=1e-3)
    assert (
        found.why == "level 2 could not be estimated: it was solved, but not its error: it did not"
    )
    assert found.solution is calls[1] and len(found.levels) == 2
    calls[:] = [None, None]
    with pytest.raises(NotConverged, match="it was solved, but not its error") as caught:
        refined(l_body(l_mesh(), 1), energy=1e-3)
    assert caught.value.last is calls[2] and caught.value.fraction == 1.0


def test_a_degree_whose_error_cannot_be_estimated_is_refused_before_it_is_solved() -> None:
    with pytest.raises(InputError, match="degree 9 was given, and 8 is the highest"):
        refined(l_body(l_mesh(), 9), energy=1e-3)


def test_the_same_levels_come_again() -> None:
    one, other = (refined(l_body(l_mesh(), 2), energy=0.05, threads=n) for n in (1, 2))
    assert told(one) == told(other)
    bits = [each.solution.displacement.controls.tobytes() for each in (one, other)]
    assert bits[0] == bits[1]


@pytest.mark.parametrize("breaks", [False, True])
def test_incompressible_tissue_is_refined(breaks: bool) -> None:
    mesh = block((2, 1, 1), cells=(2, 1, 1))
    half = (mesh.points[mesh.tets].mean(axis=1)[:, 0] > 1).astype(int)
    mesh = bz.TetMesh(mesh.points, mesh.tets, half, ("soft", "stiff"), dict(mesh.surfaces))
    laws = {"soft": LinearElastic(1.0, 0.5), "stiff": LinearElastic(10.0, 0.5)}
    held = [Fixed("left"), Moved("right", translation=(0, 0, 0.1))]
    body = Body(mesh, 2, laws, held, incompressible=True, pressure_breaks=breaks)
    at = PatchMean("top", at=(1, 0.5, 1), radius=0.4, direction="z")
    found = refined(body, tolerance=1e-6, at=at, by="both", most_unknowns=2500)
    assert len(found.levels) > 1
    assert found.levels[-1].error < found.levels[0].error
    assert found.solution.pressure is not None
    assert found.solution.body.pressure_degree == found.levels[-1].degree - 1
    assert found.solution.body.mesh.regions == ("soft", "stiff")


def test_large_motions_are_refined() -> None:
    load = Traction("right", value=(0, 0, 0.02))
    body = Body(block((3, 1, 1), cells=(3, 1, 1)), 1, NeoHooke(1.0, 0.3), [Fixed("left")], [load])
    found = refined(
        body, tolerance=1e-6, at={"tip": SurfaceMean("right", direction="z")}, most_unknowns=700
    )
    assert len(found.levels) > 2
    assert found.levels[-1].error < found.levels[0].error
    assert found.levels[-1].at[0].name == "tip"
    assert len(found.solution.path) < 6  # from the level before, at the whole load


def test_unknowns_are_counted_before_they_are_numbered() -> None:
    for degree in (1, 3):
        body = l_body(l_mesh(), degree)
        assert unknowns(body) == 3 * solve(body).net.count


def test_the_bulk_is_the_least_that_suffices() -> None:
    draw = np.random.default_rng(0)
    for part in (0.1, 0.5, 0.9, 1.0):
        shares = draw.exponential(size=200) ** 3
        chosen = bulk(shares, part)
        assert shares[chosen].sum() >= part * shares.sum() * (1 - 1e-12)
        assert np.delete(shares[chosen], shares[chosen].argmin()).sum() < part * shares.sum()
        assert shares[chosen].min() >= np.delete(shares, chosen).max(initial=0.0)
    assert len(bulk(np.zeros(4), 0.5)) == 0


def test_the_worst_place_counts() -> None:
    found = refined(l_body(l_mesh(), 1), tolerance=1.0, at=["right", "roof"])
    at = found.levels[0].at
    assert found.levels[0].error == max(each.error for each in at) > min(e.error for e in at)
    assert found.reached and len(found.levels) == 1
