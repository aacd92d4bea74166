# SPDX-License-Identifier: BSD-3-Clause
"""A head phantom as a CT: made by formula, with its truth, to measure labels against."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, radians, sin
from types import MappingProxyType

import numpy as np

from bezsoma.arrays import Floats
from bezsoma.errors import InputError
from bezsoma.imaging import head_bodies as bodies
from bezsoma.imaging.meaning import AIR, BONE, CAVITY, MANDIBLE, SOFT
from bezsoma.imaging.shapes import Grid, Rod, Singles, coverage
from bezsoma.imaging.volume import Frame, Volume
from bezsoma.imaging.volume import Grid as Array

HU = MappingProxyType({
    "air": -1000.0, "plastic": 150.0, "metal": 3000.0, "skin": 30.0, "fat": -90.0, "muscle": 55.0,
    "brain": 35.0, "cortex": 1200.0, "marrow": 380.0, "tooth": 2000.0,
})  # fmt: skip
"""What each tissue of the phantom measures, in Hounsfield units."""
DERMIS, FAT, CORTEX = 2.0, 6.0, 2.0
"""mm: how deep skin and fat reach, and how thick the cortex of a bone is."""
LOW, HIGH = np.array([-92.0, -125.0, -96.0]), np.array([92.0, 134.0, 158.0])
"""The corners of what is in view, mm."""


@dataclass(frozen=True, eq=False)
class HeadCt:
    """A CT volume in HU, its true labels (z, y, x) at voxel centres, and the skin's level."""

    volume: Volume
    truth: Array
    skin: Singles
    """(z, y, x) near the skin its distance in mm to first order, negative inside."""


def head_ct(
    spacing: Sequence[float] = (1.5, 1.5, 1.5),
    *,
    noise: float = 20.0,
    tilt: float = 0.0,
    mouth: float = 0.0,
    joint: float = 1.5,
    bite: float = 1.0,
    things: bool = True,
    filling: bool = False,
    seed: int = 0,
) -> HeadCt:
    """A head as a CT with voxels of `spacing` mm along x, y, z and `noise` in HU (one sigma).

    `tilt` turns the grid in degrees about all three axes, `mouth` opens the mouth in degrees;
    `joint` is the gap in mm over the condyles and `bite` that between the teeth (0: they touch).
    `things` are a head rest that touches the head, a table, and wires on the cheeks. A `filling`
    of metal sends out streaks. The same arguments give the same bits.

    >>> head = head_ct((4, 4, 4))
    >>> head.volume.values.dtype, sorted(np.unique(head.truth).tolist())
    (dtype('int16'), [0, 1, 2, 3, 4])
    """
    if not (len(spacing) == 3 and min(spacing) >= 0.3 and max(spacing) <= 4):
        raise InputError(f"voxels of {tuple(spacing)} mm: three sizes of 0.3 to 4 mm are needed")
    if not (0 <= noise <= 500 and abs(tilt) <= 30 and 0 <= mouth <= 25):
        raise InputError(
            f"noise {noise} HU, tilt {tilt} and mouth {mouth} degrees: 0 to 500, -30 to 30 and 0 "
            "to 25 can be made"
        )
    grid = _grid(np.array(spacing, float), radians(tilt))
    parts = _levels(grid, radians(mouth), joint, bite)
    values = _cast(parts, grid, things)
    if filling:
        _streak(values, grid)
    values += np.random.default_rng(seed).normal(0, 1, values.shape).astype(np.float32) * noise
    whole = np.clip(np.rint(values), -1024, 3071).astype(np.int16)
    return HeadCt(Volume(whole, grid.frame), _truth(parts), parts["skin"])


def _grid(spacing: Floats, angle: float) -> Grid:
    """The grid over the head, turned about its middle."""
    axes = np.eye(3)
    for first, second in ((0, 1), (1, 2), (2, 0)):
        turn = np.eye(3)
        turn[[first, second], [first, second]] = cos(angle)
        turn[first, second], turn[second, first] = -sin(angle), sin(angle)
        axes = turn @ axes
    shape = np.ceil((HIGH - LOW) / spacing).astype(int)
    middle = (LOW + HIGH) / 2
    frame = Frame(spacing, middle - axes @ (spacing * (shape - 1) / 2), axes)
    return Grid(frame, (int(shape[0]), int(shape[1]), int(shape[2])))


def _levels(grid: Grid, mouth: float, joint: float, bite: float) -> dict[str, Singles]:
    """Levels (z, y, x) of every part, hollows already cut out of bones."""
    cast, without = grid.cast, _without
    angle = mouth  # y towards z: what lies in front goes down
    half = bite / 2 if bite > 0 else -0.15
    skull = np.minimum(without(cast(bodies.CRANIUM), cast(bodies.BRAIN)), cast(bodies.FACE, 3))
    for hollow in (bodies.BRAIN, bodies.ORBITS, bodies.fossae(joint if joint > 0 else -0.2)):
        skull = without(skull, cast(hollow))
    upper, lower = bodies.teeth(half, 16), bodies.teeth(-half, -26)
    skin = cast([*bodies.SKIN, *bodies.opened(bodies.SKIN_OF_JAW, angle)], 12, 40)
    hollows = [*bodies.SINUSES, *bodies.NOSE, *bodies.THROAT, *(bodies.MOUTH if mouth else [])]
    return {
        "skin": skin,
        "cavity": cast(hollows),
        "skull": skull,
        "spine": np.minimum(without(cast(bodies.SPINE), cast(bodies.CANAL)), cast(bodies.HYOID)),
        "jaw": cast(bodies.opened(bodies.JAW, angle), 2),
        "upper": cast(upper),
        "lower": cast(bodies.opened(lower, angle)),
        "fat": cast(bodies.ORBITS),
        "eyes": cast(bodies.EYES),
        "brain": cast(bodies.BRAIN),
        "sinuses": cast([*bodies.SINUSES, *bodies.NOSE]),
        "open": cast(bodies.MOUTH) if mouth else grid.empty(),
    }


def _without(body: Singles, hollow: Singles) -> Singles:
    return np.asarray(np.maximum(body, -hollow))


def _cast(parts: dict[str, Singles], grid: Grid, things: bool) -> Singles:
    """Values (z, y, x) in HU: every part painted over those before by how much it covers."""
    values = np.full(grid.shape[::-1], HU["air"], np.float32)
    if things:
        _paint(values, _rest(grid), "plastic")
    skin = parts["skin"]
    _paint(values, skin, "skin")
    _paint(values, skin + DERMIS, "fat")
    _paint(values, skin + FAT, "muscle")
    for name, tissue in (("fat", "fat"), ("eyes", "brain"), ("brain", "brain")):
        _paint(values, np.maximum(parts[name], skin + DERMIS), tissue)
    _paint(values, parts["open"], "air")
    for name in ("skull", "spine", "jaw"):
        _paint(values, np.maximum(parts[name], skin), "cortex")
        _paint(values, parts[name] + CORTEX, "marrow")
    _paint(values, np.minimum(parts["upper"], parts["lower"]), "tooth")
    kept = np.maximum(parts["cavity"], -np.minimum(parts["upper"], parts["lower"]))
    kept = np.maximum(kept, -np.minimum(parts["jaw"], parts["spine"]))
    _paint(values, np.maximum(kept, -np.maximum(parts["skull"], -parts["sinuses"])), "air")
    if things:
        _paint(values, _wires(grid, skin), "metal")
    return values


def _paint(values: Singles, levels: Singles, tissue: str) -> None:
    reached, part = coverage(levels)
    flat = values.reshape(-1)
    flat[reached] += part * (np.float32(HU[tissue]) - flat[reached])


def _rest(grid: Grid) -> Singles:
    """A shell of 4 mm around the back of the head, which it touches, and a table under it."""
    p = grid.points()
    across = np.hypot(p[..., 0], p[..., 1] - 8)
    shell = np.maximum(np.abs(across - 98.5) - 2, 60 - p[..., 1])
    table = np.abs(p[..., 1] - 124) - 3
    return np.asarray(np.minimum(shell, table), np.float32)


def _wires(grid: Grid, skin: Singles) -> Singles:
    """Two wires of 1.2 mm that lie on the cheeks."""
    p = grid.points()
    beside = np.abs(np.abs(p[..., 0]) - 45) - 0.6
    along = np.maximum(np.abs(p[..., 2] - 12) - 28, p[..., 1])
    return np.asarray(np.maximum(np.maximum(beside, along), np.abs(skin - 0.5) - 0.6), np.float32)


def _streak(values: Singles, grid: Grid) -> None:
    """A filling of metal in a lower molar, and streaks in its slices."""
    place = (28.0, -46.0, -4.0)
    p = grid.points() - place
    reach = np.hypot(p[..., 0], p[..., 1]) + 1
    wave = np.cos(9 * np.arctan2(p[..., 1], p[..., 0])) * np.exp(-((p[..., 2] / 4) ** 2))
    values += (900 * wave * np.exp(-reach / 45)).astype(np.float32)
    values[grid.cast([Rod(place, place, 3, 3)]) < 0] = 6000


def _truth(parts: dict[str, Singles]) -> Array:
    """Labels (z, y, x) at voxel centres, in the order in which parts were painted."""
    labels = np.full(parts["skin"].shape, AIR, np.uint8)
    skin, inner = parts["skin"], parts["skin"] < 0
    labels[inner] = SOFT
    labels[(parts["open"] < 0) & inner] = CAVITY
    for name, label in (("skull", BONE), ("spine", BONE), ("jaw", MANDIBLE)):
        labels[(parts[name] < 0) & (skin < 0)] = label
    labels[parts["upper"] < 0] = BONE
    labels[parts["lower"] < 0] = MANDIBLE
    hollow = (parts["cavity"] < 0) & ~np.isin(labels, (MANDIBLE,)) & inner
    hollow &= (parts["upper"] >= 0) & (parts["spine"] >= 0)
    hollow &= (parts["skull"] >= 0) | (parts["sinuses"] < 0)
    labels[hollow] = CAVITY
    return labels
