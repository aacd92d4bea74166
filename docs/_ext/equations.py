# SPDX-License-Identifier: BSD-3-Clause
"""The paper's equations lead to the code that realises them, and the code leads back.

Both are read from docs/map.md, which tests hold to the sources: the page of the equations gets
what the map says of each, the map's names become links, and a docstring that speaks of an equation
links to it.
"""

from __future__ import annotations

import re
import sys
from typing import Any

from page import ROOT
from sphinx.application import Sphinx

sys.path.insert(0, str(ROOT / "tests"))

from house import map as paper

PAGE, MAP = "theory/equations", "map"
HEADING = re.compile(r"^### Eq\. (\d+)$", re.MULTILINE)
PACKAGE = ROOT / "src" / "bezsoma"


def show(app: Sphinx, name: str, source: list[str]) -> None:
    """Put the links into the two pages."""
    if name == PAGE:
        source[0] = with_code(source[0])
    if name == MAP:
        source[0] = with_links(source[0])


def with_code(text: str) -> str:
    """The page of the equations, below each what realises it."""
    of = {row.number: row for row in paper.rows(ROOT)}
    before, *parts = HEADING.split(text)
    told = [before]
    for number, body in zip(parts[::2], parts[1::2], strict=True):
        row = of[int(number)]
        formula, after = split_at_next_section(body)
        code = ", ".join(link(each) for each in row.code)
        tests = ", ".join(link(each) for each in row.tests)
        heading = f"(eq-{number})=\n### Eq. {number}"
        told.append(f"{heading}{formula}\n*Code*: {code}. *Tests*: {tests}.\n\n{after}")
    return "".join(told)


def split_at_next_section(body: str) -> tuple[str, str]:
    """What belongs to an equation, and the heading of the next section where one follows."""
    at = body.find("\n## ")
    return (body, "") if at < 0 else (body[:at], body[at + 1 :])


def link(to: paper.Reference) -> str:
    """A file and a name in it, as a link where the reference has it."""
    shown = f"{to.name or to.file.name}"
    if to.file.suffix != ".py" or PACKAGE not in to.file.parents:
        place = to.file.relative_to(ROOT)
        return f"`{place}{':' if to.name else ''}{to.name}`"
    module = ".".join(("bezsoma", *to.file.relative_to(PACKAGE).with_suffix("").parts))
    role, whole = ("py:obj", f"{module}.{to.name}") if to.name else ("py:mod", module)
    return f"{{{role}}}`{shown} <{whole}>`"


def with_links(text: str) -> str:
    """The map, its numbers and its names as links."""
    head, table = text.split("## Equations")
    table = re.sub(r"^\| (\d+) \|", r"| [\1](#eq-\1) |", table, flags=re.MULTILINE)
    found = paper.REFERENCE.sub(lambda m: link(paper.references(m[0], ROOT)[0]), table)
    return f"{head}## Equations{found}"


def back(app: Sphinx, what: str, name: str, obj: Any, options: Any, lines: list[str]) -> None:
    """The numbers of equations in a docstring, as links; what is laid out stays as it is."""
    lines[:] = [each if each[:4].isspace() else paper.MENTION.sub(linked, each) for each in lines]


def linked(mention: re.Match[str]) -> str:
    """`eqs. 22 and 23`, each number a link."""
    numbers = re.sub(r"\d+", r"\\ :ref:`\g<0> <eq-\g<0>>`\\ ", mention[1])
    return mention[0].replace(mention[1], numbers)


def setup(app: Sphinx) -> dict[str, bool]:
    """Listen to what is read."""
    app.connect("source-read", show)
    app.connect("autodoc-process-docstring", back, priority=950)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
