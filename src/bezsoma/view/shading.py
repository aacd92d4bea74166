# SPDX-License-Identifier: BSD-3-Clause
"""From triangles to a picture: hidden parts by rays, light by formula, in the camera's frame."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from bezsoma.arrays import Bools, Floats
from bezsoma.view.camera import Camera
from bezsoma.view.light import BACKGROUND, SKIN, lamps, linear, lit, screen
from bezsoma.view.pieces import Drawn
from bezsoma.view.rays import Scene, Singles

_CHUNK = 1 << 17
_GRAIN = 1e-6
"""Values in single precision that differ by less, relative to the largest, are one: no line."""


@dataclass(frozen=True, eq=False)
class Layer:
    """A surface and its paint: one colour, or values (..) at its samples, by a table of colours."""

    surface: Drawn
    colour: tuple[float, float, float] = SKIN
    values: Floats | None = None
    limits: tuple[float, float] = (0.0, 1.0)
    table: Floats | None = None
    """(k, 3) colours from the lower to the upper limit, 0 to 1 as shown on a screen."""
    translucent: bool = False
    """Whether light creeps on into the shade as in skin, red the farthest."""
    wires: bool = False
    """Whether the edges of the facets are drawn."""
    levels: Floats | None = None
    """Values along which thin lines are drawn."""


@dataclass(frozen=True, eq=False)
class Shaded:
    """A picture without letters."""

    colours: Floats
    """(h, w, 3) from 0 to 1 as shown on a screen."""
    coverage: Floats
    """(h, w) the part of each pixel that the surfaces cover."""


def shaded(camera: Camera, layers: list[Layer], rays: int = 2) -> Shaded:
    """The layers as the camera sees them, with rays**2 rays a pixel."""
    model = _Model.of(camera, layers)
    window = _window(camera, model.scene)
    hit, weights = _seen(camera, model.scene, window, rays)
    light = np.empty((hit.size, 3), np.float32)
    light[:] = linear(np.array(BACKGROUND))
    found = np.flatnonzero(hit.ravel() >= 0)
    shown = np.zeros(len(model.layer), bool)
    shown[hit.ravel()[found]] = True
    sky, standing = _openness(model.scene, camera, layers, shown), lamps(camera)
    for start in range(0, len(found), _CHUNK):
        part = found[start : start + _CHUNK]
        at = hit.ravel()[part]
        light[part] = model.light(at, weights.reshape(-1, 2)[part], sky[at], standing)
    light = light.reshape(*hit.shape, 3)
    model.draw_levels(light, hit, weights)
    return Shaded(
        _placed(screen(_pooled(light, rays)), camera, window, BACKGROUND),
        _placed(_covered(hit, rays), camera, window, (0.0,))[..., 0],
    )


def coverage(camera: Camera, surface: Drawn, rays: int = 4) -> Floats:
    """The part (h, w) of each pixel that a surface covers: its silhouette."""
    scene = Scene(camera.seen(surface.corners(surface.points)).astype(np.float32))
    window = _window(camera, scene)
    hit, _ = _seen(camera, scene, window, rays)
    return _placed(_covered(hit, rays), camera, window, (0.0,))[..., 0]


def openness(scene: Scene, points: Singles, normals: Singles, rays: int = 64) -> Singles:
    """The part (p,) of the sky that each point sees, weighted by the cosine to its normal.

    Rays go out in directions spread evenly over the sphere, the same for all points, so that
    neighbours agree and the shade has no grain.
    """
    reach = float(np.ptp(scene.corners.reshape(-1, 3), axis=0).max(initial=1.0))
    start = points + np.float32(2e-3 * reach) * normals
    seen = np.zeros(len(points), np.float32)
    total = np.zeros(len(points), np.float32)
    for direction in _spread(rays):
        cosine = normals @ direction
        up = np.flatnonzero(cosine > 0.05)
        free = ~scene.blocked(start[up], np.broadcast_to(direction, (len(up), 3)).copy())
        total[up] += cosine[up]
        seen[up] += cosine[up] * free
    return np.asarray(seen / np.maximum(total, 1e-6), np.float32)


@dataclass(frozen=True, eq=False)
class _Model:
    """All layers as one list of r triangles in the camera's frame, single precision."""

    scene: Scene
    normals: Singles
    """(r, 3, 3) at the corners."""
    outer: Bools
    """(r,) whether the outside faces the viewer."""
    values: Singles
    """(r, 3) at the corners, 0 where there are none."""
    layer: npt.NDArray[np.int8]
    """(r,) which layer each triangle belongs to."""
    wires: Singles
    """(r, 3) height in pixels over the side opposite each corner where it is drawn, else inf."""
    layers: list[Layer]

    @classmethod
    def of(cls, camera: Camera, layers: list[Layer]) -> _Model:
        corners, normals, values, wires = [], [], [], []
        for layer in layers:
            surface = layer.surface
            seen = camera.seen(surface.corners(surface.points)).astype(np.float32)
            corners.append(seen)
            normals.append((surface.corners(surface.normals) @ camera.axes.T).astype(np.float32))
            painted = np.zeros(surface.points.shape[:-1]) if layer.values is None else layer.values
            values.append(surface.corners(painted).astype(np.float32))
            wires.append(_heights(seen, camera.scale, surface.rims & layer.wires))
        joined = np.concatenate(corners)
        normal = np.concatenate(normals)
        scene = Scene(joined)
        ring = np.cross(joined[:, 1] - joined[:, 0], joined[:, 2] - joined[:, 0])
        turned = np.einsum("rd,rd->r", ring, normal.sum(axis=1)) < 0
        return cls(
            scene,
            normal,
            (ring[:, 2] > 0) != turned,
            np.concatenate(values),
            np.repeat(np.arange(len(layers), dtype=np.int8), [len(part) for part in corners]),
            np.concatenate(wires),
            layers,
        )

    def light(
        self, hit: npt.NDArray[np.int32], weights: Singles, sky: Singles, standing: Singles
    ) -> Singles:
        """Light (p, 3) that leaves the places hit towards the viewer, linear.

        sky (p, 3) is the openness at the corners of the triangles hit.
        """
        bary = _three(weights)
        normal = _normalised(_mixed(bary, self.normals[hit]))
        outer = self.outer[hit]
        normal[~outer] *= -1
        open_ = _mixed(bary, sky)
        layer = self.layer[hit]
        found = np.empty((len(hit), 3), np.float32)
        for number, one in enumerate(self.layers):
            mine = np.flatnonzero(layer == number)
            paint = _paint(one, _mixed(bary[mine], self.values[hit[mine]]))
            paint = paint * np.where(outer[mine], 1.0, 0.45)[:, None]
            coloured = one.values is not None
            found[mine] = lit(paint, normal[mine], open_[mine], standing, one.translucent, coloured)
        line = np.clip(1.1 - (bary * self.wires[hit]).min(axis=1), 0, 1) * 0.55
        return np.asarray(found * (1 - line[:, None]), np.float32)

    def draw_levels(self, light: Singles, hit: npt.NDArray[np.int32], weights: Singles) -> None:
        """Darkens the rays (h, w) at which the value steps over a level of its layer."""
        for number, layer in enumerate(self.layers):
            if layer.levels is None or layer.values is None:
                continue
            mine = (hit >= 0) & (self.layer[hit] == number)
            value = np.einsum("pc,pc->p", _three(weights[mine]), self.values[hit[mine]])
            step, shown = np.full(hit.shape, -1, np.int64), np.zeros(hit.shape, np.float32)
            step[mine], shown[mine] = np.searchsorted(layer.levels, value), value
            least = _GRAIN * float(np.abs(layer.limits).max())
            for one, other, a, b in (
                (step[:, :-1], step[:, 1:], shown[:, :-1], shown[:, 1:]),
                (step[:-1], step[1:], shown[:-1], shown[1:]),
            ):
                across = (one != other) & (one >= 0) & (other >= 0) & (np.abs(a - b) > least)
                light[: one.shape[0], : one.shape[1]][across] *= 0.35


def _window(camera: Camera, scene: Scene) -> tuple[int, int, int, int]:
    """Left, top, right and bottom of the pixels that the scene can cover."""
    across = scene.corners[..., 0] * camera.scale + camera.size[0] / 2
    down = camera.size[1] / 2 - scene.corners[..., 1] * camera.scale
    spans = []
    for place, most in ((across, camera.size[0]), (down, camera.size[1])):
        low, high = int(np.floor(place.min())) - 1, int(np.ceil(place.max())) + 1
        first = min(max(0, low), most - 1)
        spans.append((first, max(first + 1, min(most, high))))
    return spans[0][0], spans[1][0], spans[0][1], spans[1][1]


def _seen(
    camera: Camera, scene: Scene, window: tuple[int, int, int, int], rays: int
) -> tuple[npt.NDArray[np.int32], Singles]:
    """The triangle (h, w) that each ray of a regular grid hits, -1 for none; where (h, w, 2)."""
    left, top, right, bottom = window
    columns = left + (np.arange((right - left) * rays) + 0.5) / rays
    rows = top + (np.arange((bottom - top) * rays) + 0.5) / rays
    origins = np.empty((len(rows), len(columns), 3), np.float32)
    origins[..., 0] = (columns - camera.size[0] / 2) / camera.scale
    origins[..., 1] = (camera.size[1] / 2 - rows[:, None]) / camera.scale
    depth = scene.corners[..., 2]
    origins[..., 2] = depth.max() + np.ptp(depth) * 0.01 + 1.0 / camera.scale
    hit, weights = scene.hits(origins.reshape(-1, 3), np.array([0, 0, -1], np.float32))
    return hit.reshape(origins.shape[:2]), weights.reshape(*origins.shape[:2], 2)


def _covered(hit: npt.NDArray[np.int32], rays: int) -> Floats:
    """The part (h, w, 1) of the rays in each pixel that hit anything."""
    return _pooled((hit >= 0)[..., None].astype(np.float32), rays)


def _placed(
    part: Floats, camera: Camera, window: tuple[int, int, int, int], ground: tuple[float, ...]
) -> Floats:
    """The whole picture (h, w, k) with the window's part (h', w', k) in its place."""
    left, top, right, bottom = window
    whole = np.empty((camera.size[1], camera.size[0], part.shape[2]))
    whole[:] = ground
    whole[top:bottom, left:right] = part
    return whole


def _openness(scene: Scene, camera: Camera, layers: list[Layer], shown: Bools) -> Singles:
    """Openness (r, 3) at the corners of the triangles that are shown (r,), 1 at others.

    Found once for each shading vertex.
    """
    parts, begin = [], 0
    for layer in layers:
        surface = layer.surface
        corners = surface.corners(surface.vertex)
        mine, begin = shown[begin : begin + len(corners)], begin + len(corners)
        first = np.unique(surface.vertex, return_index=True)[1]
        points = camera.seen(surface.points.reshape(-1, 3)[first]).astype(np.float32)
        normals = (surface.normals.reshape(-1, 3)[first] @ camera.axes.T).astype(np.float32)
        near = np.zeros(len(first), bool)
        near[corners[mine]] = True
        near &= normals[:, 2] > -0.4
        found = np.ones(len(first), np.float32)
        found[near] = openness(scene, points[near], normals[near])
        parts.append(found[corners])
    return np.asarray(np.concatenate(parts), np.float32)


def _spread(number: int) -> Singles:
    """Directions (number, 3) spread evenly over the sphere, on a spiral of golden angles."""
    height = 1 - (2 * np.arange(number) + 1) / number
    turn = np.pi * (3 - np.sqrt(5)) * np.arange(number)
    ring = np.sqrt(1 - height**2)
    return np.stack([ring * np.cos(turn), ring * np.sin(turn), height], axis=1).astype(np.float32)


def _heights(corners: Singles, scale: float, drawn: Bools) -> Singles:
    """Height (r, 3) in pixels, as seen, of each corner over the side opposite it; inf if hidden."""
    flat = corners[..., :2] * np.float32(scale)
    a, b = flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0]
    area = np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    side = np.stack(
        [np.hypot(*(flat[:, (k + 2) % 3] - flat[:, (k + 1) % 3]).T) for k in range(3)], axis=1
    )
    return np.where(drawn, area[:, None] / np.maximum(side, 1e-6), 1e6).astype(np.float32)


def _three(weights: Singles) -> Singles:
    """All three barycentric weights (p, 3) from the second and third."""
    return np.concatenate([1 - weights.sum(axis=1, keepdims=True), weights], axis=1)


def _paint(layer: Layer, values: Singles) -> Singles:
    """The linear colour (p, 3) of a layer where it has the given values."""
    if layer.values is None or layer.table is None:
        return linear(np.array(layer.colour))
    low, high = layer.limits
    table = linear(layer.table)
    place = (values - low) / (high - low if high > low else 1.0) * (len(table) - 1)
    return np.asarray(table[np.clip(np.rint(place), 0, len(table) - 1).astype(np.int64)])


def _mixed(bary: Singles, corners: Singles) -> Singles:
    """Values (p, ...) between those at three corners (p, 3, ...)."""
    weights = bary.reshape(*bary.shape, *([1] * (corners.ndim - 2)))
    mixed = weights[:, 0] * corners[:, 0]
    for i in (1, 2):
        mixed += weights[:, i] * corners[:, i]
    return np.asarray(mixed, np.float32)


def _normalised(vectors: Singles) -> Singles:
    length = np.sqrt(_mixed(vectors, vectors))
    return np.asarray(vectors / np.maximum(length, 1e-6)[:, None], np.float32)


def _pooled(rays: Singles, factor: int) -> Floats:
    """Averages (h, w, k) over squares of factor x factor rays."""
    total = np.zeros((rays.shape[0] // factor, rays.shape[1] // factor, rays.shape[2]))
    for i in range(factor):
        for j in range(factor):
            total += rays[i::factor, j::factor]
    return np.asarray(total / factor**2)
