# SPDX-License-Identifier: BSD-3-Clause
"""Polynomials given tet by tet: their values, gradients, integrals and distances.

What is written here serves fields that are continuous and fields that are broken alike.  Values
may have any shape; below it is written `...` (empty for a scalar, 3 for a displacement, 3, 3 for
a stress), and a gradient adds one axis of length 3 at the end: the direction of d/dx.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Literal, Protocol

import numpy as np

from bezsoma import bernstein
from bezsoma.arrays import Floats, Ints
from bezsoma.errors import InputError
from bezsoma.mesh.functions import Function, sampled
from bezsoma.mesh.locator import Locator
from bezsoma.mesh.tets import TetMesh

Outside = Literal["raise", "nearest", "nan"]
"""What to do with a point outside the mesh: refuse, take the nearest boundary point, or nan."""
PORTION = 1 << 22
"""Numbers in the largest scratch array."""


class TetPolynomials(Protocol):
    """A polynomial of one degree on every tet of a mesh."""

    @property
    def mesh(self) -> TetMesh:
        """The mesh."""

    @property
    def degree(self) -> int:
        """The degree n."""

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape `...` of a value."""

    def on_tets(self, tets: Ints | slice) -> Floats:
        """The controls of some tets (q, m, ...)."""


def values(field: TetPolynomials, tets: Ints, bary: Floats) -> Floats:
    """The values (p, ...) at one barycentric point (p, 4) in each of the tets (p,)."""
    found = np.empty((len(tets), *field.shape))
    for part in portions(len(tets), bernstein.count(field.degree, 3) * size(field)):
        local = field.on_tets(tets[part])
        weights = bernstein.values(field.degree, bary[part])
        found[part] = np.einsum("pm,pm...->p...", weights, local)
    return found


def gradients(field: TetPolynomials, tets: Ints, bary: Floats) -> Floats:
    """The gradients (p, ..., 3) at one barycentric point (p, 4) in each of the tets (p,)."""
    found = np.zeros((len(tets), *field.shape, 3))
    if field.degree == 0:
        return found
    for part in portions(len(tets), 3 * bernstein.count(field.degree, 3) * size(field)):
        weights = bernstein.values(field.degree - 1, bary[part])
        local = gradient_controls(field, tets[part])
        found[part] = np.einsum("pm,pm...->p...", weights, local)
    return found


def gradient_controls(field: TetPolynomials, tets: Ints | slice) -> Floats:
    """The controls (q, m_{n-1}, ..., 3) of the gradient on some tets, of degree n - 1.

        grad u = n sum_beta B^{n-1}_beta sum_i b_{beta + e_i} grad L_i

    The gradients of the L_i add up to zero, so b_{beta + e_0} is taken off each term: a constant
    field has the gradient zero, not one that is nearly so.

    The gradient of x y z, times x, y and z in turn, is three times x y z (Euler):

    >>> from bezsoma.mesh.field import ControlNet, Field
    >>> mesh = TetMesh([[0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3.0]], [[0, 1, 2, 3]])
    >>> cubic = Field.interpolating(ControlNet(mesh, 3), lambda x: x.prod(axis=1))
    >>> x = np.array([[0.2, 0.3, 0.4]])
    >>> bool(abs(cubic.gradient(x)[0] @ x[0] - 3 * x.prod()) < 1e-15)
    True
    """
    local = field.on_tets(tets)
    shifts = bernstein.shifts(field.degree, 3)
    lowest = local[:, shifts[:, 0]]
    steps = np.stack([local[:, shifts[:, i]] - lowest for i in (1, 2, 3)], axis=-1)
    rows = steps.reshape(len(local), -1, 3) @ (field.degree * field.mesh.gradients_of(tets)[:, 1:])
    return np.asarray(rows.reshape(steps.shape))


def tabulated(field: TetPolynomials, bary: Floats, tets: Ints | slice = slice(None)) -> Floats:
    """The values (q, b, ...) at the same barycentric points (b, 4) in each of q tets."""
    local = field.on_tets(tets)
    weights = bernstein.values(field.degree, bary)
    return np.moveaxis(np.tensordot(weights, local, (1, 1)), 0, 1)


def at(field: TetPolynomials, points: Floats, outside: Outside, gradient: bool = False) -> Floats:
    """The values (p, ...) or gradients (p, ..., 3) at points (p, 3) in mm."""
    tets, bary = located(field.mesh, points, outside)
    inside = np.flatnonzero(tets >= 0)
    evaluated = (gradients if gradient else values)(field, tets[inside], bary[inside])
    if len(inside) == len(tets):
        return evaluated
    found = np.full((len(tets), *evaluated.shape[1:]), np.nan)
    found[inside] = evaluated
    return found


def located(mesh: TetMesh, points: Floats, outside: Outside) -> tuple[Ints, Floats]:
    """The tets (p,) and barycentric coordinates (p, 4) of points, by the rule for those outside."""
    if outside not in ("raise", "nearest", "nan"):
        raise InputError(f"outside={outside!r} is not known; give 'raise', 'nearest' or 'nan'")
    points, locator = _points(points), Locator(mesh)
    tets, bary = locator.tets_of(points)
    lost = np.flatnonzero(tets < 0)
    if len(lost) and outside == "raise":
        x, y, z = points[lost[0]]
        distance = locator.nearest(points[lost[:1]]).distance[0]
        raise InputError(
            f"point {lost[0]} at ({x:g}, {y:g}, {z:g}) mm lies outside the mesh, {distance:.3g} mm "
            f"from it ({len(lost)} of {len(points)} such); outside='nearest' takes the value at "
            "the nearest boundary point, outside='nan' gives nan there"
        )
    if len(lost) and outside == "nearest":
        tets[lost], bary[lost] = locator.in_tets(locator.nearest(points[lost]))
    return tets, bary


def _points(given: Any) -> Floats:
    """The points (p, 3) as numbers; that they are finite is for the locator to say."""
    try:
        points = np.asarray(given, dtype=np.float64)
    except (TypeError, ValueError):
        shown = repr(given)
        raise InputError(
            f"{shown if len(shown) <= 60 else shown[:60] + '...'} are no points; give numbers "
            "(p, 3) in mm, such as [[0, 0, 0]]"
        ) from None
    if points.ndim != 2 or points.shape[1] != 3:
        one = "; one point is [[x, y, z]]" if points.shape == (3,) else ""
        raise InputError(f"points of shape {points.shape} were given; (p, 3) in mm is needed{one}")
    return points


def integral(field: TetPolynomials) -> Floats:
    """The integral over the mesh (...), value times mm3.

    int_T B_alpha = V / C(n+3, 3) = V / m: each tet's volume times its mean control.
    """
    total = np.zeros(field.shape)
    for part in tet_portions(field, bernstein.count(field.degree, 3)):
        total += np.einsum(
            "t,t...->...", field.mesh.volumes[part], field.on_tets(part).mean(axis=1)
        )
    return total


def l2_norm(field: TetPolynomials) -> float:
    """sqrt(int |u|^2 dV) over all components, from the mass matrix in closed form."""
    mass = bernstein.mass(field.degree, field.degree, 3)
    total = 0.0
    for part in tet_portions(field, bernstein.count(field.degree, 3)):
        total += mass_product(mass, field.on_tets(part), field.mesh.volumes[part])
    return float(np.sqrt(total))


def h1_seminorm(field: TetPolynomials) -> float:
    """sqrt(int |grad u|^2 dV) over all components and directions, in closed form."""
    if field.degree == 0:
        return 0.0
    mass = bernstein.mass(field.degree - 1, field.degree - 1, 3)
    total = 0.0
    for part in tet_portions(field, 3 * bernstein.count(field.degree, 3)):
        total += mass_product(mass, gradient_controls(field, part), field.mesh.volumes[part])
    return float(np.sqrt(total))


def mass_product(mass: Floats, local: Floats, volumes: Floats) -> float:
    """sum_t V_t b_t . M b_t over tets, for controls (t, m, ...)."""
    flat = local.reshape(*local.shape[:2], -1)
    return float(np.einsum("t,tmk,tmk->", volumes, flat, np.matmul(mass, flat)))


def l2_error(field: TetPolynomials, function: Function, exactness: int | None = None) -> float:
    """sqrt(int |u - f|^2 dV) by quadrature, for a function of points (p, 3).

    Args:
        field: u.
        function: f; its values have the shape of the field's, (p, ...).
        exactness: the degree that the quadrature integrates exactly; 2 n + 2 unless given, and
            more where f is far from a polynomial.
    """
    return _distance(field, function, exactness, gradient=False)


def h1_error(field: TetPolynomials, gradient: Function, exactness: int | None = None) -> float:
    """sqrt(int |grad u - g|^2 dV) by quadrature, for the gradient g (p, ..., 3) of a function."""
    return _distance(field, gradient, exactness, gradient=True)


def _distance(
    field: TetPolynomials, function: Function, exactness: int | None, gradient: bool
) -> float:
    bary, weights = bernstein.simplex(2 * field.degree + 2 if exactness is None else exactness, 3)
    shape = (*field.shape, 3) if gradient else field.shape
    total = 0.0
    for part in tet_portions(field, len(bary) * (3 if gradient else 1)):
        points = np.einsum("qi,tid->tqd", bary, field.mesh.points[field.mesh.tets[part]])
        wanted = sampled(function, points.reshape(-1, 3))
        if wanted.shape[1:] != shape:
            raise InputError(
                f"the function gives values of shape {wanted.shape[1:]}, and the field "
                f"{'has gradients' if gradient else 'has values'} of shape {shape}"
            )
        if gradient:
            local = gradient_controls(field, part)
            found = np.tensordot(bernstein.values(field.degree - 1, bary), local, (1, 1))
            found = np.moveaxis(found, 0, 1)
        else:
            found = tabulated(field, bary, part)
        square = ((found - wanted.reshape(found.shape)) ** 2).reshape(*found.shape[:2], -1)
        total += np.einsum("t,q,tqk->", field.mesh.volumes[part], weights, square)
    return float(np.sqrt(total))


def bounds_of_tets(field: TetPolynomials, tolerance: float | None = None) -> tuple[Floats, Floats]:
    """A lower and an upper bound (t, ...) of the values on every tet, component by component."""
    low, high = (np.empty((len(field.mesh.tets), *field.shape)) for _ in range(2))
    for part in tet_portions(field, bernstein.count(field.degree, 3)):
        low[part], high[part] = bernstein.bounds(field.on_tets(part), field.degree, 3, tolerance)
    return low, high


def bounds(field: TetPolynomials, tolerance: float | None = None) -> tuple[Floats, Floats]:
    """A lower and an upper bound (...) of the values on the mesh, component by component.

    With a tolerance only those tets are subdivided whose controls exceed, by more than that, the
    largest value at any corner: no other can hold an extreme that is farther out.
    """
    low, high = bounds_of_tets(field)
    if tolerance is not None:
        corners = tabulated(field, np.eye(4)).reshape(-1, *field.shape)
        beyond = (low < corners.min(axis=0) - tolerance) | (high > corners.max(axis=0) + tolerance)
        tets = np.flatnonzero(beyond.reshape(len(low), -1).any(axis=1))
        local = field.on_tets(tets)
        low[tets], high[tets] = bernstein.bounds(local, field.degree, 3, tolerance)
    return low.min(axis=0), high.max(axis=0)


def size(field: TetPolynomials) -> int:
    """The numbers in one value."""
    return int(np.prod(field.shape, dtype=np.int64))


def tet_portions(field: TetPolynomials, rows: int) -> Iterator[slice]:
    """Slices of the tets, for scratch arrays of so many rows of values a tet."""
    return portions(len(field.mesh.tets), rows * size(field))


def portions(count: int, each: int) -> Iterator[slice]:
    """Slices of `count` things that take `each` numbers a thing.

    >>> list(portions(5, PORTION // 2))
    [slice(0, 2, None), slice(2, 4, None), slice(4, 5, None)]
    """
    step = max(1, PORTION // max(1, each))
    return (slice(begin, min(begin + step, count)) for begin in range(0, count, step))
