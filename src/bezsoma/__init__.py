# SPDX-License-Identifier: BSD-3-Clause
"""BezSoma predicts how a face follows when jaw bones are moved.

Everything a script needs is named here: `import bezsoma as bz`. A name is imported when it is
first used, so that `import bezsoma` and `bezsoma --version` do not wait for a ray tracer.

Lengths are millimetres, forces newtons, moduli megapascals, angles radians; frames are LPS (x to
the patient's left, y to posterior, z to superior). Research software, not a medical device.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

__version__: str
"""The version of the installed package."""

if TYPE_CHECKING:
    from bezsoma.case import Case as Case
    from bezsoma.case import read_case as read_case
    from bezsoma.case import run_case as run_case
    from bezsoma.case.showing import results_film as results_film
    from bezsoma.case.showing import results_picture as results_picture
    from bezsoma.equations.locked import unlocked as unlocked
    from bezsoma.errors import BezSomaError as BezSomaError
    from bezsoma.errors import InputError as InputError
    from bezsoma.errors import MeshError as MeshError
    from bezsoma.errors import MissingExtra as MissingExtra
    from bezsoma.errors import NotConverged as NotConverged
    from bezsoma.imaging.phantom import head_phantom as head_phantom
    from bezsoma.mechanics.body import Body as Body
    from bezsoma.mechanics.hyperelastic import Guccione as Guccione
    from bezsoma.mechanics.hyperelastic import MooneyRivlin as MooneyRivlin
    from bezsoma.mechanics.hyperelastic import NeoHooke as NeoHooke
    from bezsoma.mechanics.hyperelastic import Ogden as Ogden
    from bezsoma.mechanics.hyperelastic import StVenantKirchhoff as StVenantKirchhoff
    from bezsoma.mechanics.hyperelastic import VerondaWestmann as VerondaWestmann
    from bezsoma.mechanics.joins import Gap as Gap
    from bezsoma.mechanics.joins import Graded as Graded
    from bezsoma.mechanics.joins import Precedence as Precedence
    from bezsoma.mechanics.laws import FunctionLaw as FunctionLaw
    from bezsoma.mechanics.loads import BodyForce as BodyForce
    from bezsoma.mechanics.loads import PointForce as PointForce
    from bezsoma.mechanics.loads import Pressure as Pressure
    from bezsoma.mechanics.loads import Traction as Traction
    from bezsoma.mechanics.materials import LinearElastic as LinearElastic
    from bezsoma.mechanics.polynomial import Polynomial as Polynomial
    from bezsoma.mechanics.stiffening import Stiffening as Stiffening
    from bezsoma.mechanics.supports import Fixed as Fixed
    from bezsoma.mechanics.supports import Moved as Moved
    from bezsoma.mechanics.supports import Prescribed as Prescribed
    from bezsoma.mesh.broken_field import BrokenField as BrokenField
    from bezsoma.mesh.control_net import ControlNet as ControlNet
    from bezsoma.mesh.field import Field as Field
    from bezsoma.mesh.files import read_mesh as read_mesh
    from bezsoma.mesh.files import write_mesh as write_mesh
    from bezsoma.mesh.isolines import isolines as isolines
    from bezsoma.mesh.levels import contour as contour
    from bezsoma.mesh.levels import slice_of as slice_of
    from bezsoma.mesh.lines import line_through as line_through
    from bezsoma.mesh.planes import Plane as Plane
    from bezsoma.mesh.solids import ball as ball
    from bezsoma.mesh.solids import block as block
    from bezsoma.mesh.split import split as split
    from bezsoma.mesh.subdivision import Subdivision as Subdivision
    from bezsoma.mesh.subdivision import subdivision as subdivision
    from bezsoma.mesh.tets import TetMesh as TetMesh
    from bezsoma.model import ModelSettings as ModelSettings
    from bezsoma.model import run_model as run_model
    from bezsoma.refinement.estimates import energy_estimate as energy_estimate
    from bezsoma.refinement.estimates import goal_estimate as goal_estimate
    from bezsoma.refinement.estimates import vector_estimate as vector_estimate
    from bezsoma.refinement.goals import InnerMean as InnerMean
    from bezsoma.refinement.goals import PatchMean as PatchMean
    from bezsoma.refinement.goals import SurfaceMean as SurfaceMean
    from bezsoma.refinement.levels import Refined as Refined
    from bezsoma.refinement.loop import refined as refined
    from bezsoma.results import Results as Results
    from bezsoma.results import read_results as read_results
    from bezsoma.solvers.solution import Solution as Solution
    from bezsoma.solvers.solve import solve as solve
    from bezsoma.view.convergence import convergence_picture as convergence_picture
    from bezsoma.view.film import film as film
    from bezsoma.view.history import history_picture as history_picture
    from bezsoma.view.named import head_picture as head_picture
    from bezsoma.view.named import mesh_picture as mesh_picture
    from bezsoma.view.picture import face_picture as face_picture
    from bezsoma.view.picture import picture as picture
    from bezsoma.view.picture import side_by_side as side_by_side
    from bezsoma.view.shot import Shot as Shot
    from bezsoma.view.tessellation import tessellation as tessellation
    from bezsoma.view.vtk import write_vtu as write_vtu
    from bezsoma.view.vtkhdf import write_vtkhdf as write_vtkhdf
    from bezsoma.view.window import show as show

HOMES = {
    "bezsoma.case": ["Case", "read_case", "run_case"],
    "bezsoma.equations.locked": ["unlocked"],
    "bezsoma.errors": ["BezSomaError", "InputError", "MeshError", "MissingExtra", "NotConverged"],
    "bezsoma.imaging.phantom": ["head_phantom"],
    "bezsoma.mechanics.body": ["Body"],
    "bezsoma.mechanics.hyperelastic": [
        "Guccione",
        "MooneyRivlin",
        "NeoHooke",
        "Ogden",
        "StVenantKirchhoff",
        "VerondaWestmann",
    ],
    "bezsoma.mechanics.joins": ["Gap", "Graded", "Precedence"],
    "bezsoma.mechanics.laws": ["FunctionLaw"],
    "bezsoma.mechanics.loads": ["BodyForce", "PointForce", "Pressure", "Traction"],
    "bezsoma.mechanics.materials": ["LinearElastic"],
    "bezsoma.mechanics.stiffening": ["Stiffening"],
    "bezsoma.mechanics.supports": ["Fixed", "Moved", "Prescribed"],
    "bezsoma.mechanics.polynomial": ["Polynomial"],
    "bezsoma.mesh.control_net": ["ControlNet"],
    "bezsoma.mesh.broken_field": ["BrokenField"],
    "bezsoma.mesh.field": ["Field"],
    "bezsoma.mesh.files": ["read_mesh", "write_mesh"],
    "bezsoma.mesh.solids": ["ball", "block"],
    "bezsoma.mesh.split": ["split"],
    "bezsoma.mesh.subdivision": ["Subdivision", "subdivision"],
    "bezsoma.mesh.tets": ["TetMesh"],
    "bezsoma.refinement.estimates": ["energy_estimate", "goal_estimate", "vector_estimate"],
    "bezsoma.refinement.goals": ["InnerMean", "PatchMean", "SurfaceMean"],
    "bezsoma.refinement.levels": ["Refined"],
    "bezsoma.refinement.loop": ["refined"],
    "bezsoma.model": ["ModelSettings", "run_model"],
    "bezsoma.results": ["Results", "read_results"],
    "bezsoma.solvers.solution": ["Solution"],
    "bezsoma.solvers.solve": ["solve"],
    "bezsoma.view.history": ["history_picture"],
    "bezsoma.view.tessellation": ["tessellation"],
    "bezsoma.view.picture": ["face_picture", "picture", "side_by_side"],
    "bezsoma.case.showing": ["results_film", "results_picture"],
    "bezsoma.mesh.isolines": ["isolines"],
    "bezsoma.mesh.levels": ["contour", "slice_of"],
    "bezsoma.mesh.lines": ["line_through"],
    "bezsoma.mesh.planes": ["Plane"],
    "bezsoma.view.convergence": ["convergence_picture"],
    "bezsoma.view.film": ["film"],
    "bezsoma.view.shot": ["Shot"],
    "bezsoma.view.window": ["show"],
    "bezsoma.view.named": ["head_picture", "mesh_picture"],
    "bezsoma.view.vtk": ["write_vtu"],
    "bezsoma.view.vtkhdf": ["write_vtkhdf"],
}
"""Module -> the public names that live in it."""

HOME_OF = {name: module for module, names in HOMES.items() for name in names}

__all__ = ["__version__", *HOME_OF]


def __getattr__(name: str) -> Any:
    """The public name, imported on first use (PEP 562)."""
    if name == "__version__":
        from importlib.metadata import version

        return version("bezsoma")
    if name not in HOME_OF:
        raise AttributeError(f"module 'bezsoma' has no attribute {name!r}")
    value = globals()[name] = getattr(import_module(HOME_OF[name]), name)
    return value


def __dir__() -> list[str]:
    """All public names, imported yet or not, for completion at the prompt."""
    return sorted({*globals(), *__all__})
