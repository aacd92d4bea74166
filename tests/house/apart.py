# SPDX-License-Identifier: BSD-3-Clause
"""A Python that takes BezSoma from another folder than the one that is installed.

An editable installation goes before PYTHONPATH, so a copy of the sources that was changed on
purpose would not be seen. Without `site` (option -S) no installation is known; what is installed
beside it is put on the path by hand.
"""

from __future__ import annotations

import subprocess
import sys
import sysconfig
from pathlib import Path


def prefix(source: Path) -> list[str]:
    """The command that runs one line of Python, to be appended, with BezSoma from `source`."""
    path = [str(source), sysconfig.get_path("purelib"), sysconfig.get_path("platlib")]
    return [
        sys.executable,
        "-S",
        "-c",
        f"import sys; sys.path[:0] = {path!r}; exec(sys.argv.pop(1))",
    ]


def python_on(source: Path, line: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """What one line of Python does in a folder, with BezSoma from `source`."""
    command = [*prefix(source), line]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)


def main() -> int:
    """`python -m house.apart SOURCE ARGUMENT...`: pytest with BezSoma from `SOURCE`."""
    line = "import pytest; raise SystemExit(pytest.main(sys.argv[1:]))"
    return subprocess.run([*prefix(Path(sys.argv[1])), line, *sys.argv[2:]], check=False).returncode


if __name__ == "__main__":
    sys.exit(main())
