# SPDX-License-Identifier: BSD-3-Clause
"""The one problem that everything here solves, and how it travels to another process.

A block of 1 mm of Kuhn's tets, E = 1 MPa and nu = 0.3, is clamped below and drawn sideways by a
traction of 0.01 MPa on the middle quarter of its top: a smooth body with a load as in the paper's
figure 6, spread over a patch.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np

import bezsoma as bz

E, NU = 1.0, 0.3
"""Young's modulus in MPa, Poisson's ratio."""
TRACTION = (0.01, 0.0, 0.0)
"""On the patch, MPa."""
RTOL = 1e-8
"""The residual over the free unknowns, relative to that at zero free displacement."""
DEGREES = (1, 2, 3, 4, 6)


@dataclass(frozen=True, eq=False)
class Tets:
    """What every engine gets: points (v, 3) mm, tets (t, 4), facets (f, 3) clamped and loaded."""

    points: np.ndarray[Any, Any]
    tets: np.ndarray[Any, Any]
    bottom: np.ndarray[Any, Any]
    patch: np.ndarray[Any, Any]

    def write(self, path: Path) -> None:
        """Store it; read back by `read_tets`."""
        np.savez(path, **{field.name: getattr(self, field.name) for field in fields(self)})


def read_tets(path: Path) -> Tets:
    """What `Tets.write` stored."""
    with np.load(path) as stored:
        return Tets(**{field.name: stored[field.name] for field in fields(Tets)})


def cells(unknowns: int, degree: int) -> int:
    """How many cells a side give about so many unknowns."""
    return max(1, round(((unknowns / 3) ** (1 / 3) - 1) / degree))


def block(unknowns: int, degree: int) -> bz.TetMesh:
    """The block with about so many unknowns at that degree, with its surface `patch`."""
    mesh = bz.block(cells=cells(unknowns, degree))
    return mesh.with_surface("patch", patch(mesh))


def patch(mesh: bz.TetMesh) -> np.ndarray[Any, Any]:
    """The facets of the top whose middle lies in its middle quarter; all where cells are few."""
    top = mesh.facets_of("top")
    off = np.abs(mesh.points[top].mean(axis=1)[:, :2] - 0.5).max(axis=1)
    return top[off < 0.25] if (off < 0.25).any() else top


def tets(unknowns: int, degree: int) -> Tets:
    """The block as plain arrays."""
    mesh = block(unknowns, degree)
    return Tets(mesh.points, mesh.tets, mesh.facets_of("bottom"), mesh.facets_of("patch"))


def body(mesh: bz.TetMesh, degree: int) -> bz.Body:
    """The block with its supports and load."""
    return bz.Body(
        mesh,
        degree=degree,
        materials=bz.LinearElastic(E=E, nu=NU),
        supports=[bz.Fixed("bottom")],
        loads=[bz.Traction("patch", value=TRACTION)],
    )
