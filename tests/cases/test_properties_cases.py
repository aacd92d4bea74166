# SPDX-License-Identifier: BSD-3-Clause
"""Any case file means what it says, however it is laid out; any wrong key in it is named."""

from __future__ import annotations

import json
import string
from pathlib import Path
from typing import Any

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from bezsoma.case.reading import Case, case_from
from bezsoma.errors import InputError

Tables = dict[str, Any]
PATH = Path("any.toml")

numbers = st.integers(-1000, 1000).map(lambda n: n / 16)
positive = st.integers(1, 1000).map(lambda n: n / 64)
names = st.text(string.ascii_lowercase + " _-é", min_size=1, max_size=8)
places = st.lists(names, min_size=1, max_size=3)
points = st.tuples(numbers, numbers, numbers).map(list)
formulas = st.one_of(numbers, st.sampled_from(["x", "1e-3*x*y", "z**2 - 1", "-(x + 2*y)"]))
components = st.sampled_from(["x", "y", "z", "xy", "xz", "yz", "xyz"])


def table(needed: Tables, **possible: Any) -> st.SearchStrategy[Tables]:
    """A table with these keys, and any of the possible ones."""
    return st.fixed_dictionaries(needed, optional=possible)


def typed(kind: str, **needed: Any) -> Tables:
    """What a table of a kind needs."""
    return {"type": st.just(kind), **needed}


supports = st.one_of(
    table(typed("fixed", on=places), components=components),
    table(typed("moved", on=places), translation=points, components=components),
    table(typed("moved", on=places, axis=points, about=points, degrees=positive)),
    table(typed("prescribed", on=places, value=st.tuples(formulas, formulas, formulas).map(list))),
)
joins = st.one_of(
    table(typed("precedence", place=names, over=names)),
    table(typed("graded", over=names, to=names, band=positive)),
    table(typed("gap", free=names, at=names, width=positive)),
)
loads = st.one_of(
    table(typed("traction", on=places, value=st.tuples(formulas, formulas, formulas).map(list))),
    table(typed("pressure", on=places, value=formulas), following=st.booleans()),
    table(typed("body", value=points), regions=places),
    table(typed("point", at=st.one_of(names, points), force=points)),
)
materials = st.one_of(
    table({"E": positive, "nu": st.sampled_from([0.0, 0.3, 0.49, 0.5])}),
    table({"G": positive, "kappa": positive}),
)
solids = table({"solid": st.sampled_from(["block", "ball"])}, vertices=st.just({}))
solvers = table(
    {},
    method=st.sampled_from(["auto", "direct", "multigrid", "cg", "saddle"]),
    rtol=st.sampled_from([1e-4, 1e-8]),
    threads=st.integers(0, 1024),
    exactness=st.integers(0, 40),
)
expectations = table(
    {"of": names, "source": names, "value": numbers, "tolerance": positive},
    degrees=st.lists(st.integers(1, 10), min_size=1, max_size=3),
)
words = st.from_regex(r"[A-Za-z][A-Za-z0-9_-]{0,6}", fullmatch=True)
probes = st.lists(words, max_size=3, unique=True).flatmap(
    lambda each: st.tuples(*[table({"name": st.just(w), "point": points}) for w in each]).map(list)
)
cases = table(
    {
        "degree": st.integers(1, 10),
        "mesh": solids,
        "materials": st.dictionaries(names, materials, min_size=1, max_size=3),
    },
    title=st.text(string.printable, max_size=12),
    incompressible=st.booleans(),
    support=st.lists(supports, max_size=3),
    join=st.lists(joins, max_size=2),
    load=st.lists(loads, max_size=3),
    solver=solvers,
    probe=probes,
    expect=st.lists(expectations, max_size=2),
    output=table({}, vtu=st.booleans(), stress=st.booleans(), pictures=st.just([])),
)


def toml(value: Any) -> str:
    """A value as TOML, tables inline: JSON but for their = and for keys that may stand bare."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key(k)} = {toml(v)}" for k, v in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(toml, value)) + "]"
    return json.dumps(value).replace("\x7f", "\\u007f")


def key(name: str) -> str:
    """A key, in quotes where it has to be."""
    bare = string.ascii_letters + string.digits + "_-"
    return name if name and set(name) <= set(bare) else json.dumps(name)


def laid_out(tables: Tables, order: Any, inline: bool) -> str:
    """The text of a case: its keys in an order of their own, tables inline or under headings."""
    plain = {k: v for k, v in tables.items() if inline or not isinstance(v, dict)}
    lines = [f"{key(k)} = {toml(v)}" for k, v in order(list(plain.items()))]
    for name, inner in order([(k, v) for k, v in tables.items() if k not in plain]):
        lines += [
            f"\n[{key(name)}]  # a table",
            *(f"{key(k)} = {toml(v)}" for k, v in inner.items()),
        ]
    return "\n".join(lines) + "\n"


def read(tables: Tables) -> Case:
    """The case of these tables."""
    return case_from(PATH, laid_out(tables, list, inline=True))


def as_given(found: Any, given: Any) -> None:
    """What stands in the file stands in the case, one to one."""
    if isinstance(given, dict):
        for name, value in given.items():
            as_given(found[name] if isinstance(found, dict) else getattr(found, name), value)
    elif isinstance(given, list):
        assert len(found) == len(given)
        for one, other in zip(found, given, strict=True):
            as_given(one, other)
    else:
        assert found == given and isinstance(found, bool) == isinstance(given, bool)


@given(cases, st.randoms(use_true_random=False), st.booleans())
def test_a_case_has_what_its_file_says_in_whatever_order(
    tables: Tables, random: Any, inline: bool
) -> None:
    def shuffled(items: list[Any]) -> list[Any]:
        return random.sample(items, len(items))

    case = case_from(PATH, laid_out(tables, shuffled, inline))
    as_given(case.file, tables)
    assert case.file == read(tables).file


@given(cases)
def test_a_case_survives_being_written_from_what_was_read(tables: Tables) -> None:
    once = read(tables).file
    again = json.loads(once.model_dump_json(exclude_unset=True))
    assert read(again).file == once


def paths(value: Any, at: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Where keys of the schema stand: not those that the user names."""
    if isinstance(value, list):
        return [path for i, v in enumerate(value) for path in paths(v, (*at, i))]
    if not isinstance(value, dict):
        return []
    mine = [] if at and at[-1] in ("materials", "vertices") else [(*at, k) for k in value]
    return mine + [path for k, v in value.items() for path in paths(v, (*at, k))]


@given(st.data(), cases)
def test_a_misspelt_key_is_named_with_its_place_and_the_right_one(
    data: st.DataObject, tables: Tables
) -> None:
    """Wherever it stands; a key that is needed is missed as well, which is said too."""
    path = data.draw(st.sampled_from(paths(tables)))
    assume(path[-1] != "type")  # its table would be of no kind
    table = tables
    for step in path[:-1]:
        table = table[step]
    right = path[-1]
    at = data.draw(st.integers(0, len(right)))
    wrong = right[:at] + "q" + right[at:]
    table[wrong] = table.pop(right)
    with pytest.raises(InputError) as caught:
        read(tables)
    told = str(caught.value)
    place = ".".join(f"[{step}]" if isinstance(step, int) else step for step in path[:-1])
    assert f"{place}.{wrong}".lstrip(".") + ": unknown key" in told
    if len(right) > 2:
        assert f"(did you mean {right!r}?)" in told


@given(st.data(), cases)
def test_a_value_of_another_kind_is_refused_with_its_key(
    data: st.DataObject, tables: Tables
) -> None:
    """A date stands nowhere in a case; the key is named."""
    path = data.draw(st.sampled_from(paths(tables)))
    table = tables
    for step in path[:-1]:
        table = table[step]
    table[path[-1]] = "@@"
    text = laid_out(tables, list, inline=True).replace('"@@"', "1998-01-01", 1)
    with pytest.raises(InputError) as caught:
        case_from(PATH, text)
    assert str(path[-1]) in str(caught.value)
