# SPDX-License-Identifier: BSD-3-Clause
"""What a run shows of itself: bars on a terminal, plain lines elsewhere."""

from __future__ import annotations

from io import StringIO

import pytest
from rich.console import Console

from bezsoma import progress


def test_stages_are_plain_lines_where_there_is_no_terminal(
    capsys: pytest.CaptureFixture[str],
) -> None:
    with progress.shown(quiet=False) as report:
        report("mesh", None, "reading")
        for step in range(100):
            report("solving", step / 100, f"iteration {step}")
        report("write", None, "")
    out, err = capsys.readouterr()
    assert err.splitlines() == ["mesh: reading", "solving 0 %: iteration 0", "write"]
    assert out == ""


def test_a_long_stage_says_now_and_then_that_it_goes_on(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    clock = iter(0.5 * progress.SECONDS_BETWEEN_LINES * step for step in range(100))
    monkeypatch.setattr(progress, "perf_counter", lambda: next(clock))
    with progress.shown(quiet=False) as report:
        for step in range(5):
            report("solving", step / 4, f"iteration {step}")
    assert [line.split()[-1] for line in capsys.readouterr().err.splitlines()] == ["0", "2", "4"]


def test_a_quiet_run_shows_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    with progress.shown(quiet=True) as report:
        report("mesh", None, "reading")
    assert capsys.readouterr() == ("", "")


def test_on_a_terminal_each_stage_has_a_line_and_brackets_are_no_markup() -> None:
    shown = StringIO()
    console = Console(file=shown, force_terminal=True, width=100, color_system=None)
    with progress._bars(console) as report:
        report("mesh", None, "reading [red]x[/red]")
        report("solving", 0.5, "halfway")
        report("solving", 1.0, "there")
    last = shown.getvalue().split("\x1b[2K")[-1] + shown.getvalue()
    assert "reading [red]x[/red]" in last
    assert "ok mesh" in last
    assert "there" in last
