# SPDX-License-Identifier: BSD-3-Clause
"""Domains, tets and models that cannot be made: what was given, why not, what can; nothing left."""

from __future__ import annotations

import errno
import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import numpy as np
import pytest

import dicom_files as dicom

pytest.importorskip("SimpleITK", reason="comes with the extra 'imaging'")

import bezsoma as bz
from bezsoma import cli
from bezsoma.errors import InputError
from bezsoma.imaging import (
    DomainSettings,
    Frame,
    Labels,
    LabelSettings,
    Sizes,
    domain,
    face_mesh,
    face_points,
    head_ct,
    write_volume,
)
from bezsoma.imaging.meaning import AIR, BONE, MANDIBLE, SOFT
from bezsoma.model import ModelSettings, building, read_settings, run_model
from bezsoma.model.folder import RECORD, ModelFolder, source_of
from bezsoma.model.lock import locked
from bezsoma.model.settings import written


def refused(words: list[str], call: Callable[..., Any], *given: Any, **named: Any) -> None:
    with pytest.raises(InputError) as caught:
        call(*given, **named)
    missing = [word for word in words if word not in str(caught.value)]
    assert not missing, f"{missing} not in: {caught.value}"


def block() -> Labels:
    """Two bones in a block of tissue."""
    values = np.zeros((40, 60, 60), np.uint8)
    values[4:36, 5:55, 5:55] = SOFT
    values[10:16, 20:40, 10:50] = MANDIBLE
    values[26:32, 20:40, 10:50] = BONE
    frame = Frame(np.full(3, 2.0), np.zeros(3), np.eye(3))
    return Labels(values, frame, LabelSettings(), np.zeros(3, np.int64), ())


BLOCK = DomainSettings(above=60, behind=60, below=60, loose=0.1)
DOMAINS: Mapping[str, tuple[dict[str, Any], list[str]]] = {
    "beside the head": ({"low": (500, None, None)}, ["beside the head", "LPS"]),
    "low above high": ({"low": (60, 0, 0), "high": (50, 90, 90)}, ["beside the head"]),
    "too thin": ({"low": (50, None, None), "high": (60, None, None)}, ["thinner than 20 mm"]),
    "no skull": ({"high": (None, None, 45)}, ["no bone of the skull", "move its planes"]),
    "no mandible": ({"low": (None, None, 40)}, ["no bone of the mandible"]),
    "not a number": ({"low": (np.nan, None, None)}, ["three numbers in mm"]),
    "two numbers": ({"low": (1, 2)}, ["three numbers in mm"]),
    "negative": ({"apart": -1}, ["apart=-1"]),
    "endless": ({"smooth": np.inf}, ["smooth=inf"]),
    "far": ({"below": 1000}, ["below=1000"]),
    "hollows": ({"hollows": "shut"}, ["'filled' or 'open'"]),
}


@pytest.mark.parametrize("case", DOMAINS)
def test_domains_are_refused(case: str) -> None:
    given, words = DOMAINS[case]
    refused(words, lambda: domain(block(), replace(BLOCK, **given)))


def test_labels_without_what_is_needed_are_refused() -> None:
    labels = block()
    no_jaw = replace(labels, values=np.where(labels.values == MANDIBLE, SOFT, labels.values))
    refused(["no mandible", "segmentation"], domain, no_jaw, BLOCK)
    refused(["no mandible"], face_points, no_jaw)
    bare = replace(labels, values=np.where(labels.values == SOFT, AIR, labels.values))
    refused(["soft tissue"], domain, bare, replace(BLOCK, cover=0))


SIZES: Mapping[str, tuple[dict[str, Any], list[str]]] = {
    "zero": ({"segment": 0}, ["segment=0", "0.2 to 50"]),
    "huge": ({"largest": 1000}, ["largest=1000"]),
    "no growth": ({"growth": 0}, ["growth=0"]),
    "no number": ({"skin": np.nan}, ["skin=nan"]),
}


@pytest.mark.parametrize("case", SIZES)
def test_sizes_are_refused(case: str) -> None:
    given, words = SIZES[case]
    refused(words, Sizes, **given)


def test_cells_that_do_not_suit_the_domain_are_refused() -> None:
    part = domain(block(), BLOCK)
    refused(["would fill", "larger ones"], face_mesh, part, Sizes(0.25, 0.25, 0.25, 0.25))


SETTINGS: Mapping[str, tuple[str, list[str]]] = {
    "no TOML": ("[labels", ["not readable TOML"]),
    "unknown table": ("[label]\nskin = 1", ["no table 'label'", "labels"]),
    "unknown key": ("[domain]\nabov = 3", ["[domain]", "'abov'", "above"]),
    "wrong value": ("[labels]\nbone = -600", ["have to rise"]),
    "too few tets": ("[model]\ntets = 3", ["tets=3"]),
    "far forward": ("[model]\nforward = 500.0", ["forward=500"]),
    "a word": ('[sizes]\nskin = "small"', ["[sizes]", "skin", "say a number"]),
    "half a point": ("[labels]\nchin = [1, 2]", ["chin", "three numbers"]),
    "no point": ("[labels]\nchin = [nan, 0, 0]", ["chin", "three numbers"]),
    "three ends": ("[labels]\nfat = [1, 2, 3]", ["fat", "two numbers"]),
    "no plane": ("[domain]\nlow = 3", ["low = 3", "three numbers"]),
    "yes": ('[labels]\nhalfway = "no"', ["halfway", "true or false"]),
    "half a degree": ("[model]\ndegree = 3.5", ["degree = 3.5", "a whole number"]),
    "a number": ("[model]\nseries = 5", ["series = 5", "a word in quotes"]),
    "no slope": ("[model]\nhounsfield = [0, 3]", ["hounsfield=(0, 3)", "positive slope"]),
    "half a rescale": ("[model]\nhounsfield = [1.0]", ["hounsfield", "two numbers"]),
    "a gap": ("[model]\ninterpolate = 1", ["interpolate", "true or false"]),
    "not given": ("[model]\nforward = nan", ["forward = nan", "a number"]),
    "no table": ("labels = 3", ["labels is a table"]),
    "far too long": ("[model]\nforward = " + "9" * 400, ["forward", "more than 64 bits"]),
    "longer than is read": ("[model]\nforward = " + "9" * 5000, ["not readable TOML"]),
    "long in hexadecimals": ("[labels]\nbone = 0x" + "f" * 5000, ["bone", "64 bits"]),
    "a long one of three": ("[labels]\nchin = [0, 1" + "0" * 400 + ", 2]", ["chin", "64 bits"]),
    "deep": ("[labels]\nchin = " + "[" * 5000 + "]" * 5000, ["nested too deep"]),
    "less deep": ("[labels]\nchin = " + "[" * 200 + "]" * 200, ["chin", "no setting"]),
}


@pytest.mark.parametrize("case", SETTINGS)
def test_files_of_settings_are_refused(case: str, tmp_path: Path) -> None:
    text, words = SETTINGS[case]
    (tmp_path / "s.toml").write_text(text)
    refused(["s.toml", *words], read_settings, tmp_path / "s.toml")
    refused(["no file of settings"], read_settings, tmp_path / "other.toml")


@pytest.mark.parametrize("word", ['a "b"', "back\\slash", "two\nlines\t\x01\x7f", "hör é", "#="])
def test_settings_are_read_as_they_were_written(word: str, tmp_path: Path) -> None:
    settings = replace(COARSE, series=word)
    for mark in (b"", b"\xef\xbb\xbf"):  # as some editors begin a file
        (tmp_path / "s.toml").write_bytes(mark + written(settings).encode())
        assert read_settings(tmp_path / "s.toml") == settings


@pytest.fixture(scope="module")
def ct(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("ct") / "ct.nrrd"
    volume = head_ct((3, 3, 3), joint=5, noise=0).volume
    write_volume(path, volume.values, volume.frame)
    return path


@cache
def truth() -> Any:
    return head_ct((3, 3, 3), joint=5, noise=0).truth


def quick(head: Any, settings: Any, masks: Any) -> Labels:
    """Labels at once: what these tests try is not how they are found."""
    return Labels(truth(), head.frame, LabelSettings(), np.zeros(3, np.int64), ("quick",))


COARSE = ModelSettings(
    sizes=Sizes(segment=12.0, skin=16.0, bone=14.0, largest=40.0, layer=1.5), tets=None, degree=1
)
STAGES = {"labels", "mesh", "case"}


@pytest.fixture
def fast(monkeypatch: pytest.MonkeyPatch) -> pytest.MonkeyPatch:
    monkeypatch.setattr(building, "labels", quick)
    for name in ("mesh_picture", "plates_picture"):
        monkeypatch.setattr(building, name, lambda path, *a, **k: path.write_bytes(b"PNG"))
    monkeypatch.setattr(building, "label_plates", lambda *a: [])
    return monkeypatch


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def test_a_stopped_run_goes_on_and_gives_the_same_bits(
    ct: Path, tmp_path: Path, fast: pytest.MonkeyPatch
) -> None:
    whole, halted = tmp_path / "whole", tmp_path / "halted"
    assert run_model(ct, whole, COARSE).kept == ()

    def stopped(*_: Any, **__: Any) -> None:
        raise KeyboardInterrupt

    with fast.context() as broken:
        broken.setattr(building, "write_landmarks", stopped)  # after mesh.npz was written
        with pytest.raises(KeyboardInterrupt):
            run_model(ct, halted, COARSE)
    assert set(contents(halted)) == {RECORD, *building.FILES["labels"]}
    (halted / ".mesh.killed").mkdir()  # what a run leaves that cannot clean up after itself
    (halted / ".mesh.killed" / "mesh.npz").write_bytes(b"half")
    again = run_model(ct, halted, COARSE)
    assert again.kept == ("labels",)
    assert contents(halted) == contents(whole)
    assert set(run_model(ct, whole, COARSE).kept) == STAGES
    (whole / "mesh.npz").unlink()
    assert run_model(ct, whole, COARSE).kept == ("labels", "case")
    assert contents(halted) == contents(whole)


def test_a_run_that_is_killed_amid_a_swap_is_made_good(
    ct: Path, tmp_path: Path, fast: pytest.MonkeyPatch
) -> None:
    """What the old mesh made is gone before the new one stands there; the next run finishes."""
    other = replace(COARSE, domain=DomainSettings(above=12))
    place, fresh = tmp_path / "m", tmp_path / "fresh"
    run_model(ct, place, COARSE)
    run_model(ct, fresh, other)
    old = contents(place)
    move = Path.replace

    def stopped(path: Path, to: Path) -> Path:
        if to == place / "mesh.npz":
            raise KeyboardInterrupt
        return move(path, to)

    with fast.context() as broken:
        broken.setattr(Path, "replace", stopped)
        with pytest.raises(KeyboardInterrupt):
            run_model(ct, place, other, overwrite=True)
    left = {path.name for path in place.iterdir() if path.is_file()}
    assert left == set(old) - set(building.FILES["case"])
    assert (place / "mesh.npz").read_bytes() == old["mesh.npz"] != (fresh / "mesh.npz").read_bytes()
    assert run_model(ct, place, other).kept == ("labels", "mesh")
    assert contents(place) == contents(fresh)


def test_one_run_at_a_time_works_in_a_folder(
    ct: Path, tmp_path: Path, fast: pytest.MonkeyPatch
) -> None:
    place = tmp_path / "m"
    with locked(place):
        mine = f"another run (process {os.getpid()})"
        refused([mine, str(place), "-o"], run_model, ct, place, COARSE)
        assert not place.exists()
        run_model(ct, tmp_path / "n", COARSE)
    assert {path.name for path in tmp_path.iterdir()} == {"n"}
    hold = f"""
from bezsoma.model.lock import locked, Path
with locked(Path({str(place)!r})):
    print("held", flush=True)
    input()
"""
    pipe = subprocess.PIPE
    with subprocess.Popen([sys.executable, "-c", hold], stdin=pipe, stdout=pipe) as other:
        assert other.stdout is not None and other.stdout.readline() == b"held\n"
        refused([f"process {other.pid}"], run_model, ct, place, COARSE)
        other.kill()
    assert (tmp_path / ".m.lock").read_text() == f"{other.pid}\n"
    assert run_model(ct, place, COARSE).kept == ()
    assert {path.name for path in tmp_path.iterdir()} == {"m", "n"}


def test_no_file_of_a_model_says_who_it_is(tmp_path: Path, fast: pytest.MonkeyPatch) -> None:
    """Name, number, birthday and identifiers of the DICOM files, also from their folder's name."""
    volume = head_ct((3, 3, 3), joint=5, noise=0).volume
    series = [
        dicom.Slice(
            plane + 1024, volume.frame.points(np.array([0, 0, k])), spacing=(3, 3),
            changes={(0x0008, 0x103E): "head of Doe"},
        )
        for k, plane in enumerate(volume.values)
    ]  # fmt: skip
    folder = dicom.written(tmp_path / "Doe^Jane 4711", series)
    assert b"Doe^Jane" in (folder / "IM0000").read_bytes()
    run_model(folder, tmp_path / "m", COARSE)
    for path in (tmp_path / "m").iterdir():
        content = path.read_bytes()
        if path.suffix == ".npz":
            with ZipFile(path) as archive:
                content += b"".join(archive.read(name) for name in archive.namelist())
        for word in (b"Doe", b"Jane", b"4711", b"19700101", b"1.2.3.4"):
            assert word not in content, f"{word!r} in {path.name}"


def test_a_full_disk_leaves_the_stages_before_it(
    ct: Path, tmp_path: Path, fast: pytest.MonkeyPatch
) -> None:
    def full(*_: Any, **__: Any) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    with fast.context() as broken:
        broken.setattr(building, "write_mesh", full)
        refused(["no space is left"], run_model, ct, tmp_path / "m", COARSE)
    assert set(contents(tmp_path / "m")) == {RECORD, *building.FILES["labels"]}
    usage = shutil.disk_usage(tmp_path)._replace(free=1000)
    fast.setattr(shutil, "disk_usage", lambda _: usage)
    refused(["MB free"], run_model, ct, tmp_path / "other", COARSE)
    assert not (tmp_path / "other").exists()


def test_what_stands_there_is_not_lost(ct: Path, tmp_path: Path, fast: pytest.MonkeyPatch) -> None:
    place = tmp_path / "m"
    run_model(ct, place, COARSE)
    other = replace(COARSE, domain=DomainSettings(above=12))
    refused(["'mesh'", "other settings", "--overwrite"], run_model, ct, place, other)
    made = run_model(ct, place, other, overwrite=True)
    assert made.kept == ("labels",)
    (place / "case.toml").write_text("mine")
    refused(["case.toml", "was changed"], run_model, ct, place, other)
    refused(["case.toml", "was changed"], run_model, ct, place, other, overwrite=True)
    twin = tmp_path / "twin.nrrd"
    volume = head_ct((3, 3, 3), joint=5, noise=1).volume
    write_volume(twin, volume.values, volume.frame)
    refused(["another picture"], run_model, twin, place, COARSE)


def test_places_that_are_not_ours_are_refused(ct: Path, tmp_path: Path) -> None:
    refused(["no file or folder"], run_model, tmp_path / "none.nrrd", tmp_path / "m")
    refused(["no folder"], run_model, ct, tmp_path / "a" / "b")
    (tmp_path / "theirs").mkdir()
    (tmp_path / "theirs" / "note.txt").write_text("keep me")
    refused(["nothing in it is touched"], run_model, ct, tmp_path / "theirs")
    refused(["is no folder"], run_model, ct, ct)
    refused(["cannot be the path"], run_model, 3, tmp_path / "m")
    assert (tmp_path / "theirs" / "note.txt").read_text() == "keep me"
    assert not (tmp_path / "m").exists()


def test_a_refused_picture_leaves_no_claim_on_a_folder(
    ct: Path, tmp_path: Path, fast: pytest.MonkeyPatch
) -> None:
    """Not a folder of ours nor one that was there, whether at the format, or in the first stage."""
    new, own = tmp_path / "new", tmp_path / "own"
    own.mkdir()
    series = tmp_path / "series"
    slices = dicom.stack(dicom.pattern())
    dicom.written(series, slices[:5] + slices[6:])
    for place in (new, own):
        refused(["none that is read"], run_model, "/dev/null", place, COARSE)
        refused(["none that is read"], run_model, ct, place, COARSE, segmentation="/dev/null")
        refused(["slices are missing"], run_model, series, place, COARSE)
    assert not new.exists() and list(own.iterdir()) == []
    with ModelFolder.at(own, "another picture", overwrite=False):
        killed = (own / RECORD).read_text()
    (own / RECORD).write_text(killed)
    new.mkdir()
    (new / ".model-0123abcd.json").write_text("{")  # the record of a run killed at its start
    for place in (new, own):
        assert run_model(ct, place, COARSE).kept == ()
    before = contents(new)
    refused(["slices are missing"], run_model, series, new, COARSE, overwrite=True)
    assert set(run_model(ct, new, COARSE).kept) == STAGES and contents(new) == before


def test_a_record_that_lost_something_is_refused(
    ct: Path, tmp_path: Path, fast: pytest.MonkeyPatch
) -> None:
    place = tmp_path / "m"
    run_model(ct, place, COARSE)
    before = contents(place)
    whole = json.loads(before[RECORD])
    for path in ([], ["stages", "labels"], ["stages", "mesh", "said"]):
        inner = whole
        for key in path:
            inner = inner[key]
        for key in list(inner):
            if key == "format":
                continue
            kept = inner.pop(key)
            (place / RECORD).write_text(json.dumps(whole))
            refused([RECORD, "not as it was written", "--overwrite"], run_model, ct, place, COARSE)
            inner[key] = kept
    (place / RECORD).write_text(json.dumps(whole | {"stages": {"labels": 3}}))
    assert run_model(ct, place, COARSE, overwrite=True).kept == ()
    assert contents(place) == before


def test_what_a_refusal_asks_for_can_be_said_in_settings(
    tmp_path: Path, fast: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A gap, two series and grey values, by the words in the messages themselves."""
    volume = head_ct((3, 3, 3), joint=5, noise=0).volume
    slices = [
        dicom.Slice(plane + 1024, volume.frame.points(np.array([0, 0, k])), spacing=(3, 3))
        for k, plane in enumerate(volume.values)
    ]
    other = dicom.stack(dicom.pattern())
    for number, one in enumerate(other):
        one.changes = {(0x0020, 0x000E): "1.2.9", (0x0008, 0x0018): f"1.2.8.{number}"}
    folder = dicom.written(tmp_path / "s", [*slices[:20], *slices[21:], *other])
    grey = tmp_path / "grey.nrrd"
    values = np.rint((volume.values.clip(-1024, 3056) + 1024) / 16).astype(np.uint8)
    write_volume(grey, values, volume.frame)
    coarse = written(COARSE)

    def made(picture: Path, *lines: str) -> int:
        words = [line.split("=")[0] for line in lines]
        rest = [line for line in coarse.splitlines() if line.split("=")[0] not in words]
        (tmp_path / "s.toml").write_text("\n".join([*rest, *lines]))
        place, settings = str(tmp_path / "m"), str(tmp_path / "s.toml")
        more = ["-q", "--overwrite", "--settings", settings]
        return cli.main(["model", str(picture), "-o", place, *more])

    one, gap = 'series = "1.2.3.4"', "interpolate = true"
    assert made(folder) == 2 and 'series = "..." in [model]' in said(capsys)
    assert made(folder, one) == 2 and f"{gap} in [model]" in said(capsys)
    assert made(folder, one, gap) == 0
    assert made(grey) == 2 and "hounsfield = [slope, intercept] in [model]" in said(capsys)
    assert made(grey, "hounsfield = [16, -1024]") == 0
    assert read_settings(tmp_path / "m" / "model.toml").hounsfield == (16, -1024)


def said(capsys: pytest.CaptureFixture[str]) -> str:
    return " ".join(capsys.readouterr().err.split())


def test_skin_that_bone_pierces_is_told() -> None:
    block = bz.block(size=(10, 10, 10), cells=(1, 1, 1))
    mesh = block.with_surface("skin", block.surfaces["front"])
    mesh = mesh.with_surface("mandible", block.surfaces["back"])
    assert building._pierced(mesh.with_surface("skull", block.surfaces["back"])) == []
    (note,) = building._pierced(mesh.with_surface("skull", block.surfaces["left"]))
    assert note.startswith("LOOK") and "at 2 vertices" in note and "more tets" in note


def test_a_poor_mesh_is_told() -> None:
    good = {"least_dihedral": 8.1, "tets": 900, "off_voxels": {"skin": 0.4, "skull": 0.5}}
    assert building._poor(good, 1000) == building._poor(good, None) == []
    poor = {"least_dihedral": 7.94, "tets": 790, "off_voxels": {"skin": 0.4, "skull": 0.51}}
    angle, surface, count = building._poor(poor, 1000)
    assert angle.startswith("LOOK") and "7.9 degrees, below 8" in angle
    assert surface.startswith("LOOK") and "skull lies 0.51 voxels" in surface
    assert count.startswith("LOOK") and "790 tets" in count and "1000 were asked" in count
    assert len(building._poor(poor, None)) == 2 and len(building._poor(poor, 790)) == 2


def test_a_poor_mesh_is_told_in_the_model(
    ct: Path, tmp_path: Path, fast: pytest.MonkeyPatch
) -> None:
    """Its notes and README.txt have the warning, here of a limit that no mesh keeps."""
    fast.setattr(building, "OFF", 0.01)
    made = run_model(ct, tmp_path / "m", COARSE)
    off = [name for name, value in made.report["off_voxels"].items() if value > 0.01]
    assert off and all(f"the surface {name} lies" in str(made.notes) for name in off)
    assert "voxels from that of the labels" in (tmp_path / "m" / "README.txt").read_text()


def test_a_model_in_the_folder_of_its_ct_is_refused(tmp_path: Path) -> None:
    refused(["folder of the CT", "-o"], run_model, tmp_path, tmp_path / "model")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("name", "lines"),
    [
        ("a.mhd", "ElementDataFile = a b.raw"),
        ("a.mha", "ElementDataFile = a b.raw"),
        ("a.mhd", "ElementDataFile = a %c.raw 98 98 1"),
        ("a.mhd", "ElementDataFile = LIST 2\na b.raw"),
        ("a.nhdr", "data file: ./a b.raw"),
        ("a.nrrd", "datafile: a b.raw"),
        ("a.nhdr", "data file: a %c.raw 98 98 1"),
        ("a.nhdr", "data file: LIST\na b.raw"),
    ],
)
def test_values_beside_a_header_count_as_the_picture(name: str, lines: str, tmp_path: Path) -> None:
    header, values = tmp_path / name, tmp_path / "a b.raw"
    header.write_text(f"NDims = 3\n{lines}\n")
    known = []
    for content in (b"one", b"two"):
        values.write_bytes(content)
        known.append(source_of(header))
    assert known[0] != known[1]


def test_slices_by_a_pattern_count_as_the_picture(tmp_path: Path) -> None:
    """As SimpleITK takes it, which reads them."""
    import SimpleITK as sitk  # noqa: N813

    header, size = tmp_path / "a.mhd", (10, 12, 14)
    header.write_text(
        f"ObjectType = Image\nNDims = 3\nDimSize = {' '.join(map(str, size))}\n"
        "ElementType = MET_SHORT\nElementSpacing = 3 3 3\nElementDataFile = s%03d.raw 0 13 1\n"
    )
    for k in range(size[2]):
        np.full(size[:2], k, np.int16).tofile(tmp_path / f"s{k:03d}.raw")
    before = source_of(header), sitk.GetArrayFromImage(sitk.ReadImage(str(header)))
    np.full(size[:2], 99, np.int16).tofile(tmp_path / "s003.raw")
    after = source_of(header), sitk.GetArrayFromImage(sitk.ReadImage(str(header)))
    assert before[0] != after[0]
    assert np.unique(np.argwhere(before[1] != after[1])[:, 0]).tolist() == [3]


@pytest.mark.parametrize(
    ("name", "head"),
    [("a.mhd", "NDims = 3\nElementDataFile = LOCAL\n"), ("a.nrrd", "NRRD0004\ndimension: 3\n\n")],
)
def test_values_in_the_file_itself_are_no_names(name: str, head: str, tmp_path: Path) -> None:
    """Bytes in which any line may stand, too long for a name, or as one of a file beside."""
    (tmp_path / "other").write_bytes(b"one")
    values = b"\0\nother\ndata file: other\n" + b"a/" * 9000 + b"\n"
    (tmp_path / name).write_bytes(head.encode() + values)
    known = source_of(tmp_path / name)
    (tmp_path / "other").write_bytes(b"two")
    assert source_of(tmp_path / name) == known
    (tmp_path / name).write_bytes(head.replace("LOCAL", "x" * 999).encode() + values)
    source_of(tmp_path / name)


def test_heads_that_are_none_leave_no_stage(tmp_path: Path) -> None:
    volume = head_ct((4, 4, 4), joint=5, noise=0).volume
    over = tmp_path / "over.nrrd"
    write_volume(over, volume.values[::-1].copy(), volume.frame)
    refused(["upside down"], run_model, over, tmp_path / "m")
    soft = tmp_path / "soft.nrrd"
    write_volume(soft, np.minimum(volume.values, 200), volume.frame)
    refused(["no bone is in view"], run_model, soft, tmp_path / "n")
    assert not (tmp_path / "m").exists() and not (tmp_path / "n").exists()
    seeds = ModelSettings(labels=LabelSettings(chin=(0, -300, 0)))
    refused(["chin=", "mm away"], run_model, ct_of(tmp_path, volume), tmp_path / "k", seeds)


def ct_of(folder: Path, volume: Any) -> Path:
    write_volume(folder / "whole.nrrd", volume.values, volume.frame)
    return folder / "whole.nrrd"


def test_the_command_says_what_it_made(
    ct: Path, tmp_path: Path, fast: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "s.toml").write_text(
        "[sizes]\nsegment = 12\nskin = 16\nbone = 14\nlargest = 40\nlayer = 1.5\n"
        "[model]\ntets = nan\ndegree = 1\n"
    )
    words = ["model", str(ct), "-o", str(tmp_path / "m"), "--settings", str(tmp_path / "s.toml")]
    assert cli.main([*words, "-q"]) == 0
    out = capsys.readouterr().out
    assert "quick" in out and "dihedral angles" in out and "case.toml" in out
    case = tmp_path / "m" / "case.toml"
    text, pictures = case.read_text(), 'pictures = ["three-quarter", "front", "right"]'
    assert pictures in text  # drawn in the demo's test; here they would take most of the time
    plain = case.with_name("plain.toml")
    plain.write_text(text.replace(pictures, "pictures = []"))
    assert cli.main(["run", str(plain), "-o", str(tmp_path / "r"), "-q"]) == 0
    assert "chin" in capsys.readouterr().out
    probes = bz.read_results(tmp_path / "r").summary["probes"]
    assert probes and all(0 < probe["error"] < 3 for probe in probes.values())  # mm, degree 1
    assert cli.main(["model", str(tmp_path / "none"), "-o", str(tmp_path / "x"), "-q"]) == 2
    assert cli.main([*words, "-q", "--tets", "5"]) == 2
