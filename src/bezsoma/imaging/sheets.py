# SPDX-License-Identifier: BSD-3-Clause
"""Surfaces by formula over azimuth and row: how a table of anatomy becomes skin or bone. mm."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import PchipInterpolator

from bezsoma.arrays import Floats
from bezsoma.imaging import anatomy


@dataclass(frozen=True, eq=False)
class Sheet:
    """A surface over azimuth [degrees] and row [-]: rows (r, 8) and bumps (b, 7) in mm.

    Azimuth a is 0 in front and 90 on the patient's left. On a row, with the numbers that
    `anatomy` names,

        x = half sin a
        y = side - (side - base) cos a + (front - base) exp(-|x/w|^n)
        z = z_side + (z_front - z_side) cos a

    : half an ellipse, tilted where the side lies higher than the front, with the midline feature
    (nose, lips, chin) on it. Between rows each number is a monotone cubic of the row (Fritsch and
    Carlson 1980, doi:10.1137/0717021), so a tip stays a tip and nothing overshoots. Bumps then
    move the point along the ellipse's horizontal normal.

    The row that names a point passes through it, and nothing near it lies further forward:

    >>> face = Sheet(anatomy.SKIN, anatomy.SKIN_BUMPS[:0])
    >>> tip = anatomy.ROWS.index("Prn")
    >>> face.points(np.array(0.0), np.array(float(tip))).tolist() == [0, -115, 32]
    True
    >>> bool(face.points(np.zeros(99), np.linspace(tip - 1, tip + 1, 99))[:, 1].min() == -115)
    True

    Where the feature is gone it is the ellipse, and the right side mirrors the left:

    >>> plain = Sheet(np.array([[5.0, -90, -90, 20, 2, 60, 0, 5]] * 2), np.empty((0, 7)))
    >>> x, y, z = plain.points(np.linspace(-98, 98, 50), np.zeros(50)).T
    >>> bool(abs((x / 60) ** 2 + (y / 90) ** 2 - 1).max() < 1e-14), bool((x == -x[::-1]).all())
    (True, True)
    """

    rows: Floats
    """(r, 8) mm: z, front, base, w, n [-], half, side, z_side; the order of `anatomy.SKIN`."""
    bumps: Floats
    """(b, 7) mm: x, z, half widths, tilt [degrees], power [-], height."""

    def points(self, azimuth: Floats, row: Floats) -> Floats:
        """Points (..., 3) in mm at azimuths (...) in degrees and rows (...)."""
        numbers = PchipInterpolator(np.arange(len(self.rows)), self.rows)(row)
        z_front, front, base, w, n, half, side, z_side = np.moveaxis(numbers, -1, 0)
        sine, cosine = np.sin(np.deg2rad(azimuth)), np.cos(np.deg2rad(azimuth))
        x, z = half * sine, z_side + (z_front - z_side) * cosine
        feature = (front - base) * np.exp(-(np.abs(x / w) ** n))
        normal = np.stack([(side - base) * sine, -half * cosine, 0 * sine], axis=-1)
        normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
        section = np.stack([x, side - (side - base) * cosine + feature, z], axis=-1)
        return np.asarray(section + heights(x, z, self.bumps)[..., None] * normal)


def heights(x: Floats, z: Floats, bumps: Floats) -> Floats:
    """How far bumps (b, 7) lift a surface at x and z (...), mm; both sides alike.

    A bump of height h is h exp(-s^p), s = (along/a)^2 + (across/b)^2, in axes turned by its tilt;
    it and its mirror image are added. Far from the median plane only one of the two counts:

    >>> bump = np.array([[40.0, 10, 6, 3, 90, 1, 2.5]])  # turned by 90 degrees: 6 mm along z
    >>> at = heights(np.array([40.0, -40, 40, 43]), np.array([10.0, 10, 16, 10]), bump)
    >>> np.round(at / 2.5, 12).tolist() == np.round([1, 1, np.exp(-1), np.exp(-1)], 12).tolist()
    True
    """
    lifted = np.zeros(np.shape(x))
    for x_middle, z_middle, along, across, tilt, power, height in bumps:
        cosine, sine = np.cos(np.deg2rad(tilt)), np.sin(np.deg2rad(tilt))
        for across_x in (x - x_middle, -x - x_middle):
            up = z - z_middle
            s = ((cosine * across_x + sine * up) / along) ** 2
            s = s + ((cosine * up - sine * across_x) / across) ** 2
            lifted += height * np.exp(-(s**power))
    return lifted


SKIN = Sheet(anatomy.SKIN, anatomy.SKIN_BUMPS)
"""The skin of the phantom."""
BONE = Sheet(anatomy.BONE, anatomy.BONE_BUMPS)
"""Its deep surface: bone, mucosa over the teeth, and the deep side of the neck."""
