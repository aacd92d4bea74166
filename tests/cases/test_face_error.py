# SPDX-License-Identifier: BSD-3-Clause
"""The chin of the real face: what a solution says of its error, beside a much finer solution.

studies/face_error.py has the same for higher degrees, and docs/verification/face_error.md what
came out.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import bezsoma as bz
from bezsoma.arrays import Floats
from bezsoma.case.build import body_of
from bezsoma.case.expectations import probe_points
from bezsoma.case.reading import read_case
from bezsoma.case.sources import mesh_of
from bezsoma.refinement import VectorEstimate
from bezsoma.refinement.bisection import bisected
from bezsoma.refinement.loop import BULK, TIMES
from bezsoma.refinement.marking import bulk
from bezsoma.refinement.means import mean

pytestmark = [pytest.mark.real_data, pytest.mark.slow]


@pytest.fixture(scope="module")
def bodies(root: Path, data: Path) -> tuple[bz.Body, bz.Body, bz.PatchMean]:
    """The face at degrees 2 and 3, and the skin within 3 mm of its chin."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("BEZSOMA_DATA", str(data))
        case = read_case(root / "cases" / "face_small_jaw_forward.toml")
        mesh = mesh_of(case)
    chin = bz.PatchMean("skin", at=probe_points(case, mesh)["chin"], radius=3, direction="y")
    return body_of(case, mesh, 2), body_of(case, mesh, 3), chin


def moved(solution: bz.Solution, place: bz.PatchMean) -> Floats:
    """The mean displacement (3,) mm."""
    goals = [replace(place, direction=axis) for axis in "xyz"]
    return np.array([mean(goal, solution.displacement) for goal in goals])


def judged(body: bz.Body, place: bz.PatchMean, truth: Floats) -> VectorEstimate:
    """The estimate, once it is seen to enclose the truth and to come near it."""
    found = bz.vector_estimate(bz.solve(body), place)
    lacking = truth - found.value
    size = float(np.linalg.norm(lacking))
    assert size <= found.size
    assert np.linalg.norm(found.error - lacking) < 0.5 * size  # so what is added makes it better
    return found


def test_the_value_at_the_chin_and_its_error_enclose_a_much_finer_one(
    bodies: tuple[bz.Body, bz.Body, bz.PatchMean],
) -> None:
    second, third, chin = bodies
    along = bz.vector_estimate(bz.solve(second), chin).along
    finer = bisected(second.mesh, bulk(np.abs(along.of_tet), BULK), times=TIMES).mesh
    cut = replace(second, mesh=finer)
    truth = moved(bz.solve(replace(cut, degree=4), rtol=1e-8), chin)
    coarse, high, low = (judged(body, chin, truth) for body in (second, third, cut))
    assert max(high.size, low.size) < coarse.size / 2
    assert np.linalg.norm(high.value - low.value) <= high.size + low.size
