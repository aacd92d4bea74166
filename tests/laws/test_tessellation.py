# SPDX-License-Identifier: BSD-3-Clause
"""Tessellated surfaces: near enough everywhere, without cracks, with exact points and normals."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from bezsoma import bernstein
from bezsoma.errors import InputError
from bezsoma.mesh import ControlNet, Field, TetMesh, ball, block, subdivision
from bezsoma.view.chords import bends, circle, lattice_error, strip_error, triangles_error
from bezsoma.view.cuts import STEPS, cut, nip_corners, strip_corners
from bezsoma.view.tessellation import Tessellation, tessellation

RNG = np.random.default_rng(11)


def uneven(degree: int, size: float = 1.0) -> Field:
    """A block that is bent much on one side and not at all on the other."""
    mesh = block((10.0, 8.0, 6.0), (3, 2, 2), irregular=0.3)

    def bent(x: np.ndarray) -> np.ndarray:
        a, b, c = x.T / 5
        wave = np.sin(a**2) * np.array([0.4, -0.3, 1.0])[:, None] * np.exp(b - 1)
        return size * (wave + np.stack([c * b, a * 0, a * b * c])).T

    return Field.interpolating(ControlNet(mesh, degree), bent)


def rounded(degree: int, cells: int = 3, radius: float = 30.0) -> Field:
    mesh = ball(radius, cells)

    def rounding(points: np.ndarray) -> np.ndarray:
        far = np.linalg.norm(points, axis=1, keepdims=True)
        return np.where(far > 0.8 * radius, points * (radius / np.maximum(far, 1e-9) - 1), 0.0)

    return Field.interpolating(ControlNet(mesh, degree), rounding)


def strays(found: Tessellation) -> np.ndarray:
    """How far (r,) each triangle is from the patch, by dense sampling."""
    inside = bernstein.domain_points(7, 2)
    flat = inside @ found.points[found.triangles]
    bary = inside @ found.bary
    surface = found.surface
    weights = bernstein.values(surface.degree, bary)
    moved = np.einsum("rsm,rmk->rsk", weights, surface.controls[found.facet])
    exact = np.einsum("rsi,rik->rsk", bary, surface.corners[found.facet]) + found.scale * moved
    return np.asarray(np.linalg.norm(flat - exact, axis=2).max(axis=1))


@pytest.mark.parametrize("degree", [1, 2, 3, 5, 10])
def test_every_triangle_is_nearer_than_the_tolerance(degree: int) -> None:
    surface = uneven(degree).on_surface()
    for tolerance in (1.0, 0.1) if degree > 5 else (1.0, 0.1, 0.03):
        found = tessellation(surface, tolerance)
        worst = strays(found)
        assert worst.max() <= tolerance
        if degree == 1:
            assert worst.max() < 1e-14 and len(found.triangles) == len(surface.facets)
        elif tolerance < 1:
            assert worst.max() > tolerance / 12  # not finer than is needed, by much
    assert len({tuple(group.cut.bary.shape) for group in found.groups}) >= min(degree, 3)


def test_a_magnified_displacement_needs_more_triangles() -> None:
    surface = uneven(3).on_surface("top")
    one, five = (tessellation(surface, 0.05, scale) for scale in (1.0, 5.0))
    assert strays(five).max() <= 0.05
    assert len(five.triangles) > 2 * len(one.triangles)
    assert len(tessellation(surface, 0.05, 0.0).triangles) == len(surface.facets)


def test_sides_are_no_longer_than_asked_for() -> None:
    surface = uneven(3).on_surface()
    for tolerance, longest in ((1e3, 0.7), (0.1, 1.0)):
        found = tessellation(surface, tolerance, longest=longest)
        for group in found.groups:
            corners = surface.corners[group.facets]
            for i, j in ((0, 1), (0, 2), (1, 2)):
                side = np.linalg.norm(corners[:, j] - corners[:, i], axis=1)
                on = group.cut.bary[:, 3 - i - j] == 0
                assert side.max() / (on.sum() - 1) <= longest * (1 + 1e-12)
                places = group.cut.bary @ corners
                inner = places[:, group.cut.triangles]
                ends = inner[:, :, [1, 2, 0]] - inner
                assert np.linalg.norm(ends, axis=3).max() < 2 * longest
        assert strays(found).max() <= tolerance
    one = tessellation(uneven(1).on_surface(surface.facets[:1]), 1e3, longest=1e-3)
    assert len(one.triangles) == STEPS[-1] ** 2  # as many as there may be
    with pytest.raises(InputError, match="at most 0 mm"):
        tessellation(surface, longest=0)


@pytest.mark.parametrize("tolerance", [2.0, 0.3, 0.05])
def test_a_closed_surface_has_no_cracks(tolerance: float) -> None:
    for field, scale in ((uneven(4), 1.0), (rounded(3), 1.0), (uneven(3), 3.0)):
        found = tessellation(field.on_surface(), tolerance, scale)
        sides = found.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
        there = {tuple(side) for side in sides.tolist()}
        assert len(there) == len(sides)  # each is passed once in each direction
        assert all((b, a) in there for a, b in there)
        assert len(found.points) - len(sides) // 2 + len(found.triangles) == 2  # Euler
        assert len(np.unique(found.triangles)) == len(found.points)
        a, b, c = (found.points[found.triangles[:, i]] for i in range(3))
        assert np.linalg.norm(np.cross(b - a, c - a), axis=1).min() > 0


def test_surfaces_cut_apart_fit_together() -> None:
    """The points on a shared edge depend on that edge alone, to the last bit."""
    field = uneven(5)
    top, side = (edge_points(tessellation(field.on_surface(n), 0.03)) for n in ("top", "right"))
    whole = edge_points(tessellation(field.on_surface(), 0.03))
    assert len(set(top) & set(side)) == 2 and set(top) | set(side) <= set(whole)
    assert all(top[edge] == side[edge] for edge in set(top) & set(side))
    assert all(part[edge] == whole[edge] for part in (top, side) for edge in part)
    assert max(map(len, top.values())) > 4 > min(map(len, top.values()))


def edge_points(found: Tessellation) -> dict[tuple[int, int], set[tuple[float, ...]]]:
    """The points on every mesh edge of a surface."""
    points: dict[tuple[int, int], set[tuple[float, ...]]] = {}
    for group in found.groups:
        for k, (i, j) in enumerate(((1, 2), (0, 2), (0, 1))):
            on = found.points[group.points[:, group.cut.bary[:, k] == 0]].tolist()
            ends = found.surface.facets[group.facets][:, [i, j]].tolist()
            for edge, row in zip(ends, on, strict=True):
                points.setdefault(tuple(edge), set()).update(map(tuple, row))
    return points


def test_points_lie_on_the_patch_and_normals_are_those_of_its_formula() -> None:
    field = uneven(4)
    found = tessellation(field.on_surface(), 0.05)
    surface = found.surface
    places = np.einsum("rci,rid->rcd", found.bary, surface.corners[found.facet])
    values = field.at(places.reshape(-1, 3), outside="nearest").reshape(places.shape)
    assert np.abs(found.points[found.triangles] - places - values).max() < 1e-11
    gradient = np.eye(3) + field.gradient_bary(
        *held(field, surface.facets[found.facet], found.bary)
    )
    normals = surface.mesh.normals(surface.facets)[found.facet]
    cofactor = np.linalg.det(gradient)[:, None, None] * np.linalg.inv(gradient).swapaxes(1, 2)
    wanted = np.einsum("rij,rj->ri", cofactor, np.repeat(normals, 3, axis=0))  # Nanson
    wanted /= np.linalg.norm(wanted, axis=1, keepdims=True)
    assert np.abs(found.normals.reshape(-1, 3) - wanted).max() < 1e-10
    lengths = tessellation(field.on_surface(), 0.05).values(field.on_surface())
    assert np.abs(lengths - values).max() < 1e-11


def held(field: Field, facets: np.ndarray, bary: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The tets that hold facets (r, 3), each three times, and barycentric points (3 r, 4)."""
    tets = field.mesh.tets_of_facets(facets)
    inside = np.zeros((len(facets), 3, 4))
    local = (field.mesh.tets[tets][:, None] == facets[:, :, None]).argmax(axis=2)
    np.put_along_axis(inside, np.repeat(local[:, None], 3, axis=1), bary, axis=2)
    return np.repeat(tets, 3), inside.reshape(-1, 4)


def test_triangles_look_outwards_inside_the_mesh_too() -> None:
    mesh = block((2.0, 1.0, 1.0), (2, 1, 1))
    region = (mesh.points[mesh.tets].mean(axis=1)[:, 0] > 1).astype(int)
    mesh = TetMesh(mesh.points, mesh.tets, region, ("a", "b"), mesh.surfaces)
    wall = mesh.all_faces[(mesh.points[mesh.all_faces][:, :, 0] == 1).all(axis=1)].astype(np.int64)
    mesh = mesh.with_surface("wall", wall)
    still = Field(net := ControlNet(mesh, 2), np.zeros((net.count, 3)))
    found = tessellation(still.on_surface("wall"))
    lower = mesh.tets_of_facets(wall)
    assert np.allclose(np.abs(found.normals[..., 0]), 1)
    towards = np.sign(1 - mesh.points[mesh.tets[lower]].mean(axis=1)[:, 0])
    assert (np.sign(found.normals[:, 0, 0]) == towards[found.facet]).all()
    outer = tessellation(still.on_surface())
    away = np.einsum("rcd,rcd->rc", outer.normals, outer.points[outer.triangles] - [1, 0.5, 0.5])
    assert (away > 0).all()


def test_a_sphere_of_degree_five_is_round() -> None:
    found = tessellation(rounded(5).on_surface(), 0.02)
    assert np.abs(np.linalg.norm(found.points, axis=1) - 30).max() < 0.01
    middles = found.points[found.triangles].mean(axis=1)
    assert 0 < (30 - np.linalg.norm(middles, axis=1)).max() < 0.03
    radial = found.points[found.triangles] / 30
    assert np.einsum("rcd,rcd->rc", found.normals, radial).min() > np.cos(0.02)


# What the bounds rest on


@pytest.mark.parametrize("degree", [2, 3, 4, 7])
def test_no_bound_is_below_what_sampling_finds(degree: int) -> None:
    controls = RNG.normal(size=(20, bernstein.count(degree, 2), 3))
    bent = bends(controls, degree)
    some = np.arange(20)
    shapes = {
        "whole": (lattice_error(bent), np.eye(3)[None]),
        "any": (triangles_error(bent, any_ := RNG.dirichlet(np.ones(3), (2, 3))), any_),
        "nip": (triangles_error(bent, nip := nip_corners((3, 2), 4, 1)), nip),
    }
    for edge, parts in product(range(3), (1, 4)):
        small = strip_corners(parts, 6, edge, (False, False))
        shapes[f"strip {edge} {parts}"] = (strip_error(bent.of(some), edge, 1 / 6, small), small)
    inside = bernstein.domain_points(9, 2)
    for name, (bound, corners) in shapes.items():
        ends = bernstein.values(degree, corners) @ controls[:, None]
        exact = bernstein.values(degree, inside @ corners) @ controls[:, None]
        error = np.linalg.norm(inside @ ends - exact, axis=3).max(axis=(1, 2))
        assert (error <= bound * (1 + 1e-12)).all(), name
        assert (error > bound / 200).all(), name


def test_a_patch_of_even_curvature_is_bounded_by_its_circle() -> None:
    """Of a quadratic the bound is the error itself, wherever all sides bend the same way."""
    x, y = (bernstein.domain_points(2, 2) @ np.array([[0, 0], [1, 0], [0.4, 0.8]])).T
    controls = (bernstein.interpolation(2, 2) @ (x**2 + y**2))[None, :, None]
    sides = np.array([[1.0, 0.4**2 + 0.8**2, 0.6**2 + 0.8**2]])
    assert lattice_error(bends(controls, 2)) == pytest.approx(2 * circle(sides))
    inside = RNG.dirichlet(np.ones(3), 20000)
    exact = bernstein.values(2, inside) @ controls[0, :, 0]
    ends = controls[0, [0, 3, 5], 0]
    assert (inside @ ends - exact).max() == pytest.approx(2 * circle(sides)[0], rel=1e-3)


@pytest.mark.parametrize("inside", [3, 4, 6, 64])
def test_patterns_fill_the_facet(inside: int) -> None:
    for parts in product((1, 2, 5, 16), repeat=3):
        for nipped in product((False, True), repeat=3):
            near = [(parts[0], parts[1]), (parts[2], parts[0]), (parts[1], parts[2])]
            if any(
                n and (min(p) < 2 or sum(p) <= inside) for n, p in zip(nipped, near, strict=True)
            ):
                continue
            found = cut(parts, inside, nipped)
            areas = np.linalg.det(found.bary[found.triangles])
            assert areas.min() > 1e-9 and areas.sum() == pytest.approx(1)
            assert len(np.unique(found.triangles)) == len(found.bary)
            assert ((found.bary == 0).any(axis=1).sum()) == found.rim == sum(parts)


# Refusals


@pytest.mark.parametrize(
    ("tolerance", "scale"), [(0.0, 1.0), (-1.0, 1.0), (float("nan"), 1.0), (0.1, float("inf"))]
)
def test_tolerances_that_are_none_are_refused(tolerance: float, scale: float) -> None:
    with pytest.raises(InputError, match="has to be positive, and both finite"):
        tessellation(uneven(2).on_surface(), tolerance, scale)


def test_a_tolerance_too_fine_says_what_can_be_had() -> None:
    surface = uneven(3).on_surface()
    with pytest.raises(InputError, match=r"would cut edges in \d+ parts, and 256 is the most") as e:
        tessellation(surface, 1e-7)
    assert STEPS[-1] == 256 and "subdivide the field first" in str(e.value)
    field = uneven(3)
    finer = field.subdivided(subdivision(field.mesh)).on_surface()
    fine, coarse = tessellation(finer, 0.02), tessellation(surface, 0.02)
    assert strays(fine).max() <= 0.02 < 1 < len(coarse.triangles) / len(fine.triangles) * 4


def test_a_field_that_moves_nothing_or_lies_elsewhere_is_refused() -> None:
    mesh = block()
    heat = Field(net := ControlNet(mesh, 2), np.ones(net.count))
    with pytest.raises(InputError, match="does not move points"):
        tessellation(heat.on_surface())
    broken = Field(net, np.full((net.count, 3), np.nan))
    with pytest.raises(InputError, match="NaN or infinite"):
        tessellation(broken.on_surface())
    found = tessellation(uneven(2).on_surface("top"))
    with pytest.raises(InputError, match="other facets"):
        found.values(uneven(2).on_surface("bottom"))
