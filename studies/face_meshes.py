# SPDX-License-Identifier: BSD-3-Clause
"""Two meshes of one face: that of `bezsoma model` beside face_large, which was made another way.

The whole mandible moves 5 mm forward at degree 2, nu = 0.45, the skull held and the cut free. Both
predictions are compared at the vertices of the skin of face_large. Run as

    bezsoma model ../shared/data/visible_human_head/head_ct.nrrd -o model --settings box.toml
    python studies/face_meshes.py model

with face_large where the cases look for it, and for its region in box.toml

    [domain]
    low = [166.5, 120, 11.5]
    high = [331, 227.5, 91.5]

docs/theory/tetrahedra.md has what it prints.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import bezsoma as bz
from bezsoma.case.sources import mesh_of

NEAR = 15.0
"""mm: vertices of the skin so near to the chin, the fold or the lower lip are of their skin."""
FORWARD = (0.0, -5.0, 0.0)
"""mm, to the front."""


def forward(mesh: bz.TetMesh, *jaw: str) -> bz.Field:
    """The displacement of a mesh whose jaw moves, mm."""
    held = [bz.Fixed("skull"), bz.Moved(*jaw, translation=FORWARD)]
    return bz.solve(bz.Body(mesh, 2, bz.LinearElastic(0.015, 0.45), held)).displacement


def main(words: list[str]) -> None:
    """Print how far the predictions are apart."""
    folder = Path(__file__).parent.parent / "cases"
    case = bz.read_case(folder / "face_large_opening.toml")
    known, model = mesh_of(case), bz.read_mesh(Path(words[0]) / "mesh.npz")
    one, other = forward(known, "jaw", "rami"), forward(model, "mandible")
    points = known.points[np.unique(known.surfaces["skin"])]
    moved, apart = one.at(points), other.at(points, outside="nearest")
    far = np.linalg.norm(moved - apart, axis=1)
    probes = {probe.name: np.array(probe.point) for probe in case.file.probe}
    lips = [probes[name] for name in ("chin", "fold", "lower_lip")]
    near = np.min([np.linalg.norm(points - each, axis=1) for each in lips], axis=0) < NEAR
    print(
        f"skin of chin and lower lip, {near.sum()} vertices: {far[near].mean():.2f} mm in the mean,"
    )
    print(f"{far[near].max():.2f} at most; all of the skin: {far.mean():.2f} and {far.max():.2f}")
    for name in ("chin", "fold", "lower_lip", "upper_lip"):
        at = [field.at([probes[name]], outside="nearest")[0].round(2) for field in (one, other)]
        print(name, *(" ".join(f"{value:.2f}" for value in each) for each in at), sep=" | ")


if __name__ == "__main__":
    main(sys.argv[1:])
