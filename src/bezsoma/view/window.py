# SPDX-License-Identifier: BSD-3-Clause
"""An interactive window, or a view in a Jupyter notebook, through pyvista (the extra `view`).

The surface that is shown is our own, cut from the polynomials as for a picture: VTK is given
triangles, normals and numbers, and no cells of its own to interpolate. On a bare machine VTK ends
the whole process when it cannot open a window, so another process tries it first.
"""

from __future__ import annotations

import os
import subprocess
import sys
from functools import cache
from typing import Any, Protocol, runtime_checkable

import numpy as np

from bezsoma.arrays import Floats, Ints
from bezsoma.errors import InputError, MissingExtra
from bezsoma.mesh import Field
from bezsoma.view.camera import Camera, fitted
from bezsoma.view.sheet import NOTICE
from bezsoma.view.shot import Part, Shot, bar_of

_SIZE = (1000, 900)
_TRY = (
    "import pyvista as p; q = p.Plotter(off_screen={off}, window_size=(64, 64));"
    " q.add_mesh(p.Sphere()); q.show(auto_close=False, interactive=False); q.screenshot(None)"
)
_SECONDS = 60
_VEIL = 0.35


@runtime_checkable
class Solved(Protocol):
    """What a solve or a results folder gives: here only its displacement matters."""

    @property
    def displacement(self) -> Field:
        """In mm."""
        ...


def show(
    shown: Shot | Solved,
    *,
    view: str = "three-quarter",
    screenshot: bool = False,
    notebook: bool | None = None,
) -> Any:
    """Opens a window, in a notebook a view, on a shot, a solution or results; waits till closed.

    Of a solution the displaced surface is shown, coloured by how far it moved. With `screenshot`
    nothing is opened, and what it would show comes back as an array (h, w, 3) from 0 to 255.
    """
    shot = _shot(shown).checked("show(shot)")
    pyvista = _pyvista()
    notebook = "ipykernel" in sys.modules if notebook is None else notebook
    _check_windows(off_screen=screenshot or notebook)
    plotter = pyvista.Plotter(off_screen=screenshot, window_size=_SIZE, notebook=notebook)
    camera = fitted(view, shot.subject.points(), _SIZE)
    _fill(plotter, pyvista, shot, camera)
    _place(plotter, camera)
    if screenshot:
        plotter.show(auto_close=False, interactive=False)
        image = np.asarray(plotter.screenshot(None))
        plotter.close()
        return image
    return plotter.show(title=NOTICE)


def triangles(part: Part) -> tuple[Floats, Ints, Floats, Floats | None]:
    """Points (p, 3), triangles (r, 3) turned outward, normals (p, 3) and numbers (p,).

    Corners that share a point, a normal and a number are one.
    """
    at = part.surface.corners
    key = at(part.surface.vertex).reshape(-1, 1)
    if part.numbers is not None:
        key = np.concatenate([key, at(part.numbers).reshape(-1, 1)], axis=1)
    _, first, rows = np.unique(key, axis=0, return_index=True, return_inverse=True)
    rows = rows.reshape(-1, 3)
    flat = [at(each).reshape(-1, 3)[first] for each in (part.surface.points, part.surface.normals)]
    a, b, c = np.moveaxis(flat[0][rows], 1, 0)
    inward = np.einsum("rd,rd->r", np.cross(b - a, c - a), flat[1][rows].sum(axis=1)) < 0
    rows[inward] = rows[inward][:, [0, 2, 1]]
    if part.numbers is None:
        return flat[0], rows, flat[1], None
    return flat[0], rows, flat[1], at(part.numbers).ravel()[first]


def _shot(shown: Shot | Solved) -> Shot:
    """The shot itself, or that of how far a solution moved."""
    if isinstance(shown, Shot):
        return shown
    if isinstance(shown, Solved) and isinstance(shown.displacement, Field):
        moved = shown.displacement
        surface = "skin" if "skin" in moved.mesh.surfaces else None
        return Shot(moved.mesh, moved, moved, surface=surface, label="displacement, mm")
    raise InputError(
        f"show: a {type(shown).__name__} cannot be shown; give a Solution, Results or "
        "Shot(mesh, colour, displacement)"
    )


def _pyvista() -> Any:
    try:
        import pyvista
    except ImportError as error:
        raise MissingExtra(
            "windows need the extra `view`, which is not installed here: python -m pip install "
            "'bezsoma[view]'; picture() and film() work without it"
        ) from error
    return pyvista


def _check_windows(off_screen: bool) -> None:
    """Refuses where VTK cannot draw; it would end this process."""
    said = _trial(off_screen)
    if said is not None:
        raise MissingExtra(
            f"VTK cannot open a window here ({said}). On a machine with a screen, install "
            "libegl1 and libgl1-mesa-dri (Debian, Ubuntu); without one use picture() and film(), "
            "which need none"
        )


@cache
def _trial(off_screen: bool) -> str | None:
    """How another process ended that tried to draw with VTK; None where it could."""
    if not off_screen and sys.platform.startswith("linux") and not _has_screen():
        return "no screen: neither DISPLAY nor WAYLAND_DISPLAY is set"
    try:
        done = subprocess.run(
            [sys.executable, "-c", _TRY.format(off=off_screen)],
            capture_output=True,
            text=True,
            timeout=_SECONDS,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return f"it did not answer within {_SECONDS} s"
    if done.returncode == 0:
        return None
    last = done.stderr.strip().splitlines()[-1:] or [""]
    return f"status {done.returncode} {last[0][:120]}".strip()


def _has_screen() -> bool:
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


def _fill(plotter: Any, pyvista: Any, shot: Shot, camera: Camera) -> None:
    """The surfaces, a colour bar, and the letters of the sides."""
    seen = shot.seen(camera)
    bar = bar_of([shot], [seen])
    for part, opacity in [(each, 1.0) for each in seen.solid] + (
        [] if seen.veil is None else [(seen.veil, _VEIL)]
    ):
        points, rows, normals, numbers = triangles(part)
        mesh = pyvista.PolyData(points, np.insert(rows, 0, 3, axis=1).ravel())
        mesh.point_data.active_normals = normals
        look: dict[str, Any] = {"color": part.colour}
        if numbers is not None and bar is not None:
            mesh.point_data["shown"] = numbers
            look = {"scalars": "shown", "clim": bar.limits, "cmap": hexadecimal(bar.table)}
            look["scalar_bar_args"] = {"title": f"{bar.label}\n"}  # or it would touch the numbers
        plotter.add_mesh(mesh, opacity=opacity, smooth_shading=True, **look)
    plotter.add_axes(xlabel="L", ylabel="P", zlabel="S", line_width=4)
    plotter.add_text(NOTICE, position="lower_right", font_size=7)


def _place(plotter: Any, camera: Camera) -> None:
    """The viewer where the picture has it, without vanishing points; the scale in mm."""
    far = 4 * max(camera.size) / camera.scale
    plotter.camera.focal_point = camera.centre
    plotter.camera.position = camera.centre + far * camera.axes[2]
    plotter.camera.up = camera.axes[1]
    plotter.enable_parallel_projection()
    plotter.camera.parallel_scale = 1.15 * camera.size[1] / (2 * camera.scale)
    plotter.reset_camera_clipping_range()


def hexadecimal(table: Floats) -> list[str]:
    """Colours (k, 3) from 0 to 1 as text.

    >>> hexadecimal(np.array([[0.0, 1.0, 0.5]]))
    ['#00ff80']
    """
    return [f"#{r:02x}{g:02x}{b:02x}" for r, g, b in np.rint(255 * table).astype(int).tolist()]
