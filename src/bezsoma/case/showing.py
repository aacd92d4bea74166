# SPDX-License-Identifier: BSD-3-Clause
"""Pictures and films of a results folder."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from bezsoma.case.fields import field_of
from bezsoma.errors import InputError, unknown
from bezsoma.mesh.planes import Plane
from bezsoma.results import Results, read_results
from bezsoma.view.camera import axes
from bezsoma.view.film import ENDINGS, film
from bezsoma.view.picture import page
from bezsoma.view.shot import Shot
from bezsoma.view.written import vacant, written

ORIGINAL = "original"
_ALONG = ("left", "front", "top")
"""From where a slice x=.., y=.. and z=.. is looked at unless a view is named."""


def results_picture(
    path: str | Path | None,
    results: Results | Path | str,
    *,
    field: str | None = "displacement",
    view: str | None = None,
    plane: Plane | str | None = None,
    over: str | None = None,
    title: str | None = None,
    size: tuple[int, int] = (1000, 900),
    overwrite: bool = False,
    **how: object,
) -> bytes:
    """A picture of a results folder as PNG, moved as it came out; written if a path is given.

    `field` is one of `FIELDS`, or None for a plain surface; `over="original"` draws the mesh
    before the move over it. Without a view, a slice is looked at along its axis. Further words,
    as `translucent`, `surface`, `net`, `wires`, `carried`, `magnified` and `limits`, are those of
    `picture`.
    """
    if path is not None:
        vacant(path, overwrite, ".png")
    view = view_of(plane) if view is None else view
    axes(view)
    if over not in (None, ORIGINAL):
        raise InputError(unknown("mesh to draw over it", over, [ORIGINAL], "results"))
    read = _read(results)
    shot = shot_of(read, field, plane=plane, before=over == ORIGINAL, **how)
    title = _title(read, title)
    content = page([shot], view, title, size, "results_picture(path, results)")
    if path is not None:
        written(path, content, overwrite)
    return content


def results_film(
    path: str | Path | None,
    results: Results | Path | str,
    *,
    field: str | None = None,
    view: str = "three-quarter",
    turn: float = 360.0,
    frames: int = 36,
    seconds: float = 4.5,
    title: str | None = None,
    size: tuple[int, int] = (520, 560),
    overwrite: bool = False,
    progress: Callable[[int, int], None] | None = None,
    **how: object,
) -> bytes:
    """A film of the movement in a results folder, GIF or MP4; written if a path is given.

    See `film`; `field` is one of `FIELDS`, or None for a plain surface.
    """
    if path is not None:
        vacant(path, overwrite, *ENDINGS)
    read = _read(results)
    return film(
        path,
        shot_of(read, field, **how),
        view=view,
        turn=turn,
        frames=frames,
        seconds=seconds,
        title=_title(read, title),
        size=size,
        overwrite=overwrite,
        progress=progress,
    )


def shot_of(results: Results, field: str | None, **how: object) -> Shot:
    """The moved body of some results, its skin where it has one, coloured by a field."""
    words = dict(how)
    if words.get("surface") is None and words.get("translucent") is None:
        words["surface"] = "skin" if "skin" in results.mesh.surfaces else None
    if field is not None:
        shown = field_of(results, field)
        words |= {"colour": shown.field, "measure": shown.measure, "label": shown.label}
    words = {"displacement": results.displacement, **words}
    unheard = sorted(set(words) - set(Shot.__dataclass_fields__))
    if unheard:
        raise InputError(unknown("word", unheard[0], Shot.__dataclass_fields__, "a picture"))
    return Shot(results.mesh, **words)  # type: ignore[arg-type]


def view_of(plane: Plane | str | None) -> str:
    """From where to look: along the axis of a slice, else three-quarter.

    >>> view_of("x=12"), view_of("z=0"), view_of(None)
    ('left', 'top', 'three-quarter')
    """
    if plane is None:
        return "three-quarter"
    return _ALONG[int(np.abs(Plane.of(plane).normal).argmax())]


def _title(results: Results, given: str | None) -> str:
    """The title given, or that of the results; a state that is no answer is marked in any case."""
    if given is None:
        return str(results.summary["title"])
    return f"{results.unfinished}: {given}" if results.unfinished else given


def _read(results: Results | Path | str) -> Results:
    return results if isinstance(results, Results) else read_results(results)
