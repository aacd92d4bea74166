# SPDX-License-Identifier: BSD-3-Clause
"""What the body is, nothing computed: materials, supports, loads, joins between supports."""

from bezsoma.mechanics.body import Body
from bezsoma.mechanics.hyperelastic import (
    Guccione,
    MooneyRivlin,
    NeoHooke,
    Ogden,
    StVenantKirchhoff,
    VerondaWestmann,
)
from bezsoma.mechanics.joins import Gap, Graded, Join, Precedence
from bezsoma.mechanics.laws import FunctionLaw, Law
from bezsoma.mechanics.loads import BodyForce, Load, PointForce, Pressure, Traction
from bezsoma.mechanics.materials import LinearElastic, Material
from bezsoma.mechanics.polynomial import Polynomial
from bezsoma.mechanics.stiffening import Stiffening
from bezsoma.mechanics.supports import Fixed, Moved, Prescribed, Support
from bezsoma.mechanics.values import Value

__all__ = [
    "Body",
    "BodyForce",
    "Fixed",
    "FunctionLaw",
    "Gap",
    "Graded",
    "Guccione",
    "Join",
    "Law",
    "LinearElastic",
    "Load",
    "Material",
    "MooneyRivlin",
    "Moved",
    "NeoHooke",
    "Ogden",
    "PointForce",
    "Polynomial",
    "Precedence",
    "Prescribed",
    "Pressure",
    "StVenantKirchhoff",
    "Stiffening",
    "Support",
    "Traction",
    "Value",
    "VerondaWestmann",
]
