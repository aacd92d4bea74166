# SPDX-License-Identifier: BSD-3-Clause
"""Bodies cut open, overlays, films, side by side, convergence, windows: what is seen, and where."""

from __future__ import annotations

import io
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from bezsoma import Shot, convergence_picture, film, picture, side_by_side
from bezsoma.errors import InputError, MissingExtra
from bezsoma.mesh import ControlNet, Field, TetMesh, block
from bezsoma.mesh.solids import ball
from bezsoma.view import movie, window
from bezsoma.view.camera import Camera, around, axes, fitted, turned
from bezsoma.view.film import angles, shares
from bezsoma.view.overlays import Screen, control_net, net_points, wireframe
from bezsoma.view.pieces import clipped
from bezsoma.view.sections import Section
from bezsoma.view.sheet import gif
from bezsoma.view.shot import bar_of, panel
from bezsoma.view.surfaces import displaced

SMALL = (300, 320)


def field(mesh: TetMesh, degree: int, function: Any) -> Field:
    return Field.interpolating(ControlNet(mesh, degree), function)


def bent(mesh: TetMesh) -> Field:
    """Bends along x, upwards by x**2 / 40."""
    return field(mesh, 2, lambda x: np.c_[0 * x[:, 0], 0 * x[:, 0], x[:, 0] ** 2 / 40])


def bar() -> TetMesh:
    return block((20.0, 6.0, 6.0), (2, 1, 1))


def pixels(content: bytes) -> np.ndarray:
    return np.asarray(Image.open(io.BytesIO(content)).convert("RGB"), float)


def test_the_colours_on_a_cut_are_those_of_the_field_in_the_plane() -> None:
    mesh = bar()
    inside = field(mesh, 3, lambda x: (x[:, 1] - 3) ** 2 * x[:, 0])
    shot = Shot(mesh, inside, plane="y=3.0", table="viridis").checked("")
    camera = fitted("front", shot.subject.points(), (400, 200))
    seen = shot.seen(camera)
    assert np.abs(seen.numbers()).max() < 1e-12  # on the walls it is up to 180
    shot = Shot(mesh, inside, plane="y=1.0").checked("")
    numbers = shot.seen(camera).numbers()
    assert np.isclose(numbers.max(), 4 * 20) and abs(numbers.min()) < 1e-12


def test_what_stands_before_the_plane_is_gone_whichever_way_its_normal_points() -> None:
    mesh = bar()
    for view, plane, axis, kept in (
        ("front", "y=2", 1, (2, 6)),
        ("back", "y=2", 1, (0, 2)),
        ("left", "x=5", 0, (0, 5)),
        ("right", "x=5", 0, (5, 20)),
    ):
        shot = Shot(mesh, plane=plane).checked("")
        camera = fitted(view, shot.subject.points(), SMALL)
        points = np.concatenate(
            [part.surface.points.reshape(-1, 3)[:, axis] for part in shot.seen(camera).solid]
        )
        assert np.allclose([points.min(), points.max()], kept), view


def test_a_cut_moves_with_the_body_or_cuts_it_where_it_came_to() -> None:
    mesh, upward = bar(), bent(bar())
    moved = Field(ControlNet(mesh, 2), upward.controls)
    camera = Camera(axes("top"), np.zeros(3), 5.0, SMALL)
    now = Section.of(mesh, "z=5", moved, False, camera).face(None, None, False)[0]
    assert np.abs(now.points[..., 2] - 5).max() < 1e-12
    before = Section.of(mesh, "z=5", moved, True, camera).face(None, None, False)[0]
    x, _, z = before.points.reshape(-1, 3).T
    assert np.allclose(z, 5 + x**2 / 40, atol=1e-12)
    slope = np.stack([-x / 20, 0 * x, 1 + 0 * x], axis=1)
    slope /= np.linalg.norm(slope, axis=1)[:, None]
    assert np.allclose(before.normals.reshape(-1, 3), slope, atol=1e-12)
    rims = now.rims.sum()
    wired = Section.of(mesh, "z=5", moved, False, camera).face(None, None, True)[0].rims.sum()
    assert 0 < rims < wired


def test_a_clipped_surface_keeps_its_area_and_its_rims() -> None:
    mesh = block((4.0, 4.0, 1.0), (2, 2, 1))
    top = displaced(mesh, mesh.facets_of("top"), None, longest=1.0)
    half = clipped(top, top.points[..., 0] - 1.7)
    a, b, c = np.moveaxis(half.points, 1, 0)
    assert np.isclose(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2, 1.7 * 4)
    assert np.allclose(half.normals, [0, 0, 1])
    sides = half.points[:, [[1, 2], [2, 0], [0, 1]]][half.rims]
    on_cut = (np.abs(sides[..., 0] - 1.7) < 1e-12).all(axis=1)
    assert not on_cut.any() and len(sides)


def test_the_mesh_before_stands_where_it_stood() -> None:
    mesh = bar()
    shot = Shot(mesh, displacement=bent(mesh), before=True).checked("")
    camera = fitted("front", shot.subject.points(), SMALL)
    (strokes,) = shot.seen(camera).strokes
    corners = camera.pixels(mesh.points)
    ends = strokes.segments.reshape(-1, 2)
    assert strokes.label == "before" and len(ends)
    assert (ends.min(axis=0) >= corners.min(axis=0) - 1e-9).all()
    assert (ends.max(axis=0) <= corners.max(axis=0) + 1e-9).all()
    screen = Screen.of(camera, [displaced(mesh, mesh.boundary, None)])
    seen = wireframe(shot.subject, screen).segments
    length = np.linalg.norm(np.diff(seen, axis=1), axis=2).sum() / camera.scale
    assert length < 2 * (20 + 6) + 6 + 2 * np.hypot(10, 6) + 2 * (20 + 20)  # the back is hidden


def test_a_cut_hides_what_stood_behind_it_before_the_move() -> None:
    mesh = bar()
    shot = Shot(mesh, displacement=bent(mesh), before=True, plane="y=3").checked("")
    camera = fitted("front", shot.subject.points(), SMALL)
    (strokes,) = shot.seen(camera).strokes
    corners = camera.pixels(mesh.points)
    low, high = corners.min(axis=0), corners.max(axis=0)
    middle = strokes.segments.mean(axis=1)
    inner = ((middle > low + 2) & (middle < high - 2)).all(axis=1)
    assert not inner.any()  # the back wall has edges across, and a diagonal to each
    missed = Shot(mesh, displacement=shot.displacement, before=True, plane="z=8").checked("")
    below = fitted("top", missed.subject.points(), SMALL)
    assert missed.seen(below).strokes[0].label == "before"  # cut after the move alone


def test_a_cut_shows_the_outline_of_what_stood_there_before_the_move() -> None:
    mesh = ball(30.0, cells=4)
    shift = field(mesh, 1, lambda p: np.array([3.0, 0.0, 1.0]) + 0 * p)
    shot = Shot(mesh, displacement=shift, before=True, plane="y=1").checked("")
    camera = fitted("front", shot.subject.points(), SMALL)
    (strokes,) = shot.seen(camera).strokes
    ends = strokes.segments.reshape(-1, 2) - camera.pixels(np.zeros((1, 3)))
    radii = np.linalg.norm(ends, axis=1) / camera.scale
    assert len(radii) > 30 and radii.min() > 0.9 * 30 and radii.max() <= 30
    turned = np.sort(np.arctan2(*ends.T))
    assert np.diff(turned, append=turned[0] + 2 * np.pi).max() < 0.5  # it goes all the way round


@pytest.mark.parametrize("plane", ["x=20", "x=20.5"])
def test_a_plane_may_cut_what_came_to_it_by_the_move_alone(plane: str) -> None:
    mesh = bar()
    drawn_out = field(mesh, 1, lambda p: p * [0.1, 0, 0])
    shot = Shot(mesh, displacement=drawn_out, before=True, plane=plane).checked("")
    camera = fitted("right", shot.subject.points(), SMALL)
    seen = shot.seen(camera)
    assert seen.strokes[0].label == "before"
    assert any(np.ptp(part.surface.points[..., 0]) < 1e-9 for part in seen.solid)


def test_the_control_net_is_drawn_at_the_controls_and_not_on_the_surface() -> None:
    mesh = bar()
    shot = Shot(mesh, displacement=bent(mesh), net=True).checked("")
    camera = fitted("front", shot.subject.points(), SMALL)
    (strokes,) = shot.seen(camera).strokes
    assert strokes.dots is not None
    # x**2 / 40 on an edge from 0 to 10 has the middle control 0, where its value is 25 / 40
    control = camera.pixels(np.array([5.0, 0.0, 6.0]))
    assert np.abs(strokes.dots - control).max(axis=1).min() < 1e-9
    value = camera.pixels(np.array([5.0, 0.0, 6.0 + 25 / 40]))
    assert np.abs(strokes.dots - value).max(axis=1).min() > 1
    screen = Screen.of(camera, [displaced(mesh, mesh.boundary, shot.displacement, 0.01)])
    assert len(control_net(shot.subject, screen).dots) < ControlNet(mesh, 2).count  # type: ignore[arg-type]


@pytest.mark.parametrize("carried", [True, False])
def test_the_control_net_of_what_was_cut_away_is_gone(carried: bool) -> None:
    mesh = block((20.0, 6.0, 6.0), (2, 2, 1))
    moved = field(mesh, 2, lambda x: np.c_[0 * x[:, 0], 0 * x[:, 0] + 4, x[:, 0] ** 2 / 40])
    y = "y=3" if carried else "y=7"  # the same cut: all goes 4 mm to the back
    shot = Shot(mesh, displacement=moved, net=True, plane=y, carried=carried).checked("")
    camera = fitted("three-quarter", shot.subject.points(), SMALL)
    (strokes,) = shot.seen(camera).strokes
    drawn, points = strokes.dots, net_points(shot.subject)[0]
    assert drawn is not None and len(drawn)
    behind = camera.pixels(points[points[:, 1] >= 7 - 1e-9])
    off = np.abs(drawn[:, None] - behind[None]).max(axis=2).min(axis=1)
    assert off.max() < 1e-9  # each dot is a control of what is left


def test_what_is_translucent_lets_through_what_lies_behind() -> None:
    mesh = block((10.0, 10.0, 10.0), (2, 2, 2))
    plain = dict(view="front", size=SMALL)
    through = pixels(picture(None, mesh, translucent="front", **plain))  # type: ignore[arg-type]
    removed = pixels(picture(None, mesh, translucent="back", **plain))  # type: ignore[arg-type]
    middle = (slice(140, 180), slice(130, 170))
    assert np.abs(through[middle] - removed[middle]).mean() > 3
    with pytest.raises(InputError, match="all that would be seen is translucent"):
        picture(None, mesh, surface="front", translucent="front")


def test_levels_stand_inside_where_the_field_has_them_and_move_along() -> None:
    mesh = block((10.0, 10.0, 10.0), (2, 2, 2))
    round_ = field(mesh, 2, lambda x: ((x - 5) ** 2).sum(axis=1))
    moved = field(mesh, 1, lambda x: np.c_[x[:, 0], 0 * x[:, 0], 0 * x[:, 0]])
    shot = Shot(mesh, round_, moved, levels=(4.0, 9.0)).checked("")
    camera = fitted("front", shot.subject.points(), (60, 60))
    seen = shot.seen(camera)
    assert seen.veil is not None and len(seen.solid) == 2
    for part, radius in zip(seen.solid, (2, 3), strict=True):
        x = part.surface.points.reshape(-1, 3) / [2, 1, 1] - 5  # back to where it was
        assert np.abs(np.linalg.norm(x, axis=1) - radius).max() < 1e-12
        normal = x / [2, 1, 1]  # of an ellipsoid twice as long
        normal /= np.linalg.norm(normal, axis=1)[:, None]
        assert np.allclose(part.surface.normals.reshape(-1, 3), normal, atol=1e-12)
    scale = bar_of([shot], [seen])
    assert scale is not None and np.allclose(scale.limits, (4, 75))
    assert panel(shot, seen, camera, "", scale).colours.shape == (60, 60, 3)
    with pytest.raises(InputError, match="levels are those of a scalar colour"):
        picture(None, mesh, moved, levels=(1.0,))
    with pytest.raises(InputError, match="does not reach the level 99"):
        picture(None, mesh, round_, levels=(99.0,))


def test_side_by_side_has_one_scale_and_one_range() -> None:
    mesh, other = bar(), block((10.0, 6.0, 6.0), (1, 1, 1))
    small = field(other, 1, lambda x: x[:, 0])
    large = field(mesh, 1, lambda x: x[:, 0])
    shots = [Shot(other, small).checked(""), Shot(mesh, large).checked("")]
    seen = [shot.seen(fitted("front", shot.subject.points(), SMALL)) for shot in shots]
    scale = bar_of(shots, seen)
    assert scale is not None and np.allclose(scale.limits, (0, 20))
    sheet = Image.open(io.BytesIO(side_by_side(None, shots, size=(600, 300))))
    assert sheet.size == (600, 300)
    with pytest.raises(InputError, match="1 to 4"):
        side_by_side(None, shots * 3)


def test_a_film_has_its_frames_and_they_differ() -> None:
    mesh = bar()
    shot = Shot(mesh, displacement=bent(mesh))
    calls: list[tuple[int, int]] = []
    content = film(
        None, shot, frames=6, seconds=1.2, size=(240, 240), progress=lambda *a: calls.append(a)
    )
    shown = Image.open(io.BytesIO(content))
    assert shown.n_frames == 6 and shown.info["loop"] == 0  # type: ignore[attr-defined]
    assert calls == [(k, 6) for k in range(6)]
    frames = []
    for number in range(6):
        shown.seek(number)
        frames.append(np.asarray(shown.convert("RGB"), float))
        assert shown.info["duration"] == 200
    differ = [np.abs(a - b).mean() for k, a in enumerate(frames) for b in frames[:k]]
    assert min(differ) > 0.2


def decoded(content: bytes) -> tuple[list[np.ndarray], float]:
    """The frames of an MP4 and how long it lasts, s."""
    av = pytest.importorskip("av", reason="PyAV is not installed: the extra film")
    with av.open(io.BytesIO(content)) as file:
        frames = [frame.to_ndarray(format="rgb24") for frame in file.decode(video=0)]
        return frames, float(file.streams.video[0].duration * file.streams.video[0].time_base)


def test_an_mp4_shows_the_frames_it_was_given() -> None:
    pytest.importorskip("av", reason="PyAV is not installed: the extra film")
    across, down = np.meshgrid(np.linspace(0, 1, 81), np.linspace(0, 1, 60))
    frames = [
        np.rint(255 * np.stack([across, down, 0 * across + k / 9], axis=2)).astype(np.uint8)
        for k in range(10)
    ]
    shown, lasts = decoded(movie.mp4(frames, 0.125))
    assert len(shown) == 10 and abs(lasts - 1.25) < 1e-6
    assert shown[0].shape == (60, 82, 3)
    for frame, given in zip(shown, frames, strict=True):
        assert np.abs(frame[:, :81].astype(float) - given).mean() < 3
        assert np.abs(frame[:, 81].astype(float) - given[:, 80]).mean() < 6


def test_a_film_is_an_mp4_where_its_name_says_so(tmp_path: Path) -> None:
    pytest.importorskip("av", reason="PyAV is not installed: the extra film")
    mesh = bar()
    shot, how = Shot(mesh, displacement=bent(mesh)), {"frames": 4, "seconds": 1.0}
    content = film(tmp_path / "a.mp4", shot, size=(241, 253), **how)  # type: ignore[arg-type]
    assert (tmp_path / "a.mp4").read_bytes() == content
    shown, lasts = decoded(content)
    assert len(shown) == 4 and abs(lasts - 1.0) < 1e-6 and shown[0].shape == (254, 242, 3)
    still = Image.open(io.BytesIO(film(None, shot, size=(241, 253), **how)))  # type: ignore[arg-type]
    still.seek(2)
    same = np.asarray(still.convert("RGB"), float)
    assert (
        np.abs(shown[2][:253, :241] - same).mean() < 4 < np.abs(shown[1][:253, :241] - same).max()
    )
    with pytest.raises(InputError, match=r"hold a GIF or MP4; end it in \.gif or \.mp4"):
        film(tmp_path / "a.avi", shot)


def test_without_the_extra_an_mp4_says_what_to_install_before_any_work(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setitem(sys.modules, "av", None)
    drawn: list[int] = []
    shot = Shot(bar(), displacement=bent(bar()))
    with pytest.raises(MissingExtra, match=r"bezsoma\[film\]"):
        film(tmp_path / "a.mp4", shot, progress=lambda *_: drawn.append(1))
    assert not drawn and not list(tmp_path.iterdir())


def test_the_viewer_walks_around_at_one_scale_and_up_stays_up() -> None:
    assert np.allclose(turned(axes("front"), 180), axes("back"), atol=1e-12)
    frames = [turned(axes("three-quarter"), angle) for angle in angles(360, 12)]
    assert all(np.isclose(np.linalg.det(frame), 1) for frame in frames)
    tilts = np.array([frame[:, 2] for frame in frames])  # of the patient's up: no roll, one height
    assert np.allclose(tilts, tilts[0], atol=1e-12) and np.allclose(tilts[:, 0], 0, atol=1e-12)
    points = bar().points
    cameras = around(frames, points, SMALL)
    assert len({camera.scale for camera in cameras}) == 1
    landed = np.stack([camera.pixels(points) for camera in cameras])
    assert (landed > 0).all() and (landed < np.array(SMALL)).all()
    assert shares(4)[0] == 0 and max(shares(36)) == 1
    assert max(angles(40.0, 8)) == 20 and min(angles(40.0, 8)) == -20


def test_few_frames_all_have_their_colours() -> None:
    plain = [np.full((8, 8, 3), 255 * each, np.uint8) for each in np.eye(3, dtype=np.uint8)]
    with Image.open(io.BytesIO(gif(plain, 0.1))) as shown:
        for number, frame in enumerate(plain):
            shown.seek(number)
            assert np.abs(np.asarray(shown.convert("RGB"), float) - frame).max() < 8


def test_a_film_that_cannot_be_made_says_why() -> None:
    mesh = bar()
    shot = Shot(mesh, displacement=bent(mesh))
    for call, message in (
        (lambda: film(None, Shot(mesh)), "nothing moves"),
        (lambda: film(None, shot, frames=1), "give 2 to 240"),
        (lambda: film(None, shot, seconds=0.1), "0.02 s or more"),
        (lambda: film(None, shot, turn=900), "give -360 to 360"),
        (lambda: film(None, shot, view="frnt"), "did you mean 'front'"),
        (lambda: film(None, Shot(mesh, displacement=bent(mesh), plane="y=3")), "seen edge-on"),
        (lambda: picture(None, mesh, before=True), "nothing moves"),
        (lambda: picture(None, mesh, plane="x=3", view="front"), "seen edge-on"),
        (lambda: picture(None, mesh, plane="x=30", view="left"), "does not cut the body"),
        (lambda: convergence_picture(None, {}), "0 curves were given"),
        (lambda: convergence_picture(None, {"a": [(1.0, 0.0)]}), "not positive"),
        (lambda: convergence_picture(None, {"a": [(1.0, 2.0, 3.0)]}), "no list of pairs"),  # type: ignore[list-item]
    ):
        with pytest.raises(InputError, match=message):
            call()


def test_the_picture_of_a_shot_is_translucent_skin_over_bone() -> None:
    mesh = block((10.0, 10.0, 10.0), (2, 2, 2))
    shot = Shot(mesh, translucent="top").checked("")
    camera = fitted("top", shot.subject.points(), (60, 60))
    seen = shot.seen(camera)
    assert seen.veil is not None and seen.veil.skin
    shown = panel(shot, seen, camera, "", None).colours
    assert shown.shape == (60, 60, 3) and shown.min() >= 0 and shown.max() <= 1


# Windows: pyvista is an extra.


def test_without_the_extra_a_window_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyvista", None)
    with pytest.raises(MissingExtra, match=r"bezsoma\[view\]"):
        window.show(Shot(bar()))
    with pytest.raises(InputError, match="a int cannot be shown"):
        window.show(3)  # type: ignore[arg-type]


def test_a_machine_where_vtk_cannot_draw_is_told_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(window, "_TRY", "import os; os.abort()")
    monkeypatch.setattr(window, "_pyvista", lambda: None)
    window._trial.cache_clear()
    with pytest.raises(MissingExtra, match=r"status -6.*libegl1"):
        window.show(Shot(bar()), screenshot=True)
    window._trial.cache_clear()


def test_a_window_is_given_our_own_triangles_turned_outward() -> None:
    mesh = block((10.0, 10.0, 10.0), (1, 1, 1))
    height = field(mesh, 1, lambda x: x[:, 2])
    shot = Shot(mesh, height).checked("")
    (part,) = shot.seen(fitted("front", shot.subject.points(), SMALL)).solid
    points, rows, normals, numbers = window.triangles(part)
    assert numbers is not None and np.allclose(numbers, points[:, 2], atol=1e-12)
    a, b, c = np.moveaxis(points[rows], 1, 0)
    ring = np.cross(b - a, c - a)
    assert np.isclose(np.linalg.norm(ring, axis=1).sum() / 2, 600)
    assert (np.einsum("rd,rd->r", ring, normals[rows[:, 0]]) > 0).all()
    assert np.isclose(np.einsum("rd,rd->", a, ring) / 6, 1000)  # the volume, by Gauss


def test_an_off_screen_window_shows_the_body() -> None:
    pytest.importorskip("pyvista", reason="the extra `view` is not installed")
    said = window._trial(True)
    if said is not None:
        pytest.skip(f"VTK cannot draw on this machine: {said}")
    mesh = bar()
    image = window.show(Shot(mesh, bent(mesh), bent(mesh), label="mm"), screenshot=True)
    assert image.shape == (900, 1000, 3) and image.std() > 10
