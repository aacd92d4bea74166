# SPDX-License-Identifier: BSD-3-Clause
"""The verdicts on all deliberate errors, kept beside their tables, and the page that shows them."""

from __future__ import annotations

import datetime
import hashlib
import json
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

from mutants import table
from mutants.mutant import Mutant

VERDICTS = Path(__file__).with_name("verdicts.jsonl")
PAGE = Path(__file__).resolve().parents[2] / "docs" / "verification" / "deliberate_errors.md"


class Recorded(NamedTuple):
    """What was found about one error: the first test that noticed it, None if none did; when."""

    by: str | None
    date: str


def mark(mutant: Mutant) -> str:
    """What tells one error from another, and from itself with other texts or tests."""
    told = json.dumps([mutant.file, mutant.old, mutant.new, mutant.tests, mutant.compiled])
    return hashlib.sha256(told.encode()).hexdigest()[:16]


def verdicts() -> dict[str, Recorded]:
    """All that were recorded; of one error the last."""
    if not VERDICTS.exists():
        return {}
    lines = VERDICTS.read_text(encoding="utf-8").splitlines()
    return {entry["mark"]: Recorded(entry["by"], entry["date"]) for entry in map(json.loads, lines)}


def has(mutant: Mutant) -> bool:
    """Whether an error as it stands now has a verdict."""
    return mark(mutant) in verdicts()


def add(mutant: Mutant, by: str | None) -> None:
    """Record the verdict on one error, beside what other runs may record at the same time."""
    entry = {"mark": mark(mutant), "by": by, "date": datetime.date.today().isoformat()}
    with VERDICTS.open("a", encoding="utf-8") as lines:
        lines.write(json.dumps(entry) + "\n")


def tidy() -> None:
    """Keep one verdict an error, in the order of the table, and none of errors that are gone."""
    found = verdicts()
    known = [mark(m) for m in table.ALL if mark(m) in found]
    lines = [json.dumps({"mark": m, **found[m]._asdict()}) for m in known]
    VERDICTS.write_text("\n".join(lines) + "\n", encoding="utf-8")


def judged(mutants: Iterable[Mutant]) -> tuple[int, int]:
    """How many of these errors have a verdict, and how many of them some test noticed."""
    found = verdicts()
    known = [found[mark(m)] for m in mutants if mark(m) in found]
    return len(known), sum(entry.by is not None for entry in known)


def missed() -> list[Mutant]:
    """Those that no test noticed."""
    found = verdicts()
    return [m for m in table.ALL if mark(m) in found and found[mark(m)].by is None]


def page() -> str:
    """The page: the score, those that nothing notices with the reason, and all verdicts."""
    found = verdicts()
    dates = sorted({entry.date for entry in found.values()}) or ["never"]
    kinds = {"the C++ core": table.CPP, "Python": table.PYTHON, "all": table.ALL}
    argued = [f"- *{m.what}* (`{m.file}`): {m.argued}" for m in missed()] or ["None."]
    parts = [
        "# Deliberate errors",
        "Coverage says which lines the tests run, not whether they would notice that a line is "
        "wrong. So small, plausible errors are planted in the code one by one, and the tests that "
        "should notice run. This page is written from the verdicts by\n\n"
        "```sh\n./dev mutants --record          # all of them; hours\n"
        "./dev mutants --record --rest   # those that are new or changed\n```",
        f"Run from {dates[0]} to {dates[-1]}. The core is built for this with one set of kernels, "
        "up to degree 4, and with all its errors, of which one is chosen when it is loaded; a test "
        "that needs more is left out.",
        "| planted in | errors | with a verdict | noticed | score |\n|---|---|---|---|---|\n"
        + "\n".join(score(name, errors) for name, errors in kinds.items()),
        "## Those that no test notices\n\n" + "\n".join(argued),
    ]
    for name, errors in list(kinds.items())[:2]:
        parts.append(f"## In {name}\n\n{rows(errors, found)}")
    return "\n\n".join(parts) + "\n"


def score(name: str, errors: tuple[Mutant, ...]) -> str:
    """A line of the table of scores."""
    known, noticed = judged(errors)
    return f"| {name} | {len(errors)} | {known} | {noticed} | {noticed / max(known, 1):.1%} |"


def rows(errors: tuple[Mutant, ...], found: dict[str, Recorded]) -> str:
    """A line for each error, file by file."""
    lines = ["| file | error | first noticed by |", "|---|---|---|"]
    for m in sorted(errors, key=lambda m: m.file):
        entry = found.get(mark(m))
        by = "not run yet"
        if entry:
            by = f"`{entry.by.removeprefix('tests/')}`" if entry.by else "**nothing**"
        file = m.file.removeprefix("src/bezsoma/").removeprefix("src/")
        lines.append(f"| `{file}` | {m.what} | {by.replace('|', '/')} |")
    return "\n".join(lines)


def write_page() -> None:
    """Write docs/verification/deliberate_errors.md."""
    tidy()
    PAGE.write_text(page(), encoding="utf-8")


if __name__ == "__main__":
    write_page()
