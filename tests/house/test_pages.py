# SPDX-License-Identifier: BSD-3-Clause
"""The pages of the documentation: their examples run, and none is left out of the contents."""

from __future__ import annotations

import doctest
import re
import subprocess
import sys
from pathlib import Path

import pytest

from house import sources

PAGES = Path(__file__).resolve().parents[2] / "docs"
WITH_EXAMPLES = [
    page
    for page in sources.files(PAGES, "**/*.md")
    if re.search(r"^>>> ", page.read_text(encoding="utf-8"), re.MULTILINE)
]

EXECUTED = sorted(
    page
    for pattern in ("tutorials/*.md", "adding/*.md", "coming_from.md")
    for page in PAGES.glob(pattern)
    if page.stem != "index"
)
"""Pages that are run from top to bottom; so they are when the documentation is built."""
SLOW = {"first_face", "your_own_ct", "figures"}


def executed(page: Path, kept: Path) -> subprocess.CompletedProcess[str]:
    """What running a page says; what it left is in `kept`."""
    command = [sys.executable, str(PAGES / "_ext/page.py"), str(page), str(kept)]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def test_the_pages_that_run_are_those_of_the_build() -> None:
    text = (PAGES / "_ext/executed.py").read_text(encoding="utf-8")
    assert 'EXECUTED = ("tutorials/*.md", "adding/*.md", "coming_from.md")' in text
    assert len(EXECUTED) >= 12


@pytest.mark.parametrize(
    "page",
    [pytest.param(p, id=p.stem, marks=[pytest.mark.slow] * (p.stem in SLOW)) for p in EXECUTED],
)
def test_a_page_runs_and_leaves_its_pictures(page: Path, tmp_path: Path) -> None:
    ran = executed(page, tmp_path)
    assert ran.returncode == 0, ran.stderr
    text = page.read_text(encoding="utf-8")
    for picture in re.findall(rf"generated/{page.stem}/([^)]+)\)", text):
        assert (tmp_path / "files" / picture).stat().st_size > 5000, picture


@pytest.mark.parametrize("page", [p for p in EXECUTED if p.parent.name == "tutorials"])
def test_a_tutorial_ends_in_assertions(page: Path) -> None:
    last = re.findall(r"```python\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)[-1]
    assert re.search(r"^ *assert ", last, re.MULTILINE)


BROKEN = {
    "a wrong claim": ("```python\nassert 1 == 2\n```", "line 3", "AssertionError"),
    "a failing command": ("```sh\nfalse\n```", "line 3", "status 1"),
    "a mistake that is none": ("```sh refused\ntrue\n```", "line 3", "status 0"),
    "a file that is not there": ("```toml + a.toml\nx = 1\n```", "line 3", "no a.toml"),
    "a change that does not fit": (
        "```diff\n--- a/x.py\n+++ b/x.py\n@@ -1,1 +1,1 @@\n-a\n+b\n```",
        "line 3",
        "does not fit",
    ),
}


@pytest.mark.parametrize("how", BROKEN)
def test_a_page_that_is_wrong_is_named_with_its_line(how: str, tmp_path: Path) -> None:
    block, *words = BROKEN[how]
    (tmp_path / "wrong.md").write_text(f"# A page\n\n{block}\n")
    ran = executed(tmp_path / "wrong.md", tmp_path / "kept")
    assert ran.returncode == 1
    assert [word for word in ["wrong.md", *words] if word not in ran.stderr] == []


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
