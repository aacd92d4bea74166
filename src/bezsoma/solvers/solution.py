# SPDX-License-Identifier: BSD-3-Clause
"""What a solve gives: the displacement, and all that follows from it."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from functools import cached_property
from importlib.metadata import version
from typing import Any

import numpy as np
import scipy

from bezsoma import bernstein
from bezsoma.arrays import Bools, Floats, Ints
from bezsoma.equations import stress as stresses
from bezsoma.equations import volume
from bezsoma.equations.displacement import Equations
from bezsoma.mechanics.body import Body
from bezsoma.mesh.broken_field import BrokenField
from bezsoma.mesh.control_net import ControlNet
from bezsoma.mesh.evaluation import tet_portions
from bezsoma.mesh.field import Field
from bezsoma.solvers.newton import Iteration


@dataclass(frozen=True, eq=False)
class Reaction:
    """What a support does to the body: force (3,) N, moment (3,) N mm about the origin."""

    force: Floats
    moment: Floats


@dataclass(frozen=True, eq=False)
class Solution:
    """The answer to a body at rest: mm, N, MPa, N mm.

    `reactions` has a Reaction for each supported place; a control on the line between two places
    counts for one of them, so that they add up to the whole. `history` holds the residual of each
    iteration, the Euclidean norm over the free components relative to that at zero free
    displacement; `residual` is the one attained, taken anew from the equations. `energy` is the
    stored energy, `volume_change` is int div u in mm3. `timings` has seconds by stage.

    `pressure` [MPa], positive in compression, is there where the body has one of its own: a
    continuous Field, or one that breaks between regions. `level` is a sentence about what its
    mean follows from: the equations, or, where they leave a constant open, the choice of zero.
    `held_tets` counts tets all four vertices of which are prescribed (see `unlocked`). `advice`
    is what another form would do better, or where the tissue is turned inside out between the
    points at which its law was asked, so that the answer cannot be trusted there; mostly nothing,
    and shown wherever the solution is. Where the body is not linear, `path` has every iteration of
    the load steps.

    A solution can be pickled where the functions in its body can: those of a module, no lambdas.
    """

    body: Body
    displacement: Field
    reactions: Mapping[str, Reaction]
    energy: float
    volume_change: float
    method: str
    history: tuple[float, ...]
    iterations: int
    residual: float
    free: int
    timings: Mapping[str, float]
    pressure: Field | BrokenField | None = None
    level: str = ""
    held_tets: int = 0
    advice: str = ""
    path: tuple[Iteration, ...] = ()

    def __repr__(self) -> str:
        advice = f", advice={self.advice!r}" if self.advice else ""
        return (
            f"Solution(degree={self.net.degree}, unknowns={3 * self.net.count}, "
            f"method={self.method!r}, energy={self.energy:.6g} N mm, "
            f"largest_displacement={self.largest_displacement:.6g} mm{advice})"
        )

    @property
    def net(self) -> ControlNet:
        """The control net."""
        return self.displacement.net

    @cached_property
    def strain(self) -> BrokenField:
        """The small strain, (3, 3) at a point: (H + H^T)/2 with H = grad u. Jumps between tets."""
        return stresses.strain(self.displacement)

    @cached_property
    def stress(self) -> BrokenField:
        """The Cauchy stress, (3, 3) at a point, MPa; of degree n - 1, jumps between tets.

        `stress.averaged()` is the continuous field for pictures and probes.
        """
        if self.pressure is not None:
            return stresses.mixed_stress(self.body, self.displacement, self.pressure)
        return stresses.stress(self.body, self.displacement)

    @cached_property
    def divergence(self) -> BrokenField:
        """The volumetric strain div u of small strains; of degree n - 1, jumps between tets.

        At nu = 1/2 the mixed form makes int q div u vanish for every pressure q of its degree, not
        div u at every point; how large it is there says how fine the mesh is.
        """
        return volume.divergence(self.displacement)

    @cached_property
    def determinant(self) -> BrokenField:
        """det(I + grad u) - 1: the local change of volume of the points moved to x + u(x).

        Beware: small-strain equations do not make it vanish, even where they are solved exactly;
        it is of second order in grad u. *Interpolated* beyond degree 4 of the displacement.
        """
        return volume.determinant(self.displacement)

    @cached_property
    def largest_divergence(self) -> float:
        """The largest |div u| [-] in the domain points of every tet; it is attained."""
        return self.divergence.largest()[0]

    @cached_property
    def largest_determinant(self) -> float:
        """The largest |det(I + grad u) - 1| [-] in the domain points of every tet; attained."""
        return self.determinant.largest()[0]

    @cached_property
    def von_mises(self) -> BrokenField:
        """The von Mises stress, MPa, *interpolated* in the domain points of degree n - 1.

        A root is no polynomial: exact in those points only. See `von_mises_at`.
        """
        return stresses.interpolated(self.stress, stresses.von_mises)

    @cached_property
    def principal_stresses(self) -> BrokenField:
        """The principal stresses (3,), MPa, largest first, *interpolated* as `von_mises` is."""
        return stresses.interpolated(self.stress, stresses.principal)

    def von_mises_at(self, points: Floats) -> Floats:
        """The von Mises stress (p,), MPa, of the stress at points (p, 3); no interpolation."""
        return stresses.von_mises(self.stress.at(points))

    def principal_stresses_at(self, points: Floats) -> Floats:
        """The principal stresses (p, 3), MPa, largest first, of the stress at points (p, 3)."""
        return stresses.principal(self.stress.at(points))

    @cached_property
    def largest_displacement(self) -> float:
        """The largest length of the displacement, mm, over the domain points of every tet.

        It is attained; the true maximum may lie a little above, and at most at
        `largest_displacement_bound`. For degree 1 all three are one number.
        """
        field = self.displacement
        bary = bernstein.domain_points(field.degree, 3)
        parts = tet_portions(field, len(bary))
        return max(
            float(np.sqrt((field.tabulated(bary, part) ** 2).sum(axis=-1)).max()) for part in parts
        )

    @property
    def largest_displacement_bound(self) -> float:
        """The largest length of a control, mm: no point moves further (convex hull)."""
        return float(np.linalg.norm(self.displacement.controls, axis=1).max())

    def summary(self) -> dict[str, Any]:
        """The numbers of this solution for a JSON file; mm, N, N mm, s."""
        mesh, net = self.body.mesh, self.net
        sizes = {"tets": len(mesh.tets), "vertices": len(mesh.points), "controls": net.count}
        unknowns = {"unknowns": 3 * net.count, "free_unknowns": self.free}
        return {
            "sizes": {**sizes, **unknowns},
            "degree": net.degree,
            **self._of_pressure(),
            "method": self.method,
            "iterations": self.iterations,
            "residual": self.residual,
            "history": list(self.history),
            **({"steps": [asdict(each) for each in self.path]} if self.path else {}),
            "energy": self.energy,
            "volume_change": self.volume_change,
            "reactions": {
                place: {"force": reaction.force.tolist(), "moment": reaction.moment.tolist()}
                for place, reaction in self.reactions.items()
            },
            "largest_displacement": self.largest_displacement,
            "largest_displacement_bound": self.largest_displacement_bound,
            "timings": dict(self.timings),
            "versions": {
                "bezsoma": version("bezsoma"),
                "python": sys.version.split()[0],
                "numpy": np.__version__,
                "scipy": scipy.__version__,
            },
        }

    def _of_pressure(self) -> dict[str, Any]:
        """What the mixed form adds to the summary, and advice."""
        advice = {"advice": self.advice} if self.advice else {}
        if self.pressure is None:
            return advice
        low, high = _range(self.pressure)
        return {
            **advice,
            "pressure_degree": self.pressure.degree,
            "pressure_level": self.level,
            "pressure_range": [low, high],
            "held_tets": self.held_tets,
            "largest_divergence": self.largest_divergence,
            "largest_determinant": self.largest_determinant,
        }


def _range(field: Field | BrokenField) -> tuple[float, float]:
    """The least and the largest value in the domain points of every tet."""
    bary = bernstein.domain_points(field.degree, 3)
    found = [field.tabulated(bary, part) for part in tet_portions(field, len(bary))]
    return min(float(x.min()) for x in found), max(float(x.max()) for x in found)


def reactions(equations: Equations, u: Floats) -> dict[str, Reaction]:
    """The reaction of each supported place: force, and moment about the origin.

        force = sum_c f_c,  moment = sum_c x_c x f_c,  f = K u - loads where held

    Exact for any degree, although a control is no point of the body: the controls of a rigid
    motion are its values at the domain points x_c (linear precision), so that x_c x f_c summed is
    the work of the forces on a turn. Positions are those before the deformation.
    """
    return resultants(equations.net, equations.of_support, -equations.residual(u))


def resultants(
    net: ControlNet, of_support: Mapping[str, tuple[Ints, Bools]], pull: Floats
) -> dict[str, Reaction]:
    """The force and moment of each supported place from the forces (c, 3) on its controls."""
    points, out = net.points, {}
    for place, (controls, components) in of_support.items():
        f = np.where(components, pull[controls], 0.0)
        out[place] = Reaction(f.sum(axis=0), np.cross(points[controls], f).sum(axis=0))
    return out
