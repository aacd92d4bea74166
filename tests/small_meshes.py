# SPDX-License-Identifier: BSD-3-Clause
"""Bodies of few tets, drawn by hypothesis; what fails shrinks to a single tet where it can."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from bezsoma.arrays import Floats, Ints
from bezsoma.mesh import TetMesh, block

ONE = TetMesh(np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]), [[0, 1, 2, 3]])
TWO = TetMesh(np.vstack([ONE.points, [1.0, 1, 1]]), [[0, 1, 2, 3], [1, 2, 3, 4]])


@st.composite
def meshes(draw: st.DrawFn) -> TetMesh:
    """A tet, two that share a face, or an irregular block of two regions."""
    kind = draw(st.sampled_from(["one", "two", "block"]))
    if kind != "block":
        return ONE if kind == "one" else TWO
    cells = draw(st.tuples(st.integers(1, 2), st.integers(1, 2), st.integers(1, 2)))
    irregular = draw(st.sampled_from([0.0, 0.15, 0.3]))
    mesh = block((1.5, 1.0, 0.8), cells=cells, irregular=irregular, seed=draw(st.integers(0, 5)))
    region = (mesh.points[mesh.tets].mean(axis=1)[:, 0] > 0.7).astype(int)
    return TetMesh(mesh.points, mesh.tets, region, ("soft", "stiff"), mesh.surfaces)


frames = st.builds(
    lambda turn, shift, length: (Rotation.from_rotvec(turn).as_matrix(), np.array(shift), length),
    st.tuples(*[st.sampled_from([0.0, 0.5, -1.0, 2.0])] * 3),
    st.tuples(*[st.sampled_from([0.0, 1.0, -700.0])] * 3),
    st.sampled_from([1.0, 1e-3, 1e3]),
)
"""A rotation (3, 3), a shift (3,) mm and a factor of lengths."""

seeds = st.integers(0, 1000)


def renumbered(mesh: TetMesh, seed: int) -> tuple[TetMesh, Ints]:
    """The same mesh with its vertices and tets in another order; old vertex v is new[v] there."""
    random = np.random.default_rng(seed)
    new = random.permutation(len(mesh.points))
    order = random.permutation(len(mesh.tets))
    points = np.empty_like(mesh.points)
    points[new] = mesh.points
    tets = random.permuted(new[mesh.tets[order]], axis=1)
    surfaces = {name: new[facets] for name, facets in mesh.surfaces.items()}
    return TetMesh(points, tets, mesh.region[order], mesh.regions, surfaces), new


def inside(mesh: TetMesh, count: int, seed: int) -> Floats:
    """Points (count, 3) within the body."""
    random = np.random.default_rng(seed)
    tets = random.integers(0, len(mesh.tets), count)
    return np.einsum("pi,pik->pk", random.dirichlet([1.0] * 4, count), mesh.points[mesh.tets[tets]])
