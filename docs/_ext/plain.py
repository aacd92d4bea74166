# SPDX-License-Identifier: BSD-3-Clause
"""Docstrings here are plain text; this makes them safe for Sphinx, which reads markup.

A bar is an absolute value, a star a product, an underscore an index. What stands between backticks
is code, between stars *stressed*. An indented block is a formula, shown as it was laid out.
"""

from __future__ import annotations

import re
from typing import Any

from sphinx.application import Sphinx

KEPT = re.compile(r"(`+[^`]*`+|(?<![\w*])\*[A-Za-z][^*`]*[A-Za-z]\*(?![\w*]))")
MARK = re.compile(r"[|*\\]|_(?!\w)")
BULLET = re.compile(r"^(\s*[*-] )")


def literal(text: str) -> str:
    """A line with everything escaped that Sphinx would take for markup, outside backticks."""
    bullet = BULLET.match(text)
    start = bullet[1] if bullet else ""
    parts = KEPT.split(text[len(start) :])
    kept = [part + "\\ " if part else "" for part in parts[1::2]]
    free = [MARK.sub(r"\\\g<0>", part) for part in parts[::2]]
    return start + free[0] + "".join(k + f for k, f in zip(kept, free[1:], strict=True))


def indent(line: str) -> int:
    """How far a line is indented."""
    return len(line) - len(line.lstrip())


def prepared(lines: list[str]) -> list[str]:
    """The lines of a docstring, for Sphinx."""
    done: list[str] = []
    margin, mode = 0, "text"
    for line in lines:
        if not line.strip():
            mode = "text" if mode == "examples" else mode
            done.append(line)
            continue
        if mode == "formula" and indent(line) <= margin:
            mode = "text"
        if mode != "formula" and line.lstrip().startswith(">>>"):
            mode = "examples"
        if mode == "text" and begins_formula(line, done):
            margin, mode = indent(paragraph(done)), "formula"
            announce(done)
        done.append(literal(line) if mode == "text" else line)
    return done


def last(done: list[str]) -> int:
    """Where the last line with words is."""
    return max((number for number, line in enumerate(done) if line.strip()), default=-1)


def paragraph(done: list[str]) -> str:
    """The last line with words."""
    return done[last(done)] if last(done) >= 0 else ""


def begins_formula(line: str, done: list[str]) -> bool:
    """Whether a line is the first of a block that is indented under a paragraph."""
    before = paragraph(done)
    apart = bool(done) and not done[-1].strip()
    special = before.lstrip().startswith((":", "..")) or before.endswith("::")
    return apart and bool(before) and not special and indent(line) >= indent(before) + 4


def announce(done: list[str]) -> None:
    """Say that what follows is laid out: a second colon, or two on a line of their own."""
    if paragraph(done).endswith(":"):
        done[last(done)] += ":"
    else:
        done += [" " * indent(paragraph(done)) + "::", ""]


def process(app: Sphinx, what: str, name: str, obj: Any, options: Any, lines: list[str]) -> None:
    """Sphinx hands over the lines of each docstring, to be changed in place."""
    lines[:] = prepared(lines)


def setup(app: Sphinx) -> dict[str, bool]:
    """Listen to autodoc."""
    app.connect("autodoc-process-docstring", process, priority=900)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
