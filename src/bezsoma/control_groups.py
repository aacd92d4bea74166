# SPDX-License-Identifier: BSD-3-Clause
"""The control groups that this process is in: a container's, a batch job's (Linux)."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

GROUPS = Path("/sys/fs/cgroup")
OWN_GROUPS = Path("/proc/self/cgroup")


def groups(kind: str) -> Iterator[Path]:
    """The folders of the groups that limit "memory" or "cpu", own ones and those above.

    Of either version: the second has one tree for all kinds, the first one for each.
    """
    yield from (GROUPS, GROUPS / kind)
    try:
        lines = OWN_GROUPS.read_text(errors="surrogateescape").splitlines()
    except OSError:
        return
    for line in lines:
        _, kinds, path = line.split(":", 2)
        roots = dict.fromkeys((GROUPS / kind, GROUPS / kinds)) if kinds else (GROUPS,)
        if not kinds or kind in kinds.split(","):
            for root in roots:
                own = root / path.lstrip("/")
                yield from (folder for folder in (own, *own.parents) if root in folder.parents)
