# SPDX-License-Identifier: BSD-3-Clause
"""What the body is, nothing computed: materials, supports, loads, joins between supports."""

from bezsoma.mechanics.body import Body
from bezsoma.mechanics.joins import Gap, Graded, Join, Precedence
from bezsoma.mechanics.laws import FunctionLaw, Law
from bezsoma.mechanics.loads import BodyForce, Load, PointForce, Pressure, Traction
from bezsoma.mechanics.materials import LinearElastic, Material
from bezsoma.mechanics.polynomial import Polynomial
from bezsoma.mechanics.supports import Fixed, Moved, Prescribed, Support
from bezsoma.mechanics.values import Value

__all__ = [
    "Body",
    "BodyForce",
    "Fixed",
    "FunctionLaw",
    "Gap",
    "Graded",
    "Join",
    "Law",
    "LinearElastic",
    "Load",
    "Material",
    "Moved",
    "PointForce",
    "Polynomial",
    "Precedence",
    "Prescribed",
    "Pressure",
    "Support",
    "Traction",
    "Value",
]
