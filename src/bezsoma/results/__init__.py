# SPDX-License-Identifier: BSD-3-Clause
"""The folder that a run leaves, whole or not at all, and how it is read back without loss."""

from __future__ import annotations

from bezsoma.results.archive import Results, read_results, write_fields
from bezsoma.results.folder import Destination, destination

__all__ = ["Destination", "Results", "destination", "read_results", "write_fields"]
