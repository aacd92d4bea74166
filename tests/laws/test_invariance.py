# SPDX-License-Identifier: BSD-3-Clause
"""The answer belongs to the body, not to how it is written down: order, frame, place, unit."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import bezsoma as bz
from bezsoma.arrays import Floats, Ints
from bezsoma.mesh import TetMesh, block
from tolerances import INVARIANCE

DEGREES = (1, 2, 4)
STIFF, SOFT = (0.3, 0.3), (0.015, 0.45)
"""E in MPa and nu of two regions."""
TURN = Rotation.from_rotvec([0.7, -1.1, 0.4]).as_matrix()
SCANNER = np.array([1000.0, -700.0, 1300.0])


@dataclass(frozen=True)
class Written:
    """A way to write a body down: x' = length * turn x + shift, stresses times `stress`.

    `seed` shuffles tets, vertices and the vertices within each tet.
    """

    turn: Floats = field(default_factory=lambda: np.eye(3))
    shift: Floats = field(default_factory=lambda: np.zeros(3))
    length: float = 1.0
    stress: float = 1.0
    seed: int | None = None

    def there(self, x: Floats) -> Floats:
        """Points (p, 3) in the new frame."""
        return self.length * x @ self.turn.T + self.shift

    def here(self, x: Floats) -> Floats:
        """Points (p, 3) of the new frame in the old one."""
        return (x - self.shift) @ self.turn / self.length

    @property
    def hand(self) -> float:
        """-1 for a mirrored frame, where turns and moments change their sense."""
        return float(np.linalg.det(self.turn))


WAYS = {
    "tets, vertices and their order shuffled": Written(seed=1),
    "turned": Written(turn=TURN),
    "mirrored": Written(turn=np.diag([1.0, 1.0, -1.0])),
    "in scanner coordinates": Written(shift=SCANNER),
    "turned, in scanner coordinates, shuffled": Written(turn=TURN, shift=SCANNER, seed=2),
    "in kilometres": Written(length=1e-6, stress=1e12),
    "in nanometres": Written(length=1e6, stress=1e-12),
    "a millionth as stiff and as loaded": Written(stress=1e-6),
    "a million times as stiff and as loaded": Written(stress=1e6),
}


def plain() -> TetMesh:
    """An irregular block of two regions."""
    mesh = block((1.5, 1.0, 0.8), cells=(3, 2, 2), irregular=0.3, seed=7)
    region = (mesh.points[mesh.tets].mean(axis=1)[:, 0] > 0.8).astype(int)
    return TetMesh(mesh.points, mesh.tets, region, ("soft", "stiff"), mesh.surfaces)


def rewritten(mesh: TetMesh, way: Written) -> TetMesh:
    """The same mesh written another way."""
    points, tets, region = way.there(mesh.points), mesh.tets, mesh.region
    number = np.arange(len(points))
    if way.seed is not None:
        rng = np.random.default_rng(way.seed)
        number = rng.permutation(len(points))
        order = rng.permutation(len(tets))
        tets, region = rng.permuted(tets[order], axis=1), region[order]
    moved = np.empty_like(points)
    moved[number] = points

    def renamed(rows: Ints) -> Ints:
        return number[rows]

    surfaces = {name: renamed(rows) for name, rows in mesh.surfaces.items()}
    return TetMesh(moved, renamed(tets), region, mesh.regions, surfaces)


def body(way: Written, degree: int) -> bz.Body:
    """Moved as a bone, held, pressed, pulled, weighed and poked."""
    mesh = rewritten(plain(), way)
    L, S, Q = way.length, way.stress, way.turn

    def weight(x: Floats) -> Floats:
        x = way.here(x)
        return (
            S / L * np.stack([0.001 * x[:, 1], 0.002 * x[:, 0] ** 2, -0.003 + 0 * x[:, 0]], 1) @ Q.T
        )

    def pressure(x: Floats) -> Floats:
        return S * 0.001 * (1 + way.here(x)[:, 0] * way.here(x)[:, 1])

    def bent(x: Floats) -> Floats:
        x = way.here(x)
        return L * np.stack([0 * x[:, 0], 0.1 * x[:, 2] ** 2, 0.05 * x[:, 1]], 1) @ Q.T

    jaw = bz.Moved(
        "right",
        translation=L * Q @ [0.1, -0.2, 0.05],
        axis=way.hand * Q @ [1, 2, -1],
        angle=0.2,
        about=way.there(np.array([1.5, 0.2, 0.1])),
    )
    loads = [
        bz.BodyForce(weight, exactness=degree + 2),
        bz.Pressure("back", value=pressure, exactness=degree + 2),
        bz.Traction("top", value=S * Q @ [0.002, 0, 0.001]),
        bz.PointForce(way.there(plain().points[20]), S * L**2 * Q @ [0, 0.001, 0]),
    ]
    laws = {
        name: bz.LinearElastic(S * E, nu)
        for name, (E, nu) in {"soft": SOFT, "stiff": STIFF}.items()
    }
    return bz.Body(mesh, degree, laws, [jaw, bz.Prescribed("left", value=bent)], loads)


def graded(way: Written, degree: int) -> bz.Body:
    """A moved side that meets a held floor: the jump is graded over a band in mm."""
    L, Q = way.length, way.turn
    jaw = bz.Moved("right", translation=L * Q @ [0.1, -0.2, 0.05])
    joins = [bz.Graded(over="bottom", to="right", band=0.7 * L)]
    law = bz.LinearElastic(way.stress * 0.015, 0.45)
    laws = {"soft": law, "stiff": law}
    return bz.Body(rewritten(plain(), way), degree, laws, [jaw, bz.Fixed("bottom")], joins=joins)


BODIES = {"body": body, "graded": graded}


@dataclass(frozen=True, eq=False)
class Answer:
    """What is compared, brought back to the plain frame and unit."""

    displacement: Floats
    stress: Floats
    energy: Floats
    volume_change: Floats
    force: Floats
    moment: Floats


@lru_cache
def plain_answer(which: str, degree: int) -> Answer:
    return answer(which, Written(), degree)


def answer(which: str, way: Written, degree: int) -> Answer:
    """The answer, at points inside every tet; found by their coordinates, whatever the order."""
    solution = bz.solve(BODIES[which](way, degree), solver="direct")
    mesh = plain()
    bary = np.array([[0.25] * 4, [0.7, 0.1, 0.15, 0.05], [0.1, 0.1, 0.1, 0.7]])
    points = way.there((bary @ mesh.points[mesh.tets]).reshape(-1, 3))
    L, S, Q = way.length, way.stress, way.turn
    parts = [solution.reactions[name] for name in sorted(solution.reactions)]
    force = np.array([r.force for r in parts]) / (S * L**2)
    moment = np.array([r.moment for r in parts]) / (S * L**3)
    moment -= np.cross(way.shift / L, force)
    return Answer(
        solution.displacement.at(points) / L @ Q,
        Q.T @ solution.stress.at(points) / S @ Q,
        np.array(solution.energy / (S * L**3)),
        np.array(solution.volume_change / L**3),
        force @ Q,
        way.hand * moment @ Q,
    )


@pytest.mark.parametrize("degree", DEGREES)
@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("which", BODIES)
def test_answer_does_not_depend_on_how_it_is_written(which: str, way: str, degree: int) -> None:
    found, wanted = answer(which, WAYS[way], degree), plain_answer(which, degree)
    for name, value in vars(wanted).items():
        apart = np.abs(getattr(found, name) - value).max() / np.abs(value).max()
        assert apart < INVARIANCE, name


def test_a_wrong_hand_would_show() -> None:
    """The test of the test: an answer taken back with the wrong turn is far from the plain one."""
    found, wanted = answer("body", Written(turn=TURN), 1), plain_answer("body", 1)
    largest = np.abs(wanted.stress).max()
    assert np.abs(found.stress @ TURN - wanted.stress).max() > 0.1 * largest
    assert np.abs(found.stress - wanted.stress).max() < INVARIANCE * largest
