# SPDX-License-Identifier: BSD-3-Clause
"""Deliberate errors in subdivision, bounds, tessellation and cells for VTK."""

from __future__ import annotations

from mutants.mutant import Mutant

BERNSTEIN = "src/bezsoma/bernstein"
MESH = "src/bezsoma/mesh"
VIEW = "src/bezsoma/view"
SUBDIVISION = ("tests/laws/test_subdivision.py",)
TESSELLATION = ("tests/laws/test_tessellation.py",)

SURFACES = (
    Mutant(
        "the longest inner diagonal of a tet cut in eight",
        f"{MESH}/subdivision.py",
        "lengths <= lengths.min(axis=1, keepdims=True) * (1 + 1e-9)",
        "lengths >= lengths.max(axis=1, keepdims=True) * (1 - 1e-9)",
        SUBDIVISION,
    ),
    Mutant(
        "children whose corners are those of another diagonal",
        f"{MESH}/subdivision.py",
        "refinement_points(3)[patterns][diagonal]",
        "refinement_points(3)[patterns][0 * diagonal]",
        SUBDIVISION,
    ),
    Mutant(
        "the blossom of a bisection with the point in the wrong child's place",
        f"{BERNSTEIN}/subdivision.py",
        "children[0, j, [i, j]] = children[1, i, [i, j]] = 1 - at, at",
        "children[0, j, [i, j]] = children[1, i, [i, j]] = at, 1 - at",
        SUBDIVISION,
    ),
    Mutant(
        "bounds that forget what was laid aside",
        f"{BERNSTEIN}/bounds.py",
        "np.maximum.at(found, owner[~open_], above[~open_])",
        "np.maximum.at(found, owner[~open_], taken[owner[~open_]])",
        SUBDIVISION,
    ),
    Mutant(
        "bounds of a mesh that pass over a tet by its lower side",
        f"{MESH}/evaluation.py",
        "(high > corners.max(axis=0) + tolerance)",
        "(high < corners.max(axis=0) - tolerance)",
        SUBDIVISION,
    ),
    Mutant(
        "edges of a surface cut by the whole facet's bends, not by their own",
        f"{VIEW}/fineness.py",
        "wanted = np.sqrt(bent.whole.rim / (4 * tolerance))",
        "wanted = np.sqrt(bent.whole.along / (4 * tolerance))",
        TESSELLATION,
    ),
    Mutant(
        "the circle around a triangle half as large as it is",
        f"{VIEW}/chords.py",
        "np.where(acute, around, longest / 4) / 2",
        "np.where(acute, around / 2, longest / 4) / 2",
        (f"{VIEW}/chords.py", *TESSELLATION),
    ),
    Mutant(
        "a mixed second derivative that counts once",
        f"{VIEW}/chords.py",
        "2 * across[:, c] * ranges[i, j]",
        "0 * across[:, c] * ranges[i, j]",
        TESSELLATION,
    ),
    Mutant(
        "the strip of one edge with the ranges of another",
        f"{VIEW}/cuts.py",
        "points[parts + 1 :, 3 - i - j] = 1 / inside",
        "points[parts + 1 :, j] += 1 / inside",
        TESSELLATION,
    ),
    Mutant(
        "normals of a moved surface that do not turn with its facets",
        f"{VIEW}/tessellation.py",
        "                * turned[group.facets]",
        "                * 1.0",
        TESSELLATION,
    ),
    Mutant(
        "values in the place of controls in Bezier cells",
        f"{VIEW}/grid.py",
        "return np.asarray(elevation(degree, dim, chosen - degree))",
        "return np.asarray(values(degree, domain_points(chosen, dim)))",
        ("tests/laws/test_vtk_bezier.py",),
    ),
)
