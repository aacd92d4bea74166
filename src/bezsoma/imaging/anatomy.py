# SPDX-License-Identifier: BSD-3-Clause
"""The anatomy of the head phantom as tables: rows from the neck to the forehead, and bumps.

Lengths are mm, the frame is LPS: x to the patient's left, y to posterior, z to superior. The
origin lies in the median plane at the height of the closed lips, under the ears. `sheets` says
how a table becomes a surface. The numbers are those of no person: they were chosen so that face
heights, breadths, the profile and the tissue's thickness lie within what is usual for adults
(tests/laws/test_phantom.py names the ranges), and so that the picture is a face.
"""

from __future__ import annotations

import numpy as np

from bezsoma.arrays import frozen

ROWS = (
    "neck", "throat", "under the chin", "Me'", "Pg'", "B'", "under the lip", "Li", "Stm", "Ls",
    "A'", "Sn", "columella", "Prn", "above the tip", "dorsum", "bridge", "lids", "N'", "G'",
    "brow", "forehead",
)  # fmt: skip
"""Names of the rows, from below: cephalometric ones where there are such points of the skin."""

AZIMUTHS = (0.0, 5.5, 11.0, 16.5, 22.5, 29.0, 36.5, 45.5, 56.0, 68.5, 82.5, 98.0)
"""Where the columns stand in degrees from the median plane: close together at nose and mouth."""

# Each row of a sheet, mm: z and y where it crosses the median plane; y there without the midline
# feature (nose, lips, chin); half width w and power n of that feature; half width of the head,
# and y and z of its side, where the azimuth is 90 degrees.
SKIN = frozen(np.array([
    [   -80,  -37.5,  -37.5,    20,     2,    53,    17,   -72],
    [   -61,    -43,    -43,    20,     2,    54,    16,   -54],
    [   -53,    -63,    -61,    18,     2,  54.5,     9,   -34],
    [   -46,    -85,    -80,    18,   2.4,    56,     2,   -21],
    [   -33,  -94.5,    -87,    17,   2.4,    59,     0,   -14],
    [   -19,    -91,  -88.5,    22,   2.4,  61.5,     0,    -7],
    [   -12,    -94,    -89,    20,   2.6,    63,     0,    -1],
    [    -6,  -98.5,  -89.5,    22,     3,    64,     0,     5],
    [     0,    -94,    -90,    26,     4,    65,     0,    11],
    [     6, -100.5,  -90.5,    21,   2.6,    66,     0,  17.5],
    [    13,    -98,  -90.5,    22,   2.4,    67,     0,    24],
    [    20,    -98,    -90,    16,   2.4,    68,     0,    31],
    [    25,   -107,    -89,  12.5,     3,  68.5,     0,  37.5],
    [    32,   -115,  -87.5,    12,   2.6,    69,     0,    44],
    [    41, -109.5,  -85.5,    11,   2.2,  69.5,     0,    50],
    [  48.5, -103.5,    -84,  10.5,     2,  69.5,     0,  55.5],
    [    56,    -97,    -83,   9.5,     2,  69.5,     0,  61.5],
    [  63.5,    -91,    -83,     9,     2,  69.5,     0,    68],
    [  72.5,  -86.5,  -84.5,    11,     2,    69,     0,  75.5],
    [    86,    -90,  -86.5,    16,     2,  68.5,     0,    87],
    [   104,    -88,    -87,    20,     2,  68.5,     0,   104],
    [   126,    -78,    -78,    20,     2,  66.5,     0,   125],
]))  # fmt: skip
"""The skin, a line for every name of `ROWS`."""

BONE = frozen(np.array([
    [   -78,  -28.5,  -28.5,    20,     2,    44,    17,   -70],
    [   -53,    -35,    -35,    20,     2,    44,    16,   -50],
    [   -44,    -58,    -57,    20,     2,    44,     9,   -29],
    [   -39,    -77,    -73,    18,   2.2,    45,     2,   -17],
    [   -31,    -84,    -78,    16,   2.2,    46,     0,   -11],
    [   -20,    -80,    -79,    18,   2.2,  46.5,     0,    -5],
    [   -13,    -82,    -80,    20,   2.2,    47,     0,     0],
    [    -7,  -85.5,    -81,    20,   2.4,  47.5,     0,   5.5],
    [     0,  -86.5,    -82,    20,   2.4,  48.5,     0,  11.5],
    [     6,    -88,    -82,    20,   2.4,  49.5,     0,    18],
    [    14,  -84.5,    -81,    20,   2.4,  51.5,     0,    24],
    [    22,    -88,  -79.5,    11,   2.2,    54,     0,    31],
    [    28,    -94,    -79,     8,   2.2,    57,     0,  37.5],
    [    35,   -101,  -78.5,   7.5,   2.2,  60.5,     0,    44],
    [    43,  -98.5,    -78,     7,   2.2,  61.5,     0,    50],
    [    50,    -96,  -77.5,     7,     2,  62.5,     0,  55.5],
    [    57,    -91,  -76.5,     7,     2,  62.5,     0,  61.5],
    [    64,  -85.5,    -76,     7,     2,  62.5,     0,    68],
    [  72.5,  -80.5,  -75.5,    10,     2,  62.5,     0,  75.5],
    [    86,  -84.5,    -81,    14,     2,  62.5,     0,    87],
    [   104,  -82.5,  -81.5,    20,     2,    63,     0,   104],
    [   126,  -72.5,  -72.5,    20,     2,    61,     0,   125],
]))  # fmt: skip
"""The deep surface: bone, at the nose with the firm frame of the nose, below it the neck's."""

# Each bump, mm: x and z of its middle, half widths along and across, tilt in degrees (its long
# axis turned from x towards z), power (1 a Gaussian, more: steeper sides), height outwards. The
# same bump stands on the right side.
SKIN_BUMPS = frozen(np.array([
    [  14.2,     25,    4.6,   6.5,     0,     1,   8.5],  # wings of the nose
    [   6.5,   23.5,    3.4,   2.8,     0,     1,    -3],  # nostrils
    [    33,     64,     19,    15,     0,     1,    -9],  # eye sockets
    [  31.5,     62,     13,    10,     0,   1.5,     8],  # eyeballs behind closed lids
    [    31,     60,   12.5,   1.8,    -4,   1.5,    -2],  # the closed lids' line
    [    28,     83,     18,     9,    -8,     1,   1.5],  # brows
    [    47,     40,     16,    13,    20,     1,   3.5],  # cheekbones
    [    38,     20,     13,    14,     0,     1,     3],  # cheeks
    [    25,     13,    3.2,    14,    25,     1,  -1.5],  # folds from the nose to the mouth
    [    27,      0,      4,     4,     0,     1,  -2.5],  # corners of the mouth
    [     5,     11,    2.6,     7,     6,     1,     1],  # ridges of the philtrum
    [     0,     12,    2.5,     6,     0,     1,  -0.5],  # philtrum
    [    60,     92,     18,    18,     0,     1,    -3],  # temples
]))  # fmt: skip
"""What stands out of the skin or is sunk into it."""

BONE_BUMPS = frozen(np.array([
    [    33,     64,     17,    12,     0,     1,    -5],  # orbits, filled
    [    28,     82,     18,     6,   -10,     1,     3],  # brows
    [    50,     42,     18,    14,    15,     1,     5],  # cheekbones
]))  # fmt: skip
"""The same for bone."""
