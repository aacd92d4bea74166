# SPDX-License-Identifier: BSD-3-Clause
"""The numbering of controls: how many, which belong together, in what order, where they lie."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bezsoma import bernstein
from bezsoma.errors import InputError
from bezsoma.mesh.control_net import ControlNet
from bezsoma.mesh.morton import morton_keys, morton_order
from bezsoma.mesh.parts import PARTS, inside, owners
from bezsoma.mesh.solids import block
from bezsoma.mesh.tets import TetMesh
from tolerances import ROUNDING, patch

DEGREES = range(1, 11)


@pytest.fixture(scope="module")
def mesh() -> TetMesh:
    solid = block(size=(2.0, 3.0, 1.0), cells=(2, 3, 2), irregular=0.4, seed=1)
    corner = np.flatnonzero(np.abs(solid.points).max(axis=1) == 0)
    edges = solid.all_edges[np.abs(solid.points[solid.all_edges][:, :, 1:]).max(axis=(1, 2)) == 0]
    return solid.with_edges("line", edges).with_vertices("corner", numbers=corner)


@pytest.mark.parametrize("degree", DEGREES)
def test_count_is_that_of_eulers_entities(mesh: TetMesh, degree: int) -> None:
    net, n = ControlNet(mesh, degree), degree
    entities = len(mesh.points), len(mesh.all_edges), len(mesh.all_faces), len(mesh.tets)
    inner = (1, n - 1, (n - 1) * (n - 2) // 2, (n - 1) * (n - 2) * (n - 3) // 6)
    assert net.sizes == inner
    assert net.count == sum(e * s for e, s in zip(entities, inner, strict=True))
    assert net.of_tet.shape == (len(mesh.tets), bernstein.count(degree, 3))
    assert net.of_tet.dtype == np.int64
    assert np.array_equal(np.unique(net.of_tet), np.arange(net.count))


@pytest.mark.parametrize("degree", [1, 2, 3, 5, 8])
def test_each_entity_is_one_run_in_first_touch_order(mesh: TetMesh, degree: int) -> None:
    """Written out as a walk, control by control, which is what the vectorised one has to be."""
    net = ControlNet(mesh, degree)
    expected = np.full(net.count, -1)
    seen: dict[tuple[int, ...], int] = {}
    following = 0
    for tet in net.morton:
        corners = mesh.tets[tet]
        part, _ = owners(degree, 3)
        for local, vertices in enumerate(PARTS[3]):
            entity = tuple(corners[list(vertices)])
            own = net.of_tet[tet][part == local]
            if entity not in seen:
                seen[entity] = following
                expected[following : following + len(own)] = np.arange(len(own))
                following += len(own)
            assert np.array_equal(own, seen[entity] + np.arange(len(own)))
    assert following == net.count


def test_morton_order_walks_a_grid_cell_by_cell() -> None:
    """On a grid of 2^k points a side, the first eighth of the walk fills the first octant."""
    side = np.arange(8)
    points = np.stack(np.meshgrid(side, side, side, indexing="ij"), axis=-1).reshape(-1, 3) * 1.0
    order = morton_order(points)
    assert np.array_equal(np.sort(order), np.arange(512))
    assert points[order[:64]].max() == 3.0
    assert np.array_equal(points[order[:2]], [[0, 0, 0], [1, 0, 0]])
    by_hand = [
        sum(((int(x) >> b & 1) << 3 * b + a) for a, x in enumerate(p) for b in range(3))
        for p in points
    ]
    assert np.array_equal(np.argsort(morton_keys(points)), np.argsort(by_hand))


def test_morton_keys_interleave_every_bit() -> None:
    """Against strings of binary digits, at the full resolution of 21 bits an axis."""
    last = 2**21 - 1
    steps = np.random.default_rng(0).integers(0, last, (50, 3))
    points = np.concatenate([[[0, 0, 0], [last, last, last]], steps]).astype(float)
    for point, key in zip(points.astype(int), morton_keys(points), strict=True):
        x, y, z = (f"{c:021b}" for c in point)
        assert int("".join(c + b + a for a, b, c in zip(x, y, z, strict=True)), 2) == key


def test_morton_order_of_equal_points_keeps_their_order() -> None:
    assert morton_order(np.ones((4, 3))).tolist() == [0, 1, 2, 3]
    assert morton_order(np.empty((0, 3))).tolist() == []


@pytest.mark.parametrize("degree", DEGREES)
def test_points_are_the_domain_points_of_every_tet(mesh: TetMesh, degree: int) -> None:
    net = ControlNet(mesh, degree)
    bary = bernstein.domain_points(degree, 3)
    expected = np.einsum("mi,tid->tmd", bary, mesh.points[mesh.tets])
    assert np.abs(net.points[net.of_tet] - expected).max() < 3 * ROUNDING


@pytest.mark.parametrize("degree", [1, 2, 3, 4, 7])
def test_neighbours_share_the_controls_of_their_face(mesh: TetMesh, degree: int) -> None:
    net = ControlNet(mesh, degree)
    faces = net.of_facets(mesh.all_faces)
    for local, vertices in enumerate(((1, 2, 3), (0, 2, 3), (0, 1, 3), (0, 1, 2))):
        trace = net.of_tet[:, bernstein.trace(degree, 3, vertices)]
        assert np.array_equal(trace, faces[mesh.faces_of_tet[:, local]])
    edges = net.of_edges(mesh.all_edges)
    for local, pair in enumerate(((0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3))):
        trace = net.of_tet[:, bernstein.trace(degree, 3, pair)]
        assert np.array_equal(trace, edges[mesh.edges_of_tet[:, local]])
    vertices = net.of_vertices(np.arange(len(mesh.points)))
    assert np.array_equal(net.points[vertices], mesh.points)


@pytest.mark.parametrize("degree", [1, 2, 3, 6])
def test_a_place_holds_its_closure(mesh: TetMesh, degree: int) -> None:
    """What lies on the plane of a surface of a block are its controls, and no others are."""
    net = ControlNet(mesh, degree)
    for name, axis, value in (("left", 0, 0.0), ("back", 1, 3.0), ("top", 2, 1.0)):
        on = np.flatnonzero(np.abs(net.points[:, axis] - value) < 1e-12)
        assert np.array_equal(net.of_place(name), on)
    line = np.flatnonzero(np.abs(net.points[:, 1:]).max(axis=1) < 1e-12)
    assert np.array_equal(net.of_place("line"), line)
    corner = np.flatnonzero(np.abs(net.points).max(axis=1) < 1e-12)
    assert np.array_equal(net.of_place("corner"), corner)


@pytest.mark.parametrize("degree", DEGREES)
def test_a_polynomial_is_reproduced(mesh: TetMesh, degree: int) -> None:
    net, direction = ControlNet(mesh, degree), np.array([0.3, -0.5, 0.7])
    controls = net.interpolated(lambda x: (x @ direction) ** degree)
    bary, _ = bernstein.simplex(4, 3)
    points = np.einsum("qi,tid->tqd", bary, mesh.points[mesh.tets])
    found = np.einsum("qm,tm->tq", bernstein.values(degree, bary), controls[net.of_tet])
    expected = (points @ direction) ** degree
    assert np.abs(found - expected).max() < patch(degree) * np.abs(expected).max()


@pytest.mark.parametrize("degree", [1, 2, 3, 5, 9])
def test_a_function_is_interpolated_in_every_domain_point(mesh: TetMesh, degree: int) -> None:
    net = ControlNet(mesh, degree)

    def function(x: np.ndarray) -> np.ndarray:
        return np.stack([np.sin(x[:, 0] + x[:, 1]), np.exp(x[:, 2])], axis=1)

    controls = net.interpolated(function)
    at_points = bernstein.values(degree, bernstein.domain_points(degree, 3))
    found = np.einsum("qm,tmk->tqk", at_points, controls[net.of_tet])
    assert np.abs(found - function(net.points)[net.of_tet]).max() < patch(degree)
    assert np.array_equal(controls, net.interpolated(function(net.points)))


@pytest.mark.parametrize("degree", [1, 2, 3, 4, 6])
def test_a_function_on_a_place_needs_the_place_alone(mesh: TetMesh, degree: int) -> None:
    net = ControlNet(mesh, degree)
    everywhere = net.interpolated(lambda x: np.cos(x))
    for name in ("left", "top", "line", "corner"):
        asked = []

        def function(x: np.ndarray, asked: list[np.ndarray] = asked) -> np.ndarray:
            asked.append(x)
            return np.cos(x)

        numbers, values = net.interpolated_on(name, function)
        assert np.array_equal(numbers, net.of_place(name))
        assert np.abs(values - everywhere[numbers]).max() < patch(degree)
        assert np.array_equal(np.concatenate(asked), net.points[numbers])


@pytest.mark.parametrize("degree", [2, 4])
def test_where_places_meet_the_same_function_gives_the_same_controls(
    mesh: TetMesh, degree: int
) -> None:
    """One support does not see the other: the trace on an edge depends on that edge alone."""
    net = ControlNet(mesh, degree)
    left, on_left = net.interpolated_on("left", lambda x: np.cos(x))
    top, on_top = net.interpolated_on("top", lambda x: np.cos(x) + (x[:, :1] > 1e-9))
    shared, i, j = np.intersect1d(left, top, return_indices=True)
    assert len(shared) == degree * 3 + 1
    assert np.abs(on_left[i] - on_top[j]).max() < ROUNDING * 100


@settings(max_examples=25, deadline=None)
@given(st.integers(1, 10), st.integers(0, 3))
def test_owners_split_a_simplex_into_its_parts(degree: int, dim: int) -> None:
    part, rank = owners(degree, dim)
    for number, vertices in enumerate(PARTS[dim]):
        own = np.flatnonzero(part == number)
        alphas = bernstein.indices(degree, dim)[own]
        assert len(own) == len(inside(degree, len(vertices) - 1))
        assert (alphas[:, list(vertices)] > 0).all()
        assert (alphas[:, list(vertices)].sum(axis=1) == degree).all()
        inner = bernstein.indices(degree, len(vertices) - 1)[inside(degree, len(vertices) - 1)]
        assert np.array_equal(alphas[:, list(vertices)], inner[rank[own]])


def test_the_walk_over_tets_is_near_in_memory() -> None:
    """Neighbours in the walk touch near controls: the median span stays far below the total."""
    net = ControlNet(block(cells=(8, 8, 8)), 2)
    walked = net.of_tet[net.morton]
    spans = walked.max(axis=1) - walked.min(axis=1)
    assert np.median(spans) < net.count / 8
    fresh = np.maximum.accumulate(walked.max(axis=1))
    assert (np.diff(fresh, prepend=-1) <= bernstein.count(2, 3)).all()


@pytest.mark.parametrize("degree", [0, 11, -1, 2.0, True, "3"])
def test_other_degrees_are_refused(mesh: TetMesh, degree: object) -> None:
    with pytest.raises(InputError, match=r"cannot be used; give a whole number 1 to 10"):
        ControlNet(mesh, degree)  # type: ignore[arg-type]


def test_a_numpy_integer_is_a_degree(mesh: TetMesh) -> None:
    assert type(ControlNet(mesh, np.int32(2)).degree) is int  # type: ignore[arg-type]


def test_faults_are_named(mesh: TetMesh) -> None:
    net = ControlNet(mesh, 2)
    with pytest.raises(InputError, match=r"facet \[0, 1, 2\] belongs to no tet"):
        net.of_facets(np.array([[0, 1, 2]]))
    with pytest.raises(InputError, match=r"\(1 of 1 such\); its vertices have to ascend"):
        net.of_edges(mesh.all_edges[:1, ::-1])
    with pytest.raises(InputError, match=r"no place 'lefd'.*did you mean 'left'"):
        net.of_place("lefd")
    with pytest.raises(InputError, match=r"values of shape \(3,\) for .* points"):
        net.interpolated(np.zeros(3))
    with pytest.raises(InputError, match=r"value at .* mm is not finite \(\d+ of \d+ such\)"):
        net.interpolated(lambda x: np.where(x[:, 0] > 0.9, np.nan, 1.0))
    with pytest.raises(InputError, match="is not finite"):
        net.interpolated(lambda x: np.where(x > 0.9, np.inf, 1.0))
