# SPDX-License-Identifier: BSD-3-Clause
"""Which way the internal forces of a body's laws are worked out: compiled, or over arrays."""

from __future__ import annotations

from collections.abc import Sequence

from bezsoma import _core, bernstein
from bezsoma.equations.pointwise import Internal, Pointwise
from bezsoma.equations.pointwise_free import PointwiseFree
from bezsoma.mechanics.laws import Law
from bezsoma.mechanics.materials import LinearElastic
from bezsoma.mesh.control_net import ControlNet


def core_law(law: object, mixed: bool = False) -> _core.Law | None:
    """The core's law, or None for a law that is a function in Python."""
    if isinstance(law, LinearElastic):
        return _core.Law("linear", [law.kappa, law.mu])
    found = getattr(law, "core_mixed", None) if mixed else None
    found = getattr(law, "core", None) if found is None else found
    return found if isinstance(found, _core.Law) else None


def internal_forces(
    net: ControlNet, laws: Sequence[Law], exactness: int, threads: int = 0
) -> Internal:
    """The internal forces of laws, one a region, by quadrature of that exactness.

    By the core where it has all of the laws, else over arrays: the same numbers to rounding.
    """
    compiled = [core_law(law) for law in laws]
    known = tuple(law for law in compiled if law is not None)
    if len(known) < len(laws):
        return Pointwise(net, laws, exactness)
    points, weights = bernstein.simplex(exactness, 3)
    return PointwiseFree(net, known, points, weights, threads)
