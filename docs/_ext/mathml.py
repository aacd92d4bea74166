# SPDX-License-Identifier: BSD-3-Clause
"""Formulas as MathML, made when the pages are built.

Browsers draw MathML themselves, so the pages need no script and no network. Sphinx's own renderers
either fetch a script when a page is read or need a LaTeX installation when it is built.
"""

from __future__ import annotations

from typing import Any

from docutils import nodes
from latex2mathml.converter import convert
from sphinx.application import Sphinx


def inline(writer: Any, formula: nodes.math) -> None:
    """A formula within a line."""
    writer.body.append(convert(formula.astext(), display="inline"))
    raise nodes.SkipNode


def block(writer: Any, formula: nodes.math_block) -> None:
    """A formula on a line of its own."""
    writer.body.append(f'<div class="math">{convert(formula.astext(), display="block")}</div>')
    raise nodes.SkipNode


def setup(app: Sphinx) -> dict[str, bool]:
    """Offer the renderer to Sphinx under the name mathml."""
    app.add_html_math_renderer("mathml", (inline, None), (block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
