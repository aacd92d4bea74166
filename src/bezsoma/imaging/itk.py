# SPDX-License-Identifier: BSD-3-Clause
"""Image files by SimpleITK, in a process of its own. The only place that imports it.

A file can crash a library, or make it ask for more memory than there is. So this file is not
imported but run, by `child`: one request a line comes in as JSON, one answer a line goes out, and
values go through a file. Nothing that names a patient is answered: two identities are compared by
a hash with a salt that is thrown away.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import resource
import sys
from collections.abc import Callable
from typing import Any

import numpy as np
import SimpleITK as sitk  # noqa: N813

TAGS = {
    "modality": "0008|0060",
    "kind": "0008|0008",
    "series": "0020|000e",
    "number": "0020|0011",
    "about": "0008|103e",
    "position": "0020|0032",
    "directions": "0020|0037",
    "spacing": "0028|0030",
    "bits": "0028|0100",
    "samples": "0028|0002",
    "frames": "0028|0008",
    "slope": "0028|1053",
    "intercept": "0028|1052",
    "tilt": "0018|1120",
    "rows": "0028|0010",
    "columns": "0028|0011",
    "place": "0018|5100",
    "kernel": "0018|1210",
    "thick": "0018|0050",
}
CT = b"1.2.840.10008.5.1.4.1.1.2"
"""What a file that holds a slice of a CT says of its kind; others of CT go on behind it."""
IDENTITY = ("0010|0020", "0010|0010", "0010|0030")
NAMES = (*IDENTITY, "0010|1000", "0010|1001", "0010|1005", "0010|1060")
"""Words of a patient: also other numbers and names, that at birth, the mother's."""
TOLD = ("about", "kernel", "number", "thick")
"""Words of a series that may be shown, unless they hold one of a patient."""
SALT = os.urandom(16)


def header(path: str) -> dict[str, Any]:
    """The tags of one DICOM file that geometry and calibration need."""
    reader = sitk.ImageFileReader()
    reader.SetImageIO("GDCMImageIO")
    reader.SetFileName(path)
    reader.ReadImageInformation()

    def tag(key: str) -> str:
        return reader.GetMetaData(key).strip() if reader.HasMetaDataKey(key) else ""

    person = "\0".join(map(tag, IDENTITY)).encode("utf-8", "replace")
    found: dict[str, Any] = {name: tag(key) for name, key in TAGS.items()}
    names = " ".join(map(tag, NAMES))
    found |= {name: "" for name in TOLD if is_personal(found[name], names)}
    return found | {"person": hashlib.sha256(SALT + person).hexdigest()[:16]}


def is_personal(text: str, names: str) -> bool:
    """Whether a word of a patient's names stands in a text: one of three letters anywhere."""
    words, text = re.findall(r"[^\W_]+", names.casefold()), text.casefold()
    apart = re.findall(r"[^\W_]+", text)
    return any(word in (text if len(word) >= 3 else apart) for word in words)


def headers(request: dict[str, Any]) -> dict[str, Any]:
    """For every path its tags, or null for a file that is no DICOM image; and damaged slices."""
    found: list[dict[str, Any] | None] = []
    damaged = []
    for path in request["paths"]:
        try:
            found.append(header(path))
        except RuntimeError:
            found.append(None)
            if is_damaged(path):
                damaged.append(path)
    return {"headers": found, "damaged": damaged}


def is_damaged(path: str) -> bool:
    """Whether a file that does not read as an image says at its head that it is one of a CT.

    One that begins as DICOM and ends before it says what it holds counts too. So does one that is
    empty or begins with zeros alone, where its name does not end as that of another kind of file.
    """
    with open(path, "rb") as file:
        head = file.read(4096)
    if not head.strip(b"\0"):
        return os.path.splitext(path)[1].lower() in ("", ".dcm", ".ima")
    if head[128:132] != b"DICM":
        return False
    told = re.search(rb"\x02\x00\x02\x00UI(..)([0-9.]+)", head, re.DOTALL)
    if told is None or len(told[2]) < int.from_bytes(told[1], "little") - 1:
        return len(head) < 4096
    return told[2] == CT or told[2].startswith(CT + b".")


def slices(request: dict[str, Any]) -> dict[str, Any]:
    """The values of many DICOM files of one size, each (rows, columns), in the order given."""
    stack = None
    for number, path in enumerate(request["paths"]):
        image = sitk.ReadImage(path, imageIO="GDCMImageIO")
        if image.GetNumberOfComponentsPerPixel() != 1:
            raise RuntimeError("a slice in colour")
        values = np.squeeze(sitk.GetArrayViewFromImage(image))
        if stack is None:
            stack = np.empty((len(request["paths"]), *values.shape), np.float32)
        if values.shape != stack.shape[1:]:
            raise RuntimeError("slices of different size")
        stack[number] = values
    assert stack is not None
    return _saved(stack, request["out"])


def image(request: dict[str, Any]) -> dict[str, Any]:
    """One file of another format: values, frame, and the words of its header that are needed."""
    reader = sitk.ImageFileReader()
    reader.SetImageIO(request["io"])
    reader.SetFileName(request["path"])
    reader.ReadImageInformation()
    size, dimension = reader.GetSize(), reader.GetDimension()
    about = {
        "dimension": dimension,
        "size": list(size),
        "components": reader.GetNumberOfComponents(),
        "type": sitk.GetPixelIDValueAsString(reader.GetPixelID()),
        "spacing": list(reader.GetSpacing()),
        "origin": list(reader.GetOrigin()),
        "axes": list(reader.GetDirection()),
        "words": {
            key: reader.GetMetaData(key)
            for key in reader.GetMetaDataKeys()
            if key.startswith(("Segment", "NRRD_space")) or key in ("qform_code", "sform_code")
        },
    }
    if dimension != 3 or int(np.prod(size, dtype=object)) > request["most"]:
        return about
    if about["components"] != 1 and not request["layers"]:
        return about
    picture = reader.Execute()  # named, since a view does not keep it alive
    return about | _saved(sitk.GetArrayViewFromImage(picture), request["out"])


def _saved(values: Any, out: str) -> dict[str, Any]:
    with open(out, "wb") as file:
        np.save(file, values)
    return {"saved": True}


WORK: dict[str, Callable[[dict[str, Any]], dict[str, Any]]] = {
    "headers": headers,
    "slices": slices,
    "image": image,
}


def main() -> None:
    """Answer requests until there are none; the first argument is the most memory in bytes."""
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)  # whatever a library prints stays out of the answers
    for limit, most in ((resource.RLIMIT_AS, int(sys.argv[1])), (resource.RLIMIT_CORE, 0)):
        try:
            resource.setrlimit(limit, (most, most))
        except (ValueError, OSError):  # not every system knows the limit
            continue
    sitk.ProcessObject.SetGlobalDefaultNumberOfThreads(1)
    sitk.ProcessObject.SetGlobalWarningDisplay(False)
    answers.write(json.dumps({"ready": True}) + "\n")
    answers.flush()
    for line in sys.stdin:
        request = json.loads(line)
        try:
            answer = WORK[request["what"]](request)
        except (RuntimeError, MemoryError, ValueError, OverflowError, OSError) as error:
            answer = {"error": f"{type(error).__name__}: {error}"[-2000:]}
        answers.write(json.dumps(answer) + "\n")
        answers.flush()


if __name__ == "__main__":
    main()
