# SPDX-License-Identifier: BSD-3-Clause
"""All that can be chosen on the way from a CT to a model, and the TOML file that chooses it."""

from __future__ import annotations

import json
import tomllib
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any

import numpy as np

from bezsoma.errors import InputError, unknown
from bezsoma.imaging.domain import DomainSettings
from bezsoma.imaging.settings import LabelSettings
from bezsoma.imaging.tetrahedra import Sizes

KINDS = {"labels": LabelSettings, "domain": DomainSettings, "sizes": Sizes}
"""The tables of a file of settings; `[model]` holds the rest."""
FORMS: dict[str, str] = {
    "bool": "true or false", "int": "a whole number", "float": "a number",
    "str": "a word in quotes", "Literal": "a word in quotes", "Point": "three numbers",
    "Corner": "three numbers, nan where it is found by itself", "tuple": "two numbers",
}  # fmt: skip
"""What a value has to be, by the word that its type begins with."""


@dataclass(frozen=True)
class ModelSettings:
    """Settings of every stage; lengths mm."""

    labels: LabelSettings = field(default_factory=LabelSettings)
    domain: DomainSettings = field(default_factory=DomainSettings)
    sizes: Sizes = field(default_factory=Sizes)
    tets: int | None = 80_000
    """About how many tets: all `sizes` are scaled alike until it is so. None: as they stand."""
    forward: float = 5.0
    """mm by which the case moves the mandible."""
    degree: int = 3
    """Of the displacement in the case."""
    series: str | None = None
    """Which series of a DICOM folder: its UID, its number, or what it is called."""
    interpolate: bool = False
    """Whether slices that a series lacks are filled in between their neighbours."""
    hounsfield: tuple[float, float] | None = None
    """Slope and intercept by which stored values that are none become HU."""

    def __post_init__(self) -> None:
        if self.tets is not None and not 1000 <= self.tets <= 3_000_000:
            raise InputError(f"tets={self.tets}: 1000 to 3000000 can be made")
        if not (np.isfinite(self.forward) and abs(self.forward) <= 50):
            raise InputError(f"forward={self.forward}: at most 50 mm")
        if not 1 <= self.degree <= 10:
            raise InputError(f"degree={self.degree}: 1 to 10")
        if self.hounsfield is not None and not (
            np.isfinite(self.hounsfield).all() and self.hounsfield[0] > 0
        ):
            raise InputError(
                f"hounsfield={self.hounsfield}: a positive slope and an intercept are needed"
            )

    def stated(self) -> dict[str, dict[str, object]]:
        """Every table with all its names and values."""
        tables = {name: getattr(self, name).stated() for name in KINDS}
        own = [each.name for each in fields(self) if each.name not in KINDS]
        return {**tables, "model": {name: getattr(self, name) for name in own}}


def read_settings(path: Path | str) -> ModelSettings:
    """Settings from a TOML file with tables [labels], [domain], [sizes] and [model].

    What is not said keeps its default; nan stands for what is found by itself (a plane, a number).
    """
    place = Path(path)
    try:
        tables = tomllib.loads(place.read_text(encoding="utf-8-sig"))  # a mark at its head is none
    except FileNotFoundError:
        raise InputError(
            f"no file of settings {str(path)!r}; give a .toml file, or leave it out"
        ) from None
    except RecursionError:
        raise InputError(
            f"{place.name}: arrays or tables are nested too deep; no setting needs more than one"
        ) from None
    except (OSError, ValueError) as error:  # also of bytes, and of numbers too long to be read
        raise InputError(f"{place.name}: this is not readable TOML: {error}") from None
    try:
        return _settings(tables)
    except InputError as error:
        raise InputError(f"{place.name}: {error}") from None


def _settings(tables: dict[str, Any]) -> ModelSettings:
    known = (*KINDS, "model")
    for name, table in tables.items():
        if name not in known:
            raise InputError(unknown("table", name, known, "a file of settings"))
        if not isinstance(table, dict):
            raise InputError(f"{name} is a table: write [{name}], and its keys below")
    made = {name: _made(kind, tables.get(name, {}), name) for name, kind in KINDS.items()}
    own = [f.name for f in fields(ModelSettings) if f.name not in KINDS]
    return _made(ModelSettings, tables.get("model", {}), "model", own, made)  # type: ignore[no-any-return]


def _made(
    kind: Any, table: dict[str, Any], name: str, own: list[str] | None = None, more: Any = None
) -> Any:
    names = [f.name for f in fields(kind)] if own is None else own
    for key in table:
        if key not in names:
            raise InputError(f"[{name}] {unknown('key', key, names, 'this table')}")
    types = {f.name: str(f.type) for f in fields(kind)}
    for key, value in table.items():
        _check_within(f"[{name}] {key}", value)
    values = {key: _value(value) for key, value in table.items()}
    for key, value in values.items():
        if not (_fits(types[key], value) or (value is None and "None" in types[key])):
            form = FORMS[_form(types[key])]
            raise InputError(f"[{name}] {key} = {table[key]!r}: say {form}")
    return kind(**values, **(more or {}))


def _form(type_: str) -> str:
    return next(form for form in FORMS if type_.startswith(form))


def _fits(type_: str, value: Any) -> bool:
    """Whether a value is of a type, which is named as in the classes of settings."""
    number = isinstance(value, int | float) and not isinstance(value, bool)
    form = _form(type_)
    if form in ("Point", "Corner", "tuple"):
        several = isinstance(value, tuple) and len(value) == (2 if form == "tuple" else 3)
        return several and all(_fits("float", x) or (x is None and form == "Corner") for x in value)
    if form in ("bool", "str", "Literal"):
        return isinstance(value, bool if form == "bool" else str)
    return number and (form == "float" or isinstance(value, int))


def _check_within(key: str, value: Any) -> None:
    """Refuses whole numbers longer than TOML promises, and lists in lists."""
    for each in value if isinstance(value, list) else [value]:
        if isinstance(each, int) and not -(2**63) <= each < 2**63:
            raise InputError(f"{key}: a whole number of more than 64 bits can be no setting")
        if isinstance(each, list | dict):
            raise InputError(f"{key}: no setting holds lists or tables in a list")


def _value(value: Any) -> Any:
    """TOML has lists where settings hold tuples, and nan where they hold None."""
    if isinstance(value, list):
        return tuple(_value(each) for each in value)
    return None if isinstance(value, float) and np.isnan(value) else value


def written(settings: ModelSettings) -> str:
    """The settings as a TOML file that `read_settings` reads again.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     place = Path(folder) / "model.toml"
    ...     _ = place.write_text(written(ModelSettings(tets=5000)))
    ...     read_settings(place) == ModelSettings(tets=5000)
    True
    """
    lines = ["# Settings of a model; nan stands for what is found by itself. mm, HU, LPS."]
    for name, table in settings.stated().items():
        lines += ["", f"[{name}]"]
        lines += [f"{key} = {_text(value)}" for key, value in table.items()]
    return "\n".join(lines) + "\n"


def _text(value: object) -> str:
    if isinstance(value, tuple):
        return "[" + ", ".join(_text(each) for each in value) + "]"
    if isinstance(value, bool):
        return str(value).lower()
    if value is None:
        return "nan"
    return _quoted(value) if isinstance(value, str) else repr(value)


def _quoted(word: str) -> str:
    r"""A basic string of TOML: what JSON escapes, and the one more character that TOML does.

    >>> print(_quoted('a "b" \\ c'))
    "a \"b\" \\ c"
    """
    return json.dumps(word, ensure_ascii=False).replace("\x7f", "\\u007f")
