# SPDX-License-Identifier: BSD-3-Clause
"""Tets of one domain by two ways: isosurface stuffing, and a surface net filled by fTetWild.

pytetwild[all] and psutil are no dependencies of BezSoma: install them beside it, then
./dev python benchmarks/meshers.py. Both ways are told the same sizes; each is run twice, in a
process of its own with a limit of time.
"""

from __future__ import annotations

import argparse
from typing import Any

from isolated import ran

WAYS = ("stuffing", "SurfaceNets and fTetWild")
HEAD = (
    "| way | tets | dihedral angles | mean ratio | skin, skull, mandible off, voxels | held at all "
    "corners | steps | s | MB | a re-run gives the same bits |\n" + "|---" * 10 + "|"
)


def row(way: str, first: dict[str, Any], again: dict[str, Any]) -> str:
    """A line of the table."""
    if "failed" in first:
        return f"| {way} | {first['failed']} | | | | | | | | |"
    same = "yes" if first["same"] == again.get("same") else "no"
    if "failed" in again:
        same = again["failed"]
    return (
        f"| {way} | {first['tets']:,} | {first['least']:.1f} to {first['largest']:.1f} | "
        f"{first['ratio']:.2f} | {', '.join(f'{x:.2f}' for x in first['off'])} | {first['held']} | "
        f"{first['steps']} | {first['seconds']:.1f} | {first['memory'] / 1e6:.0f} | {same} |"
    )


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tets", type=int, default=24_000)
    parser.add_argument("--voxel", type=float, default=2.0, help="mm, of the phantom")
    parser.add_argument("--model", default="", help="a model folder: its labels, not a phantom's")
    parser.add_argument("--degree", type=int, default=3)
    parser.add_argument("--longer", type=float, default=1.0, help="edges fTetWild is told, times")
    parser.add_argument("--limit", type=float, default=900.0, help="s for each process")
    parser.add_argument("--way", choices=WAYS, help="only this one")
    options = parser.parse_args()
    print(HEAD, flush=True)
    for way in [options.way] if options.way else WAYS:
        request = {**vars(options), "way": way}
        first, again = (ran("one_mesh.py", request, 1, options.limit) for _ in range(2))
        print(row(way, first, again), flush=True)


if __name__ == "__main__":
    main()
