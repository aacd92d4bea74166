# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of problems whose shape or stress says more than a row of a table."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from io import BytesIO
from typing import Any

from PIL import Image

import bezsoma as bz
from bezsoma.arrays import Floats
from bezsoma.experiments.blocks import pulled
from cases.exact import ThickSphere
from cases.test_finite_motions import twisted
from cases.test_finite_problems import muscle_beam
from cases.test_incompressible import slab
from verification import beams, plates, regions, singular, spheres, stiffening, torsion

SIZE = (560, 460)


@dataclass(frozen=True)
class Picture:
    """A PNG beside a page: its name, what it shows, and how it is made."""

    file: str
    about: str
    content: Callable[[], bytes]


def moved(found: bz.Solution, **how: Any) -> bytes:
    """The deformed body with the edges of its mesh, coloured by the length of u unless told."""
    given = {"colour": found.displacement, "label": "displacement, mm", "wires": True, "size": SIZE}
    page = bz.picture(None, found.body.mesh, displacement=found.displacement, **(given | how))
    small = BytesIO()
    Image.open(BytesIO(page)).convert("RGB").quantize(256, dither=0).save(
        small, "PNG", optimize=True
    )
    return small.getvalue()


def stressed(found: bz.Solution, part: tuple[int, int], name: str, **how: Any) -> bytes:
    """The same coloured by a component of the stress, averaged between tets."""

    def component(values: Floats) -> Floats:
        return values[:, 3 * part[0] + part[1]]

    how = {"colour": found.stress.averaged(), "measure": component, "label": name} | how
    return moved(found, **how)


def cook() -> bytes:
    """Cook's membrane."""
    return moved(bz.solve(slab(3, pressure_degree=2), solver="direct"), view="top")


def muscle() -> bytes:
    """Land's beam."""
    _, found = muscle_beam(2, (20, 2, 2), "multigrid")
    return moved(found, before=True)


def twist() -> bytes:
    """A cube turned at its top."""
    found = twisted(5, bz.NeoHooke(1.0, 0.5), incompressible=True)
    return moved(found, before=True)


def le1() -> bytes:
    """The elliptic membrane."""
    found = bz.solve(plates.membrane(3, (6, 32, 1)))
    return stressed(found, (1, 1), "s_yy, MPa", magnified=1000, view="top")


def le10() -> bytes:
    """The thick plate."""
    found = bz.solve(plates.thick_plate(3, (6, 16, 2)))
    return stressed(found, (1, 1), "s_yy, MPa", magnified=1000, view="top")


def sphere() -> bytes:
    """An eighth of a thick sphere."""
    found = spheres.thick(ThickSphere(E=1.0, nu=0.3, p=1.0, a=1.0, b=1.5), 3)
    return moved(found, magnified=0.1)


def tube() -> bytes:
    """A quarter of a thick tube."""
    return moved(spheres.pressed_tube(spheres.Tube(1.5, 0.5), True, 3), magnified=0.1, view="top")


def hole() -> bytes:
    """A quarter of a plate about a hole."""
    return stressed(spheres.holed(4), (0, 0), "s_xx, MPa", magnified=0.1, view="top")


def warped() -> bytes:
    """A bar that is twisted, by how far its section warps."""
    found = torsion.twisted(torsion.slice_of_bar(2.0), 4, 0.5)
    return moved(found, measure=lambda u: u[:, 2], label="u_z, mm", magnified=0.5)


def cantilever() -> bytes:
    """A clamped beam."""
    load = bz.Traction("right", value=(0, 0, 0.001))
    found = bz.solve(beams.clamped_beam(5.0, load, 3), solver="direct")
    return stressed(found, (0, 0), "s_xx, MPa", magnified=2, before=True)


def notch() -> bytes:
    """An L, clamped at one end."""
    return stressed(bz.solve(singular.notched(8)), (0, 0), "s_xx, MPa", magnified=5, view="top")


def block(held: str, magnified: float) -> bytes:
    """The block of figure 6."""
    found = bz.solve(pulled(held, 4, 3, singular.LAW_6, 1.0), solver="direct")
    return moved(found, magnified=magnified)


def layers() -> bytes:
    """A beam of two layers; its stress jumps between them, so it is not averaged."""
    found = bz.solve(regions.layered_beam(20.0, 2), solver="direct")
    return stressed(found, (0, 0), "s_xx, MPa", colour=found.stress, magnified=50)


def stiffened() -> bytes:
    """A cube drawn out between walls."""
    law = bz.Stiffening(stiffening.E, stiffening.NU, stiffening.A)
    return moved(bz.solve(stiffening.between_walls(law, 2)), before=True)


PICTURES = {
    "incompressible: Cook's membrane at nu = 1/2, degree 3": Picture(
        "cook.png", "Cook's membrane at nu = 1/2, moved, coloured by displacement", cook
    ),
    "finite: Beam of heart muscle, pressed from below": Picture(
        "muscle.png", "A beam of heart muscle bends up under pressure from below", muscle
    ),
    "finite: Cube twisted by 60 degrees and pressed by a fifth, incompressible": Picture(
        "twisted.png", "A cube of six tets of degree 5, its top turned by 60 degrees", twist
    ),
    "plates: NAFEMS LE1: elliptic membrane": Picture(
        "le1.png", "NAFEMS LE1: s_yy on a quarter of the elliptic membrane", le1
    ),
    "plates: NAFEMS LE10: thick plate under pressure": Picture(
        "le10.png", "NAFEMS LE10: s_yy on a quarter of the thick plate, seen from above", le10
    ),
    "spheres: Thick sphere, b/a = 1.5, nu = 0.3": Picture(
        "sphere.png", "An eighth of a thick sphere blown up, coloured by displacement", sphere
    ),
    "spheres: Thick tube, b/a = 1.5, nu = 0.5, with a pressure": Picture(
        "tube.png", "A quarter of a thick tube blown up, coloured by displacement", tube
    ),
    "spheres: Hole in a plate that is drawn out (Kirsch)": Picture(
        "hole.png", "s_xx about a hole in a plate that is drawn out along x", hole
    ),
    "torsion: Rectangle, b/a = 2": Picture(
        "warped.png", "A slice of a rectangular bar, twisted, coloured by how it warps", warped
    ),
    "beams: Cantilever with a force at its end, l/h = 5": Picture(
        "cantilever.png", "A clamped beam bent by a force, coloured by s_xx", cantilever
    ),
    "singular: Notch of 90 degrees in plane strain": Picture(
        "notch.png", "An L whose stress s_xx grows without bound at the notch", notch
    ),
    "singular: Block under a point force, by degree": Picture(
        "point.png", "A block drawn out to a spike by a point force", partial(block, "points", 1.0)
    ),
    "singular: Block held and pulled on squares": Picture(
        "squares.png",
        "The same block, its force spread over a square",
        partial(block, "squares", 5.0),
    ),
    "regions: Beam of two layers, 1 : 20": Picture(
        "layers.png", "A beam of a soft and a stiff layer, coloured by s_xx, which jumps", layers
    ),
    "stiffening: Drawn between walls: Frobenius": Picture(
        "walls.png", "A cube drawn out between walls, over its edges as they were", stiffened
    ),
}
"""By the problem, as it calls itself."""
