# SPDX-License-Identifier: BSD-3-Clause
"""The stiffness matrix of a whole net, as a sparse matrix of 3x3 blocks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.sparse import bsr_array

from bezsoma import _core
from bezsoma.arrays import Floats, Ints, frozen
from bezsoma.equations.threads import thread_count
from bezsoma.mesh import ControlNet


@dataclass(frozen=True, eq=False)
class BlockMatrix:
    """A symmetric matrix of 3x3 blocks, one block row a control, columns ascending.

    starts (c + 1,) int64, columns (blocks,) int32, blocks (blocks, 3, 3) N/mm. The starts are
    64 bits wide since a million controls of high degree have more than 2^31 entries; the columns
    are not, since they count controls. `threads` are those of a product.
    """

    starts: Ints
    columns: npt.NDArray[np.int32]
    blocks: Floats
    threads: int = 1

    @property
    def controls(self) -> int:
        """The number c of block rows."""
        return len(self.starts) - 1

    def __matmul__(self, x: Floats) -> Floats:
        """K x (c, 3) N for x (c, 3) mm; the same bits for any number of threads."""
        y, x = np.empty((self.controls, 3)), np.ascontiguousarray(x)
        _core.multiply(self.starts, self.columns, self.blocks, x, y, self.threads)
        return y

    @property
    def diagonal(self) -> Floats:
        """The diagonal (c, 3) N/mm."""
        rows = np.repeat(np.arange(self.controls), np.diff(self.starts))
        on = self.blocks[rows == self.columns]
        return np.ascontiguousarray(np.diagonal(on, axis1=1, axis2=2))

    def scipy(self) -> bsr_array[Any]:
        """The same matrix (3c, 3c) for SciPy, sharing the blocks; index 3c + k."""
        size = 3 * self.controls
        return bsr_array((self.blocks, self.columns, self.starts), shape=(size, size))


def pattern(of_tet: Ints, controls: int) -> tuple[Ints, npt.NDArray[np.int32]]:
    """Which controls meet in a tet: starts (c + 1,) and ascending columns (blocks,).

    Two tets that share a face:

    >>> starts, columns = pattern(np.array([[0, 1, 2, 3], [0, 1, 2, 4]]), 5)
    >>> [columns[a:b].tolist() for a, b in zip(starts, starts[1:])][2:4]
    [[0, 1, 2, 3, 4], [0, 1, 2, 3]]
    """
    return _core.pattern(of_tet, controls)


def assembled(net: ControlNet, lam: Floats, mu: Floats, threads: int = 0) -> BlockMatrix:
    """The stiffness matrix of a net for lambda and mu (t,) MPa of its tets (paper, eqs. 32, 34).

    Each block is summed over its tets in ascending order by one thread, so that the matrix has
    the same bits for any number of them (0: all cores), and is symmetric to the last bit.
    """
    mesh, number = net.mesh, thread_count(threads)
    starts, columns = pattern(net.of_tet, net.count)
    tets = (mesh.gradients, mesh.volumes, lam, mu)
    blocks = _core.assembled(net.degree, net.of_tet, *tets, starts, columns, number)
    return BlockMatrix(frozen(starts), frozen(columns), frozen(blocks), number)
