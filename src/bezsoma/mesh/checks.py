# SPDX-License-Identifier: BSD-3-Clause
"""What a mesh is refused for, and the sentences that say so.

Each function takes what the user gave and hands back the arrays that the mesh will hold, or
raises `MeshError`. Numbers in the messages are the user's own, from before unused points are
dropped. Coincident points are accepted: a mesh that is not welded is legal, and comes apart in
the check for rigid motions, which names the loose part.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from bezsoma import _core
from bezsoma.arrays import Floats, Int32s, Ints, Numbers
from bezsoma.errors import MeshError, counted
from bezsoma.mesh.shape import FLAT, LARGEST, Signs, flat_tets, heights_and_lengths


def listed(numbers: npt.ArrayLike, first: int = 4) -> str:
    """The first few numbers, and how many more there are.

    >>> listed([3, 5]), listed(range(9))
    ('3 and 5', '0, 1, 2, 3 and 5 more')
    """
    known = [str(number) for number in np.asarray(numbers).ravel()]
    if len(known) > first:
        known = [*known[:first], f"{len(known) - first} more"]
    return " and ".join([", ".join(known[:-1]), known[-1]] if len(known) > 1 else known)


def point_array(given: npt.ArrayLike) -> Floats:
    """The points (v, 3) in mm as a fresh float64 array."""
    array = _array(given, "points")
    if array.ndim != 2 or array.shape[1] != 3:
        flat = " (2-D points: add a third coordinate)" if array.shape[1:] == (2,) else ""
        raise MeshError(f"points have the shape {array.shape}; (v, 3) in mm is needed{flat}")
    if array.dtype.kind not in "fiu":
        raise MeshError(f"points are of type {array.dtype}; real numbers (mm) are needed")
    points = np.array(array, dtype=np.float64)
    with np.errstate(invalid="ignore"):
        bad = np.flatnonzero(~(np.abs(points) <= LARGEST).all(axis=1))
    if len(bad):
        raise MeshError(
            f"{_many(bad, 'point')} {listed(bad)}: the coordinates of point {bad[0]} are "
            f"{points[bad[0]].tolist()}; every coordinate must be a finite number of mm "
            f"(at most {LARGEST:g})"
        )
    return points


def tet_array(given: npt.ArrayLike, count: int) -> Ints:
    """The tets (t, 4), every row ascending; `count` points were given."""
    tets = index_rows(given, 4, count, "tet", "point")
    if not len(tets):
        raise MeshError("the mesh has no tets; at least one row of four vertex numbers is needed")
    return tets


def index_rows(given: npt.ArrayLike, width: int, count: int, what: str, of: str) -> Ints:
    """Rows (r, width) of distinct numbers below `count`, each row ascending.

    >>> index_rows([[2, 0, 1]], 3, 5, "facet", "point")
    array([[0, 1, 2]])
    """
    array = _array(given, _plural(what))
    if array.size == 0:
        return np.zeros((0, width), np.int64)
    if array.ndim != 2 or array.shape[1] != width:
        raise MeshError(
            f"{_plural(what)} have the shape {array.shape}; (n, {width}) is needed: "
            f"a row of {width} {of} numbers for each {what}"
        )
    rows = index_array(array, count, _plural(what), of)
    if _core.sort_rows(rows) >= 0:
        twice = np.flatnonzero((rows[:, 1:] == rows[:, :-1]).any(axis=1))
        raise MeshError(
            f"{_many(twice, what)} {listed(twice)}: number {twice[0]} is "
            f"{array[twice[0]].tolist()} and has the same {of} twice; remove it"
        )
    return rows


def index_array(given: npt.ArrayLike, count: int, what: str, of: str) -> Ints:
    """Numbers of `of`s, 0 to count - 1, as fresh int64."""
    array = _array(given, what)
    if array.size == 0:
        return np.zeros(array.shape, np.int64)
    if array.dtype.kind not in "iu":
        raise MeshError(
            f"{what} hold numbers of type {array.dtype}{_fractions(array)}; {of} numbers are "
            f"whole numbers, 0 to {count - 1}: give an array of integers (.astype(int))"
        )
    if array.min() < 0 or array.max() >= count:
        outside = (array < 0) | (array >= count)
        rows = np.flatnonzero(outside.reshape(len(array), -1).any(axis=1))
        value = array[outside][0]
        one = " (numbers start at 0, not at 1)" if value == count else ""
        raise MeshError(
            f"{what} name {of} {value} (in row {listed(rows)}), but the "
            f"{_plural(of)} are numbered 0 to {count - 1}{one}"
        )
    return np.array(array, dtype=np.int64, order="C")


def region_names(given: Sequence[str]) -> tuple[str, ...]:
    """The names of the regions, each once."""
    if isinstance(given, str):
        raise MeshError(f"regions is the text {given!r}; a sequence is needed: ({given!r},)")
    names = tuple(given)
    if not names:
        raise MeshError("regions is empty; at least one name is needed, such as ('tissue',)")
    for name in names:
        place_name(name, "region")
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise MeshError(f"the region name {twice[0]!r} is given twice; each region needs its own")
    return names


def region_array(given: npt.ArrayLike | None, tets: int, names: tuple[str, ...]) -> Ints:
    """The region (t,) of each tet, an index into `names`."""
    if given is None:
        return np.zeros(tets, np.int64)
    array = _array(given, "region")
    if array.shape != (tets,):
        raise MeshError(
            f"region has the shape {array.shape}, but the mesh has {counted(tets, 'tet')}; "
            f"one region number a tet is needed: the shape ({tets},)"
        )
    return index_array(array, len(names), f"region numbers (regions: {list(names)})", "region")


def shape(points: Floats, tets: Ints) -> Signs:
    """The orientation (t,) of every tet, +1 or -1; flat ones are refused."""
    signs, flat = flat_tets(points, tets)
    bad = np.flatnonzero(flat)
    if len(bad):
        worst = tets[bad[0]]
        height, length = heights_and_lengths(points[worst][None])
        raise MeshError(
            f"{len(bad)} of {len(tets)} tets {'is' if len(bad) == 1 else 'are'} flat: tet "
            f"{listed(bad)}. Tet {bad[0]} (vertices {worst.tolist()}) has the height "
            f"{height[0]:.3g} mm and a longest edge of {length[0]:.3g} mm, a ratio below {FLAT:g}; "
            "a tet needs a volume: collapse or remove it, or mesh again"
            + _coincident(points, worst)
        )
    return signs


class Faces(NamedTuple):
    """The tets (t, 4) of a mesh, its faces (f, 3), and which of them each tet has (t, 4)."""

    tets: Ints
    rows: Int32s
    of_tet: Int32s


def topology(mesh: Faces, signs: Signs, names: Ints) -> None:
    """Say what is wrong where tets overlap: listed twice, three at a face, or folded.

    `names` (v,) are the numbers of the points as the user gave them.
    """
    _listed_twice(mesh, names)
    counts = np.bincount(mesh.of_tet.ravel())
    order = np.argsort(mesh.of_tet.ravel(), kind="stable")  # what touches each face, face by face
    ends = np.cumsum(counts)
    crowded = np.flatnonzero(counts > 2)
    if len(crowded):
        around = order[ends[crowded[0]] - counts[crowded[0]] : ends[crowded[0]]] // 4
        raise MeshError(
            f"the face with vertices {names[mesh.rows[crowded[0]]].tolist()} is shared by "
            f"{len(around)} tets ({listed(around)}){_others(crowded)}; a face separates at most "
            "two: tets overlap there, remove the wrong ones or mesh again"
        )
    _folds(mesh, signs, order, ends[counts == 2], names)


def _listed_twice(mesh: Faces, names: Ints) -> None:
    """Equal rows have the same first face and the same last vertex."""
    keys = mesh.of_tet[:, 3].astype(np.int64) * (int(mesh.tets.max()) + 1) + mesh.tets[:, 3]
    order = np.argsort(keys, kind="stable")
    same = np.flatnonzero(keys[order][1:] == keys[order][:-1])
    if len(same):
        first, again = order[same[0]], order[same[0] + 1]
        raise MeshError(
            f"tets {first} and {again} are the same, vertices {names[mesh.tets[first]].tolist()}"
            f"{_others(same)}; a tet may be listed once only: remove the copies"
        )


def _folds(mesh: Faces, signs: Signs, order: Ints, ends: Ints, names: Ints) -> None:
    """Two tets on one side of their face: moving vertex i to the front gives the sign (-1)^i."""
    side = (signs[:, None] * np.array([1, -1, 1, -1])).ravel()
    one, other = order[ends - 2], order[ends - 1]
    folded = np.flatnonzero(side[one] == side[other])
    if len(folded):
        a, b = one[folded[0]] // 4, other[folded[0]] // 4
        face = mesh.rows[mesh.of_tet.ravel()[one[folded[0]]]]
        raise MeshError(
            f"tets {a} and {b} lie on the same side of the face they share, vertices "
            f"{names[face].tolist()}{_others(folded)}: the mesh is folded over "
            "itself there; move the vertex that was pushed through, or mesh again"
        )


def place_name(name: object, kind: str) -> str:
    """A name that can be read back: text, not blank, nothing around it."""
    if not isinstance(name, str) or not name or name != name.strip() or not name.isprintable():
        raise MeshError(
            f"{name!r} cannot name a {kind}; a name is text that is not blank, on one line and "
            "without space at its ends"
        )
    return name


def one_namespace(**kinds: Mapping[str, object]) -> None:
    """Refuse a name that two kinds of places bear: a support could not tell which is meant."""
    seen: dict[str, str] = {}
    for kind, places in kinds.items():
        for name in places:
            if place_name(name, kind) in seen:
                raise MeshError(
                    f"{name!r} is the name of two places ({seen[name]}, {kind}); surfaces, edges "
                    "and vertices share their names: rename one"
                )
            seen[name] = kind


def members(found: Ints, rows: Ints, name: str, kind: str, why: str) -> None:
    """Refuse an empty place, rows that are not in the mesh, and rows listed twice.

    `found` (r,) is each row's number among the mesh's own, -1 where it is none of them.
    """
    if not len(rows):
        raise MeshError(f"{kind} {name!r} is empty; leave it out or give it at least one row")
    wrong = np.flatnonzero(found < 0)
    if len(wrong):
        raise MeshError(
            f"{kind} {name!r}: row {listed(wrong)} (first: {rows[wrong[0]].tolist()}) {why}"
        )
    _, counts = np.unique(found, return_counts=True)
    if (counts > 1).any():
        raise MeshError(
            f"{kind} {name!r}: {int((counts > 1).sum())} of its rows are listed more than once; "
            "loads on them would count twice: give every row once"
        )


def _array(given: npt.ArrayLike, what: str) -> Numbers:
    try:
        array = np.asarray(given)
    except (ValueError, TypeError) as error:
        raise MeshError(
            f"{what} cannot be made into an array ({error}); rows of equal length are needed"
        ) from error
    return array


def _fractions(array: Numbers) -> str:
    if array.dtype.kind != "f":
        return ""
    values = array.astype(np.float64)
    bad = values[values != np.floor(values)]
    return f" (such as {bad[0]:g})" if len(bad) else ""


def _coincident(points: Floats, vertices: Ints) -> str:
    for i, a in enumerate(vertices):
        for b in vertices[i + 1 :]:
            if (points[a] == points[b]).all():
                return f" (vertices {a} and {b} lie at the same place)"
    return ""


def _many(bad: Ints, what: str) -> str:
    return what if len(bad) == 1 else f"{len(bad)} {_plural(what)}:"


def _plural(noun: str) -> str:
    """Many of it: the first word bears the ending.

    >>> _plural("vertex"), _plural("facet of surface 'skin'")
    ('vertices', "facets of surface 'skin'")
    """
    first, space, rest = noun.partition(" ")
    return ("vertices" if first == "vertex" else f"{first}s") + space + rest


def _others(bad: Ints) -> str:
    return "" if len(bad) == 1 else f" (and {len(bad) - 1} more such places)"
