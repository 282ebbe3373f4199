"""The command `railhead`, and the same options for `python cases/<case>.py`."""

from __future__ import annotations

import io
import shutil
import sys
import textwrap
import time
from collections.abc import Sequence
from contextlib import redirect_stdout
from pathlib import Path

import click

from railhead import __version__
from railhead.run import process
from railhead.scene import catalogue
from railhead.scene.scene import Scene, SceneError

SOLVED, CHECK_FAILED, WRONG_INPUT = 0, 1, 2
PROCESSES = click.IntRange(1)
PROCESSES.name = "number of processes; give a whole number from 1 on"
ALIKE = ("list", "plan", "locate", "profile")  # done by all processes of MPI, said by the first

_set = click.option(
    "--set", "assignments", multiple=True, metavar="KEY=VALUE", help="Change a key of the scene."
)
_with = click.option(
    "--with", "switched_on", multiple=True, metavar="NAME", help="Simulate this effect."
)
_without = click.option(
    "--without", "switched_off", multiple=True, metavar="NAME", help="Leave this effect out."
)


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__)
@click.pass_context
def railhead(context: click.Context) -> None:
    """Wheel-rail contact by finite elements, held against exact Hertz."""
    if context.invoked_subcommand in ALIKE and process.rank() > 0:
        context.with_resource(redirect_stdout(io.StringIO()))


@railhead.command("list")
def list_cases() -> None:
    """List the cases that ship."""
    width = shutil.get_terminal_size().columns
    for name, text in catalogue.shipped().items():
        click.echo(textwrap.fill(f"{name:24s} {text}", width, subsequent_indent=25 * " "))


@railhead.command()
@click.argument("case")
@_set
@_with
@_without
@click.option("--accuracy", help="Asked accuracy, e.g. 1%.")
@click.option("--json", "as_json", is_flag=True, help="Print the plan as JSON and nothing else.")
def plan(
    case: str,
    assignments: Sequence[str],
    switched_on: Sequence[str],
    switched_off: Sequence[str],
    accuracy: str | None,
    as_json: bool,
) -> None:
    """Say what would be simulated and what it costs; solve nothing."""
    from railhead import api
    from railhead.results import result_folder
    from railhead.results.report import terminal

    scene = _scene(case, assignments, switched_on, switched_off)
    planned = api.plan(scene, accuracy=accuracy, quiet=as_json)
    if as_json:
        click.echo(result_folder.to_json(planned.plan.to_dict()), nl=False)
    else:
        planned.show(terminal.standard())


@railhead.command()
@click.argument("case")
@_set
@_with
@_without
@click.option("--accuracy", help="Asked accuracy, e.g. 1%.")
@click.option("--budget", help="Best accuracy for that time, e.g. 30s.")
@click.option("--out", type=click.Path(path_type=Path), help="Result folder [results/<case>].")
@click.option("--no-pictures", is_flag=True, help="Write no PNG files and no report.html.")
@click.option("--no-report", is_flag=True, help="Write no report.html.")
@click.option("--whole", is_flag=True, help="Write .vtu files of the whole model, mirrored.")
@click.option("--units", help="Of the table and the report, e.g. mm,kN,MPa.")
@click.option("--ranks", type=PROCESSES, help="Processes [as many as pay].")
@click.option("--quiet", is_flag=True, help="Print only what fails.")
@click.option("--json", "as_json", is_flag=True, help="Print summary.json and nothing else.")
@click.pass_obj
def run(
    arguments: Sequence[str],
    case: str,
    assignments: Sequence[str],
    switched_on: Sequence[str],
    switched_off: Sequence[str],
    accuracy: str | None,
    budget: str | None,
    out: Path | None,
    no_pictures: bool,
    no_report: bool,
    whole: bool,
    units: str | None,
    ranks: int | None,
    quiet: bool,
    as_json: bool,
) -> int:
    """Solve a case (its name, or a TOML file) and compare it with exact Hertz."""
    from railhead.results import result_folder
    from railhead.results.report.output_units import Units

    shown = Units.parse(units)
    scene = _scene(case, assignments, switched_on, switched_off)
    folder = out if out is not None else Path("results") / scene.name
    result_folder.check_folder(folder)

    from railhead import api
    from railhead.cli import launch
    from railhead.planning import budget as budgets
    from railhead.planning import plan as planning
    from railhead.planning.cost import machine

    start = time.perf_counter()
    planned = planning.make(api.with_accuracy(scene, accuracy, budget))
    if not process.started():
        budgets.check_memory(planned, machine.free_memory())
        count = ranks or launch.suited(planned)
        if count > 1:
            launch.restart(count, arguments)

    from railhead.results import pipeline
    from railhead.results.report import tables, terminal
    from railhead.run import refinement

    quiet = quiet or as_json
    with refinement.telling(quiet=quiet, since=start) as progress:
        result = pipeline.solve(planned, progress)
    first, problem = result.mesh.comm.rank == 0, None
    with refinement.telling(quiet=quiet, since=start) as progress:
        progress.stage("writing files" + ("" if no_pictures else " and pictures"))
        try:
            result.save(
                folder, pictures=not no_pictures, report=not no_report, whole=whole, units=shown
            )
        except OSError as error:
            problem = error
    if first:
        if not result.passed:
            tables.show_failure(result.summary, terminal.errors())
        if as_json:
            click.echo(result_folder.as_json(result), nl=False)
        elif not quiet:
            result.show(terminal.standard(), shown)
        if problem is not None:
            _not_written(problem)
        elif not quiet:
            click.echo(f"written to {folder}/")
    return SOLVED if result.passed and problem is None else CHECK_FAILED


@railhead.command()
@click.argument("case")
@click.option(
    "--over",
    "lists",
    multiple=True,
    required=True,
    metavar="KEY=VALUES",
    help="Values of a key: 25kN,50kN or first:last:step, 0:10:0.5mm.",
)
@_set
@_with
@_without
@click.option("--out", type=click.Path(path_type=Path), help="Folder [results/<case>_sweep].")
@click.option("--resume", is_flag=True, help="Go on with the sweep that is in the folder.")
@click.option("--vtu", is_flag=True, help="Write .vtu files of each combination, for ParaView.")
@click.option("--no-pictures", is_flag=True, help="Write no PNG files.")
@click.option("--quiet", is_flag=True, help="Print only what fails.")
def sweep(
    case: str,
    lists: Sequence[str],
    assignments: Sequence[str],
    switched_on: Sequence[str],
    switched_off: Sequence[str],
    out: Path | None,
    resume: bool,
    vtu: bool,
    no_pictures: bool,
    quiet: bool,
) -> int:
    """Solve a case for every combination of values, side by side."""
    from railhead.results import result_folder
    from railhead.sweeps.grid import ParameterGrid, parse_values

    scene, values = _scene(case, assignments, switched_on, switched_off), parse_values(lists)
    grid = ParameterGrid.combine(scene, values)
    grid.refuse_duplicates()
    folder = out if out is not None else Path("results") / f"{scene.name}_sweep"
    result_folder.check_folder(folder)

    from railhead.sweeps import parallel, sweep_table

    task = parallel.ParallelSweep(grid=grid, folder=folder, vtu=vtu)
    status = parallel.run(task, resume=resume, pictures=not no_pictures, quiet=quiet)
    if status is None:  # a rank that worked for the first one
        return SOLVED
    failed = {number: text for number, text in status.items() if text != sweep_table.PASSED}
    for number, text in failed.items():
        click.echo(f"{grid.label(number)}: {text}", err=True)
    if not quiet:
        verdict = f"{len(failed)} not passed" if failed else "all passed"
        click.echo(f"{len(status)} combinations, {verdict}")
        click.echo(f"written to {folder}/")
    return CHECK_FAILED if failed else SOLVED


@railhead.command()
@click.argument("case")
@_set
@click.option("--shift", help="Lateral shift of the wheelset, e.g. 3mm.")
@click.option("--yaw", help="Yaw of the wheelset, e.g. 2mrad.")
@click.option("--out", type=click.Path(path_type=Path), help="Folder [results/<case>_locate].")
@click.option("--no-pictures", is_flag=True, help="Write nothing.")
@click.option("--json", "as_json", is_flag=True, help="Print the summary and nothing else.")
def locate(
    case: str,
    assignments: Sequence[str],
    shift: str | None,
    yaw: str | None,
    out: Path | None,
    no_pictures: bool,
    as_json: bool,
) -> None:
    """Find where both wheels of a wheelset touch their rails; solve nothing."""
    from railhead.cli import locate as locating
    from railhead.results import result_folder
    from railhead.results.report import terminal

    options = {"wheelset.shift": shift, "wheelset.yaw": yaw}
    asked = [f"{key}={value}" for key, value in options.items() if value is not None]
    scene = catalogue.find(case).replace([*assignments, *asked])
    folder = out if out is not None else Path("results") / f"{scene.name}_locate"
    result_folder.check_folder(folder)
    location = locating.locate(scene)
    if not no_pictures:
        locating.write(location, folder)
    if as_json:
        click.echo(locating.as_json(location), nl=False)
        return
    locating.show(location, terminal.standard())
    if not no_pictures:
        click.echo(f"written to {folder}/")


@railhead.command()
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--body", type=click.Choice(["rail", "wheel"]), help="Whose profile it is.")
@_set
@click.option("--out", type=click.Path(path_type=Path), help="Folder [results/<file>_profile].")
@click.option("--no-pictures", is_flag=True, help="Write nothing.")
@click.option("--json", "as_json", is_flag=True, help="Print the summary and nothing else.")
def profile(
    file: Path,
    body: str | None,
    assignments: Sequence[str],
    out: Path | None,
    no_pictures: bool,
    as_json: bool,
) -> None:
    """Read and smooth a measured profile, and say what is worn off it; solve nothing."""
    from railhead.cli import examine_profile as profiling
    from railhead.results import result_folder
    from railhead.results.report import terminal

    folder = out if out is not None else Path("results") / f"{file.stem}_profile"
    result_folder.check_folder(folder)
    examined = profiling.examine(file, body, assignments)
    if not no_pictures:
        profiling.write(examined, folder)
    if as_json:
        click.echo(profiling.as_json(examined), nl=False)
        return
    profiling.show(examined, terminal.standard())
    if not no_pictures:
        click.echo(f"written to {folder}/")


@railhead.command()
@click.argument("name", required=False)
@click.option("--out", type=click.Path(path_type=Path), help="Folder [results/<study>].")
@click.option("--quick", is_flag=True, help="Only a small part of the study.")
@click.option("--install", is_flag=True, help="First install the programs that `peers` measures.")
def study(name: str | None, out: Path | None, quick: bool, install: bool) -> None:
    """Run a study: CSV, picture and page. Without a name: list the studies."""
    from railhead.cli import study as studying

    if name is None:
        if out is not None or quick or install:
            raise SceneError(
                "study", "--out, --quick and --install need the name of a study; give one"
            )
        for known in studying.names():
            click.echo(f"{known:22s} {studying.load(known).STUDY}")
        return
    folder, page = studying.run(name, out, quick=quick, install=install)
    click.echo(page)
    click.echo(f"written to {folder}/")


def _scene(case: str, assignments: Sequence[str], on: Sequence[str], off: Sequence[str]) -> Scene:
    """A case with what --set, --with and --without say."""
    for name in set(on) & set(off):
        raise SceneError(f"effects.{name}", "given with --with and --without; give one of them")
    switches = [f"effects.{name}=on" for name in on] + [f"effects.{name}=off" for name in off]
    return catalogue.find(case).replace([*assignments, *switches])


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command; exits with 0 (solved), 1 (a check failed, or the files could not be
    written) or 2 (wrong input)."""
    process.prepare()
    sys.exit(_status(arguments))


def _status(arguments: Sequence[str] | None) -> int:
    given = process.arguments() if arguments is None else list(arguments)
    try:
        code = railhead.main(given, prog_name="railhead", standalone_mode=False, obj=given)
        return int(code or SOLVED)
    except SceneError as error:
        return _refuse(str(error))
    except click.exceptions.NoArgsIsHelpError as error:
        click.echo(error.format_message())
        return WRONG_INPUT
    except click.ClickException as error:
        return _refuse(error.format_message())
    except OSError as error:
        return _not_written(error)
    except Exception as error:
        from railhead.meshing.mesh import MeshError

        if not isinstance(error, MeshError):
            raise
        _say(f"NOT MESHED: {error}")
        return CHECK_FAILED


def _say(text: str) -> None:
    """To standard error, once by all processes of MPI."""
    mpi = sys.modules.get("mpi4py.MPI")
    if (mpi.COMM_WORLD.rank if mpi else process.rank()) == 0:
        click.echo(f"railhead: {text}", err=True)


def _refuse(text: str) -> int:
    _say(" ".join(text.split()))
    return WRONG_INPUT


def _not_written(error: OSError) -> int:
    from railhead.planning.cost import machine

    where, cache = str(error.filename or ""), machine.cache_file().parents[1]
    hint = ""
    if where and (cache.is_relative_to(where) or Path(where).is_relative_to(cache)):
        hint = " (the cache of compiled forms; XDG_CACHE_HOME names another folder)"
    _say(f"NOT WRITTEN: {where + ': ' if where else ''}{error.strerror or error}{hint}")
    return CHECK_FAILED
