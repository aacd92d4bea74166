# SPDX-License-Identifier: BSD-3-Clause
"""What a fresh interpreter has to run first, to import the package and core that this one has."""

from __future__ import annotations

import sys
from pathlib import Path

import bezsoma
import bezsoma._core


def prelude() -> str:
    """Python text; the core may lie beside the sources or, installed for editing, apart."""
    places = [*map(str, bezsoma.__path__), str(Path(str(bezsoma._core.__file__)).parent)]
    return (
        f"import sys; sys.path[:0] = {sys.path!r}\n"
        f"import bezsoma; bezsoma.__path__[:] = {list(dict.fromkeys(places))!r}\n"
    )
