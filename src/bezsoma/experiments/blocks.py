# SPDX-License-Identifier: BSD-3-Clause
"""The block of figures 6 to 8, as the paper has it and as it can be computed.

The paper gives neither the block's size nor its mesh. Here it is 10 x 10 x 5 mm in `cells` x
`cells` x `cells`/2 cells of six Kuhn tets each, E = 1 MPa. Forces pull upwards; the equations of
figures 6 and 7 are linear, so pushing is the mirror image of it.
"""

from __future__ import annotations

from functools import cache

import numpy as np

import bezsoma as bz
from bezsoma.arrays import Floats
from bezsoma.mechanics.materials import Material

SIZE = (10.0, 10.0, 5.0)
CELLS = 4
TETS = 6 * CELLS**3 // 2
MIDDLE = np.array([[5.0, 5.0, 5.0]])
"""The middle of the top, where the force acts."""
HALF = 2.5
"""Half the side of the loaded square, and the side of the four that hold the block, mm."""
CORNERS = tuple((x, y, 0.0) for x in (0.0, SIZE[0]) for y in (0.0, SIZE[1]))


@cache
def slab(cells: int) -> bz.TetMesh:
    """The block with its lower corners named, squares at them, and the square on its top."""
    mesh = bz.block(SIZE, (cells, cells, cells // 2)).with_vertices("corners", CORNERS)
    if cells % 4:
        return mesh  # whose facets do not end where the squares do
    mesh = mesh.with_surface("feet", lambda x: (x[:, 2] == 0) & (beside(x) >= HALF).all(axis=1))
    return mesh.with_surface("patch", lambda x: (x[:, 2] == 5) & (beside(x) <= HALF).all(axis=1))


def beside(points: Floats) -> Floats:
    """How far points (p, 3) lie from the block's middle in x and y (p, 2), mm, to 1e-9."""
    return np.asarray(np.round(np.abs(points[:, :2] - 5), 9))


def at_a_point(cells: int, degree: int, law: Material, force: float, mixed: bool) -> bz.Body:
    """As the paper: held at its lower corners, a force [N] at the middle of the top."""
    held, load = [bz.Fixed("corners")], [bz.PointForce(MIDDLE[0], (0, 0, force))]
    return bz.Body(slab(cells), degree, law, held, load, incompressible=mixed)


def on_squares(cells: int, degree: int, law: Material, force: float, mixed: bool) -> bz.Body:
    """As it can be computed: held on squares at the corners, the force spread over a square."""
    held, load = [bz.Fixed("feet")], [bz.Traction("patch", value=(0, 0, force / (2 * HALF) ** 2))]
    return bz.Body(slab(cells), degree, law, held, load, incompressible=mixed)


BLOCKS = {"points": at_a_point, "squares": on_squares}
"""Both by what holds and loads them."""


def pulled(
    held: str, cells: int, degree: int, law: Material, force: float, mixed: bool = False
) -> bz.Body:
    """One of the two blocks, to be solved."""
    return BLOCKS[held](cells, degree, law, force, mixed)


def lifted(solution: bz.Solution) -> float:
    """How far the middle of the top has moved up, mm."""
    found: Floats = solution.displacement.at(MIDDLE)
    return float(found[0, 2])
