# SPDX-License-Identifier: BSD-3-Clause
"""One run at a time in a folder: a hidden file beside it that says which process works there."""

from __future__ import annotations

import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from bezsoma.errors import InputError


@contextmanager
def locked(place: Path) -> Iterator[None]:
    """While it lasts, no other run enters a folder; one that tries is told by which process.

    The system keeps the lock and lets it go when the process ends, however it ends. So the file
    that a killed run leaves behind bars nobody: the next one takes it over, and away at its end.
    """
    path = place.with_name(f".{place.name}.lock")
    file = _taken(path, place)
    try:
        os.truncate(file, 0)
        os.write(file, f"{os.getpid()}\n".encode())
        yield
    finally:
        path.unlink(missing_ok=True)  # before it is let go, lest it be another's
        os.close(file)


def _taken(path: Path, place: Path) -> int:
    """The open file at a path, locked."""
    while True:
        file = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            owner = os.read(file, 20).decode(errors="replace").strip() or "unknown"
            os.close(file)
            raise InputError(
                f"another run (process {owner}) is making the model in {str(place)!r}; wait until "
                "it ends, or choose another folder with -o"
            ) from None
        except BaseException:
            os.close(file)
            raise
        if _is_at(path, file):
            return file
        os.close(file)  # its owner took it away after we opened it


def _is_at(path: Path, file: int) -> bool:
    """Whether an open file is the one that stands at a path now."""
    try:
        return os.path.samestat(os.stat(path), os.fstat(file))
    except FileNotFoundError:
        return False
