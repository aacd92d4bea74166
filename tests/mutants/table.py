# SPDX-License-Identifier: BSD-3-Clause
"""Deliberate errors: small, plausible, wrong; each with the tests that have to notice.

`old` stands exactly once in `file`; `tests` are what pytest is given, the quick ones that should
notice. Add one to python_errors.py or core_errors.py with every new formula; run with
./dev mutants.
"""

from __future__ import annotations

from mutants.core_errors import CPP
from mutants.mutant import Mutant
from mutants.python_errors import PYTHON

__all__ = ["ALL", "CPP", "IN_CI", "PYTHON", "Mutant"]

IN_CI = (*PYTHON, *CPP[:3])
ALL = (*PYTHON, *CPP)
