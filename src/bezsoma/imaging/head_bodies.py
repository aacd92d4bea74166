# SPDX-License-Identifier: BSD-3-Clause
"""The bodies that make up the CT phantom: skin, bones, teeth, hollows. mm, LPS.

The origin lies in the median plane between the closed lips. Sizes are chosen to lie within what is
usual for adults; they are those of no person.
"""

from __future__ import annotations

from collections.abc import Sequence

from bezsoma.imaging.shapes import Body, Ellipsoid, Rod, Turned

Point = tuple[float, float, float]
HINGE: Point = (0, 4, 30)
"""The middle of the line through both condyles, about which the mouth opens."""
SIDES = (1, -1)
ARCH = ((4, -78), (11, -76), (18, -70), (23, -62), (26, -53), (28, -44), (29, -35))
"""Where teeth stand: x and y of the left half."""
CONDYLE = (47.0, 4.0, 30.0)


def both(*bodies: Body) -> list[Body]:
    """Every body and its mirror image."""
    return [*bodies, *map(_mirrored, bodies)]


def _mirrored(body: Body) -> Body:
    def over(p: Point) -> Point:
        return -p[0], p[1], p[2]

    if isinstance(body, Ellipsoid):
        return Ellipsoid(over(body.middle), body.half)
    if isinstance(body, Rod):
        return Rod(over(body.start), over(body.end), body.first, body.second, body.tall)
    return Turned(_mirrored(body.body), body.pivot, body.angle)  # type: ignore[arg-type]


def opened(bodies: Sequence[Body], angle: float) -> list[Body]:
    """Bodies that move with the lower jaw when the mouth opens by an angle in rad."""
    return [Turned(b, HINGE, angle) for b in bodies if not isinstance(b, Turned)]


def chained(points: Sequence[Point], radii: Sequence[float], tall: float = 1.0) -> list[Body]:
    """Rods from point to point."""
    stretches = zip(points[:-1], points[1:], radii[:-1], radii[1:], strict=True)
    return [Rod(a, b, r, s, tall) for a, b, r, s in stretches]


SKIN: list[Body] = [
    Ellipsoid((0, 8, 72), (77, 97, 80)),
    Ellipsoid((0, -28, 18), (70, 66, 72)),
    Rod((0, 22, -140), (0, 14, -10), 58, 58),
    Rod((0, -88, 58), (0, -106, 30), 8, 9),
    Rod((-18, -91, 6), (18, -91, 6), 7, 7),
    *both(Ellipsoid((12, -98, 27), (8, 9, 8)), Ellipsoid((77, 10, 40), (7, 17, 28))),
]
SKIN_OF_JAW: list[Body] = [
    Ellipsoid((0, -48, -22), (54, 48, 37)),
    Ellipsoid((0, -84, -33), (20, 14, 20)),
    Rod((-16, -91, -7), (16, -91, -7), 6.5, 6.5),
    *both(*chained([(18, -74, -32), (33, -48, -31), (42, -8, -26)], [11, 12, 12], 1.65)),
]
CRANIUM: list[Body] = [Ellipsoid((0, 8, 74), (70, 90, 72))]
BRAIN: list[Body] = [Ellipsoid((0, 8, 74), (63, 83, 65)), Rod((0, 35, -10), (0, 35, 14), 13, 13)]
FACE: list[Body] = [
    Ellipsoid((0, -46, 34), (34, 36, 25)),
    Ellipsoid((0, -74, 84), (22, 8, 11)),
    *both(
        Ellipsoid((33, -50, 60), (24, 23, 22)),
        Ellipsoid((47, 8, 46), (13, 20, 15)),
        *chained([(42, -52, 34), (56, -22, 37), (60, 0, 40), (58, 14, 46)], [5.5, 4, 3.5, 4]),
        *chained([(x, y + 3, 12) for x, y in ((0, -79), *ARCH)], [6.0] * 8),
        Rod((29, -32, 14), (26, -22, 30), 6, 5),
    ),
]
ORBITS: list[Body] = both(Ellipsoid((33, -64, 60), (17, 32, 16)))
EYES: list[Body] = both(Ellipsoid((33, -64, 60), (12, 12, 12)))
SPINE: list[Body] = [Rod((0, 36, -140), (0, 30, -7), 12, 12)]
CANAL: list[Body] = [Rod((0, 45, -140), (0, 38, 6), 7, 7)]
HYOID: list[Body] = [*both(Rod((15, -34, -62), (5, -46, -64), 2.5, 3)),
                     Rod((-5, -46, -64), (5, -46, -64), 3, 3)]  # fmt: skip
JAW: list[Body] = [
    *chained([(-18, -74, -32), (-8, -79, -32), (8, -79, -32), (18, -74, -32)], [7, 7, 7, 7], 1.8),
    *both(
        *chained([(18, -74, -32), (33, -48, -31), (42, -8, -26)], [7, 6, 5], 1.8),
        Ellipsoid((44, -3, -4), (5, 17, 24)),
        Rod((46, 3, 10), (47, 4, 26), 4.5, 3.8),
        Rod((45, -14, 8), (45, -16, 25), 3.5, 2.2),
        Ellipsoid(CONDYLE, (9, 5, 6)),
    ),
]
SINUSES: list[Body] = both(
    Ellipsoid((21, -46, 36), (10, 15, 13)), Ellipsoid((9, -77, 84), (8, 3.5, 6))
)
NOSE: list[Body] = [
    Ellipsoid((0, -58, 32), (8, 30, 15)),
    *both(Rod((6.5, -103, 21), (6, -82, 27), 3.5, 4)),
]
THROAT: list[Body] = chained(
    [(0, -40, 30), (0, -12, 22), (0, -10, -90), (0, -10, -140)], [7, 7, 7, 7]
)
MOUTH: list[Body] = [Ellipsoid((0, -78, -7), (20, 34, 6)), Rod((0, -60, -8), (0, -12, -12), 5, 6)]


def fossae(gap: float) -> list[Body]:
    """The hollows over the condyles, `gap` mm above them, wider than they are, and open below.

    Without the rods the floor of the skull would stand around the rami below the condyles.
    """
    x, y, z = CONDYLE
    return both(
        Ellipsoid((x, y, z + 6 + gap - 9), (18, 14, 9)), Rod((45, -16, 20), (x, y, 20), 10, 10)
    )


def teeth(tip: float, root: float) -> list[Body]:
    """A row of teeth from their tips to their roots at heights in mm."""
    inward = 3.0 if root > tip else -3.0
    stands = [Rod((x, y, tip + inward), (x, y + 2, root), 3.0, 2.2) for x, y in ARCH]
    return both(*stands)
