# SPDX-License-Identifier: BSD-3-Clause
"""Volumes and labels out as NRRD, and as segmentations for 3D Slicer; the same bytes each time."""

from __future__ import annotations

import os
import zlib
from pathlib import Path

import numpy as np

from bezsoma.errors import InputError
from bezsoma.imaging.meaning import AIR, COLOURS, NAMES
from bezsoma.imaging.volume import Frame, Grid
from bezsoma.mesh.whole import write_whole

TYPES = {"uint8": "uint8", "int16": "int16", "uint16": "uint16", "float32": "float"}
"""numpy's name of a type and NRRD's."""


def write_volume(
    path: str | os.PathLike[str], values: Grid, frame: Frame, *, overwrite: bool = False
) -> None:
    """Write values (z, y, x) on a frame (LPS, mm) as .nrrd, whole or not at all; no patient."""
    place = checked_place(path, (".nrrd",), overwrite)
    whole(place, _header(values, frame, {}) + _packed(values))


def write_segmentation(
    path: str | os.PathLike[str], values: Grid, frame: Frame, *, overwrite: bool = False
) -> None:
    """Write label numbers (z, y, x) as .seg.nrrd, which 3D Slicer opens with names and colours."""
    place = checked_place(path, (".seg.nrrd",), overwrite)
    words = {"Segmentation_ContainedRepresentationNames": "Binary labelmap|"}
    present = [n for n in np.unique(values).tolist() if n != AIR and n in NAMES]
    x, y, z = values.shape[::-1]
    for segment, number in enumerate(present):
        words |= {
            f"Segment{segment}_ID": f"Segment_{number}",
            f"Segment{segment}_Name": NAMES[number],
            f"Segment{segment}_Color": " ".join(f"{c:g}" for c in COLOURS[number]),
            f"Segment{segment}_LabelValue": str(number),
            f"Segment{segment}_Layer": "0",
            f"Segment{segment}_Extent": f"0 {x - 1} 0 {y - 1} 0 {z - 1}",
        }
    whole(place, _header(values, frame, words) + _packed(values))


def _header(values: Grid, frame: Frame, words: dict[str, str]) -> bytes:
    if values.dtype.name not in TYPES or values.ndim != 3:
        raise InputError(
            f"values of type {values.dtype} in {values.ndim} dimensions cannot be written; give "
            f"three dimensions, of a type among {list(TYPES)}"
        )

    def vector(numbers: Grid) -> str:
        return "(" + ",".join(repr(float(x)) for x in numbers) + ")"

    steps = " ".join(vector(step) for step in (frame.axes * frame.spacing).T)
    lines = [
        "NRRD0005",
        f"type: {TYPES[values.dtype.name]}",
        "dimension: 3",
        "space: left-posterior-superior",
        "sizes: " + " ".join(map(str, values.shape[::-1])),
        f"space directions: {steps}",
        "kinds: domain domain domain",
        "endian: little",
        "encoding: gzip",
        f"space origin: {vector(frame.origin)}",
        *(f"{key}:={word}" for key, word in words.items()),
    ]
    return ("\n".join(lines) + "\n\n").encode()


def _packed(values: Grid) -> bytes:
    """gzip without a date, so that the same labels give the same bytes."""
    pack = zlib.compressobj(level=3, wbits=31)
    little = np.ascontiguousarray(values, values.dtype.newbyteorder("<"))
    return pack.compress(little.tobytes()) + pack.flush()


def checked_place(path: str | os.PathLike[str], endings: tuple[str, ...], overwrite: bool) -> Path:
    """The path, if a file with one of the endings may be written there."""
    place = Path(path)
    if not place.name.lower().endswith(endings):
        raise InputError(f"{path}: the name has to end in one of {', '.join(endings)}")
    if place.exists() and not overwrite:
        raise InputError(f"{path} is there already; take another name, or say overwrite=True")
    if not place.parent.is_dir():
        raise InputError(f"{path}: there is no folder {place.parent}; make it first")
    return place


def whole(place: Path, content: bytes) -> None:
    """Write a file whole or not at all; a full disk is told as such."""
    try:
        write_whole(place, lambda part: part.write_bytes(content))
    except OSError as error:
        raise InputError(f"{place} could not be written: {error.strerror or error}") from error
