# SPDX-License-Identifier: BSD-3-Clause
"""Where real data lies, and which tests are skipped for want of data or of kernels."""

from __future__ import annotations

import os
from collections.abc import Generator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings

ROOT = Path(__file__).resolve().parent.parent
DATA = Path(os.environ.get("BEZSOMA_DATA") or ROOT.parent / "shared" / "data")
NO_DATA = f"needs real data, and there is none at {DATA}: set BEZSOMA_DATA to where it lies"

PARTIAL_CORE = "BEZSOMA_PARTIAL_CORE"
"""Set by what builds a core of low degrees on purpose: tests of the others are skipped then."""
LACKS_KERNELS = "this build of the core lacks the kernels"


# The same examples in every run, so that nothing fails by chance; others are looked for by
# ./dev test --hypothesis-profile search.
settings.register_profile("house", derandomize=True, deadline=None)
settings.register_profile("search", max_examples=1000, deadline=None)
settings.load_profile("house")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Skip what needs real data where it is absent, or stop where it has to be there."""
    if DATA.is_dir():
        return
    if os.environ.get("BEZSOMA_DATA_REQUIRED"):
        raise pytest.UsageError(f"BEZSOMA_DATA_REQUIRED is set, and there is no data at {DATA}")
    for item in items:
        if item.get_closest_marker("real_data"):
            item.add_marker(pytest.mark.skip(reason=NO_DATA))


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call() -> Generator[None, Any, Any]:
    """Skip what asks for kernels that a core built to look for errors lacks.

    Only there: a core for use that lacks kernels has to fail.
    """
    try:
        return (yield)
    except ValueError as error:
        if os.environ.get(PARTIAL_CORE) and LACKS_KERNELS in str(error):
            pytest.skip(str(error))
        raise


@pytest.fixture(scope="session")
def data() -> Path:
    """The folder with the real data."""
    if not DATA.is_dir():
        pytest.skip(NO_DATA)
    return DATA


@pytest.fixture(scope="session")
def root() -> Path:
    """The folder of the project."""
    return ROOT
