# SPDX-License-Identifier: BSD-3-Clause
"""VTK's order of the points of a triangle, where it first tells directions apart.

At degree 2 an edge has one inner point, and an edge the wrong way round does not show. From
degree 3 on it does, in surface files, and from degree 5 on in the faces of tets.
"""

from __future__ import annotations

import pytest

from bezsoma.view.lagrange import lattice

# Vertices; edges 01, 12, 20, each from its first to its second vertex; the inside.
VTK_TRIANGLE = {
    3: "300 030 003 210 120 021 012 102 201 111",
    4: "400 040 004 310 220 130 031 022 013 103 202 301 211 121 112",
}


@pytest.mark.parametrize("degree", VTK_TRIANGLE)
def test_the_order_of_a_triangle(degree: int) -> None:
    found = ["".join(map(str, row)) for row in lattice(degree, 2).tolist()]
    assert " ".join(found) == VTK_TRIANGLE[degree]
