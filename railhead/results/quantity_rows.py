"""Rows of the quantities of summary.json, as the terminal, report.html and result.csv show them."""

import itertools
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any

from railhead.postprocess.findings import NO_DEPTH, Units, brief
from railhead.postprocess.pass_rows import PASS_COLUMNS, PASS_ERRORS
from railhead.scene import quantities
from railhead.scene.keys import dotted

Cell = float | str | None
Row = dict[str, Cell]
"""Cells by column: "quantity", "unit", "FE" and what stands beside it; None where there is none.
Where half-spaces are the answer, "FE" is "half-spaces". "estimate" is a relative error, or a word
why there is none: "below resolution", "given", "no law" (of errors)."""

ROUNDING = 1e-9  # of friction times load: a force below it is 0
FIRST = ("quantity", "unit")
MADE = ("program", "date")
ANSWERS = ("FE", "half-spaces")
OF_ONE = ("a_mm", "b_mm")  # of several patches they are in the table of patches
PATCHES: tuple[tuple[str, str, Callable[[Mapping[str, Any]], float]], ...] = (
    ("share", "%", lambda each: 100 * each["load_share"]),
    ("x", "mm", lambda each: each["centre_mm"][0]),
    ("y", "mm", lambda each: each["centre_mm"][1]),
    ("angle", "deg", lambda each: math.degrees(each["contact_angle_rad"])),
    ("a", "mm", lambda each: each["a_mm"]),
    ("b", "mm", lambda each: each["b_mm"]),
    ("area", "mm2", lambda each: each["area_mm2"]),
    ("p_max", "MPa", lambda each: each["max_MPa"]),
)
"""Name, unit and value of the columns of the table of patches: share of the load, place of the
centre of pressure, contact angle, half lengths along and across, area, largest pressure."""
PASSES_SHOWN = 10  # rows of the table of passes, and the last one
TINY = 1e-9  # mm, a place that is rounding
RELATIVE = (
    "estimate",
    *(f"{name} - Hertz" for name in ANSWERS),
    "estimate A",
    "estimate B",
    "B - A",
)
"""Columns of relative numbers."""


def rows(summary: Mapping[str, Any], table: str) -> list[Row]:
    """Rows of one table of quantities, a row for each quantity of `quantities.rows` that the result
    has; empty where nothing touches.

    table: "contact": beside the answer stand estimates, half-spaces, exact Hertz and the solution
        without yield or friction; half-spaces only beside finite elements. Of several patches there
        are neither Hertz's numbers, which are of one patch, nor half lengths, which `patches` has.
        "load". "yield": under the load and after it. "friction": forces of the wheel on the rail,
        motion and stick share, beside other methods. "steel": effects of pressure and tractions on
        the steel.
    """
    result = summary["result"]
    if result is None:
        return []
    answer = "half-spaces" if summary.get("method") == "half-spaces" else "FE"
    friction = result.get("friction") or {}
    within = summary["accuracy"]["bound"] | dict.fromkeys(friction.get("given", ()), "given")
    within |= dict.fromkeys(friction.get("below_resolution", ()), "below resolution")
    limit = friction.get("limit_N", 0.0)
    several = len(result.get("patches", ())) > 1
    others: dict[str, Any] = {}
    if table == "contact":
        others = {"half-space": summary.get("half_space"), "Hertz": summary["hertz"]}
        if several:
            del others["Hertz"]
        if answer == "half-spaces":
            del others["half-space"]
    elif table == "friction":
        methods = summary.get("half_space_friction") or {}
        flat = {"without creepage": friction.get("without_creepage", {}), **methods}
        others = {name: {"friction": of} for name, of in flat.items() if "reason" not in of}
    found = []
    for each in quantities.rows(table):
        if each.value(result) is None or (several and each.key in OF_ONE):
            continue
        least = 0.0  # up to which a number is rounding
        if table == "yield" or each.key.endswith("depth_mm"):
            least = NO_DEPTH * result["patch"]["a_mm"]
        elif each.over_friction_limit or each.unit == "N mm":  # a moment's arm is 1 mm
            least = ROUNDING * limit
        value = _cell(each.value(result), least)
        error = within.get(each.key, within.get(each.like))
        over = limit if each.over_friction_limit else float(each.absolute)
        if isinstance(value, float) and isinstance(error, float) and over:
            error = error * over / abs(value) if value else None
        elif isinstance(value, float) and error is None and table != "load":
            error = "no law" if value else None
        row: Row = {
            "quantity": each.label,
            "unit": each.unit,
            answer: value,
            "estimate": error,
            **{name: _cell(each.value(of), least) for name, of in others.items()},
        }
        if table == "contact":
            if not several:
                row[f"{answer} - Hertz"] = _relative(row[answer], row["Hertz"])
            for name in summary.keys() & {"elastic", "frictionless"}:
                row[f"{name} {answer}"] = _cell(each.value(summary[name]), least)
        found.append(row)
    return found


def patches(summary: Mapping[str, Any], units: Units) -> tuple[str, list[list[str]]]:
    """Title and cells of the table of separate patches, its header first and the most loaded patch
    next; no cells for a single one.
    """
    each = (summary["result"] or {}).get("patches", ())
    if len(each) < 2:
        return "", []
    bound = summary["accuracy"]["bound"]
    known = [f"{key[0]} within {bound[key]:.2%}" for key in OF_ONE if key in bound]
    names = (f"{name}, {units.unit(unit)}" for name, unit, _ in PATCHES)
    table = [["patch", *names]]
    for number, of in enumerate(each, 1):
        values = ((read(of), unit) for _, unit, read in PATCHES)
        rounded = ((value if abs(value) > TINY else 0.0, unit) for value, unit in values)
        table.append([str(number), *(brief(units.value(*each)) for each in rounded)])
    title = f"{len(each)} separate patches"
    return title + f" ({', '.join(known)} of the first)" * bool(known), table


def passes(
    result: Mapping[str, Any], units: Units, shown: int = PASSES_SHOWN
) -> Iterator[tuple[str, list[list[str]], str]]:
    """Of passes, for each body and patch: title with the estimates after the last pass, cells of
    the table (its header first; the first `shown` passes and the last), and the verdict in words.
    result: "result" of summary.json; none where it has no passes.
    """
    names = (f"{name}, {units.unit(unit)}".strip(", ") for name, unit in PASS_COLUMNS.values())
    header = ["pass", *names]
    for each in [result, *result.get("passes_beside", ())] if result.get("passes") else ():
        known = each["passes_after"]["estimate"]
        errors = {name: known.get(key) for key, name in PASS_ERRORS.items()}
        errors["rate"] = (each.get("rate") or {}).get("estimate")
        told = [f"{name} {error:.1%}" for name, error in errors.items() if error is not None]
        within = f"estimate after the last: {', '.join(told)}" if told else "without an estimate"
        of = f", {each['passes_name']}" if "passes_name" in each else ""
        count = len(each["passes"])
        table = [header]
        for number in sorted({*range(min(shown, count)), count - 1}):
            row = each["passes"][number]
            cells = (brief(units.value(row[key], unit)) for key, (_, unit) in PASS_COLUMNS.items())
            table.append([str(number + 1), *cells])
        yield f"passes{of} ({within})", table, f"Passes{of}: {each['passes_words']}."


def error_parts(summary: Mapping[str, Any]) -> list[list[str]]:
    """Cells of the table of the parts of estimates, in per cent, its header first: a row for each
    quantity that has an estimate, a column for each part that is not 0 for all of them. No cells
    where there are no estimates.
    """
    bound, parts = summary["accuracy"]["bound"], summary["accuracy"]["parts"]
    known = {
        each.label: parts[each.key]
        for each in quantities.QUANTITIES
        if each.label and each.key in bound.keys() & parts.keys()
    }
    names = [
        name
        for name in dict.fromkeys(itertools.chain(*known.values()))
        if any(own.get(name) for own in known.values())
    ]
    table = [["quantity", "estimate", *(name.replace("_", " ") for name in names)]] * bool(known)
    for label, own in known.items():
        cells = (sum(own.values()), *(own.get(name, 0.0) for name in names))
        table.append([label.strip(), *(f"{cell:.3%}" for cell in cells)])
    return table


def filled(rows: Sequence[Row]) -> list[str]:
    """Names of the columns beside quantity and unit in which any row has a value that is not empty,
    in the order of their first appearance.
    """
    names = dict.fromkeys(name for row in rows for name in row if name not in FIRST)
    return [name for name in names if any(row.get(name) not in (None, "") for row in rows)]


def texts(
    rows: Sequence[Row], columns: Sequence[str], units: Units
) -> list[tuple[str, str, list[str]]]:
    """Quantity, displayed unit and cells as text of each row of a table, for the named columns."""
    return [
        (
            str(row["quantity"]),
            units.unit(str(row["unit"])),
            [text(name, row.get(name), str(row["unit"]), units) for name in columns],
        )
        for row in rows
    ]


def text(column: str, value: Cell, unit: str, units: Units) -> str:
    """Text of a cell: words as they are, nothing for None, relative columns in per cent, other
    numbers in displayed units. unit: base unit of the value.
    """
    if value is None or isinstance(value, str):
        return value or ""
    if column.startswith("estimate"):
        return f"{value:.2%}" if value <= 1 else "above 100%"
    if column in RELATIVE:
        return f"{round(value, 4) + 0.0:+.2%}"  # -0 is 0
    return f"{units.value(value, unit):.5g}"


def everything(summary: Mapping[str, Any]) -> Iterator[Row]:
    """Rows of all tables, each with a unique name in "quantity", and the column "value" in the
    place of "FE" or "half-spaces"; then program and date.
    """
    above = ""
    for table in ("contact", "load", "yield", "friction", "steel"):
        for row in rows(summary, table):
            label = str(row["quantity"])
            name = f"{above}: {label.strip()}" if label.startswith(" ") else label
            above = above if label.startswith(" ") else label
            named: Row = {"value" if key in ANSWERS else key: value for key, value in row.items()}
            yield {**named, "quantity": name}
    yield from _passes(summary["result"] or {})
    yield {"quantity": "program", "value": f"railhead {summary['railhead']}"}
    yield {"quantity": "date", "value": summary["date"]}


def _passes(result: Mapping[str, Any]) -> Iterator[Row]:
    """Rows of the passes of a wheel: their number, and of each body and patch the verdict (such as
    "shakes down", see `postprocess.pass_rows.verdict`), and the values of PASS_COLUMNS in the last
    pass, with the estimated relative error of those that have one; names of all but the first name
    it: "passes, wheel: verdict". result: "result" of summary.json; no rows where it has no passes.
    """
    if not result.get("passes"):
        return
    yield {"quantity": "passes", "unit": "", "value": float(len(result["passes"]))}
    beside = {f"passes, {each['passes_name']}": each for each in result.get("passes_beside", ())}
    for of, each in {"passes": result, **beside}.items():
        errors, last = each["passes_after"]["estimate"], each["passes"][-1]
        yield {"quantity": f"{of}: verdict", "unit": "", "value": each["passes_verdict"]}
        for key, (name, unit) in PASS_COLUMNS.items():
            row: Row = {"quantity": f"{of}: {name} of the last", "unit": unit, "value": last[key]}
            yield row | {"estimate": errors.get(key)}


def difference(
    first: Mapping[str, Any],
    second: Mapping[str, Any],
    rows: Callable[[Mapping[str, Any]], Iterable[Row]] = everything,
) -> dict[str, Any]:
    """Two results beside each other. first, second: summary.json of A and of B. rows: of each.

    "made": program and date of each; "scene": pairs of values by dotted key that differ, None where
    a key is not given; "quantities": a row for each quantity of either, with "B - A" relative to A;
    "beyond": names of those that differ by more than the sum of their estimates.
    """
    keys = [dict(dotted(each.get("scene", {}))) for each in (first, second)]
    pairs = {key: [of.get(key) for of in keys] for key in dict.fromkeys([*keys[0], *keys[1]])}
    cells = [{str(row["quantity"]): row for row in rows(each)} for each in (first, second)]
    found, beyond = [], []
    for name in dict.fromkeys(name for of in cells for name in of if name not in MADE):
        a, b = (of.get(name, {}) for of in cells)
        change = _relative(b.get("value"), a.get("value"))
        row: Row = {
            "quantity": name,
            "unit": a.get("unit", b.get("unit")),
            "A": a.get("value"),
            "B": b.get("value"),
            "B - A": change,
            "estimate A": a.get("estimate"),
            "estimate B": b.get("estimate"),
        }
        bounds = [row["estimate A"], row["estimate B"]]
        known = [bound for bound in bounds if isinstance(bound, float)]
        if change is not None and len(known) == 2 and abs(change) > sum(known):
            beyond.append(name)
        found.append(row)
    differing = {key: pair for key, pair in pairs.items() if pair[0] != pair[1]}
    made = [[f"railhead {of['railhead']}", of["date"]] for of in (first, second)]
    return {"made": made, "scene": differing, "quantities": found, "beyond": beyond}


def _cell(value: Any, least: float) -> Cell:
    """A number or a word of a table; a number whose size is at most `least` (rounding) becomes 0.
    None stays None.
    """
    if value is None or isinstance(value, str):
        return value
    return float(value) if abs(value) > least else 0.0


def _relative(value: Cell, exact: Cell) -> float | None:
    """Relative deviation (value - exact) / exact; None for words, missing numbers and an exact
    0.
    """
    if isinstance(value, str) or isinstance(exact, str) or value is None or not exact:
        return None
    return (value - exact) / exact
