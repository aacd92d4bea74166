# SPDX-License-Identifier: BSD-3-Clause
"""Deliberate errors: small, plausible, wrong; each with the tests that have to notice.

`old` stands exactly once in `file`; `tests` are what pytest is given, the quick ones that should
notice. Add one to the table of its kind (python_errors.py, surface_errors.py, refinement_errors.py,
picture_errors.py, core_errors.py) with every new formula; run with ./dev mutants.
"""

from __future__ import annotations

from mutants import python_errors
from mutants.core_errors import CPP
from mutants.mutant import Mutant
from mutants.picture_errors import PICTURES
from mutants.refinement_errors import REFINING
from mutants.surface_errors import SURFACES

__all__ = ["ALL", "CPP", "IN_CI", "PYTHON", "Mutant"]

PYTHON = (*python_errors.PYTHON, *REFINING, *PICTURES, *SURFACES)
IN_CI = (*PYTHON, *CPP[:3])
ALL = (*PYTHON, *CPP)
