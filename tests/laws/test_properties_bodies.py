# SPDX-License-Identifier: BSD-3-Clause
"""Laws of meshes, fields and bodies that hold for any small mesh, order, frame and unit."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bezsoma import bernstein
from bezsoma.arrays import Floats
from bezsoma.mechanics import Body, LinearElastic, Prescribed
from bezsoma.mesh import ControlNet, TetMesh, read_mesh, write_mesh
from bezsoma.mesh.field import Field
from bezsoma.mesh.files import WRITTEN
from bezsoma.solvers import solve
from small_meshes import frames, inside, meshes, renumbered, seeds
from tolerances import INVARIANCE, ROUNDING

Frame = tuple[Floats, Floats, float]


def there(frame: Frame, points: Floats) -> Floats:
    """Points in another frame and unit."""
    turn, shift, length = frame
    return np.asarray(length * points @ turn.T + shift)


def moved(mesh: TetMesh, frame: Frame) -> TetMesh:
    """A mesh in another frame and unit."""
    return TetMesh(there(frame, mesh.points), mesh.tets, mesh.region, mesh.regions, mesh.surfaces)


def arbitrary(mesh: TetMesh, degree: int, seed: int) -> Field:
    """A field of three components drawn at random."""
    net = ControlNet(mesh, degree)
    return Field(net, np.random.default_rng(seed).normal(size=(net.count, 3)))


# ------------------------------------------------------------------ meshes


@given(meshes(), seeds)
def test_the_order_of_vertices_and_tets_is_no_part_of_a_mesh(mesh: TetMesh, seed: int) -> None:
    other, new = renumbered(mesh, seed)
    assert sorted(map(sorted, new[mesh.tets])) == sorted(map(sorted, other.tets))
    assert sorted(other.volumes) == pytest.approx(sorted(mesh.volumes), rel=ROUNDING * 10)
    assert len(other.all_edges) == len(mesh.all_edges)
    assert sorted(map(sorted, new[mesh.boundary])) == sorted(map(sorted, other.boundary))
    for name in mesh.surfaces:
        area = mesh.areas(mesh.facets_of(name)).sum()
        assert other.areas(other.facets_of(name)).sum() == pytest.approx(area, rel=1e-12)
    for degree in (1, 3, 5):
        assert ControlNet(other, degree).count == ControlNet(mesh, degree).count


@given(meshes(), frames)
def test_volumes_areas_and_gradients_turn_with_the_frame(mesh: TetMesh, frame: Frame) -> None:
    turn, _, length = frame
    other = moved(mesh, frame)
    far = 1e-12 * (1 + np.abs(other.points).max() / length)
    assert np.allclose(other.volumes, length**3 * mesh.volumes, rtol=1e3 * far, atol=0)
    gradients = mesh.gradients @ turn.T / length
    assert np.abs(other.gradients - gradients).max() < 1e3 * far * np.abs(gradients).max()
    areas = mesh.areas(mesh.boundary)
    assert np.allclose(other.areas(mesh.boundary), length**2 * areas, rtol=1e3 * far)


@given(meshes(), st.integers(1, 10))
def test_euler_counts_the_controls(mesh: TetMesh, degree: int) -> None:
    """As many as the polynomials of each vertex, edge, face and tet have of their own."""
    counts = (len(mesh.points), len(mesh.all_edges), len(mesh.all_faces), len(mesh.tets))
    own = (1, degree - 1, (degree - 1) * (degree - 2) // 2)
    own += ((degree - 1) * (degree - 2) * (degree - 3) // 6,)
    net = ControlNet(mesh, degree)
    assert net.count == sum(map(int.__mul__, counts, own))
    assert np.array_equal(np.unique(net.of_tet), np.arange(net.count))
    assert counts[0] - counts[1] + counts[2] - counts[3] == 1  # a body without holes


@given(meshes(), st.sampled_from(WRITTEN))
def test_a_mesh_comes_back_from_its_file(mesh: TetMesh, suffix: str) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"mesh{suffix}"
        write_mesh(path, mesh)
        read = read_mesh(path)
    assert np.array_equal(read.points, mesh.points)
    assert sorted(read.tets.tolist()) == sorted(mesh.tets.tolist())
    if not suffix.startswith(".mesh"):  # Medit has numbers for names
        assert set(read.surfaces) == set(mesh.surfaces)
        for name, facets in mesh.surfaces.items():
            assert sorted(read.surfaces[name].tolist()) == sorted(facets.tolist())


# ------------------------------------------------------------------ fields


@given(meshes(), st.integers(1, 5), seeds)
def test_elevation_and_subdivision_can_change_places(mesh: TetMesh, degree: int, seed: int) -> None:
    field = arbitrary(mesh, degree, seed)
    finer = field.subdivided()
    first, second = field.elevated(degree + 2).subdivided(), finer.elevated(degree + 2)
    assert np.array_equal(first.mesh.points, second.mesh.points)
    largest = np.abs(field.controls).max()
    assert np.abs(first.controls - second.controls).max() < ROUNDING * 10 * largest
    asked = inside(mesh, 20, seed)
    assert np.abs(finer.at(asked) - field.at(asked)).max() < 1e-11 * largest
    assert np.allclose(finer.integral(), field.integral(), atol=1e-12 * largest)
    (low, high), (below, above) = finer.bounds(), field.bounds()
    assert (below <= low + 1e-12).all() and (high <= above + 1e-12).all()


@given(meshes(), frames, st.integers(1, 5), seeds)
def test_a_field_belongs_to_the_body_and_not_to_its_frame(
    mesh: TetMesh, frame: Frame, degree: int, seed: int
) -> None:
    field = arbitrary(mesh, degree, seed)
    net = ControlNet(moved(mesh, frame), degree)  # in an order of its own
    controls = np.empty_like(field.controls)
    controls[net.of_tet] = field.of_tet
    other = Field(net, controls)
    asked, (turn, _, length) = inside(mesh, 15, seed), frame
    far = 1e-12 * (1 + np.abs(other.mesh.points).max() / length)
    largest = np.abs(field.controls).max()
    values = other.at(there(frame, asked))
    assert np.abs(values - field.at(asked)).max() < 1e3 * far * degree * largest
    gradients = field.gradient(asked) @ turn.T / length
    found = other.gradient(there(frame, asked))
    assert np.abs(found - gradients).max() < 1e4 * far * degree**2 * np.abs(gradients).max()


@given(meshes(), st.integers(1, 4), seeds)
def test_the_trace_on_the_boundary_is_the_field_there(
    mesh: TetMesh, degree: int, seed: int
) -> None:
    field = arbitrary(mesh, degree, seed)
    controls = field.net.of_facets(mesh.boundary)
    on_it = np.isin(np.arange(field.net.count), controls)
    other = Field(field.net, np.where(on_it[:, None], field.controls, 0.0))
    corners = mesh.points[mesh.boundary]
    bary = np.random.default_rng(seed).dirichlet([1.0] * 3, len(corners))
    asked = np.einsum("fi,fik->fk", bary, corners)
    largest = np.abs(field.controls).max()
    close = bernstein.count(degree, 3) * 1e-11 * largest
    assert (
        np.abs(other.at(asked, outside="nearest") - field.at(asked, outside="nearest")).max()
        < close
    )


# ------------------------------------------------------------------ bodies


def held(mesh: TetMesh, matrix: Any, degree: int, unit: float = 1.0) -> Body:
    """A body whose boundary follows an affine motion, with a bulge in its interior's way."""
    whole = mesh.with_surface("hull", lambda x: np.ones(len(x), dtype=bool))

    def motion(x: Floats) -> Floats:
        return np.asarray(x @ np.asarray(matrix).T)

    stiff = {name: LinearElastic(unit * (1 + i), 0.3) for i, name in enumerate(mesh.regions)}
    return Body(whole, degree, stiff, [Prescribed("hull", value=motion)])


numbers = st.integers(-4, 4).map(lambda n: n / 64)
matrices = st.tuples(*[st.tuples(*[numbers] * 3)] * 3).map(np.array)


@settings(max_examples=25)
@given(meshes(), matrices, matrices, st.integers(1, 3), seeds)
def test_solutions_add_up_and_do_not_mind_order_frame_or_unit(
    mesh: TetMesh, one: Floats, two: Floats, degree: int, seed: int
) -> None:
    """Of u, v: u + v solves for both; renumbered it is the same; ten times as stiff too."""
    asked = inside(mesh, 10, seed)
    u, v, both = (
        solve(held(mesh, m, degree)).displacement.at(asked) for m in (one, two, one + two)
    )
    size = np.abs(one).max() + np.abs(two).max() + 1e-300
    assert np.abs(u + v - both).max() <= INVARIANCE * size
    again = solve(held(renumbered(mesh, seed)[0], one, degree, unit=10.0))
    assert np.abs(again.displacement.at(asked) - u).max() <= INVARIANCE * size


@settings(max_examples=25)
@given(meshes(), frames, matrices, st.integers(1, 3), seeds)
def test_solutions_turn_with_the_frame(
    mesh: TetMesh, frame: Frame, matrix: Floats, degree: int, seed: int
) -> None:
    turn, shift, length = frame
    asked = inside(mesh, 10, seed)
    here = solve(held(mesh, matrix, degree)).displacement.at(asked)

    def motion(x: Floats) -> Floats:
        return np.asarray((x - shift) @ turn @ matrix.T @ turn.T)

    whole = moved(mesh, frame).with_surface("hull", lambda x: np.ones(len(x), dtype=bool))
    stiff = {name: LinearElastic(1.0 + i, 0.3) for i, name in enumerate(mesh.regions)}
    other = solve(Body(whole, degree, stiff, [Prescribed("hull", value=motion)]))
    found = other.displacement.at(there(frame, asked)) @ turn / length
    far = 1 + np.abs(whole.points).max() / length
    assert np.abs(found - here).max() <= INVARIANCE * far * (np.abs(matrix).max() + 1e-300)
