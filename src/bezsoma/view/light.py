# SPDX-License-Identifier: BSD-3-Clause
"""How a place is lit, and how light becomes a colour on a screen.

One key lamp above the viewer's shoulder, a weak fill from the other side, and light from the
whole sky that reaches a place only as far as the surface around leaves it open: that openness
(ambient occlusion) is what shows the folds beside the nose and under the lip. Light adds up
linearly, so it is added before the eye's gamma is applied.
"""

from __future__ import annotations

import numpy as np

from bezsoma.arrays import Floats
from bezsoma.view.camera import Camera
from bezsoma.view.rays import Singles

SKIN = (0.925, 0.775, 0.690)
CLAY = (0.845, 0.825, 0.790)
BONE = (0.905, 0.865, 0.765)
TISSUE = (0.850, 0.600, 0.560)
REST = (0.800, 0.808, 0.820)
BACKGROUND = (0.972, 0.974, 0.978)
_KEY = (0.50, 0.55, 0.67)
_FILL = (-0.80, 0.05, 0.60)
_SKIN_WRAP = (0.32, 0.24, 0.20)
_SKIN_SHADE = (1.04, 0.98, 0.94)
_PLAIN_WRAP = (0.20, 0.20, 0.20)


def lamps(camera: Camera) -> Singles:
    """Directions (3, 3) in the camera's frame to the key lamp, the fill lamp and for gloss.

    The key stands on the side to which the face is turned, so that its profile is in the light;
    the viewer's left where it looks straight ahead.
    """
    ahead = float(camera.axes[0] @ np.array([0.0, -1.0, 0.0]))
    side = np.array([1.0 if ahead > 0.2 else -1.0, 1.0, 1.0])
    key, fill = (np.array(lamp) * side for lamp in (_KEY, _FILL))
    key, fill = key / np.linalg.norm(key), fill / np.linalg.norm(fill)
    half = key + np.array([0.0, 0.0, 1.0])
    return np.stack([key, fill, half / np.linalg.norm(half)]).astype(np.float32)


def lit(
    paint: Singles,
    normal: Singles,
    open_: Singles,
    standing: Singles,
    translucent: bool = False,
    painted: bool = False,
) -> Singles:
    """Light (p, 3) from places with these unit normals and this openness, under lamps (3, 3).

    Painted values get flatter light, so that a colour can be found again in its colour bar.
    """
    wrap = np.array(_SKIN_WRAP if translucent else _PLAIN_WRAP, np.float32)
    key = np.clip(((normal @ standing[0])[:, None] + wrap) / (1 + wrap), 0, None)
    fill = np.clip((normal @ standing[1] + 0.25) / 1.25, 0, None) * open_
    sky = open_ * (0.75 + 0.25 * normal[:, 1])
    tint = np.array(_SKIN_SHADE if translucent else (1, 1, 1), np.float32)
    shade = (0.15 * fill + 0.27 * sky)[:, None] * tint
    light = 0.76 * key * (0.3 + 0.7 * open_)[:, None] + shade
    gloss = 0.06 * np.clip(normal @ standing[2], 0, None) ** 18 * open_
    if painted:
        light, gloss = 0.34 + 0.66 * light, 0.7 * gloss
    return np.asarray(paint * light + gloss[:, None], np.float32)


def linear(colours: Floats) -> Singles:
    """Light from the values that a screen is given (IEC 61966-2-1)."""
    low = colours / 12.92
    return np.where(colours <= 0.04045, low, ((colours + 0.055) / 1.055) ** 2.4).astype(np.float32)


def screen(light: Floats) -> Floats:
    """The values that a screen is given, from 0 to 1, for light: the inverse of `linear`.

    >>> shown = np.linspace(0, 1, 9)
    >>> bool(np.allclose(screen(linear(shown).astype(float)), shown))
    True
    """
    clipped = np.clip(light, 0, 1)
    return np.where(clipped <= 0.0031308, 12.92 * clipped, 1.055 * clipped ** (1 / 2.4) - 0.055)
