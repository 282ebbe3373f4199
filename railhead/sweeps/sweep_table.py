"""A sweep as records, rows of sweep.csv and results; its verdict, and report.html of all rows: one
file for a reader who has nothing else.
"""

import math
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from railhead.planning.effects import EFFECTS
from railhead.postprocess.findings import BASE_UNITS, Drawing, Subject, Units, keyed
from railhead.results import result_folder
from railhead.results.report import html, terminal
from railhead.results.result import Result
from railhead.scene import quantities
from railhead.scene.catalogue import as_path
from railhead.scene.scene import Scene, SceneError
from railhead.sweeps import sampling, store
from railhead.sweeps.grid import column, shown
from railhead.theory.array_types import Array

Row = dict[str, Any]
COLUMNS = [each for each in quantities.QUANTITIES if each.column]
CHECKS, PASSED, WARNINGS, BELOW = "checks", "passed", "warnings", "below resolution"
STEEL = "steel"  # column: whether a steel that was solved as elastic would yield
REPORT, MAP, PICTURE = "report.html", "fatigue_map.png", "sweep.png"
MOVED = 0.1  # mm across the rail between patches, above which there is a map
LARGEST = "p_max [MPa]"
POSITION, NOTHING = "rail.position [mm]", 0.01  # of the load
NOTE = re.compile(rf"(?:^|; )({'|'.join(EFFECTS)}): ")  # begin of a warning in a cell


def record(
    over: Mapping[str, object], names: Mapping[str, str], result: Result | Exception
) -> dict[str, Any]:
    """Record of a solved scene, or of the error that refused the scene, as plain data; an error
    makes `over`, `names` and `fault` alone.

    over: values of the changing keys by dotted key.
    names: of the files among them, by key (`ParameterGrid.names`).
    fault: reason why there is no result, in one line; empty where there is one.
    summary: content of summary.json.
    """
    table: dict[str, Any] = {"over": over, "names": names, "fault": ""}
    if isinstance(result, Exception):
        return table | {"fault": " ".join(str(result).split())}
    return table | {"summary": result.summary}


def records(folder: Path) -> dict[int, tuple[dict[str, Any], Row]]:
    """Record and row by number of the scene, in that order. Raises SceneError for a broken file,
    and for one that is no record of a scene.
    """
    found = {}
    for number in sorted(store.done(folder)):
        record = store.read(folder, number)
        try:
            cells = row(record)
            # Every number is read once: what is broken shows here.
            _ = verdict([cells]), [cell(cells, name, BASE_UNITS) for name in cells]
            found[number] = record, cells
        except (LookupError, TypeError, ValueError, AttributeError):
            raise store.broken(store.record_path(folder, number)) from None
    return found


def row(record: Mapping[str, Any]) -> Row:
    """A row of sweep.csv: cells by column header.

    Without a result the row ends after `checks`, and where Newton's method did not converge after
    `warnings`. Raises LookupError, TypeError, ValueError or AttributeError for data that is no
    record of a scene.
    """
    values = record["over"] | record["names"]
    cells: Row = {column(key): shown(key, value) for key, value in values.items()}
    cells[CHECKS] = status(record)
    if record["fault"]:
        return cells
    summary = record["summary"]
    after = summary["effects_after"].items()
    told = [f"{name}: {each['why']}" for name, each in after if each["needed"] or each["notable"]]
    if summary["effects_after"].get("plasticity", {}).get("needed"):
        cells[STEEL] = "would yield"
    cells[WARNINGS] = "; ".join(told)
    if not summary["checks"]["converged"]:
        return cells
    result, bound = summary["result"], summary["accuracy"]["bound"]
    cells |= {each.header: each.value(result) for each in COLUMNS if each.path[0] in result}
    if friction := result.get("friction"):
        hidden = friction.get("below_resolution") or ()
        cells[BELOW] = "; ".join(each.column for each in COLUMNS if each.key in hidden)
    # Of several patches the most loaded one is the first, as for a, b and its place.
    patches = result["patches"]
    angle = (patches[0] if patches else summary["plan"])["contact_angle_rad"]
    share = {"load share": patches[0]["load_share"]} if "surface_shape" in result else {}
    heads = result.get("heads", {}).items()
    cells |= {f"share {name}": head["share"] for name, head in heads}
    cells |= {f"p_max {name} [MPa]": head["max_MPa"] for name, head in heads}
    return cells | {
        "contact angle [deg]": math.degrees(angle),
        **{f"patch {axis} [mm]": result["contact_point_mm"][n] for n, axis in enumerate("xyz")},
        "patches": max(1, len(patches)),
        "unknowns": summary["cost"]["dofs"],
        **share,
        **{
            f"{each.column.removeprefix('found ')} estimate": bound.get(each.key)
            for each in COLUMNS
            if each.estimated or (not each.absolute and each.key in bound)
        },
        "program": f"railhead {summary['railhead']}",
        "date": summary["date"],
    }


def verdict(rows: Sequence[Mapping[str, Any]], units: Units = BASE_UNITS) -> list[str]:
    """Lines that say of all rows what a run says of one: whether the checks hold, largest pressures
    with their estimates, and warnings, counted by kind. units: of the pressures.
    """
    failed = sum(row[CHECKS] != PASSED for row in rows)
    warned = sum(bool(row.get(WARNINGS)) for row in rows)
    lines = [f"{len(rows)} combinations, {f'{failed} not passed' if failed else 'all passed'}"]
    lines[0] += f", {warned} with warnings" if warned else ""
    if yields := sum(bool(row.get(STEEL)) for row in rows):
        lines[0] += f"; the steel would yield in {yields}, whose answers are elastic"
    same = Counter(row[CHECKS] for row in rows if row[CHECKS] != PASSED)
    lines += [f"{text} (in {count})" for text, count in same.items() if count > 1]
    if solved := [row for row in rows if row.get("p_max [MPa]") is not None]:
        pressures = [units.value(row["p_max [MPa]"], "MPa") for row in solved]
        known = [row["p_max estimate"] for row in solved if row["p_max estimate"] is not None]
        text = f"largest pressure {min(pressures):.5g} to {max(pressures):.5g} {units.unit('MPa')}"
        if known:
            text += f", estimated within {_share(min(known))} to {_share(max(known))}"
        missing = len(solved) - len(known)
        lines.append(text + (f"; {missing} without an estimate" if missing else ""))
    if over := transfer(rows):
        place = {
            key: f"{units.value(over[key], 'mm'):.6g}" for key in ("half_mm", "from_mm", "to_mm")
        }
        text = f"half of the load has gone over at {place['half_mm']} {units.unit('mm')}, within "
        text += f"{units.text(over['to_mm'] - over['from_mm'], 'mm', 3)} of travel "
        lines.append(f"{text}({place['from_mm']} to {place['to_mm']})")
    hidden = Counter(name for row in rows for name in _hidden(row))
    kinds = Counter(name for row in rows for name in NOTE.findall(row.get(WARNINGS, "")))
    return [
        *lines,
        *(f"{name}: below resolution in {count}" for name, count in hidden.items()),
        *(
            f"{kind}: a warning in {count} of {len(rows)} (column {WARNINGS})"
            for kind, count in kinds.items()
        ),
    ]


def transfer(rows: Sequence[Mapping[str, Any]]) -> dict[str, float]:
    """Positions along a crossing between which the load passes from one head to the other, mm:
    "half_mm" at which both carry half of it; "from_mm" and "to_mm", between which each carries more
    than 1 % (NOTHING), or the ends of the rows; and the largest pressure of all rows,
    "largest_MPa". Between rows the share is linear. Empty where the load does not pass, or passes
    more than once. rows: of sweep.csv over rail.position, of which those with two heads count.
    """
    known = [row for row in rows if row.get("share wing") is not None and POSITION in row]
    known.sort(key=lambda row: row[POSITION])
    at, share = (
        np.array([row[name] for row in known], dtype=float) for name in (POSITION, "share rail")
    )
    ahead = np.sign(share - 0.5)
    if len(known) < 2 or np.count_nonzero(np.diff(ahead)) != 1:
        return {}
    if ahead[0] > 0:
        share = 1 - share

    def reached(value: float) -> float:
        """First position at which the head that takes over has more than a share, mm."""
        after = int(np.argmax(share > value)) if share.max() > value else len(share)
        ends = slice(max(after - 1, 0), after + 1)
        return float(np.interp(value, share[ends], at[ends]))

    return {
        "half_mm": reached(0.5),
        "from_mm": reached(NOTHING),
        "to_mm": reached(1 - NOTHING),
        "largest_MPa": max(row["p_max [MPa]"] for row in known),
    }


def short(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Columns of short tables, behind those of the values."""
    from railhead.postprocess.pictures.sweep_plots import panels

    steel = [STEEL] if any(row.get(STEEL) for row in rows) else []
    return [CHECKS, *steel, *panels(rows)]


def _hidden(row: Mapping[str, Any]) -> list[str]:
    """Names of the columns of a row, without units, whose values mesh or grid do not resolve."""
    return [name for name in str(row.get(BELOW) or "").split("; ") if name]


def _share(error: float) -> str:
    """A relative error in per cent, with two digits at least."""
    return f"{error:.2%}" if error >= 1e-3 else f"{100 * error:.2g}%"


def status(record: Mapping[str, Any]) -> str:
    """State of a record in words: "passed", the names of the failed checks, or the reason why there
    is no result.
    """
    if record["fault"]:
        return f"NOT SOLVED: {record['fault']}"
    checks = record["summary"]["checks"]
    if not checks["converged"]:
        return f"NOT CONVERGED: {record['summary']['newton']['reason']}"
    return PASSED if checks["passed"] else f"FAILED: {' '.join(checks['failed'])}"


def cell(row: Mapping[str, Any], name: str, units: Units) -> str:
    """A cell of a row as text: a number in the reader's unit, with its relative estimate, or the
    mark that it is below resolution, where it has one. Empty where the row has no value.
    """
    from railhead.postprocess.pictures.sweep_plots import FRICTION

    short = name.partition(" [")[0]
    value, bound = keyed(name, row.get(name)), row.get(f"{short} estimate")
    text = "" if value is None else str(value)
    if isinstance(value, float):
        value = units.value(value, name) + 0.0
        text = f"{value:g}"
        if bound is not None:
            error = f"{_share(bound)} of mu N" if name in FRICTION else _share(bound)
            text = f"{value:.5g}\u00a0\u00b1\u00a0{error}"
    return f"{text} ({BELOW})" if text and short in _hidden(row) else text


def _sampled(rows: Mapping[int, Row], request: Mapping[str, Any]) -> dict[str, Any]:
    """What samples say together (`sampling.summary`), of rows by number, with those errors of each
    row that sweep.csv has. request: content of sweep.json.
    """
    keys = list(request["over"]) if request["sample"]["sobol"] else []
    size, group = max(rows, default=-1) + 1, len(keys) + 2 if keys else 1
    numbers, answers = range(size + -size % group), {}

    def cells(name: str) -> Array:
        """Numbers of a column, NaN where a row has none. ValueError: a word."""
        return np.array([rows.get(number, {}).get(name) for number in numbers], dtype=float)

    for each in COLUMNS:
        with suppress(ValueError):
            values = cells(each.header)
            over = cells("mu N [N]") if each.over_friction_limit else values
            error = cells(f"{each.column.removeprefix('found ')} estimate")
            scaled = error * (1.0 if each.absolute else np.abs(over))
            if np.isfinite(values).any():
                answers[each.header] = values, scaled
    failed = {number: row[CHECKS] for number, row in rows.items() if row[CHECKS] != PASSED}
    return sampling.summary(answers, failed, keys)


def _said(sample: Mapping[str, Any], units: Units) -> list[str]:
    """Lines with median and 95 % of what short tables have, with both errors, and of the largest
    pressure the shares of its variance. sample: as of `sampling.summary`, or empty.
    """
    from railhead.postprocess.pictures.sweep_plots import PANELS

    lines = []
    for name, own in sample.get("quantiles", {}).items():
        texts = [
            f"{word} below {value} (sampling {error}, runs {estimate})"
            for word, share in (("half", "0.5"), ("95 %", "0.95"))
            for value, error, estimate in [
                [
                    "?" if each is None else f"{units.value(each, name):.4g}"
                    for each in own[share].values()
                ]
            ]
        ]
        lines += [f"{units.unit(name)}: {', '.join(texts)}"] if name in PANELS else []
    return lines + [
        f"variance of the largest pressure by {key}: {own['first']:.3f} alone, {own['total']:.3f} "
        f"in all, within {'?' if own['error'] is None else format(own['error'], '.3f')}"
        for key, own in sample.get("sobol", {}).get(LARGEST, {}).items()
    ]


class Sweep(terminal.Drawn, list[Result]):
    """List of the results of all combinations that were solved, the last key changing fastest. A
    combination without a result is missing in the list, but has a row, so positions need not be
    numbers of combinations.

    keys: dotted keys that are set, in order.
    failures: a line for each file that could not be drawn.
    sample: what samples say together, as `sampling.summary`; empty where they are none.
    """

    def __init__(self, folder: Path) -> None:
        """folder: of the sweep. Nothing is solved. Raises SceneError for a broken file, and for
        records of another sweep, wear or a creep table.
        """
        request = store.load(folder / store.REQUEST)
        if "over" not in request:
            text = f"{str(folder)!r} holds no run and no sweep"
            raise SceneError("load", f"{text}; give the folder of one")
        known = records(folder)
        super().__init__(
            Result(None, record["summary"]) for record, _ in known.values() if not record["fault"]
        )
        try:
            name, self.keys = str(request["scene"]["name"]), list(request["over"])
        except (LookupError, TypeError):
            raise store.broken(folder / store.REQUEST) from None
        self._title = f"sweep of {name} over {' and '.join(self.keys)}"
        self._columns = [column(key) for key in self.keys]
        self._rows = [row for _, row in known.values()]
        self.sample: dict[str, Any] = {}
        if "sample" in request:
            self.sample = _sampled(dict(zip(known, self._rows, strict=True)), request)
        if any(name not in row for name in self._columns for row in self._rows):
            raise SceneError("load", f"{str(folder)!r} holds records of another sweep")
        self.failures: list[str] = []

    def show(self, console: Console, units: Units | None = None) -> None:
        """Print a row for each combination, and what they say together, on a console. units: of the
        numbers; None: mm, N, MPa.
        """
        units = units or BASE_UNITS

        def table(names: Sequence[str]) -> Table:
            """The values and these columns. A dot and a unit may end a line of a head."""
            names = [*self._columns, *names]
            found = Table(box=box.SIMPLE)
            for name in names:
                head = units.unit(name).replace(".", ".\n").replace(" [", "\n[")
                found.add_column(Text(head), overflow="fold")
            for row in self._rows:
                found.add_row(*(Text(cell(row, name, units)) for name in names))
            return found

        terminal.print_in_parts(short(self._rows), table, console, console.width)
        for line in self.verdict(units):
            console.print(line, markup=False, highlight=False)

    def drawings(self, units: Units = BASE_UNITS) -> dict[str, Drawing]:
        """Functions that draw the pictures, by name of their PNG file. units: of their numbers."""
        from railhead.postprocess.pictures import sweep_plots as plots

        said = [each.summary for each in self]
        loads = sorted({each["scene"].get("load") for each in said} - {None})
        ends = (units.text(load, "N", 5) for load in dict.fromkeys(loads[:1] + loads[-1:]))
        methods = sorted({each["method"] for each in said})
        title = ", ".join([self._title, *[" to ".join(ends)] * bool(loads), *methods])
        subject = Subject(title, units=units)
        found = [each["result"] for each in said if "fatigue" in (each["result"] or {})]
        laid = [each["contact_point_mm"][1] for each in found]
        profiles = [each["fatigue"]["profile"] for each in found]
        moved, draw = np.ptp(laid or [0.0]) > MOVED, plots.fatigue_map
        more = {MAP: partial(draw, laid, profiles, subject)} if moved else {}
        if self.sample:
            own = self.sample["quantiles"].get(LARGEST, {})
            drawn = partial(plots.samples, self._columns, self._rows, LARGEST, own, subject)
            return {PICTURE: drawn, **more}
        return plots.drawings(self._columns, self._rows, subject) | more

    def write_report(self, folder: Path, scenes: Sequence[Scene], units: Units) -> None:
        """Write report.html into the folder of the sweep, with those pictures that are there.
        scenes: of all rows. units: of the numbers. Raises OSError where it cannot be written.
        """
        drawn = (folder / name for name in self.drawings())
        rows, columns = self._rows, self._columns
        first, *others = map(html.scene_rows, scenes)
        text = html.template("sweep.html.j2").render(
            title=self._title,
            units=units,
            verdict=self.verdict(units),
            passed=all(row[CHECKS] == PASSED for row in rows),
            pictures=[html.picture(path.read_bytes()) for path in drawn if path.exists()],
            columns=[*columns, *short(rows), WARNINGS],
            every=list(dict.fromkeys(name for row in rows for name in row)),
            rows=rows,
            cell=cell,
            asked={
                name: list(dict.fromkeys(cell(row, name, units) for row in rows))
                for name in columns
            },
            same=[pair for pair in first if all(pair in other for other in others)],
            date=result_folder.now(),
            versions=html.versions(),
        )
        (folder / REPORT).write_text(text, encoding="utf-8")

    def as_dict(self) -> dict[str, Any]:
        """The rows as plain data, of a crossing where the load goes over (`transfer`), and of
        samples what they say together ("sample").
        """
        more = {store.TRANSFER: transfer(self._rows), "sample": self.sample}
        return {"rows": self._rows, **{key: each for key, each in more.items() if each}}

    def verdict(self, units: Units) -> list[str]:
        """Lines that say of all rows what a run says of one, and quantiles and shares of samples.
        units: of the numbers.
        """
        return verdict(self._rows, units) + _said(self.sample, units)

    def worst(self) -> list[int]:
        """Numbers of the rows with the largest pressures, the largest first."""
        known = [n for n, row in enumerate(self._rows) if row.get(LARGEST) is not None]
        return sorted(known, key=lambda number: -self._rows[number][LARGEST])

    def rows(self) -> list[Row]:
        """The table of `railhead sweep`: a row for each combination that has a record, in their
        order, cells by column header (docs/sweeps.md). A combination that could not be solved has
        the reason in "checks".
        """
        return self._rows

    def to_csv(self, path: str | Path) -> None:
        """Write the rows as comma-separated values, in UTF-8 with a byte order mark. Raises
        SceneError for what is no path, OSError where it cannot be written.
        """
        as_path(path, "path").write_bytes(result_folder.encoded(self.rows()))
