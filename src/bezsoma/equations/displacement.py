# SPDX-License-Identifier: BSD-3-Clause
"""The equations of the displacement form: K u = f where nothing is prescribed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from bezsoma.arrays import Bools, Floats, Ints
from bezsoma.equations.assembled import BlockMatrix
from bezsoma.equations.matrix_free import MatrixFree
from bezsoma.mesh.control_net import ControlNet


@dataclass(frozen=True, eq=False)
class Equations:
    """K u = f on the free components of the controls, u = given on the others (paper, eq. 33).

    stiffness K [N/mm], a matrix or what it does; forces f (c, 3) of the loads [N]; held (c, 3)
    says which components are prescribed; given (c, 3) their values [mm], zero elsewhere;
    of_support has for each supported place its controls (k,) and which of their components (k, 3)
    it holds.
    """

    net: ControlNet
    stiffness: BlockMatrix | MatrixFree
    forces: Floats
    held: Bools
    given: Floats
    of_support: Mapping[str, tuple[Ints, Bools]]

    @property
    def free(self) -> int:
        """How many components are unknown."""
        return int(self.held.size - self.held.sum())

    def residual(self, u: Floats) -> Floats:
        """f - K u (c, 3) N: what is out of balance where free, minus the reactions where held.

        K u are the internal forces, int B^T tau (paper, eqs. 8 and 45): for a linear law, and for
        no other, they are the stiffness matrix times the controls.
        """
        product = self.stiffness @ u
        return np.subtract(self.forces, product, out=product)

    def free_product(self, u: Floats) -> Floats:
        """K u (c, 3) N with zeros where the displacement is prescribed."""
        product = self.stiffness @ u
        np.copyto(product, 0.0, where=self.held)
        return product
