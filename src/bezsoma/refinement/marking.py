# SPDX-License-Identifier: BSD-3-Clause
"""Which tets to refine: the fewest that carry a given part of the error."""

from __future__ import annotations

import numpy as np

from bezsoma.arrays import Floats, Ints


def bulk(shares: Floats, part: float) -> Ints:
    """The fewest tets (q,), ascending, that carry `part` of the sum of `shares` (t,), all >= 0.

        sum over chosen of shares >= part * sum of shares

    W. Doerfler, SIAM J. Numer. Anal. 33, 1996, doi:10.1137/0733054: with shares that are squares
    of an energy error, a fixed part of it is worked on each time, and the error shrinks by a fixed
    factor. With signed contributions to a goal give their magnitudes. Of equal shares the tet of
    the lower number comes first, so that the choice is the same each time.

    >>> bulk(np.array([1.0, 5.0, 0.0, 3.0, 1.0]), 0.8).tolist()
    [1, 3]
    """
    order = np.argsort(-shares, kind="stable")
    carried = np.cumsum(shares[order])
    if not carried[-1] > 0:
        return np.zeros(0, np.int64)
    enough = int(np.searchsorted(carried, part * carried[-1] * (1 - 1e-12))) + 1
    return np.sort(order[:enough])
