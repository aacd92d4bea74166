# SPDX-License-Identifier: BSD-3-Clause
"""A thousand damaged files of each format: read, or refused, and never a crash or a hang."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import dicom_files as dicom

pytest.importorskip("SimpleITK", reason="comes with the extra 'imaging'")

from bezsoma.errors import InputError
from bezsoma.imaging import Frame, Volume, read_landmarks, read_volume, write_landmarks
from bezsoma.imaging.child import Child

NUMBER = int(os.environ.get("BEZSOMA_MUTATED", "1000"))
"""Damaged files of each format; `./dev fuzz` takes 10,000."""
MEMORY = 1 << 30


@pytest.fixture(scope="module")
def child() -> Iterator[Child]:
    with Child(memory=MEMORY, seconds=20) as reader:
        yield reader


def mutated(content: bytes, random: np.random.Generator, head: int) -> bytes:
    """The content with a few bytes changed (mostly in its first `head`), cut, doubled or moved."""
    data = bytearray(content)
    way = random.integers(6)
    for _ in range(int(random.integers(1, 8))):
        place = int(random.integers(min(head, len(data)) if random.random() < 0.8 else len(data)))
        if way == 0:
            data[place] = int(random.integers(256))
        elif way == 1:
            data[place] ^= 1 << int(random.integers(8))
        elif way == 2:
            data[place : place + 1] = b"0123456789-. \n"[int(random.integers(14)) :][:1]
        elif way == 3:
            data[place : place + int(random.integers(1, 9))] = b""
        elif way == 4:
            data[place:place] = data[place : place + int(random.integers(1, 40))]
        else:
            data[place : place + 4] = b"\xff\xff\xff\x7f"
    return bytes(data[: int(random.integers(len(data) + 1))] if random.random() < 0.1 else data)


def originals(folder: Path) -> dict[str, bytes]:
    """A small good file of each format, written by SimpleITK."""
    import SimpleITK as sitk  # noqa: N813

    values = np.full((10, 11, 12), -1000, np.int16)
    values[3:7, 3:8, 3:8] = 400
    image = sitk.GetImageFromArray(values)
    image.SetSpacing((3, 3, 3))
    for ending in (".nrrd", ".nii", ".nii.gz", ".mha"):
        sitk.WriteImage(image, str(folder / f"good{ending}"), ending == ".nrrd")
    return {e: (folder / f"good{e}").read_bytes() for e in (".nrrd", ".nii", ".nii.gz", ".mha")}


@pytest.mark.parametrize("ending", [".nrrd", ".nii", ".nii.gz", ".mha"])
def test_damaged_volumes(ending: str, tmp_path: Path, child: Child) -> None:
    good = originals(tmp_path)[ending]
    random = np.random.default_rng(8)
    answers = {"read": 0, "refused": 0}
    path = tmp_path / f"a{ending}"
    for _ in range(NUMBER):
        path.write_bytes(mutated(good, random, 400))
        answers[outcome(path, child)] += 1
    assert answers["refused"] > NUMBER // 20, answers


def outcome(path: Path, child: Child) -> str:
    try:
        volume = read_volume(path, child=child)
    except InputError as error:
        assert path.name in str(error) and len(str(error)) < 900
        return "refused"
    assert isinstance(volume, Volume) and isinstance(volume.frame, Frame)
    assert volume.values.dtype == np.int16 and np.isfinite(volume.corners).all()
    return "read"


def test_damaged_slices(tmp_path: Path, child: Child) -> None:
    """One damaged slice in a series of eight, in its header or its values."""
    folder = dicom.written(tmp_path / "s", dicom.stack(dicom.pattern(8, 9, 12), 3))
    path = folder / "IM0003"
    good = path.read_bytes()
    random = np.random.default_rng(8)
    answers = {"read": 0, "refused": 0}
    for _ in range(NUMBER):
        path.write_bytes(mutated(good, random, len(good)))
        try:
            read_volume(folder, child=child)
            answers["read"] += 1
        except InputError as error:
            assert str(folder) in str(error) and "Doe" not in str(error)
            answers["refused"] += 1
    assert min(answers.values()) > 0, answers


def test_damaged_landmarks(tmp_path: Path) -> None:
    write_landmarks(tmp_path / "good.mrk.json", {"A": np.ones(3), "B": np.zeros(3)})
    good = (tmp_path / "good.mrk.json").read_bytes()
    assert json.loads(good)
    random = np.random.default_rng(8)
    path = tmp_path / "a.mrk.json"
    for _ in range(NUMBER):
        path.write_bytes(mutated(good, random, len(good)))
        try:
            found: dict[str, Any] = read_landmarks(path)
        except InputError as error:
            assert path.name in str(error)
            continue
        assert all(p.shape == (3,) and np.isfinite(p).all() for p in found.values())
