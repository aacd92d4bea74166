# SPDX-License-Identifier: BSD-3-Clause
"""From pictures of a head to labels; and phantoms, which need no picture."""

from __future__ import annotations

from bezsoma.imaging.around import head_around
from bezsoma.imaging.domain import Domain, DomainSettings, domain
from bezsoma.imaging.face_points import face_points
from bezsoma.imaging.head_ct import HeadCt, head_ct
from bezsoma.imaging.labelling import Labels, labels
from bezsoma.imaging.nrrd import write_segmentation, write_volume
from bezsoma.imaging.phantom import head_phantom, landmarks
from bezsoma.imaging.plates import label_plates, legend
from bezsoma.imaging.reading import Segmentation, dicom_series, read_segmentation, read_volume
from bezsoma.imaging.settings import LabelSettings
from bezsoma.imaging.slicer import read_landmarks, write_landmarks, write_surface
from bezsoma.imaging.tetrahedra import FaceMesh, Sizes, face_mesh, sizes_for
from bezsoma.imaging.volume import Frame, Volume

__all__ = [
    "Domain",
    "DomainSettings",
    "FaceMesh",
    "Frame",
    "HeadCt",
    "LabelSettings",
    "Labels",
    "Segmentation",
    "Sizes",
    "Volume",
    "dicom_series",
    "domain",
    "face_mesh",
    "face_points",
    "head_around",
    "head_ct",
    "head_phantom",
    "label_plates",
    "labels",
    "landmarks",
    "legend",
    "read_landmarks",
    "read_segmentation",
    "read_volume",
    "sizes_for",
    "write_landmarks",
    "write_segmentation",
    "write_surface",
    "write_volume",
]
