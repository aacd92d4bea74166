# SPDX-License-Identifier: BSD-3-Clause
"""Cook's membrane of neo-Hooke, and a block that is twisted and compressed."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import skfem
from scipy.sparse.linalg import spsolve
from skfem.helpers import dot

import bezsoma as bz
from bezsoma.mesh import cook
from cases.cook_plane import graded
from twins.neo_hooke import forms

MU, NU = 80.1938, 0.3
LAM = 2 * MU * NU / (1 - 2 * NU)
LOAD = 6.25
"""100 N over 16 x 1 mm2, as the membrane is loaded at finite strain; its corner rises 8 mm."""


change, internal = forms(MU, LAM)


@skfem.LinearForm
def pull(v: Any, w: Any) -> Any:
    """The load along y."""
    return LOAD * dot(np.array([0.0, 1.0])[:, None, None] * np.ones_like(v), v)


def corner_in_plane_strain(layers: int) -> Any:
    """The displacement of the upper corner by scikit-fem: triangles of degree 3, graded."""
    mesh = graded(layers).with_boundaries({"loaded": lambda x: x[0] > 48 - 1e-9})
    element = skfem.ElementVector(skfem.ElementTriP3())
    basis = skfem.Basis(mesh, element, intorder=8)
    load = pull.assemble(skfem.FacetBasis(mesh, element, facets="loaded", intorder=6))
    held = np.flatnonzero(basis.doflocs[0] < 1e-9)
    free, x = np.setdiff1d(np.arange(basis.N), held), np.zeros(basis.N)
    for part in (0.5, 1, 1, 1, 1, 1, 1):
        u = basis.interpolate(x)
        K, f = change.assemble(basis, u=u), internal.assemble(basis, u=u)
        x[free] += spsolve(K[free][:, free].tocsc(), (part * load - f)[free])
    return np.asarray(basis.interpolator(x)(np.array([[48.0], [60.0]]))).ravel()


def corner(degree: int) -> Any:
    """The same by BezSoma: a slab of 4 x 4 x 1 cells between smooth walls."""
    sides = [bz.Fixed("clamped"), bz.Fixed("front", "back", components="z")]
    load = [bz.Traction("loaded", value=(0, LOAD, 0))]
    law = bz.NeoHooke(2 * MU * (1 + NU), NU)
    body = bz.Body(cook(cells=(4, 4, 1), thickness=8), degree, law, sides, load)
    return bz.solve(body).displacement.at(np.array([[48.0, 60.0, 4.0]]))[0, :2]


def test_cooks_membrane_of_neo_hooke() -> None:
    """The same membrane in plane strain by another code, in the plane, on another mesh."""
    reference = corner_in_plane_strain(4)
    off = [np.abs(corner(degree) - reference).max() / reference[1] for degree in (2, 4)]
    assert reference[1] > 5
    assert off[0] < 0.05 and off[1] < 0.01 and off[1] < off[0] / 2


def twisted(degree: int, law: Any, **more: Any) -> bz.Solution:
    """A cube whose top is turned by 60 degrees and pressed down by a fifth."""
    top = {"translation": (0, 0, -0.2), "axis": (0, 0, 1), "angle": np.radians(60)}
    supports = [bz.Fixed("bottom"), bz.Moved("top", about=(0.5, 0.5, 0), **top)]
    return bz.solve(bz.Body(bz.block(), degree, law, supports, **more), solver="direct")


@pytest.mark.parametrize(
    ("law", "more"),
    [(bz.NeoHooke(1.0, 0.3), {}), (bz.NeoHooke(1.0, 0.5), {"incompressible": True})],
)
def test_twisted_block_converges_with_the_degree(law: Any, more: Any) -> None:
    """Energies come down, ever less; what is asked of one end is borne by the other."""
    found = [twisted(degree, law, **more) for degree in (2, 3, 4)]
    energies = np.array([each.energy for each in found])
    steps = -np.diff(energies) / energies[-1]
    assert (steps > 0).all(), "a conforming space cannot do better than the next"
    assert steps[1] < steps[0] / 2
    for each in found:
        bottom, top = each.reactions["bottom"], each.reactions["top"]
        assert np.abs(bottom.force + top.force).max() < 1e-8
    if more:
        assert max(abs(each.volume_change) for each in found) < 1e-10
