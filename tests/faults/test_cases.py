# SPDX-License-Identifier: BSD-3-Clause
"""Case files with something wrong: the message has the place, what was given and what can stand."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from bezsoma import InputError
from bezsoma.case import read_case, run_case
from bezsoma.case.build import body_of
from bezsoma.case.expectations import probe_points
from bezsoma.case.sources import mesh_of
from cases.written import case_file

Change = tuple[str, str]


def message(path: Path) -> str:
    """What is said of a case before anything is solved."""
    with pytest.raises(InputError) as caught:
        case = read_case(path)
        mesh = mesh_of(case)
        probe_points(case, mesh)
        body_of(case, mesh, case.file.degree)
    return str(caught.value)


IN_THE_FILE: dict[str, tuple[Change, list[str]]] = {
    "unknown key in a list of tables": (
        ("translation = [0.1", "translatoin = [0.1"),
        ["case.toml: support.[1].translatoin: unknown key (did you mean 'translation'?), line 20"],
    ),
    "unknown key at the top": (
        ("degree = 2", "degree = 2\ndegreee = 3"),
        ["degreee: unknown key (did you mean 'degree'?)", "line 4"],
    ),
    "unknown key without a near one": (
        ("nu = 0.3", "nu = 0.3\nzzz = 1"),
        ["materials.tissue.zzz", "known here: A, C, E, G, ", "line 12"],
    ),
    "degree is a fraction": (("degree = 2", "degree = 2.5"), ["degree:", "whole number", "2.5"]),
    "degree is a text": (
        ("degree = 2", 'degree = "2"'),
        ["degree:", "whole number", "'2' (a text)"],
    ),
    "degree is a truth": (("degree = 2", "degree = true"), ["degree:", "whole number", "True"]),
    "degree too high": (
        ("degree = 2", "degree = 11"),
        ["degree: 11 is out of range: 1 to 10 can stand here, line 3"],
    ),
    "degree zero": (
        ("degree = 2", "degree = 0"),
        ["degree: 0 is out of range: 1 to 10 can stand here, line 3"],
    ),
    "no degree": (("degree = 2", ""), ["degree: this key is missing", "1 to 10"]),
    "title is a number": (('"A block"', "7"), ["title: a text in quotes is needed", "7"]),
    "two sources of the mesh": (
        ('solid = "block"', 'solid = "block"\nphantom = "small"'),
        ["mesh: give exactly one", "['phantom', 'solid']", "line 5"],
    ),
    "no source of the mesh": (
        ('solid = "block"\nparameters = { size = [2, 1, 1], cells = [2, 1, 1] }', ""),
        ["mesh: give exactly one", "none"],
    ),
    "unknown phantom": (
        (
            'solid = "block"\nparameters = { size = [2, 1, 1], cells = [2, 1, 1] }',
            'phantom = "big"',
        ),
        ["mesh.phantom: 'big'", "'small', 'medium' or 'large'"],
    ),
    "tags without a file": (
        ('solid = "block"', 'solid = "block"\nsurfaces = { skin = 1 }'),
        ["mesh:", "surfaces", "belong to a 'file'"],
    ),
    "a tag that is no number": (
        (
            'solid = "block"\nparameters = { size = [2, 1, 1], cells = [2, 1, 1] }',
            'file = "a.npz"\nsurfaces = { skin = "one" }',
        ),
        ["mesh.surfaces.skin: a whole number is needed", "'one'"],
    ),
    "unknown solid": (
        ('solid = "block"', 'solid = "blok"'),
        ["mesh.solid: no solid 'blok' (did you mean 'block'?), line 6"],
    ),
    "unknown parameter of a solid": (
        ("size = [2, 1, 1]", "sise = [2, 1, 1]"),
        ["mesh.parameters.sise: unknown key (did you mean 'size'?), line 7"],
    ),
    "a solid that cannot be": (
        ("cells = [2, 1, 1]", "cells = [0, 1, 1]"),
        ["mesh.parameters: the solid 'block' refuses", "line 7"],
    ),
    "unknown law": (
        ("E = 0.015", 'law = "neo-hook"\nE = 0.015'),
        [
            "materials.tissue.law: 'neo-hook' cannot stand here",
            "'stiffening'",
            "(did you mean 'neo-hooke'?), line 10",
        ],
    ),
    "a law that is like none": (
        ("E = 0.015", 'law = "xxx"\nE = 0.015'),
        ["materials.tissue.law: 'xxx' cannot stand here", "or 'guccione', line 10"],
    ),
    "unknown iteration": (
        ("[output]", '[solver]\niteration = "newtn"\n\n[output]'),
        ["solver.iteration: 'newtn' cannot stand here", "(did you mean 'newton'?), line 37"],
    ),
    "E and G": (("nu = 0.3", "G = 0.3"), ["materials.tissue: give E and nu, or G and kappa"]),
    "E below zero": (("E = 0.015", "E = -1"), ["materials.tissue: E = -1 MPa", "positive"]),
    "nu beyond 1/2": (("nu = 0.3", "nu = 0.6"), ["materials.tissue: nu = 0.6", "at most 1/2"]),
    "a pressure degree as text": (
        ("degree = 2", 'degree = 2\npressure_degree = "one"'),
        ["pressure_degree: a whole number is needed"],
    ),
    "a field that is none": (
        ("pictures = []", 'pictures = []\nfields = "presure"'),
        ["output.fields: 'presure' cannot stand here", "'pressure'"],
    ),
    "E not a number": (("E = 0.015", "E = nan"), ["materials.tissue.E: a finite number", "nan"]),
    "no material": (
        ("[materials.tissue]\nE = 0.015\nnu = 0.3", "materials = {}"),
        ["materials", "missing"],
    ),
    "unknown type of support": (
        ('type = "moved"', 'type = "mvoed"'),
        ["support.[1]: unknown type 'mvoed' (did you mean 'moved'?), line 17"],
    ),
    "support without a type": (
        ('type = "fixed"', ""),
        ["support.[0]: the key 'type' is missing", "fixed, moved, prescribed"],
    ),
    "support on nothing": (
        ('on = "left"', "on = []"),
        ["support.[0].on: at least one entry", "the places held"],
    ),
    "support without places": (
        ('on = "left"', ""),
        ["support.[0].on: this key is missing: the places held"],
    ),
    "unknown components": (
        ('on = "left"', 'on = "left"\ncomponents = "xw"'),
        ["support.[0].components: 'xw'", "'xyz'"],
    ),
    "a component twice": (
        ('on = "left"', 'on = "left"\ncomponents = "zxz"'),
        ["support.[0].components: 'zxz'", "'xyz'"],
    ),
    "two components of a vector": (
        ("[0.1, 0, 0]", "[0.1, 0]"),
        ["support.[1].translation: three entries are needed (x, y, z), not 2"],
    ),
    "a vector that is a number": (
        ("[0.1, 0, 0]", "0.1"),
        ["support.[1].translation: a list is needed here, not 0.1"],
    ),
    "a turn without an axis": (
        ("translation = [0.1, 0, 0]", "degrees = 5"),
        ["support.[1]: a turn by 'degrees' needs its 'axis' and a point 'about'"],
    ),
    "an axis without a turn": (
        ("translation = [0.1, 0, 0]", "axis = [1, 0, 0]"),
        ["support.[1]: 'axis' and 'about' belong to a turn; say by how many 'degrees'"],
    ),
    "a formula that cannot be read": (
        ('"1e-5*x"', '"1e-5*import"'),
        ["load.[0].value.[2]", "formula '1e-5*import'", "allowed are numbers, x, y, z"],
    ),
    "a formula with a function": (
        ('"1e-5*x"', '"sin(x)"'),
        ["load.[0].value.[2]", "sin(x)", "allowed"],
    ),
    "a pressure in three directions": (
        ('type = "traction"', 'type = "pressure"'),
        ["load.[0].value: a number is needed", "(a list)"],
    ),
    "unknown type of load": (
        ('type = "traction"', 'type = "force"'),
        ["load.[0]: unknown type 'force'", "traction, pressure, body, point"],
    ),
    "unknown method": (
        ("[output]", '[solver]\nmethod = "lu"\n[output]'),
        ["solver.method: 'lu'", "'auto', 'direct', 'multigrid', 'cg' or 'saddle'"],
    ),
    "a tolerance of zero": (
        ("[output]", "[solver]\nrtol = 0\n[output]"),
        ["solver.rtol: 0 is out of range: numbers above 0 and below 1 can stand here"],
    ),
    "too many threads": (
        ("[output]", "[solver]\nthreads = -1\n[output]"),
        ["solver.threads: -1 is out of range: 0 to 1024 can stand here"],
    ),
    "a degree of an expectation": (
        ("[0.04, 0.06]", "[0.04, 0.06]\ndegrees = [2, 12]"),
        ["expect.[0].degrees.[1]: 12 is out of range: 1 to 10 can stand here"],
    ),
    "a band below zero": (
        ("[[load]]", '[[join]]\ntype = "graded"\nover = "left"\nto = "top"\nband = -1\n\n[[load]]'),
        ["join.[0].band: -1 is out of range: numbers above 0 can stand here"],
    ),
    "a probe with a dot in its name": (
        ('name = "middle"', 'name = "mid.dle"'),
        ["probe.[0].name: 'mid.dle' is no word"],
    ),
    "a probe named like something else": (
        ('name = "middle"', 'name = "energy"'),
        ["probe.[0].name: 'energy' means a quantity of the whole body; take another name"],
    ),
    "two probes of one name": (
        ("[[expect]]", '[[probe]]\nname = "middle"\npoint = [0, 0, 0]\n\n[[expect]]'),
        ["probe.[1].name: 'middle' names a probe above; give each a name of its own"],
    ),
    "an expectation without a number": (
        ("between = [0.04, 0.06]", ""),
        ["expect.[0]: give 'value' with one of 'tolerance' and 'relative'"],
    ),
    "an expectation upside down": (
        ("[0.04, 0.06]", "[0.06, 0.04]"),
        ["expect.[0]: 'between' runs from the smaller to the larger"],
    ),
    "an expectation without a source": (
        ('source = "half of what the right side moves"', ""),
        ["expect.[0].source: this key is missing: where the number comes from"],
    ),
    "unknown view": (
        ("pictures = []", 'pictures = ["fornt"]'),
        ["output.pictures.[0]: no view 'fornt'", "did you mean 'front'?", "line 37"],
    ),
}

IN_THE_MESH: dict[str, tuple[Change, list[str]]] = {
    "unknown surface of a support": (
        ('on = ["right"]', 'on = ["rihgt"]'),
        ["support.[1].on: no place 'rihgt'; this mesh has", "did you mean 'right'?", "line 19"],
    ),
    "unknown surface of a load": (
        ('on = "top"', 'on = "topp"'),
        ["load.[0].on: no surface 'topp'", "did you mean 'top'?", "line 24"],
    ),
    "unknown region": (
        ("[materials.tissue]", "[materials.tisue]"),
        [
            "materials.tisue: no region 'tisue'",
            "did you mean 'tissue'?",
            "no material for the region",
        ],
    ),
    "unknown place of a join": (
        ("[[load]]", '[[join]]\ntype = "graded"\nover = "left"\nto = "up"\nband = 1\n\n[[load]]'),
        ["join.[0].to: no place 'up'", "'left'"],
    ),
    "unknown surface of a probe": (
        ("point = [1, 0.5, 0.5]", 'point = [1, 0.5, 0.5]\non = "skin"'),
        ["probe.[0].on: no surface 'skin'"],
    ),
    "unknown surface of the pictures": (
        ("pictures = []", 'surface = "skin"'),
        ["output.surface: no surface 'skin'"],
    ),
    "a probe outside": (
        ("point = [1, 0.5, 0.5]", "point = [1, 0.5, 1.5]"),
        [
            "probe.[0].point: [1.0, 0.5, 1.5] lies outside the mesh, 0.5 mm from it",
            "'on'",
            "line 29",
        ],
    ),
    "a probe at a vertex that has no name": (
        ("point = [1, 0.5, 0.5]", 'point = "chin"'),
        ["probe.[0].point: no vertex place 'chin'", "line 29"],
    ),
    "an expectation of nothing": (
        ('of = "middle.x"', 'of = "midle.x"'),
        ["expect.[0].of: no quantity 'midle.x' (did you mean 'middle.x'?), line 32"],
    ),
    "a reaction of what holds nothing": (
        ('of = "middle.x"', 'of = "reaction.top.x"'),
        ["expect.[0].of: no quantity 'reaction.top.x'"],
    ),
    "nu of 1/2 without a pressure": (
        ("nu = 0.3", "nu = 0.5"),
        ["case.toml: region 'tissue' has nu = 1/2", "incompressible = true beside degree"],
    ),
    "a pressure of the same degree": (
        ("degree = 2", "degree = 2\npressure_degree = 2"),
        ["case.toml: degree = 2 with pressure_degree = 2", "pressure_degree=1"],
    ),
    "a point force beside every vertex": (
        ("[[probe]]", '[[load]]\ntype = "point"\nat = [9, 9, 9]\nforce = [0, 0, 1]\n\n[[probe]]'),
        ["case.toml: PointForce: no vertex of this mesh lies at [9.0, 9.0, 9.0]"],
    ),
}


@pytest.mark.parametrize("fault", IN_THE_FILE)
def test_a_fault_in_the_file_is_named_with_its_place(fault: str, tmp_path: Path) -> None:
    change, said = IN_THE_FILE[fault]
    found = message(case_file(tmp_path, change))
    assert [phrase for phrase in said if phrase not in found] == [], found
    assert all(line.startswith("case.toml: ") for line in found.splitlines())


@pytest.mark.parametrize("fault", IN_THE_MESH)
def test_a_name_that_the_mesh_lacks_is_named_with_its_place(fault: str, tmp_path: Path) -> None:
    change, said = IN_THE_MESH[fault]
    found = message(case_file(tmp_path, change))
    assert [phrase for phrase in said if phrase not in found] == [], found


def test_a_probe_is_at_one_vertex(tmp_path: Path) -> None:
    pair = "[mesh.vertices]\npair = [[1, 0, 0], [1, 1, 0]]\n\n[materials.tissue]"
    changes = ("[materials.tissue]", pair), ("point = [1, 0.5, 0.5]", 'point = "pair"')
    assert "probe.[0].point: 'pair' is 2 vertices; name one alone" in message(
        case_file(tmp_path, *changes)
    )


def test_a_place_where_the_mesh_has_no_vertex_is_refused(tmp_path: Path) -> None:
    beside = "[mesh.vertices]\ntip = [1, 0, 0.1]\n\n[materials.tissue]"
    found = message(case_file(tmp_path, ("[materials.tissue]", beside)))
    assert found.startswith("case.toml: mesh.vertices.tip: ")
    assert found.endswith("line 10")


def test_all_faults_are_reported_in_the_order_of_the_file(tmp_path: Path) -> None:
    path = case_file(
        tmp_path, ("degree = 2", "degree = 0"), ("E = 0.015", "Ee = 1"), ('"moved"', '"shifted"')
    )
    lines = message(path).splitlines()
    places = [line.split(": ")[1] for line in lines]
    assert places == ["degree", "materials.tissue.Ee", "support.[1]"]
    numbers = [int(re.findall(r"line (\d+)$", line)[0]) for line in lines]
    assert numbers == sorted(numbers)


def test_all_names_that_a_mesh_lacks_are_reported_in_one_go(tmp_path: Path) -> None:
    path = case_file(
        tmp_path,
        ('on = "left"', 'on = "lft"'),
        ('on = "top"', 'on = "tp"'),
        ("point = [1, 0.5, 0.5]", "point = [1, 0.5, 1.5]"),
        ('of = "middle.x"', 'of = "middle.q"'),
    )
    places = [line.split(": ")[1] for line in message(path).splitlines()]
    assert places == ["support.[0].on", "load.[0].on", "probe.[0].point", "expect.[0].of"]


def test_a_file_that_is_not_toml_is_refused_with_its_line(tmp_path: Path) -> None:
    found = message(case_file(tmp_path, ("nu = 0.3", "nu = = 0.3")))
    assert "case.toml: this is not TOML" in found
    assert "line 11" in found


def test_a_key_given_twice_is_refused(tmp_path: Path) -> None:
    assert "not TOML" in message(case_file(tmp_path, ("nu = 0.3", "nu = 0.3\nnu = 0.4")))


def test_bytes_that_are_no_text_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "case.toml"
    path.write_bytes(b'title = "M\xfcller"')
    found = message(path)
    assert "byte 10 is not UTF-8" in found
    assert "save the file as UTF-8" in found


def test_an_empty_file_is_refused_with_all_that_is_missing(tmp_path: Path) -> None:
    path = tmp_path / "case.toml"
    path.write_text("")
    found = message(path)
    assert all(f"{key}: this key is missing" in found for key in ("degree", "mesh", "materials"))


def test_a_folder_is_no_case(tmp_path: Path) -> None:
    assert "is a folder; give the case file itself" in message(tmp_path)


def test_a_case_that_is_not_there_names_those_that_are(tmp_path: Path) -> None:
    case_file(tmp_path, name="jaw.toml")
    found = message(tmp_path / "jow.toml")
    assert "no case" in found
    assert "['jaw.toml']" in found
    assert "does not exist" in message(tmp_path / "there" / "case.toml")


def test_a_mesh_file_that_is_nowhere_lists_the_places_tried(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    old = 'solid = "block"\nparameters = { size = [2, 1, 1], cells = [2, 1, 1] }'
    path = case_file(tmp_path, (old, 'file = "head/face.npz"\nfolder = "../store"'))
    monkeypatch.delenv("BEZSOMA_DATA", raising=False)
    found = message(path)
    assert "mesh.file: no file 'head/face.npz'" in found
    assert str(tmp_path / "head" / "face.npz") in found
    assert str(tmp_path.parent / "store" / "head" / "face.npz") in found
    assert "BEZSOMA_DATA is not set" in found
    assert "line 6" in found
    monkeypatch.setenv("BEZSOMA_DATA", str(tmp_path / "elsewhere"))
    found = message(path)
    assert str(tmp_path / "elsewhere" / "head" / "face.npz") in found
    assert "is not set" not in found


def test_a_damaged_mesh_file_is_refused_with_the_place_in_the_case(tmp_path: Path) -> None:
    (tmp_path / "face.npz").write_bytes(b"PK\x03\x04 not a mesh")
    old = 'solid = "block"\nparameters = { size = [2, 1, 1], cells = [2, 1, 1] }'
    found = message(case_file(tmp_path, (old, 'file = "face.npz"')))
    assert found.startswith("case.toml: mesh.file: ")
    assert "face.npz" in found


def refusal(folder: Path, *changes: Change) -> str:
    """What is said when the equations of a case are set up."""
    with pytest.raises(InputError) as caught:
        run_case(read_case(case_file(folder, *changes)), folder / "out")
    assert not (folder / "out").exists()
    return str(caught.value)


def test_supports_that_collide_are_told_what_to_write_into_the_case(tmp_path: Path) -> None:
    found = refusal(tmp_path, ('on = "left"', 'on = "back"'))
    assert found.startswith("case.toml: Fixed on 'back' and Moved on 'right' prescribe different")
    assert "Graded(over='back', to='right', band=<mm>)" in found
    assert '[[join]] type = "precedence" place = "right" over = "back"' in found
    assert '[[join]] type = "graded" over = "back" to = "right" band = <mm>' in found
    assert '[[join]] type = "gap" free = "back" at = "right" width = <mm>' in found


@pytest.mark.parametrize(
    "join",
    [
        'type = "precedence"\nplace = "right"\nover = "back"',
        'type = "graded"\nover = "back"\nto = "right"\nband = 1.5',
        'type = "gap"\nfree = "back"\nat = "right"\nwidth = 0.5',
    ],
)
def test_each_table_that_is_told_there_is_taken(join: str, tmp_path: Path) -> None:
    changes = ('on = "left"', 'on = "back"'), ("[[load]]", f"[[join]]\n{join}\n\n[[load]]")
    free = ("[0.04, 0.06]", "[-1, 1]")
    results = run_case(read_case(case_file(tmp_path, *changes, free)), tmp_path / "out")
    assert results.displacement.controls.any()


def test_motions_that_are_left_are_told_what_to_write_into_the_case(tmp_path: Path) -> None:
    loose = (
        ('type = "moved"', 'type = "fixed"\ncomponents = "x"'),
        ("translation = [0.1, 0, 0]", ""),
    )
    found = refusal(tmp_path, ('on = "left"', 'on = "left"\ncomponents = "x"'), *loose)
    assert found.startswith("case.toml: the supports leave motions that cost no energy")
    assert "Hold (Fixed, Moved, Prescribed) a surface of what moves" in found
    assert 'in the case file: [[support]] type = "fixed" on = "<place>"' in found
