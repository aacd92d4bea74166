# SPDX-License-Identifier: BSD-3-Clause
"""What one product K u takes, counted from the kernel (src/core/elastic_kernel.hpp).

Flops are additions and multiplications. Where an addition follows a multiplication a processor
does both at once, so `instructions` counts those pairs as one: a sum without factors, which most of
the ladder is, fills half of a unit that is rated by such pairs.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import comb

WRITTEN_OUT = 6
"""The highest degree whose whole ladder is.

Its highest level is 5, and BEZSOMA_LADDER says 4 of the level below.
"""


@dataclass(frozen=True)
class Counts:
    """Of one tet and one right-hand side."""

    flops: int
    instructions: int


def controls(degree: int) -> int:
    """Of one tet; 0 for a degree of -1."""
    return comb(degree + 3, 3)


def of_tet(degree: int) -> Counts:
    """Gradient, stress, ladder on six components, transposed gradient, sum into the forces.

    At each control of degree n - 1 (counted beside the code):

        differences  9 subtractions
        gradient     9 sums of three products:             27 mul 18 add, 27 with pairs
        stress       trace, scales, 6 components:          12 mul  8 add, 14 with pairs
        forces       6 scales, 3 x 4 sums of three products, 3 x 3 of them onto a sum:
                                                           42 mul 33 add, 42 with pairs
        from degree 3 on 6 scales, 3 x 3 sums of three products, their sums, and 3 x 3 sums
        onto others:                                       33 mul 33 add, 48 with pairs

    and the ladder from level m = n - 1 down, for each of six components: 3 + 4 additions for each
    control of the level below and one product for each of this level, which an addition pairs with.
    The lowest level's factor is one, and is left out, as are those of the corners of the highest
    where its controls are written out for the compiler. Last 3 sums for each control.
    Factors of one elsewhere and sums onto zero, about as many, are not told apart.

    >>> of_tet(1).flops == 9 + 45 + 20 + 75 + 12
    True
    >>> of_tet(2).flops == 4 * (9 + 45 + 20 + 75) + 6 * 7 + 30
    True
    """
    points = controls(degree - 1)
    below = sum(controls(level) for level in range(degree - 1))
    levels = sum(controls(level) for level in range(1, degree))
    corners = 4 if 2 <= degree <= WRITTEN_OUT else 0
    ladder = 6 * (7 * below + levels - corners)
    scatter = 3 * controls(degree)
    forces, paired = (75, 42) if degree <= 2 else (66, 48)
    flops = points * (9 + 45 + 20 + forces) + ladder + scatter
    instructions = points * (9 + 27 + 14 + paired) + 6 * 7 * below + scatter
    return Counts(flops, instructions)


def forms_shapes(degree: int, width: int) -> bool:
    """Whether shapes are formed from points in place of being kept (src/core/formed_shapes.hpp)."""
    return degree == 1 and width == 8


def bytes_of_tet(degree: int, width: int) -> int:
    """Geometry, first controls and region of one tet, for numbers of `width` bytes."""
    entities = (4, 10, 14, 15)[min(degree, 4) - 1]
    geometry = 0 if forms_shapes(degree, width) else 9 * width
    return geometry + 4 * entities + 4


def least_bytes(degree: int, tets: int, unknowns: int, width: int, sides: int) -> int:
    """What has to move between memory and processor.

    u is read; f is written, and read before that, as a cache does where a store misses; each tet's
    own numbers, and points where shapes are formed from them, are read once for all sides.
    """
    points = width * unknowns if forms_shapes(degree, width) else 0
    return 3 * width * unknowns * sides + tets * bytes_of_tet(degree, width) + points
