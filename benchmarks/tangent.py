# SPDX-License-Identifier: BSD-3-Clause
"""What a tangent application costs in linear ones, by law and degree: python benchmarks/tangent.py.

One thread, the default quadrature (exactness 2k+2, at least 6). The least of many runs, each in CPU
time of the thread.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial

import numpy as np

from bezsoma import _core, bernstein
from bezsoma.arrays import Floats
from bezsoma.equations.matrix_free import MatrixFree
from bezsoma.equations.pointwise_free import PointwiseFree
from bezsoma.mesh import ControlNet, block

KAPPA, MU = 3.0, 0.7
PARAMETERS = {
    "linear": [KAPPA, MU],
    "st_venant_kirchhoff": [KAPPA, MU],
    "neo_hooke": [KAPPA, MU],
    "neo_hooke_isochoric": [KAPPA, MU],
    "mooney_rivlin": [KAPPA, 0.2, 0.15],
    "ogden": [KAPPA, 0.7, 2.0],
    "veronda_westmann": [KAPPA, 0.3, 1.2],
    "guccione": [KAPPA, 0.5, 3.0, 2.0, 1.5, 1.0, 0.0, 0.0],
}
STIFFENING = [KAPPA, MU, 5.0]
CELLS = {1: 24, 2: 13, 3: 9, 4: 7, 5: 5, 6: 4}


def seconds(work: Callable[[], object], spend: float = 0.5) -> float:
    """The least time of one call."""
    work()
    best, end = np.inf, time.perf_counter() + spend
    while time.perf_counter() < end:
        start = time.thread_time()
        work()
        best = min(best, time.thread_time() - start)
    return float(best)


def ratios(degree: int) -> dict[str, tuple[float, float, float]]:
    """Tangent, forces and tangent in float32, by law, in linear applications."""
    net = ControlNet(block(cells=CELLS[degree]), degree)
    u = 0.01 * np.sin(7 * net.points + 3 * net.points[:, [1, 2, 0]])  # strains of any frame
    K = MatrixFree(net, np.array([[KAPPA - 2 * MU / 3, MU]]), 1)
    one = seconds(lambda: K @ u)
    rule = bernstein.simplex(max(2 * degree + 2, 6), 3)
    found = {}
    for name in _core.law_names():
        law = _core.Law(name, PARAMETERS.get(name, STIFFENING))
        spent = times(PointwiseFree(net, (law,), *rule, threads=1), u)
        found[name] = (spent[0] / one, spent[1] / one, spent[2] / one)
    return found


def times(operator: PointwiseFree, u: Floats) -> tuple[float, float, float]:
    """Seconds of a tangent, of forces, and of a tangent in float32."""
    f, du, df = np.empty_like(u), np.float32(u), np.empty(u.shape, np.float32)
    return (
        seconds(partial(operator.kernel.tangent, u, u, f)),
        seconds(partial(operator.kernel.forces, u, f)),
        seconds(partial(operator.single.tangent_single, du, du, df)),
    )


def main() -> None:
    """A table a degree."""
    for degree in CELLS:
        print(f"\ndegree {degree}: tangent, forces, tangent in float32 [linear applications]")
        for name, row in ratios(degree).items():
            print(f"{name:34}" + "".join(f"{ratio:8.2f}" for ratio in row))


if __name__ == "__main__":
    main()
