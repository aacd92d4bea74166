# SPDX-License-Identifier: BSD-3-Clause
"""Rays against triangles, on the processor alone: no display, no graphics library."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from bezsoma.errors import MissingExtra

Singles = npt.NDArray[np.float32]


def _embree() -> tuple[Any, Any]:
    """The classes of embreex for a scene and its triangles."""
    try:
        from embreex.mesh_construction import TriangleMesh
        from embreex.rtcore_scene import EmbreeScene
    except ImportError as error:
        raise MissingExtra(
            "pictures need the package embreex, which is not installed here (some platforms have"
            " no wheel of it): python -m pip install embreex; files for other viewers can be"
            " written without it, by write_vtu"
        ) from error
    return EmbreeScene, TriangleMesh


@dataclass(frozen=True, eq=False)
class Scene:
    """Triangles that rays can hit."""

    corners: Singles
    """(r, 3, 3) the corners of each triangle in mm, in a frame whose origin is near."""

    @cached_property
    def _scene(self) -> Any:
        scene_of, triangles_of = _embree()
        scene = scene_of()
        triangles_of(scene, np.ascontiguousarray(self.corners, np.float32))
        return scene

    def hits(self, origins: Singles, direction: Singles) -> tuple[npt.NDArray[np.int32], Singles]:
        """Which triangle (p,) parallel rays from (p, 3) hit first, -1 for none, and where.

        The second array (p, 2) holds the barycentric weights of the triangle's second and third
        corner.

        >>> scene = Scene(np.array([[[0, 0, 0], [1, 0, 0], [0, 1, 0]]], np.float32))
        >>> start = np.array([[0.25, 0.5, 9], [2, 2, 9]], np.float32)
        >>> triangle, weights = scene.hits(start, np.array([0, 0, -1], np.float32))
        >>> triangle.tolist(), weights[0].tolist()
        ([0, -1], [0.25, 0.5])
        """
        found = self._scene.run(origins, _repeated(direction, len(origins)), output=True)
        return found["primID"], np.stack([found["u"], found["v"]], axis=1)

    def blocked(self, origins: Singles, directions: Singles) -> npt.NDArray[np.bool_]:
        """Whether anything lies on the rays (p,) from (p, 3) along (p, 3)."""
        return np.asarray(self._scene.run(origins, directions, query="OCCLUDED") >= 0)


def _repeated(direction: Singles, number: int) -> Singles:
    return np.ascontiguousarray(np.broadcast_to(direction.astype(np.float32), (number, 3)))
