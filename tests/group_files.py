# SPDX-License-Identifier: BSD-3-Clause
"""Control groups as files of a folder, in place of those that this process is in."""

from __future__ import annotations

from pathlib import Path

import pytest

from bezsoma import control_groups


def laid(files: dict[str, str], own: str, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The files of groups in a folder, and what says in which of them this process is."""
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    (folder / "own").write_text(own)
    monkeypatch.setattr(control_groups, "GROUPS", folder)
    monkeypatch.setattr(control_groups, "OWN_GROUPS", folder / "own")
