# SPDX-License-Identifier: BSD-3-Clause
"""A body at a fraction of its load: what is prescribed on the way to the whole."""

from __future__ import annotations

from dataclasses import dataclass, replace

from bezsoma.arrays import Floats
from bezsoma.mechanics.body import Body
from bezsoma.mechanics.supports import Fixed, Moved, Support


@dataclass(frozen=True, eq=False)
class Part:
    """A fraction of what another support prescribes."""

    whole: Support
    fraction: float

    @property
    def places(self) -> tuple[str, ...]:
        """The same places."""
        return self.whole.places

    @property
    def components(self) -> str:
        """The same components."""
        return self.whole.components

    @property
    def degree(self) -> int | None:
        """The same degree."""
        return self.whole.degree

    def displacement(self, points: Floats) -> Floats:
        """That fraction of the displacement (p, 3) mm."""
        return self.fraction * self.whole.displacement(points)


def support_at(support: Support, fraction: float) -> Support:
    """The support on its way: what moves rigidly stays rigid, turned by a fraction of its angle.

    Half of a half turn is a quarter turn, not the straight way, on which a bone would shrink to
    a line:

    >>> import numpy as np
    >>> flip = Moved("jaw", axis=(0, 0, 1), angle=np.pi, about=(0, 0, 0))
    >>> x = np.array([[1.0, 0, 0]])
    >>> (x + support_at(flip, 0.5).displacement(x)).round(12).tolist()
    [[0.0, 1.0, 0.0]]
    """
    if isinstance(support, Fixed):
        return support
    if not isinstance(support, Moved):
        return Part(support, fraction)
    if not support.angle:
        shift = fraction * support.translation
        return Moved(*support.places, translation=shift, components=support.components)
    return Moved(
        *support.places,
        translation=fraction * support.translation,
        axis=support.axis,
        angle=fraction * support.angle,
        about=support.about,
        components=support.components,
    )


def body_at(body: Body, fraction: float) -> Body:
    """The same body with that fraction of its prescribed displacements; loads are left as they are.

    The whole is the body itself:

    >>> from bezsoma.mechanics import LinearElastic
    >>> from bezsoma.mesh.solids import block
    >>> body = Body(block(), 1, LinearElastic(1.0, 0.3), [Fixed("bottom")])
    >>> body_at(body, 1.0) is body
    True
    """
    if fraction == 1:
        return body
    return replace(body, supports=[support_at(each, fraction) for each in body.supports])


def turns(body: Body) -> bool:
    """Whether a support turns: then the way to the whole is no straight line."""
    return any(isinstance(each, Moved) and each.angle for each in body.supports)
