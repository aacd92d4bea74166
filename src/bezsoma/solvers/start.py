# SPDX-License-Identifier: BSD-3-Clause
"""An earlier solution as the start of the next solve."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from bezsoma.arrays import Floats
from bezsoma.errors import InputError
from bezsoma.mesh.broken_field import BrokenField
from bezsoma.mesh.control_net import ControlNet
from bezsoma.mesh.field import Field


class State(Protocol):
    """What can start a solve: a Solution, Results, or fields of your own."""

    @property
    def displacement(self) -> Field:
        """The displacement, mm, on any mesh of about the same body and of any degree."""

    @property
    def pressure(self) -> Field | BrokenField | None:
        """The pressure, MPa, where there is one."""


@dataclass(frozen=True, eq=False)
class Begun:
    """Fields to start from that are nobody's solution."""

    displacement: Field
    pressure: Field | BrokenField | None = None


def start_checked(start: Any) -> State | None:
    """The start, if it has a displacement of three finite components; None stays None."""
    if start is None:
        return None
    field, pressure = getattr(start, "displacement", None), getattr(start, "pressure", None)
    if not isinstance(field, Field) or not isinstance(pressure, Field | BrokenField | None):
        raise InputError(
            f"start = {start!r}: a solve starts from what has a displacement and a pressure "
            "(or None), as a Solution and Results do"
        )
    if field.shape != (3,) or not np.isfinite(field.controls).all():
        raise InputError(
            f"start: its displacement has values of the shape {field.shape}, all finite: "
            f"{bool(np.isfinite(field.controls).all())}; three finite components are needed, mm"
        )
    if pressure is not None and not (pressure.shape == () and np.isfinite(pressure.controls).all()):
        raise InputError("start: its pressure has to be one finite number at a point, MPa")
    found: State = start
    return found


def first_displacement(start: State, net: ControlNet) -> Floats:
    """The controls (c, 3) mm of an earlier displacement on the net of the next solve.

    On the same mesh and from a lower degree it is the same field. Else it is interpolated: a
    start need not be exact. What lies outside the earlier mesh takes the nearest value.
    """
    field = start.displacement
    if field.mesh is net.mesh and field.degree <= net.degree:
        return net.elevated(field.controls, field.net)
    return net.interpolated(lambda x: field.at(x, outside="nearest"))


def first_pressure(start: State, net: ControlNet, tets: Any) -> Floats:
    """The controls (cp,) MPa of an earlier pressure on its net, which may be torn; zero if none.

    `tets` is the mesh of the body, whose tets are those of the net in the same order.
    """
    field = start.pressure
    if field is None:
        return np.zeros(net.count)
    if field.mesh is not tets or field.degree > net.degree:
        return net.interpolated(lambda x: field.at(x, outside="nearest"))
    controls = np.empty(net.count)
    controls[net.of_tet] = field.elevated(net.degree).of_tet
    return controls
