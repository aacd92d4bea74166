# SPDX-License-Identifier: BSD-3-Clause
"""Deliberate errors in the mixed form: pressures, their level, and tets that lock."""

from __future__ import annotations

from mutants.mutant import Mutant

MECHANICS = "src/bezsoma/mechanics"
EQUATIONS = "src/bezsoma/equations"
MIXED = ("tests/laws/test_mixed.py",)
PRESSURE = ("tests/paper/test_mixed_equations.py", "tests/twins/test_taylor_hood.py")

MIXING = (
    Mutant(
        "a level of the pressure that is never open",
        f"{EQUATIONS}/level.py",
        "out = parts.flux[np.flatnonzero(~held.ravel())] / size",
        "out = parts.flux / size",
        MIXED,
    ),
    Mutant(
        "compressible tissue that does not determine a level",
        f"{EQUATIONS}/level.py",
        "rigid = np.setdiff1d(label, label[soft])",
        "rigid = np.unique(label)",
        MIXED,
    ),
    Mutant(
        "a net flux that goes unseen",
        f"{EQUATIONS}/level.py",
        "if abs(flux) > FLUX * whole:",
        "if abs(flux) > 1e6 * FLUX * whole:",
        ("tests/faults/test_mixed.py",),
    ),
    Mutant(
        "a mean that counts controls in place of volume",
        f"{EQUATIONS}/level.py",
        "means = np.repeat(net.mesh.volumes / m, m)",
        "means = np.full(net.of_tet.size, 1.0)",
        ("tests/laws/test_mixed.py", "tests/twins/test_taylor_hood.py"),
    ),
    Mutant(
        "a deviatoric strain that keeps half of the volume",
        f"{EQUATIONS}/mixed.py",
        "np.stack([-2 / 3 * G, G], axis=1)",
        "np.stack([-1 / 2 * G, G], axis=1)",
        PRESSURE,
    ),
    Mutant(
        "a pressure that is positive in tension",
        f"{EQUATIONS}/mixed.py",
        "weights = -mesh.volumes[tets, None, None] * mesh.gradients[tets]",
        "weights = mesh.volumes[:, None, None] * mesh.gradients",
        PRESSURE,
    ),
    Mutant(
        "kappa where its reciprocal belongs",
        f"{MECHANICS}/materials.py",
        "return 3 * (1 - 2 * self.nu) / self.E",
        "return 3 * (1 - self.nu) / self.E",
        PRESSURE,
    ),
    Mutant(
        "a pressure that pulls",
        f"{EQUATIONS}/stress.py",
        "law.deviatoric_stress(H[here]) - p[here][..., None, None] * np.eye(3)",
        "law.deviatoric_stress(H[here]) + p[here][..., None, None] * np.eye(3)",
        PRESSURE,
    ),
    Mutant(
        "the second order of a volume change with the wrong sign",
        f"{EQUATIONS}/volume.py",
        "trace + (trace**2 - square) / 2 + cubic",
        "trace - (trace**2 - square) / 2 + cubic",
        MIXED,
    ),
    Mutant(
        "pairs of equal degree let through",
        f"{MECHANICS}/pairs.py",
        "if not 1 <= given <= degree - 1:",
        "if not 1 <= given <= degree:",
        ("tests/faults/test_mixed.py",),
    ),
    Mutant(
        "tets locked that are not looked at",
        f"{EQUATIONS}/locked.py",
        "return np.flatnonzero(whole[net.of_vertices(net.mesh.tets)].all(axis=1))",
        "return np.flatnonzero(whole[net.of_vertices(net.mesh.tets[:, :0])].any(axis=1))",
        ("tests/laws/test_mixed.py", "tests/faults/test_mixed.py"),
    ),
    Mutant(
        "held tets looked at one by one",
        f"{EQUATIONS}/locked.py",
        "links = np.concatenate([free[net.of_tet[tets]], own[pressures.of_tet[tets]]], axis=1)",
        "links = np.concatenate([free[net.of_tet[tets]], own[pressures.of_tet[tets]]], axis=1) & 0",
        ("tests/laws/test_mixed.py",),
    ),
    Mutant(
        "a torn mesh that holds together",
        "src/bezsoma/mesh/torn.py",
        "keys = mesh.tets * len(mesh.regions) + mesh.region[:, None]",
        "keys = mesh.tets * len(mesh.regions)",
        ("tests/laws/test_mixed.py", "tests/cases/test_incompressible.py"),
    ),
    Mutant(
        "fluxes scaled for their size and not scaled back",
        f"{EQUATIONS}/level.py",
        "_plain(modes / size[:, None])",
        "_plain(modes)",
        MIXED,
    ),
)
