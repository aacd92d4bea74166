# SPDX-License-Identifier: BSD-3-Clause
"""How much memory a solve will take, told before it is taken."""

from __future__ import annotations

import os
from dataclasses import dataclass
from functools import cached_property
from math import comb
from pathlib import Path

from bezsoma.control_groups import groups
from bezsoma.errors import InputError
from bezsoma.mechanics.body import Body
from bezsoma.mesh.tets import TetMesh
from bezsoma.solvers.gmres import KEPT


def estimate(
    mesh: TetMesh,
    degree: int,
    solver: str,
    pressure_degree: int | None = None,
    linear: bool = True,
) -> int:
    """The bytes that a solve will take besides the mesh: from counts, before anything is numbered.

    The solvers are those of `solve`, but "auto". The factors were measured (benchmarks/growth.py,
    tests/laws/test_memory.py): right within a factor of two. A refusal that saves a machine from
    swapping needs no more. What no count knows is the fill of a direct solver on a plate or a bar,
    which is less.

    At degree 3 a cube has more than three times the controls that it has at degree 2, yet without
    a matrix it takes less than twice the memory:

    >>> from bezsoma.mesh.solids import block
    >>> cube = block(cells=8)
    >>> Counts(cube, 3).controls > 3 * Counts(cube, 2).controls
    True
    >>> estimate(cube, 3, "multigrid") < 2 * estimate(cube, 2, "multigrid")
    True
    """
    net = Counts(mesh, degree)
    pressures = Counts(mesh, pressure_degree) if pressure_degree else None
    bytes_of_nets = net.numbering + (pressures.numbering if pressures else 0)
    if solver in ("direct", "cg"):
        return bytes_of_nets + _with_a_matrix(net, pressures, solver, linear)
    return bytes_of_nets + _without(net, pressures, linear)


@dataclass(frozen=True)
class Counts:
    """What a control net of some degree will have, known before it is numbered.

    Edges follow from Euler's formula; a tunnel, a cavity or a part more shifts them by a handful.

    >>> from bezsoma.mesh.control_net import ControlNet
    >>> from bezsoma.mesh.solids import block
    >>> mesh = block(cells=3)
    >>> all(Counts(mesh, n).controls == ControlNet(mesh, n).count for n in range(1, 11))
    True
    """

    mesh: TetMesh
    degree: int

    @property
    def entities(self) -> tuple[int, int, int, int]:
        """How many vertices, edges, faces and tets there are."""
        v, f, t = len(self.mesh.points), self.mesh.face_count, len(self.mesh.tets)
        return v, v + f - t - 1, f, t

    @property
    def inside(self) -> tuple[int, int, int, int]:
        """The controls inside one of each."""
        n = self.degree - 1
        return 1, n, comb(n, 2), comb(n, 3)

    @cached_property
    def controls(self) -> int:
        """The controls of all."""
        return sum(e * i for e, i in zip(self.entities, self.inside, strict=True))

    @property
    def numbering(self) -> int:
        """The bytes of the numbering: where controls begin, and the edges and faces of tets."""
        _, e, f, t = self.entities
        starts = sum(8 * e for e, i in zip(self.entities, self.inside, strict=True) if i)
        edges = (8 * e + 24 * t) if self.degree > 1 else 0
        faces = (12 * f + 16 * t) if self.degree > 2 else 0
        return starts + edges + faces + 8 * t

    @property
    def blocks(self) -> int:
        """About how many 3x3 blocks a matrix has: the controls of the tets around each control."""
        n = self.degree
        own = comb(n + 3, 3)
        face = 2 * own - comb(n + 2, 2)
        edge = 5 * (own - comb(n + 2, 2)) + n + 1
        vertex = 24 * (own - comb(n + 2, 2)) // 2 + 1
        meets = (max(vertex, 15), max(edge, 8), face, own)
        counts = zip(self.entities, self.inside, meets, strict=True)
        return sum(e * i * m for e, i, m in counts)

    @property
    def packed(self) -> int:
        """The bytes of the inverses of the entities' blocks, in float32, and their answers."""
        total = 0
        for entities, inside in zip(self.entities, self.inside, strict=True):
            rows = 3 * inside
            total += 4 * entities * (rows * (rows + 1) // 2 + 2 * rows)
        return total


def _with_a_matrix(net: Counts, pressures: Counts | None, solver: str, linear: bool) -> int:
    matrix, unknowns = 72 * net.blocks, 3 * net.controls
    if solver == "cg":
        return 2 * matrix + 400 * net.controls
    if pressures:
        matrix = matrix * 3 // 2
        unknowns += pressures.controls
    copies = 3 if linear else 8
    # The factors of a cube hold about c^(5/3) numbers in SuperLU's order, whatever the degree
    # (1000 to 36000 unknowns were measured); those of a bar or a plate fewer.
    return copies * matrix + 4_000_000 + int(22 * unknowns ** (5 / 3))


def _without(net: Counts, pressures: Counts | None, linear: bool) -> int:
    vertices, _, _, tets = net.entities
    of_tets = tets * (120 if net.degree == 1 else 400)
    packed = net.packed if net.degree > 1 else 0
    unknowns = 3 * net.controls + (pressures.controls if pressures else 0)
    vectors = 10
    if pressures:
        of_tets += 200 * tets
        vectors = 18 if linear else 2 * KEPT + 25
    elif not linear:
        of_tets += 300 * tets
        vectors = 34
    return of_tets + 8 * vectors * unknowns + packed + 1500 * vertices


def available() -> int | None:
    """The bytes that may be taken without swapping; None where the system does not say."""
    limits = [_kernel_says(), _groups_allow()]
    known = [limit for limit in limits if limit is not None]
    return min(known) if known else None


def refuse_what_does_not_fit(body: Body, solver: str, linear: bool = True) -> None:
    """Raise an InputError if a solver would need more memory than there is.

    "auto" counts as what it takes for large bodies: the factors of small ones take little in any
    case, and are not counted beforehand where iterations come first.
    """
    without = "saddle" if body.mixed and linear else "multigrid"
    chosen = without if solver == "auto" else solver
    needed = estimate(body.mesh, body.degree, chosen, body.pressure_degree, linear)
    there = available()
    if there is not None and needed > there:
        unknowns = 3 * Counts(body.mesh, body.degree).controls
        raise InputError(
            f"{unknowns} unknowns of degree {body.degree} by {chosen!r} take about "
            f"{size(needed)}, and {size(there)} are free; take a lower degree or a coarser mesh"
            + ("" if chosen == without else f", or solver={without!r}, which needs no matrix")
        )


def size(many: float) -> str:
    """So many bytes, to be read.

    >>> size(3.5 * 2**30), size(48_300_000), size(500_000)
    ('3.5 GiB', '48.3 MB', '0.5 MB')
    """
    return f"{many / 2**30:.1f} GiB" if many >= 2**30 else f"{many / 1e6:.4g} MB"


def _kernel_says() -> int | None:
    try:
        for line in Path("/proc/meminfo").read_text().splitlines():
            if line.startswith("MemAvailable:"):
                return int(line.split()[1]) * 1024
    except OSError:
        pass
    try:
        return os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    except (ValueError, OSError):
        return None


def _groups_allow() -> int | None:
    """The least that the control groups (of a container, of a batch job) leave of their limits."""
    left = [room for folder in groups("memory") if (room := _room(folder)) is not None]
    return min(left, default=None)


_FILES = (
    ("memory.max", "memory.current", "inactive_file"),
    ("memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file"),
)
"""Of version 2 and 1: the limit, what is used, and what of it are pages of files to be dropped."""


def _room(folder: Path) -> int | None:
    """What one group leaves of its limit; None where it has none."""
    for limit, used, dropped in _FILES:
        try:
            most, taken = int((folder / limit).read_text()), int((folder / used).read_text())
        except (OSError, ValueError):  # not there, or "max"
            continue
        return max(most - taken + _counted(folder / "memory.stat", dropped), 0)
    return None


def _counted(table: Path, name: str) -> int:
    try:
        rows = (line.split() for line in table.read_text().splitlines())
        return next((int(row[1]) for row in rows if row[0] == name), 0)
    except (OSError, ValueError, IndexError):
        return 0
