# SPDX-License-Identifier: BSD-3-Clause
"""What can go wrong, said so that the reader knows what to do.

A message says what was given, why it cannot work and what can. Input is checked once, at the
boundary; below it nothing is checked again.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence
from typing import Any


class BezSomaError(Exception):
    """The root of every error that BezSoma raises on purpose."""


class InputError(BezSomaError, ValueError):
    """What was asked for cannot be done; the message says why and what can."""


class MeshError(InputError):
    """The mesh is damaged or does not fit; the message names the tets or points."""


class NotConverged(BezSomaError):
    """An iteration stopped short of its tolerance; `history` holds the residual of each step.

    Where a load was put on in steps, `last` is the Solution of the last one that converged, and
    `fraction` how much of the load it bears: to be looked at and written, not to be taken for the
    answer. `path` has every iteration.
    """

    def __init__(
        self,
        message: str,
        history: Sequence[float] = (),
        *,
        last: Any = None,
        fraction: float = 0.0,
        path: Sequence[Any] = (),
    ) -> None:
        super().__init__(message)
        self.history = tuple(history)
        self.last, self.fraction, self.path = last, fraction, tuple(path)


class Inadmissible(BezSomaError):
    """A state that a law cannot bear: J <= 0, an exponential that overflows, a number that is none.

    Newton meets it by a smaller step. `what` is "J", "exponent" or "number", `value` what it was
    there; `tet`, `region` and `point` [mm, undeformed] say where.
    """

    def __init__(
        self,
        message: str,
        what: str,
        value: float,
        tet: int,
        region: str,
        point: tuple[float, float, float],
    ) -> None:
        super().__init__(message)
        self.what, self.value = what, value
        self.tet, self.region, self.point = tet, region, point


class MissingExtra(BezSomaError, ImportError):
    """An optional package is not installed; the message has the line that installs it."""


def counted(number: int, thing: str) -> str:
    """So many things, one in the singular.

    >>> [counted(n, "tet") for n in (0, 1, 2)]
    ['0 tets', '1 tet', '2 tets']
    """
    return f"{number} {thing}" if number == 1 else f"{number} {thing}s"


def unknown(kind: str, given: object, known: Iterable[Any], of: str) -> str:
    """The sentence for a name that is not there, with the nearest that is.

    >>> print(unknown("surface", "skim", ["skin", "bone"], "this mesh"))
    no surface 'skim'; this mesh has ['bone', 'skin'] (did you mean 'skin'?)
    >>> print(unknown("surface", "x", [], "this mesh"))
    no surface 'x'; this mesh has none
    """
    names = sorted(str(name) for name in known)
    near = difflib.get_close_matches(str(given), names, n=1)
    hint = f" (did you mean {near[0]!r}?)" if near else ""
    return f"no {kind} {given!r}; {of} has {names if names else 'none'}{hint}"
