"""The command `railhead`, and the same options for `python cases/<case>.py`."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import click
from rich.console import Console

from railhead import __version__, catalogue
from railhead.scene import Scene, SceneError

SOLVED, CHECK_FAILED, WRONG_INPUT = 0, 1, 2

_set = click.option(
    "--set", "assignments", multiple=True, metavar="KEY=VALUE", help="Change a key of the scene."
)


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__)
def railhead() -> None:
    """Wheel-rail contact by finite elements, held against exact Hertz."""


@railhead.command("list")
def list_cases() -> None:
    """List the cases that ship."""
    for name, (_, text) in catalogue.shipped().items():
        click.echo(f"{name:22s} {text}")


@railhead.command()
@click.argument("case")
@_set
@click.option("--accuracy", help="Asked accuracy, e.g. 1%.")
def plan(case: str, assignments: Sequence[str], accuracy: str | None) -> None:
    """Say what would be simulated and what it costs; solve nothing."""
    from railhead import machine, report
    from railhead import plan as planning

    scene = _scene(catalogue.find(case), assignments, accuracy)
    decided = planning.make(scene)
    if not machine.known():
        click.echo("measuring this machine's speed, once", err=True)
        machine.measure()
    report.show_plan(decided, _console())


@railhead.command()
@click.argument("case")
@_set
@click.option("--accuracy", help="Asked accuracy, e.g. 1%.")
@click.option("--budget", help="Best accuracy for that time, e.g. 30s.")
@click.option("--out", type=click.Path(path_type=Path), help="Result folder [results/<case>].")
@click.option("--no-pictures", is_flag=True, help="Write no PNG files.")
@click.option("--quiet", is_flag=True, help="Print nothing.")
@click.option("--json", "as_json", is_flag=True, help="Print summary.json and nothing else.")
def run(
    case: str,
    assignments: Sequence[str],
    accuracy: str | None,
    budget: str | None,
    out: Path | None,
    no_pictures: bool,
    quiet: bool,
    as_json: bool,
) -> int:
    """Solve a case (its name, or a TOML file) and compare it with exact Hertz."""
    scene = _scene(catalogue.find(case), assignments, accuracy, budget)
    return _run(scene, out, pictures=not no_pictures, quiet=quiet or as_json, as_json=as_json)


@railhead.command()
@click.argument("name", required=False)
@click.option("--out", type=click.Path(path_type=Path), help="Folder [results/<study>].")
@click.option("--quick", is_flag=True, help="Only a small part of the study.")
def study(name: str | None, out: Path | None, quick: bool) -> None:
    """Run a study: CSV, picture and page. Without a name: list the studies."""
    from railhead import studies

    if name is None:
        for known, module in studies.shipped().items():
            click.echo(f"{known:22s} {module.STUDY}")
        return
    folder, page = studies.run(name, out, quick=quick)
    click.echo(page)
    click.echo(f"written to {folder}/")


def _console() -> Console:
    """Standard output; tables keep their width where there is no terminal."""
    console = Console()
    return console if console.is_terminal else Console(width=120)


def _scene(
    scene: Scene, assignments: Sequence[str], accuracy: str | None, budget: str | None = None
) -> Scene:
    options = {"accuracy": accuracy, "budget": budget}
    asked = [f"{key}={value}" for key, value in options.items() if value is not None]
    return scene.replace([*assignments, *asked])


def _run(scene: Scene, out: Path | None, *, pictures: bool, quiet: bool, as_json: bool) -> int:
    from railhead import results

    folder = out if out is not None else Path("results") / scene.name
    results.check_folder(folder)

    from railhead import report
    from railhead import run as running
    from railhead.progress import Progress

    rank = running.MPI.COMM_WORLD.rank
    with Progress(quiet=quiet or rank > 0) as progress:
        result = running.run(scene, progress)
        if rank == 0:
            progress.stage("writing files" + (" and pictures" if pictures else ""))
            results.write(result, folder, pictures=pictures)
    passed = running.MPI.COMM_WORLD.bcast(result.passed)
    if rank == 0:
        if as_json:
            click.echo(results.as_json(result), nl=False)
        elif not quiet:
            report.show_result(result.summary, _console())
            click.echo(f"written to {folder}/")
        if not passed:
            report.show_failure(result.summary, Console(stderr=True))
    return SOLVED if passed else CHECK_FAILED


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command; exits with 0 (solved), 1 (a check failed) or 2 (wrong input)."""
    try:
        status = railhead.main(arguments, prog_name="railhead", standalone_mode=False)
    except SceneError as error:
        status = _refuse(str(error))
    except click.exceptions.NoArgsIsHelpError as error:
        click.echo(error.format_message())
        status = WRONG_INPUT
    except click.ClickException as error:
        status = _refuse(error.format_message())
    except (click.Abort, KeyboardInterrupt):
        status = 130
    except Exception as error:
        from meshing.mesh import MeshError

        if not isinstance(error, MeshError):
            raise
        click.echo(f"railhead: NOT MESHED: {error}", err=True)
        status = CHECK_FAILED
    sys.exit(status or SOLVED)


def _refuse(text: str) -> int:
    click.echo(f"railhead: {' '.join(text.split())}", err=True)
    return WRONG_INPUT


def run_case(scene: Scene) -> None:
    """What `python cases/<case>.py [options]` does: `railhead run` on that scene."""
    main(["run", scene.name, *sys.argv[1:]])
