# SPDX-License-Identifier: BSD-3-Clause
"""Means of a displacement: what they are the means of, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

from bezsoma.errors import InputError
from bezsoma.mesh.control_net import ControlNet
from bezsoma.mesh.field import Field
from bezsoma.mesh.solids import ball, block
from bezsoma.mesh.tets import TetMesh
from bezsoma.refinement.goals import Goal, InnerMean, PatchMean, SurfaceMean, goal_checked
from bezsoma.refinement.means import mean, weights


def kernel(r2: np.ndarray) -> np.ndarray:
    """The weight of a mean at r^2, the radius being one."""
    return np.maximum(1 - r2, 0) ** 2


def test_the_mean_over_a_patch_is_that_of_a_fine_grid() -> None:
    net = ControlNet(block(cells=3, irregular=0.3), 3)
    field = Field.interpolating(
        net, lambda x: np.stack([x[:, 0] ** 2 * x[:, 1], 0 * x[:, 0], x[:, 1] ** 3], axis=1)
    )
    goal = PatchMean("top", at=(0.9, 0.4, 1.0), radius=0.3, direction=(3, 0, 4))
    x, y = np.meshgrid((np.arange(1500) + 0.5) / 1500, (np.arange(1500) + 0.5) / 1500)
    w = kernel(((x - 0.9) ** 2 + (y - 0.4) ** 2) / 0.3**2)
    wanted = (w * (0.6 * x**2 * y + 0.8 * y**3)).sum() / w.sum()
    assert abs(mean(goal, field) - wanted) < 2e-5


def test_the_mean_around_a_point_inside_is_that_of_a_fine_grid() -> None:
    net = ControlNet(block(cells=2, irregular=0.3), 2)
    field = Field.interpolating(net, lambda x: x[:, :1] * x[:, 1:2] * np.array([[1.0, 0, 0]]))
    goal = InnerMean(at=(0.4, 0.5, 0.9), radius=0.25, direction="x")
    x, y, z = np.meshgrid(*[(np.arange(160) + 0.5) / 160] * 3)
    w = kernel(((x - 0.4) ** 2 + (y - 0.5) ** 2 + (z - 0.9) ** 2) / 0.25**2)
    assert abs(mean(goal, field) - (w * x * y).sum() / w.sum()) < 1e-5


def test_means_do_not_depend_on_the_mesh() -> None:
    goal = PatchMean("top", at=(0.4, 0.55, 1.0), radius=0.2, direction="z")
    found = []
    for cells in (1, 4):
        net = ControlNet(block(cells=cells, irregular=0.3), 4)
        field = Field.interpolating(net, lambda x: (x[:, :1] ** 3 * x[:, 1:2]) * np.eye(3)[2])
        found.append(mean(goal, field))
    assert abs(found[0] - found[1]) < 1e-6


def test_a_patch_is_one_piece() -> None:
    """Two blocks 1 mm apart, as lips are: the patch on one does not reach the other."""
    one = block()
    points = np.concatenate([one.points, one.points + [0.0, 0.0, 1.1]])
    tets = np.concatenate([one.tets, one.tets + len(one.points)])
    both = TetMesh(points, tets)
    both = both.with_surface("lips", both.boundary)
    goal = PatchMean("lips", at=(0.5, 0.5, 1.0), radius=0.4, direction="x")
    net = ControlNet(both, 2)
    along = weights(goal, net)[:, 0]
    assert abs(along.sum() - 1) < 1e-14
    assert not along[net.points[:, 2] > 1.05].any()


def test_the_mean_over_a_surface_is_by_area() -> None:
    mesh = ball(radius=2.0, cells=2)
    name = next(iter(mesh.surfaces))
    field = Field.interpolating(ControlNet(mesh, 2), lambda x: x + [0.0, 0.0, 3.0])
    assert abs(mean(SurfaceMean(name, direction="z"), field) - 3.0) < 1e-12


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ((1.0, 2.0, 3.0), "no finite dual"),
        ("top", "no finite dual"),
        (SurfaceMean("topp", direction="z"), "did you mean 'top'"),
    ],
)
def test_what_is_no_goal_is_refused(given: object, said: str) -> None:
    with pytest.raises(InputError, match=said):
        goal_checked(given, block())


def test_a_radius_of_nothing_is_a_point() -> None:
    with pytest.raises(InputError, match="no finite dual"):
        PatchMean("top", at=(0, 0, 0), radius=0.0, direction="z")


@pytest.mark.parametrize(
    ("goal", "said"),
    [
        (PatchMean("top", at=(0.5, 0.5, 3.0), radius=0.5, direction="z"), "2 mm away"),
        (InnerMean(at=(0.5, 0.5, 3.0), radius=0.5, direction="z"), "outside the mesh"),
    ],
)
def test_a_goal_off_the_body_is_refused(goal: Goal, said: str) -> None:
    with pytest.raises(InputError, match=said):
        weights(goal, ControlNet(block(), 1))


@pytest.mark.parametrize("direction", ["w", (0, 0, 0), (1, 2)])
def test_a_direction_that_is_none_is_refused(direction: object) -> None:
    with pytest.raises(InputError, match="direction"):
        SurfaceMean("top", direction=direction)
