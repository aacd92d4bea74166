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
    compiled: bool = False
    """Whether it sits in what the compiler works out, and needs a build of its own."""
    argued: str = ""
    """Why no test can be expected to notice it, where none does."""

    @property
    def is_cpp(self) -> bool:
        """Whether the core has to be built again to see it."""
        return self.file.endswith((".cpp", ".hpp"))


def errors_in(
    file: str, tests: tuple[str, ...], *texts: tuple[str, str, str]
) -> tuple[Mutant, ...]:
    """Several in one file that the same tests have to notice: what, old, new of each."""
    return tuple(Mutant(what, file, old, new, tests) for what, old, new in texts)
