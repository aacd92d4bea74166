# SPDX-License-Identifier: BSD-3-Clause
"""Writes docs/verification/problems from what the problems give.

`PYTHONPATH=tests ./dev python -m verification.pages` runs all of them, about two minutes; names of
families after it, only those.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable, Sequence
from pathlib import Path

from verification.every import FAMILIES, PROBLEMS
from verification.pictures import PICTURES
from verification.problem import EQUAL, KINDS, Family, Problem, Value

ROOT = Path(__file__).resolve().parents[2]
BOOK = Path("docs/verification/problems")


def row(value: Value) -> str:
    """A line of a table."""
    sense = "" if value.sense == EQUAL else f"{value.sense} "
    cells = [
        value.where,
        value.of,
        f"{value.found:.6g}",
        f"{sense}{value.wanted:.6g}",
        f"{value.off:.1e}",
        f"{value.within:.1e}",
    ]
    return f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in cells)} |"


def section(problem: Problem, values: Iterable[Value]) -> str:
    """A problem: where it is from, its answer, a picture if there is one, what was found."""
    drawn = PICTURES.get(str(problem))
    lines = [
        f"## {problem.name}",
        "",
        f"- **Source** ({problem.kind}): {problem.source}",
        f"- **Answer**: `{problem.answer}`",
        f"- **Tolerance**: {problem.why}",
        "",
        *([f"![{drawn.about}](pictures/{drawn.file})", ""] if drawn else []),
        "| degree and mesh | what | found | wanted | off by | tolerance |",
        "|---|---|---|---|---|---|",
        *map(row, values),
    ]
    return "\n".join(lines)


def page(family: Family) -> str:
    """A family."""
    parts = [f"# Verification: {family.name.replace('_', ' ')}", family.about]
    parts += [section(problem, problem.values()) for problem in family]
    return "\n\n".join(parts) + "\n"


def contents() -> str:
    """The first page: how many of each kind."""
    head = ["| family | problems | analytical | published | laws | |", "|---|---|---|---|---|---|"]
    rows = [
        f"| [{family.name.replace('_', ' ')}]({family.name}.md) | {len(family)} | "
        + " | ".join(str(sum(p.kind == kind for p in family)) for kind in KINDS)
        + f" | {family.about} |"
        for family in FAMILIES
    ]
    kinds = [sum(p.kind == kind for p in PROBLEMS) for kind in KINDS]
    total = f"| **all** | {len(PROBLEMS)} | {' | '.join(map(str, kinds))} | |"
    about = "\n".join(f"- *{kind}*: {what}." for kind, what in KINDS.items())
    return (
        "\n\n".join(
            [
                "# The problems, one by one",
                "Each has its source, its answer, what is found by degree and mesh, and why the "
                "tolerance is what it is. `tests/verification` states them and tests every number; "
                "these pages are written from the same statements by\n\n"
                "```sh\nPYTHONPATH=tests ./dev python -m verification.pages\n```",
                about,
                "\n".join([*head, *rows, total]),
                "```{toctree}\n:hidden:\n:glob:\n\n*\n```",
            ]
        )
        + "\n"
    )


def main(chosen: Sequence[str]) -> None:
    """Write the pages and pictures of the families that are chosen, or of all."""
    folder = ROOT / BOOK
    (folder / "pictures").mkdir(parents=True, exist_ok=True)
    for family in (each for each in FAMILIES if each.name in chosen or not chosen):
        (folder / f"{family.name}.md").write_text(page(family), encoding="utf-8")
        for drawn in (PICTURES[str(each)] for each in family if str(each) in PICTURES):
            (folder / "pictures" / drawn.file).write_bytes(drawn.content())
    (folder / "index.md").write_text(contents(), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
