# SPDX-License-Identifier: BSD-3-Clause
"""What a verification problem is: a statement from elsewhere, and the numbers that are found."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from functools import partial
from typing import Any

ANALYTICAL, PUBLISHED, LAW = "analytical", "published", "law"
KINDS = {
    ANALYTICAL: "a formula gives the answer",
    PUBLISHED: "somebody else's number, or another code's",
    LAW: "a law that every answer obeys, whatever it is",
}
EQUAL, AT_LEAST, AT_MOST = "=", ">=", "<="


@dataclass(frozen=True)
class Value:
    """One number that was found, and what it has to be.

    `within` is relative to `wanted`, absolute where that is zero. A rate has to be at least, an
    error at most what is wanted.
    """

    of: str
    where: str
    found: float
    wanted: float
    within: float = 0.0
    sense: str = EQUAL

    @property
    def off(self) -> float:
        """How far it is from what is wanted, as `within` is meant."""
        scale = abs(self.wanted) if self.wanted and self.sense == EQUAL else 1.0
        away = (self.found - self.wanted) / scale
        return {EQUAL: abs(away), AT_LEAST: max(-away, 0.0), AT_MOST: max(away, 0.0)}[self.sense]

    @property
    def good(self) -> bool:
        """Whether it is near enough; not a number never is."""
        return self.off <= self.within


@dataclass(frozen=True)
class Problem:
    """A problem with its source, its answer in a formula or a number, and why the tolerance."""

    family: str
    name: str
    kind: str
    source: str
    answer: str
    why: str
    values: Callable[[], Iterable[Value]]

    def __str__(self) -> str:
        return f"{self.family}: {self.name}"


Values = Callable[..., Iterable[Value]]


@dataclass(frozen=True)
class Family:
    """The problems of a family, in the order in which a page shows them."""

    name: str
    about: str
    problems: list[Problem] = field(default_factory=list)

    def __iter__(self) -> Iterator[Problem]:
        return iter(self.problems)

    def __len__(self) -> int:
        return len(self.problems)

    def add(
        self, name: str, kind: str, source: str, answer: str, why: str, values: Values, *given: Any
    ) -> None:
        """One more problem; what is given is handed to the function of its values."""
        self.problems.append(
            Problem(self.name, name, kind, source, answer, why, partial(values, *given))
        )


EXACT = "the answer lies in the space of this degree, so only rounding is left"
ROUNDING = "two sums of the same numbers, in another order"
"""Reasons that many share."""
