# SPDX-License-Identifier: BSD-3-Clause
"""The laws that a case file can name, and which numbers each takes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from bezsoma.errors import InputError, unknown
from bezsoma.mechanics.hyperelastic import (
    Guccione,
    MooneyRivlin,
    NeoHooke,
    Ogden,
    StVenantKirchhoff,
    VerondaWestmann,
)
from bezsoma.mechanics.materials import LinearElastic, Material
from bezsoma.mechanics.stiffening import Stiffening

LAWS: dict[str, tuple[Callable[..., Material], tuple[str, ...], tuple[str, ...]]] = {
    "linear": (LinearElastic, ("E", "nu"), ()),
    "stiffening": (Stiffening, ("E", "nu", "A"), ("measure", "shears")),
    "st-venant-kirchhoff": (StVenantKirchhoff, ("E", "nu"), ()),
    "neo-hooke": (NeoHooke, ("E", "nu"), ()),
    "mooney-rivlin": (MooneyRivlin, ("c1", "c2", "kappa"), ()),
    "ogden": (Ogden, ("mu", "alpha", "kappa"), ()),
    "veronda-westmann": (VerondaWestmann, ("c1", "c2", "kappa"), ()),
    "guccione": (Guccione, ("C", "bf", "bt", "bfs", "kappa", "fibre"), ()),
}
"""Name -> what makes it, the keys it needs, the keys it may have."""

LAW_NAMES = tuple(LAWS)


def law_of(name: str, given: Mapping[str, Any]) -> Material:
    """The material of a law's name and the numbers that were given.

    >>> law_of("neo-hooke", {"E": 0.015, "nu": 0.45})
    NeoHooke(E=0.015, nu=0.45)
    """
    if name not in LAWS:
        raise InputError(unknown("law", name, LAWS, "a case"))
    if name == "linear" and set(given) == {"G", "kappa"}:
        return LinearElastic.from_shear_bulk(**given)
    made, needed, optional = LAWS[name]
    if not set(needed) <= set(given) <= {*needed, *optional}:
        also = f" (and may have {' and '.join(optional)})" if optional else ""
        pair = ", or G and kappa, one pair" if name == "linear" else ""
        raise InputError(
            f"give {' and '.join(needed)}{pair}{also} for the law {name!r}; here is "
            f"{sorted(given) or 'none'}"
        )
    return made(**given)
