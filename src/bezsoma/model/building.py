# SPDX-License-Identifier: BSD-3-Clause
"""The way from a CT to a model in three stages, each kept: labels, mesh, case.

A stage reads what the one before it wrote, never what is in memory, so a run that goes on from
files gives the same bits as one that was never stopped.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from bezsoma.errors import InputError
from bezsoma.imaging.domain import domain
from bezsoma.imaging.face_points import face_points
from bezsoma.imaging.labelling import Labels, labels
from bezsoma.imaging.meaning import AIR, NAMES
from bezsoma.imaging.nrrd import write_segmentation
from bezsoma.imaging.plates import label_plates, legend
from bezsoma.imaging.reading import read_segmentation, read_volume, readable
from bezsoma.imaging.slicer import read_landmarks, write_landmarks
from bezsoma.imaging.tetrahedra import FaceMesh, face_mesh, sizes_for
from bezsoma.mesh import TetMesh, read_mesh, write_mesh
from bezsoma.mesh.nouns import path_given
from bezsoma.model.case_text import case_text
from bezsoma.model.folder import ModelFolder, hashed, key_of, source_of
from bezsoma.model.readme import readme
from bezsoma.model.settings import ModelSettings, written
from bezsoma.view.named import mesh_picture
from bezsoma.view.plates import plates_picture

Progress = Callable[[str, float | None, str], None]
"""Called with a stage, how much of it is done (0 to 1, None where unknown) and a note."""
LABELS, MESH, LANDMARKS, CASE = "labels.seg.nrrd", "mesh.npz", "landmarks.mrk.json", "case.toml"
SHARPEST, OFF, FAR = 8.0, 0.5, 1.25
"""Degrees, voxels, and times the tets asked for, beyond which a mesh is warned of."""
FILES: Mapping[str, tuple[str, ...]] = {
    "labels": (LABELS, "labels.png"),
    "mesh": (MESH, LANDMARKS),
    "case": (CASE, "mesh.png", "model.toml", "README.txt"),
}
"""What each stage leaves."""


@dataclass(frozen=True)
class Model:
    """A finished model folder."""

    folder: Path
    notes: tuple[str, ...]
    """What a person should know and look at."""
    report: Mapping[str, Any]
    """Sizes and quality of the mesh (`face_mesh`)."""
    kept: tuple[str, ...]
    """Stages that an earlier run had done."""

    @property
    def case(self) -> Path:
        """The case that `bezsoma run` takes."""
        return self.folder / CASE

    @property
    def mesh(self) -> TetMesh:
        """The mesh with its surfaces, mm, LPS."""
        return read_mesh(self.folder / MESH)

    @property
    def labels(self) -> Labels:
        """The labels of the head."""
        return labels_in(self.folder)


def silent(stage: str, fraction: float | None, note: str) -> None:
    """The progress of those who do not watch."""


def run_model(
    ct: Path | str,
    folder: Path | str,
    settings: ModelSettings | None = None,
    *,
    segmentation: Path | str | None = None,
    overwrite: bool = False,
    progress: Progress = silent,
) -> Model:
    """Make the model of a CT (a file or a DICOM folder) in a folder, stage by stage.

    Run again after a stop, it goes on with the first stage that is not done; each stage appears
    whole or not at all, and one run at a time works in a folder. The same CT, settings and version
    give the same bits. A `segmentation` with masks named bone, mandible or skin takes the place of
    what the image would give.
    """
    settings = ModelSettings() if settings is None else settings
    ct = path_given(ct, "run_model(ct, folder)")
    given = None if segmentation is None else Path(segmentation)
    folder = path_given(folder, "run_model(ct, folder)")
    if ct.is_dir() and folder.resolve().is_relative_to(ct.resolve()):
        raise InputError(
            f"{str(folder)!r} lies in the folder of the CT, which is read whole and stays as it "
            "is; choose another folder with -o"
        )
    progress("look", None, f"at {ct.name} and the folder")
    for picture in (ct,) if given is None else (ct, given):
        readable(picture)
    source = source_of(ct)
    with ModelFolder.at(folder, source, overwrite=overwrite) as place:
        return _made(ct, given, place, settings, source, progress)


def _made(
    ct: Path,
    given: Path | None,
    place: ModelFolder,
    settings: ModelSettings,
    source: str,
    progress: Progress,
) -> Model:
    """The model, stage by stage, in a folder that no other run uses."""
    stated = settings.stated()
    drawn = None if given is None else source_of(given)
    told = settings.series, settings.interpolate, settings.hounsfield
    first = key_of(source, stated["labels"], told, drawn)
    second = key_of(first, stated["domain"], stated["sizes"], settings.tets)
    third = key_of(second, stated["model"])
    stages: tuple[tuple[str, str, Callable[[Path], dict[str, Any]]], ...] = (
        ("labels", first, lambda at: _labels(at, ct, given, settings, progress)),
        ("mesh", second, lambda at: _mesh(at, place.place, settings, progress)),
        ("case", third, lambda at: _case(at, place, settings, progress)),
    )
    kept = []
    for number, (stage, key, write) in enumerate(stages):
        if place.done(stage, FILES[stage], key):
            kept.append(stage)
            progress(stage, 1.0, "kept from an earlier run")
        else:
            place.fill(stage, key, write, [later for later, _, _ in stages[number + 1 :]])
    notes = (*place.said("labels")["notes"], *place.said("mesh")["notes"])
    return Model(place.place, notes, place.said("mesh")["report"], tuple(kept))


def labels_in(folder: Path) -> Labels:
    """The labels that a model folder holds."""
    given = read_segmentation(folder / LABELS)
    numbers = {name: number for number, name in NAMES.items()}
    values = np.full(next(iter(given.masks.values())).shape, AIR, np.uint8)
    for name, mask in given.masks.items():
        values[mask] = numbers[name]
    return Labels(values, given.frame, ModelSettings().labels, np.zeros(3, np.int64), ())


def _labels(
    at: Path, ct: Path, given: Path | None, settings: ModelSettings, progress: Progress
) -> dict[str, Any]:
    progress("labels", None, f"reading {ct.name}")
    volume = read_volume(
        ct,
        series=settings.series,
        interpolate=settings.interpolate,
        hounsfield=settings.hounsfield,
    )
    masks = None if given is None else read_segmentation(given)
    progress("labels", None, "finding skin, bone and mandible")
    found = labels(volume, settings.labels, masks)
    write_segmentation(at / LABELS, found.values, found.frame)
    progress("labels", None, "drawing the sheet to check them by")
    plates = label_plates(volume, found)
    look = [note for note in found.notes if note.startswith("LOOK")]
    plates_picture(at / "labels.png", plates, legend(found), title="Labels", notes=look)
    return {"notes": list(found.notes), "cm3": found.volumes()}


def _mesh(at: Path, folder: Path, settings: ModelSettings, progress: Progress) -> dict[str, Any]:
    progress("mesh", None, "cutting the domain from the head")
    found = labels_in(folder)
    part = domain(found, settings.domain)
    progress("mesh", None, "filling it with tets")
    sizes = settings.sizes
    if settings.tets is not None:
        sizes = sizes_for(part, settings.tets, sizes)
    made: FaceMesh = face_mesh(part, sizes)
    for name in ("skin", "skull", "mandible"):
        if name not in made.mesh.surfaces:
            raise InputError(
                f"the mesh has no surface {name!r}, only {list(made.mesh.surfaces)}: too little of "
                "it lies in the domain for cells of this size; move its planes, or take more tets"
            )
    write_mesh(at / MESH, made.mesh)
    write_landmarks(at / LANDMARKS, face_points(found))
    notes = [*part.notes, *_pierced(made.mesh), *_poor(made.report, settings.tets)]
    return {"notes": notes, "report": dict(made.report), "sizes": sizes.stated()}


def _pierced(mesh: TetMesh) -> list[str]:
    """A warning where bone reaches the skin, which tissue covers in the domain everywhere."""
    bone = np.union1d(mesh.vertices_of("skull"), mesh.vertices_of("mandible"))
    count = len(np.intersect1d(mesh.vertices_of("skin"), bone))
    if count == 0:
        return []
    return [
        f"LOOK: bone pierces the skin at {count} vertices, since the tissue between is thinner "
        "than the cells; take more tets, or a smaller domain"
    ]


def _poor(report: Mapping[str, Any], wanted: int | None) -> list[str]:
    """Warnings of a mesh that is less than a model promises: its angles, surfaces, size."""
    notes = []
    if report["least_dihedral"] < SHARPEST:
        notes.append(
            f"LOOK: a dihedral angle of {report['least_dihedral']:.1f} degrees, below "
            f"{SHARPEST:g}, slows the solver and spoils stress there; take more tets, or move the "
            "domain's planes"
        )
    for name, off in report["off_voxels"].items():
        if off > OFF:
            notes.append(
                f"LOOK: the surface {name} lies {off:.2f} voxels from that of the labels in the "
                f"mean, more than {OFF:g}: cells are too large for its form; take more tets"
            )
    if wanted is not None and not 1 / FAR <= report["tets"] / wanted <= FAR:
        notes.append(
            f"LOOK: {report['tets']} tets were made where {wanted} were asked for: no sizes were "
            "found that give as many; ask for another number, or set [sizes] and tets = nan"
        )
    return notes


def _case(
    at: Path, place: ModelFolder, settings: ModelSettings, progress: Progress
) -> dict[str, Any]:
    progress("case", None, "writing the case, drawing the mesh")
    mesh = read_mesh(place.place / MESH)
    points = read_landmarks(place.place / LANDMARKS)
    (at / CASE).write_text(case_text(mesh, points, settings), encoding="utf-8")
    mesh_picture(at / "mesh.png", mesh, title=f"{len(mesh.tets)} tets and their surfaces")
    (at / "model.toml").write_text(written(settings), encoding="utf-8")
    text = readme(place.said("labels"), place.said("mesh"))
    (at / "README.txt").write_text(text, encoding="utf-8")
    return {"mesh": hashed([place.place / MESH])}
