# SPDX-License-Identifier: BSD-3-Clause
"""Where a displacement has to be right: named places, each with one goal or one for each axis."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from bezsoma.arrays import Floats
from bezsoma.errors import InputError
from bezsoma.mesh.tets import TetMesh
from bezsoma.refinement.goals import Goal, InnerMean, PatchMean, SurfaceMean, goal_checked

AXES = "xyz"


@dataclass(frozen=True, eq=False)
class Target:
    """A name and the goals there, whose errors together are a vector: its length counts, mm."""

    name: str
    goals: tuple[Goal, ...]


def around(name: str, point: Floats, radius: float, surface: str | None = None) -> Target:
    """The mean displacement within a radius [mm] of a point (3,): of a surface, or of the inside.

    >>> around("chin", [0.0, 0.0, 1.0], 3.0, "skin").goals[1].direction.tolist()
    [0.0, 1.0, 0.0]
    """
    if surface is None:
        inner = (InnerMean(at=point, radius=radius, direction=axis) for axis in AXES)
        return Target(name, tuple(inner))
    patch = (PatchMean(surface, at=point, radius=radius, direction=axis) for axis in AXES)
    return Target(name, tuple(patch))


def targets(at: Any, mesh: TetMesh) -> tuple[Target, ...]:
    """What `at` of `refined` means: surfaces by name, goals, or names with goals.

    >>> from bezsoma.mesh.solids import block
    >>> [(each.name, len(each.goals)) for each in targets(["top", "left"], block())]
    [('top', 3), ('left', 3)]
    """
    found = tuple(_targets(at))
    for target in found:
        for goal in target.goals:
            goal_checked(goal, mesh)
    return found


def _targets(at: Any) -> list[Target]:
    if isinstance(at, Target):
        return [at]
    if isinstance(at, str):
        return [Target(at, tuple(SurfaceMean(at, direction=axis) for axis in AXES))]
    if isinstance(at, Goal):
        return [Target(goal_name(at), (at,))]
    if isinstance(at, Mapping):
        return [Target(str(name), _listed(goals)) for name, goals in at.items()]
    if isinstance(at, list | tuple) and not any(isinstance(each, int | float) for each in at):
        return [target for each in at for target in _targets(each)]
    raise InputError(
        f"at={at!r}: give the name of a surface, as at='skin', or goals, as at=PatchMean('skin', "
        "at=(x, y, z), radius=3, direction='y'), a list of these, or a dict from a name to goals"
    )


def _listed(goals: Any) -> tuple[Any, ...]:
    return tuple(goals) if isinstance(goals, list | tuple) else (goals,)


def goal_name(goal: Goal) -> str:
    """The goal in a few words."""
    along = " ".join(f"{each:.3g}" for each in goal.direction)
    if isinstance(goal, SurfaceMean):
        return f"{goal.surface} along ({along})"
    where = " ".join(f"{each:.4g}" for each in goal.at)
    of = goal.surface if isinstance(goal, PatchMean) else "inside"
    return f"{of} at ({where}) along ({along})"
