# SPDX-License-Identifier: BSD-3-Clause
"""The C++ kernels: flat arrays in C order; 0 threads means all cores."""

from collections.abc import Callable, Sequence

import numpy as np
import numpy.typing as npt

from .arrays import Bools, Floats, Int32s, Ints

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
def orientations(
    points: Floats, tets: Ints, flat: float, largest: float
) -> npt.NDArray[np.int8]: ...
def simplices(tets: Ints, vertices: int, width: int) -> tuple[Int32s, Int32s]: ...
def neighbours(
    faces_of_tet: Int32s, faces: int, sign: npt.NDArray[np.int8]
) -> tuple[Int32s, bool]: ...
def components(pairs: Int32s, tets: int) -> Int32s: ...
def numbers_among(rows: Ints, among: Ints | Int32s) -> Ints: ...
def sort_rows(rows: Ints) -> int: ...
def first_controls(
    order: Ints,
    tets: Ints,
    edges_of_tet: Int32s | None,
    faces_of_tet: Int32s | None,
    counts: Sequence[int],
    inside: Sequence[int],
) -> Ints: ...

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
        corners: Int32s | None,
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
    @property
    def levels(self) -> list[int]: ...
    @property
    def bytes(self) -> int: ...

class Inverse:
    def __init__(
        self,
        walk: Walk,
        corners: Int32s | None,
        points: Floats,
        held: Bools,
        held_vertices: Bools,
        threads: int = 0,
        instructions: str = "",
    ) -> None: ...
    def apply(self, r: Floats, z: Floats) -> None: ...
    def apply_single(self, r: Singles, z: Singles) -> None: ...
    @property
    def bytes(self) -> int: ...
    @property
    def threads(self) -> int: ...

class Saddle:
    def __init__(
        self,
        form: MixedFree,
        walk: Walk,
        corners: Int32s | None,
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

class Law:
    """A material law at points: parameters in the order of docs/theory/laws.md, kappa first.

    linear (kappa, mu); stiffening_frobenius, stiffening_mean, stiffening_frobenius_engineering,
    stiffening_mean_engineering, stiffening_energy, stiffening_deviatoric (kappa, mu, A);
    st_venant_kirchhoff, neo_hooke, neo_hooke_isochoric (kappa, mu); mooney_rivlin and
    veronda_westmann (kappa, c1, c2); ogden (kappa, mu_1, alpha_1, mu_2, alpha_2, ...);
    guccione (kappa, C, bf, bt, bfs, the unit vector of the fibres (3)). kappa = inf is for the
    mixed form only.

    P is tested against grad v: the stress tau at small strain, first Piola-Kirchhoff at finite
    strain. The mixed form has P(H, p) and c(H, p), tested against q: - tr eps - p/kappa at small
    strain, - (J - 1) - p/kappa at finite strain.
    """

    def __init__(self, name: str, parameters: Sequence[float], instructions: str = "") -> None: ...
    def stress(self, H: Floats) -> Floats: ...
    def derivative(self, H: Floats, dH: Floats) -> Floats: ...
    def energy(self, H: Floats) -> Floats: ...
    def mixed_stress(self, H: Floats, p: Floats) -> tuple[Floats, Floats]: ...
    def mixed_derivative(
        self, H: Floats, p: Floats, dH: Floats, dp: Floats
    ) -> tuple[Floats, Floats]: ...
    def mixed_energy(self, H: Floats, p: Floats) -> Floats: ...
    @property
    def name(self) -> str: ...
    @property
    def parameters(self) -> list[float]: ...
    @property
    def finite(self) -> bool:
        """Whether H may be large: J > 0 is asked for."""
    @property
    def has_energy(self) -> bool: ...
    @property
    def splits(self) -> bool:
        """Whether the law has a mixed form."""

def law_names() -> list[str]: ...

class Pointwise:
    """Forces and tangents of laws, one a region, by quadrature without a matrix.

    points (q, 4) barycentric, weights (q,) with sum 1, values (q, m): the Bernstein polynomials of
    degree - 1 at the points. With a pressure net (its degree and first controls) the mixed form.
    """

    def __init__(
        self,
        walk: Walk,
        laws: list[Law],
        points: Floats,
        weights: Floats,
        values: Floats,
        threads: int = 0,
        instructions: str = "",
        single: bool = False,
        pressure_degree: int = 0,
        first_pressure: Int32s | None = None,
    ) -> None: ...
    def forces(self, u: Floats, f: Floats) -> None: ...
    def tangent(self, u: Floats, du: Floats, df: Floats) -> None: ...
    def tangent_single(self, u: Singles, du: Singles, df: Singles) -> None: ...
    def energy(self, u: Floats) -> float: ...
    def mixed_forces(self, u: Floats, p: Floats, f: Floats, g: Floats) -> None: ...
    def mixed_tangent(
        self, u: Floats, p: Floats, du: Floats, dp: Floats, df: Floats, dg: Floats
    ) -> None: ...
    def mixed_energy(self, u: Floats, p: Floats) -> float: ...
    @property
    def least_jacobian(self) -> tuple[float, int, int]:
        """J, tet, point of the last forces or energy; J = inf if no law asks for it."""
    @property
    def greatest_exponent(self) -> tuple[float, int, int]:
        """Argument of exp, tet, point of the last forces or energy; -inf if no law has one."""
    @property
    def bytes(self) -> int: ...
    @property
    def instructions(self) -> str: ...
    @property
    def threads(self) -> int: ...

def instruction_sets() -> list[str]: ...
