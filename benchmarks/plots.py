# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of what was measured; the only file here that draws."""

from __future__ import annotations

from typing import Any

import matplotlib.pyplot as plt
import numpy as np

Run = dict[str, Any]
plt.switch_backend("agg")  # no display is needed
COLOURS = {1: "#444444", 2: "#0072b2", 3: "#009e73", 4: "#d55e00", 6: "#cc79a7"}


def operator(found: Run, path: str) -> None:
    """Rates by degree and instruction set, and the parts of the roof."""
    if not path:
        return
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4), layout="constrained")
    one = [row for row in found["rows"] if row["sides"] == 1]
    styles = {8: "-", 4: "--"}
    names = list(dict.fromkeys(row["instructions"] for row in one))
    for colour, name in zip(("#0072b2", "#009e73", "#d55e00"), names, strict=False):
        for width, style in styles.items():
            rows = [r for r in one if r["instructions"] == name and r["width"] == width]
            left.plot(
                [r["degree"] for r in rows],
                [r["rate"] / 1e6 for r in rows],
                style,
                color=colour,
                marker="o",
                ms=4,
                label=f"{name}, float{8 * width}",
            )
    left.set(xlabel="degree", ylabel="million unknowns a second, one right-hand side", ylim=0)
    left.legend(frameon=False, ncols=3, loc="lower center", bbox_to_anchor=(0.5, 1), fontsize=8)
    rows = [r for r in one if r["instructions"] == names[0] and r["width"] == 8]
    for part, label, colour, width in (
        # The roof is the larger of the next two: wide, so that both show.
        ("part", "of the roof", "#cccccc", 7),
        ("part_memory", "of the bandwidth", "#0072b2", 1.5),
        ("part_flops", "of the flops", "#d55e00", 1.5),
        ("part_issue", "of the instructions", "#cc79a7", 1.5),
    ):
        right.plot(
            [r["degree"] for r in rows],
            [100 * r[part] for r in rows],
            "o-",
            ms=4,
            lw=width,
            color=colour,
            label=label,
        )
    right.axhline(50, color="#999999", lw=0.8, ls=":")
    right.set(xlabel="degree", ylabel=f"attained, %; {names[0]}, float64", ylim=(0, 100))
    right.legend(frameon=False, ncols=2, loc="lower center", bbox_to_anchor=(0.5, 1), fontsize=8)
    _finished(figure, path)


def growth(rows: list[Run], path: str) -> None:
    """Seconds, iterations and memory against unknowns."""
    if not path:
        return
    figure, axes = plt.subplots(1, 3, figsize=(12, 4), layout="constrained")
    draws = (
        ("seconds for a million unknowns", lambda r: r["solve"] / r["unknowns"] * 1e6),
        ("iterations", lambda r: r["iterations"]),
        (
            "bytes an unknown, without what imports take",
            lambda r: (r["bytes_peak"] - r["bytes_imported"]) / r["unknowns"],
        ),
    )
    for ax, (label, value) in zip(axes, draws, strict=True):
        for degree in sorted({r["degree"] for r in rows}):
            own = sorted((r["unknowns"], value(r)) for r in rows if r["degree"] == degree)
            if label.startswith("bytes"):
                own = [point for point in own if point[0] > 20_000]
            ax.plot(*np.array(own).T, "o-", ms=4, color=COLOURS.get(degree), label=f"n = {degree}")
        ax.set(xscale="log", xlabel="unknowns", ylabel=label)
        if label.startswith("iter"):
            ax.set_ylim(0)
        else:
            ax.set_yscale("log")
    axes[0].legend(frameon=False)
    _finished(figure, path)


def stages(rows: list[Run], names: dict[str, str], path: str) -> None:
    """Where the time goes at the largest size of each degree."""
    if not path:
        return
    figure, ax = plt.subplots(figsize=(9, 3.2), layout="constrained")
    largest = {}
    for row in sorted(rows, key=lambda r: r["unknowns"]):
        largest[row["degree"]] = row
    largest = dict(sorted(largest.items()))
    labels = [f"n = {n}, {row['unknowns'] / 1e6:.2g} M" for n, row in largest.items()]
    begin = np.zeros(len(largest))
    colours = plt.get_cmap("tab10").colors
    for colour, (key, name) in zip(colours, names.items(), strict=False):
        wide = np.array([row["stages"].get(key, 0.0) for row in largest.values()])
        total = np.array([sum(row["stages"].values()) for row in largest.values()])
        ax.barh(labels, 100 * wide / total, left=begin, color=colour, label=name)
        begin += 100 * wide / total
    ax.set(xlabel="% of the time from reading the mesh to results on disk", xlim=(0, 100))
    ax.invert_yaxis()
    ax.legend(frameon=False, ncols=4, loc="upper center", bbox_to_anchor=(0.5, -0.18), fontsize=8)
    _finished(figure, path)


def peers(rows: list[Run], path: str) -> None:
    """How many times longer the best peer took, by degree."""
    if not path:
        return
    figure, ax = plt.subplots(figsize=(6, 4), layout="constrained")
    series = sorted({(row["size"], row["threads"]) for row in rows})
    for (size, threads), mark in zip(series, ("o-", "o--", "s-", "s--"), strict=False):
        own = [row for row in rows if (row["size"], row["threads"]) == (size, threads)]
        own.sort(key=lambda row: row["degree"])
        ax.plot(
            [row["degree"] for row in own],
            [row["ratio"] for row in own],
            mark,
            ms=5,
            label=f"about {size // 1000}k unknowns, {threads} thread" + "s" * (threads > 1),
        )
    ax.set(yscale="log", xlabel="degree", ylabel="time of the best peer over ours")
    ticks = [1, 3, 10, 30, 100]
    ax.set_yticks(ticks, [str(tick) for tick in ticks])
    ax.set_xticks(sorted({row["degree"] for row in rows}))
    ax.axhline(1, color="#999999", lw=0.8)
    ax.legend(frameon=False, ncols=2, loc="lower center", bbox_to_anchor=(0.5, 1), fontsize=8)
    _finished(figure, path)


def _finished(figure: Any, path: str) -> None:
    figure.savefig(path, dpi=130, metadata={"Date": None} if path.endswith("svg") else None)
    plt.close(figure)
