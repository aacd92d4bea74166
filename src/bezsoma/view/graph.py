# SPDX-License-Identifier: BSD-3-Clause
"""Graphs and line drawings as PNG: numbers of a study, the nets of a patch."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from bezsoma.errors import InputError
from bezsoma.view.sheet import Graph, Line, Tiles, graphs, png
from bezsoma.view.written import written

__all__ = ["Graph", "Line", "Tiles", "graph_picture"]


def graph_picture(
    path: str | Path | None,
    shown: Sequence[Graph],
    *,
    columns: int = 2,
    title: str = "",
    size: tuple[int, int] = (1200, 560),
    overwrite: bool = False,
) -> bytes:
    r"""A page of graphs as PNG, `columns` in a row; written if a path is given.

    >>> import numpy as np
    >>> line = Line(np.array([[1.0, 1.0], [2.0, 4.0]]), "x^2")
    >>> graph_picture(None, [Graph("a parabola", [line])], columns=1)[:4]
    b'\x89PNG'
    """
    if not len(shown) or columns < 1:
        raise InputError(
            f"{len(shown)} graphs in rows of {columns} cannot be drawn; give one graph or more, "
            "and columns=1 or more"
        )
    content = png(graphs(shown, columns, title, size), title)
    if path is not None:
        written(path, content, overwrite)
    return content
