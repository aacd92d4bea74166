# SPDX-License-Identifier: BSD-3-Clause
"""CT pictures, series, segmentations and landmarks that cannot be used are refused."""

from __future__ import annotations

import json
import os
import re
import signal
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import dicom_files as dicom

pytest.importorskip("SimpleITK", reason="comes with the extra 'imaging'")

from bezsoma.errors import InputError
from bezsoma.imaging import (
    Frame,
    LabelSettings,
    Segmentation,
    Volume,
    head_ct,
    labels,
    read_landmarks,
    read_segmentation,
    read_volume,
    write_landmarks,
    write_surface,
    write_volume,
)
from bezsoma.imaging.child import Child

PLAIN = Frame([4, 4, 4], [0, 0, 0], np.eye(3))


@pytest.fixture(scope="module")
def child() -> Iterator[Child]:
    with Child(seconds=30) as reader:
        yield reader


def refused(words: list[str], call: Callable[..., Any], *given: Any, **options: Any) -> None:
    with pytest.raises(InputError) as caught:
        call(*given, **options)
    message = str(caught.value)
    assert [word for word in words if word not in message] == [], message
    said = message.replace(str(given[0]), "") if given else message
    assert len(said) < 700
    assert not re.search(r"\bdoe\b|jane|4711|19700101", said, re.IGNORECASE), said


def changed(**tags: Any) -> list[dicom.Slice]:
    """A series with tags changed everywhere, named g0008_0060."""
    slices = dicom.stack(dicom.pattern())
    for one in slices:
        one.changes = {tuple(int(x, 16) for x in t[1:].split("_")): v for t, v in tags.items()}
    return slices


def one_changed(number: int, **fields: Any) -> list[dicom.Slice]:
    slices = dicom.stack(dicom.pattern())
    for name, value in fields.items():
        setattr(slices[number], name, value)
    return slices


def two_series() -> list[dicom.Slice]:
    other = changed(g0020_000e="1.2.9")
    for number, one in enumerate(other):
        one.changes[(0x0008, 0x0018)] = f"1.2.8.{number}"
    return [*dicom.stack(dicom.pattern()), *other]


def named(*words: str) -> list[dicom.Slice]:
    """A series called by each of the words, most of which name the patient."""
    slices = []
    for number, word in enumerate(words):
        for one in changed(g0020_000e=f"1.2.{number}.4", g0008_103e=word):
            one.changes[(0x0008, 0x0018)] = f"1.2.8.{len(slices)}"
            if word == "kernel":
                more = {(0x0018, 0x1210): "B30", (0x0020, 0x0011): 5, (0x0018, 0x0050): 2}
                one.changes |= more
            else:
                one.changes |= {(0x0018, 0x1210): "doe"}
            slices.append(one)
    return slices


def far_double() -> list[dicom.Slice]:
    slices = dicom.stack(dicom.pattern())
    twin = dicom.stack(dicom.pattern() + 9)[4]
    twin.changes = {(0x0008, 0x0018): "1.2.8"}
    return [*slices, twin]


def without_one() -> list[dicom.Slice]:
    slices = dicom.stack(dicom.pattern())
    return slices[:5] + slices[6:]


SERIES: dict[str, tuple[Callable[[], list[dicom.Slice]], list[str]]] = {
    "an MR": (lambda: changed(g0008_0060="MR"), ["MR, not CT", "Hounsfield"]),
    "no modality": (lambda: changed(g0008_0060=None), ["unknown, not CT"]),
    "two patients": (
        lambda: one_changed(3, changes={(0x0010, 0x0020): "4712"}),
        ["2 patients", "keep one"],
    ),
    "two series": (two_series, ["several series", "1.2.9: 14 slices", "series="]),
    "two series called by a name": (
        lambda: named("DOE head", "Jane_bone", "4711", "b 19700101", "kernel"),
        [
            "1.2.3.4: 14 slices of CT;",
            "1.2.4.4: 14 slices of CT, number 5, 2 mm thick, kernel B30 (kernel)",
        ],
    ),
    "colour": (lambda: changed(g0028_0002=3), ["colour"]),
    "no rescale": (lambda: changed(g0028_1052=None), ["rescale", "original"]),
    "a slope of nothing": (lambda: changed(g0028_1053="0"), ["slope", "(0, -1024)"]),
    "a slope in words": (lambda: changed(g0028_1053="abc"), ["slope", "abc"]),
    "a slope downwards": (lambda: changed(g0028_1053="-1"), ["slope", "positive"]),
    "an endless slope": (lambda: changed(g0028_1053="1e400"), ["slope", "1e400"]),
    "an intercept in words": (lambda: changed(g0028_1052="none"), ["intercept", "none"]),
    "no position": (lambda: one_changed(2, changes={(0x0020, 0x0032): None}), ["position"]),
    "a broken position": (
        lambda: one_changed(2, changes={(0x0020, 0x0032): "1\\nan\\3"}),
        ["no usable position"],
    ),
    "another direction": (
        lambda: one_changed(2, directions=(1, 0, 0, 0, 0, -1)),
        ["1 of 14 slices", "another direction"],
    ),
    "a missing slice": (without_one, ["missing", "after slice 5", "8 mm", "interpolate = true"]),
    "two pictures of a place": (far_double, ["lie at one place (1 such place)", "acquisitions"]),
    "too few": (lambda: dicom.stack(dicom.pattern(5)), ["5 slices", "at least 8"]),
    "another size": (
        lambda: one_changed(2, stored=np.zeros((20, 28))),
        ["different size", "20 x 28"],
    ),
    "another spacing": (lambda: one_changed(2, spacing=(3, 2.5)), ["different size", "3\\2.5"]),
    "no air": (lambda: dicom.stack(np.abs(dicom.pattern())), ["no air", "hounsfield="]),
    "a shear of metres": (lambda: dicom.stack(dicom.pattern(), shear=300), ["3900 mm beside"]),
    "no spacing": (
        lambda: one_spaced(0),
        ["all three must be positive", "export the picture again"],
    ),
    "next to none, sheared": (lambda: sheared_and_spaced(1e-9), ["mm beside each other"]),
    "far too fine": (lambda: one_spaced(0.01), ["too thin", "mm"]),
}


def sheared_and_spaced(spacing: float) -> list[dicom.Slice]:
    return one_spaced(spacing, shear=1.0)


def one_spaced(spacing: float, shear: float = 0.0) -> list[dicom.Slice]:
    slices = dicom.stack(dicom.pattern(), shear=shear)
    for one in slices:
        one.spacing = (spacing, spacing)
    return slices


@pytest.mark.parametrize("case", SERIES)
def test_a_series_is_refused(case: str, tmp_path: Path, child: Child) -> None:
    slices, words = SERIES[case]
    refused(words, read_volume, dicom.written(tmp_path / "s", slices()), child=child)


@pytest.mark.parametrize("number", [0, 6, 13])
@pytest.mark.parametrize("part", [0, 0.05, 0.25, 0.6, 0.99])
def test_a_damaged_slice_is_named(number: int, part: float, tmp_path: Path, child: Child) -> None:
    """At the ends of a series, where no gap tells of it, and amid it, where the gap would."""
    stack = dicom.stack(dicom.pattern())
    folder = dicom.written(tmp_path / "s", stack, shuffled=False)
    path = folder / f"IM{number:04d}"
    content = path.read_bytes()
    path.write_bytes(content[: int(part * len(content))])
    words = ["1 of its 14 files", path.name, "damaged or cut short", "copy the series again"]
    refused(words, read_volume, folder, child=child)
    path.unlink()
    if number != 6:
        assert read_volume(folder, child=child).shape == (30, 20, 13)


def test_files_of_another_kind_are_no_damaged_slices(tmp_path: Path, child: Child) -> None:
    """A report in DICOM has no picture; a note may be empty."""
    folder = dicom.written(tmp_path / "s", dicom.stack(dicom.pattern()))
    report = dicom.stack(dicom.pattern())[0]
    picture = [tag for tag in report.tags(0) if tag[0] in (0x0028, 0x7FE0)]
    report.changes = dict.fromkeys(picture)
    report.changes |= {(0x0008, 0x0016): "1.2.840.10008.5.1.4.1.1.88.11", (0x0008, 0x0060): "SR"}
    (folder / "SR0001").write_bytes(report.content(99))
    (folder / "note.txt").touch()
    assert read_volume(folder, child=child).shape == (30, 20, 14)
    only = tmp_path / "only"
    only.mkdir()
    (only / "IM0000").write_bytes((folder / "IM0000").read_bytes()[:300])
    refused(["1 of its 1 files", "IM0000", "damaged"], read_volume, only, child=child)


def test_eight_bits_are_refused(tmp_path: Path, child: Child) -> None:
    slices = changed(g0028_0100=8, g0028_0101=8, g0028_0102=7)
    for one in slices:
        one.changes[(0x7FE0, 0x0010)] = bytes(one.stored.size)
    refused(["8 bits"], read_volume, dicom.written(tmp_path / "s", slices), child=child)


def test_folders_without_images_are_refused(tmp_path: Path, child: Child) -> None:
    refused(["no file or folder"], read_volume, tmp_path / "absent", child=child)
    refused(["empty"], read_volume, tmp_path, child=child)
    (tmp_path / "a.txt").write_text("nothing")
    refused(["none of its 1 files"], read_volume, tmp_path, child=child)
    folder = dicom.written(tmp_path / "s", dicom.stack(dicom.pattern()))
    refused(["no series 'x'", "1.2.3.4"], read_volume, folder, series="x", child=child)
    refused(["give the folder"], read_volume, (folder / "IM0001").rename(tmp_path / "a.dcm"))


def image(path: Path, values: Any, frame: Frame = PLAIN) -> Path:
    write_volume(path, values, frame)
    return path


def replaced(path: Path, old: bytes, new: bytes) -> Path:
    content = path.read_bytes()
    assert old in content
    path.write_bytes(content.replace(old, new, 1))
    return path


def test_damaged_and_unfitting_files_are_refused(tmp_path: Path, child: Child) -> None:
    values = np.full((12, 15, 20), -1000, np.int16)
    values[3:9, 3:9, 3:9] = 300

    def read(words: list[str], path: Path, **options: Any) -> None:
        refused([path.name, *words], read_volume, path, child=child, **options)

    def fresh(name: str, **other: Any) -> Path:
        return image(tmp_path / f"{name}.nrrd", other.get("values", values))

    cut = fresh("cut")
    cut.write_bytes(cut.read_bytes()[:-40])
    read(["cannot be read"], cut)
    read(["cannot be read"], replaced(fresh("word"), b"type: int16", b"type: knots"))
    empty = tmp_path / "empty.nrrd"
    empty.touch()
    read(["0 bytes"], empty)
    other = tmp_path / "a.jpg"
    other.write_bytes(b"x")
    read(["none that is read", ".nrrd"], other)
    read(["8 bits", "hounsfield="], fresh("bits", values=np.zeros(values.shape, np.uint8)))
    read(["no air"], fresh("air", values=np.abs(values)))
    mirrored = replaced(fresh("mirror"), b"(4.0,0.0,0.0)", b"(-4.0,0.0,0.0)")
    read(["mirror image", "left"], mirrored)
    nan = values.astype(np.float32)
    nan[2, 2, 2] = np.nan
    read(["1 voxels are NaN"], fresh("nan", values=nan))
    read(["no Hounsfield units"], fresh("huge", values=values.astype(np.float32) * 400))
    metres = image(tmp_path / "m.nrrd", values, Frame([400] * 3, [0] * 3, np.eye(3)))
    read(["longer than any person"], metres)
    read(["too thin"], image(tmp_path / "t.nrrd", values, Frame([0.004] * 3, [0] * 3, np.eye(3))))
    read(["one file", "folder"], fresh("series"), series="1.2")
    read(["positive slope"], fresh("slope"), hounsfield=(0, 1))
    claimed = replaced(fresh("claim"), b"sizes: 20 15 12", b"sizes: 90000 90000 90000")
    read(["more than a CT of a head"], claimed)


def test_files_without_a_side_or_a_third_dimension_are_refused(
    tmp_path: Path, child: Child
) -> None:
    import SimpleITK as sitk  # noqa: N813

    values = np.full((12, 15, 20), -1000, np.int16)
    sitk.WriteImage(sitk.GetImageFromArray(values[0]), str(tmp_path / "flat.mha"))
    refused(["2 dimensions"], read_volume, tmp_path / "flat.mha", child=child)
    sitk.WriteImage(sitk.GetImageFromArray(values[None]), str(tmp_path / "time.nii"))
    refused(["dimensions"], read_volume, tmp_path / "time.nii", child=child)
    colour = sitk.GetImageFromArray(np.zeros((12, 15, 20, 3), np.int16), isVector=True)
    sitk.WriteImage(colour, str(tmp_path / "colour.mha"))
    refused(["3 numbers"], read_volume, tmp_path / "colour.mha", child=child)
    image = sitk.GetImageFromArray(values)
    image.SetSpacing((4, 4, 4))
    sitk.WriteImage(image, str(tmp_path / "a.nii"))
    content = bytearray((tmp_path / "a.nii").read_bytes())
    content[252:256] = bytes(4)  # qform and sform code
    (tmp_path / "a.nii").write_bytes(content)
    refused(["where left is"], read_volume, tmp_path / "a.nii", child=child)
    sitk.WriteImage(sitk.GetImageFromArray(values.astype(float)), str(tmp_path / "f.nrrd"))
    refused(["whole numbers"], read_segmentation, tmp_path / "f.nrrd", child=child)
    refused(["no segment"], read_segmentation, image_of(tmp_path, values * 0), child=child)


def image_of(folder: Path, values: Any) -> Path:
    return image(folder / "zero.nrrd", values.astype(np.uint8))


MARKUP = {"coordinateSystem": "LPS", "controlPoints": [{"label": "A", "position": [1, 2, 3]}]}
LANDMARKS: dict[str, tuple[Any, list[str]]] = {
    "no list": ({"points": []}, ["no list 'markups'"]),
    "no frame": ({**MARKUP, "coordinateSystem": None}, ["LPS or RAS", "left"]),
    "metres": ({**MARKUP, "coordinateUnits": "m"}, ["mm is needed"]),
    "two of a name": (
        {**MARKUP, "controlPoints": MARKUP["controlPoints"] * 2},  # type: ignore[operator]
        ["'A'", "twice"],
    ),
    "no numbers": (
        {**MARKUP, "controlPoints": [{"label": "A", "position": [1, "x", 3]}]},
        ["'A'", "three finite numbers"],
    ),
    "none": ({**MARKUP, "controlPoints": []}, ["no landmark"]),
}


@pytest.mark.parametrize("case", LANDMARKS)
def test_landmarks_are_refused(case: str, tmp_path: Path) -> None:
    content, words = LANDMARKS[case]
    whole = content if case == "no list" else {"markups": [content]}
    path = tmp_path / "a.mrk.json"
    path.write_text(json.dumps(whole))
    refused([path.name, *words], read_landmarks, path)
    path.write_text("{")
    refused(["no JSON"], read_landmarks, path)


def test_what_cannot_be_written_leaves_nothing(tmp_path: Path) -> None:
    point = {"A": np.zeros(3)}
    refused(["end in"], write_landmarks, tmp_path / "a.json", point)
    refused(["no folder"], write_landmarks, tmp_path / "x" / "a.mrk.json", point)
    refused(
        ["0 to 3", "there are 3"], write_surface, tmp_path / "a.stl", np.zeros((3, 3)), [[0, 1, 3]]
    )
    refused(["float64"], write_volume, tmp_path / "a.nrrd", np.zeros((2, 2, 2)), PLAIN)
    assert list(tmp_path.iterdir()) == []
    write_landmarks(tmp_path / "a.mrk.json", point)
    refused(["overwrite=True"], write_landmarks, tmp_path / "a.mrk.json", point)


SETTINGS: dict[str, tuple[dict[str, Any], list[str]]] = {
    "order": ({"bone": -600}, ["have to rise"]),
    "negative": ({"thin": -1}, ["thin=-1"]),
    "window": ({"fat": (-30, -200)}, ["fat=", "below"]),
    "soft": ({"soft": 300}, ["below bone"]),
    "fuller": ({"fuller": 0.5}, ["fuller=0.5", "1 to 2"]),
    "cavities": ({"cavities": "open"}, ["'apart' or 'tissue'"]),
}


@pytest.mark.parametrize("case", SETTINGS)
def test_settings_are_refused(case: str) -> None:
    given, words = SETTINGS[case]
    refused(words, LabelSettings, **given)


@pytest.fixture(scope="module")
def head() -> Volume:
    return head_ct((3, 3, 3), noise=0, joint=4).volume


def test_heads_that_cannot_be_labelled(head: Volume) -> None:
    small = Volume(head.values, Frame([0.3] * 3, [0] * 3, np.eye(3)))
    refused(["cm3", "mm and HU"], labels, small)
    large = Volume(head.values, Frame([30.0] * 3, [0] * 3, np.eye(3)))
    refused(["cm3"], labels, large)
    refused(["no bone", "250 HU"], labels, head.with_values(np.minimum(head.values, 200)))
    over = head.with_values(head.values[::-1])
    refused(["upside down", "skull="], labels, over)
    crown = head.cropped(np.array([0, 0, 45]), np.array(head.shape))
    refused(["105 mm below", "chin is not in view"], labels, crown)
    air = head.with_values(np.full_like(head.values, -1000))
    refused(["0 cm3"], labels, air)


def test_a_head_smaller_than_an_adult_s_is_told(head: Volume) -> None:
    """Three quarters of an adult's: a child of one or two years, or a wrong scale."""
    alike = LabelSettings(coarse=4)
    frame = head.frame
    small = Volume(head.values, Frame(0.75 * frame.spacing, 0.75 * frame.origin, frame.axes))
    (note,) = (note for note in labels(small, alike).notes if "scale" in note)
    assert note.startswith("LOOK: 14") and "child's" in note and "170 and more" in note
    assert not any("scale" in note for note in labels(head, alike).notes)


def test_seeds_and_segmentations_that_do_not_fit(head: Volume) -> None:
    refused(["chin=", "mm away"], labels, head, LabelSettings(chin=(0, -300, 0)))
    refused(["skull="], labels, head, LabelSettings(skull=(0, 0, 75)))
    masks = {"teeth": head.values > 1500}
    refused(["'teeth'", "names="], labels, head, given=Segmentation(masks, head.frame))
    empty = {"bone": np.zeros((4, 4, 4), np.bool_)}
    refused(["empty"], labels, head, given=Segmentation(empty, PLAIN))


def test_phantoms_that_cannot_be_made() -> None:
    refused(["0.3 to 4 mm"], head_ct, (0.1, 1, 1))
    refused(["noise"], head_ct, noise=-1)


def test_a_reader_that_hangs_is_stopped(tmp_path: Path) -> None:
    path = image(tmp_path / "a.nrrd", np.full((12, 15, 20), -1000, np.int16))
    with Child(seconds=0.2) as hanging:
        os.kill(hanging._running().pid, signal.SIGSTOP)
        refused(["longer than 0.2 s"], read_volume, path, child=hanging)


def test_a_reader_that_dies_is_told_and_replaced(tmp_path: Path) -> None:
    values = np.full((12, 15, 20), -1000, np.int16)
    values[3:9] = 300
    path = image(tmp_path / "a.nrrd", values)
    with Child() as child:
        read_volume(path, child=child)
        assert child._process is not None
        child._process.kill()
        child._process.wait()
        assert read_volume(path, child=child).shape == (20, 15, 12)
