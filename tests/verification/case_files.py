# SPDX-License-Identifier: BSD-3-Clause
"""The case files of `cases/verification`, at the degree that each states."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

import bezsoma as bz
from verification.problem import PUBLISHED, Family, Value

FOLDER = Path(__file__).resolve().parents[2] / "cases" / "verification"
FAMILY = Family(
    "case_files", "Problems as a user states them: `bezsoma run cases/verification/NAME.toml`."
)


def expected(path: Path) -> Iterator[Value]:
    case = bz.read_case(path)
    with TemporaryDirectory() as folder:
        summary = bz.run_case(case, Path(folder) / "out").summary
    where = f"degree {case.file.degree}, {summary['sizes']['tets']} tets"
    for check in summary["expectations"]:
        low, high = check["between"]
        middle, half = (low + high) / 2, (high - low) / 2
        slack = half / abs(middle) if middle else half
        yield Value(check["of"], where, check["found"], middle, slack * (1 + 1e-9))


for path in sorted(FOLDER.glob("*.toml")):
    case = bz.read_case(path)
    sources = dict.fromkeys(expect.source for expect in case.file.expect)
    FAMILY.add(
        f"{path.stem}: {case.file.title}", PUBLISHED, "; ".join(sources),
        f"cases/verification/{path.name}",
        "stated in the case, with the number", expected, path,
    )  # fmt: skip
