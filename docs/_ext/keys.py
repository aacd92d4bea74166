# SPDX-License-Identifier: BSD-3-Clause
"""The keys of a case file, read from its schema, as a page."""

from __future__ import annotations

import ast
import inspect
import json
from itertools import pairwise
from typing import Any

from bezsoma.case import schema

TITLE = """# Keys of the case file

Read from the schema that case files are checked with: every table, its keys, what may stand there,
and what holds where nothing does. [The case file](../../case_file.md) explains them, with examples.
"""
KINDS = {
    "string": "text",
    "integer": "whole number",
    "number": "number",
    "boolean": "true or false",
}
BOUNDS = {
    "minimum": "from {}",
    "maximum": "to {}",
    "exclusiveMinimum": "above {}",
    "exclusiveMaximum": "below {}",
}


def page() -> str:
    """The whole page."""
    whole = schema.CaseFile.model_json_schema()
    tables = {"CaseFile": whole, **whole["$defs"]}
    ordered = sorted(tables, key=lambda name: place(name, whole))
    told = [section(name, heading(name, whole), tables[name]) for name in ordered]
    return "\n".join([TITLE, *told])


def place(name: str, whole: dict[str, Any]) -> int:
    """Where a table stands in a case file; the head of the file is first."""
    specs = list(whole["properties"].values())
    return next((i for i, spec in enumerate(specs) if names_table(spec, name)), -1)


def names_table(spec: dict[str, Any], name: str) -> bool:
    """Whether a key holds this table."""
    return f'"#/$defs/{name}"' in json.dumps(spec)


def heading(name: str, whole: dict[str, Any]) -> str:
    """How a table is written in a case: `[mesh]`, `[[support]]`."""
    for key, spec in whole["properties"].items():
        if names_table(spec, name):
            return f"[[{key}]]" if spec.get("type") == "array" else f"[{key}{under(spec)}]"
    return "The head of the file"


def under(spec: dict[str, Any]) -> str:
    """What follows the name of a table of tables."""
    return ".NAME" if "additionalProperties" in spec else ""


def section(name: str, heading: str, table: dict[str, Any]) -> str:
    """One table of the file."""
    kind = table["properties"].get("type", {}).get("const")
    title = f"{heading}, type {kind}" if kind else heading
    said, needed = docstrings(name), table.get("required", [])
    rows = [
        f"| `{key}` | {allowed(spec)} | {otherwise(key, spec, needed)} | "
        f"{cell(spec.get('description') or said.get(key, ''))} |"
        for key, spec in table["properties"].items()
    ]
    about = "" if name == "CaseFile" else table.get("description", "")
    head = ["| key | may be | else | what it says |", "|---|---|---|---|"]
    return "\n".join([f"## {title}", "", cell(about), "", *head, *rows, ""])


def docstrings(name: str) -> dict[str, str]:
    """What stands below the fields of a class of the schema."""
    table = ast.parse(inspect.getsource(getattr(schema, name))).body[0]
    return {
        field.target.id: inspect.cleandoc(text.value.value).replace("\n", " ")
        for field, text in pairwise(table.body)
        if isinstance(field, ast.AnnAssign)
        and isinstance(text, ast.Expr)
        and isinstance(text.value, ast.Constant)
    }


def allowed(spec: dict[str, Any]) -> str:
    """What may stand at a key."""
    if "$ref" in spec:
        return "a table"
    if "const" in spec:
        return f'`"{spec["const"]}"`'
    if "enum" in spec:
        return ", ".join(f'`"{each}"`' for each in spec["enum"])
    options = spec.get("anyOf") or spec.get("oneOf")
    if options:
        told = [allowed(each) for each in options if each.get("type") != "null"]
        return " or ".join(dict.fromkeys(told))
    return listed(spec) if spec.get("type") in ("array", "object") else plain(spec)


def plain(spec: dict[str, Any]) -> str:
    """A text, a number, a truth value, with its bounds."""
    bounds = [words.format(spec[key]) for key, words in BOUNDS.items() if key in spec]
    return " ".join([KINDS.get(spec.get("type", ""), "see the right"), *bounds])


def listed(spec: dict[str, Any]) -> str:
    """A list, or a table of names."""
    if spec["type"] == "object":
        inside = spec.get("additionalProperties")
        return f"names = {allowed(inside)}" if isinstance(inside, dict) and inside else "a table"
    if "prefixItems" in spec:
        return f"{spec['minItems']} of: {allowed(spec['prefixItems'][0])}"
    return f"a list of: {allowed(spec.get('items', {}))}"


def otherwise(key: str, spec: dict[str, Any], needed: list[str]) -> str:
    """What holds where a key is left out."""
    if key in needed:
        return "**needed**"
    default = spec.get("default")
    if default in (None, "", [], {}) or isinstance(default, dict):
        return ""
    return f"`{json.dumps(default)}`"


def cell(text: str) -> str:
    """A text that can stand in a table."""
    return text.replace("|", "\\|").replace("[", "\\[")
