# SPDX-License-Identifier: BSD-3-Clause
"""Abaqus input files, the part that describes a mesh of straight tets.

Ours because sets are the point of this format: regions are the *ELSETs of tets, surfaces the
*SURFACEs and the *ELSETs of triangles, edge places the *ELSETs of lines, vertex places the *NSETs
(an *NSET that bears the name of a surface is left to the surface).
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import TextIO

import numpy as np
import numpy.typing as npt

from bezsoma.arrays import Ints
from bezsoma.errors import InputError, MeshError
from bezsoma.mesh.tagged import Cells, Listing
from bezsoma.mesh.tets import TetMesh

POINTS = "".join(("NO", "DE"))
"""The format's keyword for a point, in two halves: our own word is vertex."""
WIDTHS = {"tet": 4, "triangle": 3, "line": 2}
SIDES = {"S1": (0, 1, 2), "S2": (0, 1, 3), "S3": (1, 2, 3), "S4": (0, 2, 3)}
"""The corners of a tet's sides, in the order of the file."""
_TYPES = (
    ("tet", r"(C|DC|AC)3D4[A-Z]*"),
    ("triangle", r"(S3|STRI3|CPS3|CPE3|R3D3|SFM3D3|M3D3)[A-Z]*"),
    ("line", r"(T3D2|B31|R3D2)[A-Z]*"),
    ("other", r"(C|DC|AC)3D.*|(S|STRI|CPS|CPE|R3D|SFM3D|M3D)\d.*"),
)


@dataclass
class _Deck:
    """What has been read so far; numbers are the file's own."""

    points: dict[int, list[float]] = field(default_factory=dict)
    cells: dict[str, dict[int, list[int]]] = field(
        default_factory=lambda: {kind: {} for kind in WIDTHS}
    )
    elements: dict[str, list[int]] = field(default_factory=dict)
    vertices: dict[str, list[int]] = field(default_factory=dict)
    surfaces: dict[str, list[tuple[str, str]]] = field(default_factory=dict)


def read_abaqus(file: TextIO) -> Listing:
    """All that the file says about points, tets, triangles, lines and their sets."""
    deck = _Deck()
    for keyword, options, rows in _blocks(file):
        if keyword == POINTS:
            _add_points(deck, options, rows)
        elif keyword == "ELEMENT":
            _add_cells(deck, options, rows)
        elif keyword in ("ELSET", "NSET"):
            _add_set(deck, keyword, options, rows)
        elif keyword == "SURFACE" and options.get("TYPE", "ELEMENT").upper() == "ELEMENT":
            deck.surfaces[_needed(options, "NAME", keyword)] = [
                (row[0], row[1].upper() if len(row) > 1 else "") for row in rows
            ]
        elif keyword == "INCLUDE" or (keyword == "INSTANCE" and rows):
            raise MeshError(
                f"it uses *{keyword}{' with a position' if rows else ''}; only a flat file is "
                "read: write the mesh out as one part, in its place"
            )
    return _listing(deck)


def write_abaqus(file: TextIO, mesh: TetMesh) -> None:
    """Tets as C3D4 by region, surfaces as sides of tets, edge places as T3D2, vertices as NSETs."""
    for name in (*mesh.regions, *mesh.places):
        if re.search(r"[,=*\"]", name):
            raise InputError(f"the name {name!r} has a sign that Abaqus cannot hold: rename it")
    file.write(f"*HEADING\nmm, N, MPa; LPS\n*{POINTS}\n")
    for number, (x, y, z) in enumerate(mesh.points.tolist(), 1):
        file.write(f"{number}, {x!r}, {y!r}, {z!r}\n")
    file.write("*ELEMENT, TYPE=C3D4\n")
    tets = mesh.oriented_tets
    for number, row in enumerate((tets + 1).tolist(), 1):
        file.write(f"{number}, {', '.join(map(str, row))}\n")
    for index, name in enumerate(mesh.regions):
        _write_set(file, f"*ELSET, ELSET={name}", np.flatnonzero(mesh.region == index) + 1)
    labels = ("S3", "S4", "S2", "S1")
    for name, facets in mesh.surfaces.items():
        file.write(f"*SURFACE, NAME={name}, TYPE=ELEMENT\n")
        owner = mesh.tets_of_facets(facets)
        opposite = (tets[owner][:, :, None] != facets[:, None, :]).all(axis=2).argmax(axis=1)
        for tet, corner in zip((owner + 1).tolist(), opposite.tolist(), strict=True):
            file.write(f"{tet}, {labels[corner]}\n")
    number = len(mesh.tets)
    for name, rows in mesh.edges.items():
        file.write(f"*ELEMENT, TYPE=T3D2, ELSET={name}\n")
        for a, b in (rows + 1).tolist():
            number += 1
            file.write(f"{number}, {a}, {b}\n")
    for name, vertices in mesh.vertices.items():
        _write_set(file, f"*NSET, NSET={name}", vertices + 1)


def _write_set(file: TextIO, head: str, numbers: Ints) -> None:
    if len(numbers):
        file.write(f"{head}\n")
    for start in range(0, len(numbers), 8):
        file.write(", ".join(map(str, numbers[start : start + 8].tolist())) + "\n")


def _blocks(file: TextIO) -> Iterator[tuple[str, dict[str, str], list[list[str]]]]:
    """Keyword, options and rows of words, one block after the other."""
    keyword, options, rows = "", dict[str, str](), list[list[str]]()
    for line in file:
        if line.startswith("**") or not line.strip():
            continue
        if not line.startswith("*"):
            rows.append([word.strip() for word in line.rstrip().rstrip(",").split(",")])
            continue
        yield keyword, options, rows
        head, *words = (word.strip() for word in line[1:].split(","))
        pairs = (word.partition("=") for word in words)
        options = {key.strip().upper(): value.strip().strip('"') for key, _, value in pairs}
        keyword, rows = head.upper(), []
    yield keyword, options, rows


def _add_points(deck: _Deck, options: Mapping[str, str], rows: list[list[str]]) -> None:
    for row in rows:
        number, position = int(row[0]), [float(word) for word in row[1:4]]
        if number in deck.points:
            raise MeshError(
                f"point {number} is listed twice; only one part is read: write the mesh as one"
            )
        deck.points[number] = position
    if "NSET" in options:
        deck.vertices.setdefault(options["NSET"], []).extend(int(row[0]) for row in rows)


def _add_cells(deck: _Deck, options: Mapping[str, str], rows: list[list[str]]) -> None:
    name = _needed(options, "TYPE", "ELEMENT").upper()
    kind = next((kind for kind, pattern in _TYPES if re.fullmatch(pattern, name)), "")
    if kind == "other":
        raise MeshError(
            f"it has elements of type {name}; straight tets (C3D4) with triangles (S3) and lines "
            "(T3D2) are read: mesh with linear tets, or split these"
        )
    if not kind:
        return
    numbers = [int(word) for row in rows for word in row if word]
    width = WIDTHS[kind] + 1
    if len(numbers) % width:
        raise MeshError(
            f"a block of {name} elements has {len(numbers)} numbers, which is no multiple of "
            f"{width}; the file is cut short or damaged"
        )
    found = {numbers[i]: numbers[i + 1 : i + width] for i in range(0, len(numbers), width)}
    if len(found) * width < len(numbers) or any(found.keys() & old for old in deck.cells.values()):
        raise MeshError(
            f"an element number of the {name} elements is used twice; numbers must be distinct: "
            "only one part is read"
        )
    deck.cells[kind].update(found)
    if "ELSET" in options:
        deck.elements.setdefault(options["ELSET"], []).extend(found)


def _add_set(deck: _Deck, keyword: str, options: Mapping[str, str], rows: list[list[str]]) -> None:
    sets = deck.elements if keyword == "ELSET" else deck.vertices
    members = sets.setdefault(_needed(options, keyword, keyword), [])
    for row in rows:
        if "GENERATE" in options:
            first, last, *step = (int(word) for word in row)
            members.extend(range(first, last + 1, step[0] if step else 1))
        else:
            for word in row:
                members.extend([int(word)] if word.isdigit() else _set(sets, word, keyword))


def _set(sets: Mapping[str, list[int]], name: str, keyword: str) -> list[int]:
    for known, members in sets.items():
        if known.upper() == name.strip('"').upper():
            return members
    raise MeshError(f"it refers to the {keyword} {name!r}, which is not defined before")


def _needed(options: Mapping[str, str], key: str, keyword: str) -> str:
    if not options.get(key):
        raise MeshError(f"a *{keyword} has no {key}=; the file is damaged")
    return options[key]


def _listing(deck: _Deck) -> Listing:
    if not deck.points or not deck.cells["tet"]:
        raise MeshError("it has no points or no tets (C3D4); a mesh of tets is needed")
    if {len(position) for position in deck.points.values()} != {3}:
        raise MeshError("its points do not all have three coordinates; 3-D points are needed")
    number = {point: i for i, point in enumerate(deck.points)}
    rows = {kind: _rows(cells, number, WIDTHS[kind]) for kind, cells in deck.cells.items()}
    sets = {kind: _members(deck.elements, cells) for kind, cells in deck.cells.items()}
    facets, sides = rows["triangle"], dict(sets["triangle"])
    for name, parts in deck.surfaces.items():
        found = _sides(deck, name, parts, rows["tet"], number)
        sides[name] = np.arange(len(facets), len(facets) + len(found))
        facets = np.concatenate([facets, found])
    used = np.unique(rows["tet"]).tolist()
    corner = {vertex: i for i, vertex in enumerate(used)}
    at = {point: corner[i] for point, i in number.items() if i in corner}
    single = _members(deck.vertices, at)
    return Listing(
        np.array(list(deck.points.values())),
        Cells(rows["tet"], sets=sets["tet"]),
        Cells(facets, sets=sides),
        Cells(rows["line"], sets=sets["line"]),
        Cells(np.array(used)[:, None], sets=single),
    )


def _rows(cells: Mapping[int, list[int]], number: Mapping[int, int], width: int) -> Ints:
    try:
        found = [[number[point] for point in row] for row in cells.values()]
    except KeyError as error:
        raise MeshError(
            f"an element uses point {error.args[0]}, which the file does not list; it is damaged"
        ) from error
    return np.array(found, np.int64).reshape(-1, width)


def _members(sets: Mapping[str, list[int]], cells: Mapping[int, object]) -> dict[str, Ints]:
    """Positions, each once, of those members that are cells of this kind."""
    place = {number: i for i, number in enumerate(cells)}
    found: dict[str, npt.NDArray[np.int64]] = {}
    for name, members in sets.items():
        rows = np.array(sorted({place[m] for m in members if m in place}), np.int64)
        if len(rows):
            found[name] = rows
    return found


def _sides(
    deck: _Deck, name: str, parts: list[tuple[str, str]], tets: Ints, number: Mapping[int, int]
) -> Ints:
    """The facets (f, 3) of a surface made of sides S1 to S4 of tets, or of whole triangles."""
    place = {element: i for i, element in enumerate(deck.cells["tet"])}
    found: list[list[int]] = []
    for member, side in parts:
        elements = [int(member)] if member.isdigit() else _set(deck.elements, member, "ELSET")
        for element in elements:
            if side in SIDES and element in place:
                found.append([int(tets[place[element], corner]) for corner in SIDES[side]])
            elif side in ("", "SPOS", "SNEG") and element in deck.cells["triangle"]:
                found.append([number[point] for point in deck.cells["triangle"][element]])
            else:
                raise MeshError(
                    f"surface {name!r} has side {side!r} of element {element}; sides S1 to S4 of "
                    "tets, or triangles, are read"
                )
    return np.array(found, np.int64).reshape(-1, 3)
