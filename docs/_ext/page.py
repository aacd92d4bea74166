# SPDX-License-Identifier: BSD-3-Clause
"""Runs the blocks of a page from top to bottom, in a scratch folder of its own.

    python docs/_ext/page.py docs/tutorials/first_face.md KEPT

What the first line of a block says decides what becomes of it:

- `python`: run, all of a page in one namespace;
- `sh`: run, with `bezsoma` on the path; `sh refused` has to fail;
- `toml mine.toml`, `python src/bezsoma/x.py`: written to that file; `toml + mine.toml`: added;
- `diff`: applied;
- anything else is for reading.

On pages that write below `src`, the folder begins as a copy of the project, and `./dev test` there
runs tests with the package of the copy. What the blocks print and the files they leave go to KEPT,
as `said.json` and the folder `files`. The first block that fails ends it, with its page and line.
"""

from __future__ import annotations

import contextlib
import io
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

ROOT = Path(__file__).resolve().parents[2]
FENCE = re.compile(r"^```(\w+)(?: (\S.*?))?\n(.*?)^```$", re.MULTILINE | re.DOTALL)
COPIED = ("src", "tests", "pyproject.toml")
DEV = """#!/bin/sh
shift
unset BEZSOMA_DATA_REQUIRED # no data lie beside the copy
PYTHONPATH=tests exec {python} -m house.apart "$PWD/src" -q -p no:cacheprovider "$@"
"""


class Block(NamedTuple):
    """A fenced block: its language, the rest of its first line, its text, its line on the page."""

    language: str
    words: str
    text: str
    line: int


class Failed(Exception):
    """What a block did wrong."""


def blocks(text: str) -> list[Block]:
    r"""The fenced blocks of a page.

    >>> blocks("Look:\n```sh refused\nfalse\n```\n")
    [Block(language='sh', words='refused', text='false\n', line=2)]
    """
    found = FENCE.finditer(text)
    return [Block(m[1], m[2] or "", m[3], text.count("\n", 0, m.start()) + 1) for m in found]


def run(page: Path, kept: Path) -> list[str]:
    """What each block of a page printed; the files that it left are copied to `kept`."""
    parts = blocks(page.read_text(encoding="utf-8"))
    scope: dict[str, Any] = {"__name__": "__main__"}
    with tempfile.TemporaryDirectory() as scratch, contextlib.chdir(scratch):
        if any(block.words.startswith("src/") for block in parts):
            copy_project()
        said = [done(block, page, scope).replace(f"{scratch}/", "") for block in parts]
        shutil.copytree(scratch, kept / "files", ignore=shutil.ignore_patterns("src", "tests"))
    (kept / "said.json").write_text(json.dumps(said), encoding="utf-8")
    return said


def copy_project() -> None:
    """A copy of the project to change, with the core as it is built, and a `dev` that tests it."""
    for name in COPIED:
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, name, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(ROOT / name, name)
    shutil.copy(built_core(), "src/bezsoma")
    Path("dev").write_text(DEV.format(python=sys.executable), encoding="utf-8")
    Path("dev").chmod(0o755)


def built_core() -> Path:
    """The compiled core of the package that is installed."""
    import bezsoma._core as core

    return Path(str(core.__file__))


def done(block: Block, page: Path, scope: dict[str, Any]) -> str:
    """What a block printed; a block that fails is named."""
    try:
        return way(block)(block, page, scope)
    except Failed as error:
        raise Failed(f"{page.name}, line {block.line}: {error}") from None


def way(block: Block) -> Callable[[Block, Path, dict[str, Any]], str]:
    """How a block is run."""
    if block.words and block.words != "refused":
        return written
    return {"python": python, "sh": shell, "diff": patched}.get(block.language, shown)


def shown(block: Block, page: Path, scope: dict[str, Any]) -> str:
    """A block that is only read."""
    return ""


def written(block: Block, page: Path, scope: dict[str, Any]) -> str:
    """A block that is a file, or is added to one."""
    more = block.words.startswith("+ ")
    file = Path(block.words.removeprefix("+ "))
    if more and not file.exists():
        raise Failed(f"there is no {file} to add to")
    file.parent.mkdir(parents=True, exist_ok=True)
    with file.open("a" if more else "w", encoding="utf-8") as out:
        out.write(("\n" if more else "") + block.text)
    return ""


def python(block: Block, page: Path, scope: dict[str, Any]) -> str:
    """A block of Python; its lines have the numbers of the page in a traceback."""
    said = io.StringIO()
    try:
        with contextlib.redirect_stdout(said):
            exec(compile("\n" * block.line + block.text, str(page), "exec"), scope)
    except BaseException:
        raise Failed(said.getvalue() + traceback.format_exc()) from None
    return said.getvalue()


def shell(block: Block, page: Path, scope: dict[str, Any]) -> str:
    """A block of commands; of those that are refused, what they say."""
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])
    ran = subprocess.run(
        ["sh", "-eu", "-c", block.text],
        env={**os.environ, "PATH": path},
        capture_output=True,
        text=True,
        check=False,
    )
    if (ran.returncode != 0) != (block.words == "refused"):
        raise Failed(f"left with status {ran.returncode}\n{ran.stdout}{ran.stderr}")
    return ran.stderr if block.words == "refused" else ran.stdout


def patched(block: Block, page: Path, scope: dict[str, Any]) -> str:
    """A change of files of the copy."""
    command = ["git", "apply", "--recount", "-"]
    ran = subprocess.run(command, input=block.text, capture_output=True, text=True, check=False)
    if ran.returncode:
        raise Failed(f"does not fit the sources as they are now:\n{ran.stderr}")
    return ""


def main() -> int:
    """Run one page; 1 and the reason if it fails."""
    page, kept = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
    shutil.rmtree(kept, ignore_errors=True)
    kept.mkdir(parents=True)
    try:
        run(page, kept)
    except Failed as error:
        print(error, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
