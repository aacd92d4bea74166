# SPDX-License-Identifier: BSD-3-Clause
"""Damaged meshes are refused, in words that say what was given and what can be done.

Beside each fault stand the words its message must have. The look-alikes at the end are fine and
must be accepted.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from bezsoma.errors import InputError, MeshError
from bezsoma.mesh import TetMesh, ball, block, l_block, round_bar, shell

POINTS = np.array(
    [[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1], [-1, -0.8, 0.7], [0.2, 0.2, -2]]
)
TWO = [[0, 1, 2, 3], [1, 2, 3, 4]]


def changed(where: tuple[int, int], value: float) -> np.ndarray:
    points = POINTS.copy()
    points[where] = value
    return points


def mesh(points: Any = POINTS, tets: Any = TWO, **more: Any) -> TetMesh:
    return TetMesh(points, tets, **more)


FAULTS: dict[str, tuple[Callable[[], object], list[str]]] = {
    "not a number": (lambda: mesh(changed((2, 1), np.nan)), ["point 2", "nan", "finite"]),
    "infinite": (lambda: mesh(changed((4, 0), np.inf)), ["point 4", "inf", "finite"]),
    "infinite, unused point": (lambda: mesh(changed((5, 0), -np.inf)), ["point 5", "-inf"]),
    "overflowing": (lambda: mesh(changed((1, 0), 1e200)), ["point 1", "1e+200", "at most"]),
    "2-D points": (lambda: mesh(POINTS[:, :2]), ["(7, 2)", "2-D points", "third coordinate"]),
    "one point": (lambda: mesh(POINTS[0]), ["(3,)", "(v, 3)"]),
    "points of text": (lambda: mesh(POINTS.astype(str)), ["type <U", "real numbers"]),
    "complex points": (lambda: mesh(POINTS * 1j), ["complex128", "real numbers"]),
    "ragged points": (lambda: mesh([[0, 0, 0], [1, 0]]), ["points", "equal length"]),
    "index too large": (lambda: mesh(tets=[[0, 1, 2, 9]]), ["point 9", "row 0", "0 to 6"]),
    "one-based": (lambda: mesh(tets=[[1, 2, 3, 7]]), ["point 7", "start at 0, not at 1"]),
    "negative index": (lambda: mesh(tets=[*TWO, [0, 1, 2, -1]]), ["point -1", "row 2"]),
    "huge unsigned": (
        lambda: mesh(tets=np.array([[0, 1, 2, 2**64 - 1]], np.uint64)),
        ["point 18446744073709551615", "numbered 0 to 6"],
    ),
    "fractions": (lambda: mesh(tets=[[0, 1, 2, 2.5]]), ["such as 2.5", "whole numbers"]),
    "whole floats": (lambda: mesh(tets=np.array(TWO, float)), ["float64", ".astype(int)"]),
    "logical": (lambda: mesh(tets=np.ones((1, 4), bool)), ["bool", "whole numbers"]),
    "no tets": (lambda: mesh(tets=np.zeros((0, 4), int)), ["no tets", "at least one"]),
    "nothing": (lambda: TetMesh([], []), ["points", "(v, 3)"]),
    "triangles": (lambda: mesh(tets=[[0, 1, 2]]), ["(1, 3)", "(n, 4)"]),
    "quadratic tets": (lambda: mesh(tets=[list(range(10))]), ["(1, 10)", "(n, 4)"]),
    "flat row": (lambda: mesh(tets=[0, 1, 2, 3]), ["(4,)", "(n, 4)"]),
    "ragged tets": (lambda: mesh(tets=[[0, 1, 2, 3], [0, 1]]), ["tets", "equal length"]),
    "same vertex twice": (
        lambda: mesh(tets=[*TWO, [4, 2, 4, 3]]),
        ["tet 2", "[4, 2, 4, 3]", "twice"],
    ),
    "flat": (lambda: mesh(changed((3, 2), 0.0)), ["tet 0", "flat", "height 0 mm", "mesh again"]),
    "all flat": (
        lambda: mesh(POINTS * [1, 1, 0]),
        ["2 of 2 tets", "0 and 1", "flat"],
    ),
    "nearly flat": (lambda: mesh(changed((3, 2), 1e-12)), ["tet 0", "1e-12", "flat"]),
    "flat, in micrometres": (lambda: mesh(1e-6 * changed((3, 2), 1e-12)), ["tet 0", "1e-18"]),
    "flat, far away": (
        lambda: mesh((changed((3, 2), 0.0) @ np.diag([0.1, 0.3, 0.7])) + 1000.1),
        ["tet 0", "flat"],
    ),
    "two points at one place": (
        lambda: mesh(np.vstack([POINTS, POINTS[:1]]), [[0, 1, 2, 7]]),
        ["flat", "vertices 0 and 7 lie at the same place"],
    ),
    "all points at one place": (lambda: mesh(POINTS * 0), ["2 of 2 tets", "flat"]),
    "vanishing": (lambda: mesh(POINTS * 1e-80), ["flat"]),
    "listed twice": (
        lambda: mesh(tets=[*TWO, [3, 2, 1, 0]]),
        ["tets 0 and 2", "the same", "copies"],
    ),
    "three on a face": (
        lambda: mesh(tets=[*TWO, [1, 2, 3, 5]]),
        ["[1, 2, 3]", "3 tets", "0, 1 and 2", "at most two"],
    ),
    "folded": (
        lambda: mesh(tets=[[0, 1, 2, 3], [1, 2, 3, 5]]),
        ["tets 0 and 1", "same side", "folded"],
    ),
    "folded by a pushed vertex": (
        lambda: folded(),
        ["same side of the face", "more such places", "pushed through"],
    ),
    "region too short": (lambda: mesh(region=[0]), ["(1,)", "2 tets", "(2,)"]),
    "region too long": (lambda: mesh(region=[0, 0, 0]), ["(3,)", "2 tets"]),
    "region without name": (lambda: mesh(region=[0, 1]), ["region 1", "['tissue']"]),
    "negative region": (lambda: mesh(region=[0, -1]), ["region -1"]),
    "region by name": (lambda: mesh(region=["a", "b"]), ["whole numbers"]),
    "regions as text": (lambda: mesh(regions="fat"), ["'fat'", "('fat',)"]),
    "region twice": (lambda: mesh(regions=("a", "a")), ["'a'", "twice"]),
    "no region": (lambda: mesh(regions=()), ["empty", "'tissue'"]),
    "region that is a number": (lambda: mesh(regions=(1,)), ["1 cannot name a region", "text"]),
    "facet of no tet": (
        lambda: mesh(surfaces={"skin": [[0, 1, 2], [0, 1, 4]]}),
        ["'skin'", "row 1", "[0, 1, 4]", "no face"],
    ),
    "facet of unused points": (
        lambda: mesh(surfaces={"skin": [[4, 5, 6]]}),
        ["'skin'", "[4, 5, 6]", "no face"],
    ),
    "facet of two": (lambda: mesh(surfaces={"skin": [[0, 1]]}), ["'skin'", "(1, 2)", "(n, 3)"]),
    "facet out of range": (lambda: mesh(surfaces={"skin": [[0, 1, 8]]}), ["'skin'", "point 8"]),
    "facet with a vertex twice": (lambda: mesh(surfaces={"s": [[1, 1, 2]]}), ["'s'", "twice"]),
    "facet twice": (
        lambda: mesh(surfaces={"skin": [[0, 1, 2], [2, 1, 0]]}),
        ["'skin'", "more than once", "count twice"],
    ),
    "empty surface": (lambda: mesh(surfaces={"skin": []}), ["'skin'", "empty", "leave it out"]),
    "edge of no tet": (lambda: mesh(edges={"rim": [[0, 4]]}), ["'rim'", "[0, 4]", "no edge"]),
    "vertex of no tet": (lambda: mesh(vertices={"tip": [5]}), ["'tip'", "5", "no tet uses"]),
    "vertices in rows": (lambda: mesh(vertices={"tip": [[0]]}), ["'tip'", "(1, 1)", "(k,)"]),
    "one name for two places": (
        lambda: mesh(surfaces={"rim": [[0, 1, 2]]}, edges={"rim": [[0, 1]]}),
        ["'rim'", "surface", "edge", "rename"],
    ),
    "blank name": (lambda: mesh(surfaces={" ": [[0, 1, 2]]}), ["' '", "not blank"]),
    "name of two lines": (lambda: mesh(surfaces={"a\nb": [[0, 1, 2]]}), ["one line"]),
    "unknown surface": (lambda: block().facets_of("lefd"), ["'lefd'", "did you mean 'left'"]),
    "unknown place": (lambda: block().place_kind("tob"), ["'tob'", "did you mean 'top'"]),
    "name taken": (lambda: block().with_surface("top", [[0, 1, 3]]), ["'top'", "another name"]),
    "rule that fits nothing": (
        lambda: block().with_surface("lid", lambda x: x[:, 2] > 2),
        ["'lid'", "no boundary facet", "widen"],
    ),
    "rule that gives numbers": (
        lambda: block().with_surface("lid", lambda x: x[:, 2]),
        ["'lid'", "float64", "True or False"],
    ),
    "line off the edges": (
        lambda: block(cells=2).with_edges("rim", [(0, 0, 0), (1, 0, 0), (0, 1, 0.0)]),
        ["'rim'", "no edges along the whole line", "[1.0, 0.0, 0.0]"],
    ),
    "line of one point": (lambda: block().with_edges("rim", [(0.0, 0, 0)]), ["two or more points"]),
    "line that stands": (
        lambda: block().with_edges("rim", [(0, 0, 0), (0, 0, 0.0)]),
        ["stands still"],
    ),
    "no vertex there": (
        lambda: block().with_vertices("tip", (0.9, 1, 1)),
        ["[0.9, 1.0, 1.0]", "nearest is vertex 7", "0.1 mm away"],
    ),
    "vertex out of range": (
        lambda: block().with_vertices("tip", numbers=[8]),
        ["'tip'", "vertex 8", "0 to 7"],
    ),
    "empty vertices": (lambda: block().with_vertices("tip"), ["'tip'", "empty"]),
    "normal inside": (lambda: block().normals(block().all_faces), ["between two tets", "boundary"]),
    "foreign facet": (lambda: block().tets_of_facets([[0, 1, 6]]), ["[0, 1, 6]", "no face"]),
    "flattening move": (lambda: block().moved(np.diag([1, 1, 0])), ["flat"]),
    "matrix of four": (lambda: block().moved(np.eye(4)), ["(4, 4)", "(3, 3)"]),
    "solid of no size": (lambda: block((1, 0, 1)), ["size", "(1, 0, 1)", "positive"]),
    "solid without cells": (lambda: block(cells=0), ["cells is 0", "from 1 up"]),
    "cells in fractions": (lambda: ball(1, 2.5), ["cells", "2.5", "whole"]),  # type: ignore[arg-type]
    "two cells for three": (lambda: block(cells=(2, 2)), ["(2, 2)", "3 whole"]),  # type: ignore[arg-type]
    "too irregular": (lambda: block(cells=6, irregular=1.0), ["irregular=1.0", "1/3"]),
    "irregular beyond": (lambda: block(cells=2, irregular=-0.1), ["-0.1", "from 0 to 1"]),
    "shell inside out": (lambda: shell(2, 1), ["from 2 to 1 mm", "inner must be the smaller"]),
    "endless bar": (lambda: round_bar(1, np.inf), ["length is inf", "finite"]),
    "L without arm": (lambda: l_block(-1), ["arm is -1", "positive"]),
}


def folded() -> TetMesh:
    """A block whose middle vertex was pushed out through a side."""
    whole = block(cells=2)
    points = whole.points.copy()
    middle = np.flatnonzero((points == 0.5).all(axis=1))
    points[middle] = (0.5, 0.52, 1.4)
    return TetMesh(points, whole.tets)


@pytest.mark.parametrize("name", FAULTS)
def test_refused_with_words_that_help(name: str) -> None:
    fault, words = FAULTS[name]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(InputError) as caught:
            fault()
    message = str(caught.value)
    assert [word for word in words if word not in message] == [], message
    assert len(message) < 500


def test_what_concerns_the_mesh_is_a_mesh_error() -> None:
    for name in ("not a number", "flat", "folded", "facet of no tet", "region too short"):
        with pytest.raises(MeshError):
            FAULTS[name][0]()


GOOD: dict[str, Callable[[], TetMesh]] = {
    "either orientation": lambda: mesh(tets=[[1, 0, 2, 3], [4, 1, 2, 3]]),
    "unused points": lambda: mesh(tets=TWO[:1]),
    "far from the origin": lambda: mesh(POINTS + np.array([1000.1, -1000.2, 1e3])),
    "micrometres": lambda: mesh(POINTS * 1e-6),
    "metres for micrometres": lambda: mesh(POINTS * 1e6),
    "light years": lambda: mesh(POINTS * 1e18),
    "atoms": lambda: mesh(POINTS * 1e-15),
    "negative coordinates": lambda: mesh(-POINTS - 3),
    "thin": lambda: mesh(changed((3, 2), 1e-7)),
    "thin, far away": lambda: mesh(changed((3, 2), 1e-7) + 1000.1),
    "needle": lambda: mesh([[0, 0, 0], [1e-6, 0, 0], [0, 1e-6, 0], [0, 0, 1.0]], [[0, 1, 2, 3]]),
    "integer points": lambda: mesh(np.array(POINTS[:5], int)),
    "single precision": lambda: mesh(POINTS.astype(np.float32)),
    "lists": lambda: mesh(POINTS.tolist()),
    "small integers": lambda: mesh(tets=np.array(TWO, np.uint8)),
    "Fortran order": lambda: mesh(np.asfortranarray(POINTS), np.asfortranarray(TWO)),
    "parts that touch in a vertex": lambda: mesh(tets=[TWO[0], [3, 4, 5, 6]]),
    "parts that touch in an edge": lambda: mesh(tets=[TWO[0], [2, 3, 4, 5]]),
    "separate parts": lambda: mesh(
        np.vstack([POINTS[:4], POINTS[:4] + 5]), [[0, 1, 2, 3], [4, 5, 6, 7]]
    ),
    "not welded": lambda: mesh(np.vstack([POINTS[:4], POINTS[1:5]]), [[0, 1, 2, 3], [4, 5, 6, 7]]),
    "facets in any order": lambda: mesh(surfaces={"skin": [[2, 1, 0], [4, 3, 1]]}),
    "a surface inside": lambda: mesh(surfaces={"cut": [[1, 2, 3]]}),
    "surfaces that overlap": lambda: mesh(surfaces={"a": [[0, 1, 2]], "b": [[0, 1, 2]]}),
    "a region without tets": lambda: mesh(regions=("fat", "muscle")),
    "a region and a surface of one name": lambda: mesh(
        regions=("skin",), surfaces={"skin": [[0, 1, 2]]}
    ),
    "names in any script": lambda: mesh(surfaces={"Haut 皮膚 1/2": [[0, 1, 2]]}),
}


@pytest.mark.parametrize("name", GOOD)
def test_look_alikes_are_accepted(name: str) -> None:
    accepted = GOOD[name]()
    assert (accepted.volumes > 0).all()
    assert np.isfinite(accepted.gradients).all()


def test_reversed_tets_give_the_same_mesh() -> None:
    one, other = mesh(), mesh(tets=[[3, 2, 1, 0], [2, 1, 4, 3]])
    assert (one.tets == other.tets).all()
    assert (one.gradients == other.gradients).all()


def test_unused_points_may_be_anything_finite() -> None:
    assert mesh(changed((6, 0), 1e30)).dropped == 2
