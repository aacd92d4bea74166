# SPDX-License-Identifier: BSD-3-Clause
"""What may stand in a case file: every table, key, type and range, and nothing else.

Units: mm, N, MPa; angles in *degrees*, since people write these files (Python takes radians).
Each key's description is what the message says where the key is missing.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal, get_args

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    Tag,
    model_validator,
)

import bezsoma.mechanics.materials
from bezsoma.case.laws import LAW_NAMES, law_of
from bezsoma.equations.threads import MOST_THREADS
from bezsoma.errors import unknown
from bezsoma.mechanics.polynomial import Polynomial
from bezsoma.refinement.loop import MOST_UNKNOWNS
from bezsoma.solvers.load_steps import steps_checked
from bezsoma.view.camera import VIEWS

Degree = Annotated[int, Field(ge=1, le=10)]
Finite = Annotated[float, Field(allow_inf_nan=False)]
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
Name = Annotated[str, Field(min_length=1)]


def _tuple(value: Any) -> Any:
    """TOML has lists where frozen models hold tuples."""
    return tuple(value) if isinstance(value, list) else value


def _triple(value: Any) -> Any:
    """Three entries, one for each of x, y and z."""
    if isinstance(value, list) and len(value) != 3:
        raise ValueError(f"three entries are needed (x, y, z), not {len(value)}: {value}")
    return _tuple(value)


def _pair(value: Any) -> Any:
    """Two entries, the lower and the higher."""
    if isinstance(value, list) and len(value) != 2:
        raise ValueError(f"two entries are needed (low, high), not {len(value)}: {value}")
    return _tuple(value)


def _place_shape(value: Any) -> str:
    """A list is a point; anything else has to be a name."""
    return "list" if isinstance(value, list | tuple) else "text"


def _formula_shape(value: Any) -> str:
    """A text is a formula; anything else has to be a number."""
    return "text" if isinstance(value, str) else "number"


def _view(value: str) -> str:
    """A view that a picture can be drawn from."""
    if value not in VIEWS:
        raise ValueError(unknown("view", value, VIEWS, "a picture"))
    return value


def _names(value: Any) -> Any:
    """One name may stand without brackets."""
    return (value,) if isinstance(value, str) else _tuple(value)


def _polyline(value: Any) -> Any:
    """One point may stand without a second pair of brackets."""
    if isinstance(value, list) and value and not isinstance(value[0], list):
        return (tuple(value),)
    return tuple(_tuple(point) for point in value) if isinstance(value, list) else value


def _parsed(value: Any) -> Any:
    """The value itself, once its formulas are known to be readable."""
    Polynomial.parse(value)
    return value


Point = Annotated[tuple[Finite, Finite, Finite], BeforeValidator(_triple)]
Points = Annotated[tuple[Point, ...], BeforeValidator(_polyline), Field(min_length=1)]
Names = Annotated[tuple[Name, ...], BeforeValidator(_names), Field(min_length=1)]
Degrees = Annotated[tuple[Degree, ...], BeforeValidator(_tuple), Field(min_length=1)]
Formula = Annotated[
    Annotated[Finite, Tag("number")] | Annotated[str, AfterValidator(_parsed), Tag("text")],
    Discriminator(_formula_shape),
]
Formulas = Annotated[tuple[Formula, Formula, Formula], BeforeValidator(_triple)]
Vertex = Annotated[
    Annotated[Name, Tag("text")] | Annotated[Point, Tag("list")], Discriminator(_place_shape)
]
Fields = Annotated[
    tuple[Literal["pressure", "divergence", "determinant", "von_mises"], ...],
    BeforeValidator(_names),
]
Views = Annotated[tuple[Annotated[str, AfterValidator(_view)], ...], BeforeValidator(_names)]


def _steps(value: Any) -> Any:
    """A number, a list of fractions or "auto", as `solve` takes them."""
    steps_checked(value)
    return _tuple(value)


Steps = Annotated[Any, BeforeValidator(_steps)]
Letters = Literal["x", "y", "z", "xy", "xz", "yz", "xyz"]


def _ordered(value: Any) -> Any:
    """Components may stand in any order, as "zx" in Python; what is none of them stays as it is."""
    ordered = "".join(sorted(value)) if isinstance(value, str) else value
    return ordered if ordered in get_args(Letters) else value


Components = Annotated[Letters, BeforeValidator(_ordered)]


class Table(BaseModel):
    """A table of the file: no unknown keys, no silent conversion of types."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


class Mesh(Table):
    """The tets, from one of three sources, and the names of their places."""

    file: Name | None = None
    """A mesh file: beside the case, else in BEZSOMA_DATA, else in `folder`."""
    folder: Name | None = None
    """Where data lies when it is not beside the case, relative to the case."""
    phantom: Literal["small", "medium", "large"] | None = None
    """The built-in head, of one of three sizes."""
    solid: Name | None = None
    """A simple solid by its name in `bezsoma.mesh.solids`."""
    parameters: dict[str, Any] = {}
    """What the solid's function is called with."""
    surfaces: dict[Name, int] | None = None
    """Name -> tag of the surfaces in the file."""
    regions: dict[Name, int] | None = None
    """Name -> tag of the regions in the file."""
    vertices: dict[Name, Points] = {}
    """Name -> the points (mm) of vertices."""
    edges: dict[Name, Points] = {}
    """Name -> the points (mm) of a line of mesh edges."""

    @model_validator(mode="after")
    def _one_source(self) -> Mesh:
        given = [key for key in ("file", "phantom", "solid") if getattr(self, key) is not None]
        if len(given) != 1:
            raise ValueError(
                f"give exactly one of 'file', 'phantom' and 'solid'; here is {given or 'none'}"
            )
        of_file = ("folder", "surfaces", "regions")
        idle = [key for key in of_file if self.file is None and getattr(self, key) is not None]
        if idle:
            raise ValueError(f"{idle} belong to a 'file'; here is a {given[0]!r}")
        if self.solid is None and self.parameters:
            raise ValueError(f"'parameters' belong to a solid; {given[0]!r} takes none")
        return self


class Material(Table):
    """The law of a region: linear elasticity where no `law` is named; see `case.laws`."""

    law: Literal[*LAW_NAMES] = "linear"  # type: ignore[valid-type]
    E: Finite | None = None
    """Young's modulus, MPa."""
    nu: Finite | None = None
    """Poisson's ratio; 0.5 is incompressible."""
    G: Finite | None = None
    """The shear modulus, MPa; with `kappa` in place of `E` and `nu`."""
    kappa: Annotated[float, Field(allow_inf_nan=True)] | None = None
    """The bulk modulus, MPa; inf is incompressible."""
    A: Finite | None = None
    """How fast a stiffening law stiffens."""
    measure: str | None = None
    """The size of a strain, of a stiffening law."""
    shears: str | None = None
    """Of the same: "tensor", or "engineering" as printed in the paper."""
    c1: Finite | None = None
    """MPa; of Mooney-Rivlin and Veronda-Westmann."""
    c2: Finite | None = None
    """MPa, or without unit; of the same."""
    mu: Annotated[tuple[Finite, ...], BeforeValidator(_tuple)] | None = None
    """MPa, one for each term of Ogden's law."""
    alpha: Annotated[tuple[Finite, ...], BeforeValidator(_tuple)] | None = None
    """The powers of these terms."""
    C: Finite | None = None
    """MPa; of Guccione's law."""
    bf: Finite | None = None
    """Of the same, along the fibres."""
    bt: Finite | None = None
    """Across them."""
    bfs: Finite | None = None
    """In shear along them."""
    fibre: Point | None = None
    """The direction of the fibres."""

    @model_validator(mode="after")
    def _made(self) -> Material:
        self.made()
        return self

    def made(self) -> bezsoma.mechanics.materials.Material:
        """The material itself, which checks its numbers."""
        stated = {key: getattr(self, key) for key in type(self).model_fields if key != "law"}
        given = {key: value for key, value in stated.items() if value is not None}
        return law_of(self.law, given)


class Fixed(Table):
    """Places held where they are."""

    type: Literal["fixed"]
    on: Names = Field(description="the places held")
    components: Components = "xyz"


class Moved(Table):
    """Places moved as a rigid body: turned about a line through `about`, then shifted."""

    type: Literal["moved"]
    on: Names = Field(description="the places moved")
    translation: Point = (0.0, 0.0, 0.0)
    axis: Point | None = None
    degrees: Finite = 0.0
    about: Point | None = None
    components: Components = "xyz"

    @model_validator(mode="after")
    def _whole_turn(self) -> Moved:
        if self.degrees and (self.axis is None or self.about is None):
            raise ValueError("a turn by 'degrees' needs its 'axis' and a point 'about' (mm)")
        if not self.degrees and (self.axis is not None or self.about is not None):
            raise ValueError("'axis' and 'about' belong to a turn; say by how many 'degrees'")
        return self


class Prescribed(Table):
    """Places given a displacement (mm), each component a number or a polynomial of x, y, z."""

    type: Literal["prescribed"]
    on: Names = Field(description="the places given a displacement")
    value: Formulas = Field(description="the displacement, mm: three numbers or polynomials")
    components: Components = "xyz"


class Precedence(Table):
    """Where two supports meet, one of them holds."""

    type: Literal["precedence"]
    place: Name = Field(description="the place that keeps its own displacement")
    over: Name = Field(description="the place that gives way where the two meet")


class Graded(Table):
    """Where two supports meet, the jump is spread over a band of one of them."""

    type: Literal["graded"]
    over: Name = Field(description="the place on which the band lies")
    to: Name = Field(description="the place whose displacement the band leads to")
    band: Positive = Field(description="the width of the band, mm")


class Gap(Table):
    """Where two supports meet, a strip of one of them is set free."""

    type: Literal["gap"]
    free: Name = Field(description="the place on which the strip is set free")
    at: Name = Field(description="the place beside which the strip lies")
    width: Positive = Field(description="the width of the strip, mm")


class Traction(Table):
    """Force per area (MPa) on surfaces."""

    type: Literal["traction"]
    on: Names = Field(description="the surfaces loaded")
    value: Formulas = Field(description="the traction, MPa: three numbers or polynomials")


class Pressure(Table):
    """Pressure p (MPa) on surfaces: the traction is -p n."""

    type: Literal["pressure"]
    on: Names = Field(description="the surfaces loaded")
    value: Formula = Field(description="the pressure, MPa: a number or a polynomial")
    following: bool = False
    """Whether it stays normal to the surface as that deforms."""


class BodyForce(Table):
    """Force per volume (N/mm3), everywhere or in some regions."""

    type: Literal["body"]
    value: Formulas = Field(description="the force, N/mm3: three numbers or polynomials")
    regions: Names | None = None


class PointForce(Table):
    """A force (N) at a vertex, named or given by its coordinates."""

    type: Literal["point"]
    at: Vertex = Field(description="a named vertex, or the coordinates of one, mm")
    force: Point = Field(description="the force, N: three numbers")


class Solver(Table):
    """How to solve."""

    method: Literal["auto", "direct", "multigrid", "cg", "saddle"] = "auto"
    """As `solver` of `bezsoma.solve`."""
    rtol: Annotated[float, Field(gt=0, lt=1)] | None = None
    """What the residual has to come down to, relative to that at zero."""
    steps: Steps = "auto"
    """Of the load, where the body is not linear: how many, their fractions, or "auto"."""
    iteration: Literal["newton", "modified", "secant"] = "newton"
    exactness: Annotated[int, Field(ge=0, le=40)] | None = None
    threads: Annotated[int, Field(ge=0, le=MOST_THREADS, description="0: all cores")] | None = None


class Refine(Table):
    """Refine the mesh, or raise the degree, until the error is small enough; see `refined`."""

    tolerance: Positive | None = None
    """The largest error of a displacement in `at`, mm."""
    at: Names | None = None
    """Probes and surfaces; all probes where not given, else the surface skin."""
    energy: Positive | None = None
    """The largest relative error in the energy norm."""
    by: Literal["mesh", "degree", "both"] = "mesh"
    most_unknowns: Annotated[int, Field(ge=1)] = MOST_UNKNOWNS
    most_seconds: Positive | None = None


class Error(Table):
    """How far the answer is from the truth: see `bezsoma.refinement.estimates`."""

    estimate: bool | None = None
    """Whether it is estimated; where not given, if that takes no more than a million unknowns."""
    radius: Positive = 3.0
    """Of the patch around a probe over which the displacement is averaged, mm; [refine] too."""
    components: Components | None = None
    """Of the displacement of a probe; where not given, all three."""


class Probe(Table):
    """A point to look at: coordinates (with `on`, the nearest point of that surface), a vertex."""

    name: Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_-]*$")] = Field(
        description="a word by which the point is called"
    )
    point: Vertex = Field(description="where it is, mm, or the name of a vertex")
    on: Name | None = None

    @model_validator(mode="after")
    def _one_way(self) -> Probe:
        if isinstance(self.point, str) and self.on is not None:
            raise ValueError("a named vertex lies where it lies; leave 'on' out")
        return self


class Expect(Table):
    """A number that the case must give: a value with a tolerance, or an interval."""

    of: Name = Field(description="the quantity, such as 'chin.y' or 'energy'")
    value: Finite | None = None
    tolerance: Positive | None = None
    relative: Positive | None = None
    between: Annotated[tuple[Finite, Finite], BeforeValidator(_pair)] | None = None
    degrees: Degrees | None = None
    """The degrees for which the number holds; all where not given."""
    source: str = Field(description="where the number comes from")

    @model_validator(mode="after")
    def _one_kind(self) -> Expect:
        tolerances = [self.tolerance, self.relative].count(None)
        by_value = self.value is not None and tolerances == 1 and self.between is None
        by_interval = self.between is not None and self.value is None and tolerances == 2
        if not (by_value or by_interval):
            raise ValueError(
                "give 'value' with one of 'tolerance' and 'relative', or 'between = [low, high]'"
            )
        if self.between is not None and self.between[0] > self.between[1]:
            raise ValueError(f"'between' runs from the smaller to the larger, not {self.between}")
        return self


class Output(Table):
    """What to write besides the net, the controls, the summary and a README."""

    vtu: bool = True
    """The displacement on curved cells, for other programs."""
    stress: bool = False
    """The Cauchy stress (MPa) in that file too."""
    pictures: Views = ("three-quarter", "front")
    """A sheet (before, after, how far it moved) for each of these views."""
    surface: Name | None = None
    """The surface that the pictures show; skin where there is one, else the whole boundary."""
    fields: Fields = ()
    """Further fields for the file of cells, and a picture of each from every view."""


class CaseFile(Table):
    """The whole file."""

    title: str = ""
    """For the summary and the pictures."""
    degree: Degree = Field(description="the degree of the displacement, 1 to 10")
    pressure_degree: Annotated[int, Field(ge=0, le=10)] | None = None
    """The degree of a pressure of its own (the mixed form)."""
    incompressible: bool = False
    """The mixed form with a pressure of one degree less."""
    pressure_breaks: bool = False
    """Whether the pressure may jump between regions."""
    split_held_tets: bool = False
    """Whether tets all four vertices of which are prescribed are cut in four."""
    mesh: Mesh = Field(description="the table [mesh] says where the tets come from")
    materials: dict[Name, Material] = Field(
        min_length=1, description="a table [materials.REGION] for each region of the mesh"
    )
    support: list[Annotated[Fixed | Moved | Prescribed, Field(discriminator="type")]] = []
    join: list[Annotated[Precedence | Graded | Gap, Field(discriminator="type")]] = []
    load: list[
        Annotated[Traction | Pressure | BodyForce | PointForce, Field(discriminator="type")]
    ] = []
    solver: Solver = Solver()
    refine: Refine | None = None
    error: Error = Error()
    probe: list[Probe] = []
    expect: list[Expect] = []
    output: Output = Output()
