# SPDX-License-Identifier: BSD-3-Clause
"""Where a results folder will stand: checked before any work, filled beside it, then renamed.

A half-written folder looks like an answer. So everything is written into a hidden sibling, which
one rename turns into the results folder; whatever stops the run before that (an error, a full
disk, Ctrl-C) removes the sibling and leaves what was there before.
"""

from __future__ import annotations

import errno
import json
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from bezsoma.errors import InputError

SUMMARY = "summary.json"
FORMAT = "bezsoma results 1"
"""The mark in summary.json by which a folder is known to be one of ours."""

REASONS = {
    errno.ENOSPC: "no space is left on that disk; free some, or choose another folder with -o",
    errno.EDQUOT: "your quota on that disk is used up; free some, or choose another folder with -o",
    errno.EIO: "that disk does not take it (input/output error); choose another folder with -o",
    errno.EROFS: "that disk is read-only; choose another folder with -o",
    errno.EACCES: "you may not write there; choose another folder with -o",
    errno.EPERM: "you may not write there; choose another folder with -o",
}


@dataclass(frozen=True)
class Destination:
    """A place that was found fit for a results folder."""

    folder: Path
    """Where the results will stand."""
    replaces: bool
    """Whether a results folder stands there now, which this run was told to replace."""

    @contextmanager
    def filling(self) -> Iterator[Path]:
        """The hidden sibling to write into; it becomes `folder` when the block ends well."""
        with written(self.folder):
            partial = Path(tempfile.mkdtemp(dir=self.folder.parent, prefix=f".{self.folder.name}."))
            try:
                partial.chmod(0o777 & ~_umask())
                yield partial
                self._take_place(partial)
            finally:
                shutil.rmtree(partial, ignore_errors=True)

    def _take_place(self, partial: Path) -> None:
        """Rename the filled sibling; a folder it replaces is put back if that fails."""
        refuse_occupied(self.folder, overwrite=self.replaces)
        if not self.folder.exists():
            partial.rename(self.folder)
            return
        old = Path(tempfile.mkdtemp(dir=self.folder.parent, prefix=f".{self.folder.name}.old."))
        aside = old / self.folder.name
        self.folder.rename(aside)
        try:
            partial.rename(self.folder)
        except BaseException:
            aside.rename(self.folder)
            raise
        finally:
            shutil.rmtree(old, ignore_errors=True)

    def check_room(self, size: int) -> None:
        """Refuse to start when fewer than `size` bytes are free on the disk of the folder."""
        free = shutil.disk_usage(self.folder.parent).free
        if free < size:
            raise InputError(
                f"the results of this case need about {size / 1e6:.0f} MB, and the disk of "
                f"{str(self.folder.parent)!r} has {free / 1e6:.0f} MB free; {_reason(errno.ENOSPC)}"
            )


def destination(folder: Path | str, *, overwrite: bool = False) -> Destination:
    """`folder` as a place for results, or an InputError that says what stands in the way.

    Only a folder that BezSoma itself wrote, with nothing else in it, is ever replaced, and only
    with `overwrite`. The place is tried by making and removing a hidden folder beside it: asking
    for permissions would say nothing about read-only disks.
    """
    folder = Path(os.path.abspath(folder))
    with written(folder):
        if not folder.parent.is_dir():
            missing = "is not a folder" if folder.parent.exists() else "does not exist"
            raise InputError(
                f"the results folder {folder.name!r} cannot be made in {str(folder.parent)!r}: "
                f"that {missing}; make it first, or choose another folder with -o"
            )
        refuse_occupied(folder, overwrite=overwrite)
        os.rmdir(tempfile.mkdtemp(dir=folder.parent, prefix=f".{folder.name}."))
    return Destination(folder, replaces=folder.exists() and any(folder.iterdir()))


def refuse_occupied(folder: Path, *, overwrite: bool) -> None:
    """Refuse a folder that may not be (re)placed; an empty one is as good as none."""
    name = str(folder)
    if folder.is_symlink():
        raise InputError(f"{name!r} is a link; give the folder itself, or another one with -o")
    if not folder.exists():
        return
    if not folder.is_dir():
        raise InputError(f"{name!r} is a file, not a folder; choose another folder with -o")
    if not any(folder.iterdir()):
        return
    foreign = strangers(folder)
    if foreign is None:
        raise InputError(
            f"{name!r} exists and is not a results folder of BezSoma, so nothing in it is "
            "touched; choose another folder with -o"
        )
    if not overwrite:
        raise InputError(
            f"results already stand in {name!r}; choose another folder with -o, or replace them "
            "with --overwrite"
        )
    if foreign:
        raise InputError(
            f"{name!r} holds {foreign}, which BezSoma did not write and will not delete; move "
            "that elsewhere, or choose another folder with -o"
        )


def strangers(folder: Path) -> list[str] | None:
    """The names in a results folder that its own list of files lacks; None where it is not one."""
    try:
        summary = json.loads((folder / SUMMARY).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    if not isinstance(summary, dict) or summary.get("format") != FORMAT:
        return None
    known = {SUMMARY, *summary.get("files", [])}
    return sorted(path.name for path in folder.iterdir() if path.name not in known)


@contextmanager
def written(folder: Path) -> Iterator[None]:
    """Turns the system's refusal to write below `folder` into a sentence."""
    try:
        yield
    except OSError as error:
        if error.errno is None:
            raise
        raise InputError(
            f"cannot write the results to {str(folder)!r}: {_reason(error.errno)}"
        ) from error


def _reason(number: int) -> str:
    told = f"the system says {os.strerror(number)!r}; try again, or choose another folder with -o"
    return REASONS.get(number, told)


def _umask() -> int:
    """The process's umask, which can only be read by setting it."""
    mask = os.umask(0)
    os.umask(mask)
    return mask
