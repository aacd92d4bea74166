# SPDX-License-Identifier: BSD-3-Clause
"""DICOM slices written byte by byte, in every odd form, by nothing but the standard (PS3.5)."""

from __future__ import annotations

import struct
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

CT, MR = "1.2.840.10008.5.1.4.1.1.2", "1.2.840.10008.5.1.4.1.1.4"
LONG = ("OB", "OW", "SQ", "UN", "UT")
VR = {
    (0x0008, 0x0008): "CS", (0x0008, 0x0016): "UI", (0x0008, 0x0018): "UI", (0x0008, 0x0060): "CS",
    (0x0008, 0x103E): "LO", (0x0010, 0x0010): "PN", (0x0010, 0x0020): "LO", (0x0010, 0x0030): "DA",
    (0x0018, 0x0050): "DS", (0x0018, 0x1120): "DS", (0x0018, 0x1210): "SH", (0x0020, 0x000D): "UI",
    (0x0020, 0x000E): "UI", (0x0020, 0x0011): "IS", (0x0020, 0x0013): "IS", (0x0020, 0x0032): "DS",
    (0x0020, 0x0037): "DS", (0x0020, 0x0052): "UI", (0x0028, 0x0002): "US", (0x0028, 0x0004): "CS",
    (0x0028, 0x0006): "US", (0x0028, 0x0008): "IS", (0x0028, 0x0010): "US", (0x0028, 0x0011): "US",
    (0x0028, 0x0030): "DS", (0x0028, 0x0100): "US", (0x0028, 0x0101): "US", (0x0028, 0x0102): "US",
    (0x0028, 0x0103): "US", (0x0028, 0x1052): "DS", (0x0028, 0x1053): "DS", (0x7FE0, 0x0010): "OW",
}  # fmt: skip


def element(group: int, number: int, vr: str, value: bytes) -> bytes:
    value += (b"\0" if vr in ("UI", "OB", "OW") else b" ") * (len(value) % 2)
    size = struct.pack("<HI", 0, len(value)) if vr in LONG else struct.pack("<H", len(value))
    return struct.pack("<HH", group, number) + vr.encode() + size + value


def encoded(vr: str, value: Any) -> bytes:
    if isinstance(value, bytes):
        return value
    return struct.pack("<H", value) if vr == "US" else str(value).encode()


@dataclass
class Slice:
    """One slice of stored values (rows, columns) at a position in mm (LPS)."""

    stored: Any
    position: Any
    directions: Any = (1, 0, 0, 0, 1, 0)
    spacing: Any = (3.0, 2.0)
    changes: dict[tuple[int, int], Any] = field(default_factory=dict)
    """Tags set to other values; None leaves one out."""

    def tags(self, number: int) -> dict[tuple[int, int], Any]:
        rows, columns = self.stored.shape[:2]
        join = "\\".join
        found = {
            (0x0008, 0x0008): "ORIGINAL\\PRIMARY\\AXIAL", (0x0008, 0x0016): CT,
            (0x0008, 0x0018): f"1.2.3.4.{number + 1}", (0x0008, 0x0060): "CT",
            (0x0008, 0x103E): "head", (0x0010, 0x0010): "Doe^Jane", (0x0010, 0x0020): "4711",
            (0x0010, 0x0030): "19700101", (0x0020, 0x000D): "1.2.3", (0x0020, 0x000E): "1.2.3.4",
            (0x0020, 0x0013): number + 1, (0x0020, 0x0032): join(f"{x:.9g}" for x in self.position),
            (0x0020, 0x0037): join(f"{x:.12g}" for x in self.directions), (0x0020, 0x0052): "1.9",
            (0x0028, 0x0002): 1, (0x0028, 0x0004): "MONOCHROME2", (0x0028, 0x0010): rows,
            (0x0028, 0x0011): columns, (0x0028, 0x0030): join(f"{x:.9g}" for x in self.spacing),
            (0x0028, 0x0100): 16, (0x0028, 0x0101): 16, (0x0028, 0x0102): 15, (0x0028, 0x0103): 0,
            (0x0028, 0x1052): -1024, (0x0028, 0x1053): 1,
            (0x7FE0, 0x0010): self.stored.astype("<u2").tobytes(),
        }  # fmt: skip
        found |= self.changes
        return {tag: value for tag, value in sorted(found.items()) if value is not None}

    def content(self, number: int) -> bytes:
        tags = self.tags(number)
        body = b"".join(element(*t, VR[t], encoded(VR[t], v)) for t, v in tags.items())
        uid = encoded("UI", tags.get((0x0008, 0x0018), "1.2"))
        meta = b"".join([
            element(2, 1, "OB", b"\0\1"),
            element(2, 2, "UI", encoded("UI", tags.get((0x0008, 0x0016), CT))),
            element(2, 3, "UI", uid),
            element(2, 0x10, "UI", b"1.2.840.10008.1.2.1"),
            element(2, 0x12, "UI", b"1.2.3.9"),
        ])  # fmt: skip
        return (
            b"\0" * 128 + b"DICM" + element(2, 0, "UL", struct.pack("<I", len(meta))) + meta + body
        )


def pattern(count: int = 14, rows: int = 20, columns: int = 30) -> Any:
    """Hounsfield units (z, y, x) in which no two places look alike, with air around."""
    z, y, x = np.meshgrid(np.arange(count), np.arange(rows), np.arange(columns), indexing="ij")
    values = 10 * x + 7 * y + 3 * z + 100
    values[:, :2] = -1000
    return values


def stack(
    hounsfield: Any, step: float = 4.0, directions: Any = (1, 0, 0, 0, 1, 0), shear: float = 0.0
) -> list[Slice]:
    """Slices of values (z, y, x); `shear` mm along the columns a slice is a gantry's tilt."""
    turn = np.reshape(directions, (2, 3)).astype(float)
    normal = np.cross(*turn)
    start = np.array([-30.0, 11, 5])
    return [
        Slice(plane + 1024, start + k * (step * normal + shear * turn[1]), directions)
        for k, plane in enumerate(hounsfield)
    ]


def written(folder: Path, slices: list[Slice], shuffled: bool = True) -> Path:
    """A folder with the slices, under names whose order says nothing."""
    folder.mkdir(exist_ok=True)
    names = np.random.default_rng(1).permutation(len(slices)) if shuffled else range(len(slices))
    for number, (name, one) in enumerate(zip(names, slices, strict=True)):
        (folder / f"IM{name:04d}").write_bytes(one.content(number))
    return folder
