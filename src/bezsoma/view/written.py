# SPDX-License-Identifier: BSD-3-Clause
"""Files that appear whole or not at all."""

from __future__ import annotations

from pathlib import Path

from bezsoma.errors import InputError
from bezsoma.mesh.whole import write_whole


def written(path: str | Path, content: bytes, overwrite: bool = False) -> Path:
    """The path, once `content` stands there; refuses to replace a file unless `overwrite`.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     target = written(Path(folder) / "a.bin", b"abc")
    ...     target.read_bytes(), [entry.name for entry in Path(folder).iterdir()]
    (b'abc', ['a.bin'])
    """
    target = vacant(path, overwrite)
    try:
        write_whole(target, lambda part: part.write_bytes(content))
    except OSError as error:
        raise InputError(
            f"cannot write {str(target)!r} ({error.strerror}); make room or choose another folder"
        ) from error
    return target


def vacant(path: str | Path, overwrite: bool = False, *endings: str) -> Path:
    """The path, if a file may be written there: asked before the work as well as after it.

    `endings` are what its name may end in, so that it says what the file holds.
    """
    target = Path(path)
    if target.is_dir():
        raise InputError(f"{str(target)!r} is a folder; give the name of a file in it")
    if endings and not target.name.lower().endswith(endings):
        kinds = " or ".join(each[1:].upper() for each in endings)
        raise InputError(f"{str(target)!r} would hold a {kinds}; end it in {' or '.join(endings)}")
    if target.exists() and not overwrite:
        raise InputError(f"{str(target)!r} exists; say overwrite=True to replace it")
    if not target.parent.is_dir():
        raise InputError(f"there is no folder {str(target.parent)!r}; make it first")
    return target
