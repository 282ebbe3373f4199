"""The kinds of folders that `railhead show` prints again and `railhead diff` compares.

`api.load` reads runs and sweeps; each other kind is an entry of KINDS.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.console import Console

from railhead import api
from railhead.cli.examined.geometry import ExaminedProfile, Location
from railhead.cli.examined.passage import Passage
from railhead.cli.examined.steels import SteelTests
from railhead.postprocess.findings import BASE_UNITS, Subject, Units
from railhead.results import quantity_rows, result_folder
from railhead.results.quantity_rows import Row
from railhead.results.report import terminal
from railhead.results.result import Result
from railhead.scene.sections import refuse_first
from railhead.sweeps import creep_tables
from railhead.sweeps.sweep_table import Sweep
from railhead.sweeps.wear import wear, wear_result

Summary = Mapping[str, Any]
Numbers = Iterable[tuple[Any, ...]]
"""Of each number that is compared: name, base unit, value, and its relative error if known."""


@dataclass(frozen=True)
class Kind:
    """What a command leaves in its folder.

    name: of the command.
    key: entry of its summary that the summaries of other commands do not have.
    shown: prints a summary on a console, numbers in units.
    numbers: of a summary, which `diff` compares.
    """

    name: str
    key: str
    shown: Callable[[Summary, Console, Units], None]
    numbers: Callable[[Summary], Numbers]

    def rows(self, summary: Summary) -> list[Row]:
        """Rows as of `quantity_rows.everything`."""
        names = "quantity", "unit", "value", "estimate"
        return [dict(zip(names, each, strict=False)) for each in self.numbers(summary)]


@dataclass(frozen=True)
class Kept:
    """The result of a command of KINDS in a folder. summary: what its summary file holds."""

    kind: Kind
    summary: dict[str, Any]

    def show(self, console: Console, units: Units = BASE_UNITS) -> None:
        """Print what the command printed. units: of the numbers that it prints in units."""
        self.kind.shown(self.summary, console, units)

    def as_dict(self) -> dict[str, Any]:
        """The summary."""
        return self.summary


def load(folder: Path) -> Result | Sweep | Kept:
    """What a folder holds. Raises SceneError for a folder without a result and a broken one."""
    for file in (folder / wear.SUMMARY, folder / result_folder.SUMMARY):
        with api.reading(folder, "result"):
            summary = result_folder.from_json(file) if file.is_file() else {}
            for kind in KINDS:
                if kind.key in summary:
                    found = Kept(kind, summary)
                    terminal.recorded(found.show)  # what is broken shows here
                    return found
    return api.load(folder)


def difference(folders: Sequence[Path], picture: Path | None = None) -> dict[str, Any]:
    """`quantity_rows.difference` of two folders of one kind. picture: PNG file into which the
    equivalent conicities of two folders of `locate` are drawn; None: none.
    Raises SceneError for sweeps, unlike kinds, and a picture of other kinds or in another format.
    OSError: the picture cannot be written.
    """
    found = [load(folder) for folder in folders]
    names = [each.kind.name if isinstance(each, Kept) else "run" for each in found]
    for folder, each in zip(folders, found, strict=True):
        refuse_first(
            (isinstance(each, Sweep), "diff", f"{str(folder)!r} holds a sweep; give two runs")
        )
    one, other = (each.summary for each in found if not isinstance(each, Sweep))
    png = picture is None or (picture.suffix == ".png" and "conicity" in one)
    refuse_first(
        (names[0] != names[1], "diff", f"a {names[0]} and a {names[1]}; give two of one kind"),
        (not png, "--picture", f"{str(picture)!r}: give two folders of locate, and FILE.png"),
    )
    with api.reading(folders[0], "result"):
        rows = found[0].kind.rows if isinstance(found[0], Kept) else quantity_rows.everything
        told = quantity_rows.difference(one, other, rows)
    if picture is not None:
        _draw_conicities(
            {str(f): each for f, each in zip(folders, (one, other), strict=True)}, picture
        )
    return told


def _draw_conicities(summaries: Mapping[str, Summary], file: Path) -> None:
    """Draw equivalent conicities over the amplitude. summaries: of locate, by folder."""
    from railhead.postprocess.pictures import profile_plots

    lines = {}
    for folder, each in summaries.items():
        wheel, rail = (Path(each["scene"][body]["profile"]).name for body in ("wheel", "rail"))
        values = {one["amplitude_mm"]: one["value"] for one in each["conicity"]}
        lines[f"{folder}: {wheel} on {rail}"] = values
    profile_plots.conicity(lines, Subject("equivalent conicity"), file)


def _located(found: Summary) -> Numbers:
    """Of `locate`: conicities at whole amplitudes, and rolling radius differences."""
    name = "rolling radius difference"
    yield name, "mm", found["rolling_radius_difference_mm"]
    for each in found["rows"] if found["tabulated"] else ():
        yield f"{name} at {each['shift_mm']:g} mm", "mm", each["difference_mm"]
    for each in found["conicity"]:
        if each["amplitude_mm"] % 1 == 0:
            yield f"conicity at {each['amplitude_mm']:g} mm", "", each["value"]


def _worn(found: Summary) -> Numbers:
    """Of `wear`: depths, areas and pressures, and when limits are reached."""
    for name, unit in {"depth_max": "mm", "worn": "mm2", "pressure_max": "MPa"}.items():
        key = f"{name}_{unit}"
        for part, value in found[key].items():
            error = found["accuracy"]["bound"][key][part]
            yield f"{name} {part}".replace("_", " "), unit, value, error
    for name, each in found["limits_reached"].items():
        for key, unit in {"axles": "axles", "distance_km": "km"}.items():
            if value := each[key]:
                error = each[f"{key} estimate"]
                yield f"{name} after".replace("_", " "), unit, value, error and error / value


def _profile(found: Summary) -> Numbers:
    """Of `profile`: noise, and what is worn off."""
    yield "noise", "mm", found["noise_mm"]
    for key, value in (found["wear"] or {}).items():
        name, _, unit = key.rpartition("_")
        yield f"wear {name}".replace("_", " "), unit, value


def _steel(found: Summary) -> Numbers:
    """Of `steel`: stresses of the bar, and the strain of the last cycle."""
    yield from ((f"stress at {each}", "MPa", of) for each, of in found["proof_MPa"].items())
    yield "stress of the loop", "MPa", found["loop_MPa"]
    yield "strain of the last cycle", "", found["ratchetting"]["strain_per_cycle"][-1]


def _table(found: Summary) -> Numbers:
    """Of `table`: what was asked, and errors over mu N."""
    yield from ((name, "", found[name]) for name in ("poisson", "cells", "cases"))
    for key in ("grid_error", "interpolation_error"):
        yield from (
            (f"{key} of {name}".replace("_", " "), "", of) for name, of in found[key].items()
        )


def _said(words: Callable[[Any], list[str]]) -> Callable[[Summary, Console, Units], None]:
    """A function that prints the lines of a summary, whatever the units."""
    return lambda found, console, _: console.print(
        "\n".join(words(found)), markup=False, highlight=False, soft_wrap=True
    )


KINDS = (
    Kind("locate", "conicity", Location.shown, _located),
    Kind(
        "locate",
        "over_mm",
        Passage.shown,
        lambda found: [
            (f"height at {each['position_mm']:g} mm", "mm", each["wheel_height_mm"])
            for each in found["rows"]
        ],
    ),
    Kind("profile", "domain_mm", ExaminedProfile.shown, _profile),
    Kind("steel", "proof_MPa", SteelTests.shown, _steel),
    Kind("wear", "worn_mm2", _said(wear_result.words), _worn),
    Kind("table", "interpolation_error", _said(creep_tables.words), _table),
)
"""The commands whose folders are neither of a run nor of a sweep."""
