# SPDX-License-Identifier: BSD-3-Clause
"""The points that a case looks at and the numbers that it expects; what came of both."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from bezsoma.arrays import Floats
from bezsoma.case.build import names_missing
from bezsoma.case.faults import Fault
from bezsoma.case.quantities import Measured, complaint
from bezsoma.case.reading import Case
from bezsoma.case.refining import places_missing
from bezsoma.case.schema import Expect, Probe, Refine
from bezsoma.errors import InputError
from bezsoma.mesh.locator import Locator
from bezsoma.mesh.tets import TetMesh


def probe_points(case: Case, mesh: TetMesh, refine: Refine | None = None) -> dict[str, Floats]:
    """Name -> point (3,), mm, of each probe: a vertex, a point inside, or one of its surface.

    Everything that the case asks of its mesh and that the mesh does not have is reported here in
    one go, before anything is solved: names, quantities that are expected, probes, and where to
    `refine`.
    """
    locator, points = Locator(mesh), {}
    found = [*names_missing(case, mesh), *_quantities_missing(case, mesh)]
    found += places_missing(case.file, refine, mesh)
    unplaced = {fault.path[:2] for fault in found}
    for number, probe in enumerate(case.file.probe):
        if ("probe", number) in unplaced:
            continue
        try:
            points[probe.name] = _placed(probe, mesh, locator)
        except InputError as error:
            found.append(Fault(("probe", number, "point"), str(error)))
    case.refuse(found)
    return points


def _placed(probe: Probe, mesh: TetMesh, locator: Locator) -> Floats:
    """The point (3,), mm, at which a probe looks."""
    if isinstance(probe.point, str):
        vertices = mesh.vertices[probe.point]
        if len(vertices) != 1:
            raise InputError(f"{probe.point!r} is {len(vertices)} vertices; name one alone")
        vertex: Floats = mesh.points[vertices[0]]
        return vertex
    point = np.array([probe.point], dtype=float)
    if probe.on is not None:
        near = locator.nearest(point, probe.on)
        corners: Floats = mesh.points[mesh.facets_of(probe.on)[near.facet[0]]]
        on_surface: Floats = near.bary[0] @ corners
        return on_surface
    if locator.tets_of(point)[0][0] < 0:
        away = locator.nearest(point).distance[0]
        raise InputError(
            f"{list(probe.point)} lies outside the mesh, {away:.3g} mm from it; give a point "
            "inside, or a surface with 'on'"
        )
    inside: Floats = point[0]
    return inside


def _quantities_missing(case: Case, mesh: TetMesh) -> Iterator[Fault]:
    """Expectations of quantities that this case and mesh do not have."""
    supported = {place for support in case.file.support for place in support.on}
    places = sorted(supported & set(mesh.places))
    probes = [probe.name for probe in case.file.probe]
    for number, expect in enumerate(case.file.expect):
        if message := complaint(expect.of, probes, places):
            yield Fault(("expect", number, "of"), message)


def motions(case: Case, measured: Measured) -> dict[str, dict[str, Any]]:
    """Probe -> where it is and its displacement, mm."""
    given = {probe.name: probe.point for probe in case.file.probe}
    found = {}
    for name, point in measured.probes.items():
        asked = point if isinstance(given[name], str) else given[name]
        moved = measured.solution.displacement.at(point[None], outside="nearest")[0]
        found[name] = {
            "point": point.tolist(),
            "off_by": float(np.linalg.norm(np.subtract(point, asked))),
            "displacement": moved.tolist(),
            "size": float(np.linalg.norm(moved)),
        }
    return found


def checked(case: Case, degree: int, measured: Measured) -> list[dict[str, Any]]:
    """Each expectation that speaks of this degree, with the number found and whether it is met."""
    asked = [each for each in case.file.expect if each.degrees is None or degree in each.degrees]
    return [_judged(expect, measured.number(expect.of)) for expect in asked]


def interval(expect: Expect) -> tuple[float, float]:
    """The least and the largest number that an expectation accepts.

    >>> interval(Expect(of="energy", value=2.0, relative=0.25, source="by hand"))
    (1.5, 2.5)
    """
    if expect.between is not None:
        return expect.between
    assert expect.value is not None
    slack = expect.tolerance or (expect.relative or 0.0) * abs(expect.value)
    return expect.value - slack, expect.value + slack


def unmet(checks: list[Mapping[str, Any]]) -> Iterator[str]:
    """A sentence for each expectation that was not met."""
    for check in checks:
        if not check["met"]:
            low, high = check["between"]
            yield (
                f"expected {check['of']} from {low:g} to {high:g} ({check['source']}), "
                f"found {check['found']:.6g}"
            )


def _judged(expect: Expect, found: float) -> dict[str, Any]:
    low, high = interval(expect)
    return {
        "of": expect.of,
        "found": found,
        "between": [low, high],
        "met": bool(low <= found <= high),
        "source": expect.source,
    }
