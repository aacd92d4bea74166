# SPDX-License-Identifier: BSD-3-Clause
"""The C++ kernels: flat arrays in C order; 0 threads means all cores."""

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from .arrays import Bools, Floats, Ints

Int32s = npt.NDArray[np.int32]
Singles = npt.NDArray[np.float32]

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

class Walk:
    def __init__(
        self,
        degree: int,
        first: Int32s,
        order: Ints,
        points: Floats,
        corners: Ints,
        region: Ints,
        lame: Floats,
    ) -> None: ...

class MatrixFree:
    def __init__(
        self, walk: Walk, threads: int = 0, instructions: str = "", single: bool = False
    ) -> None: ...
    def apply(self, x: Floats, y: Floats) -> None: ...
    def apply_single(self, x: Singles, y: Singles) -> None: ...
    def work(self, x: Floats) -> float: ...
    @property
    def instructions(self) -> str: ...
    @property
    def threads(self) -> int: ...

class MixedFree:
    def __init__(
        self,
        walk: Walk,
        pressure_degree: int,
        first: Int32s,
        threads: int = 0,
        instructions: str = "",
    ) -> None: ...
    def apply(self, u: Floats, p: Floats, f: Floats, g: Floats) -> None: ...
    def work(self, u: Floats, p: Floats) -> float: ...
    def mass(self, weight: Floats, p: Floats, g: Floats) -> None: ...
    @property
    def instructions(self) -> str: ...
    @property
    def threads(self) -> int: ...

class Multigrid:
    def __init__(
        self,
        k: MatrixFree,
        walk: Walk,
        corners: Int32s,
        points: Floats,
        held: Bools,
        held_vertices: Bools,
    ) -> None: ...
    def solve(
        self,
        f: Floats,
        x: Floats,
        reference: float,
        rtol: float,
        most: int,
        report: Callable[[int, float], None],
    ) -> tuple[list[float], float, bool, bool, bool]: ...
    def apply(self, r: Floats, z: Floats) -> None: ...
    @property
    def levels(self) -> list[int]: ...
    @property
    def bytes(self) -> int: ...

class Saddle:
    def __init__(
        self,
        form: MixedFree,
        walk: Walk,
        corners: Int32s,
        points: Floats,
        held: Bools,
        held_vertices: Bools,
        weight: Floats,
        levels: Floats,
    ) -> None: ...
    def solve(
        self,
        f: Floats,
        g: Floats,
        u: Floats,
        p: Floats,
        unit: float,
        volume_weight: float,
        rtol: float,
        most: int,
        report: Callable[[int, float], None],
    ) -> tuple[list[float], float, bool, bool, bool]: ...
    @property
    def bytes(self) -> int: ...

def instruction_sets() -> list[str]: ...
