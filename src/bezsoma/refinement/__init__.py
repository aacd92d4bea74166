# SPDX-License-Identifier: BSD-3-Clause
"""How far a solution is from the truth, and what to refine."""

from __future__ import annotations

from bezsoma.refinement.estimates import (
    EnergyEstimate,
    GoalEstimate,
    VectorEstimate,
    energy_estimate,
    goal_estimate,
    vector_estimate,
)
from bezsoma.refinement.goals import Goal, InnerMean, PatchMean, SurfaceMean

__all__ = [
    "EnergyEstimate",
    "Goal",
    "GoalEstimate",
    "InnerMean",
    "PatchMean",
    "SurfaceMean",
    "VectorEstimate",
    "energy_estimate",
    "goal_estimate",
    "vector_estimate",
]
