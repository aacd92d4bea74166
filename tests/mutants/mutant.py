# SPDX-License-Identifier: BSD-3-Clause
"""What a deliberate error is."""

from __future__ import annotations

from typing import NamedTuple


class Mutant(NamedTuple):
    """One error: `old` in `file` becomes `new`, and one of `tests` has to fail."""

    what: str
    file: str
    old: str
    new: str
    tests: tuple[str, ...]

    @property
    def is_cpp(self) -> bool:
        """Whether the core has to be built again to see it."""
        return self.file.endswith((".cpp", ".hpp"))
