# SPDX-License-Identifier: BSD-3-Clause
"""The face of the experiments: the Visible Human's where its meshes lie, else the phantom's."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

import bezsoma as bz
from bezsoma.arrays import Floats, Ints
from bezsoma.case.sources import found
from bezsoma.errors import InputError
from bezsoma.imaging.phantom import landmarks
from bezsoma.mechanics.materials import Material
from bezsoma.mechanics.supports import Support
from bezsoma.mesh.locator import Locator
from bezsoma.mesh.topology import EDGES

TAGS = {"skin": 1, "skull": 2, "jaw": 3, "rami": 4, "cut": 5}
PLACES = {
    "chin": (248.0, 137.7, 30.0),
    "fold": (248.0, 141.0, 42.0),
    "lower lip": (248.5, 136.2, 53.0),
    "upper lip": (249.0, 134.2, 66.5),
}
FORWARD = 5.0
"""How far the jaw is moved, mm; the step between jaw and rami is graded over as much."""


@dataclass(frozen=True, eq=False)
class Face:
    """A mesh of the soft tissue with its named surfaces, and points on its skin to look at."""

    name: str
    mesh: bz.TetMesh
    places: Mapping[str, Floats]

    @property
    def held(self) -> list[str]:
        """The bone that stays, and the deep side of the phantom's neck."""
        return [name for name in ("skull", "rami", "neck") if name in self.mesh.surfaces]

    def body(self, degree: int, law: Material, mixed: bool = False) -> bz.Body:
        """The jaw moved forward."""
        supports: list[Support] = [
            bz.Fixed(*self.held),
            bz.Moved("jaw", translation=(0, -FORWARD, 0)),
        ]
        meet = "rami" in self.mesh.surfaces
        joins = [bz.Graded(over="rami", to="jaw", band=FORWARD)] if meet else []
        return bz.Body(self.mesh, degree, law, supports, joins=joins, incompressible=mixed)

    def moved(self, solution: bz.Solution) -> dict[str, Floats]:
        """The displacement (3,) mm of each place; each is put on the skin of its own mesh."""
        points = np.array(list(self.places.values()))
        near = Locator(self.mesh).nearest(points, "skin")
        corners = self.mesh.points[self.mesh.facets_of("skin")[near.facet]]
        on = np.einsum("pi,pid->pd", near.bary, corners)
        u = solution.displacement.at(on, outside="nearest")
        return dict(zip(self.places, u, strict=True))


@cache
def face(size: str = "small") -> Face:
    """The Visible Human's lower face, "small" or "large"; the phantom where its file is missing."""
    file = f"face_{size}/face_{size}.npz"
    try:
        path = found(file, "../shared/data", Path.cwd())
    except InputError:
        phantom = bz.head_phantom("medium" if size == "small" else "large")
        chosen = {name: landmarks()[name] for name in PLACES}
        return Face(f"phantom, {size}", phantom, chosen)
    mesh = bz.read_mesh(path, surfaces=TAGS)
    return Face(f"Visible Human, {size}", mesh, {k: np.array(p) for k, p in PLACES.items()})


def nearest_part(whole: Face, count: int) -> Face:
    """The tets of a face that lie nearest to the lower lip, about `count` of them, in one piece."""
    mesh = whole.mesh
    away = np.linalg.norm(mesh.points[mesh.tets].mean(axis=1) - whole.places["lower lip"], axis=1)
    chosen = np.sort(np.argsort(away, kind="stable")[:count])
    piece = bz.TetMesh(mesh.points, mesh.tets[chosen]).components()
    chosen = chosen[piece == np.bincount(piece).argmax()]
    kept = {}
    for name, facets in mesh.surfaces.items():
        on = np.asarray(np.isin(mesh.tets_of_facets(facets), chosen))
        if on.any():
            kept[name] = facets[on]
    part = bz.TetMesh(mesh.points, mesh.tets[chosen], surfaces=kept)
    return replace(whole, name=f"{whole.name}, the part at the lips", mesh=part)


def eighths(whole: Face) -> Face:
    """The same face with every tet cut in eight (J. Bey, doi:10.1007/BF02238487).

    Geometry and surfaces stay what they are, so what changes is the space alone.
    """
    mesh = whole.mesh
    edges = np.asarray(mesh.all_edges, np.int64)
    points = np.concatenate([mesh.points, mesh.points[edges].mean(axis=1)])
    code = edges[:, 0] * len(mesh.points) + edges[:, 1]
    order = np.argsort(code)

    def middle(a: Ints, b: Ints) -> Ints:
        wanted = np.searchsorted(code, a * len(mesh.points) + b, sorter=order)
        return np.asarray(len(mesh.points) + order[wanted])

    a, b, c, d = np.asarray(mesh.tets, np.int64).T
    ab, ac, ad, bc, bd, cd = (
        middle(*np.asarray(mesh.tets, np.int64)[:, pair].T) for pair in map(list, EDGES)
    )
    corner = [(a, ab, ac, ad), (ab, b, bc, bd), (ac, bc, c, cd), (ad, bd, cd, d)]
    inner = [(ab, ac, ad, bd), (ab, ac, bc, bd), (ac, ad, bd, cd), (ac, bc, bd, cd)]
    tets = np.concatenate([np.stack(each, axis=1) for each in corner + inner])
    fine = bz.TetMesh(
        points, tets, surfaces={k: quarters(f, middle) for k, f in mesh.surfaces.items()}
    )
    return replace(whole, name=f"{whole.name}, in eighths", mesh=fine)


def quarters(facets: Ints, middle: Any) -> Ints:
    """Facets (f, 3) each cut in four by the middles of its edges."""
    a, b, c = np.asarray(facets, np.int64).T
    ab, ac, bc = middle(a, b), middle(a, c), middle(b, c)
    four = [(a, ab, ac), (ab, b, bc), (ac, bc, c), (ab, ac, bc)]
    return np.concatenate([np.stack(each, axis=1) for each in four])
