# SPDX-License-Identifier: BSD-3-Clause
"""Landmarks and surfaces to and from 3D Slicer, always with their frame said. LPS, mm."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from bezsoma.arrays import Floats, Ints
from bezsoma.errors import InputError
from bezsoma.imaging.nrrd import checked_place, whole

SCHEMA = (
    "https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/Resources/"
    "Schema/markups-schema-v1.0.3.json#"
)
MARK = "SPACE=LPS"
"""What 3D Slicer looks for in the header of a mesh; without it, other frames would be assumed."""
TURNS = {"LPS": np.array([1.0, 1, 1]), "RAS": np.array([-1.0, -1, 1])}
"""RAS is LPS after half a turn about z, no mirror image."""
MOST_BYTES = 64 << 20
"""A file of landmarks has a few thousand bytes."""


def read_landmarks(path: str | os.PathLike[str]) -> dict[str, Floats]:
    """Points (3,) in mm, LPS, by label, of a 3D Slicer file of markups (.mrk.json)."""
    place = Path(path)
    if not place.is_file():
        raise InputError(f"no file {str(path)!r}; landmarks are read from .mrk.json")
    if place.stat().st_size > MOST_BYTES:
        raise InputError(f"{path} is too large for landmarks; is it another file?")
    try:
        content = json.loads(place.read_text(encoding="utf-8"))
    except (ValueError, RecursionError) as error:
        raise InputError(f"{path} is no JSON ({str(error)[:120]}); save it again") from None
    found: dict[str, Floats] = {}
    for markup in _listed(path, content, "markups"):
        turn = _turn(path, markup)
        for point in _listed(path, markup, "controlPoints"):
            if not isinstance(point, dict) or point.get("positionStatus") == "undefined":
                continue
            label = str(point.get("label", ""))
            if not label or label in found:
                raise InputError(
                    f"{path}: the label {label!r} is empty or stands twice; give every landmark a "
                    "name of its own"
                )
            found[label] = _position(path, label, point.get("position")) * turn
    if not found:
        raise InputError(
            f"{path} holds no landmark with a position; place one in 3D Slicer and save it again"
        )
    return found


def _listed(path: object, content: Any, key: str) -> list[Any]:
    part = content.get(key) if isinstance(content, dict) else None
    if not isinstance(part, list):
        raise InputError(
            f"{path} has no list {key!r}: it is no file of markups of 3D Slicer; give one "
            "(.mrk.json)"
        )
    return part


def _turn(path: object, markup: Mapping[str, Any]) -> Floats:
    """What brings a markup's points to LPS."""
    system = markup.get("coordinateSystem")
    name = {0: "RAS", 1: "LPS", "0": "RAS", "1": "LPS"}.get(
        system if isinstance(system, int | str) else "", system
    )
    if name not in ("LPS", "RAS"):
        raise InputError(
            f"{path}: coordinateSystem is {system!r}; LPS or RAS has to be said, else left and "
            "right would be a guess"
        )
    unit = markup.get("coordinateUnits", "mm")
    if unit not in ("mm", "[mm]", ["mm", "UCUM", "millimeter"]):
        raise InputError(f"{path}: coordinateUnits is {unit!r}; mm is needed")
    return TURNS[str(name)]


def _position(path: object, label: str, given: Any) -> Floats:
    try:
        point = np.array(given, np.float64)
    except (TypeError, ValueError):
        point = np.empty(0)
    if point.shape != (3,) or not np.isfinite(point).all():
        raise InputError(
            f"{path}: landmark {label!r} has the position {str(given)[:60]}; three finite numbers "
            "are needed (mm): place it anew, or take it out of the file"
        )
    return point


def write_landmarks(
    path: str | os.PathLike[str], points: Mapping[str, Floats], *, overwrite: bool = False
) -> None:
    """Write points (3,) in mm, LPS, by label as .mrk.json for 3D Slicer."""
    place = checked_place(path, (".mrk.json",), overwrite)
    controls = [
        {
            "id": str(number),
            "label": label,
            "position": [float(x) for x in _position(path, label, point)],
            "positionStatus": "defined",
        }
        for number, (label, point) in enumerate(points.items(), 1)
    ]
    markup = {
        "type": "Fiducial",
        "coordinateSystem": "LPS",
        "coordinateUnits": "mm",
        "controlPoints": controls,
    }
    content = {"@schema": SCHEMA, "markups": [markup]}
    whole(place, (json.dumps(content, indent=1, ensure_ascii=False) + "\n").encode())


def write_surface(
    path: str | os.PathLike[str], points: Floats, triangles: Ints, *, overwrite: bool = False
) -> None:
    """Write triangles (t, 3) of points (p, 3) in mm as .stl, .ply or .obj, marked SPACE=LPS."""
    place = checked_place(path, (".stl", ".ply", ".obj"), overwrite)
    points, triangles = np.asarray(points, np.float64), np.asarray(triangles, np.int64)
    if points.ndim != 2 or points.shape[1] != 3 or not np.isfinite(points).all():
        raise InputError(f"points of shape {points.shape}; finite (p, 3) in mm are needed")
    if triangles.ndim != 2 or triangles.shape[1] != 3:
        raise InputError(f"triangles of shape {triangles.shape}; (t, 3) is needed")
    if triangles.size and not 0 <= triangles.min() <= triangles.max() < len(points):
        raise InputError(
            f"triangles name points {triangles.min()} to {triangles.max()}, and there are "
            f"{len(points)}; number them from 0 to {len(points) - 1}"
        )
    whole(
        place, {".stl": _stl, ".ply": _ply, ".obj": _obj}[place.suffix.lower()](points, triangles)
    )


def _stl(points: Floats, triangles: Ints) -> bytes:
    corners = points[triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    table = np.zeros(len(triangles), [("xyz", "<f4", (4, 3)), ("attribute", "<u2")])
    table["xyz"][:, 0], table["xyz"][:, 1:] = normal, corners
    head = f"BezSoma, mm. {MARK}".encode().ljust(80)
    return head + len(triangles).to_bytes(4, "little") + bytes(table.tobytes())


def _ply(points: Floats, triangles: Ints) -> bytes:
    head = (
        f"ply\nformat binary_little_endian 1.0\ncomment BezSoma, mm. {MARK}\n"
        f"element vertex {len(points)}\nproperty double x\nproperty double y\nproperty double z\n"
        f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    faces = np.zeros(len(triangles), [("count", "u1"), ("of", "<i4", 3)])
    faces["count"], faces["of"] = 3, triangles
    return head.encode() + points.astype("<f8").tobytes() + faces.tobytes()


def _obj(points: Floats, triangles: Ints) -> bytes:
    lines = [f"# BezSoma, mm. {MARK}"]
    lines += [f"v {x!r} {y!r} {z!r}" for x, y, z in points.tolist()]
    lines += [f"f {a} {b} {c}" for a, b, c in (triangles + 1).tolist()]
    return ("\n".join(lines) + "\n").encode()
