# SPDX-License-Identifier: BSD-3-Clause
"""What an installation of BezSoma brings with it, and under which licences, as it says itself."""

from __future__ import annotations

import re
from importlib.metadata import distribution, metadata

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

PERMISSIVE = re.compile(r"\b(BSD|MIT|Apache|PSF|Python Software|ISC|HPND|0BSD|Zlib|MPL-2\.0)")
RECIPROCAL = re.compile(r"\bA?L?GPL")
BY_TEXT = {"Redistribution and use in source and binary forms": "BSD"}
"""Some give the text of their licence in place of its name."""


def needed(package: str, extra: str = "") -> list[str]:
    """The packages that one needs here, those that they need among them, in order."""
    found: set[str] = set()
    ahead = [(package, {extra, ""})]
    while ahead:
        for name, extras in wanted(*ahead.pop()):
            if name not in found:
                found.add(name)
                ahead.append((name, extras))
    return sorted(found)


def wanted(package: str, extras: set[str]) -> list[tuple[str, set[str]]]:
    """What a package itself asks for, on this system and for this Python."""
    asked = [Requirement(line) for line in distribution(package).requires or []]
    return [
        (canonicalize_name(each.name), {"", *each.extras})
        for each in asked
        if each.marker is None or any(each.marker.evaluate({"extra": e}) for e in extras)
    ]


def licence(name: str) -> str:
    """What a package says its licence is: an expression, else its classifiers, else its text."""
    said = metadata(name)
    kinds = [kind for kind in said.get_all("Classifier") or [] if kind.startswith("License ::")]
    named = [kind.rsplit(":: ", 1)[1] for kind in kinds]
    text: str = (said.get("License") or "").strip()
    by_text = [known for words, known in BY_TEXT.items() if words in " ".join(text.split())]
    first = text.split("\n")[0]
    return said.get("License-Expression") or " or ".join(named or by_text) or first or "unknown"


def is_permissive(said: str) -> bool:
    """Whether a licence asks for no more than its notice.

    >>> is_permissive("BSD-3-Clause AND 0BSD"), is_permissive("GPL-3.0-or-later")
    (True, False)
    """
    return bool(PERMISSIVE.search(said)) and not RECIPROCAL.search(said)


def page() -> str:
    """The page of licences."""
    plain = needed("bezsoma")
    rows = [
        f"| {name} | {metadata(name)['Version']} | {'' if name in plain else '`imaging`'} | "
        f"{licence(name)} |"
        for name in needed("bezsoma", "imaging")
    ]
    return HEAD + "\n".join([*rows, ""])


HEAD = """# Licences

What `pip install bezsoma` brings, with all that these packages need in their turn, and its extra
`imaging`: read from what was installed when this page was built, as each package says itself.
BezSoma is BSD-3-Clause. A test holds every licence to be a permissive one. The same, for
machines, is the bill of materials, `dist/bezsoma.cdx.json`, that `./dev build` makes.

| package | version | only with | licence |
|---|---|---|---|
"""
