# SPDX-License-Identifier: BSD-3-Clause
"""How much memory a solve will take, told before it is taken."""

from __future__ import annotations

import os
from math import comb
from pathlib import Path

from bezsoma.errors import InputError
from bezsoma.mesh.control_net import ControlNet


def estimate(net: ControlNet, solver: str) -> int:
    """The bytes that a solver will take for a net, besides the mesh and the net: from counts.

    The counts are exact, their factors were measured (benchmarks/growth.py): right within a
    factor of two. A refusal that saves a machine from swapping needs no more.

    A cube at degree 3 has some 30 controls more an edge entity than at degree 2, yet without a
    matrix it takes less than twice the memory:

    >>> from bezsoma.mesh.solids import block
    >>> two, three = (ControlNet(block(cells=8), n) for n in (2, 3))
    >>> three.count > 3 * two.count
    True
    >>> estimate(three, "multigrid") < 2 * estimate(two, "multigrid")
    True
    """
    n, mesh = net.degree, net.mesh
    if solver != "multigrid":
        matrix = 72 * _blocks(net)
        if solver == "cg":
            return 2 * matrix + 400 * net.count
        # The factors of a cube hold about c^(5/3) numbers in SuperLU's order, whatever the degree
        # (1000 to 36000 unknowns were measured); those of a bar or a plate fewer.
        return 3 * matrix + 4_000_000 + int(22 * (3 * net.count) ** (5 / 3))
    tets = len(mesh.tets) * (120 if n == 1 else 400)
    vectors = 10 * 24 * net.count
    packed = 0
    for dim, starts in enumerate(net.starts):
        rows = 3 * comb(n - 1, dim)
        packed += 4 * len(starts) * (rows * (rows + 1) // 2 + 2 * rows)
    return tets + vectors + packed + 1500 * len(mesh.points)


def available() -> int | None:
    """The bytes that may be taken without swapping; None where the system does not say."""
    limits = [_kernel_says(), _group_allows()]
    known = [limit for limit in limits if limit is not None]
    return min(known) if known else None


def refuse_what_does_not_fit(net: ControlNet, solver: str, without: str = "multigrid") -> None:
    """Raise an InputError if a solver would need more memory than there is.

    `without` names the one that needs no matrix. What laws that are not linear and a pressure take
    on top is not counted: a fraction of the rest.
    """
    needed, there = estimate(net, "multigrid" if solver == without else solver), available()
    if there is not None and needed > there:
        raise InputError(
            f"{3 * net.count} unknowns of degree {net.degree} by {solver!r} take about "
            f"{needed / 2**30:.1f} GiB, and {there / 2**30:.1f} GiB are free; take a lower degree "
            "or a coarser mesh"
            + ("" if solver == without else f", or solver={without!r}, which needs no matrix")
        )


def _blocks(net: ControlNet) -> int:
    """About how many 3x3 blocks a matrix has: the controls of the tets around each control."""
    n, mesh = net.degree, net.mesh
    inside = [comb(n - 1, dim) for dim in range(4)]
    own = comb(n + 3, 3)
    face = 2 * own - comb(n + 2, 2)
    edge = 5 * (own - comb(n + 2, 2)) + n + 1
    vertex = 24 * (own - comb(n + 2, 2)) // 2 + 1
    meets = (max(vertex, 15), max(edge, 8), face, own)
    entities = (len(mesh.points), len(mesh.all_edges), len(mesh.all_faces), len(mesh.tets))
    return sum(e * i * m for e, i, m in zip(entities, inside, meets, strict=True))


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


def _group_allows() -> int | None:
    """What a control group (a container) leaves of its limit."""
    group = Path("/sys/fs/cgroup")
    try:
        limit = (group / "memory.max").read_text().strip()
        used = int((group / "memory.current").read_text())
    except (OSError, ValueError):
        return None
    return None if limit == "max" else max(int(limit) - used, 0)
