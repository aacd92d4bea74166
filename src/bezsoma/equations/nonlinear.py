# SPDX-License-Identifier: BSD-3-Clause
"""The equations of a body of any law at a fraction of its load: internal against applied forces."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from scipy.sparse import csr_array

from bezsoma.arrays import Bools, Floats, Ints
from bezsoma.equations.boundary import PrescribedControls, prescribed
from bezsoma.equations.following import FollowingPressure
from bezsoma.equations.forces import forces
from bezsoma.mechanics.body import Body
from bezsoma.mechanics.loads import Pressure
from bezsoma.mechanics.path import body_at, turns
from bezsoma.mesh.control_net import ControlNet


@dataclass(frozen=True, eq=False)
class NonlinearEquations:
    """F(u) = t R(u) on the free components, u = g(t) on the others, t the fraction of the load.

    What is out of balance is R - F (paper, eq. 26). dead (c, 3) N are the loads that do not depend
    on u, `following` those that do; `known` says what is held at the whole load.
    """

    body: Body
    net: ControlNet
    dead: Floats
    following: tuple[FollowingPressure, ...]
    known: PrescribedControls

    @property
    def held(self) -> Bools:
        """Which components are prescribed (c, 3)."""
        return self.known.mask

    @property
    def of_support(self) -> Mapping[str, tuple[Ints, Bools]]:
        """The controls of each supported place, and which of their components it holds."""
        return self.known.of_support

    @property
    def free(self) -> int:
        """How many components are unknown."""
        return int(self.held.size - self.held.sum())

    def given(self, fraction: float) -> Floats:
        """The prescribed values (c, 3) mm at a fraction of the load, zero where free."""
        if turns(self.body):
            return prescribed(body_at(self.body, fraction), self.net).values
        return fraction * self.known.values

    def applied(self, u: Floats, fraction: float) -> Floats:
        """The applied forces (c, 3) N at a step (paper, eq. 44)."""
        total = self.dead.copy()
        for pressure in self.following:
            total += pressure.forces(u)
        return fraction * total

    def follow(self, u: Floats, fraction: float) -> csr_array[Any] | None:
        """The change (3c, 3c) N/mm of the applied forces with u, or None where they are dead."""
        if not self.following:
            return None
        first, *others = (pressure.matrix(u) for pressure in self.following)
        return csr_array(fraction * sum(others, first))


def nonlinear_equations(
    body: Body, net: ControlNet, known: PrescribedControls
) -> NonlinearEquations:
    """The equations of a body on its net, from what is held.

    >>> from bezsoma.mechanics import Fixed, LinearElastic
    >>> from bezsoma.mesh.solids import block
    >>> law, loads = LinearElastic(1.0, 0.3), [Pressure("top", value=1.0, following=True)]
    >>> body = Body(block(), 2, law, [Fixed("bottom")], loads)
    >>> net = ControlNet(body.mesh, 2)
    >>> found = nonlinear_equations(body, net, prescribed(body, net))
    >>> u = 0 * net.points
    >>> found.applied(u, 0.5).sum(axis=0).round(12).tolist()
    [0.0, 0.0, -0.5]
    """
    following = tuple(
        FollowingPressure(net, load, surface)
        for load in body.loads
        if isinstance(load, Pressure) and load.following
        for surface in load.surfaces
    )
    return NonlinearEquations(body, net, forces(body, net), following, known)
