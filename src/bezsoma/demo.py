# SPDX-License-Identifier: BSD-3-Clause
"""The demo: the whole way from a CT to a predicted face, of a head that is made by formula.

Nothing here is special to it: a CT is written to a file, and what follows is what `bezsoma model`
and `bezsoma run` do.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from bezsoma.case.reading import read_case
from bezsoma.case.running import Progress, run_case, silent
from bezsoma.errors import InputError
from bezsoma.imaging.around import head_around
from bezsoma.imaging.domain import DomainSettings, domain
from bezsoma.imaging.head_ct import head_ct
from bezsoma.imaging.nrrd import write_volume
from bezsoma.imaging.settings import LabelSettings
from bezsoma.model import ModelSettings, run_model
from bezsoma.results import Results
from bezsoma.results.folder import written
from bezsoma.view.named import head_picture

Size = Literal["small", "large"]
CT, MODEL, PREDICTION, HEAD = "ct.nrrd", "model", "prediction", "head.png"
OURS = {CT, MODEL, PREDICTION, HEAD}
"""All that the folder of a demo holds."""


@dataclass(frozen=True)
class Head:
    """How fine a demo is: voxels in mm, tets, the gap in mm of joints and teeth, and the domain.

    A gap under a voxel would join mandible and skull; cells wider than the flesh under the skin
    would leave holes in it, so few tets have to do with less of the face.
    """

    voxel: float
    tets: int
    gap: float
    domain: DomainSettings = field(default_factory=DomainSettings)


LOWER_FACE = DomainSettings(above=-8.0, behind=-20.0)
"""Ends below the joints and in front of the hind borders of the rami."""


HEADS = {"small": Head(2.0, 24_000, 3.0, LOWER_FACE), "large": Head(1.5, 60_000, 2.5)}


def run_demo(
    size: Size,
    folder: Path | str,
    *,
    overwrite: bool = False,
    degree: int = 3,
    progress: Progress = silent,
) -> Results:
    """Go the whole way at one of two sizes and leave a folder: the CT, model, prediction, head.png.

    Gives the results of the prediction. What an earlier demo left there goes on, or is replaced
    with `overwrite`.
    """
    place, head = Path(folder), HEADS[size]
    _check(place, overwrite)
    with written(place):
        place.mkdir(exist_ok=True)
    progress("ct", None, "of a head, by formula")
    ct = head_ct((head.voxel,) * 3, joint=head.gap, bite=head.gap).volume
    write_volume(place / CT, ct.values, ct.frame, overwrite=True)
    wide = LabelSettings(coarse=head.voxel)  # its joints are wide enough for voxels as they are
    settings = ModelSettings(
        labels=wide, domain=head.domain, tets=head.tets, degree=degree, forward=6.0
    )
    model = run_model(place / CT, place / MODEL, settings, overwrite=overwrite, progress=progress)
    case = read_case(model.case)
    results = run_case(case, place / PREDICTION, overwrite=overwrite, progress=progress)
    progress("head", None, "drawing it with the predicted part in place")
    labels = model.labels
    around = head_around(labels, domain(labels, settings.domain))
    title = f"{case.title} (degree {degree})"
    head_picture(place / HEAD, results.mesh, results.displacement, around, title=title,
                 overwrite=True)  # fmt: skip
    return results


def _check(place: Path, overwrite: bool) -> None:
    """Refuses a folder that holds what no demo wrote, or a demo, unless it may be replaced."""
    if not place.parent.is_dir():
        raise InputError(f"there is no folder {str(place.parent)!r}; make it first")
    if not place.exists():
        return
    if not place.is_dir() or {path.name for path in place.iterdir()} - OURS:
        raise InputError(
            f"{str(place)!r} holds what BezSoma did not write and will not touch; choose another "
            "folder with -o"
        )
    if any(place.iterdir()) and not overwrite:
        raise InputError(
            f"{str(place)!r} holds a demo already; choose another folder with -o, or replace it "
            "with --overwrite"
        )
