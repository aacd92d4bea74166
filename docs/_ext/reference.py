# SPDX-License-Identifier: BSD-3-Clause
"""The pages of the reference that are read from the package, so that nothing can be forgotten."""

from __future__ import annotations

import inspect
import pkgutil
import sys
from pathlib import Path

import keys
from page import ROOT
from sphinx.application import Sphinx
from sphinx.config import Config

import bezsoma
from bezsoma.cli import app as commands

sys.path.insert(0, str(ROOT / "tests"))

from house import installed

ORDER = (
    "results",
    "case",
    "solvers",
    "equations",
    "mechanics",
    "imaging",
    "view",
    "mesh",
    "bernstein",
    "errors",
    "arrays",
)


def names() -> str:
    """What `import bezsoma` offers: each name, what it is, and where it lives."""
    rows = [row(name) for name in bezsoma.__all__ if not name.startswith("_")]
    return "\n".join([".. list-table::", "   :widths: 1 3", "", *rows, ""])


def row(name: str) -> str:
    """One public name and the first line of its docstring."""
    what = getattr(bezsoma, name)
    role = "py:class" if inspect.isclass(what) else "py:func"
    first = (inspect.getdoc(what) or "").split("\n")[0]
    return f"   * - :{role}:`{name} <{what.__module__}.{what.__qualname__}>`\n     - {first}"


def modules() -> str:
    """A page with the modules of the package, from the top floor to the bottom."""
    found = [m.name for m in pkgutil.iter_modules(bezsoma.__path__) if not m.name.startswith("_")]
    high_to_low = sorted(found, key=lambda m: ORDER.index(m) if m in ORDER else -1)
    title = ["The modules", "===========", "", "From the top floor to the bottom.", ""]
    lines = [".. autosummary::", "   :toctree: .", "   :recursive:", ""]
    return "\n".join([*title, *lines, *(f"   bezsoma.{name}" for name in high_to_low), ""])


def command_line() -> str:
    """A page with all commands and their options, as the command line itself has them."""
    page: str = commands.generate_docs(output_format="markdown")
    return page.replace("# bezsoma\n", "# The command line\n", 1)


def write(app: Sphinx, config: Config) -> None:
    """Write them where reference/index.md finds them."""
    folder = Path(app.srcdir) / "reference" / "generated"
    folder.mkdir(parents=True, exist_ok=True)
    pages = {
        "names.inc": names(),
        "modules.rst": modules(),
        "case_keys.md": keys.page(),
        "commands.md": command_line(),
        "licences.md": installed.page(),
    }
    for name, text in pages.items():
        if not (folder / name).exists() or (folder / name).read_text() != text:
            (folder / name).write_text(text)


def setup(app: Sphinx) -> dict[str, bool]:
    """Write the lists before anything reads them."""
    app.connect("config-inited", write)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
