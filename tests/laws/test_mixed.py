# SPDX-License-Identifier: BSD-3-Clause
"""The mixed form's operators, stable pairs, the level of the pressure, and tets that lock."""

from __future__ import annotations

import numpy as np
import pytest

import bezsoma as bz
from bezsoma.equations import locked
from bezsoma.equations.level import undetermined, without_mean
from bezsoma.equations.locked import held_tets, unlocked
from bezsoma.equations.mixed import coupling, mixed_matrix
from bezsoma.equations.mixed_free import MixedFree
from bezsoma.equations.stress import volume_change
from bezsoma.equations.volume import change_of_volume
from bezsoma.mesh import ControlNet, TetMesh, ball, block
from bezsoma.mesh.split import split
from bezsoma.mesh.torn import pressure_net, torn
from laws.inf_sup import inf_sup
from tolerances import CLOSED_FORM, ROUNDING

SIDES = ("left", "right", "front", "back", "bottom", "top")


def layers(cells: int = 2, irregular: float = 0.2) -> TetMesh:
    """A block of two regions, "low" and the thicker "high", the plane between them straight."""
    plain = block((1.0, 0.9, 1.2), cells=(cells, cells, 3), irregular=irregular, seed=3)
    points = plain.points.copy()
    middle = np.isclose(block((1.0, 0.9, 1.2), cells=(cells, cells, 3)).points[:, 2], 0.4)
    points[middle, 2] = 0.4
    region = (points[plain.tets].mean(axis=1)[:, 2] > 0.4).astype(int)
    mesh = TetMesh(points, plain.tets, region, ("low", "high"), plain.surfaces)
    seam = mesh.all_faces[middle[mesh.all_faces].all(axis=1)]
    return mesh.with_surface("seam", seam)


@pytest.mark.parametrize(("degree", "lower"), [(2, 1), (3, 1), (3, 2), (4, 3), (6, 5)])
@pytest.mark.parametrize("breaks", [False, True])
def test_with_and_without_a_matrix(degree: int, lower: int, breaks: bool) -> None:
    mesh = layers(1)
    net, pressures = ControlNet(mesh, degree), pressure_net(mesh, lower, breaks)
    moduli = np.array([[0.4, 0.0], [3.0, 0.7]])
    rng = np.random.default_rng(degree)
    u, p = rng.uniform(-1, 1, (net.count, 3)), rng.uniform(-1, 1, pressures.count)
    f, g = mixed_matrix(net, pressures, moduli).apply(u, p)
    free = MixedFree(net, pressures, moduli)
    for found, wanted in zip(free.apply(u, p), (f, g), strict=True):
        assert np.abs(found - wanted).max() < CLOSED_FORM * np.abs(wanted).max()
    energy = (np.einsum("ck,ck->", u, f) - p @ (coupling(net, pressures) @ u.ravel())) / 2
    soft = mixed_matrix(net, pressures, moduli).softness
    assert free.energy(u, p) == pytest.approx(energy + p @ (soft @ p) / 2, rel=CLOSED_FORM)


def test_the_coupling_is_the_volume_change() -> None:
    """Against a constant pressure: minus the flux of u through the boundary (Gauss)."""
    mesh = ball(1.0, cells=2)
    net, pressures = ControlNet(mesh, 3), ControlNet(mesh, 2)
    u = bz.Field.interpolating(net, lambda x: np.sin(3 * x + x[:, ::-1]))
    total = (coupling(net, pressures) @ u.controls.ravel()).sum()
    assert total == pytest.approx(-volume_change(u), rel=CLOSED_FORM)


def test_a_torn_mesh_has_the_same_tets() -> None:
    mesh = layers()
    cut = torn(mesh)
    assert (cut.region == mesh.region).all()
    assert (cut.points[cut.tets] == mesh.points[mesh.tets]).all()
    assert len(np.unique(cut.components())) == 2
    assert torn(block()).points.shape == (8, 3)


@pytest.mark.parametrize(("degree", "bound"), [(2, 0.64), (3, 0.51), (4, 0.45)])
def test_accepted_pairs_are_stable(degree: int, bound: float) -> None:
    """0.66, 0.53 and 0.47 on Kuhn's tets of a cube with its bottom held, however fine."""
    cells = (2, 3) if degree == 2 else (1, 2)
    found = [inf_sup(block(cells=n), degree, degree - 1, "bottom") for n in cells]
    assert min(found) > bound, found
    assert found[-1] > 0.97 * found[-2], found
    for lower in range(1, degree):
        assert inf_sup(block(cells=1, irregular=0.3), degree, lower, "bottom") > bound - 0.06


def test_refused_pairs_are_not() -> None:
    """Equal degrees have pressures that nothing feels; a constant a tet falls with h."""
    for degree in (1, 2):
        assert inf_sup(block(cells=2, irregular=0.3), degree, degree, "bottom") < 1e-6
    falling = [inf_sup(block(cells=n), 2, 0, "bottom") for n in (1, 2, 3)]
    assert falling[0] > 1.9 * falling[1] > 1.9 * 1.3 * falling[2]


def modes(mesh: TetMesh, places: dict[str, str], breaks: bool, rigid: str) -> int:
    """How many pressures are undetermined, with components of places held."""
    net, pressures = ControlNet(mesh, 2), pressure_net(mesh, 1, breaks)
    held = np.zeros((net.count, 3), bool)
    for place, components in places.items():
        for letter in components:
            held[net.of_place(place), "xyz".index(letter)] = True
    soft = np.zeros(len(mesh.tets), bool)
    if rigid != "both":
        soft = mesh.region != mesh.regions.index(rigid)
    found = undetermined(net, pressures, held, soft)
    work = (coupling(net, pressures).T @ found.T).reshape(net.count, 3, -1)
    assert np.abs(work[~held]).max(initial=0) < ROUNDING
    assert (found[:, pressures.of_tet][:, soft] == 0).all()
    return len(found)


ALL = dict.fromkeys(SIDES, "xyz")
NORMALS = dict(zip(SIDES, "xxyyzz", strict=True))


@pytest.mark.parametrize(
    ("places", "breaks", "rigid", "count"),
    [
        (ALL, False, "both", 1),
        (NORMALS, False, "both", 1),
        ({**NORMALS, "top": "xy"}, False, "both", 0),
        (ALL, False, "low", 0),
        (ALL, True, "both", 1),
        (ALL, True, "low", 0),
        ({**ALL, "seam": "xyz"}, True, "both", 2),
        ({**ALL, "seam": "xyz"}, True, "low", 1),
        ({**ALL, "seam": "xyz"}, False, "both", 1),
        ({**ALL, "seam": "z", "top": "xy"}, True, "both", 1),
        ({}, True, "both", 0),
    ],
)
def test_the_level_is_determined_unless_all_of_a_boundary_is_held(
    places: dict[str, str], breaks: bool, rigid: str, count: int
) -> None:
    assert modes(layers(2, 0.0), places, breaks, rigid) == count


def test_two_parts_have_a_level_each() -> None:
    one = block()
    mesh = TetMesh(
        np.concatenate([one.points, one.points + 5]),
        np.concatenate([one.tets, one.tets + len(one.points)]),
    )
    net, pressures = ControlNet(mesh, 2), ControlNet(mesh, 1)
    held = np.zeros((net.count, 3), bool)
    held[net.of_facets(mesh.boundary)] = True
    found = undetermined(net, pressures, held, np.zeros(len(mesh.tets), bool))
    assert sorted(map(tuple, found)) == sorted(map(tuple, 1.0 - found))
    p = without_mean(np.arange(16.0), found, pressures)
    assert np.abs(bz.Field(pressures, p).integral()) < ROUNDING
    assert np.abs(bz.Field(pressures, p * found[0]).integral()) < ROUNDING


@pytest.mark.parametrize("dense", [800, 0])
@pytest.mark.parametrize("sides", [SIDES, SIDES[:5], SIDES[4:]])
@pytest.mark.parametrize(
    ("cells", "k", "m"), [(1, 2, 1), (1, 3, 2), (1, 3, 1), (2, 2, 1), (2, 3, 2)]
)
def test_undetermined_pressures_are_found_in_groups_of_tets(
    cells: int, k: int, m: int, sides: tuple[str, ...], dense: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Against the rank of the whole matrix of the coupling; no single tet of a cube shows it."""
    monkeypatch.setattr(locked, "DENSE", dense)
    net, pressures = (ControlNet(block(cells=cells), n) for n in (k, m))
    held = np.zeros((net.count, 3), bool)
    for side in sides:
        held[net.of_place(side)] = True
    soft = np.zeros(len(net.mesh.tets), bool)
    modes = undetermined(net, pressures, held, soft)
    work = coupling(net, pressures).toarray()[:, ~held.ravel()]
    open_ones = pressures.count - np.linalg.matrix_rank(work, tol=1e-9) - len(modes)
    if open_ones:
        with pytest.raises(bz.InputError, match="nothing is left to determine the pressure"):
            locked.refuse_undetermined(net, pressures, held, soft, modes)
    else:
        assert locked.refuse_undetermined(net, pressures, held, soft, modes) >= 0
    assert bool(open_ones) == (cells == 1 and len(sides) > 2 and m == k - 1)


def test_a_split_keeps_places_regions_and_volume() -> None:
    mesh = layers()
    chosen = [0, 3, 4]
    fine = split(mesh, chosen)
    assert len(fine.tets) == len(mesh.tets) + 9
    assert fine.volumes.sum() == pytest.approx(mesh.volumes.sum(), rel=ROUNDING)
    for place in mesh.places:
        assert (fine.facets_of(place) == mesh.facets_of(place)).all()
    for number in (0, 1):
        volume = mesh.volumes[mesh.region == number].sum()
        assert fine.volumes[fine.region == number].sum() == pytest.approx(volume, rel=ROUNDING)
    assert (split(mesh, []).tets == mesh.tets).all()


def test_no_tet_is_locked_once_they_are_split() -> None:
    law = bz.LinearElastic(1.0, 0.5)
    body = bz.Body(block(cells=2), 3, law, [bz.Fixed(*SIDES)], incompressible=True)
    net = ControlNet(body.mesh, 2)
    held = np.zeros((net.count, 3), bool)
    held[net.of_facets(body.mesh.boundary)] = True
    assert len(held_tets(net, held)) == 24
    other = unlocked(body)
    assert other.pressure_degree == 2 and len(other.mesh.tets) == 48 + 3 * 24
    assert bz.solve(other).held_tets == 0


def test_the_determinant_of_turns_and_shears() -> None:
    turn = np.array([[np.cos(1), -np.sin(1), 0], [np.sin(1), np.cos(1), 0], [0, 0, 1]]) - np.eye(3)
    shear = np.array([[0, 0.05, 0], [0.05, 0, 0], [0, 0, 0.0]])
    assert abs(change_of_volume(turn)) < ROUNDING
    assert change_of_volume(shear) == pytest.approx(-0.0025, rel=ROUNDING)


@pytest.mark.parametrize("degree", [2, 3, 4])
def test_divergence_and_determinant_as_fields(degree: int) -> None:
    """At points inside tets, from gradients there."""
    mesh = block(cells=2, irregular=0.3)
    law, load = bz.LinearElastic(1.0, 0.5), bz.Traction("top", value=(0.1, 0, 0))
    held = [bz.Fixed("bottom")]
    body = bz.Body(mesh, degree, law, held, [load], incompressible=True)
    solution = bz.solve(body, solver="direct")
    points = np.random.default_rng(1).uniform(0.05, 0.95, (50, 3))
    H = solution.displacement.gradient(points)
    there = np.linalg.det(np.eye(3) + H) - 1
    trace = np.trace(H, axis1=1, axis2=2)
    assert np.abs(solution.divergence.at(points) - trace).max() < CLOSED_FORM
    assert np.abs(solution.determinant.at(points) - there).max() < CLOSED_FORM
    assert solution.determinant.largest()[0] >= np.abs(there).max() * 0.9
    assert abs(solution.volume_change) < CLOSED_FORM
    assert solution.summary()["largest_divergence"] == solution.divergence.largest()[0]
