"""Options that several commands take, and the decorators that add them."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from railhead.scene import catalogue
from railhead.scene.keys import OTHER_NAMES, assignment
from railhead.scene.quantities import GROUPS
from railhead.scene.scene import Scene, SceneError
from railhead.scene.sections import refuse_first

if TYPE_CHECKING:
    from railhead.postprocess.findings import Units
    from railhead.sweeps.sampling import Law


def _lists(
    context: click.Context, _: click.Parameter, texts: Sequence[str]
) -> dict[str, list[object] | Law]:
    """Lists of values of --over, or laws, by dotted key. Raises SceneError for wrong ones."""
    if not texts:
        return {}
    from railhead.sweeps.grid import parse_values
    from railhead.sweeps.sampling import Law

    lists = parse_values(texts)
    laws = [key for key, each in lists.items() if isinstance(each, Law)]
    alone = "is a law, which railhead sweep alone takes, with --sample; give values"
    refuse_first(*((context.info_name != "sweep", key, alone) for key in laws))
    return lists


def _rows(_: click.Context, option: click.Parameter, file: Path | None) -> list[dict[str, object]]:
    """Rows of values of a file by dotted key. Raises SceneError for a file without any."""
    if file is None:
        return []
    from railhead.sweeps.grid import read_rows

    return read_rows(file, option.opts[0])


over = click.option(
    "--over",
    "lists",
    multiple=True,
    callback=_lists,
    metavar="KEY=VALUES",
    help="Values of a key: 25kN,50kN or first:last:step, 0:10:0.5mm.",
)
over_file = click.option(
    "--over-file",
    "rows",
    callback=_rows,
    type=click.Path(path_type=Path),
    help="Rows of values: a .csv file, its first line keys.",
)
samples_file = click.option(
    "--samples-file",
    "samples",
    callback=_rows,
    type=click.Path(path_type=Path),
    help="Rows that are samples, whose keys may depend on each other: a .csv file.",
)


def _once(_: click.Context, __: click.Parameter, assignments: Sequence[str]) -> Sequence[str]:
    """The assignments of --set. Raises SceneError for a key that is given twice."""
    keys = [OTHER_NAMES.get(key, key) for key, _ in map(assignment, assignments)]
    if twice := [key for key in keys if keys.count(key) > 1]:
        raise SceneError(twice[0], "given twice with --set; give it once")
    return assignments


class _Folder(click.Path):
    """The type of a folder's path, which is not empty."""

    def convert(self, value: Any, *rest: Any) -> Any:
        """The path. Raises SceneError for an empty one."""
        refuse_first((value == "", "--out", "is empty; give the path of a folder"))
        return super().convert(value, *rest)


FOLDER = _Folder(path_type=Path)


def prints_json(what: str) -> Callable[[Any], Any]:
    """The option --json of a command. what: it prints."""
    text = f"Print {what} and nothing else."
    return click.option("--json", "as_json", is_flag=True, help=text)


def out(folder: str) -> Callable[[Any], Any]:
    """The option --out of a command. folder: that it writes otherwise, in words."""
    return click.option("--out", type=FOLDER, help=f"Folder [{folder}].")


accuracy = click.option("--accuracy", help="Asked accuracy, e.g. 1%.")
no_pictures = click.option(
    "--no-pictures", is_flag=True, help="Write no PNG files and no report.html."
)
quiet = click.option("--quiet", is_flag=True, help="Print only what fails.")
force = click.option("--force", is_flag=True, help="Replace another result in --out.")
assign = click.option(
    "--set",
    "assignments",
    multiple=True,
    metavar="KEY=VALUE",
    callback=_once,
    help="Change a key of the scene.",
)
case = click.argument("case")
_effect = functools.partial(
    click.option,
    multiple=True,
    metavar="NAME",
)
_scene_options = (
    case,
    assign,
    _effect("--with", "switched_on", help="Simulate this effect."),
    _effect("--without", "switched_off", help="Leave this effect out."),
    click.option("--fast", is_flag=True, help="Half-spaces: --without finite_bodies."),
    click.option("--only", metavar="NAME,NAME", help=f"Compute these: {','.join(GROUPS)}."),
)


def _units(_: click.Context, __: click.Parameter, text: str | None) -> Units:
    """The units of --units; None: base units. Raises SceneError for unknown ones."""
    from railhead.results.report import output_units

    return output_units.parse(text)


units = click.option("--units", callback=_units, help="Of tables, pictures and report: mm,kN,MPa.")
_report_options = (
    out("results/<name>_<command>"),
    force,
    click.option("--no-pictures", is_flag=True, help="Write no PNG files."),
    units,
    click.option("--quiet", is_flag=True, help="Print nothing."),
    prints_json("the summary"),
)


def _with_options(command: Callable[..., Any], options: Iterable[Callable[[Any], Any]]) -> Any:
    """The command with additional arguments and options of click, in their order."""
    return functools.reduce(lambda inner, option: option(inner), reversed([*options]), command)


takes_report = functools.partial(_with_options, options=_report_options)
"""Adds the options that `_report` takes."""


def _first_scene(
    case: Scene, assignments: Sequence[str], rows: Sequence[Mapping[str, object]]
) -> Scene:
    """The case with the assignments and the first row of values by dotted key that makes a scene.
    Raises SceneError, that of the first row, where none does.
    """
    first: SceneError | None = None
    for row in rows:
        try:
            return case.replace(assignments, **row)
        except SceneError as error:
            first = first or error
    raise first or SceneError("--samples-file", "has no rows; give one or more")


def takes_scene(command: Callable[..., Any]) -> Any:
    """The command with the argument CASE and the options --set, --with, --without, --fast and
    --only, which it gets as one argument `scene`; keys of --over and --over-file have their first
    value there, those of laws the median, those of samples the first row that makes a scene.
    Raises SceneError for a wrong case, key, value, effect or quantity.
    """

    @functools.wraps(command)
    def call(
        *arguments: Any,
        case: str,
        assignments: Sequence[str],
        switched_on: Sequence[str],
        switched_off: Sequence[str],
        fast: bool,
        only: str | None,
        **values: Any,
    ) -> Any:
        """The command with a scene in the place of the options that change it."""
        switched_off = [*switched_off, *(["finite_bodies"] if fast else [])]
        for name in set(switched_on) & set(switched_off):
            raise SceneError(f"effects.{name}", "given with --with and --without; give one of them")
        switches = [f"effects.{name}=on" for name in switched_on]
        switches += [f"effects.{name}=off" for name in switched_off]
        asked: dict[str, object] = {} if only is None else {"quantities": only}
        for row in values.get("rows", [])[:1]:
            asked |= row
        for key, each in values.get("lists", {}).items():
            asked[key] = each[0] if isinstance(each, list) else each.median
        rows = [asked | row for row in values.get("samples") or [{}]]
        scene = _first_scene(catalogue.find(case), [*assignments, *switches], rows)
        return command(*arguments, scene=scene, **values)

    return _with_options(call, _scene_options)
