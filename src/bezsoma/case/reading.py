# SPDX-License-Identifier: BSD-3-Clause
"""From the text of a case file to a checked `Case`; all that is wrong is said in one go."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path

from pydantic import ValidationError

from bezsoma.case.faults import Fault, faults, report
from bezsoma.case.lines import lines_of
from bezsoma.case.schema import CaseFile, Probe
from bezsoma.errors import InputError

QUANTITIES = ("energy", "volume_change", "largest_displacement", "reaction", "moment")
"""Words that begin the name of another quantity, so that no probe may bear them."""


@dataclass(frozen=True)
class Case:
    """A case file that was read and found sound, its mesh not yet looked at."""

    path: Path
    """Where the file stands; paths inside it are relative to its folder."""
    text: str
    """The file as it is, comments and all."""
    file: CaseFile
    """Its tables; lengths mm, moduli MPa, angles degrees."""

    @property
    def title(self) -> str:
        """What the case calls itself, or else the name of its file."""
        return self.file.title or self.path.stem

    def refuse(self, found: list[Fault]) -> None:
        """Raise one InputError that lists the faults, if there are any."""
        if found:
            raise InputError(report(self.path.name, lines_of(self.text), found))


def read_case(path: Path | str) -> Case:
    """The case in a TOML file, checked but for what needs its mesh.

    Every fault is one line of the message, with the key's place in the file and the nearest right
    word: `case.toml: support.[1].translatoin: unknown key (did you mean 'translation'?), line 12`.
    """
    path = Path(path)
    return case_from(path, _text(path))


def case_from(path: Path, text: str) -> Case:
    """The case in a text, as if it stood in the file `path`."""
    try:
        tables = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{path.name}: this is not TOML: {error}") from None
    try:
        case = Case(path, text, CaseFile.model_validate(tables))
    except ValidationError as error:
        found = faults(error, tables)
        raise InputError(report(path.name, lines_of(text), found)) from None
    case.refuse(_repeated(case.file.probe))
    return case


def _text(path: Path) -> str:
    """The file's text, which TOML wants in UTF-8."""
    try:
        return path.read_bytes().decode("utf-8")
    except FileNotFoundError:
        raise InputError(_absent(path)) from None
    except IsADirectoryError:
        raise InputError(f"{str(path)!r} is a folder; give the case file itself") from None
    except UnicodeDecodeError as error:
        raise InputError(
            f"{path.name}: byte {error.start} is not UTF-8, which TOML files are written in; save "
            "the file as UTF-8, and give a .toml file rather than a mesh"
        ) from None
    except OSError as error:
        raise InputError(f"cannot read the case {str(path)!r}: {error.strerror}") from None


def _absent(path: Path) -> str:
    """The sentence for a case that is not there, with the cases that are."""
    if not path.parent.is_dir():
        return f"no case {str(path)!r}: the folder {str(path.parent)!r} does not exist"
    there = sorted(each.name for each in path.parent.glob("*.toml"))
    return f"no case {str(path)!r}; the .toml files in that folder are {there or 'none'}"


def _repeated(probes: list[Probe]) -> list[Fault]:
    """Probes whose name another has, or which is the name of another quantity."""
    found, seen = [], set()
    for number, probe in enumerate(probes):
        if probe.name in seen:
            why = f"{probe.name!r} names a probe above; give each a name of its own"
            found.append(Fault(("probe", number, "name"), why))
        if probe.name in QUANTITIES:
            why = f"{probe.name!r} means a quantity of the whole body; take another name"
            found.append(Fault(("probe", number, "name"), why))
        seen.add(probe.name)
    return found
