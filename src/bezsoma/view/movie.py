# SPDX-License-Identifier: BSD-3-Clause
"""A film as an MP4 file, H.264, through PyAV (the extra `film`), which brings its encoder along."""

from __future__ import annotations

import io
from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import numpy as np

from bezsoma import __version__
from bezsoma.errors import MissingExtra
from bezsoma.view.sheet import NOTICE, Bytes

_QUALITY = "18"
"""The constant rate factor of the encoder: from 18 down no loss is seen."""


def encoder() -> Any:
    """The package that encodes; refused, before any work, where it is not installed."""
    try:
        import av
    except ImportError as error:
        raise MissingExtra(
            "MP4 films need the extra `film`, which is not installed here: python -m pip install "
            "'bezsoma[film]'; GIF films need nothing"
        ) from error
    return av


def mp4(frames: Sequence[Bytes], seconds: float) -> bytes:
    """Frames (h, w, 3), each shown for so many seconds, as the bytes of an MP4 file.

    Colours are stored at half the resolution (4:2:0), as all players want it; and its sides are
    even then, so an odd one has its last row or column twice.
    """
    av = encoder()
    stream = io.BytesIO()
    rate = 1 / Fraction(seconds).limit_denominator(1000)
    with av.open(stream, "w", format="mp4") as file:
        file.metadata["comment"] = f"bezsoma {__version__}. {NOTICE}"
        track = file.add_stream("libx264", rate=rate, options={"crf": _QUALITY, "threads": "1"})
        track.pix_fmt = "yuv420p"
        images = [even(frame) for frame in frames]
        track.height, track.width = images[0].shape[:2]
        for image in images:
            file.mux(track.encode(av.VideoFrame.from_ndarray(image, format="rgb24")))
        file.mux(track.encode())
    return stream.getvalue()


def even(frame: Bytes) -> Bytes:
    """The frame with sides of an even number of pixels.

    >>> even(np.zeros((3, 4, 3), np.uint8)).shape
    (4, 4, 3)
    """
    height, width = frame.shape[:2]
    return np.pad(frame, ((0, height % 2), (0, width % 2), (0, 0)), mode="edge")
