# SPDX-License-Identifier: BSD-3-Clause
"""A short film of a movement, as GIF or MP4: to and fro, while the viewer walks around."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from bezsoma.errors import InputError
from bezsoma.view.camera import Camera, around, axes, turned
from bezsoma.view.layout import Layout
from bezsoma.view.movie import encoder, mp4
from bezsoma.view.picture import page_size, place_given
from bezsoma.view.sheet import Bar, Bytes, gif, pixels, sheet
from bezsoma.view.shot import Shot, bar_of, panel
from bezsoma.view.written import written

ENDINGS = (".gif", ".mp4")
MOST_FRAMES = 240
_SWINGS = 2
"""So often the movement is shown while the viewer walks once around."""


def film(
    path: str | Path | None,
    shot: Shot,
    *,
    view: str = "three-quarter",
    turn: float = 360.0,
    frames: int = 36,
    seconds: float = 4.5,
    title: str = "",
    size: tuple[int, int] = (520, 560),
    overwrite: bool = False,
    progress: Callable[[int, int], None] | None = None,
) -> bytes:
    """The movement of a shot as the bytes of a film; written if a path is given.

    A path that ends in .mp4 asks for an MP4 (H.264), which needs the extra `film`; any other is an
    animated GIF without end, of 256 colours.

    The displacement grows from nothing to what the shot says and back, twice, while the viewer
    walks once around from `view`; with a `turn` of less than 360 degrees to and fro by so much,
    with 0 not at all. A caption says how much of the movement each frame shows. All frames have
    one scale and one range of colours, that of the full movement.

    >>> from bezsoma.mesh import ControlNet, Field, block
    >>> mesh = block((20.0, 10.0, 10.0), (2, 1, 1))
    >>> bent = Field.interpolating(ControlNet(mesh, 2), lambda x: x**2 / 40)
    >>> film(None, Shot(mesh, displacement=bent), frames=2, size=(240, 240))[:6]
    b'GIF89a'
    """
    shot = shot.checked("film(path, shot)")
    _check(shot, turn, frames, seconds)
    place_given(path, overwrite, "film(path, shot)", *ENDINGS)
    encoded = gif
    if path is not None and str(path).lower().endswith(".mp4"):
        encoder()  # its absence is told before any work
        encoded = mp4
    layout = Layout(page_size(size), 1, 1, bool(title), shot.colour is not None)
    cameras = around(
        [turned(axes(view), angle) for angle in angles(turn, frames)],
        shot.subject.points(),
        layout.panel,
    )
    for camera in cameras:
        shot.section(camera)  # a plane must show its face from everywhere
    scale = _scale(shot, cameras)
    shown = []
    for number, (camera, share) in enumerate(zip(cameras, shares(frames), strict=True)):
        if progress is not None:
            progress(number, frames)
        shown.append(_frame(shot, share, camera, layout, title, scale))
    content = encoded(shown, seconds / frames)
    if path is not None:
        written(path, content, overwrite)
    return content


def shares(frames: int) -> list[float]:
    """How much of the movement each frame shows, from 0 to 1 and back, twice.

    >>> [round(share, 3) for share in shares(8)]
    [0.0, 0.5, 1.0, 0.5, 0.0, 0.5, 1.0, 0.5]
    """
    phase = 2 * np.pi * _SWINGS * np.arange(frames) / frames
    return [float(share) for share in (1 - np.cos(phase)) / 2]


def angles(turn: float, frames: int) -> list[float]:
    """Where the viewer stands in each frame, in degrees from the view.

    >>> angles(360.0, 4), [round(angle) for angle in angles(60.0, 4)]
    ([0.0, 90.0, 180.0, 270.0], [0, 30, 0, -30])
    """
    part = np.arange(frames) / frames
    if abs(turn) == 360.0:
        return [float(turn * each) for each in part]
    return [float(turn / 2 * np.sin(2 * np.pi * each)) for each in part]


def _check(shot: Shot, turn: float, frames: int, seconds: float) -> None:
    if shot.displacement is None:
        raise InputError("film(path, shot): nothing moves; give the shot a displacement")
    if not 2 <= frames <= MOST_FRAMES:
        raise InputError(f"a film of {frames} frames was asked for; give 2 to {MOST_FRAMES}")
    if not 0.02 * frames <= seconds <= 60:
        raise InputError(
            f"{frames} frames in {seconds:g} s cannot be shown; a frame takes 0.02 s or more, and "
            "a film a minute at most"
        )
    if not abs(turn) <= 360:
        raise InputError(f"a turn of {turn:g} degrees was asked for; give -360 to 360")


def _scale(shot: Shot, cameras: Sequence[Camera]) -> Bar | None:
    """The colour bar of the full movement, seen from where the film begins."""
    return None if shot.colour is None else bar_of([shot], [shot.seen(cameras[0])])


def _frame(
    shot: Shot, share: float, camera: Camera, layout: Layout, title: str, scale: Bar | None
) -> Bytes:
    """One frame (h, w, 3), 0 to 255."""
    part = replace(shot, magnified=share * shot.magnified)
    caption = f"{100 * share * shot.magnified:.0f} % of the movement"
    shown = panel(part, part.seen(camera), camera, caption, scale)
    return pixels(sheet([shown], layout, title))
