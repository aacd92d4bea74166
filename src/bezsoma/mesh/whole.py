# SPDX-License-Identifier: BSD-3-Clause
"""Files that appear whole or not at all."""

from __future__ import annotations

import os
import secrets
from collections.abc import Callable
from pathlib import Path


def write_whole(place: Path, write: Callable[[Path], object]) -> None:
    """Have `write` fill a neighbour of the place, then move it there in one step.

    So an interrupted run or a full disk leaves either the old file or none, never half of one.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_whole(Path(folder) / "a.bin", lambda part: part.write_bytes(b"abc"))
    ...     [entry.name for entry in Path(folder).iterdir()]
    ['a.bin']
    """
    part = place.with_name(f".{place.stem}-{secrets.token_hex(4)}{place.suffix}")
    try:
        write(part)
        os.replace(part, place)
    finally:
        part.unlink(missing_ok=True)
