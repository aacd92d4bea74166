# SPDX-License-Identifier: BSD-3-Clause
"""The page of messages shows what tests of today provoke, and enough of them."""

from __future__ import annotations

import re
from pathlib import Path


def test_at_least_200_messages_stand_on_the_page(root: Path) -> None:
    page = (root / "docs" / "verification" / "faults.md").read_text(encoding="utf-8")
    told = re.search(r"^(\d+) messages", page, re.MULTILINE)
    assert told and int(told[1]) >= 200
    assert len(re.findall(r"^\S.*:\n\n    \S", page, re.MULTILINE)) == int(told[1])
