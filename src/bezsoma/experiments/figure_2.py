# SPDX-License-Identifier: BSD-3-Clause
"""Figure 2: a general elastic body, held on a part of its surface and loaded on another."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np

import bezsoma as bz
from bezsoma import bernstein
from bezsoma.arrays import Floats
from bezsoma.equations.forces import forces
from bezsoma.experiments.report import Picture, Report, Table, Tables
from bezsoma.mesh.control_net import ControlNet

RADIUS, PULL = 10.0, 0.002
SHIFT = (0.5, 0.0, 0.2)


@dataclass(frozen=True)
class Row:
    """A statement of the principle, the two numbers that it says are equal, and what is left."""

    statement: str
    one: float
    other: float
    apart: float


@cache
def solution() -> bz.Solution:
    """A ball of tissue, a cap of it moved, a cap beside it pulled."""
    mesh = bz.ball(radius=RADIUS, cells=4)
    mesh = mesh.with_surface("held", lambda x: x[:, 2] < -0.5 * RADIUS)
    mesh = mesh.with_surface("pulled", lambda x: x[:, 0] > 0.5 * RADIUS)
    held = [bz.Moved("held", translation=SHIFT)]
    load = [bz.Traction("pulled", value=(PULL, 0, PULL))]
    body = bz.Body(mesh, 3, bz.LinearElastic(E=0.015, nu=0.45), held, load)
    return bz.solve(body, solver="direct")


def measured(quick: bool = False) -> Tables:
    """What has to hold of any such body."""
    found = solution()
    net, u = found.net, found.displacement.controls
    load = forces(found.body, net)
    push = found.reactions["held"].force
    given = np.abs(u[net.of_place("held")] - SHIFT).max()
    work = float((load * u).sum() + push @ np.array(SHIFT))
    total = float(np.linalg.norm(load.sum(axis=0)))
    left = float(np.linalg.norm(load.sum(axis=0) + push))
    rows = [
        Row(
            "largest |u - u_given| on S_u, mm, beside |u_given|",
            float(given),
            float(np.linalg.norm(SHIFT)),
            float(given),
        ),
        Row("the loads, N, and the reactions to them", total, float(np.linalg.norm(push)), left),
        Row(
            "twice the energy, N mm, and the work of all forces",
            2 * found.energy,
            work,
            abs(2 * found.energy - work),
        ),
        *virtual(found, load),
    ]
    return {
        "virtual_work": Table(
            "What the principle of virtual displacements says.",
            rows,
            ("statement",),
            {"one": 1e-6, "other": 1e-6},
        )
    }


def virtual(found: bz.Solution, load: Floats) -> list[Row]:
    """Internal and external work on polynomials v that vanish where the body is held."""
    rows, net = [], found.net
    for name, function in VIRTUAL.items():
        v = bz.Field.interpolating(ControlNet(net.mesh, net.degree), function)
        controls = v.controls.copy()
        controls[net.of_place("held")] = 0.0
        outside = float((load * controls).sum())
        inside = internal(found, bz.Field(net, controls))
        rows.append(
            Row(
                f"virtual work of v = {name}, N mm, inside and outside",
                inside,
                outside,
                abs(inside - outside),
            )
        )
    return rows


VIRTUAL: dict[str, Callable[[Floats], Floats]] = {
    "(z, 0, 0)": lambda x: np.stack([x[:, 2], 0 * x[:, 0], 0 * x[:, 0]], axis=1),
    "(x y, y z, z x)": lambda x: x * np.roll(x, -1, axis=1),
}


def internal(found: bz.Solution, v: bz.Field) -> float:
    """int tau : grad v, exactly: both are polynomials of degree n - 1."""
    mesh = found.body.mesh
    bary, weights = bernstein.simplex(2 * found.net.degree - 2, 3)
    product = found.stress.tabulated(bary) * v.gradient_field().tabulated(bary)
    return float(mesh.volumes @ (product.sum(axis=(-1, -2)) @ weights))


def finding(tables: Tables) -> str:
    """What is found."""
    worst = max(row.apart / abs(row.other) for row in tables["virtual_work"].rows)
    return (
        "Such a body of degree 3. What was prescribed is met, forces and reactions balance, and "
        f"internal and external virtual work agree, all to {worst:.0e} of their size."
    )


def told(tables: Tables) -> Report:
    """The page."""
    found = solution()
    about = "A ball of tissue: its lower cap is moved and held, its side is pulled; colours are mm."
    picture = bz.picture(
        None, found.body.mesh, found.displacement, displacement=found.displacement,
        label="displacement, mm", size=(800, 720), wires=True,
    )  # fmt: skip
    return Report(
        "Figure 2: a general elastic body",
        "A body in a fixed frame, supported on a part of its surface with prescribed "
        "displacements and subjected to forces, which together yield a displacement field.",
        finding(tables),
        "They do not. The paper writes only a force on the volume; surgery and tests need "
        "tractions on surfaces and point forces beside it, which is how this body is loaded.",
        tables,
        {"body": Picture(picture, about)},
    )
