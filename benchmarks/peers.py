# SPDX-License-Identifier: BSD-3-Clause
"""Ours beside what can be installed from PyPI: python benchmarks/peers.py.

Same tets, supports and load, nu = 0.3, same relative residual (the Euclidean norm of the residual
over the free unknowns of the engine's own basis, relative to that at zero free displacement, formed
anew after each solve; tolerances are tightened until it holds). Each run has a process of its own,
with a warm-up. Every configuration is tried once; the best of each engine is repeated, engines
interleaved, and the least time of the repeats counts. Ratios are those times over ours.

Needs `pip install "bezsoma[bench]"`; an engine that is not installed is left out and said so.
"""

from __future__ import annotations

import argparse
import tempfile
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import isolated
import plots
import problem
import record
from engines import NAMES

Run = dict[str, Any]
AGREE = 1e-8
"""How far energies may be apart, relative to ours."""
CONFIGURED = "configured.py"


def main() -> None:
    """Run and print."""
    options = _options()
    engines = [name for name in options.engines if find_spec(name)]
    found: dict[str, Any] = {"surroundings": record.surroundings(), "rows": []}
    found["missing"] = sorted(set(options.engines) - set(engines))
    with tempfile.TemporaryDirectory() as folder:
        for unknowns in options.dofs:
            for degree in options.degrees:
                tets = Path(folder) / f"{degree}-{unknowns}.npz"
                problem.tets(unknowns, degree).write(tets)
                ways = {engine: configurations(engine, degree, unknowns) for engine in engines}
                for threads in options.threads:
                    case = {"degree": degree, "threads": threads, "tets": str(tets)}
                    row = compared(case, ways, options) | {"size": unknowns}
                    ways = {engine: promising(runs) for engine, runs in row["tried"].items()}
                    found["rows"].append(row)
                    print("\n".join(lines(row)), flush=True)
                    record.kept(options.name, found)
                tets.unlink()
    record.stored(options.name, found, report(found))
    before = (row for name in options.beside for row in record.read(name)["rows"])
    plots.peers(ratios(newest([*before, *found["rows"]])), options.plot)


def configurations(engine: str, degree: int, unknowns: int) -> list[str]:
    """What that engine has for this problem."""
    asked = {"engine": engine, "degree": degree, "unknowns": unknowns}
    return list(isolated.ran(CONFIGURED, asked, 1).get("ways", []))


def promising(runs: list[Run]) -> list[str]:
    """The configurations that may be best with more threads: within twice the best time."""
    done = [run for run in runs if "failed" not in run]
    least = min((run["together"] for run in done), default=0.0)
    return [run["configuration"] for run in done if run["together"] <= 2 * least]


def compared(case: Run, ways: dict[str, list[str]], options: argparse.Namespace) -> Run:
    """All engines on one problem: every configuration once, then the best ones in turn."""
    start: Run = {"tolerance": problem.RTOL}
    tried = {
        engine: [_run(case, engine, start | {"configuration": way}, options.limit) for way in ways]
        for engine, ways in ways.items()
    }
    best = {}
    for engine, ways in tried.items():
        done = [run for run in ways if "failed" not in run]
        if done:
            best[engine] = min(done, key=lambda run: run["together"])
    runs: dict[str, list[Run]] = {engine: [] for engine in best}
    for _ in range(options.repeats):
        for engine, run in best.items():
            seconds = run["together"]
            if runs[engine] and seconds > options.long:
                continue  # noise does not matter there, patience does
            runs[engine].append(_run(case, engine, run, options.limit))
    kept = {engine: _least(best[engine], runs[engine]) for engine in best}
    first = kept.get("bezsoma")
    for run in kept.values():
        run["slower"] = run["together"] / first["together"] if first else None
        run["slower_processor"] = run["processor"] / first["processor"] if first else None
        run["energy_off"] = abs(run["energy"] / first["energy"] - 1) if first else None
    left = {key: case[key] for key in ("degree", "threads")}
    return left | {"unknowns": _unknowns(kept), "kept": kept, "tried": tried}


def _run(case: Run, engine: str, run: Run, limit: float) -> Run:
    asked = {"engine": engine, "configuration": run["configuration"]}
    request = case | asked | {"tolerance": run["tolerance"]}
    return asked | isolated.ran("one_solve.py", request, case["threads"], limit)


def _least(first: Run, runs: list[Run]) -> Run:
    """The quickest of the repeats, with all their times."""
    done = [run for run in runs if "failed" not in run] or [first]
    best = min(done, key=lambda run: run["together"])
    quickest = min(run["processor"] for run in done)
    return best | {"times": [run["together"] for run in done], "processor": quickest}


def _unknowns(kept: dict[str, Run]) -> int:
    return next((run["unknowns"] for run in kept.values()), 0)


HEAD = [
    "degree",
    "unknowns",
    "threads",
    "engine",
    "set-up s",
    "solve s",
    "together s",
    "processor s",
    "iterations",
    "residual",
    "memory MB",
    "times ours",
    "energy apart",
]


def lines(row: Run) -> list[str]:
    """The rows of the table for one problem."""
    return ["| " + " | ".join(_cells(row, run)) + " |" for run in row["kept"].values()]


def _cells(row: Run, run: Run) -> list[str]:
    apart = run["energy_off"]
    return [
        str(row["degree"]),
        str(run["unknowns"]),
        str(row["threads"]),
        f"{run['engine']} ({run['configuration']})",
        f"{run['setting_up']:.3g}",
        f"{run['solving']:.3g}",
        f"{run['together']:.3g}",
        f"{run['processor']:.3g}",
        str(run["iterations"]),
        f"{run['residual']:.1e}",
        f"{(run['bytes_peak'] - run['bytes_meshed']) / 1e6:.0f}",
        "" if run["slower"] is None else f"{run['slower']:.1f}",
        "" if apart is None else f"{apart:.0e}" + ("" if apart <= AGREE else " (!)"),
    ]


def best_peer(row: Run) -> Run | None:
    """The quickest that is not ours."""
    others = [run for engine, run in row["kept"].items() if engine != "bezsoma"]
    return min(others, key=lambda run: run["together"], default=None)


def ratios(rows: list[Run]) -> list[Run]:
    """What the picture shows: how many times longer the best peer took, where there is one."""
    beside = ((row, best_peer(row)) for row in rows if row["kept"].get("bezsoma"))
    return [row | {"ratio": peer["slower"]} for row, peer in beside if peer]


def newest(rows: list[Run]) -> list[Run]:
    """The last row of each problem."""
    return list({(row["size"], row["threads"], row["degree"]): row for row in rows}.values())


def report(found: Run) -> str:
    """Markdown: the summary by degree, then all that was kept, then what was tried."""
    about = found["surroundings"]
    rows = found["rows"]
    short = []
    for row in rows:
        other, ours = best_peer(row), row["kept"].get("bezsoma")
        if other and ours:
            short.append(
                [
                    str(row["degree"]),
                    str(row["unknowns"]),
                    str(row["threads"]),
                    f"{ours['together']:.3g}",
                    f"{other['together']:.3g}",
                    f"{other['engine']} ({other['configuration']})",
                    f"{other['slower']:.1f}",
                    f"{other['slower_processor']:.1f}",
                ]
            )
    head = ["degree", "unknowns", "threads", "ours s", "best peer s", "which", "ratio"]
    head.append("ratio of processor time")
    tried = [
        f"- degree {row['degree']}, {row['unknowns']} unknowns, {row['threads']} threads: "
        + "; ".join(
            f"{run['engine']} {run['configuration']} "
            + (f"failed ({run['failed']})" if "failed" in run else f"{run['together']:.3g} s")
            for runs in row["tried"].values()
            for run in runs
        )
        for row in rows
    ]
    missing = f"Not installed: {', '.join(found['missing'])}.\n\n" if found["missing"] else ""
    return (
        f"{about['date']}; {about['machine']}; load {about['load']} at the start; "
        f"`{about['command']}`; {about['versions']}\n\n{missing}"
        + record.table(head, short)
        + "\n\n"
        + "\n".join([record.table(HEAD, []), *(line for row in rows for line in lines(row))])
        + "\n\nTried once each:\n\n"
        + "\n".join(tried)
    )


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--degrees", type=int, nargs="+", default=problem.DEGREES)
    parser.add_argument("--dofs", type=int, nargs="+", default=[50_000, 350_000])
    parser.add_argument("--threads", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--engines", nargs="+", default=NAMES, choices=NAMES)
    parser.add_argument("--limit", type=float, default=900, help="seconds for one run")
    parser.add_argument("--long", type=float, default=10, help="longer runs are not repeated, s")
    parser.add_argument("--name", default="peers", help="of the files in benchmarks/results")
    parser.add_argument("--plot", default="", help="where to draw")
    parser.add_argument("--beside", nargs="+", default=[], help="results that are drawn, too")
    return parser.parse_args()


if __name__ == "__main__":
    main()
