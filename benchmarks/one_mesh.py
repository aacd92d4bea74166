# SPDX-License-Identifier: BSD-3-Clause
"""One mesh of a domain by one of two ways, how good it is, and what it cost (`meshers.py` asks)."""

from __future__ import annotations

import hashlib
from contextlib import chdir
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import Any

import numpy as np
from isolated import forget_peak, peak, serve

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
from bezsoma.model.building import labels_in

LOWER_FACE = DomainSettings(above=-8.0, behind=-20.0)
APART = 4.0
"""mm between the points at which fTetWild is told how long edges shall be."""


def part_of(request: dict[str, Any]) -> Any:
    """The domain: of the labels of a model folder, or of the lower face of the phantom's truth."""
    if request["model"]:
        return domain(labels_in(Path(request["model"])))
    head = head_ct((request["voxel"],) * 3, noise=0, joint=3, bite=3)
    found = Labels(head.truth, head.volume.frame, LabelSettings(), np.zeros(3, np.int64), ())
    return domain(found, LOWER_FACE)


def surface_net(part: Any) -> tuple[Any, Any]:
    """The smoothed boundary of the voxels of tissue in the box: points (p, 3), triangles (f, 3)."""
    from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
    from vtkmodules.vtkCommonDataModel import vtkImageData
    from vtkmodules.vtkFiltersCore import vtkSurfaceNets3D

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


def named(part: Any, points: Any, tets: Any) -> bz.TetMesh:
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


def by_ftetwild(part: Any, sizes: Any, longer: float) -> bz.TetMesh:
    """A mesh of the domain by the other way, told the sizes of ours times `longer`."""
    from pytetwild import tetrahedralize

    points, triangles = surface_net(part)
    extent = np.ptp(points, axis=0) + 4 * APART
    cells = np.ceil(extent / APART).astype(int)
    around = bz.block(size=tuple(extent.tolist()), cells=tuple(cells.tolist()))
    at = around.points + points.min(axis=0) - 2 * APART
    with TemporaryDirectory() as folder, chdir(folder):  # it leaves a file where it is
        found = tetrahedralize(
            points, triangles, num_threads=1, bg_vertices=np.ascontiguousarray(at),
            bg_tets=around.tets.astype(np.int32), bg_values=longer * sizes.wanted(part, at),
        )  # fmt: skip
    return named(part, *found[:2])


def off(part: Any, mesh: bz.TetMesh, name: str) -> float:
    """Mean distance in voxels of a surface from the faces of the voxels."""
    facets = mesh.surfaces[name]
    at = np.concatenate([mesh.points[facets].mean(axis=1), mesh.points[np.unique(facets)]])
    return float(np.abs(part.at(part.exact, at)).mean() / part.frame.spacing.mean())


def iterations(mesh: bz.TetMesh, degree: int) -> int:
    """Steps of the solver to 1e-8 for the mandible moved 5 mm forward."""
    shared = np.intersect1d(mesh.vertices_of("mandible"), mesh.vertices_of("skull"))
    body = bz.Body(
        mesh, degree, bz.LinearElastic(E=0.015, nu=0.45),
        [bz.Fixed("skull"), bz.Moved("mandible", translation=(0, -5, 0))],
        joins=[bz.Gap(free="skull", at="mandible", width=5)] if len(shared) else [],
    )  # fmt: skip
    return bz.solve(body, solver="multigrid", threads=1).iterations


def made(request: dict[str, Any]) -> dict[str, Any]:
    """What `meshers.py` puts into a row."""
    part = part_of(request)
    start = perf_counter()
    sizes = sizes_for(part, request["tets"])
    fitted = perf_counter() - start
    forget_peak()
    start = perf_counter()
    if request["way"] == "stuffing":
        mesh = face_mesh(part, sizes).mesh
    else:
        mesh = by_ftetwild(part, sizes, request["longer"])
    seconds = perf_counter() - start
    memory, angles = peak(), dihedral_angles(mesh)
    held = np.zeros(len(mesh.points), bool)
    for name in ("skull", "mandible"):
        held[mesh.vertices_of(name)] = True
    same = hashlib.sha256(mesh.points.tobytes() + mesh.tets.tobytes()).hexdigest()
    return {
        "tets": len(mesh.tets), "least": float(angles.min()), "largest": float(angles.max()),
        "ratio": float(mean_ratios(mesh).mean()), "held": int(held[mesh.tets].all(axis=1).sum()),
        "off": [off(part, mesh, name) for name in ("skin", "skull", "mandible")],
        "fitted": fitted, "seconds": seconds, "memory": memory, "same": same,
        "steps": iterations(mesh, request["degree"]),
    }  # fmt: skip


if __name__ == "__main__":
    serve(made)
