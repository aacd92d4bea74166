# SPDX-License-Identifier: BSD-3-Clause
"""What the pages say of case files is so: every key is described, every example runs."""

from __future__ import annotations

import re
from pathlib import Path
from typing import get_args

import pytest

import bezsoma as bz
from bezsoma.case import schema
from bezsoma.case.quantities import AXES, ENTRIES, TENSORS, WHOLE
from bezsoma.case.reading import case_from
from bezsoma.results.archive import CASE, DISPLACEMENT, MESH
from bezsoma.results.folder import SUMMARY

TABLES = [
    table
    for table in vars(schema).values()
    if isinstance(table, type) and issubclass(table, schema.Table) and table is not schema.Table
]


def page(root: Path, name: str) -> str:
    return (root / "docs" / name).read_text(encoding="utf-8")


def toml(root: Path, name: str) -> str:
    """The TOML of a page, put together."""
    return "\n".join(re.findall(r"```toml\n(.*?)```", page(root, name), re.DOTALL))


@pytest.mark.parametrize("table", TABLES, ids=lambda table: table.__name__)
def test_every_key_is_described(table: type[schema.Table], root: Path) -> None:
    text = page(root, "case_file.md")
    example = toml(root, "case_file.md")
    missing = [
        key
        for key in table.model_fields
        if f"`{key}`" not in text
        and not re.search(rf"\b{key}(\.\w+)?\]*\s*=", example)
        and f"[{key}" not in text
    ]
    assert missing == []
    types = get_args(table.model_fields["type"].annotation) if "type" in table.model_fields else ()
    assert [word for word in types if f"`{word}`" not in text] == []


def test_every_quantity_is_described(root: Path) -> None:
    text = page(root, "case_file.md")
    words = [*WHOLE, *(f".{entry}" for entry in ENTRIES), *(f".{axis}" for axis in AXES)]
    assert [word for word in words if f"`{word}`" not in text and f"{word}`" not in text] == []
    assert all(f"PROBE.{tensor}" in text for tensor in TENSORS)


def test_every_file_is_described(root: Path) -> None:
    text = page(root, "case_file.md")
    assert all(f"`{name}`" in text for name in (CASE, MESH, DISPLACEMENT, SUMMARY))


def test_the_case_on_the_page_runs_and_gives_what_it_expects(root: Path, tmp_path: Path) -> None:
    case = case_from(tmp_path / "page.toml", toml(root, "case_file.md"))
    results = bz.run_case(case, tmp_path / "out")
    assert [check for check in results.summary["expectations"] if not check["met"]] == []
    assert len(results.summary["expectations"]) == 2
