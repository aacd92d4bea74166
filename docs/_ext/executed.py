# SPDX-License-Identifier: BSD-3-Clause
"""Pages that are run when the documentation is built; one that fails, fails the build.

What a block printed is shown below it, and the pictures of a page are those that its run left: a page
`tutorials/first_face.md` shows `generated/first_face/head.png`.
"""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from page import FENCE, ROOT
from sphinx.application import Sphinx
from sphinx.errors import ExtensionError

EXECUTED = ("tutorials/*.md", "adding/*.md", "coming_from.md")
"""The pages that are run, from top to bottom."""
RUNNER = Path(__file__).with_name("page.py")


def executed(docs: Path) -> list[Path]:
    """The pages that are run."""
    return sorted(page for pattern in EXECUTED for page in docs.glob(pattern))


def run_page(page: Path, kept: Path) -> str:
    """Run a page; what went wrong, or nothing."""
    command = [sys.executable, str(RUNNER), str(page), str(kept)]
    return subprocess.run(command, capture_output=True, text=True, check=False).stderr


def pictures(page: Path) -> list[str]:
    """The files left by its run that a page shows."""
    text = page.read_text(encoding="utf-8")
    return re.findall(rf"\]\(generated/{page.stem}/([^)]+)\)", text)


def show(app: Sphinx, name: str, source: list[str]) -> None:
    """Run a page that is about to be read, and put in what it printed."""
    page = Path(app.srcdir) / f"{name}.md"
    if page not in executed(Path(app.srcdir)):
        return
    with tempfile.TemporaryDirectory() as scratch:
        kept = Path(scratch) / "kept"
        if wrong := run_page(page, kept):
            raise ExtensionError(f"a page does not run\n{wrong}")
        said = iter(json.loads((kept / "said.json").read_text(encoding="utf-8")))
        for file in pictures(page):
            place = page.parent / "generated" / page.stem / file
            place.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(kept / "files" / file, place)
    source[0] = FENCE.sub(lambda block: dressed(block, next(said)), source[0])


def dressed(block: re.Match[str], said: str) -> str:
    """A block with the name of its file above it, and what it printed below."""
    language, words, text = block.groups()
    named = words and words != "refused"
    caption = f":caption: {words.removeprefix('+ ')}\n\n" if named else ""
    code = f"```{{code-block}} {language}\n{caption}{text}```"
    return code + (f"\n\n```{{code-block}} text\n:class: said\n\n{said.rstrip()}\n```" if said else "")


def setup(app: Sphinx) -> dict[str, bool]:
    """Listen to what is read."""
    app.connect("source-read", show)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
