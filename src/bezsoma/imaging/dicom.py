# SPDX-License-Identifier: BSD-3-Clause
"""A folder of DICOM slices to one volume: which series, in what order, and whether it is a CT.

Nothing is guessed about where a slice lies: position and direction of each come from its header.
What can be mended by resampling is mended with a word; what would be an invention is refused.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy import ndimage

from bezsoma.arrays import Floats
from bezsoma.errors import InputError, counted, unknown
from bezsoma.imaging.child import Child
from bezsoma.imaging.volume import Frame, Grid, Volume

SAME_PLACE = 0.01
"""Slices closer than this, in mm, are one and the same."""
EVEN = 0.02
"""How far gaps may differ from the median, relative, to count as even."""
MISSING = 1.5
"""A gap larger than so many medians means that a slice is missing."""
TURNED = 1e-3
"""How far directions of slices may differ, as cosines, to count as one."""
FEWEST = 8
"""With fewer slices there is no volume, but a topogram or a report."""


@dataclass(frozen=True)
class Series:
    """One series of a folder: its name (a UID), what the scanner called it, files, modality.

    What it is called is free text, and left out where a word of the patient stands in it.
    """

    name: str
    about: str
    modality: str
    headers: tuple[Mapping[str, Any], ...]

    def __str__(self) -> str:
        first = self.headers[0]
        told = [
            f"{word}{first[key]}{unit}"
            for key, word, unit in (
                ("number", "number ", ""), ("thick", "", " mm thick"), ("kernel", "kernel ", "")
            ) if first[key]
        ]  # fmt: skip
        what = f"{len(self.headers)} slices of {self.modality or 'no modality'}"
        about = f" ({self.about})" if self.about else ""
        return f"{self.name}: {', '.join([what, *told])}{about}"


def series_in(folder: Path, child: Child) -> tuple[list[Series], list[Path]]:
    """The series of a folder, the largest first; and slices too damaged to say of which."""
    paths = sorted(p for p in folder.rglob("*") if p.is_file() and p.name != "DICOMDIR")
    if not paths:
        raise InputError(f"{folder}: the folder is empty; a folder of DICOM files is needed")
    answer, _ = child.answer(str(folder), what="headers", paths=[str(p) for p in paths])
    groups: dict[str, list[dict[str, Any]]] = {}
    people = set()
    for path, header in zip(paths, answer["headers"], strict=True):
        if header is not None:
            people.add(header.pop("person"))
            groups.setdefault(header["series"], []).append(header | {"path": str(path)})
    damaged = [Path(path) for path in answer["damaged"]]
    if not groups and damaged:
        raise _unreadable(folder, damaged, len(paths))
    if not groups:
        raise InputError(
            f"{folder}: none of its {len(paths)} files is a DICOM image; a folder of slices is "
            "needed (other formats are given as a file: .nrrd, .nii, .nii.gz, .mha, .mhd)"
        )
    if len(people) > 1:
        raise InputError(
            f"{folder}: it holds images of {len(people)} patients; keep one patient's in a folder"
        )
    found = [
        Series(name, group[0]["about"], group[0]["modality"], tuple(group))
        for name, group in groups.items()
    ]
    return sorted(found, key=lambda s: (-len(s.headers), s.name)), damaged


def _unreadable(folder: Path, damaged: Sequence[Path], count: int) -> InputError:
    """A series without some of its slices would lack a part of the head without a word."""
    names = [str(path.relative_to(folder)) for path in damaged]
    listed = ", ".join(names[:8]) + (f" and {len(names) - 8} more" if len(names) > 8 else "")
    return InputError(
        f"{folder}: damaged or cut short slices of a CT are {len(damaged)} of its {count} files "
        f"({listed[:300]}), so a part of the head may be missing; copy the series again, or move "
        "these files out of the folder if they do not matter"
    )


def read_series(folder: Path, child: Child, series: str | None, interpolate: bool) -> Volume:
    """The volume (HU) of one series of a folder; `series` is its UID, its number, or its name."""
    found, damaged = series_in(folder, child)
    chosen = _chosen(folder, found, series)
    if damaged:
        raise _unreadable(folder, damaged, len(damaged) + sum(len(s.headers) for s in found))
    where = str(folder)
    try:
        headers, notes = _ordered(_images_of(chosen))
        _check_ct(chosen.modality, headers)
        _, values = child.answer(where, what="slices", paths=[header["path"] for header in headers])
        assert values is not None
        return _volume(values, headers, notes, interpolate)
    except InputError as error:
        text = str(error)
        raise InputError(text if text.startswith(where) else f"{where}: {text}") from None


def _chosen(folder: Path, found: Sequence[Series], wanted: str | None) -> Series:
    """The one that was asked for, or the only CT with enough slices."""
    if wanted is not None:
        fits = [s for s in found if wanted and wanted in (s.name, s.headers[0]["number"], s.about)]
        if not fits:
            raise InputError(unknown("series", wanted, [s.name for s in found], str(folder)))
        if len(fits) == 1:
            return fits[0]
        found = fits
    volumes = [s for s in found if len(s.headers) >= FEWEST and s.modality == "CT"] or found
    if len(volumes) > 1:
        listed = "; ".join(map(str, volumes))
        raise InputError(
            f"{folder}: it holds several series: {listed}. Say which one, by what stands before "
            'the colon, by its number or by what it is called in brackets: series = "..." in '
            "[model] of the settings, series= in Python"
        )
    return volumes[0]


def _images_of(series: Series) -> list[Mapping[str, Any]]:
    """Its slices without the topogram, which shows the head from the side in the same series."""
    return [h for h in series.headers if "LOCALIZER" not in h["kind"].upper()]


def _check_ct(modality: str, headers: Sequence[Mapping[str, Any]]) -> None:
    """Refuses what is no CT in Hounsfield units."""
    first = headers[0]
    if modality != "CT":
        raise InputError(
            f"the series is of modality {modality or 'unknown'}, not CT; only a CT has Hounsfield "
            "units, by which bone and skin are found (segment other pictures elsewhere, such as "
            "in 3D Slicer, and give the segmentation)"
        )
    if any(header["samples"] not in ("", "1") for header in headers):
        raise InputError("its slices are in colour: pictures of a CT, not the CT; export the CT")
    if any(header["bits"] == "8" for header in headers):
        raise InputError(
            "its slices have 8 bits a pixel: pictures of a CT without Hounsfield units; export "
            "the original slices (16 bits)"
        )
    if any(not header["slope"] or not header["intercept"] for header in headers):
        raise InputError(
            "slices without rescale slope and intercept have no Hounsfield units; export the "
            "original slices"
        )
    for header in headers:
        if not _rescales(header):
            raise InputError(
                f"slice {Path(header['path']).name} has no usable rescale slope and intercept "
                f"({header['slope'][:30]}, {header['intercept'][:30]}): a positive and a finite "
                "number make Hounsfield units of its values; export the original slices"
            )
    if first["frames"] not in ("", "1"):
        raise InputError(
            "it is one file of many frames (enhanced CT), which is not read; convert it to NRRD "
            "with 3D Slicer"
        )


def _rescales(header: Mapping[str, Any]) -> bool:
    """Whether slope and intercept of a slice make Hounsfield units."""
    try:
        slope, intercept = float(header["slope"]), float(header["intercept"])
    except ValueError:
        return False
    return bool(np.isfinite(slope) and np.isfinite(intercept) and slope > 0)


def _numbers(header: Mapping[str, Any], tag: str, count: int) -> Floats:
    """Finite numbers of a tag, or a refusal that names it."""
    try:
        values = np.array([float(word) for word in header[tag].split("\\")])
    except ValueError:
        values = np.empty(0)
    if values.shape != (count,) or not np.isfinite(values).all():
        name = Path(header["path"]).name
        raise InputError(
            f"slice {name} has no usable {tag} ({header[tag][:60] or 'missing'}); without it nobody"
            " knows where it lies: export the original slices"
        )
    return values


def _ordered(images: list[Mapping[str, Any]]) -> tuple[list[Mapping[str, Any]], list[str]]:
    """The slices from one end to the other, by position along their normal; and what was odd."""
    if len(images) < FEWEST:
        raise InputError(
            f"the series has {len(images)} slices; a volume needs at least {FEWEST} (a topogram or "
            "a report is none)"
        )
    turns = np.array([_numbers(h, "directions", 6) for h in images])
    off = np.abs(turns - np.median(turns, axis=0)).max(axis=1) > TURNED
    if off.any():
        raise InputError(
            f"{int(off.sum())} of {len(images)} slices {'lie' if off.sum() > 1 else 'lies'} in "
            "another direction than the rest (a topogram, or a reformatted view); keep slices of "
            "one direction in a folder"
        )
    sizes = Counter((h["rows"], h["columns"], h["spacing"]) for h in images)
    if len(sizes) > 1:
        listed = ", ".join(f"{n} of {r} x {c} at {s} mm" for (r, c, s), n in sizes.items())
        raise InputError(f"slices of different size are mixed ({listed}); keep those of one size")
    normal = np.cross(turns[0, :3], turns[0, 3:])
    along = np.array([_numbers(h, "position", 3) for h in images]) @ normal
    order = np.argsort(along, kind="stable")
    notes = [] if len(images) == 0 else _tilt_note(images[0])
    return [images[i] for i in order], notes


def _tilt_note(header: Mapping[str, Any]) -> list[str]:
    try:
        tilt = float(header["tilt"] or 0)
    except ValueError:
        return []
    return [f"the gantry was tilted by {tilt:g} degrees"] if abs(tilt) > 0.01 else []


def _volume(
    values: Grid, headers: Sequence[Mapping[str, Any]], notes: list[str], interpolate: bool
) -> Volume:
    """Slices (k, rows, columns) in order to a volume on an even grid."""
    turn = _numbers(headers[0], "directions", 6).reshape(2, 3)
    axes = np.column_stack([*turn, np.cross(*turn)])
    places = np.array([_numbers(h, "position", 3) for h in headers])
    values, places = _without_doubles(values, places, axes[:, 2], notes)
    rows, columns = _numbers(headers[0], "spacing", 2)
    gaps = np.diff(places @ axes[:, 2])
    step = float(np.median(gaps))
    square = Frame(np.array([columns, rows, step]), places[0], axes)
    _check_gaps(gaps, step, interpolate, notes)
    values, start = _sheared_back(values, places, axes, (columns, rows), notes)
    if np.abs(gaps / step - 1).max() > EVEN:
        values = _evened(values, places @ axes[:, 2], step)
    return Volume(values, replace(square, origin=start), tuple(notes))


def _without_doubles(
    values: Grid, places: Floats, normal: Floats, notes: list[str]
) -> tuple[Grid, Floats]:
    """Slices at places of their own: equal doubles are dropped, different ones refused."""
    double = np.flatnonzero(np.diff(places @ normal) < SAME_PLACE) + 1
    differ = [k for k in double if not np.array_equal(values[k], values[k - 1])]
    if differ:
        raise InputError(
            "slices that show different things lie at one place "
            f"({counted(len(differ), 'such place')}): two acquisitions or reconstructions in one "
            "series; keep one of them in the folder"
        )
    if len(double):
        notes.append(f"{counted(len(double), 'slice')} there twice; one of each was taken")
    keep = np.setdiff1d(np.arange(len(places)), double)
    return values[keep], places[keep]


def _check_gaps(gaps: Floats, step: float, interpolate: bool, notes: list[str]) -> None:
    wide = gaps > MISSING * step
    found = counted(int(wide.sum()), "gap")
    if wide.any() and not interpolate:
        first = int(np.flatnonzero(wide)[0])
        raise InputError(
            f"slices are missing: after slice {first + 1} the next one follows at "
            f"{gaps[first]:.4g} mm, elsewhere at {step:.4g} mm ({found} like this); copy the "
            "series again, or have them filled between neighbours: interpolate = true in [model] "
            "of the settings, interpolate=True in Python"
        )
    if wide.any():
        notes.append(f"{found} interpolated, of up to {gaps.max():.4g} mm")
    elif np.abs(gaps / step - 1).max() > EVEN:
        notes.append(
            f"slices lie {gaps.min():.4g} to {gaps.max():.4g} mm apart; resampled to {step:.4g} mm"
        )


def _sheared_back(
    values: Grid, places: Floats, axes: Floats, spacing: tuple[float, float], notes: list[str]
) -> tuple[Grid, Floats]:
    """Slices moved within their planes to stand square on each other, as a tilted gantry's not.

    The grid grows by what they move, filled with the least value, so that nothing leaves it; the
    place (3,) of its first voxel is answered too.
    """
    with np.errstate(over="ignore"):  # of pixels of next to no size
        offset = (places - places[0]) @ axes[:, :2] / spacing
    if np.abs(offset).max() < 0.1:
        return values, places[0]
    low, high = (np.ceil(np.maximum(sign * offset, 0).max(axis=0)) for sign in (-1, 1))
    most = float(np.abs(offset * spacing).max())
    if not (low + high <= values.shape[:0:-1]).all():
        raise InputError(
            f"slices lie up to {most:.4g} mm beside each other, more than they are wide: no tilt "
            "of a gantry; export the original slices"
        )
    notes.append(
        f"slices do not stand square on each other: moved back by up to {most:.4g} mm, the grid "
        "widened by as much"
    )
    before, after = low.astype(int), high.astype(int)
    grown = np.full(
        (len(values), *(values.shape[1:] + (before + after)[::-1])), values.min(), np.float32
    )
    for wide, plane, move in zip(grown, values, offset, strict=True):
        inner = tuple(
            slice(start, start + count)
            for start, count in zip(before[::-1], plane.shape, strict=True)
        )
        wide[inner] = plane
        wide[:] = ndimage.shift(wide, move[::-1], order=1, mode="nearest")
    return grown, places[0] - axes[:, :2] @ (before * spacing)


def _evened(values: Grid, along: Floats, step: float) -> Grid:
    """Values at even steps, linear between slices."""
    count = int(np.floor((along[-1] - along[0]) / step + 1e-6)) + 1
    where = np.interp(along[0] + step * np.arange(count), along, np.arange(len(along)))
    below = np.minimum(where.astype(np.int64), len(along) - 2)
    part = (where - below)[:, None, None].astype(np.float32)
    return np.asarray((1 - part) * values[below] + part * values[below + 1])
