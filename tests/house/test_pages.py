# SPDX-License-Identifier: BSD-3-Clause
"""The pages of the documentation: their examples run, and none is left out of the contents."""

from __future__ import annotations

import doctest
import re
from pathlib import Path

import pytest

from house import sources

PAGES = Path(__file__).resolve().parents[2] / "docs"
WITH_EXAMPLES = [
    page
    for page in sources.files(PAGES, "**/*.md")
    if re.search(r"^>>> ", page.read_text(encoding="utf-8"), re.MULTILINE)
]


@pytest.mark.parametrize("page", WITH_EXAMPLES, ids=[page.stem for page in WITH_EXAMPLES])
def test_the_examples_of_a_page_run(
    page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    options = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE
    text = re.sub(r"^```\s*$", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE)
    test = doctest.DocTestParser().get_doctest(text, {}, page.stem, str(page), 0)
    said: list[str] = []
    result = doctest.DocTestRunner(optionflags=options).run(test, out=said.append)
    assert result.failed == 0, "".join(said)
    assert result.attempted > 0


def test_no_page_is_lost(root: Path) -> None:
    """Sphinx says so too; this one is quick, and holds without Sphinx."""
    docs = root / "docs"
    told = " ".join(page.read_text(encoding="utf-8") for page in docs.rglob("index.md"))
    lost = [
        str(page.relative_to(docs))
        for page in docs.glob("*.md")
        if page.stem != "index" and not re.search(rf"^{page.stem}$", told, re.MULTILINE)
    ]
    assert lost == []
