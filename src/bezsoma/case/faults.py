# SPDX-License-Identifier: BSD-3-Clause
"""What is wrong in a case file, said with its place and the nearest right word."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, get_args

from pydantic import BaseModel, ValidationError

from bezsoma.case.lines import KeyPath, line_at
from bezsoma.case.schema import CaseFile

Table = type[BaseModel]

KINDS = {
    str: "a text",
    bool: "true or false",
    int: "a whole number",
    float: "a number",
    list: "a list",
    tuple: "a list",
    dict: "a table",
}
MOST_NAMES = 20
"""No message lists more names than these."""

WANTED = {
    "string_type": "a text in quotes",
    "float_type": "a number",
    "int_type": "a whole number",
    "int_from_float": "a whole number",
    "bool_type": "true or false",
    "list_type": "a list",
    "tuple_type": "a list",
    "dict_type": "a table",
    "model_type": "a table",
    "model_attributes_type": "a table",
    "finite_number": "a finite number",
}
LIMITS = {
    "greater_than_equal": "ge",
    "greater_than": "gt",
    "less_than_equal": "le",
    "less_than": "lt",
}
"""Complaints that a number is out of range, and what the schema calls the bound."""


@dataclass(frozen=True)
class Fault:
    """One thing that is wrong, and the path of keys to it."""

    path: KeyPath
    message: str


def report(name: str, lines: Mapping[KeyPath, int], found: list[Fault]) -> str:
    """The faults in the order of the file, one a line, each with its place.

    >>> print(report("a.toml", {("load", 1): 7}, [Fault(("load", 1, "vale"), "unknown key")]))
    a.toml: load.[1].vale: unknown key, line 7
    """
    known = dict(lines)
    located = sorted(((line_at(known, fault.path) or 0, fault) for fault in found), key=_line)
    return "\n".join(
        f"{name}: {place(fault.path)}: {fault.message}" + (f", line {line}" if line else "")
        for line, fault in located
    )


def place(path: KeyPath) -> str:
    """A path of keys as one word, entries of lists counted from 0 in brackets.

    >>> place(("support", 1, "on"))
    'support.[1].on'
    """
    return ".".join(f"[{part}]" if isinstance(part, int) else part for part in path)


def nearest(word: str, known: list[str]) -> str:
    """`(did you mean ...?)`, or all known words where none is near."""
    near = difflib.get_close_matches(word, known, n=1)
    some = [*known[:MOST_NAMES], *(["..."] if len(known) > MOST_NAMES else [])]
    return f"(did you mean {near[0]!r}?)" if near else f"(known here: {', '.join(some)})"


def faults(error: ValidationError, tables: dict[str, Any]) -> list[Fault]:
    """The faults that pydantic found, in our words; of a union only its first complaint."""
    found: dict[KeyPath, Fault] = {}
    for each in error.errors(include_url=False):
        trace = _traced(each["loc"], tables)
        found.setdefault(trace.path, Fault(trace.path, _message(dict(each), trace)))
    return list(found.values())


def _line(located: tuple[int, Fault]) -> int:
    return located[0]


def _message(error: dict[str, Any], trace: Trace) -> str:
    """One complaint of pydantic as a sentence for the person who wrote the file."""
    kind, given = error["type"], error["input"]
    key = str(trace.path[-1]) if trace.path else ""
    if kind == "extra_forbidden":
        return f"unknown key {nearest(key, _keys(trace.owners))}"
    if kind == "missing":
        return f"this key is missing{_meaning(key, trace.owners)}"
    if kind == "union_tag_not_found":
        return f"the key 'type' is missing {nearest('', _tags(trace.here))}"
    if kind == "union_tag_invalid":
        return f"unknown type {given['type']!r} {nearest(str(given['type']), _tags(trace.here))}"
    if kind in WANTED:
        return f"{WANTED[kind]} is needed here, not {given!r} ({KINDS.get(type(given), 'a date')})"
    if kind == "value_error":
        return str(error["ctx"]["error"])
    if kind in ("too_short", "string_too_short"):
        return f"at least one entry is needed here{_meaning(key, trace.owners)}"
    if kind == "string_pattern_mismatch":
        return f"{given!r} is no word: give a letter, then letters, digits, '-' and '_'"
    if kind in LIMITS:
        return f"{given!r} is out of range: {_range(trace)} can stand here"
    hint = _meant(given, error["ctx"]["expected"]) if kind == "literal_error" else ""
    return f"{given!r} cannot stand here: {error['msg'][0].lower()}{error['msg'][1:]}{hint}"


def _meant(given: Any, expected: str) -> str:
    """The nearest of the words in pydantic's list of those that can stand, if one is near.

    >>> _meant("neo-hook", "'linear', 'neo-hooke' or 'ogden'")
    " (did you mean 'neo-hooke'?)"
    """
    near = difflib.get_close_matches(str(given), re.findall("'([^']*)'", expected), n=1)
    return f" (did you mean {near[0]!r}?)" if near else ""


@dataclass
class Trace:
    """Where a complaint lies: its keys in the file, and the tables that the schema has there."""

    path: KeyPath = ()
    owners: list[Table] = field(default_factory=list)
    """The tables that the last key may belong to."""
    here: list[Table] = field(default_factory=lambda: [CaseFile])
    """The tables that may stand at the place itself."""


def _traced(location: tuple[int | str, ...], tables: Any) -> Trace:
    """Follow pydantic's location through the file.

    A location also names the branch taken in a union (its tag, or a type); those parts are no
    keys of the file and are left out.
    """
    trace, data = Trace(), tables
    for number, part in enumerate(location):
        tagged = [model for model in trace.here if part in _tags([model])]
        last = number == len(location) - 1
        if isinstance(data, dict) and (part in data or (last and not tagged)):
            data = data.get(str(part))
            trace = Trace((*trace.path, part), trace.here, _inside(trace.here, str(part)))
        elif isinstance(data, list) and isinstance(part, int):
            data = data[part] if part < len(data) else None
            trace.path = (*trace.path, part)
        elif tagged:
            trace.here = tagged
    return trace


def _models(annotation: Any) -> Iterator[Table]:
    """The tables that an annotation speaks of."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
        return
    for part in get_args(annotation):
        yield from _models(part)


def _inside(models: list[Table], key: str) -> list[Table]:
    """The tables below a key; below a name that the file chose (a region) they are the same."""
    fields = [model.model_fields[key] for model in models if key in model.model_fields]
    return [table for each in fields for table in _models(each.annotation)] or models


def _tags(models: list[Table]) -> list[str]:
    """The values of `type` by which the models are told apart."""
    fields = [model.model_fields["type"] for model in models if "type" in model.model_fields]
    return [tag for field in fields for tag in get_args(field.annotation)]


def _keys(models: list[Table]) -> list[str]:
    return sorted({key for model in models for key in model.model_fields})


def _range(trace: Trace) -> str:
    """The numbers that the schema allows at a place, both ends of them."""
    key = next(part for part in reversed(trace.path) if isinstance(part, str))
    fields = [model.model_fields[key] for model in trace.owners if key in model.model_fields]
    ends = dict(end for each in fields for end in _ends(each))
    if ends.keys() == {"ge", "le"}:
        return f"{ends['ge']} to {ends['le']}"
    words = {"ge": "from {} up", "gt": "above {}", "le": "up to {}", "lt": "below {}"}
    return "numbers " + " and ".join(words[end].format(ends[end]) for end in words if end in ends)


def _ends(part: Any) -> Iterator[tuple[str, Any]]:
    """The bounds that a part of an annotation, or any part of it, sets to a number."""
    for bound in LIMITS.values():
        if hasattr(part, bound):
            yield bound, getattr(part, bound)
    inner = (getattr(part, "annotation", None), *getattr(part, "metadata", ()), *get_args(part))
    for each in inner:
        if each is not None:
            yield from _ends(each)


def _meaning(key: str, models: list[Table]) -> str:
    """What a missing key is for."""
    fields = [model.model_fields[key] for model in models if key in model.model_fields]
    return f": {fields[0].description}" if fields and fields[0].description else ""
