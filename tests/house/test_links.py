# SPDX-License-Identifier: BSD-3-Clause
"""Links that lead out of the project: as the build has no network, their form and where they go.

Links between pages are checked when the pages are built, anchors among them (test_readme.py does
the files); what is behind an address outside, no test can see. So an address has to be https and
at a host that is on the list, and a doi as dois are.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from house import sources

ADDRESS = re.compile(r"\bhttps?://[^\s\"'<>`]+")
DOI = re.compile(r"\bdoi(?::|\.org/)\s*(10\.[^\s,;\]`\"]+)")
IS_DOI = re.compile(r"10\.\d{4,9}/[A-Za-z0-9][A-Za-z0-9._()/:<>-]+")
HOSTS = {
    "doi.org",
    "github.com",
    "hypothesis.readthedocs.io",
    "pyvista.org",
    "raw.githubusercontent.com",
    "semver.org",
    "toml.io",
}
"""Hosts that pages and sources may name; another one is a decision."""


def closed(address: str) -> str:
    """An address without what the sentence around it added.

    >>> closed("https://doi.org/10.1016/0167-8396(86)90005-1)).")
    'https://doi.org/10.1016/0167-8396(86)90005-1'
    """
    address = address.split("](")[0].rstrip(".,;:*")
    while address.endswith((")", "}")) and address.count("(") < address.count(")"):
        address = address[:-1].rstrip(".,;:")
    return address


def texts(root: Path) -> dict[str, str]:
    """All that people read: pages, and the docstrings and comments of sources and tests."""
    files = [*sources.prose(root), *sources.python(root), *sources.cpp(root), *sources.tests(root)]
    here = Path(__file__).resolve()
    return {
        str(file.relative_to(root)): file.read_text(encoding="utf-8")
        for file in files
        if file.resolve() != here
    }


def test_addresses_are_whole_and_at_known_hosts(root: Path) -> None:
    strange = [
        f"{file}: {address}"
        for file, text in texts(root).items()
        for address in map(closed, ADDRESS.findall(text))
        if not re.fullmatch(r"https://([\w.-]+)(/[\w.()/:~<>#?=&%@+-]*)?", address)
        or address.split("/")[2] not in HOSTS
    ]
    assert strange == []


def test_dois_are_dois(root: Path) -> None:
    found = [(file, closed(doi)) for file, text in texts(root).items() for doi in DOI.findall(text)]
    assert len(found) > 50
    assert [f"{file}: {doi}" for file, doi in found if not IS_DOI.fullmatch(doi)] == []


@pytest.mark.parametrize("text", ["doi:10.12/short", "doi:10.1137/", "doi.org/10.1137/a b?c|d"])
def test_what_is_no_doi_is_seen(text: str) -> None:
    assert not all(IS_DOI.fullmatch(closed(doi)) for doi in DOI.findall(text + " |"))
