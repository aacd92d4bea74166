# SPDX-License-Identifier: BSD-3-Clause
"""How much of an error a higher degree does not see, told from two higher degrees.

Beside an edge where stress is singular an error falls with the degree k on fixed tets like a power
of k, and so two more degrees see a part of it only. With k, k + 1 and k + 2 at hand the power can
be told (B. A. Szabo and I. Babuska, Finite Element Analysis, 1991, sec. 4.2: the same from the
energies of three degrees). Above degree 1 only degree 2 is looked at, and the power is taken as
`FIRST`.
"""

from __future__ import annotations

from scipy.optimize import brentq

SLOWEST = 1.0
"""The least power that is believed: stress then grows as distance^(-3/4), past a crack's 1/2."""
FASTEST = 60.0
"""The greatest: nothing is left to be seen."""
FIRST = 4.0
"""That of degree 1, which is compared with degree 2 alone: most of what it lacks is curvature, and
degree 2 was seen to find 0.92 to 0.99 of what 3 does, on tets that show the solution at all."""


def share(rate: float, degree: int, by: int) -> float:
    """The part of an energy of error ~ degree^-rate that `by` more degrees see [-].

        1 - (k / (k + r))^s

    >>> share(2.0, 1, 1), round(share(2.0, 4, 2), 3), share(float("inf"), 4, 2)
    (0.75, 0.556, 1.0)
    """
    return 1.0 - float((degree / (degree + by)) ** rate)


def decay(ratio: float, degree: int) -> float:
    """The rate s at which an energy of error falls with the degree, from what was seen of it.

    `ratio` is what one degree more sees over what two see: share(s, k, 1) / share(s, k, 2).
    Smooth errors fall so fast that one degree sees all; their rate is `FASTEST`.

    >>> round(decay(share(2.18, 3, 1) / share(2.18, 3, 2), 3), 9)
    2.18
    >>> decay(1.0, 3) == FASTEST, decay(0.1, 3) == SLOWEST
    (True, True)
    """

    def too_much(rate: float) -> float:
        return share(rate, degree, 1) / share(rate, degree, 2) - ratio

    if too_much(SLOWEST) >= 0:
        return SLOWEST
    if too_much(FASTEST) <= 0:
        return FASTEST
    return float(brentq(too_much, SLOWEST, FASTEST))


def limit(first: float, second: float, rate: float, degree: int) -> float:
    """Where a change goes as the degree grows, from what one and two more degrees make of it.

    A change A + S share(s, k, r) after r more degrees ends at A + S: of the part A that is smooth
    the first degree sees all, of the singular part S its share.

    >>> seen = [3.0 + 2.0 * share(2.18, 3, by) for by in (1, 2)]
    >>> round(limit(*seen, 2.18, 3), 12)
    5.0

    Where the smooth part is not yet seen by the first degree, the two tell little of the limit: so
    it is taken to lie between half and twice what the second says.

    >>> limit(5.0, 1.0, 2.18, 3), limit(-5.0, 1.0, 2.18, 3)
    (0.5, 2.0)
    """
    one, two = share(rate, degree, 1), share(rate, degree, 2)
    if two <= one:
        return second
    ends = second / 2, 2 * second
    told = second + (second - first) * (1 - two) / (two - one)
    return min(max(told, min(ends)), max(ends))
