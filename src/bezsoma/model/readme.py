# SPDX-License-Identifier: BSD-3-Clause
"""The README.txt of a model folder: what was found, how good the mesh is, what each file is."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from bezsoma.results.archive import NOTICE

TEXT = """\
A model made from a CT
======================

{notice} Do not base treatment on it.

LOOK at labels.png first: is the mandible (blue) whole, is the skull none of it, is skin skin?
Then at mesh.png: is the part that may move the one you want? If not, change a copy of model.toml:

    bezsoma model CT --settings changed.toml -o another-folder

Found, cm3: {volumes}.
{notes}
{mesh}

Files:
  labels.png          the labels over the CT: three planes, and three views of skin and bones
  labels.seg.nrrd     the labels; 3D Slicer opens them with names and colours
  mesh.png            the mesh and its named surfaces
  mesh.npz            the mesh: bezsoma mesh info mesh.npz
  landmarks.mrk.json  points of the skin found by form, for 3D Slicer
  case.toml           the mandible moves forward; change it as you like, then: bezsoma run case.toml
  model.toml          every setting with which this was made
  model.json          what stage was done with what, for programs
"""


def readme(labels: Mapping[str, Any], mesh: Mapping[str, Any]) -> str:
    """The text, from what the stages said of themselves."""
    volumes = ", ".join(f"{name} {size:.4g}" for name, size in labels["cm3"].items())
    notes = [f"  - {note}" for note in (*labels["notes"], *mesh["notes"])]
    return TEXT.format(
        notice=NOTICE, volumes=volumes, notes="\n".join(notes), mesh=described(mesh["report"])
    )


def described(report: Mapping[str, Any]) -> str:
    """Size and quality of a mesh in a few lines.

    >>> print(described({"tets": 9, "vertices": 8, "least_dihedral": 20.0, "largest_dihedral": 150,
    ...                  "mean_ratio_mean": 0.9, "volume": 2e5, "off_voxels": {"skin": 0.25}}))
    9 tets, 8 vertices, 200 cm3; dihedral angles 20.0 to 150.0 degrees, mean ratio 0.90 (best 1).
    Mean distance of surfaces from those of the labels, in voxels: skin 0.25.
    """
    off = ", ".join(f"{name} {value:.2f}" for name, value in report["off_voxels"].items())
    return (
        f"{report['tets']} tets, {report['vertices']} vertices, {report['volume'] / 1e3:.4g} cm3; "
        f"dihedral angles {report['least_dihedral']:.1f} to {report['largest_dihedral']:.1f} "
        f"degrees, mean ratio {report['mean_ratio_mean']:.2f} (best 1).\n"
        f"Mean distance of surfaces from those of the labels, in voxels: {off}."
    )
