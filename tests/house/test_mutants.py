# SPDX-License-Identifier: BSD-3-Clause
"""The table of deliberate errors fits the sources as they are now (./dev mutants runs it)."""

from __future__ import annotations

from pathlib import Path

import pytest

import conftest
from mutants import record, table
from mutants.mutant import Mutant
from mutants.planted import piece, rounds
from mutants.workshop import PARTIAL


def test_there_are_enough_half_of_them_in_the_core() -> None:
    assert len(table.ALL) >= 100
    assert 2 * len(table.CPP) >= len(table.ALL)
    kinds = [m.is_cpp for m in table.IN_CI]
    assert kinds.count(True) >= 5 and kinds.count(False) >= 30
    assert len({record.mark(m) for m in table.ALL}) == len(table.ALL)


@pytest.mark.parametrize("mutant", table.ALL, ids=[mutant.what for mutant in table.ALL])
def test_each_stands_once_in_its_file(mutant: table.Mutant, root: Path) -> None:
    assert (root / mutant.file).read_text(encoding="utf-8").count(mutant.old) == 1
    assert mutant.old != mutant.new
    assert all((root / test.split("::")[0]).exists() for test in mutant.tests)


def test_one_build_holds_nearly_all_errors_of_the_core(root: Path) -> None:
    together = rounds(root, list(table.CPP))
    assert len(together[0]) >= len(table.CPP) - 10
    assert sum(map(len, together)) == sum(not m.compiled for m in table.CPP)


TEXTS = {
    "an index": ("    y += a[i] * b;", "a[i]", "a[0]", "    y += a[ (E ? (0) : (i))] * b;"),
    "a factor": ("x = p * (q + r);", "(q + r)", "(q - r)", "x = p * ( (E ? (q - r) : (q + r)));"),
    "a statement": ("\n  run();\n", "run();", ";", "\n  if (E) { ; } else { run(); }\n"),
    "the end of a statement": (
        "y = a +\n  b * c;",
        "b * c;",
        "b;",
        "y = (E ? (a +\n  b) : (a +\n  b * c));",
    ),
    "a statement below a remark": (
        "f(); // why\n  g();",
        "g();",
        ";",
        "f(); // why\n  if (E) { ; } else { g(); }",
    ),
    "what is declared": (
        "\n  const int n = m;",
        "n = m;",
        "n = 2;",
        "\n  const int n = (E ? (2) : (m));",
    ),
    "what is returned": ("{ return a * b; }", "a * b", "a", "{ return  (E ? (a) : (a * b)); }"),
    "an argument": ("f(a, g(b), c);", "g(b)", "g(d)", "f(a, g( (E ? (d) : (b))), c);"),
    "two arguments": ("x = f(a, b);", "a, b", "b, a", "x = (E ? (f(b, a)) : (f(a, b)));"),
    "of a template": (
        "x = f<2, n>(r);",
        "n>",
        "n - 3>",
        "x = (E ? (f<2, n - 3>(r)) : (f<2, n>(r)));",
    ),
    "a comparison": ("if (a < b && c)", "< b", "< 0", "if ( (E ? (a < 0 && c) : (a < b && c)))"),
    "a choice": ("x = a ? -b : b;", "-b", "b", "x = a ? (E ? (b) : (-b)): b;"),
}


@pytest.mark.parametrize(("text", "old", "new", "both"), TEXTS.values(), ids=TEXTS)
def test_both_texts_stand_where_one_can_be_chosen(text: str, old: str, new: str, both: str) -> None:
    begin, end, instead = piece(text, Mutant("", "x.cpp", old, new, ()), 7)
    found = text[:begin] + instead + text[end:]
    assert found == both.replace("E ", "bezsoma_error == 7 ").replace("(E)", "(bezsoma_error == 7)")


def test_a_core_without_kernels_is_excused_only_where_it_is_meant_to_be_partial(
    root: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A core for use that lacks kernels fails; the words looked for are those that it says."""
    assert conftest.LACKS_KERNELS in (root / "src/core/bindings.hpp").read_text(encoding="utf-8")
    lacks = ValueError(f"{conftest.LACKS_KERNELS} of that degree")
    other = ValueError("degree must be 1 to 10")
    assert list(PARTIAL) == [conftest.PARTIAL_CORE]
    for flags, error, outcome in (
        ({conftest.PARTIAL_CORE: ""}, lacks, ValueError),
        (PARTIAL, lacks, pytest.skip.Exception),
        (PARTIAL, other, ValueError),
    ):
        for name, value in flags.items():
            monkeypatch.setenv(name, value)
        call = conftest.pytest_runtest_call()
        next(call)
        with pytest.raises(outcome):
            call.throw(error)


def test_the_score_and_what_nothing_notices_is_argued() -> None:
    for errors in (table.CPP, table.PYTHON):
        known, noticed = record.judged(errors)
        assert noticed >= 0.9 * known
    assert [m.what for m in record.missed() if not m.argued] == []
    assert record.PAGE.read_text(encoding="utf-8") == record.page()
