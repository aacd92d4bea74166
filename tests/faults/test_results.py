# SPDX-License-Identifier: BSD-3-Clause
"""Folders that results cannot go to, disks that are full, results that are damaged."""

from __future__ import annotations

import errno
import json
import os
import shutil
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
import pytest

from bezsoma import InputError, NotConverged, cli
from bezsoma.case import last, read_case, run_case, running, showing, writing
from bezsoma.errors import BezSomaError
from bezsoma.results import destination, read_results
from cases.written import case_file


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A results folder of the small block."""
    folder = tmp_path_factory.mktemp("finished")
    run_case(read_case(case_file(folder)), folder / "out")
    return folder / "out"


@pytest.fixture
def results(finished: Path, tmp_path: Path) -> Path:
    """A copy of that folder, to be damaged."""
    return Path(shutil.copytree(finished, tmp_path / "out"))


def refusal(folder: Path, *, overwrite: bool = False) -> str:
    """What is said of a folder in which no results can be put."""
    with pytest.raises(InputError) as caught:
        destination(folder, overwrite=overwrite)
    return str(caught.value)


def damage(folder: Path) -> str:
    """What is said of a folder from which no results can be read."""
    with pytest.raises(InputError) as caught:
        read_results(folder)
    return str(caught.value)


def test_results_are_not_overwritten_unless_told_so(results: Path) -> None:
    said = refusal(results)
    assert "results already stand in" in said
    assert "--overwrite" in said
    assert destination(results, overwrite=True).replaces


def test_a_folder_that_is_not_ours_is_never_replaced(tmp_path: Path) -> None:
    (tmp_path / "thesis").mkdir()
    (tmp_path / "thesis" / "chapter.tex").write_text("years of work")
    for overwrite in (False, True):
        said = refusal(tmp_path / "thesis", overwrite=overwrite)
        assert "is not a results folder of BezSoma" in said
        assert "another folder with -o" in said
    assert (tmp_path / "thesis" / "chapter.tex").read_text() == "years of work"


def test_a_summary_of_another_program_does_not_make_a_folder_ours(tmp_path: Path) -> None:
    for number, text in enumerate(["{}", "[]", "not json", '{"format": "bezsoma results 99"}']):
        folder = tmp_path / str(number)
        folder.mkdir()
        (folder / "summary.json").write_text(text)
        assert "not a results folder" in refusal(folder, overwrite=True)


def test_a_results_folder_with_a_stranger_in_it_is_kept(results: Path) -> None:
    (results / "notes.txt").write_text("mine")
    said = refusal(results, overwrite=True)
    assert "['notes.txt']" in said
    assert "will not delete" in said


def test_a_file_in_the_place_of_the_folder_is_refused(tmp_path: Path) -> None:
    (tmp_path / "out").write_text("")
    assert "is a file, not a folder" in refusal(tmp_path / "out", overwrite=True)


def test_a_link_in_the_place_of_the_folder_is_refused(results: Path, tmp_path: Path) -> None:
    (tmp_path / "link").symlink_to(results)
    assert "is a link" in refusal(tmp_path / "link", overwrite=True)
    (tmp_path / "dangling").symlink_to(tmp_path / "nowhere")
    assert "is a link" in refusal(tmp_path / "dangling")


def test_a_missing_parent_is_refused(tmp_path: Path) -> None:
    said = refusal(tmp_path / "there" / "out")
    assert str(tmp_path / "there") in said
    assert "does not exist; make it first" in said


def test_a_name_longer_than_the_system_takes_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="File name too long"):
        destination(tmp_path / ("a" * 300))


def test_a_file_as_parent_is_refused(tmp_path: Path) -> None:
    (tmp_path / "there").write_text("")
    assert "is not a folder" in refusal(tmp_path / "there" / "out")


@pytest.mark.parametrize(
    ("number", "said"),
    [
        (errno.EROFS, "that disk is read-only"),
        (errno.EACCES, "you may not write there"),
        (errno.EPERM, "you may not write there"),
        (errno.ENOSPC, "no space is left on that disk"),
        (errno.EDQUOT, "your quota on that disk is used up"),
        (errno.EIO, "that disk does not take it"),
        (errno.ENAMETOOLONG, "the system says 'File name too long'; try again, or choose another"),
    ],
)
def test_a_place_where_nothing_can_be_made_is_refused_before_any_work(
    number: int, said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: Any, **__: Any) -> NoReturn:
        raise OSError(number, os.strerror(number))

    monkeypatch.setattr("bezsoma.results.folder.tempfile.mkdtemp", refuse)
    monkeypatch.setattr(running, "mesh_of", lambda case: pytest.fail("work was begun"))
    with pytest.raises(InputError) as caught:
        run_case(read_case(case_file(tmp_path)), tmp_path / "out")
    assert said in str(caught.value)
    assert "another folder with -o" in str(caught.value)


def test_too_little_room_is_found_before_solving(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    usage = shutil.disk_usage(tmp_path)._replace(free=1000)
    monkeypatch.setattr("bezsoma.results.folder.shutil.disk_usage", lambda path: usage)
    monkeypatch.setattr(
        "bezsoma.case.refining.solve", lambda *a, **k: pytest.fail("solving was begun")
    )
    with pytest.raises(InputError, match="MB free; no space is left"):
        run_case(read_case(case_file(tmp_path)), tmp_path / "out")


@pytest.mark.parametrize("file", ["displacement.npz", "summary.json", "README.txt", "case.toml"])
def test_a_disk_that_fills_up_leaves_nothing_behind(
    file: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The real thing: the file to be written is a link to a device that is always full."""
    if not Path("/dev/full").exists():
        pytest.skip("this system has no /dev/full")
    write = running.write_results

    def onto_a_full_disk(folder: Path, *rest: Any) -> None:
        (folder / file).symlink_to("/dev/full")
        write(folder, *rest)

    monkeypatch.setattr(running, "write_results", onto_a_full_disk)
    case = read_case(case_file(tmp_path))
    with pytest.raises(InputError, match="no space is left on that disk"):
        run_case(case, tmp_path / "out")
    assert [path.name for path in tmp_path.iterdir()] == ["case.toml"]


@pytest.mark.parametrize("stop", [KeyboardInterrupt, NotConverged("no"), MemoryError, OSError])
def test_a_run_that_is_stopped_leaves_what_was_there(
    stop: Any, results: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = {path.name: path.read_bytes() for path in results.iterdir()}
    write = running.write_results

    def stopped(*given: Any) -> NoReturn:
        write(*given)
        raise stop

    monkeypatch.setattr(running, "write_results", stopped)
    with pytest.raises(BaseException):  # noqa: B017
        run_case(read_case(case_file(tmp_path)), results, overwrite=True)
    assert {path.name: path.read_bytes() for path in results.iterdir()} == before
    assert sorted(path.name for path in tmp_path.iterdir()) == ["case.toml", "out"]


def test_a_replacement_that_fails_halfway_puts_the_old_results_back(
    results: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = {path.name: path.read_bytes() for path in results.iterdir()}
    rename = Path.rename

    def refuse_the_new(self: Path, target: Path) -> Path:
        if Path(target) == results and ".old." not in str(self):
            raise OSError(errno.EIO, "input/output error")
        return rename(self, target)

    place = destination(results, overwrite=True)
    monkeypatch.setattr(Path, "rename", refuse_the_new)
    with pytest.raises(InputError, match="cannot write the results"), place.filling() as partial:
        (partial / "new").write_text("")
    assert {path.name: path.read_bytes() for path in results.iterdir()} == before
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


def test_a_folder_that_appears_meanwhile_is_not_replaced(tmp_path: Path) -> None:
    place = destination(tmp_path / "out")
    with pytest.raises(InputError, match="exists and is not"), place.filling():
        (tmp_path / "out").mkdir()
        (tmp_path / "out" / "theirs").write_text("")
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


def test_a_folder_that_is_not_there_has_no_results(tmp_path: Path) -> None:
    said = damage(tmp_path / "nowhere")
    assert "does not exist" in said
    assert "give the folder of a run" in said


def test_a_file_or_another_folder_has_no_results(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    assert "it is a file" in damage(tmp_path / "file")
    assert "has no 'summary.json'" in damage(tmp_path)


@pytest.mark.parametrize("file", ["case.toml", "mesh.npz", "displacement.npz"])
def test_a_missing_file_is_named(file: str, results: Path) -> None:
    (results / file).unlink()
    assert f"damaged: '{file}' is missing; run the case again" in damage(results)


def test_a_damaged_summary_is_named(results: Path) -> None:
    (results / "summary.json").write_text('{"format": ')
    assert "is damaged" in damage(results)
    (results / "summary.json").write_text('{"format": "bezsoma results 99"}')
    assert "'bezsoma results 99', and this version reads 'bezsoma results 1'" in damage(results)


@pytest.mark.parametrize("file", ["mesh.npz", "displacement.npz"])
def test_a_truncated_file_is_refused(file: str, results: Path) -> None:
    whole = (results / file).read_bytes()
    for part in (b"", whole[:40], whole[: len(whole) // 2]):
        (results / file).write_bytes(part)
        assert file in damage(results)


def test_a_flipped_bit_is_refused(results: Path) -> None:
    path = results / "displacement.npz"
    whole = bytearray(path.read_bytes())
    whole[len(whole) // 2] ^= 4
    path.write_bytes(whole)
    assert "displacement.npz" in damage(results)


def read_or_refused(folder: Path) -> str | None:
    """What is said of damaged results, None where they were read; nothing else may come out."""
    try:
        read_results(folder)
    except BezSomaError as error:
        return str(error)
    return None


@pytest.mark.parametrize("file", ["mesh.npz", "displacement.npz"])
def test_flipped_bytes_are_refused_or_do_no_harm(file: str, results: Path) -> None:
    """Zip, zlib and NumPy each have their own errors; the reader of results sees one kind."""
    path, good = results / file, read_results(results)
    whole = path.read_bytes()
    random = np.random.default_rng(20240)
    for _ in range(100):
        damaged = np.frombuffer(whole, dtype=np.uint8).copy()
        at = random.integers(30, len(whole), size=random.integers(1, 4))
        damaged[at] ^= random.integers(1, 256, size=len(at), dtype=np.uint8)
        path.write_bytes(damaged.tobytes())
        said = read_or_refused(results)
        if said is None:
            back = read_results(results)
            assert back.displacement.controls.tobytes() == good.displacement.controls.tobytes()
            assert back.mesh.points.tobytes() == good.mesh.points.tobytes()
        else:
            assert file in said, said


def test_a_method_of_compression_that_is_not_known_is_refused(results: Path) -> None:
    """The two bytes that name the method, in every entry of the archive's directory."""
    path = results / "displacement.npz"
    entry, method = b"PK\x01\x02", 10
    parts = path.read_bytes().split(entry)
    path.write_bytes(
        entry.join([parts[0], *(p[: method - 4] + b"\x63\0" + p[method - 2 :] for p in parts[1:])])
    )
    assert "displacement.npz' is damaged" in damage(results)


def test_a_case_that_is_no_text_is_refused(results: Path) -> None:
    (results / "case.toml").write_bytes(b"\xff\xfe")
    assert "case.toml' is damaged" in damage(results)


def changed(results: Path, **arrays: Any) -> str:
    """What is said when some arrays of the displacement are replaced."""
    path = results / "displacement.npz"
    with np.load(path) as stored:
        np.savez(path, **{**dict(stored), **arrays})
    return damage(results)


def test_controls_that_do_not_fit_the_mesh_are_refused(results: Path) -> None:
    said = changed(results, controls=np.zeros((7, 3)))
    assert "does not fit the mesh beside it" in said
    assert "(7, 3)" in said
    assert "does not fit" in changed(results, degree=np.int64(3))
    said = changed(results, degree=np.int64(99))
    assert "displacement.npz' is damaged (degree 99" in said and "run the case again" in said


def test_controls_that_are_no_numbers_are_refused(results: Path) -> None:
    with np.load(results / "displacement.npz") as stored:
        controls = stored["controls"].copy()
    controls[3, 1] = np.nan
    assert "a control is not a number" in changed(results, controls=controls)


def test_tets_with_controls_that_do_not_exist_are_refused(results: Path) -> None:
    with np.load(results / "displacement.npz") as stored:
        of_tet = stored["of_tet"].copy()
    of_tet[0, 0] = 10**6
    assert "does not fit" in changed(results, of_tet=of_tet)


def test_an_array_that_is_missing_is_refused(results: Path) -> None:
    np.savez(results / "displacement.npz", degree=2)
    assert "displacement.npz' is damaged" in damage(results)


def test_results_with_the_tets_of_another_numbering_are_read_the_same(results: Path) -> None:
    """Another version may number the controls otherwise; the field is the same all the same."""
    before = read_results(results).displacement
    with np.load(results / "displacement.npz") as stored:
        of_tet, controls = stored["of_tet"], stored["controls"]
    shuffled = np.random.default_rng(1).permutation(len(controls))
    moved = np.empty_like(controls)
    moved[shuffled] = controls
    np.savez(results / "displacement.npz", degree=2, of_tet=shuffled[of_tet], controls=moved)
    assert np.array_equal(read_results(results).displacement.controls, before.controls)


def test_the_list_of_files_in_the_summary_is_what_the_folder_holds(finished: Path) -> None:
    summary = json.loads((finished / "summary.json").read_text())
    assert summary["files"] == sorted(path.name for path in finished.iterdir())


# What a neo-Hookean block whose right side is pushed through its left comes to.
CRUSHED = (
    ("E = 0.015\nnu = 0.3", 'law = "neo-hooke"\nE = 0.015\nnu = 0.3'),
    ("translation = [0.1, 0, 0]", "translation = [-2.5, 0, 0]"),
    ("pictures = []", 'pictures = ["front"]'),
)


def test_the_last_state_in_balance_is_kept_and_marked(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, out, kept = case_file(tmp_path, *CRUSHED), tmp_path / "out", tmp_path / "kept"
    words = ["run", str(path), "-q", "-o", str(out), "--keep-last", str(kept)]
    assert cli.main(words) == 1
    said = capsys.readouterr().err
    assert f"the last state in balance is in {str(kept)!r}, marked as no answer" in said
    assert "`" not in said
    assert not out.exists()
    results = read_results(kept)
    fraction = results.summary["unfinished"]["fraction"]
    assert 0.1 < fraction < 1
    mark = f"NOT THE ANSWER ({100 * fraction:.4g} % of the load)"
    assert results.unfinished == mark
    assert results.summary["title"] == f"{mark}: A block"
    assert "no equilibrium was found" in results.summary["unfinished"]["why"]
    assert results.summary["expectations"] == []
    moved = results.displacement.at(np.array([[2.0, 0.5, 0.5]]))[0, 0]
    assert moved == pytest.approx(-2.5 * fraction, rel=1e-12)
    readme = (kept / "README.txt").read_text(encoding="utf-8")
    assert readme.startswith(f"{mark}: A block\n")
    assert "Beware: this is not the answer but the last state in balance" in readme
    assert (kept / "case.toml").read_bytes() == path.read_bytes()
    assert (kept / "before-after-front.png").is_file()
    assert cli.main(words) == 2
    said = capsys.readouterr().err
    assert "results already stand in" in said and "another folder with --keep-last" in said


def test_without_a_folder_the_command_says_how_to_keep_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = case_file(tmp_path, *CRUSHED[:2])
    assert cli.main(["run", str(path), "-q", "-o", str(tmp_path / "out")]) == 1
    said = capsys.readouterr().err
    assert "run again with --keep-last FOLDER (keep_last= of run_case)" in said
    assert "`" not in said
    assert [each.name for each in tmp_path.iterdir()] == ["case.toml"]


def test_pictures_of_what_is_no_answer_say_so_whatever_their_title(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    titles: list[str] = []

    def drawn(shots: Any, view: Any, title: str, *rest: Any) -> bytes:
        titles.append(title)
        return b""

    path = case_file(tmp_path, *CRUSHED[:2])
    with pytest.raises(NotConverged, match="marked as no answer") as failure:
        run_case(path, tmp_path / "out", keep_last=tmp_path / "kept")
    assert failure.value.last is not None and failure.value.path
    monkeypatch.setattr(showing, "page", drawn)
    mark = read_results(tmp_path / "kept").unfinished
    for title in (None, "Mine"):
        showing.results_picture(None, tmp_path / "kept", field=None, title=title)
    assert titles == [f"{mark}: A block", f"{mark}: Mine"]


def test_pictures_of_fields_of_what_is_no_answer_say_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    titles: list[str] = []
    monkeypatch.setattr(writing, "face_picture", lambda *given, **how: None)
    monkeypatch.setattr(writing, "picture", lambda *given, title, **how: titles.append(title))
    fields = ("pictures = []", 'pictures = ["front"]\nfields = ["determinant"]')
    path = case_file(tmp_path, *CRUSHED[:2], fields)
    with pytest.raises(NotConverged, match="marked as no answer"):
        run_case(path, tmp_path / "out", keep_last=tmp_path / "kept")
    mark = read_results(tmp_path / "kept").unfinished
    assert len(titles) == 1 and titles[0].startswith(f"{mark}: det(I + grad u) - 1")


def test_a_last_state_inside_out_is_kept_without_a_picture_of_its_stress(tmp_path: Path) -> None:
    fields = ("pictures = []", 'pictures = ["front"]\nfields = ["von_mises", "determinant"]')
    path, kept = case_file(tmp_path, *CRUSHED[:2], fields), tmp_path / "kept"
    with pytest.raises(NotConverged, match="marked as no answer"):
        run_case(path, tmp_path / "out", keep_last=kept)
    pictures = {each.name for each in kept.glob("*.png")}
    assert "determinant-front.png" in pictures and "von_mises-front.png" not in pictures
    assert set(read_results(kept).summary["pictures"]) == pictures


def test_nothing_is_kept_of_a_body_that_bore_nothing(tmp_path: Path) -> None:
    path = case_file(tmp_path, *CRUSHED[:2], ("[output]", "[solver]\nsteps = 1\n\n[output]"))
    with pytest.raises(NotConverged, match="nothing under load was in balance, and none is kept"):
        run_case(path, tmp_path / "out", keep_last=tmp_path / "kept")
    assert [each.name for each in tmp_path.iterdir()] == ["case.toml"]


def test_the_last_state_is_not_kept_where_the_answer_would_be(tmp_path: Path) -> None:
    path = case_file(tmp_path)
    with pytest.raises(InputError, match="give it a folder of its own"):
        run_case(path, tmp_path / "out", keep_last=tmp_path / "out")
    results = run_case(path, tmp_path / "out", keep_last=tmp_path / "kept")
    assert results.unfinished == "" and not (tmp_path / "kept").exists()


def test_a_disk_that_fills_does_not_hide_why_there_is_no_answer(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*given: Any) -> None:
        raise OSError(errno.ENOSPC, "full")

    monkeypatch.setattr(last, "write_results", full)
    path = case_file(tmp_path, *CRUSHED[:2])
    with pytest.raises(NotConverged, match=r"could not be kept: .*with --keep-last") as failure:
        run_case(path, tmp_path / "out", keep_last=tmp_path / "kept")
    assert "no equilibrium was found" in str(failure.value)
    assert "no space is left" in str(failure.value)
    assert [each.name for each in tmp_path.iterdir()] == ["case.toml"]
