# SPDX-License-Identifier: BSD-3-Clause
"""How fast the error falls on an L-shaped block, whose inward edge is singular: r^0.5445.

Uniform meshes win N^(-0.5445 / 3) = N^-0.18, at any degree. With small tets at the edge it is
N^(-1/3) at degree 1, the best that degree has, and from degree 2 on N^-0.5445: tets that are as
small along the edge as across it are as many as the edge is long in units of them. That is a limit,
which degree 2 nears slowly: see docs/theory/refinement.md.
"""

from __future__ import annotations

import numpy as np
import pytest

from bezsoma.refinement.levels import Level
from bezsoma.refinement.loop import refined
from bezsoma.solvers.solve import solve
from l_block import ENERGY, l_body, l_mesh


def slope(unknowns: list[int], energies: list[float]) -> float:
    """The power of N by which the true energy norm of the error falls.

    All work is done by a traction: |u - u_h|^2 = 2 (energy of u - energy of u_h).
    """
    errors = np.sqrt(ENERGY - np.array(energies))
    return float(np.polyfit(np.log(unknowns), np.log(errors), 1)[0])


def late(levels: tuple[Level, ...]) -> float:
    last = [level for level in levels if 8 * level.unknowns > levels[-1].unknowns]
    return slope([level.unknowns for level in last], [level.energy for level in last])


def test_uniform_meshes_creep() -> None:
    found = [solve(l_body(l_mesh(cells), 2)) for cells in (4, 8)]
    rate = slope([3 * each.net.count for each in found], [each.energy for each in found])
    assert -0.25 < rate < -0.15


@pytest.mark.slow
@pytest.mark.parametrize(
    ("degree", "most", "least"), [(1, 10_000, -0.28), (2, 20_000, -0.43), (3, 20_000, -0.45)]
)
def test_small_tets_at_the_edge_run(degree: int, most: int, least: float) -> None:
    """`least` is what is seen at so few unknowns; studies/l_block.py goes on to the limit."""
    found = refined(l_body(l_mesh(), degree), most_unknowns=most)
    assert late(found.levels) < least
    # The estimate is worth something beside the truth.
    last = found.levels[-1]
    true = np.sqrt((ENERGY - last.energy) / ENERGY)
    assert 0.7 < last.energy_error / true < 1.5
