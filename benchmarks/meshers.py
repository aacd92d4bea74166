# SPDX-License-Identifier: BSD-3-Clause
"""Tets of one domain by two ways: isosurface stuffing, and a surface net filled by fTetWild.

pytetwild[all] is no dependency of BezSoma: install it beside it, then
./dev python benchmarks/meshers.py. Both ways are told the same sizes; each is run twice.
"""

from __future__ import annotations

import argparse
from time import perf_counter

import numpy as np
from pytetwild import tetrahedralize
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkFiltersCore import vtkSurfaceNets3D

import bezsoma as bz
from bezsoma.imaging import (
    DomainSettings,
    Labels,
    LabelSettings,
    domain,
    face_mesh,
    head_ct,
    sizes_for,
)
from bezsoma.imaging.domain import SURFACES, _inside
from bezsoma.mesh.quality import dihedral_angles, mean_ratios

LOWER_FACE = DomainSettings(above=-8.0, behind=-20.0)
LONGER = 1.0
"""How many times the edges of our tets fTetWild is told, for about as many tets."""


def surface_net(part):
    """The smoothed boundary of the voxels of tissue in the box: points (p, 3), triangles (f, 3)."""
    inside = (part.exact < 0) & _inside(part.frame, part.exact.shape, part.low, part.high)
    image, values = vtkImageData(), np.pad(inside, 1).astype(np.int16)
    image.SetDimensions(values.shape[::-1])
    image.GetPointData().SetScalars(numpy_to_vtk(values.ravel(), deep=True))
    net = vtkSurfaceNets3D()
    net.SetInputData(image)
    net.SetValue(0, 1)
    net.SetOutputMeshTypeToTriangles()
    net.Update()
    found = net.GetOutput()
    index = vtk_to_numpy(found.GetPoints().GetData()).astype(float) - 1
    triangles = vtk_to_numpy(found.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    return np.ascontiguousarray(part.frame.points(index)), triangles.astype(np.int32, order="C")


def named(part, points, tets):
    """The largest piece of tets as a mesh, each facet named by what borders on it."""
    mesh = bz.TetMesh(points, tets)
    piece = mesh.components()
    mesh = bz.TetMesh(points, tets[piece == np.bincount(piece).argmax()])
    middle = mesh.points[mesh.boundary].mean(axis=1)
    voxel = part.frame.spacing.max()
    flat = (middle < part.low + voxel) & ~part.open[0]
    flat |= (middle > part.high - voxel) & ~part.open[1]
    border = part.at(part.border, middle, order=0).astype(int)
    name = np.where(flat.any(axis=1), "cut", np.array(SURFACES)[border])
    for each in np.unique(name):
        mesh = mesh.with_surface(str(each), mesh.boundary[name == each])
    return mesh


def by_ftetwild(part, sizes, ours):
    """A mesh of the domain by the other way, sized like ours."""
    points, triangles = surface_net(part)
    found = tetrahedralize(
        points, triangles, num_threads=1, epsilon=5e-4, bg_vertices=ours.points.copy(),
        bg_tets=ours.tets.astype(np.int32), bg_values=LONGER * sizes.wanted(part, ours.points),
    )  # fmt: skip
    return named(part, *found[:2])


def off(part, mesh, name):
    """Mean distance in voxels of a surface from the faces of the voxels."""
    facets = mesh.surfaces[name]
    at = np.concatenate([mesh.points[facets].mean(axis=1), mesh.points[np.unique(facets)]])
    return np.abs(part.at(part.exact, at)).mean() / part.frame.spacing.mean()


def iterations(mesh, degree):
    """Steps of the solver to 1e-8 for the mandible moved 5 mm forward."""
    shared = np.intersect1d(mesh.vertices_of("mandible"), mesh.vertices_of("skull"))
    body = bz.Body(
        mesh, degree, bz.LinearElastic(E=0.015, nu=0.45),
        [bz.Fixed("skull"), bz.Moved("mandible", translation=(0, -5, 0))],
        joins=[bz.Gap(free="skull", at="mandible", width=5)] if len(shared) else [],
    )  # fmt: skip
    return bz.solve(body, solver="multigrid", threads=1).iterations


def main() -> None:
    """Print a row of the table for each way."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tets", type=int, default=12_000)
    parser.add_argument("--voxel", type=float, default=2.0)
    parser.add_argument("--degree", type=int, default=3)
    options = parser.parse_args()
    head = head_ct((options.voxel,) * 3, noise=0, joint=3, bite=3)
    found = Labels(head.truth, head.volume.frame, LabelSettings(), np.zeros(3, np.int64), ())
    part = domain(found, LOWER_FACE)
    sizes = sizes_for(part, options.tets)
    ours = face_mesh(part, sizes).mesh
    ways = {
        "stuffing": lambda: face_mesh(part, sizes).mesh,
        "SurfaceNets, fTetWild": lambda: by_ftetwild(part, sizes, ours),
    }
    print("way | tets | angles | mean ratio | skin, skull, mandible off | s | steps | same bits")
    for name, make in ways.items():
        start = perf_counter()
        mesh = make()
        seconds = perf_counter() - start
        angles, again = dihedral_angles(mesh), make()
        same = np.array_equal(again.points, mesh.points) and np.array_equal(again.tets, mesh.tets)
        offs = ", ".join(f"{off(part, mesh, n):.2f}" for n in ("skin", "skull", "mandible"))
        print(
            f"{name} | {len(mesh.tets)} | {angles.min():.1f} to {angles.max():.1f} | "
            f"{mean_ratios(mesh).mean():.2f} | {offs} | {seconds:.1f} | "
            f"{iterations(mesh, options.degree)} | {same}", flush=True,
        )  # fmt: skip


if __name__ == "__main__":
    main()
