# SPDX-License-Identifier: BSD-3-Clause
"""How many lines the tests run: ./dev coverage.

Of Python by the whole suite; of the core by the tests that work it hardest, with a core of its own
that counts: one set of kernels, of low degrees. Both are lines that some test *runs*; whether a
test would notice that they are wrong is what the deliberate errors tell.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from house.apart import prefix
from mutants.workshop import PARTIAL, UP_TO, Workshop

PROJECT = Path(__file__).resolve().parents[2]
OF_PYTHON, OF_THE_CORE = 95, 90
"""Per cent, at least."""
CORE_TESTS = (
    "tests/laws/test_assembled.py",
    "tests/laws/test_cholesky.py",
    "tests/laws/test_control_net.py",
    "tests/laws/test_element.py",
    "tests/laws/test_laws_core.py",
    "tests/laws/test_levels.py",
    "tests/laws/test_matrix_free.py",
    "tests/laws/test_mesh_shape.py",
    "tests/laws/test_mesh_tets.py",
    "tests/laws/test_mixed_free.py",
    "tests/laws/test_multigrid.py",
    "tests/laws/test_pickles.py",
    "tests/laws/test_pointwise_free.py",
    "tests/faults/test_core.py",
    "tests/faults/test_hard_problems.py",
    "tests/faults/test_meshes.py",
    "tests/paper/test_equations.py",
)


def main() -> int:
    """Measure what is asked for; the status is 0 if it is enough."""
    parser = argparse.ArgumentParser(prog="./dev coverage", description=__doc__)
    parser.add_argument("part", nargs="?", choices=("python", "core"), help="one of the two")
    parser.add_argument("--jobs", default=str(min(8, os.cpu_count() or 1)), help="how many at once")
    options = parser.parse_args()
    parts = {"python": python, "core": core}
    chosen = [options.part] if options.part else list(parts)
    return max(parts[part](options.jobs) for part in chosen)


def python(jobs: str) -> int:
    """Lines of Python, by the whole suite and what it starts.

    One folder of tests after the other, and then all that was counted together: a run that ends
    before its time has lost one of them.
    """
    own = {name: "1" for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS")}
    if sys.version_info >= (3, 12):
        own["COVERAGE_CORE"] = "sysmon"  # counts at nearly no cost; by itself only from 3.14 on
    count = [sys.executable, "-m", "pytest", "-q", "-n", jobs, "--dist", "worksteal"]
    statuses = []
    with tempfile.TemporaryDirectory(prefix="bezsoma-covered-") as scratch:
        for number, part in enumerate(parts()):
            own["COVERAGE_FILE"] = f"{scratch}/.coverage.{number}"
            command = [*count, "--cov", "--cov-report=", part]
            print(f"{part}:", flush=True)
            done = subprocess.run(command, cwd=PROJECT, env=os.environ | own, check=False)
            statuses.append(done.returncode)
        tool = [sys.executable, "-m", "coverage"]
        subprocess.run([*tool, "combine", "--quiet", scratch], cwd=PROJECT, check=True)
    report = ["report", "--show-missing", "--skip-covered", f"--fail-under={OF_PYTHON}"]
    statuses.append(subprocess.run([*tool, *report], cwd=PROJECT, check=False).returncode)
    return max(statuses)


def parts() -> list[str]:
    """The folders that have tests, and the package for what its docstrings state."""
    folders = {file.parent for file in (PROJECT / "tests").rglob("test_*.py")}
    return [*sorted(str(each.relative_to(PROJECT)) for each in folders), "src/bezsoma"]


def core(jobs: str) -> int:
    """Lines of the core."""
    with tempfile.TemporaryDirectory(prefix="bezsoma-covered-") as scratch:
        shop = Workshop(PROJECT, Path(scratch))
        shop.configure(
            f"-DBEZSOMA_KERNEL_OPTIONS=-O1;{UP_TO}",
            "-DCMAKE_CXX_FLAGS=--coverage -fprofile-update=atomic",
            "-DCMAKE_CXX_FLAGS_RELEASE=",
        )
        shop.make()
        line = "import pytest; raise SystemExit(pytest.main(sys.argv[1:]))"
        tests = [*prefix(shop.folder / "src"), line, "-q", "-p", "no:cacheprovider", *CORE_TESTS]
        own = os.environ | PARTIAL
        status = subprocess.run(tests, cwd=shop.folder, env=own, check=False).returncode
        report = ["--fail-under-line", str(OF_THE_CORE), "--sort", "uncovered-percent"]
        where = ["--root", str(shop.folder), "--filter", "src/core/", str(shop.build)]
        command = [sys.executable, "-m", "gcovr", "-j", jobs, *report, *where]
        return max(status, subprocess.run(command, cwd=shop.folder, check=False).returncode)


if __name__ == "__main__":
    sys.exit(main())
