# SPDX-License-Identifier: BSD-3-Clause
"""On which line of a TOML text a key stands, since `tomllib` does not tell."""

from __future__ import annotations

import re
from collections import Counter

KeyPath = tuple[str | int, ...]

TOKEN = re.compile(
    r"""(?P<long>\"\"\"|''')|(?P<string>"(?:\\.|[^"\\\n])*"|'[^'\n]*')|(?P<comment>\#[^\n]*)"""
    r"""|(?P<bracket>[\[\]{}])"""
)
HEADER = re.compile(r"^\s*(\[\[?)\s*([^\[\]#]+?)\s*\]\]?\s*(?:#.*)?$")
KEY = re.compile(r"""^\s*((?:[A-Za-z0-9_-]+|"[^"]*"|'[^']*')(?:\s*\.\s*[\w"'-]+)*)\s*=""")


def lines_of(text: str) -> dict[KeyPath, int]:
    r"""Path of each table and key -> its line, counted from 1.

    Keys inside inline tables have no entry of their own: the line of the table is theirs.

    >>> lines_of('degree = 2\n[[load]]\ntype = "body"\n[[load]]\nvalue = [1,\n 2]')
    ... # doctest: +NORMALIZE_WHITESPACE
    {('degree',): 1, ('load', 0): 2, ('load', 0, 'type'): 3,
     ('load', 1): 4, ('load', 1, 'value'): 5}
    """
    found: dict[KeyPath, int] = {}
    counts: Counter[KeyPath] = Counter()
    table: KeyPath = ()
    depth, quote = 0, ""
    for number, line in enumerate(text.splitlines(), 1):
        if depth == 0 and not quote:
            if header := HEADER.match(line):
                table = _table(header, counts)
                found.setdefault(table, number)
                continue
            if key := KEY.match(line):
                found.setdefault((*table, *_parts(key[1])), number)
        depth, quote = _state(line, depth, quote)
    return found


def line_at(lines: dict[KeyPath, int], path: KeyPath) -> int | None:
    """The line of the longest beginning of `path` that has one."""
    for length in range(len(path), 0, -1):
        if path[:length] in lines:
            return lines[path[:length]]
    return None


def _table(header: re.Match[str], counts: Counter[KeyPath]) -> KeyPath:
    """The path of a [table] or the next [[table]]; tables in an array get its last number."""
    path: KeyPath = ()
    parts = _parts(header[2])
    for place, part in enumerate(parts):
        path = (*path, part)
        last = place == len(parts) - 1
        if last and header[1] == "[[":
            counts[path] += 1
        if counts[path]:
            path = (*path, counts[path] - 1)
    return path


def _parts(key: str) -> list[str]:
    """The words of a dotted key."""
    return [part.strip().strip("\"'") for part in key.split(".")]


def _state(line: str, depth: int, quote: str) -> tuple[int, str]:
    """How many brackets are open after a line, and the quote of a text that goes on."""
    place = 0
    while place < len(line):
        if quote:
            end = line.find(quote, place)
            if end < 0:
                return depth, quote
            place, quote = end + len(quote), ""
            continue
        token = TOKEN.search(line, place)
        if token is None:
            break
        place = token.end()
        if token["long"]:
            quote = token["long"]
        elif token["bracket"]:
            depth += 1 if token["bracket"] in "[{" else -1
    return depth, quote
