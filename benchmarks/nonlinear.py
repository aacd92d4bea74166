# SPDX-License-Identifier: BSD-3-Clause
"""Laws that are not linear beside NGSolve's Newton: python benchmarks/nonlinear.py.

A block clamped below is drawn out by 38 % in one step of the load, the paper's stiffening law with
A = 5 or neo-Hooke, on the same tets, by the same exactness of quadrature, to the same residual of
1e-10 of the internal forces. NGSolve starts as ours does without its predictor, from the linear
answer, and halves corrections that do not bring the residual down. Every configuration is tried
once; those within twice the best of their engine are repeated, interleaved, and the least time
counts. Assembly, numbering and set-up count; the mesh does not.
"""

from __future__ import annotations

import argparse
import tempfile
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import isolated
import one_nonlinear
import record

Run = dict[str, Any]
CONFIGURATIONS: dict[str, tuple[str, ...]] = {
    "linear": (),
    "stiffening": ("multigrid", "bddc", "pardiso"),
    "neo-Hooke": ("multigrid", "bddc", "sparsecholesky", "pardiso"),
}
"""NGSolve's, by law: the tangents of stiffening are not symmetric. The linear law is ours alone, to
compare the memory with."""
AGREE = 1e-6
"""How far reactions may be apart, relative to ours."""
HEAD = ["law", "degree", "unknowns", "threads", "engine", "together s", "processor s", "Newton"]
HEAD += ["linear", "residual", "memory MB", "times ours", "by processor", "reaction apart"]


def main() -> None:
    """Run and print."""
    options = _options()
    found: dict[str, Any] = {"surroundings": record.surroundings(), "rows": []}
    with tempfile.TemporaryDirectory() as folder:
        for unknowns in options.dofs:
            for law in options.laws:
                path = Path(folder) / f"{unknowns}.npz"
                one_nonlinear.tets(unknowns, options.degree).write(path)
                case = {"law": law, "degree": options.degree, "threads": options.threads}
                found["rows"].append(compared(case | {"tets": str(path)}, options))
                record.kept(options.name, found)
    about = found["surroundings"]
    text = f"{about['date']}; {about['machine']}; load {about['load']} at the start; "
    text += f"`{about['command']}`; {about['versions']}\n\n"
    lines = [_cells(run) for row in found["rows"] for run in row]
    record.stored(options.name, found, text + record.table(HEAD, lines))


def compared(case: Run, options: argparse.Namespace) -> list[Run]:
    """All configurations once, then the good ones again in turn; the least time of each."""
    ways = [
        {"engine": engine, "configuration": name}
        for engine, name in (
            ("bezsoma", "auto"),
            *(("ngsolve", name) for name in CONFIGURATIONS[case["law"]]),
        )
        if find_spec(engine) and name not in options.without
    ]
    kept: list[Run] = []
    for turn in range(options.repeats):
        for i, way in enumerate(ways):
            if turn and not _again(kept, i, options.long):
                continue
            run = isolated.ran("one_nonlinear.py", case | way, case["threads"], options.limit)
            run = way | {key: case[key] for key in ("law", "degree", "threads")} | run
            print(run, flush=True)
            if turn == 0:
                kept.append(run)
            elif "failed" not in run and run["seconds"] < kept[i]["seconds"]:
                kept[i] = run
    for run in kept:
        if "failed" not in run and "failed" not in kept[0]:
            run["slower"] = run["seconds"] / kept[0]["seconds"]
            run["dearer"] = run["processor"] / kept[0]["processor"]
            run["apart"] = abs(run["reaction"] / kept[0]["reaction"] - 1)
    return kept


def _again(kept: list[Run], i: int, long: float) -> bool:
    """Whether run i is worth repeating."""
    if "failed" in kept[i] or kept[i]["seconds"] > long:
        return False
    alike = [r for r in kept if r["engine"] == kept[i]["engine"] and "failed" not in r]
    return bool(kept[i]["seconds"] <= 2 * min(r["seconds"] for r in alike))


def _cells(run: Run) -> list[str]:
    named = f"{run['engine']} ({run['configuration']})"
    head = [run["law"], str(run["degree"])]
    if "failed" in run:
        return [*head, "", str(run["threads"]), named, run["failed"], *[""] * 8]
    marked = " (!)" if run.get("apart", 0) > AGREE else ""
    return [
        *head,
        str(run["unknowns"]),
        str(run["threads"]),
        named,
        f"{run['seconds']:.3g}",
        f"{run['processor']:.3g}",
        str(run["iterations"]),
        str(run["linear"]),
        f"{run['residual']:.1e}",
        f"{run['memory'] / 1e6:.0f}",
        f"{run['slower']:.1f}" if "slower" in run else "",
        f"{run['dearer']:.1f}" if "dearer" in run else "",
        f"{run['apart']:.0e}{marked}" if "apart" in run else "",
    ]


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--degree", type=int, default=2)
    parser.add_argument("--dofs", type=int, nargs="+", default=[47_000, 207_000])
    parser.add_argument("--laws", nargs="+", default=["stiffening", "neo-Hooke"])
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--without", nargs="*", default=[], help="configurations to leave out")
    parser.add_argument("--limit", type=float, default=900, help="seconds for one run")
    parser.add_argument("--long", type=float, default=10, help="longer runs are not repeated, s")
    parser.add_argument("--name", default="nonlinear", help="of the files in benchmarks/results")
    return parser.parse_args()


if __name__ == "__main__":
    main()
