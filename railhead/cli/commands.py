"""The command `railhead`: what each of its commands does.

Modules that a command needs are imported when it runs: imports are half of a short command.
"""

from __future__ import annotations

import io
import math
import os
import shutil
import sys
import textwrap
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import redirect_stdout
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from railhead import __version__
from railhead.cli import errors, options
from railhead.cli.errors import CHECK_FAILED, SOLVED, WRONG_INPUT
from railhead.meshing import isolated_process
from railhead.results import result_folder
from railhead.run import process
from railhead.scene import catalogue
from railhead.scene.scene import Scene, SceneError, unit_questions
from railhead.scene.sections import refuse_first

if TYPE_CHECKING:
    from railhead.cli.examined.examined import Examined
    from railhead.postprocess.findings import Units
    from railhead.sweeps.grid import ParameterGrid
    from railhead.sweeps.sampling import Law

PROCESSES = click.IntRange(1)
PROCESSES.name = "number of processes; give a whole number from 1 on"
PORT = click.IntRange(0, 65535)
PORT.name = "port; give a whole number up to 65535"
BACKS, CYCLES = click.IntRange(1, 5), click.IntRange(1, 1000)
BACKS.name = "number of back stresses; give 1 to 5"
CYCLES.name = "number of cycles; give 1 to 1000"
EXPONENT = click.FloatRange(0, 30)
EXPONENT.name = "recall exponent; give 0, or 1 to 30"
START_BYTES = 750_000_000  # address space with which libraries start and half-spaces are solved
# Commands of which MPI prints one copy.
SERIAL = ("list", "plan", "show", "diff", "locate", "profile", "steel")


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__)
@click.pass_context
def railhead(context: click.Context) -> None:
    """Wheel-rail contact by finite elements, held against exact Hertz."""
    if isolated_process.address_space() < START_BYTES:
        raise MemoryError
    if context.invoked_subcommand in SERIAL and process.rank() > 0:
        context.with_resource(redirect_stdout(io.StringIO()))


def _grid(
    scene: Scene, lists: Mapping[str, list[object]], rows: Sequence[dict[str, object]]
) -> ParameterGrid:
    """The combinations of --over and of the rows of --over-file, of which `unit_questions` are
    printed. Raises SceneError for wrong ones, and where neither is given.
    """
    from railhead.sweeps.grid import ParameterGrid

    if not (lists or rows):
        raise SceneError("--over", "is missing; give it, or --over-file")
    grid = ParameterGrid.combine(scene, lists, rows)
    _ask(*grid.scenes)
    return grid


@railhead.command("list")
def list_cases() -> None:
    """List the cases that ship."""
    width = shutil.get_terminal_size().columns
    for name, text in catalogue.shipped().items():
        click.echo(textwrap.fill(f"{name:24s} {text}", width, subsequent_indent=25 * " "))


@railhead.command()
@options.takes_scene
@options.accuracy
@options.over
@options.over_file
@options.prints_json("the plan as JSON")
def plan(
    scene: Scene,
    accuracy: str | None,
    lists: Mapping[str, list[object]],
    rows: Sequence[dict[str, object]],
    as_json: bool,
) -> None:
    """Say what would be simulated and what it costs, of a sweep in all; solve nothing."""
    from railhead import api
    from railhead.planning import simulation_plan as planning
    from railhead.results.report import terminal

    scene = api.with_accuracy(scene, accuracy, None)
    if not (lists or rows):
        _ask(scene)
        planned = api.Planned(planning.make(scene))
        _print(planned.plan.to_dict(), partial(planned.show, terminal.standard()), as_json=as_json)
        return

    from railhead.run.progress import show_progress
    from railhead.sweeps import runner, worker_pool

    grid = _grid(scene, lists, rows)
    with show_progress(quiet=as_json) as progress:
        found = runner.forecast(grid, worker_pool.workers(1), progress)
    _print(found, partial(click.echo, "\n".join(runner.words(found))), as_json=as_json)


@railhead.command()
@options.takes_scene
@options.accuracy
@click.option("--budget", help="Best accuracy for that time, e.g. 30s.")
@options.out("results/<case>")
@options.force
@options.no_pictures
@click.option("--brief", is_flag=True, help="Write report.html on one page.")
@options.units
@click.option("--ranks", type=PROCESSES, metavar="NUMBER", help="Processes [as many as pay].")
@options.quiet
@options.prints_json("summary.json")
@click.pass_obj
def run(
    arguments: Sequence[str],
    scene: Scene,
    accuracy: str | None,
    budget: str | None,
    out: Path | None,
    force: bool,
    no_pictures: bool,
    brief: bool,
    units: Units,
    ranks: int | None,
    quiet: bool,
    as_json: bool,
) -> int:
    """Solve a case (its name, or a TOML file) and compare it with exact Hertz."""
    from railhead import api
    from railhead.cli import launch
    from railhead.planning import cost
    from railhead.planning import simulation_plan as planning

    start = time.perf_counter()
    _ask(scene)
    scene = api.with_accuracy(scene, accuracy, budget)
    folder = _folder(out, scene.name, "run", scene, force=force)
    planned = planning.make(scene)
    if not process.under_mpi():
        planned.price.check_memory(cost.free_memory())
        count = ranks or launch.number_of_processes(planned)
        if count > 1:
            launch.restart(count, arguments)

    from rich.console import Console

    from railhead.results import pipeline
    from railhead.results.report import terminal
    from railhead.run.progress import show_progress

    quiet = quiet or as_json
    with show_progress(quiet=quiet, since=start) as progress:
        result = pipeline.solve(planned, progress)
        first, problem = result.comm.rank == 0, None
        drawn = not no_pictures and scene.asks("pictures")
        progress.stage("writing files" + (" and pictures" if drawn else ""))
        try:
            result.save(
                folder,
                pictures=not no_pictures,
                report="brief" if brief else True,
                units=units,
                force=None if out is None else True,
            )
        except OSError as error:
            problem = error
    if first:
        if not result.passed:
            terminal.show_failure(result.summary, Console(stderr=True))
        _print(
            result.summary,
            partial(result.show, terminal.standard(), units),
            as_json=as_json,
            quiet=quiet,
            folder=folder if problem is None else None,
        )
        if problem is not None:
            errors.not_written(problem)
    return SOLVED if result.passed and problem is None else CHECK_FAILED


def _folder(out: Path | None, name: str, command: str, scene: Scene, *, force: bool) -> Path:
    """The folder of a result: `out`, or results/<name> where that is None; only checked, not made.
    `out` is kept for this command until it ends.
    Raises SceneError where the result of `command` for a scene cannot be written there. Another
    result in `out`, without `force`, and another command that writes there are refused. A result in
    results/<name> will be renamed to <name>.1, so it is refused where the scene reads a file of it.
    """
    folder = out if out is not None else Path("results") / name
    result_folder.check_free(folder, command, scene, force=force or out is None)
    read = [file.name for file in scene.files if folder.resolve() in file.resolve().parents]
    if read and out is None and result_folder.other_result(folder, command, scene):
        text = f"{str(folder)!r} holds {read[0]}, which the scene reads; give another folder"
        raise SceneError("--out", text)
    if out is not None and process.rank() == 0:
        click.get_current_context().with_resource(result_folder.claimed(out))
    return folder


@railhead.command()
@options.takes_scene
@options.over
@options.over_file
@options.out("results/<case>_sweep")
@options.force
@click.option(
    "--sample", "count", type=click.IntRange(1), metavar="NUMBER", help="Of --over KEY=LAW."
)
@options.samples_file
@click.option(
    "--sobol", is_flag=True, help="Shares of variance by key; takes KEYS + 2 times as many."
)
@options.no_pictures
@options.units
@options.quiet
@options.prints_json("the rows")
def sweep(
    scene: Scene,
    lists: Mapping[str, list[object] | Law],
    rows: Sequence[dict[str, object]],
    count: int | None,
    samples: Sequence[dict[str, object]],
    sobol: bool,
    out: Path | None,
    force: bool,
    no_pictures: bool,
    units: Units,
    quiet: bool,
    as_json: bool,
) -> int:
    """Solve a case for every combination of values, side by side."""
    from railhead.contact import head_loads
    from railhead.sweeps.grid import ParameterGrid
    from railhead.sweeps.sampling import Law

    values = {key: each for key, each in lists.items() if not isinstance(each, Law)}
    if count or samples or sobol or len(values) < len(lists):
        refuse_first((bool(rows), "--over-file", "is not allowed beside samples; leave it out"))
        grid = ParameterGrid.sampled(scene, lists, samples, count, sobol=sobol)
        _ask(*grid.scenes)
    else:
        grid = _grid(scene, values if rows else head_loads.refined(scene, values), rows)
    folder = out if out is not None else Path("results") / f"{scene.name}_sweep"
    result_folder.check_folder(folder)

    from railhead.sweeps import parallel, store, sweep_table

    task = parallel.ParallelSweep(grid=grid, folder=folder, units=units)
    other: store.Other = "replace" if force else "move" if out is None else "refuse"
    quiet = quiet or as_json
    pictures = not no_pictures and scene.asks("pictures")
    found = parallel.run(task, pictures=pictures, quiet=quiet, other=other)
    if found is None:  # a rank that worked for the first one
        return SOLVED
    failed = False
    for number, row in enumerate(found.rows()):
        if (text := row[sweep_table.CHECKS]) != sweep_table.PASSED:
            click.echo(f"{grid.label(number)}: {text}", err=True)
            failed = True
    _print(
        found.as_dict(),
        partial(click.echo, "\n".join(found.verdict(units))),
        as_json=as_json,
        quiet=quiet,
        folder=folder,
    )
    if found.failures:
        return errors.not_written(OSError("\n".join(found.failures)))
    return CHECK_FAILED if failed else SOLVED


@railhead.command()
@click.option("--out", type=options.FOLDER, default=Path("results/creep_table"))
@click.option("--poisson", default=0.28, help="Poisson's ratio of both bodies [0.28].")
@click.option("--accuracy", default="2%", help="Of lines along each axis, over mu N [2%].")
@click.option("--ratios", default="0.1:10", help="Smallest and largest a/b [0.1:10].")
@click.option("--cells", default=24, help="Of the finer grid each way [24].")
@click.option("--law", type=(float, float, float), help="Falling friction: docs/creep-tables.md.")
@options.force
@options.quiet
@options.prints_json("the errors")
def table(
    out: Path,
    poisson: float,
    accuracy: str,
    ratios: str,
    cells: int,
    law: tuple[float, float, float] | None,
    force: bool,
    quiet: bool,
    as_json: bool,
) -> int:
    """Tabulate creep forces of ellipses, for vehicle programs."""
    from railhead.sweeps import creep_tables

    found = creep_tables.creep_table(
        out,
        poisson=poisson,
        accuracy=accuracy,
        ratios=ratios,
        cells=cells,
        law=law,
        force=force,
        quiet=quiet or as_json,
    )
    if found is not None:  # None: a rank that worked for the first one
        _print(
            said := creep_tables.summary(found),
            partial(click.echo, "\n".join(creep_tables.words(said))),
            as_json=as_json,
            quiet=quiet,
            folder=out,
        )
    return SOLVED


@railhead.command()
@options.takes_scene
@options.out("results/<case>_wear")
@options.force
@options.no_pictures
@options.quiet
@options.prints_json("wear.json")
def wear(
    scene: Scene, out: Path | None, force: bool, no_pictures: bool, quiet: bool, as_json: bool
) -> int:
    """Wear rail and wheel over a route of positions, [wear] of the scene."""
    from railhead.sweeps.wear import wear as sweep

    _ask(scene)
    folder = out if out is not None else Path("results") / f"{scene.name}_wear"
    result_folder.check_folder(folder)
    quiet, pictures = quiet or as_json, not no_pictures
    found = sweep.wear(scene, folder, force=force, pictures=pictures, quiet=quiet)
    for name, advice in found.summary["checks"]["advice"].items():
        click.echo(f"FAILED {name}: {advice}", err=True)
    _print(
        found.summary,
        partial(click.echo, "\n".join(found.words())),
        as_json=as_json,
        quiet=quiet,
        folder=folder,
    )
    return SOLVED if found.passed else CHECK_FAILED


@railhead.command()
@click.argument("folder", type=click.Path(path_type=Path))
@options.units
@options.prints_json("the numbers as JSON")
def show(folder: Path, units: Units, as_json: bool) -> None:
    """Print what a command found and wrote into a folder; solve nothing."""
    from rich.console import Console

    from railhead.cli import kept
    from railhead.results.report import terminal
    from railhead.results.result import Result

    found = kept.load(folder)
    if isinstance(found, Result) and not found.passed:
        terminal.show_failure(found.summary, Console(stderr=True))
    _print(found.as_dict(), partial(found.show, terminal.standard(), units), as_json=as_json)


@railhead.command()
@click.argument("a", type=click.Path(path_type=Path))
@click.argument("b", type=click.Path(path_type=Path))
@options.units
@click.option("--picture", type=options.FOLDER, metavar="FILE.png", help="Conicities of locate.")
@options.prints_json("the comparison as JSON")
def diff(a: Path, b: Path, units: Units, picture: Path | None, as_json: bool) -> None:
    """Compare what lies in two folders of one command, and their scenes; solve nothing."""
    from railhead.cli import kept
    from railhead.results.report import terminal

    found = kept.difference((a, b), picture)
    _print(
        {"A": str(a), "B": str(b), **found},
        partial(terminal.show_difference, found, terminal.standard(), units),
        as_json=as_json,
    )


@railhead.command()
@options.case
@options.assign
@click.option("--shift", help="Lateral shift of the wheelset, e.g. 3mm.")
@click.option("--yaw", help="Yaw of the wheelset, e.g. 2mrad.")
@options.over
@options.takes_report
def locate(
    case: str,
    assignments: Sequence[str],
    shift: str | None,
    yaw: str | None,
    lists: Mapping[str, list[object]],
    **options: Any,
) -> None:
    """Find where both wheels of a wheelset touch their rails; solve nothing."""
    positions = {"wheelset.shift": shift, "wheelset.yaw": yaw}
    given = [f"{key}={value}" for key, value in positions.items() if value is not None]
    scene = catalogue.find(case).replace([*assignments, *given])

    from railhead.cli.examined.geometry import locate

    _report(locate(scene, lists or None), scene.name, "locate", **options)


@railhead.command()
@click.argument("file", type=click.Path(path_type=Path))
@click.option(
    "--body",
    type=click.Choice(["rail", "wheel"]),
    help="Whose profile it is; without it as the extension says, of a table a rail.",
)
@options.assign
@options.takes_report
def profile(file: Path, body: str | None, assignments: Sequence[str], **options: Any) -> None:
    """Read and smooth a measured profile, and say what is worn off it; solve nothing."""
    from railhead.cli.examined import geometry

    _report(geometry.profile(str(file), body, assignments), file.stem, "profile", **options)


@railhead.command()
@click.argument("source", metavar="NAME|SCENE|FILE")
@options.assign
@click.option("--backstresses", type=BACKS, default=2, help="Of the steel of a FILE [2].")
@click.option("--recall-exponent", type=EXPONENT, default=0.0, help="Of the steel of a FILE [0].")
@click.option("--mean", help="Mean stress of cycles, e.g. 50MPa.")
@click.option("--amplitude", help="Their amplitude, e.g. 400MPa.")
@click.option("--cycles", type=CYCLES, default=50, help="Their number [50].")
@options.takes_report
def steel(
    source: str,
    assignments: Sequence[str],
    backstresses: int,
    recall_exponent: float,
    mean: str | None,
    amplitude: str | None,
    cycles: int,
    **options: Any,
) -> int:
    """Show what a steel does, or fit it to a test (a FILE with columns strain, stress)."""
    from railhead.cli.examined.steels import steel_tests
    from railhead.scene.units import STRESS, to_base

    stress: dict[str, float] = {}
    for name, given in {"mean": mean, "amplitude": amplitude}.items():
        try:
            stress |= {} if given is None else {name: to_base(given, STRESS)}
        except ValueError as error:
            raise SceneError(f"--{name}", str(error)) from None
    refuse_first(
        (stress.get("amplitude", 1.0) <= 0, "--amplitude", f"{amplitude} is not above 0"),
        (math.isnan(recall_exponent), "--recall-exponent", "nan is no number; give 0 to 30"),
    )
    found = steel_tests(source, assignments, backstresses, recall_exponent, cycles=cycles, **stress)
    _report(found, Path(source).stem, "steel", **options)
    return SOLVED if found.fits else CHECK_FAILED


def _report(
    computed: Examined,
    name: str,
    command: str,
    *,
    out: Path | None,
    force: bool,
    no_pictures: bool,
    units: Units,
    quiet: bool,
    as_json: bool,
) -> None:
    """Write a result of a command into a folder and print it.

    out: the folder; None for results/<name>_<command>.
    force: whether another result in `out` is replaced.
    no_pictures: whether no PNG files are written. units: of pictures and table.
    as_json: whether the summary is printed as JSON instead of a table. quiet: whether the table is
        not printed; no effect on JSON.
    """
    from railhead.results.report import terminal

    folder = _folder(out, f"{name}_{command}", command, computed.scene, force=force)
    computed.save(
        folder, pictures=not no_pictures, units=units, force=None if out is None else True
    )
    _print(
        computed.summary(),
        partial(computed.show, terminal.standard(), units),
        as_json=as_json,
        quiet=quiet,
        folder=folder,
    )


@railhead.command()
@click.argument("case", default="s1002_60e1")
@click.option("--port", type=PORT, default=0, metavar="NUMBER", help="Of the address [a free one].")
@click.option("--no-open", is_flag=True, help="Only print the address; open no browser.")
def page(case: str, port: int, no_open: bool) -> None:
    """Look at a case in a browser: drag the wheel over the rail, then solve."""
    for name in ("aiohttp", "plotly"):
        if find_spec(name) is None:
            text = f"{name} is missing; make page, or pip install 'railhead-contact[page]'"
            raise SceneError("page", text)
    words = [case, str(port), "closed" if no_open else "open"]
    program = [sys.executable, "-c", "from railhead.page import main; main()"]
    os.execv(sys.executable, [*program, *words])


@railhead.command()
@click.argument("name", required=False)
@options.out("results/<study>")
@click.option("--quick", is_flag=True, help="Only a small part of the study.")
def study(name: str | None, out: Path | None, quick: bool) -> None:
    """Run a study: CSV, picture and page. Without a name: list the studies."""
    from railhead.cli import study as studies

    if name is None:
        if out is not None or quick:
            raise SceneError("study", "--out and --quick need the name of a study; give one")
        for each, (_, shows) in sorted(studies.modules().items()):
            click.echo(f"{each:22s} {shows}")
        return
    folder, page = studies.run(name, out, quick=quick)
    click.echo(page)
    click.echo(f"written to {folder}/")


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command with arguments, None: those of the process. Exits with status 0 (solved), 1
    (a check failed, or bodies could not be meshed or files not written) or 2 (wrong input).
    """
    process.prepare()
    sys.exit(_status(arguments))


def _status(arguments: Sequence[str] | None) -> int:
    """Run the command and return its exit status 0, 1 or 2. Errors of input, of meshing, of files
    and of memory are printed in one line, without a traceback; others are raised (`errors.told`).
    """
    words = process.take_arguments() if arguments is None else list(arguments)
    try:
        code = railhead.main(words, prog_name="railhead", standalone_mode=False, obj=words)
        return int(code or SOLVED)
    except click.exceptions.NoArgsIsHelpError as error:
        click.echo(error.format_message())
        return WRONG_INPUT
    except Exception as error:
        return errors.told(error)


def _print(
    data: dict[str, Any],
    show: Callable[[], object],
    *,
    as_json: bool,
    quiet: bool = False,
    folder: Path | None = None,
) -> None:
    """Print what a command found: with `as_json` the data alone. Else, unless `quiet`, `show`
    prints it for people, and a line names the folder that it was written to, None: none.
    """
    if as_json:
        click.echo(result_folder.to_json(data), nl=False)
    elif not quiet:
        show()
        if folder is not None:
            click.echo(f"written to {folder}/")


def _ask(*scenes: Scene) -> None:
    """Print what `unit_questions` asks about scenes to standard error."""
    for question in unit_questions(*scenes):
        errors.say(question)
