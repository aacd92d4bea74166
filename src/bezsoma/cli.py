# SPDX-License-Identifier: BSD-3-Clause
"""The commands: `bezsoma model`, `run`, `demo`, `picture`, `film`, `experiment` and `mesh info`.

Exit status: 0 all is well; 1 the computation did not converge, or an expectation of the case or a
tolerance was not met; 2 the input cannot be used; 130 stopped by Ctrl-C.
"""

from __future__ import annotations

import signal
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from importlib.metadata import version
from pathlib import Path
from types import FrameType
from typing import Annotated, Any, Literal

from cyclopts import App, CycloptsError, Parameter

from bezsoma.errors import BezSomaError, InputError, MissingExtra

DONE, FAILED, REFUSED, STOPPED = 0, 1, 2, 130

app = App(
    name="bezsoma",
    version=lambda: f"bezsoma {version('bezsoma')}",
    help_format="plaintext",
    help="""BezSoma predicts how a face follows when jaw bones are moved.

Start with: bezsoma demo

Then make a model from a CT of your own: bezsoma model CT -o model
and run the case in it, or one that you wrote: bezsoma run case.toml

Research software, not a medical device.""",
)
mesh_app = App(name="mesh", help="Look at meshes.", help_format="plaintext")
app.command(mesh_app)

OUTPUT = ("--output", "-o")
Overwrite = Annotated[
    bool, Parameter("--overwrite", negative="", help="replace results that stand there already")
]
Quiet = Annotated[
    bool, Parameter(("--quiet", "-q"), negative="", help="show no progress, only what came out")
]


@app.command
def run(
    case: Path,
    /,
    *,
    output: Annotated[
        Path | None,
        Parameter(
            OUTPUT, help="the folder to make for the results; where not given, CASE-degree-N"
        ),
    ] = None,
    degree: Annotated[int | None, Parameter(help="instead of the degree in the case")] = None,
    tolerance: Annotated[
        float | None,
        Parameter(
            help="refine until the estimated error of the displacement, around the probes or "
            "wherever [refine] says, is below so many mm"
        ),
    ] = None,
    keep_last: Annotated[
        Path | None,
        Parameter(
            help="where no equilibrium is found under the whole load: the folder to make for the "
            "last state in balance, marked as no answer"
        ),
    ] = None,
    overwrite: Overwrite = False,
    quiet: Quiet = False,
) -> int:
    """Solve a case and leave its results in a folder.

    Parameters
    ----------
    case
        the case, a TOML file: see docs/case_file.md; `bezsoma demo` leaves one, case.toml
    """
    from bezsoma.case import read_case, run_case
    from bezsoma.progress import shown

    read = read_case(case)
    degree = read.file.degree if degree is None else degree
    folder = output or Path(f"{case.stem}-degree-{degree}")
    with shown(quiet=quiet) as progress:
        results = run_case(
            read,
            folder,
            overwrite=overwrite,
            degree=degree,
            tolerance=tolerance,
            keep_last=keep_last,
            progress=progress,
        )
    return _told(results, folder)


@app.command
def model(
    ct: Path,
    /,
    *,
    output: Annotated[
        Path, Parameter(OUTPUT, help="the folder to make for the model, or to go on with")
    ] = Path("model"),
    settings: Annotated[
        Path | None, Parameter(help="a TOML file, such as the model.toml of another model")
    ] = None,
    segmentation: Annotated[
        Path | None, Parameter(help="masks named bone, mandible or skin, as 3D Slicer saves them")
    ] = None,
    tets: Annotated[int | None, Parameter(help="about how many, instead of 80000")] = None,
    overwrite: Overwrite = False,
    quiet: Quiet = False,
) -> int:
    """Make labels, a mesh with named surfaces, pictures and a ready case from a CT of a head.

    Stopped, it goes on where it ended when given the same again.

    Parameters
    ----------
    ct
        a folder of DICOM slices, or a .nrrd, .nii, .nii.gz, .mha or .mhd file, in Hounsfield units
    """
    from dataclasses import replace

    from bezsoma.model import ModelSettings, read_settings, run_model
    from bezsoma.model.readme import described
    from bezsoma.progress import shown

    chosen = ModelSettings() if settings is None else read_settings(settings)
    chosen = chosen if tets is None else replace(chosen, tets=tets)
    with shown(quiet=quiet) as progress:
        made = run_model(
            ct, output, chosen, segmentation=segmentation, overwrite=overwrite, progress=progress
        )
    for note in made.notes:
        print(note)
    print(described(made.report))
    print(f"model in {output}: look at {output / 'labels.png'}, then {output / 'mesh.png'}")
    print(f"then: bezsoma run {output / 'case.toml'}")
    return DONE


@app.command
def demo(
    *,
    size: Annotated[
        Literal["small", "large"],
        Parameter(help="how fine the CT and the mesh are; small takes a minute"),
    ] = "large",
    degree: Annotated[int, Parameter(help="the degree of the displacement")] = 3,
    output: Annotated[
        Path | None,
        Parameter(
            OUTPUT, help="the folder to make for the results; where not given, bezsoma-demo-SIZE"
        ),
    ] = None,
    overwrite: Overwrite = False,
    quiet: Quiet = False,
) -> int:
    """The whole way: a CT of a head made by formula, labels, mesh, its jaw moved, its face.

    The case.toml in its folder `model` is an example to change and give to `bezsoma run`.
    """
    from bezsoma.demo import HEAD, MODEL, run_demo
    from bezsoma.progress import shown

    folder = output or Path(f"bezsoma-demo-{size}")
    with shown(quiet=quiet) as progress:
        results = run_demo(size, folder, overwrite=overwrite, degree=degree, progress=progress)
    status = _told(results, results.folder)
    print(f"the whole head, before and after: {folder / HEAD}")
    print(f"to go on, change a copy of {folder / MODEL / 'case.toml'} and give it to: bezsoma run")
    return status


Folder = Annotated[Path, Parameter(help="the folder that `bezsoma run` or `demo` wrote")]
View = Annotated[
    str | None,
    Parameter(
        help="front, back, left, right, top, bottom, three-quarter, 'three-quarter left'; where "
        "not given, along the axis of a slice, else three-quarter"
    ),
]
OneField = Annotated[
    str,
    Parameter(
        help="what the colour shows: displacement, displacement_x (_y, _z), pressure, stress (von "
        "Mises), stress_xx (_yy, _zz, _xy, _yz, _zx), tension, divergence, determinant, none"
    ),
]
Surface = Annotated[
    str | None, Parameter(help="the surface that matters; skin where there is one, else all")
]
Through = Annotated[
    str | None, Parameter(help="a surface that is seen through, as skin, to what lies behind")
]
Times = Annotated[float, Parameter(help="how many times the displacement is drawn")]


@app.command
def picture(
    results: Folder,
    /,
    *,
    field: OneField = "displacement",
    view: View = None,
    slice: Annotated[
        str | None, Parameter(help="cut the body open at x=12.5, y=-3 or z=0 (mm), as it is drawn")
    ] = None,
    carried: Annotated[
        bool, Parameter(negative="", help="cut before it moves; the cut moves along")
    ] = False,
    over: Annotated[
        str | None, Parameter(help="original: draw the mesh before the move over it")
    ] = None,
    translucent: Through = None,
    surface: Surface = None,
    net: Annotated[bool, Parameter(negative="", help="draw the control net")] = False,
    wires: Annotated[bool, Parameter(negative="", help="draw the edges of the mesh")] = False,
    magnified: Times = 1.0,
    output: Annotated[
        Path | None,
        Parameter(OUTPUT, help="the PNG to write; where not given, RESULTS-FIELD-VIEW.png"),
    ] = None,
    overwrite: Annotated[bool, Parameter(negative="", help="replace that file")] = False,
) -> int:
    """Draw a field of a results folder, whole or cut open.

    A picture is evaluated from the polynomials of the solution, and needs no display.
    """
    from bezsoma.case.showing import results_picture, view_of

    seen = view_of(slice) if view is None else view
    path = output or Path(f"{results.resolve().name}-{field}-{seen.replace(' ', '-')}.png")
    with _replaceable():
        results_picture(
            path,
            results,
            field=None if field == "none" else field,
            view=seen,
            plane=slice,
            carried=carried,
            over=over,
            translucent=translucent,
            surface=surface,
            net=net,
            wires=wires,
            magnified=magnified,
            overwrite=overwrite,
        )
    print(path)
    return DONE


@app.command
def film(
    results: Folder,
    /,
    *,
    field: OneField = "none",
    view: View = None,
    translucent: Through = None,
    surface: Surface = None,
    magnified: Times = 1.0,
    turn: Annotated[
        float, Parameter(help="degrees to walk around: 360 once, less to and fro, 0 not at all")
    ] = 360.0,
    frames: Annotated[int, Parameter(help="pictures in the film")] = 36,
    seconds: Annotated[float, Parameter(help="how long it lasts")] = 4.5,
    output: Annotated[
        Path | None,
        Parameter(
            OUTPUT, help="the .gif, or with the extra film the .mp4, to write; else RESULTS.gif"
        ),
    ] = None,
    overwrite: Annotated[bool, Parameter(negative="", help="replace that file")] = False,
    quiet: Quiet = False,
) -> int:
    """Film the movement in a results folder, as an animated GIF or an MP4.

    The movement goes to and fro while the viewer walks around.
    """
    from bezsoma.case.showing import results_film
    from bezsoma.progress import shown

    path = output or Path(f"{results.resolve().name}.gif")
    with _replaceable(), shown(quiet=quiet) as progress:
        results_film(
            path,
            results,
            field=None if field == "none" else field,
            view=view or "three-quarter",
            translucent=translucent,
            surface=surface,
            magnified=magnified,
            turn=turn,
            frames=frames,
            seconds=seconds,
            overwrite=overwrite,
            progress=lambda done, all_: progress("film", done / all_, f"frame {done + 1}"),
        )
    print(path)
    return DONE


@app.command
def experiment(
    name: Annotated[str | None, Parameter(show=True)] = None,
    /,
    *,
    output: Annotated[
        Path | None,
        Parameter(OUTPUT, help="the folder to make; where not given, bezsoma-experiment-NAME"),
    ] = None,
    quick: Annotated[
        bool, Parameter(negative="", help="a few of the numbers, in seconds; no page, no pictures")
    ] = False,
    overwrite: Overwrite = False,
) -> int:
    """Run a figure of the paper anew: numbers, pictures, and a page about both.

    Parameters
    ----------
    name
        which one; without a name they are listed
    """
    from bezsoma.experiments.run import EXPERIMENTS, run_experiment

    if name is None:
        print("\n".join(f"{each:<16}{about}" for each, about in EXPERIMENTS.items()))
        return DONE
    folder = output or Path(f"bezsoma-experiment-{name.replace('_', '-')}")
    files = run_experiment(name, folder, overwrite=overwrite, quick=quick)
    print(f"results in {folder}: look at {files[-1]}")
    return DONE


@mesh_app.command
def info(
    file: Path,
    /,
    *,
    surfaces: Annotated[
        str | None, Parameter(help="names for the tags of surfaces, as in skin=1,jaw=3")
    ] = None,
    regions: Annotated[
        str | None, Parameter(help="names for the tags of regions, as in fat=1,muscle=2")
    ] = None,
) -> int:
    """Say what is in a mesh file: sizes, named surfaces, and how good the tets are.

    Parameters
    ----------
    file
        a mesh of tets: .npz, .vtu, .vtk, .msh, .inp, .mesh and what else meshio reads
    """
    from bezsoma.mesh.files import read_mesh
    from bezsoma.mesh_info import mesh_report

    outer = None if surfaces is None else tags_named(surfaces, "--surfaces")
    inner = None if regions is None else tags_named(regions, "--regions")
    for line in mesh_report(read_mesh(file, surfaces=outer, regions=inner)):
        print(line)
    return DONE


def tags_named(text: str, option: str) -> dict[str, int]:
    """The tags that `--surfaces` or `--regions` names.

    >>> tags_named("skin=1, jaw=3", "--surfaces")
    {'skin': 1, 'jaw': 3}
    """
    tags: dict[str, int] = {}
    for entry in text.split(","):
        name, equals, tag = (part.strip() for part in entry.partition("="))
        if not (name and equals and tag.lstrip("-").isdigit()):
            example = "fat=1,muscle=2" if option == "--regions" else "skin=1,jaw=3"
            raise InputError(f"{option}: {entry!r} is no name with a tag; write {example}")
        if name in tags:
            raise InputError(f"{option}: {name!r} is named twice; give each tag a name of its own")
        tags[name] = int(tag)
    return tags


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; the exit status. Every refusal is a sentence on stderr, no traceback."""
    words = list(sys.argv[1:] if arguments is None else arguments)
    try:
        with _terminable():
            command, bound, *_ = app.parse_args(words, print_error=False, exit_on_error=False)
            status: Any = command(*bound.args, **bound.kwargs)
            return status if isinstance(status, int) else DONE
    except CycloptsError as error:
        return _refused(f"{str(error).rstrip('.')}; see bezsoma --help")
    except (InputError, MissingExtra) as error:
        return _refused(str(error))
    except BezSomaError as error:
        return _refused(str(error), FAILED)
    except BrokenPipeError:
        return FAILED
    except KeyboardInterrupt:
        return _refused("stopped; nothing half-done was left behind", STOPPED)


def _told(results: Any, folder: Path) -> int:
    """Say what came out and where to look; the status by the expectations of the case."""
    from bezsoma.case.expectations import unmet
    from bezsoma.case.readme import error_told, levels_table, motion_table

    summary = results.summary
    print(summary["notice"])
    if table := motion_table(summary["probes"]):
        print(table)
    if error := error_told(summary):
        print(error)
    if levels := levels_table(summary):
        print(levels)
    checks = summary["expectations"]
    failures = list(unmet(checks))
    for sentence in (*summary["warnings"], *failures):
        print(f"bezsoma: {sentence}", file=sys.stderr)
    if checks:
        print(f"{len(checks) - len(failures)} of {len(checks)} expected numbers were met")
    readme = folder / "README.txt"
    first = [str(folder / name) for name in summary["pictures"][:1]]
    print(f"results in {folder}: look at {', then '.join([*first, str(readme)])}")
    short = not summary.get("refinement", {"reached": True})["reached"]
    return FAILED if failures or short else DONE


def _refused(message: str, status: int = REFUSED) -> int:
    print(f"bezsoma: {message}", file=sys.stderr)
    return status


@contextmanager
def _replaceable() -> Iterator[None]:
    """Says of a file that stands in the way how to replace it from here."""
    try:
        yield
    except InputError as error:
        raise InputError(str(error).replace("say overwrite=True", "say --overwrite")) from None


@contextmanager
def _terminable() -> Iterator[None]:
    """Being terminated unwinds as Ctrl-C does, so that nothing half-written stays."""

    def stop(number: int, frame: FrameType | None) -> None:
        raise KeyboardInterrupt

    try:
        before = signal.signal(signal.SIGTERM, stop)
    except ValueError:
        yield
        return
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


if __name__ == "__main__":
    sys.exit(main())
