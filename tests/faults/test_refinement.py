# SPDX-License-Identifier: BSD-3-Clause
"""What cannot be refined is refused, and the message says what can."""

from __future__ import annotations

from typing import Any

import pytest

from bezsoma.errors import InputError
from bezsoma.refinement.goals import PatchMean
from bezsoma.refinement.loop import refined
from l_block import l_body, l_mesh

ASKED: dict[str, tuple[dict[str, Any], str]] = {
    "nothing is below": ({"tolerance": 0.0, "at": "right"}, "give more than 0"),
    "negative": ({"tolerance": -0.1, "at": "right"}, "give more than 0"),
    "no number": ({"tolerance": "0.1 mm", "at": "right"}, r"tolerance \(mm\)"),
    "of what": ({"tolerance": 0.1}, "of what\\? Name where: at='skin'"),
    "unknown surface": ({"tolerance": 0.1, "at": "rihgt"}, "did you mean 'right'"),
    "unknown surface of a goal": (
        {"tolerance": 0.1, "at": PatchMean("skin", at=(0, 0, 0), radius=1, direction="x")},
        "no surface 'skin'; this mesh has",
    ),
    "a point": ({"tolerance": 0.1, "at": (0.0, 0.0, 0.0)}, "give the name of a surface"),
    "energy": ({"energy": 0}, "energy, .* give more than 0"),
    "way": ({"energy": 0.1, "by": "hp"}, "by 'mesh', by 'degree', or by 'both'"),
    "unknowns": ({"energy": 0.1, "most_unknowns": 0}, "most_unknowns"),
    "too many to begin with": ({"energy": 0.1, "most_unknowns": 9}, "first level has 48 unknowns"),
    "seconds": ({"energy": 0.1, "most_seconds": -1}, "most_seconds"),
    "solver": ({"energy": 0.1, "solver": "magic"}, "no solver 'magic'"),
}


@pytest.mark.parametrize("fault", ASKED)
def test_what_cannot_be_asked_is_refused(fault: str) -> None:
    asked, words = ASKED[fault]
    with pytest.raises(InputError, match=words):
        refined(l_body(l_mesh(), 1), **asked)


def test_only_a_body_is_refined() -> None:
    with pytest.raises(InputError, match="it refines a Body"):
        refined(l_mesh(), energy=0.1)  # type: ignore[arg-type]
