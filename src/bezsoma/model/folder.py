# SPDX-License-Identifier: BSD-3-Clause
"""The folder of a model: what stage was done with what, so that a run goes on where one ended.

A stage fills a hidden folder. When that is whole, `model.json` says so, and its files take their
places one after the other, those of later stages, which no longer fit, going first. Whatever stops
a run before leaves no part of the stage under way, and before the first is done no folder; what
stops it amid these steps is made good by the next run, which finishes them.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import shutil
import tempfile
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from glob import escape, glob
from pathlib import Path
from typing import Any

from bezsoma import __version__
from bezsoma.errors import InputError
from bezsoma.mesh.whole import write_whole
from bezsoma.model.lock import locked
from bezsoma.results.folder import written

RECORD = "model.json"
FORMAT = "bezsoma model 1"
"""The mark in model.json by which a folder is known to be one of ours."""
PENDING = "pending"
"""What model.json says while the files of a stage take their places."""
NAMING = {
    ".mhd": "elementdatafile", ".mha": "elementdatafile", ".nhdr": "datafile", ".nrrd": "datafile",
}  # fmt: skip
"""By what word, without its spaces, a header of a format names the files of its values."""
LONGEST_HEADER = 1_000_000
"""Bytes of a file in which its header ends."""
SUM = "sum"
"""What model.json calls the SHA-256 of the rest that it says."""
ROOM = 300_000_000
"""Bytes that have to be free before a run starts."""


@dataclass(eq=False)
class ModelFolder:
    """A folder for one model, and what its record says. `overwrite`: stages may be made anew."""

    place: Path
    source: str
    overwrite: bool
    record: dict[str, Any] = field(default_factory=dict)

    @classmethod
    @contextmanager
    def at(cls, path: Path | str, source: str, *, overwrite: bool) -> Iterator[ModelFolder]:
        """The folder, made if need be, and for this run alone; `source`: of what picture it is."""
        place = Path(os.path.abspath(path))
        if not place.parent.is_dir():
            raise InputError(f"{str(path)!r}: there is no folder {str(place.parent)!r}; make it")
        if place.is_symlink() or (place.exists() and not place.is_dir()):
            raise InputError(f"{str(path)!r} is no folder; choose another one with -o")
        with ExitStack() as held:
            with written(place):
                held.enter_context(locked(place))
            new = not place.exists()
            folder = cls._entered(path, place, source, overwrite)
            try:
                yield folder
            finally:
                folder._leave(new)

    @classmethod
    def _entered(cls, path: Path | str, place: Path, source: str, overwrite: bool) -> ModelFolder:
        record = _record(place, overwrite)
        parts = list(place.glob(f".{Path(RECORD).stem}-*.json"))  # of a run killed at its start
        if record is None and place.exists() and any(p not in parts for p in place.iterdir()):
            raise InputError(
                f"{str(path)!r} exists and is no model of BezSoma, so nothing in it is touched; "
                "choose another folder with -o"
            )
        if record and not (record["stages"] or PENDING in record):
            record = None  # left by a run that was killed early: a claim on nothing
        if record and record["source"] != source and not overwrite:
            raise InputError(
                f"{str(path)!r} holds the model of another picture; choose another folder with -o, "
                "or replace it with --overwrite"
            )
        folder = cls(
            place, source, overwrite, record or {"format": FORMAT, "source": source, "stages": {}}
        )
        folder._check_room()
        with written(place):
            place.mkdir(exist_ok=True)
            for part in parts:
                part.unlink(missing_ok=True)
            if PENDING in folder.record:
                folder._settle()
            folder._check_untouched()
            folder._save()
        return folder

    def _leave(self, new: bool) -> None:
        """Take away what a run that finished no stage made: its record, the folder if `new`."""
        if self.record["stages"] or PENDING in self.record:
            return
        (self.place / RECORD).unlink(missing_ok=True)
        if new and not any(self.place.iterdir()):
            self.place.rmdir()

    def _check_room(self) -> None:
        free = shutil.disk_usage(self.place.parent).free
        if free < ROOM:
            raise InputError(
                f"a model needs about {ROOM / 1e6:.0f} MB, and the disk of {str(self.place)!r} has "
                f"{free / 1e6:.0f} MB free; free some, or choose another folder with -o"
            )

    def done(self, stage: str, names: Iterable[str], key: str) -> bool:
        """Whether the files of a stage stand there as it left them, made with this key."""
        known = self.record["stages"].get(stage)
        names = list(names)
        if known is None:
            return False
        whole = all((self.place / name).exists() for name in names)
        if whole and known["key"] == key:
            return True
        if known["key"] != key and not self.overwrite:
            raise InputError(
                f"the stage {stage!r} in {str(self.place)!r} was made with other settings or "
                "another version; make it and what follows anew with --overwrite, or choose "
                "another folder with -o"
            )
        return False

    def _check_untouched(self) -> None:
        """Refuses files that somebody edited, before anything is made anew."""
        for known in self.record["stages"].values():
            for name, sum_ in known["files"].items():
                path = self.place / name
                if path.exists() and hashed([path]) != sum_:
                    raise InputError(
                        f"{str(path)!r} was changed since it was made; move it elsewhere, and a "
                        "new one will be made"
                    )

    def fill(
        self,
        stage: str,
        key: str,
        write: Callable[[Path], dict[str, Any]],
        later: Iterable[str] = (),
    ) -> None:
        """Have a stage write its files into a folder, and keep them with what it says of itself.

        If they are made with another key than before, what stages `later` made of them goes.
        """
        with written(self.place):
            for left in self.place.glob(f".{stage}.*"):  # of a run that was killed
                shutil.rmtree(left, ignore_errors=True)
            partial = Path(tempfile.mkdtemp(dir=self.place, prefix=f".{stage}."))
            try:
                said = write(partial)
                sums = {path.name: hashed([path]) for path in sorted(partial.iterdir())}
                known = {"key": key, "files": sums, "said": said}
                self._announce(stage, partial.name, known, later)
            except BaseException:
                shutil.rmtree(partial, ignore_errors=True)
                raise
            self._settle()

    def _announce(
        self, stage: str, partial: str, known: dict[str, Any], later: Iterable[str]
    ) -> None:
        """Have the record say which files are about to take their places, and what stages go."""
        before = self.record["stages"].get(stage)
        stale = before is None or before["key"] != known["key"]
        pending = {"stage": stage, "folder": partial, "known": known, "gone": list(later) * stale}
        self.record = {**self.record, "source": self.source, PENDING: pending}
        self._save()

    def _settle(self) -> None:
        """Let the files that were announced take their places, or the rest of them."""
        stages, pending = dict(self.record["stages"]), self.record[PENDING]
        partial, files = self.place / pending["folder"], pending["known"]["files"]
        for stage in pending["gone"]:
            for name in stages.pop(stage, {"files": ()})["files"]:
                (self.place / name).unlink(missing_ok=True)
        for name in files:
            if (partial / name).exists():
                (partial / name).replace(self.place / name)
        stages[pending["stage"]] = pending["known"]
        rest = {key: value for key, value in self.record.items() if key != PENDING}
        self.record = {**rest, "stages": stages}
        self._save()
        shutil.rmtree(partial, ignore_errors=True)

    def said(self, stage: str) -> dict[str, Any]:
        """What a finished stage said of itself."""
        said: dict[str, Any] = self.record["stages"][stage]["said"]
        return said

    def _save(self) -> None:
        text = json.dumps({**self.record, SUM: _sum(self.record)}, indent=1) + "\n"
        write_whole(self.place / RECORD, lambda part: part.write_text(text, encoding="utf-8"))


def _record(place: Path, overwrite: bool) -> dict[str, Any] | None:
    """What model.json says, if the folder has one that is ours; nothing if it is to be replaced."""
    try:
        record = json.loads((place / RECORD).read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return None
    if not (isinstance(record, dict) and record.get("format") == FORMAT):
        return None
    if record.pop(SUM, None) == _sum(record):
        return record
    if overwrite:
        return {}
    raise InputError(
        f"{str(place / RECORD)!r} is not as it was written: it was changed, or lost something of "
        "what it said; delete the folder, make the model anew with --overwrite, or choose another "
        "folder with -o"
    )


def _sum(record: dict[str, Any]) -> str:
    """Of a record as it will be read: JSON turns every key into a word."""
    return hashed([], json.dumps(json.loads(json.dumps(record)), sort_keys=True))


def hashed(paths: Iterable[Path], *words: str) -> str:
    """SHA-256 of the contents of files in order, and of words."""
    total = hashlib.sha256()
    for path in paths:
        with path.open("rb") as file:
            total.update(hashlib.file_digest(file, "sha256").digest())
    for word in words:
        total.update(hashlib.sha256(word.encode()).digest())
    return total.hexdigest()


def source_of(path: Path) -> str:
    """SHA-256 of a picture: of its file, or of all files of its folder by name.

    A MetaImage or NRRD file may be only a header, whose values lie in files beside it, whatever
    their names: in one, in one a slice by a pattern or by a list. All that it names count.
    """
    if not path.exists():
        raise InputError(f"no file or folder {str(path)!r}; give a CT: a file, or a DICOM folder")
    if path.is_dir():
        return hashed(sorted(p for p in path.rglob("*") if p.is_file()))
    if path.suffix.lower() not in NAMING:
        return hashed([path])
    return hashed([path, *_beside(path)])


def _beside(path: Path) -> list[Path]:
    """The files that a header names."""
    with path.open("rb") as file:
        lines = file.read(LONGEST_HEADER).decode("latin-1").split("\n")
    found: list[Path] = []
    for number, line in enumerate(lines):
        key, _, word = re.sub("[=:]", "\n", line, count=1).partition("\n")
        if "".join(key.split()).lower() == NAMING[path.suffix.lower()]:
            listed = lines[number + 1 :] if word.split()[:1] == ["LIST"] else []
            for name in (word, *listed):
                found += _files(path.parent, name.strip())
            break  # values may follow
        if not line.strip() and path.suffix.lower() in (".nrrd", ".nhdr"):
            break
    return found


def _files(folder: Path, name: str) -> list[Path]:
    """The file of a name, or those of a pattern such as 's%03d.raw 0 39 1', whatever its range."""
    if not name:
        return []
    place = os.path.join(folder, name)
    if os.path.isfile(place):  # false, too, for what can be no name
        return [Path(place)]
    pattern = re.sub(r"(\s+-?\d+)+$", "", place)
    parts = re.split(r"%[-+ #0]*\d*[a-zA-Z]", pattern)
    if len(parts) == 1:
        return []
    return sorted(Path(file) for file in glob("*".join(map(escape, parts))) if os.path.isfile(file))


def key_of(*parts: object) -> str:
    """What a stage depends on, as one word: settings, what came before, the version."""
    return hashed([], __version__, *(json.dumps(part, sort_keys=True) for part in parts))
