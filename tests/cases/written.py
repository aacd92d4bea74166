# SPDX-License-Identifier: BSD-3-Clause
"""A small case as text, and a way to write it with some of its lines changed."""

from __future__ import annotations

from pathlib import Path

BLOCK = """\
# A block pulled by 0.1 mm, with a formula on its upper side.
title = "A block"
degree = 2

[mesh]
solid = "block"
parameters = { size = [2, 1, 1], cells = [2, 1, 1] }

[materials.tissue]
E = 0.015
nu = 0.3

[[support]]
type = "fixed"
on = "left"

[[support]]
type = "moved"
on = ["right"]
translation = [0.1, 0, 0]

[[load]]
type = "traction"
on = "top"
value = [0, 0, "1e-5*x"]

[[probe]]
name = "middle"
point = [1, 0.5, 0.5]

[[expect]]
of = "middle.x"
between = [0.04, 0.06]
source = "half of what the right side moves"

[output]
pictures = []
"""


def case_file(folder: Path, *changes: tuple[str, str], name: str = "case.toml") -> Path:
    """The block's case in a folder, each change (from, to) made once."""
    text = BLOCK
    for before, after in changes:
        assert text.count(before) >= 1, before
        text = text.replace(before, after, 1)
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path
