# SPDX-License-Identifier: BSD-3-Clause
"""Formulas in x, y, z read as exact polynomials: parsed, never run."""

from __future__ import annotations

import ast
import re
from collections.abc import Callable
from decimal import Decimal
from fractions import Fraction
from itertools import product

from bezsoma.errors import InputError

Powers = tuple[int, int, int]
Terms = tuple[tuple[Powers, Fraction], ...]
"""A polynomial: the powers of x, y, z and the exact coefficient of every term, sorted."""

HIGHEST_DEGREE = 10
"""Up to this degree polynomials are integrated exactly; the body's own degree ends there too."""

_ALLOWED = (
    "allowed are numbers, x, y, z, + - *, division by a number, ** or ^ with a whole number from "
    f"0 to {HIGHEST_DEGREE}, and parentheses"
)
_LONGEST = 10_000
_DEEPEST = 50
_LARGEST = 1e200
_DIGITS = 4000
_WORD = re.compile(
    r"\s+|[xyz](?!\w)|(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?(?![\w.])|[-+*/^()]", re.ASCII
)
_STRANGE = re.compile(r"[\w.]+")
_Sum = dict[Powers, Fraction]


def formula(text: str | float) -> Terms:
    """The terms of one formula; decimals are taken as written, so 0.1 is one tenth.

    (x + y)**2 = x**2 + 2 x y + y**2:

    >>> formula("(x + y)**2") == formula("x**2 + 2*x*y + y^2")
    True
    >>> formula("x/10 - 0.1*x")
    ()
    """
    if isinstance(text, bool) or not isinstance(text, str | int | float):
        raise InputError(f"a formula is text or a number, not {text!r}; {_ALLOWED}")
    said = text if isinstance(text, str) else format(Decimal(repr(float(text))), "f")
    _words_checked(said)
    source = _Source(said)
    try:
        tree = ast.parse(source.python, mode="eval").body
        return tuple(sorted((p, c) for p, c in _read(tree, source).items() if c))
    except SyntaxError as error:
        raise source.refusal((error.offset or 1) - 1, "this cannot be read") from None
    except (RecursionError, MemoryError):
        raise source.refusal(0, "too much within each other") from None


class _Source:
    """A formula as it was said, and as Python writes it; positions are those of the first."""

    def __init__(self, said: str) -> None:
        self.said = said
        start = len(said) - len(said.lstrip())
        letters = [(i, "**" if c == "^" else c) for i, c in enumerate(said)][start:]
        self.python = "".join(" " if c.isspace() else c for _, c in letters).rstrip()
        self._places = [i for i, c in letters for _ in c]

    def refusal(self, column: int, why: str) -> InputError:
        """The error for what stands at a column of the Python text."""
        at = self._places[min(column, len(self._places) - 1)] if self._places else 0
        return _refusal(self.said, at, why)


def _words_checked(said: str) -> None:
    """Refuse the first word that no formula has, before anything is made of the rest."""
    if len(said) > _LONGEST:
        raise _refusal(said, 0, f"longer than {_LONGEST} characters")
    at = depth = 0
    while at < len(said):
        word = _WORD.match(said, at)
        if word is None:
            strange = _STRANGE.match(said, at)
            shown = strange[0] if strange else said[at]
            raise _refusal(said, at, f"{shown!r} cannot stand in a formula")
        depth += (word[0] == "(") - (word[0] == ")")
        if depth > _DEEPEST:
            raise _refusal(said, at, f"more than {_DEEPEST} parentheses within each other")
        at = word.end()


def _read(tree: ast.expr, source: _Source) -> _Sum:
    match tree:
        case ast.Constant(value=int() | float()) if not isinstance(tree.value, bool):
            return {(0, 0, 0): _fraction(tree, source)}
        case ast.Name(id=("x" | "y" | "z") as name):
            return {(int(name == "x"), int(name == "y"), int(name == "z")): Fraction(1)}
        case ast.UnaryOp(op=ast.UAdd(), operand=inner):
            return _read(inner, source)
        case ast.UnaryOp(op=ast.USub(), operand=inner):
            return {p: -c for p, c in _read(inner, source).items()}
        case ast.BinOp(left=left, op=ast.Pow(), right=right):
            return _power(_read(left, source), _exponent(right, source), tree, source)
        case ast.BinOp() if type(tree.op) in _OPERATIONS:
            return _chain(tree, source)
    raise source.refusal(tree.col_offset, f"{ast.unparse(tree)!r} cannot stand in a formula")


def _chain(tree: ast.expr, source: _Source) -> _Sum:
    """The sum a + b - c ... or product, read along its left side without nesting calls."""
    links: list[ast.BinOp] = []
    while isinstance(tree, ast.BinOp) and type(tree.op) in _OPERATIONS:
        links.append(tree)
        tree = tree.left
    result = _read(tree, source)
    for link in reversed(links):
        right = _read(link.right, source)
        result = _OPERATIONS[type(link.op)](result, right, link, source)
    return result


def _fraction(tree: ast.Constant, source: _Source) -> Fraction:
    literal = source.python[tree.col_offset : tree.end_col_offset]
    size = abs(float(literal))
    if size > _LARGEST or len(literal) > _DIGITS:
        raise source.refusal(tree.col_offset, f"{literal[:40]!r} is too large or too long a number")
    if size < 1 / _LARGEST:
        if literal.lower().split("e")[0].strip("0."):
            raise source.refusal(tree.col_offset, f"{literal!r} is too small a number")
        return Fraction(0)
    return Fraction(literal)


def _exponent(tree: ast.expr, source: _Source) -> int:
    if isinstance(tree, ast.Constant) and type(tree.value) is int and tree.value <= HIGHEST_DEGREE:
        return tree.value
    raise source.refusal(
        tree.col_offset,
        f"{ast.unparse(tree)!r} cannot be a power: it is no whole number "
        f"from 0 to {HIGHEST_DEGREE}",
    )


def _sum(a: _Sum, b: _Sum, tree: ast.expr, source: _Source) -> _Sum:
    return {p: a.get(p, Fraction(0)) + b.get(p, Fraction(0)) for p in a.keys() | b.keys()}


def _difference(a: _Sum, b: _Sum, tree: ast.expr, source: _Source) -> _Sum:
    return _sum(a, {p: -c for p, c in b.items()}, tree, source)


def _product(a: _Sum, b: _Sum, tree: ast.expr, source: _Source) -> _Sum:
    result: _Sum = {}
    for (p, c), (q, d) in product(a.items(), b.items()):
        powers = (p[0] + q[0], p[1] + q[1], p[2] + q[2])
        result[powers] = result.get(powers, Fraction(0)) + c * d
    if any(sum(powers) > HIGHEST_DEGREE for powers, c in result.items() if c):
        raise source.refusal(
            tree.col_offset,
            f"the degree exceeds {HIGHEST_DEGREE}, up to which "
            "polynomials are exact here; give a Python function instead",
        )
    if any(_digits(c) > _DIGITS or abs(c) > _LARGEST for c in result.values()):
        raise source.refusal(
            tree.col_offset, f"a number beyond {_LARGEST:g} or of {_DIGITS} digits"
        )
    return result


def _digits(number: Fraction) -> int:
    return max(number.numerator.bit_length(), number.denominator.bit_length()) * 3 // 10


def _quotient(a: _Sum, b: _Sum, tree: ast.expr, source: _Source) -> _Sum:
    divisor = {p: c for p, c in b.items() if c}
    if set(divisor) != {(0, 0, 0)}:
        why = "division by zero" if not divisor else "division by x, y or z is no polynomial"
        raise source.refusal(tree.col_offset, why)
    return _product(a, {(0, 0, 0): 1 / divisor[0, 0, 0]}, tree, source)


def _power(base: _Sum, exponent: int, tree: ast.expr, source: _Source) -> _Sum:
    result: _Sum = {(0, 0, 0): Fraction(1)}
    for _ in range(exponent):
        result = _product(result, base, tree, source)
    return result


_OPERATIONS: dict[type[ast.operator], Callable[[_Sum, _Sum, ast.expr, _Source], _Sum]] = {
    ast.Add: _sum,
    ast.Sub: _difference,
    ast.Mult: _product,
    ast.Div: _quotient,
}


def _refusal(source: str, at: int, why: str) -> InputError:
    shown = source if len(source) <= 80 else source[:77] + "..."
    return InputError(f"formula {shown!r}, position {at + 1}: {why}; {_ALLOWED}")
