# SPDX-License-Identifier: BSD-3-Clause
"""The fields of a results folder by name, with their units, ready to be coloured."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from bezsoma.arrays import Floats
from bezsoma.case.build import body_of
from bezsoma.case.reading import case_from
from bezsoma.equations import stress as stresses
from bezsoma.equations import volume
from bezsoma.errors import InputError, unknown
from bezsoma.mesh.broken_field import BrokenField
from bezsoma.mesh.field import Field
from bezsoma.results import Results
from bezsoma.results.archive import CASE
from bezsoma.view.numbers import Measure

Made = tuple[Field | BrokenField, Measure | None]


@dataclass(frozen=True, eq=False)
class Shown:
    """A field of some results, ready to be coloured."""

    field: Field | BrokenField
    measure: Measure | None
    """From values (p, k) to numbers (p,); None where the value or its length is meant."""
    label: str
    """What it is, with its unit."""


def field_of(results: Results, name: str) -> Shown:
    """A field of results by its name, one of `FIELDS`.

    Stresses are those of the materials in the case; roots (von Mises, principal) are taken of the
    stress at each place that is drawn, not interpolated.
    """
    if name not in FIELDS:
        raise InputError(unknown("field", name, FIELDS, "results"))
    label, made = FIELDS[name]
    field, measure = made(results)
    return Shown(field, measure, label)


def _component(number: int) -> Measure:
    return lambda values: np.asarray(values[:, number])


def _of_tensors(function: Callable[[Floats], Floats]) -> Measure:
    return lambda values: function(values.reshape(-1, 3, 3))


def _stress(results: Results) -> BrokenField:
    """The Cauchy stress, MPa, by the materials of the case."""
    case = case_from(results.folder / CASE, results.case)
    body = body_of(case, results.mesh, results.displacement.degree)
    if results.pressure is None:
        return stresses.stress(body, results.displacement)
    return stresses.mixed_stress(body, results.displacement, results.pressure)


def _pressure(results: Results) -> Made:
    """The pressure, where it is no unknown of its own minus the mean stress."""
    if results.pressure is not None:
        return results.pressure, None
    stress = _stress(results)
    mean = np.trace(stress.controls, axis1=-2, axis2=-1) / 3
    return BrokenField(stress.mesh, stress.degree, -mean), None


def _tension(stress: Floats) -> Floats:
    return np.asarray(stresses.principal(stress)[..., 0])


def _stress_fields() -> dict[str, tuple[str, Callable[[Results], Made]]]:
    """The six components, by their places in a tensor row by row."""
    places = {"xx": 0, "yy": 4, "zz": 8, "xy": 1, "yz": 5, "zx": 2}
    return {
        f"stress_{name}": (
            f"stress {name}, MPa",
            lambda results, place=place: (_stress(results), _component(place)),  # type: ignore[misc]
        )
        for name, place in places.items()
    }


FIELDS: Mapping[str, tuple[str, Callable[[Results], Made]]] = MappingProxyType(
    {
        "displacement": ("displacement, mm", lambda results: (results.displacement, None)),
        "displacement_x": (
            "displacement to the left, mm",
            lambda results: (results.displacement, _component(0)),
        ),
        "displacement_y": (
            "displacement to the back, mm",
            lambda results: (results.displacement, _component(1)),
        ),
        "displacement_z": (
            "displacement up, mm",
            lambda results: (results.displacement, _component(2)),
        ),
        "pressure": ("pressure, MPa", _pressure),
        "stress": (
            "von Mises stress, MPa",
            lambda results: (_stress(results), _of_tensors(stresses.von_mises)),
        ),
        "tension": (
            "largest principal stress, MPa",
            lambda results: (_stress(results), _of_tensors(_tension)),
        ),
        **_stress_fields(),
        "divergence": ("div u", lambda results: (volume.divergence(results.displacement), None)),
        "determinant": (
            "det(I + grad u) - 1",
            lambda results: (volume.determinant(results.displacement), None),
        ),
    }
)
"""Name -> what the colour bar says, and how the field and its measure are made."""
