# SPDX-License-Identifier: BSD-3-Clause
"""What each level of a refinement came to, and all of them as a table."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

from bezsoma.solvers.solution import Solution


@dataclass(frozen=True)
class At:
    """The mean displacement (g,) mm at a place, one number for each goal, and its error, mm.

    `error` is the length of the estimated errors (`GoalEstimate.size`) of all its goals; `product`
    that of what they cannot exceed, the product of energy errors, which is rarely near.
    """

    name: str
    value: tuple[float, ...]
    error: float
    product: float


@dataclass(frozen=True)
class Level:
    """One mesh and degree: its size, the estimated errors of its solution, and what it took.

    `energy` is the stored one, N mm; `energy_error` is relative, in the energy norm [-]; `by` says
    what led here: "start", "mesh" or "degree"; `iterations` are those of the solve; `seconds` cover
    refining, solving and estimating.
    """

    by: str
    degree: int
    tets: int
    unknowns: int
    energy: float
    energy_error: float
    at: tuple[At, ...]
    iterations: int
    seconds: float

    @property
    def error(self) -> float:
        """The largest error at any place, mm; 0 where none was named."""
        return max((each.error for each in self.at), default=0.0)


@dataclass(frozen=True, eq=False)
class Refined:
    """The last solution and the levels that led to it.

    `reached` is whether every error that was asked for is below its tolerance, by estimates (so it
    is where none was asked for, unless a level could not be solved); `why` says why the levels
    ended. `warnings` say what makes an estimate of the last level meaningless, where anything does.
    """

    solution: Solution
    levels: tuple[Level, ...]
    reached: bool
    why: str
    warnings: tuple[str, ...] = ()

    def summary(self) -> dict[str, Any]:
        """The same for a JSON file."""
        return {
            "reached": self.reached,
            "why": self.why,
            "warnings": list(self.warnings),
            "levels": [asdict(level) for level in self.levels],
        }

    def __str__(self) -> str:
        return f"{table([asdict(level) for level in self.levels])}\n{self.why}"


def table(levels: Sequence[Any]) -> str:
    """The levels, one line each, from a summary: sizes, errors in % and mm, seconds.

    >>> at = {"name": "chin", "value": [0.1, -4.2, 0.3], "error": 0.06, "product": 0.4}
    >>> level = {"by": "start", "degree": 2, "tets": 48, "unknowns": 375, "energy_error": 0.08,
    ...     "at": [at], "iterations": 12, "seconds": 0.5}
    >>> print(table([level]))
    level by     degree      tets  unknowns  energy error  chin, mm       s
        0 start       2        48       375           8 %      0.06     0.5
    """
    names = [each["name"] for each in levels[0]["at"]]
    wide = [max(8, len(name) + 4) for name in names]
    head = "level by     degree      tets  unknowns  energy error"
    head += "".join(f"  {name + ', mm':>{w}}" for name, w in zip(names, wide, strict=True))
    return "\n".join([f"{head}{'s':>8}", *(_line(i, each, wide) for i, each in enumerate(levels))])


def _line(number: int, level: Any, wide: list[int]) -> str:
    errors = zip(level["at"], wide, strict=True)
    return (
        f"{number:5} {level['by']:<7}{level['degree']:6}{level['tets']:10}{level['unknowns']:10}"
        f"{100 * level['energy_error']:12.3g} %"
        + "".join(f"  {each['error']:{w}.2g}" for each, w in errors)
        + f"{level['seconds']:8.1f}"
    )
