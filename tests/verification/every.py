# SPDX-License-Identifier: BSD-3-Clause
"""All problems, family by family."""

from __future__ import annotations

from verification import (
    algebra,
    beams,
    case_files,
    finite,
    incompressible,
    invariance,
    manufactured,
    patch,
    plates,
    regions,
    singular,
    spectral,
    spheres,
    stiffening,
    torsion,
)

MODULES = (
    algebra, patch, manufactured, beams, torsion, plates, spheres, regions, incompressible,
    stiffening, finite, singular, invariance, spectral, case_files,
)  # fmt: skip
FAMILIES = [module.FAMILY for module in MODULES]
PROBLEMS = [problem for family in FAMILIES for problem in family]
