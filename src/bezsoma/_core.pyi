# SPDX-License-Identifier: BSD-3-Clause
"""The C++ kernels: flat arrays in C order; 0 threads means all cores."""

import numpy as np
import numpy.typing as npt

from .arrays import Bools, Floats, Ints

def element_matrices(
    degree: int, gradients: Floats, volumes: Floats, lam: Floats, mu: Floats
) -> Floats: ...
def pattern(of_tet: Ints, controls: int) -> tuple[Ints, npt.NDArray[np.int32]]: ...
def assembled(
    degree: int,
    of_tet: Ints,
    gradients: Floats,
    volumes: Floats,
    lam: Floats,
    mu: Floats,
    starts: Ints,
    columns: npt.NDArray[np.int32],
    threads: int = 0,
) -> Floats: ...
def multiply(
    starts: Ints,
    columns: npt.NDArray[np.int32],
    blocks: Floats,
    x: Floats,
    y: Floats,
    threads: int = 0,
) -> None: ...
def incomplete_cholesky(
    starts: Ints,
    columns: npt.NDArray[np.int32],
    blocks: Floats,
    held: Bools,
    shift: float,
    least: float,
) -> tuple[Ints, npt.NDArray[np.int32], Floats, Floats, int]: ...
def solve_cholesky(
    starts: Ints,
    columns: npt.NDArray[np.int32],
    below: Floats,
    inverse: Floats,
    r: Floats,
    z: Floats,
) -> None: ...
