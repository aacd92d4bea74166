# SPDX-License-Identifier: BSD-3-Clause
"""The figures of the paper and what they lead to, each a script: `bezsoma experiment NAME`.

Every module has `measured(quick)`, the numbers, `finding(tables)`, what they say in words, and
`told(tables)`, the page and the pictures. Words are made from the numbers alone, so that a test
makes those of `docs/experiments` again from the tables that stand beside them. Quick numbers are
some of the rows of the full ones, the same to the last digit that is held; a test compares them
with those that `docs/experiments` prints.
"""

from __future__ import annotations

from bezsoma.experiments.run import EXPERIMENTS, run_experiment

__all__ = ["EXPERIMENTS", "run_experiment"]
