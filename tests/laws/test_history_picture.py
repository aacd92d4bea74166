# SPDX-License-Identifier: BSD-3-Clause
"""The picture of an iteration: what is drawn of it, and what is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import bezsoma as bz
from bezsoma.view import sheet


def squeezed() -> bz.Solution:
    """A block pressed together in two steps."""
    supports = [bz.Fixed("bottom"), bz.Moved("top", translation=(0, 0, -0.3))]
    return bz.solve(bz.Body(bz.block(), 2, bz.NeoHooke(1.0, 0.3), supports), steps=2)


def test_every_iteration_is_drawn(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    drawn = []
    real = sheet.chart
    monkeypatch.setattr(
        "bezsoma.view.history.chart", lambda *given: drawn.append(real(*given)) or drawn[-1]
    )
    solution = squeezed()
    content = bz.history_picture(tmp_path / "newton.png", solution.path)
    assert (tmp_path / "newton.png").read_bytes() == content
    (axes,) = drawn[0].axes
    residual, _ = axes.get_lines()
    assert residual.get_xdata().tolist() == list(range(1, len(solution.path) + 1))
    assert np.array_equal(residual.get_ydata(), [each.residual for each in solution.path])
    assert [text.get_text() for text in axes.texts] == ["50 %", "100 %"]
    assert axes.get_yscale() == "log"
    with pytest.raises(bz.InputError, match="exists"):
        bz.history_picture(tmp_path / "newton.png", solution.path)


def test_without_iterations_nothing_is_drawn() -> None:
    with pytest.raises(bz.InputError, match="no iterations to draw"):
        bz.history_picture(None, ())


def test_numbers_alone_are_refused() -> None:
    with pytest.raises(bz.InputError, match=r"it draws `path` of a Solution"):
        bz.history_picture(None, [1.0, 1e-5])  # type: ignore[list-item]
