# SPDX-License-Identifier: BSD-3-Clause
"""What an experiment hands out: tables of numbers, pictures, and a page about them."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field, fields
from typing import Any, get_type_hints

from bezsoma.errors import InputError


@dataclass(frozen=True, eq=False)
class Table:
    """Rows that were measured, dataclasses of one kind.

    `known_by` are the columns that say which row it is; `held` says of other columns how far a
    second run may be off, relative to the size of the number (times, say, are held to nothing).
    """

    about: str
    rows: Sequence[Any]
    known_by: tuple[str, ...]
    held: Mapping[str, float] = field(default_factory=dict)

    def row(self, **known: Any) -> Any:
        """The one row with these entries.

        >>> @dataclass
        ... class Row:
        ...     degree: int
        ...     found: float
        >>> Table("a square", [Row(1, 1.0), Row(2, 4.0)], ("degree",)).row(degree=2).found
        4.0
        """
        fit = list(self.where(**known))
        if len(fit) != 1:
            raise InputError(f"{len(fit)} rows of the table {self.about!r} have {known}; not one")
        return fit[0]

    def where(self, **known: Any) -> Iterator[Any]:
        """The rows with these entries, in their order."""
        return (r for r in self.rows if all(getattr(r, k) == v for k, v in known.items()))

    def key(self, row: Mapping[str, Any]) -> tuple[str, ...]:
        """What a row, as a dictionary or from a CSV file, is known by."""
        return tuple(str(row[column]) for column in self.known_by)

    @property
    def columns(self) -> list[str]:
        """The names of the columns."""
        return [each.name for each in fields(self.rows[0])]

    def as_csv(self) -> str:
        """The rows as CSV; numbers in full."""
        stream = io.StringIO()
        writer = csv.DictWriter(stream, self.columns, lineterminator="\n")
        writer.writeheader()
        writer.writerows(asdict(row) for row in self.rows)
        return stream.getvalue()

    def as_markdown(self) -> str:
        """The rows for a page; numbers to four digits."""
        head = heads(type(self.rows[0]))
        lines = [head, ["---"] * len(head)]
        lines += [[shown(value) for value in asdict(row).values()] for row in self.rows]
        return "\n".join(f"| {' | '.join(line)} |" for line in lines)


Tables = Mapping[str, Table]


@dataclass(frozen=True, eq=False)
class Picture:
    """A PNG, and what it shows."""

    content: bytes
    about: str


@dataclass(frozen=True, eq=False)
class Report:
    """One experiment as a page: what the paper said, what is found, why they differ."""

    title: str
    said: str
    found: str
    why: str
    tables: Tables
    pictures: Mapping[str, Picture]

    def page(self, name: str) -> str:
        """The page in Markdown; tables and pictures stand beside it as files."""
        parts = [
            f"# {self.title}",
            f"`bezsoma experiment {name}` writes this page, its pictures and its numbers.",
            "## What the paper says",
            self.said,
            "## What is found",
            self.found,
            *(
                f"![{each.about}]({file}.png)\n\n*{each.about}*"
                for file, each in self.pictures.items()
            ),
            "## Why they differ",
            self.why,
            "## The numbers",
            *(
                f"{each.about} (`{file}.csv` has all digits.)\n\n{each.as_markdown()}"
                for file, each in self.tables.items()
            ),
        ]
        return "\n\n".join(part.strip() for part in parts) + "\n"


def heads(row: type) -> list[str]:
    """The heads of a table: what a field is annotated with, else its name.

    >>> from bezsoma.experiments.figure_8 import Row
    >>> heads(Row)[:3]
    ['support', 'law', 'force, N']
    """
    hints = get_type_hints(row, include_extras=True)
    named = {name: getattr(hint, "__metadata__", (name,))[0] for name, hint in hints.items()}
    return [str(head).replace("_", " ") for head in named.values()]


def shown(value: Any) -> str:
    """A number as a page has it.

    >>> [shown(x) for x in (3, 0.123456, 1234567, "mixed", True, float("nan"))]
    ['3', '0.1235', '1,234,567', 'mixed', 'yes', '']
    """
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int):
        return f"{value:,}"
    if value != value:
        return ""
    return f"{value:.4g}" if isinstance(value, float) else str(value).replace("|", "\\|")
