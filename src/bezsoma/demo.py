# SPDX-License-Identifier: BSD-3-Clause
"""The demo: a head made by formula, its jaw moved 6 mm forward, as a case like any other.

The case is a text, so that the results folder holds a file that a newcomer can change and run.
"""

from __future__ import annotations

from pathlib import Path
from typing import Literal

from bezsoma.case.reading import Case, case_from
from bezsoma.case.running import Progress, run_case, silent
from bezsoma.imaging.phantom import landmarks
from bezsoma.results import Results

Size = Literal["small", "medium", "large"]

TEXT = """\
# A head made by formula; its lower jaw is moved 6 mm forward. Lengths mm, moduli MPa.
# Change a number and run it again: bezsoma run case.toml -o another-folder
title = "Demo: the lower jaw moves 6 mm forward"
degree = 3

[mesh]
phantom = "{size}"

[materials.tissue]
E = 0.015     # MPa: soft tissue of the face
nu = 0.45

[[support]]   # the skull, the back of the jaw and the deep side of the neck stay where they are
type = "fixed"
on = ["skull", "rami", "neck"]

[[support]]   # x to the patient's left, y to the back, z up: forward is -y
type = "moved"
on = "jaw"
translation = [0, -6, 0]

[[join]]      # where the moved jaw meets the rami, the step is spread over 10 mm
type = "graded"
over = "rami"
to = "jaw"
band = 10

{probes}[output]
pictures = ["three-quarter", "front"]
"""
PROBE = """\
[[probe]]{remark}
name = "{name}"
point = [{x:.3g}, {y:.4g}, {z:.3g}]
on = "skin"

"""
LOOKED_AT = ("chin", "fold", "lower lip", "upper lip", "nose tip")
REMARK = "     # where to look: the point of the skin nearest to this one"


def run_demo(
    size: Size,
    folder: Path | str,
    *,
    overwrite: bool = False,
    degree: int = 3,
    progress: Progress = silent,
) -> Results:
    """Solve the demo at one of three sizes and leave its results folder."""
    return run_case(demo_case(size), folder, overwrite=overwrite, degree=degree, progress=progress)


def demo_case(size: Size) -> Case:
    """The demo as a case."""
    return case_from(Path("demo.toml"), demo_text(size))


def demo_text(size: Size) -> str:
    """The text of the case, its probes at landmarks of the phantom."""
    places = landmarks()
    probes = [
        PROBE.format(
            name=name.replace(" ", "_"),
            remark="" if number else REMARK,
            **dict(zip("xyz", places[name], strict=True)),
        )
        for number, name in enumerate(LOOKED_AT)
    ]
    return TEXT.format(size=size, probes="".join(probes))
