# SPDX-License-Identifier: BSD-3-Clause
"""A preconditioner that is kept as long as it pays."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

from bezsoma.arrays import Floats

COST = 15.0
"""What building a preconditioner costs, in iterations with it: 3 to 16 at degrees 2 and 3
(docs/performance.md)."""

Precondition = Callable[[Floats], Floats]


@dataclass(eq=False)
class Kept:
    """The preconditioner of the last state for which one was built: z = kept(r).

    As strains grow a law that stiffens changes, and what was built at rest takes more iterations
    for each digit. It is built anew, at the state then reached, when the iterations lost against
    the best solve since it was built have come to what building costs: so no more than twice the
    least is ever spent, whatever comes (the rule of who rents skis until he has paid their price).
    Only iterations are counted, no time is taken: the same bits on every machine.

    >>> import numpy as np
    >>> kept = Kept(lambda x: lambda r: r if x is None else r / 4)
    >>> for iterations in (20, 25, 100, 20):
    ...     kept.learn(iterations, rtol=1e-2)
    ...     kept.at(np.zeros(1))
    >>> kept.built, kept(8.0)
    (1, 2.0)
    """

    build: Callable[[Floats | None], Precondition]
    """Builds one for a state x (n,), None at rest."""
    built: int = 0
    least: float = math.inf
    """The fewest iterations a digit since it was built."""
    lost: float = 0.0
    """Iterations beyond those."""
    _of: Precondition | None = field(default=None, repr=False)

    def __call__(self, r: Floats) -> Floats:
        """What it makes of r."""
        if self._of is None:
            self._renew(None)
        assert self._of is not None
        return self._of(r)

    def learn(self, iterations: int, rtol: float) -> None:
        """Hears how many iterations a solve to rtol took."""
        digits = max(-math.log10(rtol), 1.0)
        self.least = min(self.least, iterations / digits)
        self.lost += iterations - self.least * digits

    def failed(self) -> None:
        """Hears that a solve came to nothing: whatever the next costs, it is built anew for it.

        Else one that was built at a state on no way to balance would stay, with nothing better to
        be measured against.
        """
        self.lost = math.inf

    def at(self, x: Floats) -> None:
        """Hears that the tangent at x (n,) comes next."""
        if self.lost > COST:
            self._renew(x)

    def _renew(self, x: Floats | None) -> None:
        self._of = None  # two at once would need twice the memory
        self._of = self.build(x)
        self.built += 1
        self.least, self.lost = math.inf, 0.0
