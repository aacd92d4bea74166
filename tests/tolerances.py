# SPDX-License-Identifier: BSD-3-Clause
"""How close is close enough, in one place, so that no test loosens its own.

All are relative to the size of what is compared unless said otherwise. A test that needs another
number says why beside it.
"""

from __future__ import annotations

ROUNDING = 1e-13
"""Two ways to write the same sum of a few terms."""

CLOSED_FORM = 1e-12
"""A formula in floating point against the same in exact fractions."""

TWIN = 1e-10
"""The same mesh, degree and equations by another code, each solved directly."""

INVARIANCE = 1e-9
"""The same body in another order, frame, place or unit, solved directly."""

RIGID = 1e-13
"""An eigenvalue that belongs to a rigid motion, relative to the largest."""

RATE_SLACK = 0.15
"""How far a measured rate of convergence may stay below the theory's (absolute)."""

ITERATIVE = 1e-6
"""A displacement from conjugate gradients stopped at 1e-10, against the direct solver."""


def patch(degree: int) -> float:
    """How exactly a polynomial of that degree has to come back from a solve."""
    return 1e-12 if degree <= 8 else 1e-10


HUNG = 1e-11
"""A body held at three vertices only: near-rigid motions are hardly resisted, so rounding grows."""

SINGLE = 1e-5
"""Forces by an operator in float32, relative to the largest."""

ENERGY_NORM = 1e-7
"""A solve by multigrid to 1e-8 against the direct solver, in the energy norm, relative."""

HARD = 1e-5
"""Multigrid to 1e-8 against the direct solver in the energy norm, relative, on the hardest bodies:
contrasts of 1e4 and flat tets stand between a small residual and a small error."""

MIXED_TWIN = 1e-8
"""Displacement, pressure and energy of the mixed form by another code, both solved to 1e-12: the
matrix is indefinite, and nu = 0.4999 beside a stiffness contrast of 100 costs digits."""

DICE_TISSUE, DICE_JAW = 0.97, 0.95
"""Overlap of labels with the truth at voxel centres: soft tissue, and bone thicker than two voxels;
the mandible, whose cuts from the skull are a matter of a voxel or two."""

SKIN_VOXELS = 0.3
"""Mean distance of the labelled skin from the true one, in voxels; a perfect rounding to voxels has
0.2 to 0.25."""

ANGLE = 8.0
"""Degrees: what no dihedral angle of a mesh made from labels falls below."""

SURFACE_VOXELS = 0.5
"""Mean distance of a surface of the mesh from where the labels end, in voxels."""

TISSUE_VOLUME = 0.02
"""Volume of the mesh against that of the voxels: chords cut off corners, steps are smoothed."""

SMOOTH_EFFECTIVITY = 0.05
"""Estimated over true error of a smooth displacement, less one: two degrees more see all of it but
what is left at degree 1 on few tets."""

LOOSE_SOLVES = 0.05
"""Errors from solves to 3 % of the residual: 1 % of the error and a part of what is not seen."""
