# SPDX-License-Identifier: BSD-3-Clause
"""Pages that are run when the documentation is built; one that fails, fails the build.

What a block printed is shown below it, and the pictures of a page are those that its run left: a
page `tutorials/first_face.md` shows `generated/first_face/head.png`. A page runs when it is read,
which is whenever it has changed; `./dev docs -E` runs all of them anew.
"""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from page import FENCE
from sphinx.application import Sphinx
from sphinx.environment import BuildEnvironment
from sphinx.errors import ExtensionError

EXECUTED = ("tutorials/*.md", "adding/*.md", "coming_from.md")
"""The pages that are run, from top to bottom."""
RUNNER = Path(__file__).with_name("page.py")
AT_ONCE = 2
SMALLEST = 5000
"""Bytes; what is smaller is no picture."""
KEPT = "executed"
"""The folder beside the built pages in which runs leave what they said and made."""


def executed(docs: Path) -> list[Path]:
    """The pages that are run."""
    return sorted(page for pattern in EXECUTED for page in docs.glob(pattern))


def run_page(page: Path, kept: Path) -> str:
    """Run a page; what went wrong, or nothing."""
    command = [sys.executable, str(RUNNER), str(page), str(kept)]
    ran = subprocess.run(command, capture_output=True, text=True, check=False)
    if ran.returncode:
        return ran.stderr
    made = {file: kept / "files" / file for file in pictures(page)}
    bare = [name for name, at in made.items() if not at.exists() or at.stat().st_size < SMALLEST]
    return f"{page}: no picture came of {', '.join(bare)}" if bare else ""


def pictures(page: Path) -> list[str]:
    """The files left by its run that a page shows."""
    text = page.read_text(encoding="utf-8")
    return re.findall(rf"\]\(generated/{page.stem}/([^)]+)\)", text)


def run_all(app: Sphinx, env: BuildEnvironment, names: list[str]) -> None:
    """Run the pages that are about to be read, two at a time."""
    docs = Path(app.srcdir)
    pages = [page for page in executed(docs) if str(page.relative_to(docs))[:-3] in names]
    places = [kept(app, page) for page in pages]
    with ThreadPoolExecutor(AT_ONCE) as pool:
        wrong = [each for each in pool.map(run_page, pages, places) if each]
    if wrong:
        raise ExtensionError("\n".join(["pages do not run", *wrong]))
    for page, place in zip(pages, places, strict=True):
        for file in pictures(page):
            shown = page.parent / "generated" / page.stem / file
            shown.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(place / "files" / file, shown)


def kept(app: Sphinx, page: Path) -> Path:
    """Where the run of a page leaves what it said and made."""
    return Path(app.outdir).parent / KEPT / page.stem


def show(app: Sphinx, name: str, source: list[str]) -> None:
    """Put in what the blocks of a page printed."""
    page = Path(app.srcdir) / f"{name}.md"
    if page in executed(Path(app.srcdir)):
        said = iter(json.loads((kept(app, page) / "said.json").read_text(encoding="utf-8")))
        source[0] = FENCE.sub(lambda block: dressed(block, next(said)), source[0])


def dressed(block: re.Match[str], said: str) -> str:
    """A block with the name of its file above it, and what it printed below."""
    language, words, text = block.groups()
    code = f"```{language}\n{text}```"
    if words and words != "refused":
        caption = words.removeprefix("+ ")
        code = f"```{{code-block}} {language}\n:caption: {caption}\n\n{text}```"
    if not said:
        return code
    return f"{code}\n\n```{{code-block}} text\n:class: said\n\n{said.rstrip()}\n```"


def setup(app: Sphinx) -> dict[str, bool]:
    """Listen to what is read."""
    app.connect("env-before-read-docs", run_all)
    app.connect("source-read", show)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
