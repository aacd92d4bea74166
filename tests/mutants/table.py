# SPDX-License-Identifier: BSD-3-Clause
"""Deliberate errors: small, plausible, wrong; each with the tests that have to notice.

`old` stands exactly once in `file`; `tests` are what pytest is given, the quick ones that should
notice. Add one with every new formula to the table of its kind: python_errors.py,
mixed_errors.py, picture_errors.py, refinement_errors.py, surface_errors.py; core_errors.py,
kernel_errors.py, solver_errors.py. Run with ./dev mutants.
"""

from __future__ import annotations

from mutants import python_errors
from mutants.core_errors import CORE_ERRORS
from mutants.kernel_errors import KERNELS
from mutants.mixed_errors import MIXING
from mutants.mutant import Mutant
from mutants.picture_errors import PICTURES
from mutants.refinement_errors import REFINING
from mutants.solver_errors import MATRICES, SOLVERS
from mutants.surface_errors import SURFACES

__all__ = ["ALL", "CPP", "IN_CI", "PYTHON", "Mutant"]

PYTHON = (*python_errors.PYTHON, *MIXING, *REFINING, *PICTURES, *SURFACES)
CPP = (*CORE_ERRORS, *KERNELS, *SOLVERS)
IN_CI = (*PYTHON[::4], *MATRICES)
"""A choice that takes minutes; the verdicts on all are recorded, see record.py."""
ALL = (*PYTHON, *CPP)
