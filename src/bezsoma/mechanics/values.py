# SPDX-License-Identifier: BSD-3-Clause
"""What supports and loads prescribe: constants, polynomials, Python functions of points."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from bezsoma.arrays import Floats
from bezsoma.errors import InputError
from bezsoma.mechanics.checks import numbers
from bezsoma.mechanics.polynomial import Polynomial

Value = float | Sequence[float] | Floats | Polynomial | Callable[[Floats], Any]
"""What may be prescribed: number(s), a polynomial, or a function of points (p, 3) mm."""


@dataclass(frozen=True, eq=False)
class Given:
    """A checked value: called at points (p, 3) mm it gives (p, size).

    `degree` is that of the polynomial it is, or None for a Python function, of which nothing is
    known: its integrals are by quadrature and supports interpolate it.
    """

    function: Callable[[Floats], Any]
    size: int
    degree: int | None
    what: str

    def __repr__(self) -> str:
        if self.degree == 0:
            constant = self(np.zeros((1, 3)))[0].tolist()
            return repr(constant[0] if self.size == 1 else tuple(constant))
        name = getattr(self.function, "__qualname__", "") or type(self.function).__name__
        known = isinstance(self.function, Polynomial)
        return repr(self.function) if known else f"<function {name.split('.')[-1]}>"

    def __call__(self, points: Floats) -> Floats:
        """Values (p, size) at points (p, 3) mm; the answer of a Python function is checked."""
        if self.degree is not None:
            return np.asarray(self.function(points), dtype=float)
        return _answer(self.function(points.copy()), points, self)


@dataclass(frozen=True, eq=False)
class _Constant:
    """The same numbers (k,) at every point; a class, which can be pickled as no lambda can."""

    numbers: Floats

    def __call__(self, points: Floats) -> Floats:
        """The numbers (p, k)."""
        return np.tile(self.numbers, (len(points), 1))


def given(value: Any, size: int, what: str) -> Given:
    """The checked form of a value with `size` components; `what` names it in messages.

    >>> given((0, -5, 0), 3, "a displacement")(np.zeros((2, 3))).tolist()
    [[0.0, -5.0, 0.0], [0.0, -5.0, 0.0]]
    """
    if isinstance(value, Given):
        return value
    if isinstance(value, Polynomial):
        if len(value.components) != size:
            raise InputError(
                f"{what} is a polynomial of {len(value.components)} component(s); {size} are "
                f"needed: give Polynomial.parse {'one formula' if size == 1 else 'three formulas'}"
            )
        return Given(value, size, value.degree, what)
    if callable(value) and not isinstance(value, type):
        return Given(value, size, None, what)
    constant = numbers(value, (size,) if size > 1 else (), what).reshape(size)
    return Given(_Constant(constant), size, 0, what)


def as_called(kind: str, *places: str, **stated: Any) -> str:
    """The call that makes a support or a load, what was left out left out.

    >>> as_called("Traction", "top", value=given((0, 0, 1), 3, "a traction"), exactness=None)
    "Traction('top', value=(0.0, 0.0, 1.0))"
    >>> as_called("Pressure", "top", value=given(np.sin, 1, "a pressure"))
    "Pressure('top', value=<function sin>)"
    """
    named = (f"{name}={_plain(value)!r}" for name, value in stated.items() if value is not None)
    return f"{kind}({', '.join([*map(repr, places), *named])})"


def _plain(value: Any) -> Any:
    return tuple(value.tolist()) if isinstance(value, np.ndarray) else value


def _answer(answer: Any, points: Floats, value: Given) -> Floats:
    wanted = (len(points), value.size)
    try:
        array = np.asarray(answer)
    except ValueError:
        array = np.array(None)
    if value.size == 1 and array.shape == wanted[:1]:
        array = array[:, None]
    if array.dtype.kind not in "iuf" or array.shape != wanted:
        raise InputError(
            f"{value.what}: the function was given points of shape {points.shape} and answered "
            f"with {array.dtype} of shape {array.shape}; it must answer with numbers of shape "
            f"{wanted}, one row for each point"
        )
    array = array.astype(float)
    bad = np.flatnonzero(~np.isfinite(array).all(axis=1))
    if len(bad):
        raise InputError(
            f"{value.what}: the function answered with {array[bad[0]].tolist()} at "
            f"{len(bad)} of {len(points)} points, the first {points[bad[0]].tolist()} mm; "
            "it must be finite wherever it is prescribed"
        )
    return array
