# SPDX-License-Identifier: BSD-3-Clause
"""K u without a matrix and without quadrature."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from bezsoma import _core
from bezsoma.arrays import Floats, Int32s, Ints, on_lines
from bezsoma.bernstein import gradient_products
from bezsoma.equations.threads import thread_count
from bezsoma.errors import InputError, counted
from bezsoma.mesh.control_net import ControlNet
from bezsoma.mesh.topology import determinants, slices

TETS_AT_ONCE = 1 << 12
"""Of which the diagonal is formed in one piece."""


@dataclass(frozen=True, eq=False)
class MatrixFree:
    """The stiffness of a net as what it does: forces (c, 3) N for displacements (c, 3) mm.

    On an affine tet the gradient of a field of degree n is n times differences of its controls,
    of degree n - 1; stress follows control by control; a sum over degree elevations E_j applies
    the mass matrix of that degree, and the transposed differences take the moments to forces:

        H_b = n sum_i u_{b+e_i} g_i^T,  T = lam tr(H) I + mu (H + H^T)
        f_a = n V sum_i (M T)_{a-e_i} g_i,  M = sum_j a_j E_j E_j^T

    See docs/theory/fast.md. `lame` (regions, 2) holds lambda and mu in MPa of the regions of the
    mesh, or of those in which `region` (t,) puts the tets. The answer has the same bits for any
    number of `threads` (0: all cores). `instructions` names one of `_core.instruction_sets()`;
    empty takes the widest that the processor has.

    The assembled matrix is the proof:

    >>> from bezsoma.equations.assembled import assembled
    >>> from bezsoma.mesh.solids import block
    >>> net = ControlNet(block(cells=2), 4)
    >>> K = assembled(net, np.full(48, 0.6), np.full(48, 0.4))
    >>> u = np.sin(7 * net.points)
    >>> f = MatrixFree(net, np.array([[0.6, 0.4]])) @ u
    >>> bool(abs(f - K @ u).max() < 1e-13 * abs(f).max())
    True
    """

    net: ControlNet
    lame: Floats
    threads: int = 0
    instructions: str = ""
    region: Ints | None = None

    @cached_property
    def kernel(self) -> _core.MatrixFree:
        """The core's side of it."""
        return _core.MatrixFree(self.walk(), thread_count(self.threads), self.instructions)

    @cached_property
    def _single(self) -> _core.MatrixFree:
        threads = thread_count(self.threads)
        return _core.MatrixFree(self.walk(), threads, self.instructions, single=True)

    @property
    def runs_on(self) -> str:
        """The kernels and how many threads, to be read: "avx512, 2 threads"."""
        return f"{self.kernel.instructions}, {counted(self.kernel.threads, 'thread')}"

    @property
    def stiffest(self) -> float:
        """The largest lambda or mu in size that a tet has [MPa]."""
        rows = met(self.lame, self._regions()) if len(self.lame) > 1 else self.lame
        return float(np.abs(rows).max())

    def walk(self, unit: float = 1.0, first: Int32s | None = None) -> _core.Walk:
        """The tets in the order in which they numbered the controls, as the core takes them.

        lambda and mu are divided by `unit`; `first` are the `walked` controls, if at hand.
        """
        return walk(self.net, self.lame / unit, first, self.region)

    def __matmul__(self, x: npt.ArrayLike) -> Floats:
        """K x, (c, 3) or (c, 3, s) for s right-hand sides at once, N.

        Sides are worked on eight or four at a time (two where registers hold two); up to three that
        are left over go one by one. docs/performance.md has what they cost.
        """
        sides, shape = _rows(x, np.float64)
        y = on_lines(sides.shape)
        self.kernel.apply(sides, y)
        return y.reshape(shape)

    def single(self, x: npt.ArrayLike) -> npt.NDArray[np.float32]:
        """K x in float32 throughout, (c, 3) or (c, 3, s)."""
        sides, shape = _rows(x, np.float32)
        y = on_lines(sides.shape, np.float32)
        self._single.apply_single(sides, y)
        return y.reshape(shape)

    def diagonal(self) -> Floats:
        """The diagonal of K (c, 3) N/mm, for smoothers and scalings; keeps nothing of the mesh.

            K_ak,ak = sum over tets of V sum_ij w_ij ((lam + mu) g_ik g_jk + mu g_i . g_j)

        with w_ij the mean of dB_a/dL_i dB_a/dL_j.

        >>> from bezsoma.equations.assembled import assembled
        >>> from bezsoma.mesh.solids import block
        >>> net = ControlNet(block(cells=2), 3)
        >>> K = assembled(net, np.full(48, 0.6), np.full(48, 0.4))
        >>> found = MatrixFree(net, np.array([[0.6, 0.4]])).diagonal()
        >>> bool(abs(found - K.diagonal).max() < 1e-14 * found.max())
        True
        """
        mesh, region = self.net.mesh, self._regions()
        products = gradient_products(self.net.degree, 3)
        weights = np.einsum("ijaa->aij", products).reshape(-1, 16)
        found = np.zeros((self.net.count, 3))
        for part in slices(len(mesh.tets), TETS_AT_ONCE):
            g, lame = mesh.gradients_of(part), self.lame[region[part]]
            volume = np.abs(determinants(mesh.points[mesh.tets[part]])) / 6
            alike = np.einsum("t,tik,tjk->tijk", volume * lame.sum(1), g, g)
            across = np.einsum("t,til,tjl->tij", volume * lame[:, 1], g, g)
            of_tets = weights @ (alike + across[..., None]).reshape(-1, 16, 3)
            np.add.at(found, self.net.closure(3, part), of_tets)
        return found

    def _regions(self) -> Ints:
        """The region (t,) of each tet, numbers of rows of `lame`: NumPy would count -1 from behind.

        The core refuses the same where it is given them.
        """
        tets, rows = len(self.net.mesh.tets), len(self.lame)
        found = np.asarray(self.net.mesh.region if self.region is None else self.region)
        if found.shape != (tets,) or found.dtype.kind not in "biu":
            raise InputError(
                f"region is {found.dtype} of the shape {found.shape}; one whole number a tet is "
                f"needed: the shape ({tets},)"
            )
        wrong = np.flatnonzero((found < 0) | (found >= rows))
        if len(wrong):
            raise InputError(
                f"region must number rows of lame, which has {counted(rows, 'row')}, from 0 on, "
                f"and tet {wrong[0]} has {found[wrong[0]]}; give numbers below {rows}, or lame a "
                "row for each region"
            )
        return np.asarray(found, np.int64)

    def energy(self, x: Floats) -> float:
        """The stored energy int tau : eps / 2 [N mm], the first term of the paper's eq. 7.

        From gradients rather than as x . K x / 2: where supports carry a body along, displacements
        are large and strains small, and in x . K x large terms would cancel.
        """
        return self.kernel.work(np.ascontiguousarray(x)) / 2


def _rows(x: npt.ArrayLike, kind: npt.DTypeLike) -> tuple[npt.NDArray[Any], tuple[int, ...]]:
    """x (c, 3) or (c, 3, s) as (c, 3, s), not copied where it is so; and the shape it had."""
    given = np.asarray(x)
    if given.ndim not in (2, 3) or given.shape[1] != 3:
        raise ValueError(f"x is {given.shape}; it has to be (c, 3), or (c, 3, s) for several sides")
    if given.dtype.kind == "c":  # NumPy would drop the imaginary part and only warn
        raise ValueError(
            f"x is {given.dtype}, and K x is formed of real numbers; give x.real and x.imag one "
            "after the other, or as two sides (c, 3, 2)"
        )
    return np.ascontiguousarray(given, dtype=kind).reshape(len(given), 3, -1), given.shape


def met(rows: Floats, region: Ints) -> Floats:
    """Of rows (regions, ...) those whose regions have tets; region (t,).

    >>> met(np.array([[1.0], [1e9], [2.0]]), np.array([0, 2, 2])).tolist()
    [[1.0], [2.0]]
    """
    return rows[np.bincount(region, minlength=len(rows)) > 0]


def walk(
    net: ControlNet, moduli: Floats, first: Int32s | None = None, region: Ints | None = None
) -> _core.Walk:
    """The tets in the order in which they numbered the controls, as the core takes them.

    moduli (regions, 2): lambda and mu, or what the taker reads there; `first` are the `walked`
    controls of the net, if at hand; `region` (t,) replaces the regions of the mesh.
    """
    mesh = net.mesh
    return _core.Walk(
        net.degree,
        net.walked() if first is None else first,
        net.morton,
        mesh.points,
        mesh.tets,
        mesh.region if region is None else region,
        np.ascontiguousarray(moduli, dtype=np.float64),
    )
