# SPDX-License-Identifier: BSD-3-Clause
"""Which degrees of displacement and pressure go together, and which are refused and why.

A pressure is determined by the displacements that it works on. Where there are too many pressures
for them, some cost nothing, and the answer is made of these: a checkerboard. Pairs are *stable*
when the inf-sup constant

    beta = min over q  max over v of  int q div v / (|q| |grad v|)

stays above a bound on ever finer meshes. Continuous pressures of degree 1 to k - 1 beside
displacements of degree k from 2 on are stable where every tet has a vertex that is free (D. Boffi,
SIAM J. Numer. Anal. 34, 1997, doi:10.1137/S0036142994270193).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from bezsoma.errors import InputError

HIGHEST_MIXED = 8
"""The highest degree of the displacement beside a pressure."""


def pressure_degree_checked(given: Any, degree: int) -> int:
    """The degree of the pressure as an int, if the pair with this degree of displacement is stable.

    >>> pressure_degree_checked(1, 2)
    1
    """
    if isinstance(given, bool) or not isinstance(given, int | np.integer):
        raise InputError(
            f"pressure_degree = {given!r}: it must be a whole number, one less than the degree of "
            f"the displacement as a rule; {_stable(degree)}"
        )
    if not 2 <= degree <= HIGHEST_MIXED:
        raise InputError(_no_pressure(degree))
    if not 1 <= given <= degree - 1:
        raise InputError(_unstable(int(given), degree))
    return int(given)


def _no_pressure(degree: int) -> str:
    if degree == 1:
        return (
            "degree = 1 with a pressure: linear displacements are too few for any continuous "
            "pressure (P1/P1) and lock beside a constant one (P1/P0); " + _stable(1)
        )
    return (
        f"degree = {degree} with a pressure: the mixed form is built for degrees 2 to "
        f"{HIGHEST_MIXED}; from degree 6 on the displacement form hardly locks"
    )


def _unstable(given: int, degree: int) -> str:
    pair = f"degree = {degree} with pressure_degree = {given}"
    if given > degree:
        why = "there are more pressures than displacements that could tell them apart"
    elif given == degree:
        why = (
            "pairs of equal degree have pressures that no displacement feels, so that the "
            "inf-sup constant falls to zero as the mesh is refined"
        )
    elif given == 0:
        why = (
            "a pressure that is constant on each tet is not continuous, and tets are too many for "
            "it: this pair is not stable in general"
        )
    else:
        why = "a polynomial has no such degree"
    return f"{pair}: {why}; {_stable(degree)}"


def _stable(degree: int) -> str:
    if degree < 2:
        return "stable is degree=2 with pressure_degree=1, or any degree k from 2 on with 1 to k-1"
    best = f"pressure_degree={degree - 1}"
    span = best if degree == 2 else f"pressure_degree from 1 to {degree - 1} ({degree - 1} is best)"
    return f"stable with degree={degree} is a continuous pressure, {span}"
