# SPDX-License-Identifier: BSD-3-Clause
"""Many errors of the core in one build, of which a number in the environment makes one.

To build the core again for every error would take hours. So both texts, the right one and the
wrong one, stand beside each other where one may be chosen when the program runs:

    sum += x[i];     becomes     sum += x[(bezsoma_error == 7 ? (0) : (i))];

What the compiler has to know, the entries of a table that is worked out when it compiles, cannot
be chosen so: such errors say `compiled=True` and are built one by one.
"""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

from mutants.mutant import Mutant

VARIABLE = "BEZSOMA_ERROR"
DECLARED = "extern int bezsoma_error;\n"
DEFINED = f"""
#include <cstdlib>
__attribute__((visibility("default")))
int bezsoma_error = std::getenv("{VARIABLE}") ? std::atoi(std::getenv("{VARIABLE}")) : -1;
"""


class Piece(NamedTuple):
    """A stretch of a file, and what stands there instead."""

    begin: int
    end: int
    text: str


def rounds(root: Path, mutants: list[Mutant]) -> list[list[Mutant]]:
    """Errors that one build can hold: no two at the same place, and none that is compiled in."""
    found: list[list[Mutant]] = []
    taken: list[list[tuple[str, Piece]]] = []
    for mutant in mutants:
        if mutant.compiled:
            continue
        text = (root / mutant.file).read_text(encoding="utf-8")
        here = piece(text, mutant, 0)
        for number in range(len(found) + 1):
            if number == len(found):
                found.append([])
                taken.append([])
            if all(
                file != mutant.file or here.end <= other.begin or other.end <= here.begin
                for file, other in taken[number]
            ):
                found[number].append(mutant)
                taken[number].append((mutant.file, here))
                break
    return found


def planted(root: Path, mutants: list[Mutant]) -> dict[str, str]:
    """The texts of the files with all these errors to choose from, by their place in the list."""
    pieces: dict[str, list[Piece]] = {}
    for number, mutant in enumerate(mutants):
        text = (root / mutant.file).read_text(encoding="utf-8")
        pieces.setdefault(mutant.file, []).append(piece(text, mutant, number))
    changed = {}
    for file, here in pieces.items():
        text = (root / file).read_text(encoding="utf-8")
        for begin, end, instead in sorted(here, reverse=True):
            text = text[:begin] + instead + text[end:]
        changed[file] = text
    return changed


def piece(text: str, mutant: Mutant, number: int) -> Piece:
    """The smallest statement or expression that holds the error, with both texts."""
    if text.count(mutant.old) != 1:
        raise SystemExit(f"{mutant.file} has {mutant.old!r} {text.count(mutant.old)} times")
    at = text.index(mutant.old)
    chosen = f"bezsoma_error == {number}"
    if are_statements(text, at, mutant):
        instead = f"if ({chosen}) {{ {mutant.new.strip()} }} else {{ {mutant.old.strip()} }}"
        return Piece(at, at + len(mutant.old), instead)
    before, after = in_common(mutant.old, mutant.new)
    begin, end = whole(
        text,
        at + before,
        at + len(mutant.old) - after,
        mutant.new[before : len(mutant.new) - after],
    )
    head, tail = text[begin : at + before], text[at + len(mutant.old) - after : end]
    right = text[begin:end].strip()
    wrong = (head + mutant.new[before : len(mutant.new) - after] + tail).strip()
    if not wrong or not right:
        raise SystemExit(f"{mutant.what}: an expression cannot go; give the whole statement")
    return Piece(begin, end, f" ({chosen} ? ({wrong}) : ({right}))")


def whole(text: str, begin: int, end: int, instead: str) -> tuple[int, int]:
    """The expression that holds what differs, as far out as brackets and commas in it reach."""
    head, tail = begin, end
    while True:
        both = text[begin:end], text[begin:head] + instead + text[tail:end]
        left, right = (max(numbers) for numbers in zip(*map(unmatched, both), strict=True))
        # The arguments of a template are the compiler's to know.
        if not (left or right) and all(map(alone, both)) and text[enclosing(text, begin)] != "<":
            return start_of_expression(text, begin), end_of_expression(text, end)
        if left or not right:
            begin = enclosing(text, begin)
        if right or not left:
            end = enclosed(text, end)


def unmatched(text: str) -> tuple[int, int]:
    """How many brackets close without having opened in a text, and how many stay open."""
    left = right = 0
    for at in range(len(text)):
        if opens(text, at):
            right += 1
        elif closes(text, at):
            left, right = (left, right - 1) if right else (left + 1, 0)
    return left, right


def enclosing(text: str, at: int) -> int:
    """Where the bracket about a place opens."""
    depth = 0
    while depth >= 0 and at > 0:
        at -= 1
        depth += closes(text, at) - opens(text, at)
    return at


def enclosed(text: str, at: int) -> int:
    """Past where it closes."""
    depth = 0
    while depth >= 0:
        depth += opens(text, at) - closes(text, at)
        at += 1
    return at


def are_statements(text: str, at: int, mutant: Mutant) -> bool:
    """Whether both texts are statements as a whole, so that a condition can choose."""
    above, _, before = text[:at].rpartition("\n")
    last = above.rpartition("\n")[2].partition("//")[0].strip()
    begins = not before.strip() and (not last or last.endswith((";", "{", "}", ")")))
    declares = mutant.old.lstrip().startswith(("const ", "{"))
    return (
        begins
        and not declares
        and all(
            part.rstrip().endswith((";", "}")) and unmatched(part) == (0, 0)
            for part in (mutant.old, mutant.new.strip() or ";")
        )
    )


def alone(text: str) -> bool:
    """Whether no comma or semicolon in a text belongs to what is around it."""
    depth = 0
    for at in range(len(text)):
        depth += opens(text, at) - closes(text, at)
        if depth == 0 and ends_expression(text, at):
            return False
    return True


def opens(text: str, at: int) -> bool:
    """Whether a bracket opens here; < is one where no space stands about it."""
    if text[at] == "<":
        return text[at + 1 : at + 2] not in (" ", "=", "<") and (
            at == 0 or text[at - 1].isalnum() or text[at - 1] == "_"
        )
    return text[at] in "([{"


def closes(text: str, at: int) -> bool:
    """Whether one closes here."""
    if text[at] == ">":
        return text[:at].rstrip(">")[-1:] not in (" ", "-")
    return text[at] in ")]}"


def in_common(old: str, new: str) -> tuple[int, int]:
    """How many characters two texts share at their begin and, beyond those, at their end."""
    short = min(len(old), len(new))
    before = 0
    while before < short and old[before] == new[before]:
        before += 1
    after = 0
    while after < short - before and old[-1 - after] == new[-1 - after]:
        after += 1
    return before, after


def start_of_expression(text: str, at: int) -> int:
    """Where the expression that holds this place begins: after a bracket, =, a comma, return."""
    depth = 0
    while at > 0:
        if closes(text, at - 1):
            depth += 1
        elif opens(text, at - 1):
            if depth == 0:
                break
            depth -= 1
        elif depth == 0 and (
            ends_expression(text, at - 1)
            or assigns(text, at - 1)
            or text[:at].endswith(("return ", "case "))
        ):
            break
        at -= 1
    return at


def end_of_expression(text: str, at: int) -> int:
    """Where it ends."""
    depth = 0
    while depth > 0 or not (closes(text, at) or ends_expression(text, at)):
        depth += opens(text, at) - closes(text, at)
        at += 1
    return at


def ends_expression(text: str, at: int) -> bool:
    """Whether a comma, semicolon, question mark or colon (of a choice or a range) stands here."""
    if text[at] == ":":
        return ":" not in (text[at - 1 : at], text[at + 1 : at + 2])
    return text[at] in ",;?"


def assigns(text: str, at: int) -> bool:
    """Whether the = here gives a value; in == and <= it compares."""
    return text[at] == "=" and text[at + 1] != "=" and text[at - 1] not in "=!<>"
