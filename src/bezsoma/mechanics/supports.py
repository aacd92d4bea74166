# SPDX-License-Identifier: BSD-3-Clause
"""Where the displacement is known: held, moved with a bone, or prescribed; all lengths mm."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol, runtime_checkable

import numpy as np
import numpy.typing as npt

from bezsoma.arrays import Bools, Floats, frozen
from bezsoma.errors import InputError
from bezsoma.mechanics.checks import names, number, numbers
from bezsoma.mechanics.values import Given, Value, as_called, given


@runtime_checkable
class Support(Protocol):
    """Prescribed displacement, in mm, on the closure of places: surfaces, edges or vertices.

    `degree` is that of the polynomial which the displacement is (0 or 1: affine, whose controls
    are its values), or None for a function of which nothing is known.
    """

    @property
    def places(self) -> tuple[str, ...]:
        """The names of the surfaces, mesh edges or vertices."""
        ...

    @property
    def components(self) -> str:
        """Which of x, y, z are prescribed."""
        ...

    @property
    def degree(self) -> int | None:
        """The degree of the displacement as a polynomial, or None."""
        ...

    def displacement(self, points: Floats) -> Floats:
        """The displacement (p, 3) mm at points (p, 3) mm."""
        ...


@dataclass(frozen=True, init=False)
class Fixed:
    """Held: zero displacement, in all components or some, as `Fixed("floor", components="z")`.

    >>> Fixed("skull").displacement(np.ones((1, 3))).tolist()
    [[0.0, 0.0, 0.0]]
    """

    places: tuple[str, ...]
    components: str

    def __init__(self, *places: str, components: str = "xyz") -> None:
        object.__setattr__(self, "places", names(places, "Fixed"))
        object.__setattr__(self, "components", axes(components, "Fixed"))

    def __repr__(self) -> str:
        return as_called("Fixed", *self.places, components=partly(self.components))

    @property
    def degree(self) -> int:
        """0: a constant."""
        return 0

    def displacement(self, points: Floats) -> Floats:
        """Zeros (p, 3)."""
        return np.zeros((len(points), 3))


@dataclass(frozen=True, init=False, eq=False)
class Moved:
    """Moved as a rigid bone is: turned by `angle` [rad] about an axis, then shifted [mm].

    u(x) = (R - I)(x - about) + translation, with R the true rotation (not the small-angle one,
    which stretches a jaw opened by 20 degrees by 6 %); counter-clockwise seen against the axis.
    Linear tissue then follows prescribed data that are exact, its own law stays one of small
    strain. A turn needs its axis and a point `about` which it goes: a forgotten one would be a turn
    about the corner of the scan. What does not move is `Fixed`.

    >>> quarter = Moved("jaw", axis=(0, 0, 1), angle=np.pi / 2, about=(1, 0, 0))
    >>> moved = np.array([[2.0, 0, 0]]) + quarter.displacement(np.array([[2.0, 0, 0]]))
    >>> bool(np.allclose(moved, [[1, 1, 0]], atol=1e-15))
    True
    """

    places: tuple[str, ...]
    translation: Floats
    axis: Floats
    angle: float
    about: Floats
    components: str
    _minus_identity: Floats = field(repr=False)

    def __init__(
        self,
        *places: str,
        translation: npt.ArrayLike | None = None,
        axis: npt.ArrayLike | None = None,
        angle: float | None = None,
        about: npt.ArrayLike | None = None,
        components: str = "xyz",
    ) -> None:
        given = {"translation": translation, "axis": axis, "angle": angle, "about": about}
        stated = {name: value for name, value in given.items() if value is not None}
        own: dict[str, Any] = {
            "places": names(places, "Moved"),
            "components": axes(components, "Moved"),
            "angle": radians(stated.get("angle", 0.0)),
            "translation": _triple(stated, "translation", (0, 0, 0), "of Moved (mm)"),
            "axis": _triple(stated, "axis", (0, 0, 1), "of Moved"),
            "about": _triple(stated, "about", (0, 0, 0), "of Moved (mm)"),
        }
        _motion_stated(own["places"], own["angle"], stated)
        own["_minus_identity"] = rotation_minus_identity(own["axis"], own["angle"])
        for name, value in own.items():
            object.__setattr__(self, name, value)

    def __repr__(self) -> str:
        turn = {"axis": self.axis, "angle": self.angle, "about": self.about} if self.angle else {}
        components = partly(self.components)
        shift = self.translation
        return as_called("Moved", *self.places, translation=shift, **turn, components=components)

    @property
    def degree(self) -> int:
        """1: affine."""
        return 1

    def displacement(self, points: Floats) -> Floats:
        """(R - I)(x - about) + translation at points (p, 3), mm."""
        moved: Floats = (points - self.about) @ self._minus_identity.T + self.translation
        return moved


@dataclass(frozen=True, init=False, eq=False)
class Prescribed:
    """Prescribed displacement [mm]: three numbers, a polynomial, or a function of points (p, 3).

    A polynomial of the body's degree or less is met exactly. Anything else is interpolated at
    the domain points of every vertex, edge and face, and its values turned into controls, so
    that neighbours agree about what they share; controls are no values, so it is never sampled.

    >>> from bezsoma.mechanics.polynomial import Polynomial
    >>> stretch = Prescribed("left", value=Polynomial.parse(["0.1*x", 0, 0]))
    >>> stretch.displacement(np.array([[5.0, 1, 1]])).tolist(), stretch.degree
    ([[0.5, 0.0, 0.0]], 1)
    """

    places: tuple[str, ...]
    value: Given
    components: str

    def __init__(self, *places: str, value: Value | Given, components: str = "xyz") -> None:
        object.__setattr__(self, "places", names(places, "Prescribed"))
        what = f"the displacement prescribed on {', '.join(map(repr, places))} (mm)"
        object.__setattr__(self, "value", given(value, 3, what))
        object.__setattr__(self, "components", axes(components, "Prescribed"))

    def __repr__(self) -> str:
        components = partly(self.components)
        return as_called("Prescribed", *self.places, value=self.value, components=components)

    @property
    def degree(self) -> int | None:
        """The degree of the polynomial, or None for a function."""
        return self.value.degree

    def displacement(self, points: Floats) -> Floats:
        """The prescribed values (p, 3) mm at points (p, 3) mm."""
        return self.value(points)


def _triple(stated: Mapping[str, Any], name: str, default: Any, of: str) -> Floats:
    return numbers(stated.get(name, default), (3,), f"the {name} {of}")


def _motion_stated(places: tuple[str, ...], angle: float, stated: Mapping[str, Any]) -> None:
    """Refuses a motion that is none, and a turn about a line that nobody gave."""
    on = ", ".join(map(repr, places))
    if "translation" not in stated and "angle" not in stated:
        raise InputError(
            f"Moved on {on} has neither a translation (mm) nor an angle (rad), so nothing moves; "
            f"say how it moves, or say Fixed({on})"
        )
    missing = [name for name in ("axis", "about") if name not in stated]
    if angle and missing:
        raise InputError(
            f"Moved on {on} turns by {angle:g} rad, and no {' and no '.join(missing)} is given; a "
            "turn needs the direction of its axis and a point in mm which it goes about, such as "
            "axis=(1, 0, 0), about=(0, 10, 0)"
        )


def partly(components: str) -> str | None:
    """The components, or None where they are all: what a repr need not say."""
    return None if components == "xyz" else components


def axes(components: Any, of: str) -> str:
    """The checked components in the order x, y, z.

    >>> axes("zx", "Fixed")
    'xz'
    """
    letters = components if isinstance(components, str) else ""
    if not letters or len(set(letters)) < len(letters) or set(letters) - set("xyz"):
        raise InputError(
            f"components={components!r} of {of}: it must be text of the letters x, y, z, each "
            "once at most and one at least, such as 'xyz' or 'z'"
        )
    return "".join(sorted(letters))


def radians(angle: Any) -> float:
    """The checked angle of a rotation, at most one full turn either way."""
    turn = number(angle, "the angle of Moved (rad)")
    if abs(turn) > 2 * np.pi:
        raise InputError(
            f"the angle of Moved is {turn:g} rad, more than a full turn; angles are radians: "
            f"{turn:g} degrees are angle={np.radians(turn):.6g}"
        )
    return turn


def prescribes(support: Support) -> Bools:
    """Which of the components x, y, z a support prescribes (3,)."""
    return np.array([letter in support.components for letter in "xyz"])


def rotation_minus_identity(axis: Floats, angle: float) -> Floats:
    """R - I (3, 3) for the right-handed rotation by `angle` [rad] about `axis`.

    Rodrigues: R - I = sin(a) K + 2 sin(a/2)^2 K^2, K the cross product with the unit axis.
    Never formed as R minus I, so a hundred-thousandth of a degree keeps all its digits:

    >>> tiny = rotation_minus_identity(np.array([0, 0, 2.0]), 1e-9)
    >>> [float(entry) for entry in (tiny[1, 0], tiny[0, 0])]
    [1e-09, -5e-19]
    """
    length = float(np.linalg.norm(axis))
    if not np.isfinite(length) or length == 0:
        raise InputError(
            f"the axis of Moved is {axis.tolist()}, of length {length:g}; it must point somewhere, "
            "as (0, 0, 1) does"
        )
    x, y, z = axis / length
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return frozen(np.sin(angle) * K + 2 * np.sin(angle / 2) ** 2 * (K @ K))
