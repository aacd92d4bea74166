# SPDX-License-Identifier: BSD-3-Clause
"""CT volumes and segmentations from files, checked and brought to LPS, mm and HU."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from bezsoma.errors import InputError
from bezsoma.imaging.child import Child
from bezsoma.imaging.dicom import read_series, series_in
from bezsoma.imaging.volume import Frame, Grid, Volume

FORMATS = {
    ".nrrd": "NrrdImageIO",
    ".nhdr": "NrrdImageIO",
    ".nii": "NiftiImageIO",
    ".nii.gz": "NiftiImageIO",
    ".mha": "MetaImageIO",
    ".mhd": "MetaImageIO",
}
"""Endings, and who reads them."""
MOST_VOXELS = 1 << 29
"""More than 800 cubed is no CT of a head."""
LONGEST = 2500.0
"""mm; a picture longer than a tall person is not in mm."""
SHORTEST = 20.0
"""mm; a picture thinner than this shows no head, or is in other units."""
STATED = (
    "hounsfield = [slope, intercept] in [model] of the settings, hounsfield=(slope, intercept) in "
    "Python"
)
"""Where a person says what stored values are."""
AIR, LEAST, MOST = -500, -1024, 30_000
"""HU: what air is below; values below LEAST are padding; beyond MOST they are none."""


@dataclass(frozen=True, eq=False)
class Segmentation:
    """Masks (z, y, x) by name on a frame, as somebody drew them; segments may overlap."""

    masks: Mapping[str, Grid]
    frame: Frame


def read_volume(
    path: str | os.PathLike[str],
    *,
    series: str | None = None,
    interpolate: bool = False,
    hounsfield: tuple[float, float] | None = None,
    child: Child | None = None,
) -> Volume:
    """A CT as int16 HU (z, y, x) in LPS and mm, from a DICOM folder or a .nrrd, .nii or .mha file.

    Axes are exchanged and turned over, without loss, until x runs most to the patient's left, y to
    posterior and z to superior; an oblique grid stays oblique. `series` chooses among several of
    a folder. `interpolate` fills gaps of missing slices. `hounsfield` says slope and intercept
    (HU = slope * value + intercept) for values that are none, such as 8-bit pictures.

    `Volume.notes` say what had to be changed. No name, number or date of a patient is read.
    Reading happens in a process of its own (`child`, to share one between many files).
    """
    place = readable(path)
    with _reader(child) as reader:
        if place.is_dir():
            volume = read_series(place, reader, series, interpolate)
        else:
            if series is not None:
                raise InputError(
                    f"{path} is one file, and series= chooses within a DICOM folder; leave it out"
                )
            answer, values = reader.answer(
                str(path), what="image", path=str(place), io=_io(place), most=MOST_VOXELS,
                layers=False,
            )  # fmt: skip
            frame = _frame(path, answer)
            volume = Volume(_scalars(path, answer, values, hounsfield), frame)
    try:
        _check_size(volume)
        return _in_hounsfield(volume.along_lps(), hounsfield)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None


def dicom_series(folder: str | os.PathLike[str]) -> list[str]:
    """What series a folder holds: UID, number of slices, modality, and what it is called."""
    place = readable(folder)
    if not place.is_dir():
        raise InputError(f"{folder} is a file; a folder of DICOM slices is needed")
    with Child() as reader:
        return [str(found) for found in series_in(place, reader)[0]]


def read_segmentation(
    path: str | os.PathLike[str],
    names: Mapping[int, str] | None = None,
    *,
    child: Child | None = None,
) -> Segmentation:
    """Masks by name from a label map or a 3D Slicer segmentation (.seg.nrrd), in LPS and mm.

    Slicer's names are taken from the file; `names` gives or changes those of numbers. Numbers that
    nobody names become "label 7". Segments of several layers may overlap and stay apart.
    """
    place = readable(path)
    with _reader(child) as reader:
        answer, values = reader.answer(
            str(path), what="image", path=str(place), io=_io(place), most=MOST_VOXELS, layers=True
        )
    frame = _frame(path, answer)
    if values is None or values.dtype.kind not in "iu":
        raise InputError(
            f"{path}: a label map holds whole numbers in three dimensions; this is "
            f"{answer['dimension']}-D of {answer['type']}"
        )
    layered = values[..., None] if values.ndim == 3 else values
    masks: dict[str, Grid] = {}
    for layer, number, name in _segments(answer["words"], layered, names or {}):
        masks[name] = layered[..., layer] == number
    if not masks:
        raise InputError(f"{path}: it has no segment: every voxel is 0")
    turned = {name: Volume(mask, frame).along_lps() for name, mask in masks.items()}
    return Segmentation(
        {name: volume.values for name, volume in turned.items()}, next(iter(turned.values())).frame
    )


def _segments(
    words: Mapping[str, str], layered: Grid, names: Mapping[int, str]
) -> list[tuple[int, int, str]]:
    """Layer, number and name of every segment."""
    found: list[tuple[int, int, str]] = []
    told = sorted({int(m[1]) for key in words if (m := re.match(r"Segment(\d{1,4})_", key))})
    for segment in told:
        text = {part: words.get(f"Segment{segment}_{part}", "") for part in
                ("Layer", "LabelValue", "Name")}  # fmt: skip
        layer, number = (int(x) if x.isdigit() else -1 for x in
                         (text["Layer"] or "0", text["LabelValue"]))  # fmt: skip
        if 0 <= layer < layered.shape[-1] and number > 0:
            found.append((layer, number, names.get(number, text["Name"] or f"label {number}")))
    known = {(layer, number) for layer, number, _ in found}
    for layer in range(layered.shape[-1]):
        for number in np.unique(layered[..., layer]).tolist():
            if number > 0 and (layer, number) not in known:
                found.append((layer, number, names.get(number, f"label {number}")))
    twice = sorted({n for _, _, n in found if [x for *_, x in found].count(n) > 1})
    if twice:
        raise InputError(f"several segments are called {twice[0]!r}; name them apart with names=")
    return found


def readable(path: str | os.PathLike[str]) -> Path:
    """The path of a folder, or of a file whose name ends as one that is read and that holds bytes.

    Raises `InputError` where it is none.
    """
    place = Path(path)
    if not place.exists():
        raise InputError(f"no file or folder {str(path)!r}; a path is relative to where you are")
    if place.is_dir():
        return place
    _io(place)
    if not place.is_file():
        raise InputError(f"{path} is neither a file nor a folder; give the CT itself")
    if place.stat().st_size == 0:
        raise InputError(f"{path} is empty (0 bytes); copy it again")
    return place


def _io(place: Path) -> str:
    ending = next((e for e in sorted(FORMATS, key=len)[::-1] if place.name.lower().endswith(e)), "")
    if not ending:
        what = "one DICOM slice: give the folder" if place.suffix == ".dcm" else "none that is read"
        raise InputError(
            f"{place}: {what}; volumes are read from a folder of DICOM files or from "
            f"{', '.join(FORMATS)}"
        )
    return FORMATS[ending]


def _reader(child: Child | None) -> Any:
    """A reader for one file, or the given one, which stays."""
    return Child() if child is None else _Lent(child)


class _Lent:
    """A reader that somebody else ends."""

    def __init__(self, child: Child) -> None:
        self.child = child

    def __enter__(self) -> Child:
        return self.child

    def __exit__(self, *_: object) -> None:
        return None


def _frame(path: object, answer: Mapping[str, Any]) -> Frame:
    """The frame in the answer, if it is one of a volume in a known space."""
    if answer["dimension"] != 3:
        raise InputError(
            f"{path}: it has {answer['dimension']} dimensions {answer['size']}; a volume has three"
            " (of a sequence, export one frame)"
        )
    if int(np.prod(answer["size"], dtype=object)) > MOST_VOXELS:
        raise InputError(
            f"{path}: it has {' x '.join(map(str, answer['size']))} voxels, more than a CT of a "
            "head; crop it"
        )
    words = answer["words"]
    if words.get("qform_code") == "0" and words.get("sform_code") == "0":
        raise InputError(
            f"{path}: the file does not say where left is (NIfTI with qform and sform code 0); "
            "convert the original slices again"
        )
    try:
        return Frame(answer["spacing"], answer["origin"], np.reshape(answer["axes"], (3, 3)))
    except InputError as error:
        raise InputError(f"{path}: {error}") from None


def _scalars(
    path: object,
    answer: Mapping[str, Any],
    values: Grid | None,
    hounsfield: tuple[float, float] | None,
) -> Grid:
    if answer["components"] != 1:
        raise InputError(
            f"{path}: every voxel has {answer['components']} numbers (colour, or a field); a CT has"
            " one"
        )
    if values is None:
        raise InputError(
            f"{path}: a picture of {answer['size']} voxels is no volume; give the whole CT"
        )
    if values.dtype.kind not in "iuf":
        raise InputError(
            f"{path}: voxels of type {answer['type']} are no Hounsfield units; export the CT with "
            "whole numbers of 16 bits, or with real ones"
        )
    if values.dtype.itemsize == 1 and hounsfield is None:
        raise InputError(
            f"{path}: voxels of 8 bits are grey values, not Hounsfield units; export 16 bits, or "
            f"say slope and intercept if you know them: {STATED}"
        )
    return values


def _check_size(volume: Volume) -> None:
    """Refuses what can be no head in mm."""
    lengths = np.array(volume.shape) * volume.frame.spacing
    said = " x ".join(f"{x:.4g}" for x in lengths) + " mm"
    if lengths.max() > LONGEST:
        raise InputError(
            f"the picture measures {said}, longer than any person: is it in mm? Export it again"
        )
    if lengths.min() < SHORTEST:
        raise InputError(
            f"the picture measures {said}: too thin for a head, or not in mm; give the whole CT, "
            "or export it again"
        )


def _in_hounsfield(volume: Volume, given: tuple[float, float] | None) -> Volume:
    """The same in whole HU, int16, if it looks like a CT."""
    values, notes = volume.values, []
    if not np.isfinite(values).all():
        bad = int((~np.isfinite(values)).sum())
        raise InputError(f"{bad} voxels are NaN or infinite; export the picture again")
    if given is not None:
        if not np.isfinite(given).all() or given[0] <= 0:
            raise InputError(f"hounsfield={given}: a positive slope and an intercept are needed")
        values = values.astype(np.float32) * np.float32(given[0]) + np.float32(given[1])
        notes.append(f"HU = {given[0]:g} value {given[1]:+g}, as stated")
    low, high = float(values.min()), float(values.max())
    if low > AIR:
        raise InputError(
            f"values from {low:g} to {high:g}: no air (-1000 HU) is in view, so they are hardly "
            "Hounsfield units (an MR, or a CT without its intercept); export the CT again, or say "
            f"slope and intercept: {STATED}"
        )
    if high > MOST or high < AIR:
        raise InputError(
            f"values from {low:g} to {high:g} are no Hounsfield units of a head (air -1000, bone "
            f"some 300 to 2000); export the CT again, or say slope and intercept: {STATED}"
        )
    if low < LEAST:
        notes.append(f"padding below {LEAST} HU (down to {low:g}) is taken as air")
    whole = np.empty(values.shape, np.int16)
    for part, slab in zip(whole, values, strict=True):
        part[:] = np.clip(np.rint(slab), LEAST, MOST)
    return Volume(whole, volume.frame, volume.notes + tuple(notes))
