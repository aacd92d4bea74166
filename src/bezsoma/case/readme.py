# SPDX-License-Identifier: BSD-3-Clause
"""The README.txt of a results folder: what was done, what came out, what each file is."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from bezsoma.refinement.levels import table

MEANINGS = {
    "README.txt": "this text",
    "case.toml": "the case as it was, byte for byte",
    "summary.json": "sizes, method, energy, reactions, probes, versions, for programs to read",
    "mesh.npz": "the mesh with its named regions and surfaces",
    "displacement.npz": "the displacement as Bernstein controls, which are not values at points",
    "pressure.npz": "the pressure (MPa) as Bernstein controls, on its own net",
    "displacement.vtu": "the displacement for ParaView, on curved cells of its full degree",
}
DIRECTIONS = "x to the patient's left, y to the back, z up"


def readme(summary: Mapping[str, Any]) -> str:
    """The text, for a reader who has never seen such a folder."""
    parts = [
        f"{summary['title']}\n{'=' * len(summary['title'])}",
        f"{summary['notice']} Do not base treatment on it.",
        _what(summary),
        motion_table(summary["probes"]),
        error_told(summary),
        levels_table(summary),
        _expectations(summary["expectations"]),
        "\n".join(f"Beware: {warning}." for warning in summary["warnings"]),
        _files(summary["files"]),
        "Run it again, or a changed copy (files that a case names are looked for beside it):\n\n"
        f"    bezsoma run case.toml{_instead(summary)} -o another-folder",
        "Read it again in Python:\n\n    import bezsoma as bz\n"
        '    results = bz.read_results("this folder")\n'
        "    results.displacement.at(points)   # mm, at any points (p, 3) of the mesh",
    ]
    return "\n\n".join(part for part in parts if part) + "\n"


def _instead(summary: Mapping[str, Any]) -> str:
    """What was asked for beside the case, as options.

    >>> _instead({"instead": {"degree": 3, "tolerance": 0.05}})
    ' --degree 3 --tolerance 0.05'
    """
    return "".join(f" --{name} {value!r}" for name, value in summary["instead"].items())


def motion_table(probes: Mapping[str, Mapping[str, Any]]) -> str:
    """How far each probe moved, mm; empty without probes.

    >>> print(motion_table({"chin": {"displacement": [-1e-9, -4.25, 0.5], "size": 4.279}}))
    motion, mm          x       y       z    size
    chin             0.00   -4.25    0.50    4.28
    (x to the patient's left, y to the back, z up)
    """
    if not probes:
        return ""
    wide = max(12, *(len(name) for name in probes))
    judged = any("error" in probe for probe in probes.values())
    heads = [*"xyz", "size", *(["error"] if judged else [])]
    lines = [f"{'motion, mm':<{wide}}" + "".join(f"{head:>8}" for head in heads)]
    for name, probe in probes.items():
        numbers = [*probe["displacement"], probe["size"]]
        entries = [f"{round(number, 2) + 0.0:8.2f}" for number in numbers]
        if "error" in probe:
            entries.append(f"{probe['error']:8.2g}")
        lines.append(f"{name:<{wide}}" + "".join(entries))
    return "\n".join([*lines, f"({DIRECTIONS})"])


def error_told(summary: Mapping[str, Any]) -> str:
    """How large the error is believed to be, and of what; empty where nothing was asked.

    >>> print(error_told({"error": {"energy": 0.034, "probes": {}, "unknowns": 5, "seconds": 2.0}}))
    Estimated error: 3.4 % in the energy norm (2.0 s).

    It is that of the components named, of several the length of their errors.
    """
    error = summary.get("error")
    if error is None:
        return ""
    if "left_out" in error:
        return f"Error: not estimated; {error['left_out']}."
    told = f"Estimated error: {100 * error['energy']:.3g} % in the energy norm"
    radii = {found["radius"] for found in error["probes"].values()}
    if radii:
        told += (
            f"; in the table, mm, that of the mean displacement within {min(radii):g} mm of each "
            f"probe, of {_together(error['components'])}"
        )
    return f"{told} ({error['seconds']:.1f} s)."


def _together(components: str) -> str:
    """Of what in a displacement the error is."""
    return f"{components} together" if len(components) > 1 else components


def levels_table(summary: Mapping[str, Any]) -> str:
    """The levels of a refinement and why it ended; empty where there was none."""
    if "refinement" not in summary:
        return ""
    found = summary["refinement"]
    levels = table(found["levels"])
    told = f"Estimated errors, level by level:\n\n{levels}\n\nIt ended: {found['why']}."
    radii = {probe["error_radius"] for probe in summary["probes"].values() if "error" in probe}
    if radii:
        told += (
            f"\nThe errors at probes are those of the mean displacement within {min(radii):g} mm, "
            "of xyz together."
        )
    return told


def _what(summary: Mapping[str, Any]) -> str:
    """Size, method and energy, a line each."""
    sizes, degree, asked = summary["sizes"], summary["degree"], summary["degree_in_case"]
    instead = "" if degree == asked else f" (the case says {asked})"
    return (
        f"Degree {degree}{instead} on {sizes['tets']} tets: {sizes['free_unknowns']} unknowns.\n"
        f"Method: {summary['method']}.\n"
        f"Iterations: {summary['iterations']}; residual relative to that at the start: "
        f"{summary['residual']:.1e}.\n"
        f"Stored energy: {summary['energy']:.6g} N mm; largest displacement anywhere: "
        f"{summary['largest_displacement']:.3f} mm." + _volume(summary)
    )


def _volume(summary: Mapping[str, Any]) -> str:
    """Pressure and change of volume of a mixed form; nothing without."""
    if "pressure_degree" not in summary:
        return ""
    low, high = summary["pressure_range"]
    degree = summary["pressure_degree"]
    return (
        f"\nPressure of degree {degree}, {low:.3g} to {high:.3g} MPa; its level is "
        f"{summary['pressure_level']}.\nVolume: largest |div u| "
        f"{summary['largest_divergence']:.2g} (the equations make its means vanish at nu = 1/2), "
        f"largest |det(I + grad u) - 1| {summary['largest_determinant']:.2g} (not zero at small "
        "strain)."
    )


def _expectations(checks: list[Mapping[str, Any]]) -> str:
    """The numbers expected of the case and whether they were met."""
    lines = [
        f"{'met    ' if each['met'] else 'NOT MET'}  {each['of']} = {each['found']:.6g}, expected "
        f"{each['between'][0]:g} to {each['between'][1]:g} ({each['source']})"
        for each in checks
    ]
    return "\n".join(["Expected of this case:", *lines]) if lines else ""


def _files(files: list[str]) -> str:
    """What each file of the folder is."""
    wide = max(map(len, files))
    return "\n".join(
        ["Files:", *(f"  {name:<{wide}}  {MEANINGS.get(name, _picture(name))}" for name in files)]
    )


def _picture(name: str) -> str:
    """What a file is that has no entry of its own."""
    if name.startswith("before-after"):
        return "before, after, how far each point moved (mm), and both outlines"
    if name.endswith(".png"):
        return f"{name.split('-')[0]} on the displaced surface"
    return "see the documentation"
