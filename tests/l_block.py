# SPDX-License-Identifier: BSD-3-Clause
"""An L-shaped block: nothing is singular on it but the one edge that points inward.

Traction pulls the end of one arm, rollers hold the others. A roller beside a free side is a plane
of symmetry and stays smooth, so that all error that does not go away is at the edge, where the
displacement is of the order r^0.5445 (270 degrees, both sides free, plane strain, any nu: M. L.
Williams, J. Appl. Mech. 19, 1952).
"""

from __future__ import annotations

from bezsoma.mechanics import Fixed, LinearElastic, Traction
from bezsoma.mechanics.body import Body
from bezsoma.mesh.solids import block
from bezsoma.mesh.tets import TetMesh

NEAR = 1e-9
ENERGY = 4.32345e-3
"""What the block stores, N mm: degree 4 on meshes of up to 290 000 unknowns, the last three
extrapolated with an error of N^-0.5445 in the energy norm."""


def l_mesh(cells: int = 1, thickness: float = 0.5) -> TetMesh:
    """The block (-1, 1)^2 without its quadrant x > 0 > y, mm; so many cells a mm."""
    layers = max(1, round(cells * thickness))
    whole = block((2, 2, thickness), (2 * cells, 2 * cells, layers), origin=(-1, -1, 0))
    x, y, _ = whole.points[whole.tets].mean(axis=1).T
    mesh = TetMesh(whole.points, whole.tets[~((x > 0) & (y < 0))])
    sides = {"left": (0, -1), "front": (1, -1), "right": (0, 1), "floor": (2, 0)}
    for name, (axis, at) in {**sides, "roof": (2, thickness)}.items():
        mesh = mesh.with_surface(name, lambda p, axis=axis, at=at: abs(p[:, axis] - at) < NEAR)
    return mesh


def l_body(mesh: TetMesh, degree: int) -> Body:
    """Pulled at the right, on rollers elsewhere: plane strain."""
    rollers = [
        Fixed("left", components="x"),
        Fixed("front", components="y"),
        Fixed("floor", "roof", components="z"),
    ]
    pull = Traction("right", value=(0.1, 0, 0))
    return Body(mesh, degree, LinearElastic(1.0, 0.3), rollers, [pull])
