# SPDX-License-Identifier: BSD-3-Clause
"""One number for every place of a picture: what a colour stands for."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from bezsoma.arrays import Floats
from bezsoma.errors import InputError
from bezsoma.mesh import TetMesh
from bezsoma.view.restriction import AnyField, on_same_mesh
from bezsoma.view.surfaces import Surface

Measure = Callable[[Floats], Floats]


def numbers_on(mesh: TetMesh, field: AnyField, surface: Surface, measure: Measure | None) -> Floats:
    """One number (s,) at every sample of the surface: the field's, or its measure's."""
    on_same_mesh(mesh, field, "colour")
    return measured(surface.at(field), measure)


def measured(values: Floats, measure: Measure | None) -> Floats:
    """One number (..) for each value (.., k): itself, a vector's length, or its measure.

    >>> measured(np.array([[3.0, 0, 4]]), None).tolist()
    [5.0]
    """
    parts = values.shape[-1]
    if measure is None and parts not in (1, 3):
        raise InputError(
            f"a field of {parts} components has no colour of its own; give measure=, a function"
            f" from values (p, {parts}) to numbers (p,)"
        )
    if measure is None:
        found = values[..., 0] if parts == 1 else np.linalg.norm(values, axis=-1)
    else:
        found = np.asarray(measure(values.reshape(-1, parts)), float).reshape(values.shape[:-1])
    if not np.isfinite(found).all():
        raise InputError(
            f"the field to be coloured is NaN or infinite at {int((~np.isfinite(found)).sum())} of "
            f"{found.size} samples of the surface, as stress is where tissue is turned inside out "
            "(`Solution.advice` says where); colour by another field, or by the displacement"
        )
    return np.asarray(found)
