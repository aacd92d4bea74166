# SPDX-License-Identifier: BSD-3-Clause
"""The last state in balance of a case that came to no answer: kept, and marked as no answer."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

from bezsoma.case.reading import Case
from bezsoma.case.writing import write_results
from bezsoma.errors import InputError, NotConverged
from bezsoma.results import Destination
from bezsoma.solvers.solution import Solution

Progress = Callable[[str, float | None, str], None]

HOW = (
    "; to look at the last state in balance, run again with --keep-last FOLDER (keep_last= of "
    "run_case), which writes it there, marked as no answer"
)


def no_answer(fraction: float) -> str:
    """What stands first wherever such a state is shown.

    >>> no_answer(0.8125)
    'NOT THE ANSWER (81.25 % of the load)'
    """
    return f"NOT THE ANSWER ({100 * fraction:.4g} % of the load)"


def of_keep_last(refusal: InputError) -> str:
    """What a refusal of the folder says, which `--keep-last` names and not `-o`.

    >>> of_keep_last(InputError("results stand there; choose another folder with -o"))
    'results stand there; choose another folder with --keep-last'
    """
    return str(refusal).replace("another folder with -o", "another folder with --keep-last")


@contextmanager
def keeping_last(
    case: Case,
    place: Destination | None,
    summary: Callable[[Case, Solution], dict[str, Any]],
    progress: Progress,
) -> Iterator[None]:
    """Where no answer is found inside, leave the last state in balance at a place, if one is given.

    `summary` is what summary.json says of a case and its solution. The error goes on, and says
    where the state is, or how to have it.
    """
    try:
        yield
    except NotConverged as failure:
        said = str(failure)
        if failure.last is None or not failure.fraction > 0:
            said += "" if place is None else "; nothing under load was in balance, and none is kept"
        elif place is None:
            said += HOW
        else:
            said += _kept(case, place, failure, summary, progress)
        raise NotConverged(
            said,
            failure.history,
            last=failure.last,
            fraction=failure.fraction,
            path=failure.path,
        ) from failure


def _kept(
    case: Case,
    place: Destination,
    failure: NotConverged,
    summary: Callable[[Case, Solution], dict[str, Any]],
    progress: Progress,
) -> str:
    """What to say once the state is written."""
    mark = no_answer(failure.fraction)
    marked = _marked(case, mark)
    told = summary(marked, failure.last)
    told["unfinished"] = {"mark": mark, "fraction": failure.fraction, "why": str(failure)}
    told["warnings"].insert(0, f"this is not the answer but the last state in balance: {failure}")
    told["error"] = {"left_out": "it would be that of no answer"}
    try:
        with place.filling() as partial:
            write_results(partial, marked, failure.last, told, progress)
    except InputError as trouble:
        return f"; the last state in balance could not be kept: {of_keep_last(trouble)}"
    return f"; the last state in balance is in {str(place.folder)!r}, marked as no answer"


def _marked(case: Case, mark: str) -> Case:
    """The case with the mark before its title, and without what it expects of an answer."""
    changed = {"title": f"{mark}: {case.title}", "expect": []}
    return replace(case, file=case.file.model_copy(update=changed))
