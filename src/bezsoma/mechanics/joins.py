# SPDX-License-Identifier: BSD-3-Clause
"""What holds where two supports meet and prescribe different displacements.

There the prescribed displacement jumps, and the energy of a jump grows without bound as the
mesh or the degree is refined. Nothing is decided silently: one of these three says what holds.
"""

from __future__ import annotations

from dataclasses import dataclass

from bezsoma.errors import InputError
from bezsoma.mechanics.checks import names, number


@dataclass(frozen=True)
class Precedence:
    """`place` has precedence `over` another: on what they share, its displacement holds.

    The jump stays, one element wide: no claim of convergence near it.

    >>> Precedence("jaw", over="rami").places
    ('jaw', 'rami')
    """

    place: str
    over: str

    def __post_init__(self) -> None:
        two(self.place, self.over, "Precedence")

    @property
    def places(self) -> tuple[str, str]:
        """The two places that meet, the one that holds first."""
        return self.place, self.over


@dataclass(frozen=True)
class Graded:
    """On `over`, within `band` [mm] of the line where it meets `to`, the jump is graded.

    u = u_over + w(d/band) (u_to - u_over), d the distance to the line [mm], and
    w(s) = 1 - 3 s^2 + 2 s^3 a smooth step from 1 on the line to 0 at the band's end. The value
    of `to` is continued to points of `over`: for a moved bone it is the bone's motion there.

    >>> Graded(over="rami", to="jaw", band=5).places
    ('jaw', 'rami')
    """

    over: str
    to: str
    band: float

    def __post_init__(self) -> None:
        two(self.over, self.to, "Graded")
        object.__setattr__(self, "band", positive(self.band, "the band of Graded (mm)"))

    @property
    def places(self) -> tuple[str, str]:
        """The two places that meet, the one whose value holds on the line first."""
        return self.to, self.over


@dataclass(frozen=True)
class Gap:
    """A gap left free: parts of `free` that reach within `width` [mm] of the line are released.

    Every facet (or mesh edge, or vertex) of `free` with a vertex within `width` of the line
    where it meets `at` is released; what is left of `free` holds its whole closure. The line
    itself belongs to `at`.

    >>> Gap(free="rami", at="jaw", width=2).places
    ('jaw', 'rami')
    """

    free: str
    at: str
    width: float

    def __post_init__(self) -> None:
        two(self.free, self.at, "Gap")
        object.__setattr__(self, "width", positive(self.width, "the width of Gap (mm)"))

    @property
    def places(self) -> tuple[str, str]:
        """The two places that meet, the one that holds the line first."""
        return self.at, self.free


Join = Precedence | Graded | Gap


def two(first: str, second: str, of: str) -> None:
    """Check that a join names two different places."""
    if first == second:
        raise InputError(f"{of} joins {first!r} with itself; it needs two places that meet")
    names((first, second), of)


def positive(value: float, what: str) -> float:
    """A checked length in mm, above zero."""
    length = number(value, what)
    if not length > 0:
        raise InputError(f"{what} is {length:g}; it must be above zero")
    return length
