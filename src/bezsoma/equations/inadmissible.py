# SPDX-License-Identifier: BSD-3-Clause
"""States that a law cannot bear, told with their place."""

from __future__ import annotations

import numpy as np

from bezsoma import _core
from bezsoma.arrays import Floats
from bezsoma.errors import Inadmissible
from bezsoma.mesh.tets import TetMesh

OVERFLOW = 700.0
"""exp of 709.8 is the last that float64 holds; more than this is refused."""


def refuse_inadmissible(
    kernel: _core.Pointwise, mesh: TetMesh, points: Floats, found: Floats
) -> None:
    """Raises `Inadmissible` if what the kernel found last cannot be used, and says where."""
    J, tet, point = kernel.least_jacobian
    if not J > 0:
        why = "the tissue is turned inside out there"
        raise _inadmissible("J", J, tet, points[point], mesh, why)
    exponent, tet, point = kernel.greatest_exponent
    if not exponent <= OVERFLOW:
        why = "its exponential leaves the range of numbers"
        raise _inadmissible("exponent", exponent, tet, points[point], mesh, why)
    if not np.isfinite(found).all():
        raise _inadmissible("number", np.nan, max(tet, 0), points[point], mesh, "it overflows")


def _inadmissible(
    what: str, value: float, tet: int, point: Floats, mesh: TetMesh, why: str
) -> Inadmissible:
    at = point @ mesh.points[mesh.tets[tet]]
    region = mesh.regions[mesh.region[tet]]
    return Inadmissible(
        f"{what} = {value:.4g} in region {region!r}, tet {tet} at {np.round(at, 3)} mm: {why}; "
        "a smaller step of the load may get past it",
        what,
        value,
        tet,
        region,
        (float(at[0]), float(at[1]), float(at[2])),
    )
