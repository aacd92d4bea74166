# SPDX-License-Identifier: BSD-3-Clause
"""Tissue that stiffens, in states that are the same everywhere: forces and energies by formula."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy.optimize import brentq

import bezsoma as bz
from bezsoma.mesh import block
from verification.problem import ANALYTICAL, EXACT, LAW, Family, Value

FAMILY = Family("stiffening", "The paper's law in its readings, and its kin with an energy.")
E, NU, A = 1.0, 0.25, 5.0
ROTH = "S. H. M. Roth et al., doi:10.1111/1467-8659.00289, equations 22 to 24 as corrected"
STATES = {
    "confined stretch": np.diag([0.0, 0.0, 0.2]),
    "swelling": 0.1 * np.eye(3),
    "pure shear": np.array([[0, 0, 0.1], [0, 0, 0], [0.1, 0, 0]]),
    "everything at once": np.array([[0.1, 0.05, -0.02], [0.05, -0.08, 0.03], [-0.02, 0.03, 0.12]]),
}
READINGS = {
    "Frobenius": ("frobenius", "tensor"),
    "Frobenius, engineering": ("frobenius", "engineering"),
    "mean": ("mean", "tensor"),
    "mean, engineering": ("mean", "engineering"),
    "energy": ("energy", "tensor"),
    "deviatoric": ("deviatoric", "tensor"),
}


def stress(eps: np.ndarray, reading: str) -> np.ndarray:
    """By hand."""
    lam, mu = E * NU / ((1 + NU) * (1 - 2 * NU)), E / (2 + 2 * NU)
    linear = lam * np.trace(eps) * np.eye(3) + 2 * mu * eps
    measure, shears = READINGS[reading]
    weighted = eps * (1 if shears == "tensor" else 2 - np.eye(3))
    if measure == "frobenius":
        return np.exp(A * (weighted**2).sum()) * linear
    if measure == "mean":
        return np.exp(A * (np.abs(weighted).sum() / 9) ** 2) * linear
    if measure == "energy":
        return np.exp(A * (eps * linear).sum() / E) * linear
    dev = eps - np.trace(eps) / 3 * np.eye(3)
    kappa = E / (3 * (1 - 2 * NU))
    return kappa * np.trace(eps) * np.eye(3) + 2 * mu * np.exp(A * (dev**2).sum()) * dev


def homogeneous(reading: str) -> Iterator[Value]:
    """Every facet moved with the strain: the force on the top is the stress."""
    measure, shears = READINGS[reading]
    law = bz.Stiffening(E, NU, A, measure, shears)
    for name, eps in STATES.items():
        u = bz.Polynomial.affine(eps)
        held = [bz.Prescribed("left", "right", "front", "back", "bottom", "top", value=u)]
        found = bz.solve(bz.Body(block(cells=(2, 1, 1), irregular=0.2), 2, law, held))
        s = found.stress.at(np.array([[0.31, 0.42, 0.53]]))[0].reshape(3, 3)
        away = float(np.abs(s - stress(eps, reading)).max() / np.abs(stress(eps, reading)).max())
        yield Value(f"stress in {name}, largest error", "degree 2, 12 tets", away, 0.0, 1e-9)


PULL = 0.4
"""MPa."""


def between_walls(law: bz.LinearElastic | bz.Stiffening, degree: int) -> bz.Body:
    """A cube drawn out between slippery walls by a force on its top."""
    walls = [bz.Fixed("left", "right", components="x"), bz.Fixed("front", "back", components="y")]
    held = [*walls, bz.Fixed("bottom", components="z")]
    return bz.Body(block(), degree, law, held, [bz.Traction("top", value=(0, 0, PULL))])


def pulled(reading: str) -> Iterator[Value]:
    """Drawn out between slippery walls by a force: one equation for the strain."""
    measure, shears = READINGS[reading]

    def missing(e: float) -> float:
        return float(stress(np.diag([0.0, 0.0, e]), reading)[2, 2]) - PULL

    wanted = brentq(missing, 0.0, 0.5, xtol=1e-15)
    law = bz.Stiffening(E, NU, A, measure, shears)
    for degree in (1, 2):
        found = bz.solve(between_walls(law, degree))
        top = float(found.displacement.at(np.array([[0.5, 0.5, 1.0]]))[0, 2])
        yield Value("top, mm", f"degree {degree}, 6 tets", top, wanted, 1e-8)


def unstiffened() -> Iterator[Value]:
    """A = 0 is linear elasticity, and so is a small load."""
    load = [bz.Traction("top", value=(0.01, 0, 0.02))]
    both = [
        bz.solve(
            bz.Body(block(cells=2), 2, law, [bz.Fixed("bottom")], load), solver="direct"
        ).displacement.controls
        for law in (bz.LinearElastic(E, NU), bz.Stiffening(E, NU, 0.0))
    ]
    away = float(np.abs(both[0] - both[1]).max() / np.abs(both[0]).max())
    yield Value("largest difference", "degree 2, 48 tets", away, 0.0, 1e-9)


def stored(reading: str) -> Iterator[Value]:
    """Stress is the slope of the energy."""
    law = bz.Stiffening(E, NU, A, *READINGS[reading])
    h, eps = 1e-6, STATES["everything at once"]
    for i, j in ((0, 0), (0, 1), (2, 2)):
        d = np.zeros((3, 3))
        d[i, j] = h
        slope = float(law.energy(eps + d) - law.energy(eps - d)) / (2 * h)
        yield Value(
            f"dW/deps_{i}{j}", "central differences", slope, float(law.stress(eps)[i, j]), 1e-7
        )


def turned(reading: str) -> Iterator[Value]:
    """The stress turns with the frame."""
    law = bz.Stiffening(E, NU, A, *READINGS[reading])
    eps, c = STATES["everything at once"], np.sqrt(0.5)
    Q = np.array([[c, -c, 0], [c, c, 0], [0, 0, 1.0]])
    away = np.abs(law.stress(Q @ eps @ Q.T) - Q @ law.stress(eps) @ Q.T).max()
    yield Value("largest difference, MPa", "turned by 45 degrees", float(away), 0.0, 1e-13)


def unturned() -> Iterator[Value]:
    """Uniaxial stress at a strain of 0.2, in two frames: E/E0 by the printed shears."""
    eps, c = np.diag([0.2, -0.05, -0.05]), np.sqrt(0.5)
    Q = np.array([[c, -c, 0], [c, c, 0], [0, 0, 1.0]])
    law = bz.Stiffening(E, NU, A, shears="engineering")
    linear = bz.LinearElastic(E, NU)
    for where, e, wanted in (
        ("along an axis", eps, 1.25),
        ("turned by 45 degrees", Q @ eps @ Q.T, 2.00),
    ):
        grown = float(law.stress(e)[0, 0] / linear.stress(e)[0, 0])
        yield Value("E / E0", where, grown, wanted, 5e-3)


for reading in READINGS:
    FAMILY.add(
        f"Homogeneous strain: {reading}",
        ANALYTICAL,
        ROTH,
        "tau = E exp(A s^2) C_1 eps, or from its energy",
        EXACT,
        homogeneous,
        reading,
    )
    FAMILY.add(
        f"Drawn between walls: {reading}",
        ANALYTICAL,
        ROTH,
        "tau_zz(e) = p",
        "Newton stops at 1e-10",
        pulled,
        reading,
    )
for reading in ("energy", "deviatoric"):
    FAMILY.add(
        f"Stress from the energy: {reading}",
        LAW,
        "dW = tau : deps",
        "tau",
        "central differences",
        stored,
        reading,
    )
for reading in ("Frobenius", "energy", "deviatoric"):
    FAMILY.add(
        f"Frame turned: {reading}", LAW, "a tensor", "Q tau Q^T", "rounding", turned, reading
    )
FAMILY.add(
    "The printed shears change with the frame",
    ANALYTICAL,
    ROTH,
    "E/E0 = 1.25 and 2.00",
    "three digits",
    unturned,
)
FAMILY.add("No stiffening", LAW, "A = 0", "linear elasticity", "Newton stops at 1e-10", unstiffened)
