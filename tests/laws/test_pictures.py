# SPDX-License-Identifier: BSD-3-Clause
"""Pictures: where points land, which side is which, shapes, normals, colours, bars, refusals."""

from __future__ import annotations

import builtins
import io
import sys
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure
from PIL import Image

from bezsoma import face_picture, picture
from bezsoma.bernstein import domain_points
from bezsoma.errors import InputError, MissingExtra
from bezsoma.mesh import BrokenField, ControlNet, Field, TetMesh, ball, block
from bezsoma.view.camera import VIEWS, Camera, axes, fitted
from bezsoma.view.layout import Layout
from bezsoma.view.rays import Scene
from bezsoma.view.shading import Layer, coverage, openness, shaded
from bezsoma.view.sheet import colours
from bezsoma.view.shot import bar
from bezsoma.view.subject import Subject
from bezsoma.view.surfaces import Surface, displaced
from tolerances import ROUNDING

SMALL = (420, 400)


def field(mesh: TetMesh, degree: int, function: Any) -> Field:
    net = ControlNet(mesh, degree)
    return Field(net, net.interpolated(function))


def sphere(degree: int, radius: float = 30.0, cells: int = 4) -> tuple[TetMesh, Field]:
    """A ball of flat facets and the displacement that rounds its surface, interpolated."""
    mesh = ball(radius, cells)

    def rounding(points: np.ndarray) -> np.ndarray:
        far = np.linalg.norm(points, axis=1, keepdims=True)
        return np.where(far > 0.85 * radius, points * (radius / np.maximum(far, 1e-9) - 1), 0.0)

    return mesh, field(mesh, degree, rounding)


def drawn(monkeypatch: pytest.MonkeyPatch, call: Any) -> Figure:
    """The figure behind a picture."""
    kept: list[Figure] = []
    module = sys.modules["bezsoma.view.picture"]
    original = module.png  # type: ignore[attr-defined]
    monkeypatch.setattr(module, "png", lambda f, t="": kept.append(f) or original(f, t))
    call()
    return kept[0]


def pixels(content: bytes) -> np.ndarray:
    return np.asarray(Image.open(io.BytesIO(content)).convert("RGB"), float)


# Cameras


@pytest.mark.parametrize(
    ("view", "right", "above", "near"),
    [
        ("front", (1, 0, 0), (0, 0, 1), (0, -1, 0)),
        ("back", (-1, 0, 0), (0, 0, 1), (0, 1, 0)),
        ("left", (0, 1, 0), (0, 0, 1), (1, 0, 0)),
        ("right", (0, -1, 0), (0, 0, 1), (-1, 0, 0)),
        ("bottom", (1, 0, 0), (0, -1, 0), (0, 0, -1)),
        ("top", (1, 0, 0), (0, 1, 0), (0, 0, 1)),
    ],
)
def test_known_points_land_at_known_pixels(view: str, right: Any, above: Any, near: Any) -> None:
    camera = Camera(axes(view), np.array([250.0, 150.0, 50.0]), 4.0, (640, 480))
    point = camera.centre + 10 * np.array(right) + 7 * np.array(above) + 99 * np.array(near)
    assert np.allclose(camera.pixels(point), [320 + 40, 240 - 28])
    assert np.isclose(camera.seen(point)[2], 99)


def test_left_of_the_patient_is_on_the_viewers_right_from_the_front_only() -> None:
    for view, side in (("front", 1), ("bottom", 1), ("top", 1), ("back", -1)):
        camera = Camera(axes(view), np.zeros(3), 1.0, (100, 100))
        left_ear = camera.pixels(np.array([20.0, 0.0, 0.0]))
        assert np.sign(left_ear[0] - 50) == side
        assert camera.letters()[0 if side > 0 else 1] == "L"
    assert Camera(axes("left"), np.zeros(3), 1.0, (9, 9)).facing() == "L"
    assert Camera(axes("right"), np.zeros(3), 1.0, (9, 9)).letters()[:2] == ("A", "P")


@pytest.mark.parametrize("view", list(VIEWS))
def test_a_fitted_camera_shows_everything_and_wastes_nothing(view: str) -> None:
    points = np.random.default_rng(0).uniform([200, 100, 0], [300, 170, 90], (500, 3))
    camera = fitted(view, points, (600, 300), margin=0.1)
    landed = camera.pixels(points) / np.array([600, 300])
    assert landed.min() > 0.1 - 1e-9 and landed.max() < 0.9 + 1e-9
    assert np.isclose(np.ptp(landed, axis=0).max(), 0.8)
    assert np.allclose((landed.min(axis=0) + landed.max(axis=0)) / 2, 0.5)


def test_sides_are_marked_in_every_view(monkeypatch: pytest.MonkeyPatch) -> None:
    for view in VIEWS:
        with monkeypatch.context() as patch:
            figure = drawn(patch, lambda v=view: picture(None, block(), view=v, size=SMALL))
        texts = {text.get_text() for text in figure.axes[0].texts}
        marks = {text for text in texts if len(text) <= 2}
        assert any("L" in mark or "R" in mark for mark in marks), (view, texts)
        if view == "left":
            assert {"L", "the patient's left side", "A", "P"} <= texts
        if view == "front":
            where = {text.get_text(): text.get_position()[0] for text in figure.axes[0].texts}
            assert where["L"] > where["R"]


# Shapes


def test_the_silhouette_of_a_sphere_is_within_half_a_pixel() -> None:
    mesh, rounding = sphere(5)
    surface = Subject.of(mesh, None, True, rounding, 1.0).surfaces(6.0, moved=True)[0]
    for view in ("front", "three-quarter"):
        camera = Camera(axes(view), np.array([0.3, 0.1, -0.2]), 6.0, (400, 380))
        shown = coverage(camera, surface)
        middle = camera.pixels(np.zeros(3))
        rows, columns = np.mgrid[:380, :400] + 0.5
        far = np.hypot(columns - middle[0], rows - middle[1])
        assert (shown[far < 180 - 1.2] == 1).all() and (shown[far > 180 + 1.2] == 0).all()
        assert abs(np.sqrt(shown.sum() / np.pi) - 180) < 0.1
        above = rows[:, 0] - middle[1]
        chords = 2 * np.sqrt(180**2 - above[np.abs(above) < 150] ** 2)
        seen = shown.sum(axis=1)[np.abs(above) < 150]
        assert np.abs(seen - chords).max() < 1.0  # half a pixel at either end


def test_a_displaced_surface_moves_by_the_right_number_of_pixels() -> None:
    mesh = block((20.0, 30.0, 10.0), (2, 2, 1), (240.0, 140.0, 30.0))
    moved = field(mesh, 2, lambda p: np.tile([3.0, -5.0, 2.0], (len(p), 1)))
    camera = Camera(axes("left"), np.array([250.0, 152.0, 36.0]), 7.3, (420, 360))
    centres = []
    for displacement in (None, moved):
        shown = coverage(camera, displaced(mesh, mesh.boundary, displacement))
        rows, columns = np.mgrid[:360, :420] + 0.5
        centres.append([(shown * grid).sum() / shown.sum() for grid in (columns, rows)])
    step = np.subtract(centres[1], centres[0])
    assert np.allclose(step, [-5 * 7.3, -2 * 7.3], atol=0.125)  # four rays a pixel


def test_samples_lie_on_the_displaced_polynomial() -> None:
    mesh = block(cells=(2, 2, 2))
    bend = field(mesh, 4, lambda p: np.stack([p[:, 1] ** 4, p[:, 0] * p[:, 2], p[:, 0] ** 3], 1))
    surface = displaced(mesh, mesh.facets_of("front"), bend, 0.01, magnified=2.0)
    assert len(surface.triangles) > 4 * len(surface.facets)
    at = bend.at(surface.places)
    assert np.allclose(surface.points, surface.places + 2 * at, atol=1e-12)
    assert np.allclose(surface.at(bend), at, atol=1e-12)


@pytest.mark.parametrize("degree", [2, 3, 6])
def test_triangles_stray_by_less_than_the_tolerance(degree: int) -> None:
    mesh = block()
    bend = field(mesh, degree, lambda p: 0.3 * np.sin(2 * p + p[:, ::-1]))
    facets = mesh.facets_of("top")
    inside = domain_points(4, 2)
    for tolerance in (3e-2, 3e-3):
        surface = displaced(mesh, facets, bend, tolerance)
        flat = inside @ surface.corners(surface.points)
        place = inside @ surface.corners(surface.places)
        moved = bend.at(place.reshape(-1, 3), outside="nearest").reshape(place.shape)
        worst = np.linalg.norm(flat - place - moved, axis=-1).max()
        assert tolerance / 20 < worst < tolerance
    assert len(displaced(mesh, facets, bend, 1e-3, magnified=1e-9).triangles) == len(facets)


def test_a_picture_cuts_a_facet_as_often_as_it_bends_and_is_large() -> None:
    mesh, rounding = sphere(3)
    bent = np.linalg.norm(mesh.points[mesh.boundary].mean(axis=1) - [30, 0, 0], axis=1) < 20
    one_side = Field(rounding.net, rounding.controls * (rounding.net.points[:, :1] > 5))
    surface = Subject.of(mesh, None, True, one_side, 1.0).surfaces(0.3, moved=True)[0]
    counts = [0] * len(mesh.boundary)
    for group in surface.groups:
        for facet in group.facets.tolist():
            counts[facet] = len(group.cut.triangles)
    assert min(np.array(counts)[bent]) > 1 and min(counts) == 1
    sides = np.linalg.norm(
        np.diff(surface.corners(surface.places)[:, [0, 1, 2, 0]], axis=1), axis=2
    )
    assert sides.max() < 6 / 0.3 * 1.5  # a strip between unlike edges has diagonals
    near = Subject.of(mesh, None, True, one_side, 1.0).surfaces(3.0, moved=True)[0]
    assert len(near.triangles) > 20 * len(surface.triangles)


# Normals and light


def test_normals_of_a_rounded_ball_point_outwards() -> None:
    mesh, rounding = sphere(5)
    surface = displaced(mesh, mesh.boundary, rounding, 0.01)
    radial = surface.points / np.linalg.norm(surface.points, axis=1, keepdims=True)
    cosine = np.einsum("sd,sd->s", surface.normals, radial)
    assert np.degrees(np.arccos(np.clip(cosine, -1, 1))).max() < 0.1


def test_normals_of_a_bent_plate_are_those_of_its_formula() -> None:
    mesh = block(cells=(2, 2, 1))
    lift = field(mesh, 3, lambda p: np.stack([0 * p[:, 0], 0 * p[:, 0], p[:, 0] ** 2 * p[:, 1]], 1))
    for name, side in (("top", 1.0), ("bottom", -1.0)):
        surface = displaced(mesh, mesh.facets_of(name), lift, 0.01)
        x, y, _ = surface.places.T
        exact = side * np.stack([-2 * x * y, -(x**2), np.ones_like(x)], axis=-1)
        exact /= np.linalg.norm(exact, axis=-1, keepdims=True)
        assert np.allclose(surface.normals, exact, atol=1e-12)


def test_a_block_keeps_its_edges_and_a_ball_loses_them() -> None:
    mesh = block(cells=(2, 2, 2))
    surface = displaced(mesh, mesh.boundary, None, longest=0.2)
    assert np.allclose(np.abs(surface.normals).max(axis=1), 1)
    rounded = displaced(ball(1.0, 6), ball(1.0, 6).boundary, None, longest=0.1)
    radial = rounded.points / np.linalg.norm(rounded.points, axis=1, keepdims=True)
    assert np.einsum("sd,sd->s", rounded.normals, radial).min() > np.cos(np.radians(4))
    shared = len(np.unique(rounded.vertex))
    assert shared == 2 + len(rounded.triangles) // 2  # Euler: a closed surface without creases
    assert len(rounded.triangles) > 4 * len(rounded.facets)


def test_a_rotation_turns_the_normals() -> None:
    mesh = ball(1.0)
    turn = np.array([[0.0, -1, 0], [0.6, 0, -0.8], [0.8, 0, 0.6]])
    assert np.isclose(np.linalg.det(turn), 1)
    spin = field(mesh, 1, lambda p: p @ turn.T - p)
    before = displaced(mesh, mesh.boundary, None, longest=0.3)
    after = displaced(mesh, mesh.boundary, spin, longest=0.3)
    assert np.allclose(after.normals, before.normals @ turn.T, atol=1e-12)


def test_a_crushed_facet_still_has_a_picture() -> None:
    mesh = block()
    crushed = field(mesh, 1, lambda p: -p)
    surface = displaced(mesh, mesh.boundary, crushed, longest=0.7)
    assert np.isfinite(surface.normals).all()
    shown = picture(None, mesh, displacement=crushed, size=SMALL)
    assert shown[:4] == b"\x89PNG"


def test_a_plane_sees_the_whole_sky_and_a_corner_a_part_of_it() -> None:
    floor = np.array([[[-9, -9, 0], [9, -9, 0], [0, 9, 0]]], np.float32)
    wall = np.array([[[-99, 0, 0], [99, 0, 0], [0, 0, 999]]], np.float32)
    point, up = np.array([[0, -0.001, 0]], np.float32), np.array([[0, 0, 1]], np.float32)
    assert openness(Scene(floor), point, up)[0] == 1
    with_wall = Scene(np.concatenate([floor, wall]))
    # Half of the sky, weighted by the cosine to the normal, is hidden by an endless wall.
    assert abs(openness(with_wall, point, up, rays=4096)[0] - 0.5) < 0.02


def test_faces_towards_the_key_light_are_brighter() -> None:
    mesh = block((10.0, 10.0, 10.0))
    surface = displaced(mesh, mesh.boundary, None)
    camera = fitted("three-quarter", mesh.points, (200, 200))
    shown = shaded(camera, [Layer(surface)])
    places = {
        "front": np.array([5.0, 0.0, 5.0]),
        "left": np.array([0.0, 5.0, 5.0]),
        "top": np.array([5.0, 5.0, 10.0]),
    }
    light = {}
    for name, point in places.items():
        column, row = camera.pixels(point).astype(int)
        light[name] = shown.colours[row, column].mean()
    assert light["front"] > light["left"] + 0.05
    assert shown.coverage[0, 0] == 0 and shown.coverage[100, 100] == 1


def test_the_nearer_surface_hides_the_farther() -> None:
    mesh = block((10.0, 10.0, 10.0))
    near, far = (displaced(mesh, mesh.facets_of(name), None) for name in ("front", "back"))
    camera = fitted("front", mesh.points, (60, 60))
    shown = shaded(camera, [Layer(far, (0, 0, 1)), Layer(near, (1, 0, 0))]).colours[30, 30]
    assert shown[0] > 0.3 and shown[0] > 3 * shown[2]


def test_skin_has_no_edges_where_a_block_has() -> None:
    mesh = block()
    mesh = mesh.with_surface("skin", mesh.boundary)
    one, plain = (Subject.of(mesh, name, True, None, 1.0) for name in ("skin", None))
    skin, sharp = (subject.surfaces(1.0, moved=False)[0] for subject in (one, plain))
    assert len(np.unique(skin.vertex)) < len(np.unique(sharp.vertex))
    along = np.abs(sharp.normals).max(axis=1)
    assert np.allclose(along, 1) and np.abs(skin.normals).max(axis=1).min() < 0.8


@pytest.mark.parametrize(("size", "shape"), [((1, 1, 1), 0.8), ((1, 1, 9), 0.9), ((9, 1, 1), 0.62)])
def test_the_sheet_is_as_high_as_suits_what_it_shows(
    size: tuple[float, float, float], shape: float
) -> None:
    mesh = block(size)
    still = field(mesh, 1, lambda p: 0 * p)
    page = Image.open(io.BytesIO(face_picture(None, mesh, still, view="front")))
    width, height = Layout(page.size, 2, 2, title=False, bars=True).panel
    assert page.size[0] == 1600 and abs(height / width - shape) < 0.01


def test_wires_darken_the_edges_of_facets_and_nothing_else() -> None:
    mesh = block((10.0, 10.0, 10.0))
    surface = displaced(mesh, mesh.facets_of("front"), None, longest=4.0)
    camera = Camera(axes("front"), np.array([5.0, 0.0, 5.0]), 10.0, (120, 120))
    plain, wired = (shaded(camera, [Layer(surface, wires=on)]).colours for on in (False, True))
    darker = (plain - wired).mean(axis=2)
    assert darker[59:61, 59:61].max() > 0.05  # on the diagonal
    assert darker[20:100, 55].max() > 0.05 and darker[85:95, 60].max() == 0
    assert 0.03 < (darker > 0.02).mean() < 0.1


# Colours and bars


def test_the_colour_bar_ends_at_the_range_of_the_field(monkeypatch: pytest.MonkeyPatch) -> None:
    mesh = block((2.0, 1.0, 1.0), (2, 1, 1))
    scalar = field(mesh, 2, lambda p: p[:, 0] ** 2 - 1.5)
    figure = drawn(
        monkeypatch, lambda: picture(None, mesh, scalar, label="pressure in MPa", size=SMALL)
    )
    bar = figure.axes[1]
    assert np.allclose(bar.get_xlim(), (-1.5, 2.5)) and bar.get_xlabel() == "pressure in MPa"
    ticks = bar.get_xticks()
    assert np.isclose(ticks, -1.5).any()
    assert ((ticks >= -1.5 - ROUNDING) & (ticks <= 2.5 + ROUNDING)).all()


@pytest.mark.parametrize("top", [5.0, 5.1, 5.3, 5.7])
def test_both_ends_of_the_colour_bar_have_numbers_that_run_into_none(
    monkeypatch: pytest.MonkeyPatch, top: float
) -> None:
    mesh = block((2.0, 1.0, 1.0), (2, 1, 1))
    scalar = field(mesh, 1, lambda p: p[:, 0] * top / 2)
    figure = drawn(monkeypatch, lambda: picture(None, mesh, scalar, label="mm", size=SMALL))
    figure.canvas.draw()
    words = [each for each in figure.axes[1].get_xticklabels() if each.get_text()]
    assert {"0", f"{top:.3g}"} <= {each.get_text() for each in words}
    places = sorted((each.get_window_extent().x0, each.get_window_extent().x1) for each in words)
    assert all(one[1] < other[0] for one, other in pairwise(places))


def test_the_face_sheet_measures_the_displacement(monkeypatch: pytest.MonkeyPatch) -> None:
    mesh = block((20.0, 20.0, 20.0))
    moved = field(mesh, 2, lambda p: np.stack([0 * p[:, 0], -0.012 * p[:, 2] ** 2, 0 * p[:, 0]], 1))
    content: list[bytes] = []
    figure = drawn(
        monkeypatch, lambda: content.append(face_picture(None, mesh, moved, size=(840, 700)))
    )
    assert pixels(content[0]).shape == (700, 840, 3)
    titles = [panel.get_title() for panel in figure.axes]
    assert titles[:2] == ["before", "after"] and "at most 4.8 mm" in titles[2]
    bar = next(one for one in figure.axes if one.get_label() == "colour bar")
    assert np.allclose(bar.get_xlim(), (0, 4.8)) and bar.get_xlabel() == "mm"
    legend = figure.axes[-1].get_legend() or figure.axes[3].get_legend()
    assert legend is not None
    assert [text.get_text() for text in legend.get_texts()] == ["after", "before"]


def test_colours_on_the_surface_are_those_of_the_table() -> None:
    mesh = block((10.0, 10.0, 10.0))
    rising = field(mesh, 1, lambda p: p[:, 2])
    shown = pixels(picture(None, mesh, rising, view="front", size=(500, 500), limits=(0.0, 10.0)))
    inside = shown[150:350, 250]
    table = 255 * colours("viridis")

    def hue(colour: np.ndarray) -> np.ndarray:
        return colour / np.linalg.norm(colour, axis=-1, keepdims=True)

    nearest = (hue(inside)[:, None] @ hue(table).T)[:, 0].argmax(axis=1)
    steady = nearest[np.abs(np.gradient(nearest.astype(float))) < 30]
    assert (np.diff(steady) <= 12).all() and steady[0] > steady[-1] + 80


def test_a_bar_begins_at_zero_where_its_range_begins_within_half_a_colour_of_it() -> None:
    for low, shown in ((8e-4, 0.0), (3e-3, 3e-3), (-8e-4, -8e-4)):
        assert bar(np.array([low, 0.5, 1.0]), "mm", None, "viridis").limits == (shown, 1.0)


def test_a_constant_field_has_a_bar_too() -> None:
    mesh = block()
    same = field(mesh, 1, lambda p: np.full(len(p), 3.0))
    assert picture(None, mesh, same, size=SMALL)[:4] == b"\x89PNG"


def test_a_tensor_needs_a_measure_and_a_broken_field_may_jump() -> None:
    mesh = block(cells=(2, 1, 1))
    stress = BrokenField(mesh, 0, np.arange(12.0)[:, None, None, None] * np.eye(3))
    with pytest.raises(InputError, match=r"9 components.*measure="):
        picture(None, mesh, stress, size=SMALL)
    trace = picture(None, mesh, stress, measure=lambda v: v[:, [0, 4, 8]].sum(1), size=SMALL)
    assert trace[:4] == b"\x89PNG"


def test_the_scale_bar_is_as_long_as_it_says(monkeypatch: pytest.MonkeyPatch) -> None:
    mesh = block((100.0, 20.0, 60.0))
    content: list[bytes] = []
    figure = drawn(
        monkeypatch,
        lambda: content.append(picture(None, mesh, view="front", size=(800, 700))),
    )
    layout = Layout((800, 700), 1, 1, False, False)
    camera = fitted("front", mesh.points, layout.panel)
    bar = next(patch for patch in figure.axes[0].patches if patch.get_gid() == "scale bar")
    said = next(t.get_text() for t in figure.axes[0].texts if t.get_text().endswith(" mm"))
    length = float(said.removesuffix(" mm"))
    assert np.isclose(bar.get_width(), length * camera.scale)
    left, top = layout.corner(0)
    row = round(top + bar.get_y() + bar.get_height() / 2)
    dark = pixels(content[0])[row, left : left + layout.panel[0]].max(axis=1) < 60
    assert abs(dark.sum() - length * camera.scale) <= 1.5
    # The block itself is 100 mm wide on the same page.
    row = top + 2 * layout.panel[1] // 5
    shown = pixels(content[0])[row, left + 2 : left + layout.panel[0] - 2]
    assert abs((shown[:, 0] < 230).sum() - 100 * camera.scale) <= 1.5


def test_a_panel_pixel_is_a_page_pixel(monkeypatch: pytest.MonkeyPatch) -> None:
    mesh = block((10.0, 10.0, 10.0))
    content: list[bytes] = []
    figure = drawn(monkeypatch, lambda: content.append(picture(None, mesh, size=(431, 397))))
    layout = Layout((431, 397), 1, 1, False, False)
    (width, height), (left, top) = layout.panel, layout.corner(0)
    shown = np.asarray(figure.axes[0].images[0].get_array())
    assert shown.shape == (height, width, 3)
    page = pixels(content[0])[top : top + height, left : left + width]
    middle = (slice(height // 3, height // 2), slice(width // 3, width // 2))
    assert np.abs(page[middle] - shown[middle]).max() <= 1


# Files and refusals


def test_the_bytes_are_a_png_that_says_what_it_is(tmp_path: Path) -> None:
    content = picture(tmp_path / "a.png", block(), size=SMALL, title="a block")
    assert (tmp_path / "a.png").read_bytes() == content
    image = Image.open(io.BytesIO(content))
    image.verify()
    assert image.size == SMALL and "not a medical device" in image.info["Software"]
    assert image.info["Title"] == "a block" and "Creation Time" not in image.info
    with pytest.raises(InputError, match="overwrite=True"):
        picture(tmp_path / "a.png", block(), size=SMALL)


def test_the_same_picture_has_the_same_bytes() -> None:
    first, second = (picture(None, ball(1.0), size=SMALL, wires=True) for _ in range(2))
    assert first == second


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"view": "frnt"}, r"no view 'frnt'.*did you mean 'front'"),
        ({"surface": "topp"}, r"no surface 'topp'.*did you mean 'top'"),
        ({"surface": ()}, "no surface was named"),
        ({"table": "viridsi"}, r"no colour map.*did you mean 'viridis'"),
        ({"size": (0, 100)}, r"size \(0, 100\) is not"),
        ({"size": (99999, 100)}, "up to 8192"),
        ({"size": (100, 60)}, "leaves panels of"),
        ({"limits": (2.0, 1.0)}, "do not go from a lower"),
        ({"magnified": float("nan")}, "cannot be drawn nan times"),
    ],
)
def test_what_cannot_be_drawn_is_refused(given: dict[str, Any], message: str) -> None:
    mesh = block()
    scalar = field(mesh, 1, lambda p: p[:, 0])
    with pytest.raises(InputError, match=message):
        picture(None, mesh, scalar, **{"size": SMALL, **given})


def test_displacements_that_are_none_are_refused() -> None:
    mesh = block()
    scalar = field(mesh, 1, lambda p: p[:, 0])
    other = field(block(cells=(2, 1, 1)), 1, lambda p: p)
    broken = BrokenField(mesh, 1, np.zeros((6, 4, 3)))
    net = ControlNet(mesh, 1)
    holes = Field(net, np.full((net.count, 3), np.nan))
    for wrong, message in (
        (scalar, "three components"),
        (other, "another mesh"),
        (broken, "averaged"),
        (holes, "NaN"),
    ):
        with pytest.raises(InputError, match=message):
            face_picture(None, mesh, wrong, size=(840, 700))  # type: ignore[arg-type]


def test_without_embree_the_message_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    original = builtins.__import__

    def absent(name: str, *rest: Any) -> Any:
        if name.startswith("embreex"):
            raise ImportError(name)
        return original(name, *rest)

    monkeypatch.setattr(builtins, "__import__", absent)
    with pytest.raises(MissingExtra, match=r"python -m pip install embreex.*write_vtu"):
        picture(None, block(), size=SMALL)


@pytest.mark.real_data
def test_a_real_face_looks_forward(data: Path) -> None:
    stored = np.load(data / "face_small" / "face_small.npz")
    skin = stored["facets"][stored["facet_tags"] == 1]
    mesh = TetMesh(stored["points"], stored["tets"], surfaces={"skin": skin})
    camera = fitted("left", mesh.points[skin].reshape(-1, 3), (400, 300))
    shown = coverage(camera, displaced(mesh, mesh.facets_of("skin"), None))
    chin = camera.pixels(np.array([248.0, 137.7, 30.0]))
    row = shown[int(chin[1])]
    # Seen from the left the face looks to the viewer's left, and the chin is its rim there.
    assert abs(np.flatnonzero(row > 0.5)[0] - chin[0]) < 0.7 * camera.scale + 1


def test_surfaces_know_which_edges_are_those_of_facets() -> None:
    mesh = block()
    surface: Surface = displaced(mesh, mesh.facets_of("top"), None, longest=0.48)
    assert surface.rims.shape == (2 * 9, 3) and surface.rims.sum() == 2 * 9
