# SPDX-License-Identifier: BSD-3-Clause
"""The commands: `bezsoma run`, `bezsoma demo`, `bezsoma mesh info`.

Exit status: 0 all is well; 1 the computation did not converge or an expectation of the case was
not met; 2 the input cannot be used; 130 stopped by Ctrl-C.
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

Then write a case of your own and give it to: bezsoma run case.toml

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
        results = run_case(read, folder, overwrite=overwrite, degree=degree, progress=progress)
    return _told(results, folder)


@app.command
def demo(
    *,
    size: Annotated[
        Literal["small", "medium", "large"],
        Parameter(help="how fine the head is; small takes seconds, large about half a minute"),
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
    """Move the jaw of a built-in head 6 mm forward and look at its face.

    The case.toml among the results is an example to change and give to `bezsoma run`.
    """
    from bezsoma.demo import run_demo
    from bezsoma.progress import shown

    folder = output or Path(f"bezsoma-demo-{size}")
    with shown(quiet=quiet) as progress:
        results = run_demo(size, folder, overwrite=overwrite, degree=degree, progress=progress)
    status = _told(results, folder)
    print(f"to go on, change a copy of {folder / 'case.toml'} and give it to: bezsoma run")
    return status


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
            raise InputError(f"{option}: {entry!r} is no name with a tag; write skin=1,jaw=3")
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
        return _refused("stopped; nothing was left behind", STOPPED)


def _told(results: Any, folder: Path) -> int:
    """Say what came out and where to look; the status by the expectations of the case."""
    from bezsoma.case.expectations import unmet
    from bezsoma.case.readme import motion_table

    summary = results.summary
    print(summary["notice"])
    if table := motion_table(summary["probes"]):
        print(table)
    checks = summary["expectations"]
    failures = list(unmet(checks))
    for sentence in (*summary["warnings"], *failures):
        print(f"bezsoma: {sentence}", file=sys.stderr)
    if checks:
        print(f"{len(checks) - len(failures)} of {len(checks)} expected numbers were met")
    readme = folder / "README.txt"
    first = [str(folder / name) for name in summary["pictures"][:1]]
    print(f"results in {folder}: look at {', then '.join([*first, str(readme)])}")
    return FAILED if failures else DONE


def _refused(message: str, status: int = REFUSED) -> int:
    print(f"bezsoma: {message}", file=sys.stderr)
    return status


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
